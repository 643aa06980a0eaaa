"""Ends that conditions join: Bloch waves, factors, the eigenvalue in the conditions, and what is refused; every eigenvalue is exact."""

from __future__ import annotations

import cmath
import math
from pathlib import Path
from typing import Any

import mpmath
import numpy as np
import pytest

import shootstab as st
from shootstab.cli.main import main
from shootstab.core.errors import InputError

WAVENUMBER = 0.7
FREE = st.Conditions(0, []), st.Conditions(1, [])
BLOCH = ["right(u) = exp(i*k)*left(u)", "right(d(u)) = exp(i*k)*left(d(u))"]
STRING = ["d(u,2) = sigma*u"]


def bloch() -> Any:
    """σ = −(k + 2πm)²."""
    return st.equations(["u"], STRING, *FREE, coupled=BLOCH, parameters={"k": WAVENUMBER})


def claims(problem: Any, M: int) -> np.ndarray:
    return np.asarray(problem.pseudospectral.spectrum(M).eigenvalues)


@pytest.mark.parametrize("m", [0, 1, -1, 2])
def test_waves_of_bloch(m: int) -> None:
    exact = -((WAVENUMBER + 2 * math.pi * m) ** 2)
    mode = st.refine(bloch(), exact * 1.001)
    assert mode.converged
    assert abs(mode.sigma - exact) <= mode.error < 1e-9
    assert np.abs(claims(bloch(), 30) - exact).min() < 1e-8


def test_waves_of_bloch_are_counted_judged_and_shown() -> None:
    """A region holds as many as there are, and no mode among the claims is missing."""
    values = [-((WAVENUMBER + 2 * math.pi * m) ** 2) for m in (0, -1, 1)]
    assert st.count(bloch(), st.Rectangle(-50 - 1j, 1 + 1j)) == 3
    report = st.verify(bloch(), [*values, -3.0])
    assert [v.verdict for v in report.verdicts] == ["confirmed"] * 3 + ["spurious"]
    assert not report.missing
    assert [mode.sigma.real for mode in st.verify(bloch(), [values[0], values[2]]).missing] == pytest.approx([values[1]])
    shape = st.eigenfunction(bloch(), -0.49)
    z = np.array([0.0, 0.25, 1.0])
    u = shape(z)["u"]
    assert np.abs(u / u[0] - np.exp(1j * WAVENUMBER * z)).max() < 1e-9


def test_bloch_in_many_digits() -> None:
    mode = st.refine(bloch(), -0.5, digits=30)
    with mpmath.workdps(50):
        assert abs(mode.sigma + mpmath.mpf("0.49")) <= mode.error < mpmath.mpf("1e-29")


def test_a_factor_that_is_no_phase() -> None:
    """u(0) = 2 u(1) and the same of u′: u = e^{qz}, q = −ln 2 + 2πim."""
    problem = st.equations(["u"], STRING, *FREE, coupled=["left(u) = 2*right(u)", "left(d(u)) = 2*right(d(u))"])
    exact = (-math.log(2) + 2j * math.pi) ** 2
    mode = st.refine(problem, exact * 1.001)
    assert abs(mode.sigma - exact) <= mode.error < 1e-10
    with mpmath.workdps(40):
        many = st.refine(problem, exact, digits=25)
        assert abs(many.sigma - (-mpmath.log(2) + 2j * mpmath.pi) ** 2) <= many.error < mpmath.mpf("1e-24") * 40
    assert np.abs(claims(problem, 30) - exact).min() < 1e-8


def test_a_condition_at_one_end_beside_a_coupled_one() -> None:
    """u(0) = 0 and u′(0) = 3 u′(1): cos q = 1/3, σ = −q²."""
    problem = st.equations(["u"], STRING, st.Conditions(0, ["u"]), st.Conditions(1, []), coupled=["left(d(u)) = 3*right(d(u))"])
    q = math.acos(1 / 3)
    mode = st.refine(problem, -1.5)
    assert abs(mode.sigma + q * q) <= mode.error < 1e-11
    assert np.abs(claims(problem, 30) + q * q).min() < 1e-9


def test_the_eigenvalue_in_a_coupled_condition() -> None:
    """u(0) = 0 and u′(1) = σ u′(0): cos q = −q², a growing mode among them."""
    problem = st.equations(["u"], STRING, st.Conditions(0, ["u"]), st.Conditions(1, []), coupled=["right(d(u)) = sigma*left(d(u))"])
    found = sorted(claims(problem, 30), key=lambda sigma: abs(sigma))[:2]
    for claim in found:
        mode = st.refine(problem, claim)
        assert abs(mode.sigma - claim) < 1e-7
        assert abs(cmath.cos(cmath.sqrt(-mode.sigma)) - mode.sigma) < 1e-11
    assert {v.verdict for v in st.verify(problem, found).verdicts} == {"confirmed"}


def test_unknowns_that_are_no_states_and_coefficients_that_differ_at_the_ends() -> None:
    """w = (2 + z) y′ with y a wave in ln(2 + z): σ = −(k + 2πm)²/ln²(3/2)."""
    rows = ["right(y) = exp(i*k)*left(y)", "right((2 + z)*d(y)) = exp(i*k)*left(w)"]
    stated = ["w = (2 + z)*d(y)", "(2 + z)*d(w) = sigma*y"]
    problem = st.equations(["y", "w"], stated, *FREE, coupled=rows, parameters={"k": 1})
    exact = -((1 / math.log(1.5)) ** 2)
    mode = st.refine(problem, exact * 1.01)
    assert abs(mode.sigma - exact) <= mode.error < 1e-10
    assert np.abs(claims(problem, 40) - exact).min() < 1e-8


def test_a_period_is_the_case_of_equal_values() -> None:
    """Mathieu's equation between periodic ends, and with both values joined."""
    equation = ["d(y,2) + (sigma - 2*cos(2*pi*z))*y"]
    joined = st.equations(["y"], equation, *FREE, coupled=["left(y) = right(y)", "left(d(y)) = right(d(y))"])
    ring = st.equations(["y"], equation, st.Periodic(0), st.Periodic(1))
    assert st.refine(joined, -0.05).sigma == pytest.approx(st.refine(ring, -0.05).sigma, abs=1e-12)


SCENE = """
[problem]
unknowns = ["u"]
parameters = { k = 0.7 }
equations = ["d(u,2) = sigma*u"]
left = { at = 0 }
right = { at = 1 }
coupled = ["right(u) = exp(i*k)*left(u)", "right(d(u)) = exp(i*k)*left(d(u))"]
"""


def test_a_scene_file(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    scene = tmp_path / "bloch.toml"
    scene.write_text(SCENE, encoding="utf-8")
    assert main(["explain", str(scene)]) == 0
    said = capsys.readouterr().out
    assert "coupled to the other end" in said
    assert "(1)*right(u) = 0" in said
    assert main(["verify", str(scene), "-M", "24", "--missing", "none"]) == 0
    assert "confirmed to 6 digits" in capsys.readouterr().out
    assert main(["refine", str(scene), "--guess=-0.5", "--digits", "20"]) == 0
    assert "-0.49" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("changed", "told"),
    [
        ({"coupled": BLOCH[:1]}, r"0 conditions at the left end, 0 at the right and 1 that couple them: allowed are 2 in all"),
        ({"coupled": ["left(u)", "left(d(u))"]}, r"no condition holds what is at the right end: an initial-value problem"),
        ({"coupled": ["left(u) = right(u)", "2*left(u) = 2*right(u)"]}, r"coupled condition 2 follows from coupled condition 1"),
        ({"coupled": [*BLOCH[:1], "u"]}, r"u stands without an end: allowed are left\(u\) and right\(u\)"),
        ({"coupled": [*BLOCH[:1], "left(u) = z*right(u)"]}, r"z stands without an end"),
        ({"coupled": [*BLOCH[:1], "d(left(u)) = right(u)"]}, r"allowed is left\(d\(f\)\) or right\(d\(f\)\)"),
        ({"coupled": [*BLOCH[:1], "left(right(u))"]}, r"left of what has a side: allowed is one side|right of what has a side"),
        ({"coupled": [*BLOCH[:1], "left(u/z) = right(u)"]}, r"coupled condition 2 is not finite at 0"),
        ({"left": st.Infinity()}, r"coupled conditions join two finite ends"),
        ({"left": st.Periodic(0), "right": st.Periodic(1)}, r"coupled conditions join two finite ends"),
        ({"interfaces": [st.InterfaceConditions(0.5, ["jump(u)", "jump(d(u))"])]}, r"interfaces beside coupled ends: that is not offered"),
        ({"coupled": "left(u)"}, r"coupled = 'left\(u\)': allowed is a list"),
        (
            {"equations": ["d(u,2) = U*sigma*u"], "given": {"U": lambda z, order: 1 + 0 * z}, "coupled": [*BLOCH[:1], "left(U*u)"]},
            r"allowed are formulas",
        ),
    ],
)
def test_what_users_are_told(changed: dict[str, Any], told: str) -> None:
    posed = {"left": FREE[0], "right": FREE[1], "coupled": BLOCH, "parameters": {"k": WAVENUMBER}, "equations": STRING}
    posed |= changed
    with pytest.raises(InputError, match=told):
        st.equations(["u"], posed.pop("equations"), posed.pop("left"), posed.pop("right"), **posed)


def test_a_mode_between_coupled_ends_is_proved() -> None:
    proof = st.prove(bloch(), guess=-0.49)
    assert proof.count == 1 and "E16" in proof.lemmas
