"""Interfaces that a subdomain runs across: where ψ(z+) = J ψ(z−) with a constant J, the solution is carried on in ψ = T φ.

φ is continuous, T the product of the J on the way, constant between two interfaces: C T φ′ = D T φ, multiplied by T⁻¹. So the system stays
as small as it is between walls, however many layers there are.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from shootstab.problems.ends import Interface
from shootstab.problems.protocol import ComplexArray, Pencil

WELL_CONDITIONED = 1e3  # chosen: largest entry of |T⁻¹||T|, by which the rounding of the system may grow; 1 for any scales of components


@dataclass(frozen=True, eq=False)
class Crossed:
    """places (K,) in the order in which they are passed, to larger z if direction is 1; factors T and inverses (K + 1, n, n)."""

    places: NDArray[np.float64]
    direction: float
    factors: ComplexArray
    inverses: ComplexArray

    @classmethod
    def on_the_way(cls, interfaces: Sequence[Interface], low: float, high: float, direction: float, n: int) -> Crossed | None:
        """The interfaces between two points; None if there are none. T is the identity where the way begins."""
        passed = sorted((joint for joint in interfaces if low < joint.z < high), key=lambda joint: direction * joint.z)
        if not passed:
            return None
        factors: list[ComplexArray] = [np.eye(n, dtype=np.complex128)]
        for joint in passed:
            M = joint.matrices(n)[0]
            before, behind = (M[:, :n], M[:, n:]) if direction > 0.0 else (M[:, n:], M[:, :n])
            factors.append(np.asarray(-np.linalg.solve(behind, before @ factors[-1])))
        T = np.array(factors)
        return cls(np.array([joint.z for joint in passed]), direction, T, np.asarray(np.linalg.inv(T)))

    @property
    def well_conditioned(self) -> bool:
        """Whether nothing is lost by the change of variables."""
        return bool((np.abs(self.inverses) @ np.abs(self.factors)).max() <= WELL_CONDITIONED)

    @property
    def arrival(self) -> ComplexArray:
        """T (n, n) where the way ends."""
        return np.asarray(self.factors[-1])

    def changed(self, pencil: Pencil, z: ComplexArray) -> Pencil:
        """The pencil at z (m,) for φ."""
        identity = np.eye(self.factors.shape[1])
        if (self.factors == identity).all():
            return pencil
        passed = self._passed(z)
        T, inverse = self.factors[passed], self.inverses[passed]
        D = [inverse @ M @ T for M in pencil.D]
        if (identity == pencil.C[0]).all() and not any(M.any() for M in pencil.C[1:]):
            return Pencil.of(list(pencil.C), D)
        return Pencil.of([inverse @ M @ T for M in pencil.C], D)

    def solution(self, states: ComplexArray, z: ComplexArray) -> ComplexArray:
        """ψ = T φ of states φ (m, n) at z (m,); at an interface on the side that is come from."""
        return np.asarray(np.einsum("mij,mj->mi", self.factors[self._passed(z)], states))

    def left_solution(self, rows: ComplexArray, z: ComplexArray) -> ComplexArray:
        """y (m, n) of the pencil of ψ at z (m,), from rows y T (m, n) of the pencil of φ multiplied by T⁻¹."""
        return np.asarray(np.einsum("mi,mij->mj", rows, self.inverses[self._passed(z)]))

    def _passed(self, z: ComplexArray) -> NDArray[np.int64]:
        """How many interfaces (m,) lie behind z (m,)."""
        return np.asarray((self.direction * (z.real[:, None] - self.places) > 0.0).sum(axis=1))


def can_be_crossed(joint: Interface, n: int) -> bool:
    """Whether an interface gives ψ on either side from the other, the same for every σ."""
    M0, *moving = joint.matrices(n)
    if any(M.any() for M in moving):
        return False
    sizes = np.abs(M0).max(axis=1, keepdims=True)
    sides = M0[:, :n] / sizes, M0[:, n:] / sizes
    return all(np.linalg.matrix_rank(side) == n for side in sides)
