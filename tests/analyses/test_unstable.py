"""Where the half-plane of growing modes cannot be counted, that is said before long."""

from __future__ import annotations

import numpy as np
import pytest

import shootstab as st
from shootstab.analyses.unstable import bound
from shootstab.core.errors import ConvergenceError
from shootstab.discriminants.continuation import Undecidable
from shootstab.discriminants.frame import Frame


def test_waves_follow_no_law_of_diffusion_and_little_work_is_spent_on_it() -> None:
    """y′ = σ w, w′ = σ y: ln D grows with σ and not with its root, and no bound is made up."""
    D0, D1 = np.zeros((2, 2), complex), np.array([[0, 1], [1, 0]], complex)
    problem = st.problem(2, lambda _: (D0, D1), st.Wall(0, [[1, 0]]), st.Wall(1, [[1, 0]]))
    D = Frame(rtol=1e-8).on(problem)
    with pytest.raises(ConvergenceError, match=r"no bound on .* does not follow its law of growth.* in a region that is named"):
        bound(D)
    with pytest.raises(ConvergenceError, match="no bound"):
        st.count_unstable(problem)


def test_an_arc_that_ends_on_the_continuous_spectrum_is_followed_by_others_farther_out() -> None:
    """The stratified flow U = z has σ = -ikz, up to |σ| = k, as its continuous spectrum: there D does not exist."""
    stratified = ["(sigma + i*k*z)*u + w + i*k*p", "(sigma + i*k*z)*w + d(p) - b", "i*k*u + d(w)", "(sigma + i*k*z)*b + J*w"]
    ends = st.Conditions(0, ["w"]), st.Conditions(1, ["w"])
    D = Frame(rtol=1e-6).on(st.equations(["u", "w", "p", "b"], stratified, *ends, parameters={"k": 0.5, "J": 5}))
    with pytest.raises(ConvergenceError, match=r"no step is short enough at sigma = .* next to z = 0\.02"):
        D.at(-0.01j)
    assert bound(D)[0] > 0.5


def test_an_essential_spectrum_that_grows_is_refused_at_once() -> None:
    """y″ = (σ − 1/2 − 2 sech² z) y: essential spectrum up to 1/2, and a mode at 3/2."""

    def pencil(z: float) -> tuple[np.ndarray, np.ndarray]:
        return np.array([[0, 1], [-0.5 - 2 / np.cosh(z) ** 2, 0]], complex), np.array([[0, 0], [1, 0]], complex)

    problem = st.problem(2, pencil, st.Infinity(), st.Infinity())
    with pytest.raises(Undecidable, match=r"reaches Re sigma = 0\.5, right of the floor 1\.0e-08"):
        st.count_unstable(problem)


def test_growing_modes_of_a_string_with_a_spring() -> None:
    """y″ = (σ − 50) y on (0, 1): 50 − (kπ)² is positive twice, and the bound lies beyond both."""
    D0, D1 = np.array([[0, 1], [-50, 0]], complex), np.array([[0, 0], [1, 0]], complex)
    found = st.count_unstable(st.problem(2, lambda _: (D0, D1), st.Wall(0, [[1, 0]]), st.Wall(1, [[1, 0]])))
    assert found.count == 2
    assert found.radius > 50 - np.pi**2
