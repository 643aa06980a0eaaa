"""analyses/eigenfunction_digits.py: eigenfunctions in closed form to forty digits, and those of doubles to the digits that these have."""

from __future__ import annotations

import json
from pathlib import Path

import mpmath
import numpy as np
import pytest

import shootstab as st
from shootstab.cli import main as cli
from shootstab.core.errors import InputError
from shootstab.core.records import Budget, Mode

ENDS = st.Conditions(0, ["y"]), st.Conditions(1, ["y"])
STRING = """[problem]
unknowns = ["y"]
equations = ["d(y,2) = sigma*y"]
left = { at = 0, conditions = ["y"] }
right = { at = 1, conditions = ["y"] }
"""


def test_a_string_to_forty_digits() -> None:
    f = st.eigenfunction(st.equations(["y"], ["d(y,2) = sigma*y"], *ENDS), -39.4, digits=40)
    unknown, place = f.peak
    with mpmath.workdps(60):
        scale = mpmath.sin(2 * mpmath.pi * mpmath.mpf(place))
        errors = [abs(f(z)[unknown] - mpmath.sin(2 * mpmath.pi * mpmath.mpf(z)) / scale) for z in ("0", "0.3", "0.77", "1")]
    assert max(errors) <= f.error <= 1e-40
    assert f"y = 1 at z = {place}" in f.normalization


def test_the_solutions_at_an_axis_are_bessel_functions_to_thirty_digits() -> None:
    """u″ + u′/r = σu with u(1) = 0: σ = −j², u = J0(jr) with j the second zero of J0."""
    pipe = st.equations(["u"], ["r*d(u,2) + d(u) - sigma*r*u"], st.Axis(0), st.Conditions(1, ["u"]), variable="r")
    f = st.eigenfunction(pipe, -30.4, digits=30)
    place = f.peak[1]
    with mpmath.workdps(50):
        j = mpmath.besseljzero(0, 2)
        scale = mpmath.besselj(0, j * mpmath.mpf(place))
        errors = [abs(f(r)["u"] - mpmath.besselj(0, j * mpmath.mpf(r)) / scale) for r in ("0.25", "0.5", "0.8125")]
    assert max(errors) <= f.error <= 1e-30


def test_unknowns_that_the_reduction_removed_and_conditions_with_the_eigenvalue_at_both_ends() -> None:
    """The gradient q = y′/2 is no state of its own, and the ends are springs whose force is σ: doubles say the same."""
    ends = st.Conditions(0, ["d(y) - sigma*y"]), st.Conditions(1, ["d(y) + sigma*y"])
    problem = st.equations(["y", "q"], ["2*q - d(y)", "d(y,2) - (sigma + z)*y"], *ends)
    rough = st.eigenfunction(problem, st.find(problem, st.Rectangle(-30 - 1j, -5 + 1j)).modes[0])
    f = st.eigenfunction(problem, rough.mode, digits=20)
    scale = rough(float(f.peak[1]))[f.peak[0]]
    assert f.names == ("y", "q")
    for z in (0.0, 0.21, 0.64, 1.0):
        exact, double = f(z), rough(z)
        assert max(abs(complex(exact[name]) - double[name] / scale) for name in f.names) < 1e-11


def test_a_chute_inside_its_integration_and_beyond() -> None:
    """With k_x = 0, where v̂ is turned; from where the integration begins on the solution is that of the far field."""
    problem = st.scene("high").problem
    f = st.eigenfunction(problem, 0.004, digits=14)
    start = f.solution.ends[1]
    scale = f.rough(float(f.peak[1]))[f.peak[0]]
    heights = [0.0, 1.5, 0.9 * start, 1.2 * start, 3.0 * start]
    assert heights[-1] < f.rough.extent[1]
    for name in f.names:
        largest = np.abs(f.rough(np.linspace(0.0, 100.0, 101))[name]).max() / abs(scale)
        for z in heights:
            assert abs(complex(f(z)[name]) - f.rough(z)[name] / scale) < 1e-11 * largest


def test_what_is_no_simple_mode_and_no_height_is_refused() -> None:
    problem = st.equations(["y"], ["d(y,2) = sigma*y"], *ENDS)
    f = st.eigenfunction(problem, -9.9, digits=14)
    with pytest.raises(InputError, match=r"z = 1.5: allowed is z from 0 to 1"):
        f(1.5)
    with pytest.raises(InputError, match="finite real number"):
        f("one")
    with pytest.raises(InputError, match="finite real number"):
        f(float("nan"))
    twice = Mode(-9.87, 1e-6, Budget(0, 0, 0, 0, 0), "converged", "frame", 1, 0.0, multiplicity=2)
    with pytest.raises(InputError, match="stands for 2"):
        st.eigenfunction(problem, twice, digits=20)
    with pytest.raises(InputError, match="more than 12 digits"):
        plain = st.problem(
            2, lambda z: (np.array([[0, 1], [0, 0]]), np.array([[0, 0], [1, 0]])), st.Wall(0, [[1, 0]]), st.Wall(1, [[1, 0]])
        )
        st.eigenfunction(plain, -9.9, digits=20)


def test_the_command_says_and_writes_the_digits_as_text(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)  # names without folders, which could be longer than a line
    Path("string.toml").write_text(STRING)
    files = [Path(name) for name in ("y.csv", "y.json")]
    words = ["mode", "string.toml", "--guess=-9.9", "--digits", 30, "--z", "0.25,0.75", "--points", 3, "--export", files[0]]
    assert cli.main([str(word) for word in [*words, "--json", files[1]]]) == 0
    said = capsys.readouterr().out
    root = "0.707106781186547524400844362104"
    assert f"y(0.25)  {root}" in said
    assert all(len(line) <= 80 for line in said.splitlines())
    document = json.loads(files[1].read_text())
    assert document["z"] == ["0.25", "0.5", "0.75"]
    assert document["fields"]["y"][0]["re"].startswith(root)
    header, first, *_ = files[0].read_text().splitlines()
    assert header == "z,y_re,y_im"
    assert first.startswith(f"0.25,{root}")
    assert cli.main(["mode", "string.toml", "--guess=-9.9", "--digits", "30", "--export", "y.npz"]) == cli.BAD_INPUT


def test_between_two_singular_ends_and_at_the_ends_themselves() -> None:
    """P_2² ~ 1 − x²."""
    f = st.eigenfunction(st.scene("legendre").problem, 6, digits=30)
    assert f.extent == (-1.0, 1.0)
    with mpmath.workdps(50):
        scale = 1 - mpmath.mpf(f.peak[1]) ** 2
        errors = [abs(f(x)["y"] - (1 - mpmath.mpf(x) ** 2) / scale) for x in ("-1", "-0.9999", "-0.5", "0.3", "0.75", "1")]
    assert max(errors) <= f.error <= 1e-30
    with pytest.raises(InputError, match="allowed is z from -1 to 1"):
        f("1.001")


def test_at_the_axis_itself() -> None:
    """J0(jr) and J1(jr): 1 and 0 at r = 0, where the integration does not begin."""
    for order, value in ((0, 1), (1, 0)):
        equation = f"r**2*d(u,2) + r*d(u) - {order}*u - sigma*r**2*u"  # as it is printed
        pipe = st.equations(["u"], [equation], st.Axis(0), st.Conditions(1, ["u"]), variable="r")
        with mpmath.workdps(50):
            j = mpmath.besseljzero(order, 1)
            f = st.eigenfunction(pipe, complex(-(j**2)), digits=25)
            scale = mpmath.besselj(order, j * mpmath.mpf(f.peak[1]))
            errors = [abs(f(r)["u"] - mpmath.besselj(order, j * mpmath.mpf(r)) / scale) for r in ("1e-30", "0.01", "0.2", "0.7")]
            assert max(errors) <= f.error <= 1e-25
            assert abs(f(0)["u"] * scale - value) <= f.error


def test_with_ends_at_infinity_and_beyond_where_the_integration_begins() -> None:
    """tanh sech for the kink's internal mode; ψ_2 of the oscillator, whose coefficients go as powers."""
    kink = st.eigenfunction(st.scene("kink").problem, 1.2247j, digits=25)
    oscillator = st.equations(["y"], ["d(y,2) - (x**2 - sigma)*y"], st.Infinity(), st.Infinity(), variable="x")
    hermite = st.eigenfunction(oscillator, 5.0, digits=25)
    with mpmath.workdps(50):
        root = mpmath.sqrt(2)
        for f, exact, places in (
            (kink, lambda x: mpmath.tanh(x / root) * mpmath.sech(x / root), ("-30", "-3", "0.25", "1", "20")),
            (hermite, lambda x: (4 * x * x - 2) * mpmath.exp(-x * x / 2), ("-3", "0", "2.5")),
        ):
            unknown, place = f.peak
            scale = exact(mpmath.mpf(place))
            assert max(abs(f(x)[unknown] - exact(mpmath.mpf(x)) / scale) for x in places) <= f.error <= 1e-25
    with pytest.raises(InputError, match="allowed is z from -8"):
        hermite(60)


def test_in_layers_it_is_that_of_doubles() -> None:
    """Holmboe's three interfaces: w is continuous, its slope jumps."""
    problem = st.scene("holmboe").problem
    rough = st.eigenfunction(problem, 0.1291922967505368824457 + 0.748773618097320038792j)
    f = st.eigenfunction(problem, rough.mode, digits=20)
    scale = rough(float(f.peak[1]))[f.peak[0]]
    for z in (-5.0, -1.5, -0.5, 0.2, 0.9, 1.4):
        assert abs(complex(f(z)["w"]) - rough(z)["w"] / scale) < 1e-11
    assert f.error <= 1e-20


def test_at_an_axis_where_exponents_are_no_integers() -> None:
    """J_{1/3}(jr) goes as r^(1/3): a place next to the axis has to be known to all its digits, and at the axis it is 0."""
    bessel = st.equations(
        ["y"], ["r**2*d(y,2) + r*d(y) - y/9 + s*r**2*y"], st.Axis(0), st.Conditions(1, ["y"]), eigenvalue="s", variable="r"
    )
    f = st.eigenfunction(bessel, 8.425, digits=25)
    with mpmath.workdps(50):
        order = mpmath.mpf(1) / 3
        j = mpmath.findroot(lambda x: mpmath.besselj(order, x), 2.9025862484169527)
        scale = mpmath.besselj(order, j * mpmath.mpf(f.peak[1]))
        errors = [abs(f(r)["y"] - mpmath.besselj(order, j * mpmath.mpf(r)) / scale) for r in ("1e-30", "1e-5", "0.1", "0.7")]
        assert max(errors) <= f.error <= 1e-25
        assert abs(f(0)["y"]) <= f.error
