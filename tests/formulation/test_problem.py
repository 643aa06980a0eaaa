"""Problems in equations: published eigenvalues, the continuous spectrum that is found, powers of σ, many digits, mistakes of users."""

from __future__ import annotations

from typing import Any

import mpmath
import numpy as np
import pytest
from equations_written import WRITTEN

import shootstab as st
from shootstab.core.errors import InputError


def posed(name: str, left: Any, right: Any, **changed: Any) -> Any:
    written = {k: v for k, v in WRITTEN[name].items() if k not in ("order", "from", "to")}
    return st.equations(**{**written, "left": left, "right": right, **changed})


def test_plane_poiseuille_flow_in_primitive_variables() -> None:
    """S. A. Orszag, J. Fluid Mech. 50 (1971) 689; more digits from the Orr–Sommerfeld equation (models.gallery.published)."""
    problem = posed("plane Poiseuille flow", st.Conditions(-1, ["u", "v"]), st.Conditions(1, ["u", "v"]))
    c = 0.23752648882047010745 + 0.0037396706229794099322j
    mode = st.refine(problem, guess=-1j * (0.2375 + 0.0037j))
    assert abs(mode.sigma + 1j * c) <= max(mode.error, 1e-16) < 1e-13
    digits = st.refine(problem, guess=mode.sigma, digits=20)
    with mpmath.workdps(30):
        assert abs(digits.sigma - mpmath.mpc("0.0037396706229794099322", "-0.23752648882047010745")) < 3e-20


def test_conditions_may_say_the_same_otherwise() -> None:
    """d(v) = 0 stands for u = 0 by continuity, the stress for the slip."""
    left, right = st.Conditions(-1, ["d(v)", "v"]), st.Conditions(1, ["d(v)/R - i*a*v", "sigma*v"])
    mode = st.refine(posed("plane Poiseuille flow", left, right), guess=-1j * (0.2375 + 0.0037j))
    assert abs(mode.sigma - (0.00373967062297941 - 0.23752648882047j)) < 1e-13


def test_the_continuous_spectrum_of_a_shear_layer_is_found() -> None:
    """A. Michalke, J. Fluid Mech. 19 (1964) 543: 0.1897; σ_c = −i a U."""
    problem = posed("Rayleigh, in primitive variables", st.Infinity(), st.Infinity())
    z = np.linspace(-2, 2, 9) + 0.1j
    assert np.abs(problem.spectrum_inside.curve(z) + 0.4446j * np.tanh(z)).max() < 1e-15
    assert st.refine(problem, guess=0.19).sigma == pytest.approx(st.refine(st.gallery.shear_layer(), guess=0.19).sigma, abs=1e-12)


def test_a_power_of_the_eigenvalue_in_a_condition() -> None:
    """Waves on water of depth 1: ω² = g k tanh(k h)."""
    problem = st.equations(
        ["f"], ["d(f,2) - k**2*f"], st.Conditions(-1, ["d(f)"]), st.Conditions(0, ["sigma**2*f + g*d(f)"]), parameters={"k": 1, "g": 1}
    )
    with mpmath.workdps(45):
        expected = mpmath.sqrt(mpmath.tanh(1))
        mode = st.refine(problem, guess=0.87j, digits=40)
        assert abs(mode.sigma - 1j * expected) < mpmath.mpf(10) ** -40


def test_powers_of_the_eigenvalue_in_the_equations_count_what_is_there() -> None:
    """y″ + σ² y = 0 between walls: σ = ±nπ/2 and nothing else; σ = 0 is no mode."""
    problem = st.equations(["y"], ["d(y,2) + sigma**2*y"], st.Conditions(-1, ["y"]), st.Conditions(1, ["y"]))
    assert st.count(problem, st.Rectangle(-5 - 1j, 5 + 1j)) == 6
    assert abs(st.refine(problem, guess=3.1).sigma - np.pi) < 1e-12
    cubed = st.equations(["y"], ["d(y,2) + sigma**3*y"], st.Conditions(0, ["y"]), st.Conditions(2, ["d(y) - sigma**2*y"]))
    with mpmath.workdps(40):  # k cos 2k = σ² sin 2k, k = σ^{3/2}
        wavenumber = lambda s: mpmath.sqrt(s**3)  # noqa: E731
        root = mpmath.findroot(lambda s: wavenumber(s) * mpmath.cos(2 * wavenumber(s)) - s**2 * mpmath.sin(2 * wavenumber(s)), 1.6)
        mode = st.refine(cubed, guess=complex(root) + 0.001, digits=30)
        assert abs(mode.sigma - root) < 1e-29
    assert cubed.size == 2


def test_spatial_modes_are_those_of_the_temporal_problem() -> None:
    """At the α of a spatial mode the temporal problem has σ = −iω."""
    walls = st.Conditions(-1, ["u", "v"]), st.Conditions(1, ["u", "v"])
    mode = st.refine(posed("plane Poiseuille flow, spatial", *walls), guess=1.0006 - 0.0109j)
    temporal = posed("plane Poiseuille flow", *walls, parameters={"R": 10000, "a": mode.sigma})
    assert abs(st.refine(temporal, guess=-0.2375j).sigma + 0.2375j) < 1e-12


@pytest.mark.parametrize("left", [0, -1])
def test_a_continuous_spectrum_that_passes_through_infinity(left: int) -> None:
    """Couette flow U = z without viscosity, spatially: α = ω/z for all z, which ends, or is two curves, where U vanishes; modes nπi/h."""
    equations = ["i*(a*z - omega)*u + v + i*a*p", "i*(a*z - omega)*v + d(p)", "i*a*u + d(v)"]
    ends = st.Conditions(left, ["v"]), st.Conditions(1, ["v"])
    problem = st.equations(["u", "v", "p"], equations, *ends, parameters={"omega": 0.7}, eigenvalue="a")
    exact = 1j * np.pi / (1 - left)
    mode = st.refine(problem, 1.02 * exact)
    assert abs(mode.sigma - exact) <= mode.error <= 1e-12
    assert st.count(problem, st.Rectangle(-0.5 + 0.5 * exact, 0.5 + 2.5 * exact)) == 2
    # the spectrum is α ≥ 0.7 and, with the point where U = 0 inside, α ≤ −0.7 as well
    verdicts = st.verify(problem, [3.3, 1e3, -3.3, 0.3], missing=None).verdicts
    beyond = "spurious" if left == 0 else "continuum"
    assert [v.verdict for v in verdicts] == ["continuum", "continuum", beyond, "spurious"]
    curves = [sigma for _, sigma in problem.crossings]
    assert len(curves) == 1 - left
    assert all(np.abs(sigma).min() == pytest.approx(0.7, rel=1e-4) for sigma in curves)


def test_functions_in_many_digits() -> None:
    """y_zz − y_z + σ e^{2z} y = 0 is y_ss + σ y = 0 with s = e^z; and every other function agrees between two arithmetics and doubles."""
    problem = st.equations(["y"], ["d(y,2) - d(y) + sigma*exp(2*z)*y"], st.Conditions(0, ["y"]), st.Conditions(1, ["y"]))
    with mpmath.workdps(40):
        expected = (mpmath.pi / (mpmath.e - 1)) ** 2
        assert abs(st.refine(problem, guess=3.34, digits=30).sigma - expected) < 1e-29
    all_of_them = "tanh(z)*sech(z)*sqrt(2+sin(z))*log(3+z)*erf(z)*tan(z/3)*cosh(z)*sinh(i*z)*(1+z)**(1/3)/(2+z)"
    problem = st.equations(
        ["y"], [f"d(y,2) + sigma*y + {all_of_them}*y + exp(i*z)*sqrt(z-2)*y"], st.Conditions(0, ["y"]), st.Conditions(1, ["d(y)"])
    )
    double = st.refine(problem, guess=1.6 - 1.5j)
    from shootstab.analyses.refine_digits import refine_digits

    found = [refine_digits(problem, double.sigma, 25, arithmetic=name).sigma for name in ("flint", "mpmath")]
    assert abs(found[0] - found[1]) < 1e-24
    assert abs(complex(found[0]) - double.sigma) < 1e-12


MISTAKES: tuple[tuple[str, dict[str, Any], str], ...] = (
    (
        "a condition forgotten",
        {"right": st.Conditions(1, ["u"])},
        "2 conditions at the left end and 1 at the right: allowed are 4 in all, .* u, d.u., v, p",
    ),
    (
        "a condition too many",
        {"right": st.Conditions(1, ["u", "v", "d(v)"])},
        "2 conditions at the left end and 3 at the right: allowed are 4",
    ),
    ("a condition twice", {"right": st.Conditions(1, ["v", "2*v"])}, "right condition 2 follows from right condition 1, at z = 1: allowed"),
    (
        "a condition that continuity makes of another",
        {"right": st.Conditions(1, ["u", "d(v)"])},
        r"2 follows from right condition 1 and the equations, by which it is \(-i\)\*u = 0",
    ),
    (
        "a condition that is an equation",
        {"right": st.Conditions(1, ["v", "i*a*u + d(v)"])},
        "right condition 2 says nothing: the equations themselves",
    ),
    (
        "the ends in the wrong order",
        {"left": st.Conditions(1, ["u", "v"]), "right": st.Conditions(-1, ["u", "v"])},
        "the ends lie at z = 1 and -1",
    ),
    ("an end at infinity of a flow that has no limit", {"right": st.Infinity()}, "at .infinity the coefficients have no limit"),
    ("an unknown name", {"where": {}}, "equation 1, column 15, at 'U': unknown name 'U': allowed are u, v, p, R, a, z, sigma"),
    ("a nonlinear term", {"equations": ["sigma*u + u*d(u)", "d(p)", "d(v)"]}, "equation 1 is not linear: it holds u.d.u."),
    ("a term without an unknown", {"equations": ["sigma*u + 1", "d(p)", "d(v)"]}, "equation 1 holds the term 1 without an unknown"),
    ("an equation forgotten", {"equations": ["d(u) + v", "d(p)"]}, "2 equations for 3 unknowns, u, v, p"),
    ("an unknown that no equation holds", {"equations": ["d(u) + v", "d(v)", "u"]}, "no equation holds the unknown p"),
    (
        "a singular point inside",
        {"equations": ["z*d(u,2) + sigma*u", "d(v) - p", "d(p) - v"]},
        "the order of the equations changes at z = .*, where -?z vanishes, or has a pole, that multiplies d.u,2. in equation 1: allowed",
    ),
    ("a condition with an unknown name", {"left": st.Conditions(-1, ["u", "w"])}, "left condition 2, column 1, at 'w': unknown name 'w'"),
    ("an end without a place", {"left": {"conditions": ["u"]}}, "left has conditions: allowed is .at = ..., conditions = "),
    ("an end that is text", {"left": "u = 0"}, "left = 'u = 0': allowed is"),
    ("a parameter that is no number", {"parameters": {"R": "10000", "a": 1}}, "'10000' is no finite number"),
    ("conditions that are no list", {"left": st.Conditions(-1, "u")}, "left: conditions = 'u': allowed is a list"),
)


@pytest.mark.parametrize(("what", "changed", "told"), MISTAKES, ids=[m[0] for m in MISTAKES])
def test_what_users_are_told(what: str, changed: dict[str, Any], told: str) -> None:
    walls = {"left": st.Conditions(-1, ["u", "v"]), "right": st.Conditions(1, ["u", "v"])}
    with pytest.raises(InputError, match=told):
        posed("plane Poiseuille flow", **{**walls, **changed})


def test_an_initial_value_operator_has_no_eigenvalues() -> None:
    with pytest.raises(InputError, match=r"all 1 conditions stand at one end: an initial-value problem, .* it has no eigenvalues"):
        st.equations(["u"], ["d(u) - sigma*u"], st.Conditions(0, ["u"]), st.Conditions(1, []))


def test_functions_that_are_given_for_real_arrays() -> None:
    """U = 1 − z² as a table would give it: the same mode, and many digits are refused."""

    def U(z: Any, order: int) -> Any:
        assert isinstance(z, np.ndarray)
        return (1 - z**2, -2 * z, np.full_like(z, -2.0))[order] if order < 3 else np.zeros_like(z)

    walls = st.Conditions(-1, ["u", "v"]), st.Conditions(1, ["u", "v"])
    problem = posed("plane Poiseuille flow", *walls, where={}, given={"U": U})
    assert abs(st.refine(problem, guess=-1j * (0.2375 + 0.0037j)).sigma - (0.00373967062297941 - 0.23752648882047j)) < 1e-13
    with pytest.raises(InputError, match="more than 12 digits"):
        st.refine(problem, guess=-0.2375j, digits=20)
