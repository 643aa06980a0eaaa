"""The claim of validation/strangers.py in its quick form: problems that others posed, and no answer wrong, lost or untrue."""

from __future__ import annotations

import numpy as np
import pytest
from collocation import Discretization, Fixed
from strangers import CLAIM


@pytest.mark.slow
def test_no_answer_on_problems_that_others_posed_is_wrong_or_lost() -> None:
    assert CLAIM.check(quick=True)


@pytest.mark.parametrize("N", [12, 20])
def test_the_collocation_converges_as_fast_as_polynomials_do(N: int) -> None:
    """y″ = σy, y(0) = 0, y′(1) = 0: σ = −(π/2)²; at degree 12 to 1e-9, at 20 to the last bits of a double."""

    def string(z: float) -> tuple[np.ndarray, np.ndarray]:
        return np.array([[0.0, 1.0], [0.0, 0.0]]), np.array([[0.0, 0.0], [1.0, 0.0]])

    found = Discretization(2, string, Fixed(0, [[1, 0]]), Fixed(1, [[0, 1]]), N=N).near(-2.4)
    assert abs(found + (np.pi / 2) ** 2) < {12: 1e-9, 20: 4e-15}[N]
