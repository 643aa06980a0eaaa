"""Coefficients rational in the eigenvalue: the same modes as without denominators, exactly known ones, and what is said of the zeros."""

from __future__ import annotations

from typing import Any

import mpmath
import numpy as np
import pytest

import shootstab as st
from shootstab.by_name import problem_of
from shootstab.core.errors import InputError
from shootstab.models.catalogue.scene_files import scene_files

WALLS = st.Conditions(0, ["y"]), st.Conditions(1, ["y"])


def test_a_rod_of_a_maxwell_material() -> None:
    """y″/(1 + Wσ) = σ y between walls: σ (1 + Wσ) = −n²π²; the zero of the denominator is no eigenvalue, and none is counted there."""
    rod = st.equations(["y"], ["d(y,2)/(1 + W*sigma) = sigma*y"], *WALLS, parameters={"W": 2})
    exact = np.roots([2, 1, np.pi**2])
    for root in exact:
        assert abs(st.refine(rod, root * 1.01).sigma - root) < 1e-12
    assert st.count(rod, st.Rectangle(-1 - 3j, 1 + 3j)) == 2
    twin = rod.pseudospectral.spectrum(30).eigenvalues
    assert all(np.abs(twin - root).min() < 1e-9 for root in exact)
    told = dict(rod.explanation)
    assert told["denominator"].startswith("equation 1 times 1 + 2*sigma; at sigma = -1/2 what is written has no meaning")


def test_denominators_in_conditions_and_powers_of_the_eigenvalue() -> None:
    """k² = σ + σ/(1 + 2σ), sin k + k cos k/σ = 0, to thirty digits."""
    problem = st.equations(["y"], ["d(y,2) + sigma*(1 + 1/(1 + 2*sigma))*y"], WALLS[0], st.Conditions(1, ["y + sigma**-1*d(y)"]))
    with mpmath.workdps(40):
        k = lambda s: mpmath.sqrt(s + s / (1 + 2 * s))  # noqa: E731
        root = mpmath.findroot(lambda s: mpmath.sin(k(s)) + k(s) * mpmath.cos(k(s)) / s, 7.2)
        assert abs(st.refine(problem, 7.2, digits=30).sigma - root) < mpmath.mpf(10) ** -28
    held = [text.split(";")[0] for heading, text in problem.explanation if heading == "denominator"]
    assert held == ["equation 1 times 1 + 2*sigma", "right condition 1 times sigma"]


def test_a_denominator_that_cancels_is_none_of_the_problem() -> None:
    """(σ + 1)² y″/(σ + 1) = (σ + 1)(σ − 3) y has the factor σ + 1 in all of its terms: it is divided out again, and σ = −1 is no mode."""
    equation = "G*(sigma + 1)**2*d(y,2) = (sigma + 1)*(sigma - 3)*y"
    problem = st.equations(["y"], [equation], *WALLS, where={"G": "1/(1 + sigma)"})
    assert problem.first_order.degree == 1
    assert st.count(problem, st.Disc(-1, 0.5)) == 0
    assert abs(st.refine(problem, -7).sigma - (3 - np.pi**2)) < 1e-12


def test_denominators_within_denominators() -> None:
    """1/(1 + 1/(1 + σ)) = (1 + σ)/(2 + σ)."""
    nested, plain = (
        st.equations(["y"], [f"d(y,2) = sigma*{factor}*y"], *WALLS) for factor in ("1/(1 + 1/(1 + sigma))", "(1 + sigma)/(2 + sigma)")
    )
    assert abs(st.refine(nested, -10).sigma - st.refine(plain, -10).sigma) < 1e-12


LIQUID: dict[str, Any] = {
    "unknowns": ["u", "w", "p"],
    "equations": [
        "i*k*A + d(B) + b*(d(u,2) - k**2*u) = i*k*p",
        "i*k*B + d(C) + b*(d(w,2) - k**2*w) = d(p)",
        "i*k*u + d(w) = 0",
    ],
    "left": st.Conditions(0, ["u", "w"]),
    "right": st.Conditions(1, ["u", "w"]),
    "where": {
        "g": "1 - b",
        "s": "1 + W*(sigma + i*k*z)",
        "C": "g*(2*i*k*W*w + 2*d(w))/s",
        "B": "(W*(2*i*k*W*g*w + C) + g*(d(u) + i*k*w))/s",
        "A": "(2*W*(2*i*k*W*g*u + g*d(u) + B) + 2*i*k*g*u)/s",
    },
}


def test_an_oldroyd_liquid_with_its_stresses_eliminated() -> None:
    """Plane Couette flow. Without a solvent it is Maxwell's, whose modes are known in closed form; with one the collocation agrees. The
    stresses are singular on σ = −1/W − ikz, the highest derivatives on σ = −1/(bW) − ikz too: H. J. Wilson, M. Renardy & Y. Renardy,
    J. Non-Newtonian Fluid Mech. 80 (1999) 251.
    """
    maxwell = st.equations(**LIQUID, parameters={"k": 1, "W": 2, "b": 0})
    assert maxwell.first_order.order == 4
    value = scene_files()["maxwell-couette"].published.sigma
    assert abs(st.refine(maxwell, value * 1.0001).sigma - value) < 1e-13
    oldroyd = st.equations(**LIQUID, parameters={"k": 1, "W": 2, "b": 0.25})
    mode = st.refine(oldroyd, value)
    assert mode.converged
    assert abs(oldroyd.pseudospectral.ways["qz"](60, mode.sigma)[0] - mode.sigma) < 1e-11
    z = np.array([0.2, 0.7])
    curves = np.sort_complex(np.array(oldroyd.spectrum_inside.branches(z)).T)
    assert np.abs(curves - np.array([[-2 - 1j * x, -0.5 - 1j * x, -0.5 - 1j * x] for x in z])).max() < 1e-13
    told = dict(oldroyd.explanation)["continuous spectrum inside"]
    assert "sigma = -1/2 - i*z" in told
    assert "sigma = -i*z - 2" in told


@pytest.mark.parametrize(
    ("equation", "told"),
    [
        ("d(y,2)/y + sigma*y", "a division by an unknown: the equation is not linear"),
        ("d(y,2) + y**-1*sigma", "a power of an unknown: allowed are natural ones up to 64"),
        ("d(y,2) + sigma**(1/2)*y", "a power of the eigenvalue: allowed are whole ones up to 64"),
        ("d(y,2) + exp(1/sigma)*y", "exp of an unknown or of the eigenvalue: the problem is not linear, or not rational in it"),
    ],
)
def test_what_is_not_rational_is_refused(equation: str, told: str) -> None:
    with pytest.raises(InputError, match=told.replace("(", r"\(").replace("**", r"\*\*")):
        st.equations(["y"], [equation], *WALLS)


def test_sympy_expressions_may_be_rational_in_the_eigenvalue() -> None:
    import sympy as sp

    z, sigma = sp.symbols("z sigma")
    y = sp.Function("y")(z)
    rod = st.equations(["y"], [sp.diff(y, z, 2) / (1 + 2 * sigma) - sigma * y], *WALLS)
    root = np.roots([2, 1, np.pi**2])[0]
    assert abs(st.refine(rod, root * 1.01).sigma - root) < 1e-12


def test_oldroyds_liquid_has_the_continuous_spectra_of_both_its_times() -> None:
    """−1/W − ikz of the relaxation, −1/(βW) − ikz of the retardation: Wilson, Renardy & Renardy, as the scene cites them. For β → 0 the
    mode is that of Maxwell's liquid, to the first order in β.
    """
    liquid = problem_of("oldroyd-couette")
    assert dict(liquid.explanation)["continuous spectrum inside"] == "sigma = -1/2 - i*z and sigma = -i*z - 5, z along the domain"
    maxwell = complex(-0.4454759289333397, -0.8246383230532390)
    off = [st.refine(liquid.with_parameters({"beta": beta}), maxwell).sigma - maxwell for beta in (2e-4, 1e-4)]
    assert abs(off[0] / off[1] - 2) < 1e-3
