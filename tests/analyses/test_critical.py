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


def two_streams(V: float, k: complex) -> st.LinearProblem:
    """Kelvin and Helmholtz between half-planes, with surface tension: neutral below V² = (ρ1 + ρ2)/(ρ1 ρ2) · 2 (g (ρ1 − ρ2) S)^½."""
    rows = [
        "before(sigma + i*k*U)*h = before(d(f))",
        "behind(sigma + i*k*U)*h = behind(d(f))",
        "jump(rho*(sigma + i*k*U)*f) = (S*k**2 - g*jump(rho))*h",
    ]
    return st.equations(
        ["f"],
        ["d(f,2) - k**2*f = 0"],
        st.Infinity(),
        st.Infinity(),
        interfaces=[st.InterfaceConditions(0, rows, ["h"])],
        parameters={"k": k, "g": 1, "S": 0.1, "rho": [1, 0.5], "V": V},
        where={"U": [0, "V"]},
    )


@pytest.mark.parametrize(("V", "guess"), [(1.1, -0.5j), (1.3, 0.4 - 0.9j)])
def test_growth_that_begins_where_two_neutral_modes_meet(V: float, guess: complex) -> None:
    """From below, where both are neutral, and from above, where one grows and its mirror image decays; k = (g (ρ1 − ρ2)/S)^½."""
    found = st.critical(two_streams, V, 2.0, guess)
    assert abs(found.reynolds - np.sqrt(6 * np.sqrt(0.05))) <= found.reynolds_error < 1e-9
    assert abs(found.alpha - np.sqrt(5)) <= found.alpha_error < 1e-8
    assert abs(found.sigma + 1j * np.sqrt(5) * np.sqrt(6 * np.sqrt(0.05)) / 3) < 1e-8


def test_a_search_that_leads_nowhere_ends_before_long() -> None:
    """σ = 1 + R − (α − 2)² is above 0 for every R above 0."""
    with pytest.raises(st.ConvergenceError, match=r"7 steps in turn would change a parameter by more than half.*allowed are a guess"):
        st.critical(lambda R, alpha: hill(np.pi**2 + 1 + R, alpha), 2.0, 2.1, 3.0)


def test_a_neutral_mode_that_meets_none() -> None:
    """A string: σ² = −(π² + α² R), with no growth at any parameters; its mirror image is the next mode, which it does not meet."""

    def string(R: float, alpha: complex) -> st.LinearProblem:
        return st.equations(
            ["u"],
            ["sigma**2*u = d(u,2) - R*a**2*u"],
            st.Conditions(0, ["u"]),
            st.Conditions(1, ["u"]),
            parameters={"R": R, "a": alpha},
        )

    with pytest.raises(st.ConvergenceError, match=r"neither grows nor decays|no critical point found|not told apart|not followed"):
        st.critical(string, 1.0, 1.0, 3.3j)
