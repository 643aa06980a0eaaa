"""Where a path leaves the real axis, a pencil that is not analytic is refused, and one that is serves."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
import pytest

import shootstab as st
from shootstab.core.errors import InputError
from shootstab.discriminants.analyticity import require_analytic
from shootstab.discriminants.deformed_path import DeformedPath

PATHS = DeformedPath(0.5, 0.1, 0.08), DeformedPath(0.45, 0.2, -0.15), DeformedPath(0.05, 0.2, 0.1)


def with_coefficient(f: Callable[[complex], Any], place: int) -> st.LinearProblem:
    def pencil(z: complex) -> tuple[np.ndarray, ...]:
        parts = [
            np.eye(2, dtype=complex),
            np.zeros((2, 2), complex),
            np.array([[0, 1], [0, 0]], complex),
            np.array([[0, 0], [1, 0]], complex),
        ]
        parts[place][1, 0] += f(z)
        return tuple(parts)

    return st.problem(2, pencil, st.Wall(0, [[1, 0]]), st.Wall(1, [[1, 0]]))


@pytest.mark.parametrize("place", range(4))
@pytest.mark.parametrize(
    "f",
    [
        lambda z: abs(z - 0.5),
        lambda z: z.real**2,
        lambda z: np.conj(z),
        lambda z: np.interp(np.real(z), [0, 0.4, 0.52, 1], [0, 1, 0.5, 0]),
        lambda z: np.exp(-abs(z)),
        lambda z: 1.0 if np.real(z) > 0.47 else 0.0,
        lambda z: abs(np.cosh(10 * z)) ** -2,
    ],
)
def test_what_is_not_analytic_is_refused_with_the_place(f, place: int) -> None:
    problem = with_coefficient(f, place)
    for path in PATHS[:2]:
        with pytest.raises(InputError, match=rf"not analytic next to z = {path.centre:.6g}"):
            require_analytic(problem, path, problem.mesh(0.0))


@pytest.mark.parametrize(
    "f",
    [
        np.tanh,
        lambda z: np.cosh(10 * (z - 0.5)) ** -2,
        lambda z: 3.0,
        lambda z: z**7 - 2j * z,
        lambda z: np.exp(1j * 40 * z),
        lambda z: 1e-9 * z,
    ],
)
def test_what_is_analytic_passes(f) -> None:
    problem = with_coefficient(f, 2)
    for path in PATHS:
        require_analytic(problem, path, problem.mesh(0.0))


@pytest.mark.parametrize("even", [lambda y: abs(y), lambda y: np.sqrt(y.real**2)])
def test_a_stratified_shear_layer_with_abs_is_no_mode_with_a_bound(even) -> None:
    """A false mode with an error bound of 1e−14 came of it."""
    k, steep = 15.0, 30.0

    def pencil(x: complex) -> tuple[np.ndarray, ...]:
        y = even(steep * (x - 0.5) + 0j)
        s, t = 4 * np.exp(-2 * y) / (1 + np.exp(-2 * y)) ** 2, np.tanh(steep * (x - 0.5))
        a = 1j * k / 3 * t
        bend = -2j * k / 3 * steep**2 * t * s
        C1 = np.diag([0, 1]).astype(complex)
        return np.diag([1, a]), C1, np.array([[0, 1], [k * k * a + bend, 0]]), np.array([[0, 0], [k * k, 0]], complex)

    p = st.problem(2, pencil, st.Wall(0, [[1, 0]]), st.Wall(1, [[1, 0]]), continuum=lambda x: -1j * k / 3 * np.tanh(steep * (x - 0.5)))
    with pytest.raises(InputError, match="not analytic"):
        st.refine(p, guess=0.3)


@dataclass
class OfOnesOwn:
    """A problem that somebody wrote as a class, which compares by value and so has no hash."""

    f: Callable[[complex], Any]

    def pencil(self, z: np.ndarray) -> Any:
        return with_coefficient(self.f, 2).pencil(z)


def test_a_class_of_ones_own_needs_no_hash_and_is_looked_at_as_it_is_now() -> None:
    problem = OfOnesOwn(lambda z: z * z)
    nodes = np.linspace(0.0, 1.0, 9)
    require_analytic(problem, PATHS[0], nodes)  # type: ignore[arg-type]
    problem.f = lambda z: abs(z - 0.5)
    with pytest.raises(InputError, match="not analytic"):
        require_analytic(problem, PATHS[0], nodes)  # type: ignore[arg-type]
