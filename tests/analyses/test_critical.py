"""analyses/critical.py: the mode that the guess means is followed around a circle of complex α, or the search says that it is not."""

from __future__ import annotations

import numpy as np
import pytest

import shootstab as st


def crossing(reynolds: float, alpha: complex) -> st.LinearProblem:
    """Two strings coupled by α − 1: σ = R − π² ± √(α − 1), with a branch point at α = 1."""
    D0 = np.array([[0, 1, 0, 0], [-reynolds, 0, alpha - 1, 0], [0, 0, 0, 1], [1, 0, -reynolds, 0]])
    D1 = np.zeros((4, 4))
    D1[1, 0] = D1[3, 2] = 1
    rows = [[1, 0, 0, 0], [0, 0, 1, 0]]
    return st.problem(4, lambda z: (D0, D1), st.Wall(0, rows), st.Wall(1, rows))


def hill(reynolds: float, alpha: complex) -> st.LinearProblem:
    """One string: σ = R − π² − (α − 2)²; its first mode becomes neutral at R = π², α = 2, and a second one lies 3π² below."""
    D0, D1 = np.array([[0, 1], [(alpha - 2) ** 2 - reynolds, 0]]), np.array([[0, 0], [1.0, 0]])
    return st.problem(2, lambda z: (D0, D1), st.Wall(0, [[1, 0]]), st.Wall(1, [[1, 0]]))


@pytest.mark.parametrize("guess", [0.1, 0.5 + 0.3j])
def test_an_exact_critical_point(guess: complex) -> None:
    found = st.critical(hill, 10.0, 2.1, guess)
    assert abs(found.reynolds - np.pi**2) <= found.reynolds_error < 1e-8
    assert abs(found.alpha - 2.0) <= found.alpha_error < 1e-8


def test_a_branch_point_within_the_circle_is_named() -> None:
    with pytest.raises(st.ConvergenceError, match=r"is not followed around alpha = 1\.01.*a branch point, is as near"):
        st.critical(crossing, np.pi**2, 1.01, 0.1)


def test_no_step_leaves_what_is_positive() -> None:
    """From far off, where a whole step would take α below 0."""
    found = st.critical(hill, 40.0, 9.0, 40 - np.pi**2 - 49)
    assert (found.reynolds, found.alpha) == pytest.approx((np.pi**2, 2.0), rel=1e-9)
    assert 0.0 <= found.reynolds_error < 1e-8
    assert 0.0 <= found.alpha_error < 1e-8


def test_growth_that_is_least_is_no_critical_point() -> None:
    """σ = R − π² + (α − 2)²: every other wavenumber grows."""
    with pytest.raises(st.ConvergenceError, match=r"the growth rate is 0, and least over the second, not largest"):
        st.critical(lambda R, alpha: hill(R + 2 * (alpha - 2) ** 2, alpha), 10.0, 2.1, 0.14)
