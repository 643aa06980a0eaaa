"""discriminants/meshing.py: local errors that are rounding do not fall with the step, and are no reason to refuse."""

from __future__ import annotations

from typing import Any

import numpy as np

import shootstab as st
from shootstab.discriminants.frame import Frame

SIGMA = np.array([[0.0, 0.0], [1.0, 0.0]])


def strings_in_other_equations(z: float) -> tuple[Any, Any, Any, Any]:
    """y″ = σ y and a component that vanishes, the equations combined so that sigma stands in several rows of C and D."""
    S = np.array([[2.0, 0.3 * z, 0.1], [0, 1, 0.4], [0.2, 0, 1]])
    N = np.array([[0, 0, 1.0], [0, 0, -0.5], [0, 0, 0]])
    D0, D1 = np.array([[0, 1.0, 0], [0, 0, 0], [0, 0, 1]]), np.array([[0, 0, 0], [1.0, 0, 0], [0, 0, 0]])
    return S, S @ N, S @ D0, S @ (D1 + N)


def test_a_row_that_is_rounding_does_not_ask_for_shorter_steps() -> None:
    problem = st.problem(3, strings_in_other_equations, st.Wall(0, [[1, 0, 0], [0, 0, 1]]), st.Wall(1, [[1, 0, 0]]))
    mode = st.refine(problem, -9.85)
    assert mode.converged
    assert abs(mode.sigma + np.pi**2) <= mode.error < 1e-10
    assert Frame(rtol=1e-11).on(problem).at(mode.sigma).steps < 2000


def test_rounding_of_a_coefficient_is_in_the_bound() -> None:
    def pencil(z: float) -> tuple[Any, Any]:  # (1 + z) − z is 1 to rounding: the modes are −1 − n²π²
        return np.array([[0, 1], [(1e3 + z) - z - 1e3 + 1, 0]]), SIGMA

    problem = st.problem(2, pencil, st.Wall(0, [[1, 0]]), st.Wall(1, [[1, 0]]))
    mode = st.refine(problem, -10.85)
    assert mode.converged
    assert abs(mode.sigma + 1 + np.pi**2) <= mode.error < 1e-9
