"""problems/closed_form: ends of any kind of number, and what is no formula for numbers of any kind is named."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

import mpmath
import numpy as np
import pytest

import shootstab as st
from shootstab.core.errors import InputError
from shootstab.problems.closed_form import ClosedProblem, Exact


@dataclass(frozen=True)
class ClosedString:
    """y″ = (σ + V(z)) y with y = 0 at both ends."""

    ends: Callable[[Exact], tuple[Any, Any]]
    V: Callable[[Any], Any] | None = None
    size: int = 2
    decaying: int = 1

    def exact_ends(self, exact: Exact) -> tuple[Any, Any]:
        return self.ends(exact)

    def exact_pencil(self, z: Any, exact: Exact) -> list[Mapping[tuple[int, int], Any]]:
        potential = {} if self.V is None else {(1, 0): self.V(z)}
        return [{(0, 0): 1, (1, 1): 1}, {}, {(0, 1): 1, **potential}, {(1, 0): 1}]

    def exact_far(self, sigma: Any, exact: Exact) -> list[list[Any]]:
        return [[0], [1]]

    def exact_wall(self, exact: Exact) -> tuple[list[list[Any]], list[list[Any]]]:
        return [[1, 0]], [[0, 0]]


ENDS: dict[str, Callable[[Exact], tuple[Any, Any]]] = {
    "exact": lambda exact: (exact(0.1), exact(0.8)),
    "fractions": lambda exact: (Fraction(1, 10), Fraction(4, 5)),
    "mpf": lambda exact: (mpmath.mpf(1) / 10, mpmath.mpf(8) / 10),
    "floats": lambda exact: (0.1, 0.8),
    "int": lambda exact: (exact(0.3), 1),
}


@pytest.mark.parametrize("kind", ENDS)
def test_ends_of_any_kind_of_number(kind: str) -> None:
    """σ = −(π/0.7)² in doubles and in 30 digits, from either end."""
    exact = -((mpmath.mp.pi / (mpmath.mpf(7) / 10)) ** 2)
    problem = ClosedProblem(ClosedString(ENDS[kind]))
    mode = st.refine(problem, -20.0)
    assert abs(mode.sigma - complex(exact)) <= mode.error < 1e-10
    with mpmath.workdps(40):
        exact = -((mpmath.pi / (mpmath.mpf(7) / 10)) ** 2)
        digits = st.refine(problem, -20.0, digits=30)
        tolerance = 1e-14 if kind == "mpf" else 1e-29  # an mpf made with 15 digits has no more
        assert abs(digits.sigma - exact) < tolerance * abs(exact)


def test_functions_of_numpy_are_no_formulas_for_any_number() -> None:
    problem = ClosedProblem(ClosedString(lambda exact: (0, 1), np.cosh))
    assert st.refine(problem, -11.0).converged
    with pytest.raises(InputError, match="exact_pencil") as refusal:
        st.refine(problem, -11.0, digits=30)
    assert "allowed are formulas" in str(refusal.value)
