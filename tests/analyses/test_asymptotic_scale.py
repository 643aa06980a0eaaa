"""Where σ rules everywhere: slow parts and slow walls, which a law of growth that holds before them does not know of."""

from __future__ import annotations

import math

import numpy as np
import pytest

import shootstab as st
from shootstab.analyses.asymptotic_scale import asymptotic_scale
from shootstab.analyses.unstable import growth_beyond
from shootstab.core.errors import ConvergenceError

LENGTH = 12.0
STRING = np.array([[0, 0], [1, 0]], complex)


def two_times(epsilon: float) -> st.LinearProblem:
    """y″ = σ y and w″ = (ε σ − 2) k² w on (0, L), k = π/L: one mode grows, at 1/ε."""
    first = (math.pi / LENGTH) ** 2
    D0, D1 = np.zeros((4, 4), complex), np.zeros((4, 4), complex)
    D0[0, 1] = D0[2, 3] = D1[1, 0] = 1.0
    D0[3, 2], D1[3, 2] = -2.0 * first, epsilon * first
    rows = [[1, 0, 0, 0], [0, 0, 1, 0]]
    return st.problem(4, lambda _: (D0, D1), st.Wall(0, rows), st.Wall(LENGTH, rows))


def slow_wall(side: int, slowness: float) -> st.LinearProblem:
    """y″ = σ y on (0, L), y = 0 at one end and (1 − ε σ) y ± 1e−6 y′ = 0 at the other: a growing mode next to 1/ε."""
    D0 = np.array([[0, 1], [0, 0]], complex)
    free, slow = st.Wall(LENGTH, [[1, 0]]), ([[1.0, -side * 1e-6]], [[-slowness, 0.0]])
    if side < 0:
        return st.problem(2, lambda _: (D0, STRING), st.Wall(0, [[1, 0]]), st.Wall(LENGTH, *slow))
    return st.problem(2, lambda _: (D0, STRING), st.Wall(0, *slow), free)


@pytest.mark.parametrize("epsilon", [1e-4, 1e-6, 1e-9])
def test_a_mode_of_a_slow_part_is_never_counted_away(epsilon: float) -> None:
    problem = two_times(epsilon)
    assert asymptotic_scale(problem) >= 1.0 / epsilon
    with pytest.raises(ConvergenceError, match=r"follows its law of growth from .* a part .* feels sigma from|does not follow its law"):
        st.count_unstable(problem)


@pytest.mark.parametrize("epsilon", [0.5, 0.2, 0.05])
def test_a_slow_part_within_reach_is_counted(epsilon: float) -> None:
    """ln D of y alone, 30 √σ, would hide a zero of w from a departure that is measured in |q|."""
    found = st.count_unstable(two_times(epsilon))
    assert found.count == 1
    assert found.radius > 1.0 / epsilon


@pytest.mark.parametrize("side", [-1, 1])
def test_a_wall_that_hardly_feels_sigma(side: int) -> None:
    problem = slow_wall(side, 1e-5)
    assert asymptotic_scale(problem) >= 1e5
    try:
        assert st.count_unstable(problem).count == 1
    except ConvergenceError as error:
        assert "feels sigma from" in str(error)


@pytest.mark.parametrize("name", ["high", "mid", "low", "fig2"])
def test_a_chute_has_no_slow_part(name: str) -> None:
    assert asymptotic_scale(st.scene(name).problem) < 400.0


def test_a_known_scale_is_kept_where_it_serves() -> None:
    problem = two_times(1e-4)
    whole = asymptotic_scale(problem)
    assert asymptotic_scale(problem, whole) == whole
    assert asymptotic_scale(problem, 1.0) == whole


def test_rounding_of_the_conditions_of_a_chute_is_not_taken_for_a_slow_wall() -> None:
    """Components of very different sizes are balanced first: flows of figure 8 seemed to have a slow wall in what rounding left of one."""
    flow = st.chute.steady(far_temperature=1.7473800203733194, e=0.8, e_w=0.8, r=0.6, tan_theta=0.30)
    for kx, ky in ((0.000298932, 0.00298932), (0.000298932, 0.0), (0.0, 0.1)):
        assert asymptotic_scale(st.chute.problem(flow, kx=kx, ky=ky)) < 400.0


def test_where_no_scale_is_found_that_is_said_at_once() -> None:
    """(σ − 5.12) y′ = w, w′ = (σ − 9) y: C is singular at one of the σ at which rates are taken."""
    C0, C1 = np.diag([-0.01 * 8.0**3, 1.0]).astype(complex), np.diag([1.0, 0.0]).astype(complex)
    D0 = np.array([[0, 1], [-9, 0]], complex)
    problem = st.problem(2, lambda z: (C0, C1, D0, STRING), st.Wall(0, [[0, 1]]), st.Wall(1, [[1, 0]]), continuum=False)
    assert asymptotic_scale(problem) == math.inf
    with pytest.raises(ConvergenceError, match=r"no bound on .*: no .sigma. is found from which on sigma rules all rates and conditions"):
        growth_beyond(st.Frame(rtol=1e-6).on(two_times(0.5)), settled=math.inf)
