"""The candidate spectrum of the equations as they stand: published eigenvalues, and its independence of the reduction."""

from __future__ import annotations

import numpy as np
import pytest
from equations_written import WRITTEN
from test_floors import reachable

import shootstab as st
from shootstab.formulation.problem import EquationProblem


def posed(name: str, left: list[str], right: list[str], low: float = -1.0, high: float = 1.0) -> EquationProblem:
    written = {k: v for k, v in WRITTEN[name].items() if k not in ("order", "from", "to")}
    return st.equations(**written, left=st.Conditions(low, left), right=st.Conditions(high, right))


def test_it_shares_nothing_with_the_reduction() -> None:
    """Formulas, names and conditions as the user stated them are common, and the solution of a base flow; what is derived is not."""
    twin = reachable("shootstab.formulation.equation_collocation", beside="shootstab.formulation.base_")
    derived = ("reduction", "first_order", "linear_algebra", "state_pencil", "continuous_spectrum", "digits", "problem")
    assert not any(name == f"shootstab.formulation.{module}" for name in twin for module in derived)
    assert not any(name.startswith(("shootstab.discriminants", "shootstab.kernels", "shootstab.multiprecision")) for name in twin)


def test_plane_poiseuille_flow_as_it_stands() -> None:
    """Orszag 1971, in u, v and p: one coefficient fewer for the pressure, one point more for continuity."""
    twin = posed("plane Poiseuille flow", ["u", "v"], ["u", "v"]).pseudospectral
    assert twin is not None
    assert (twin.d, twin.c) == ((2, 2, 1), (0, 0, 1))
    assert abs(twin.spectrum(80).eigenvalues[0] - (0.0037396706229794 - 0.2375264888204701j)) < 1e-11


def test_convergence_is_spectral() -> None:
    """Eigenvalues −(nπ/2)²: the error falls faster than any power of N."""
    twin = st.equations(["y"], ["d(y,2) - sigma*y"], st.Conditions(-1, ["y"]), st.Conditions(1, ["y"])).pseudospectral
    assert twin is not None
    errors = [np.abs(twin.spectrum(N, filtered=False).raw + (5 * np.pi / 2) ** 2).min() for N in (12, 16, 20)]
    assert errors[1] < 1e-3 * errors[0]
    assert errors[2] < 1e-3 * errors[1]


def test_powers_of_the_eigenvalue() -> None:
    """y″ + σ² y = 0 has ±nπ/2, and σ = 0 is none; spatial modes of plane Poiseuille flow are those of the reduced problem."""
    twin = st.equations(["y"], ["d(y,2) + sigma**2*y"], st.Conditions(-1, ["y"]), st.Conditions(1, ["y"])).pseudospectral
    assert twin is not None
    found = twin.spectrum(30).eigenvalues
    near = np.sort(found[np.abs(found) < 5].real)
    assert near == pytest.approx(np.pi / 2 * np.array([-3, -2, -1, 1, 2, 3]), abs=1e-10)
    spatial = posed("plane Poiseuille flow, spatial", ["u", "v"], ["u", "v"])
    assert spatial.pseudospectral is not None
    mode = st.refine(spatial, guess=1.0006 - 0.0109j)
    assert np.abs(spatial.pseudospectral.spectrum(60, filtered=False).raw - mode.sigma).min() < 1e-9


def test_two_derivations_agree_on_taylor_couette_flow() -> None:
    """Order 6 in u, v, w, p, with the axis outside: every claim of the collocation is a mode of the reduction."""
    problem = posed("Taylor-Couette flow", ["u", "v", "w"], ["u", "v", "w"], 1.0, 2.0)
    report = st.verify(problem, problem.pseudospectral.spectrum(40).eigenvalues[:3].tolist())  # type: ignore[union-attr]
    assert [v.verdict for v in report.verdicts] == ["confirmed"] * 3


def test_none_where_an_end_is_at_infinity() -> None:
    written = {k: v for k, v in WRITTEN["Rayleigh, in primitive variables"].items() if k != "order"}
    problem = st.equations(**written, left=st.Infinity(), right=st.Infinity())
    assert problem.pseudospectral is None
