"""problems/first_mesh.py: no step of the first mesh steps over what the coefficients do."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import shootstab as st
from shootstab.problems.first_mesh import resolving
from shootstab.problems.linear_problem import FIRST_MESH

WIDTH, CENTRE = 1e-4, 0.4137
BUMP = -23.971925954284  # by collocation on elements at the bump (validation/collocation.py), 14 digits at two resolutions


def between_walls(coefficient: Callable[[float], Any]) -> st.LinearProblem:
    """y″ = (σ + coefficient) y, y = 0 at 0 and 1."""

    def pencil(x: float) -> tuple[Any, Any]:
        return np.array([[0, 1], [coefficient(x), 0]]), np.array([[0, 0], [1.0, 0]])

    return st.problem(2, pencil, st.Wall(0, [[1, 0]]), st.Wall(1, [[1, 0]]))


def bump(x: float) -> float:
    return 20 / WIDTH / math.sqrt(math.pi) * np.exp(-(((x - CENTRE) / WIDTH) ** 2))


@pytest.mark.parametrize("digits", [4, 6, 8, 10])
def test_a_narrow_bump_is_not_stepped_over(digits: int) -> None:
    (verdict,) = st.verify(between_walls(bump), [BUMP], digits=digits, missing="none").verdicts
    assert verdict.verdict == "confirmed"


def test_nodes_are_added_where_five_points_of_a_step_do_not_tell_the_others() -> None:
    nodes = np.linspace(0.0, 1.0, FIRST_MESH)
    problem = between_walls(bump)
    added = np.setdiff1d(resolving(problem.function, problem.reduction.subdomains, nodes), nodes)
    assert 0 < len(added) < 12
    assert np.abs(added - CENTRE).min() < 1e-3
    assert np.abs(added - CENTRE).max() < 1 / FIRST_MESH


@pytest.mark.parametrize("coefficient", [lambda x: 7.0, lambda x: 3 * x, lambda x: np.cos(20 * x), lambda x: np.tanh(10 * (x - 0.5))])
def test_smooth_coefficients_get_none(coefficient: Callable[[float], Any]) -> None:
    nodes = np.linspace(1.0, 0.0, FIRST_MESH)
    problem = between_walls(coefficient)
    assert np.array_equal(resolving(problem.function, problem.reduction.subdomains, nodes), nodes)
