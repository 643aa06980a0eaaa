"""Where an integration begins: at a wall, with the solutions that its rows leave free, or at infinity, with those that decay."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import scipy.linalg

from shootstab.core.errors import InputError
from shootstab.problems.decaying_space import ConstantSpace, DecayingSpace
from shootstab.problems.ends import INFINITIES, WALLS, Infinity, Wall
from shootstab.problems.kato_frame import KatoFrame
from shootstab.problems.pencil_function import PencilFunction
from shootstab.problems.protocol import ComplexArray
from shootstab.problems.splitting import AsymptoticPencil
from shootstab.problems.truncation import Approach, tails, truncation_distance

FARTHER_THAN_ORIGIN = 1.0  # chosen: where a series holds already at the last wall or interface, it begins so far beyond
BEYOND_INTERFACE = 1.01  # chosen: an infinite end begins at the nearest at this multiple of the way to the last interface


@dataclass(frozen=True, eq=False)
class WallBeginning:
    """A wall at z with rows (W0, W1, …), each (m, n)."""

    z: float
    rows: tuple[ComplexArray, ...]
    distance: float = 0.0

    @classmethod
    def of(cls, wall: Wall, side: int, n: int) -> WallBeginning:
        """Raises InputError for rows that are none."""
        return cls(wall.z, wall.matrices(n, WALLS[side]))

    @property
    def holds_sigma(self) -> bool:
        """Whether the free solutions depend on σ, so that the rows are kept as conditions where the subdomain arrives."""
        return any(W.any() for W in self.rows[1:])

    def space(self, distance: float) -> ConstantSpace:
        """The free solutions (n, n−m), or all of Cⁿ where the rows hold σ; the same at any distance."""
        W0 = self.rows[0]
        free = np.eye(W0.shape[1], dtype=np.complex128) if self.holds_sigma else _null_space(W0)
        return ConstantSpace(np.asarray(free, dtype=np.complex128))


@dataclass(frozen=True, eq=False)
class InfiniteBeginning:
    """An end at infinity with its limit, where k solutions decay at σ = reference, cut at a distance from origin."""

    pencil: PencilFunction
    given: Infinity
    limit: AsymptoticPencil
    k: int
    reference: complex
    origin: float
    distance: float

    holds_sigma = False

    @property
    def z(self) -> float:
        """The z at which an infinite end is cut."""
        return self.origin + self.limit.direction * self.distance

    def beyond(self, places: list[float]) -> InfiniteBeginning:
        """Begun beyond all of these points, if it is not. Raises InputError where the user says that it begins before."""
        side = self.limit.direction
        farthest = max((side * (z - self.origin) for z in places), default=0.0)
        if farthest < self.distance:
            return self
        if self.given.start is not None:
            told = f"at {INFINITIES[side]} start = {self.given.start:g}, and an interface lies {farthest:g} from z = {self.origin:g}"
            raise InputError(f"{told}: allowed is a start beyond all interfaces")
        return replace(self, distance=BEYOND_INTERFACE * farthest)

    def space(self, distance: float) -> DecayingSpace:
        """The decaying space, begun at this distance from the origin: of the limit, or of the pencil frozen there."""
        side = self.limit.direction
        z = self.origin + side * distance
        if self.given.expansion is not None:
            frame = KatoFrame(self.limit, self.k, self.reference)
            return DecayingSpace(frame, self.pencil, self.origin, z, None, INFINITIES[side], self.given.expansion)
        frozen = self.given.start is not None and self.given.limit is None
        limit = AsymptoticPencil(self.pencil.at(z), side) if frozen else self.limit
        tail = None if frozen else tails(self.pencil, limit, self.origin, distance)
        return DecayingSpace(KatoFrame(limit, self.k, self.reference, distance), self.pencil, self.origin, z, tail, INFINITIES[side])


def infinite_beginning(
    pencil: PencilFunction, end: Infinity, limit: AsymptoticPencil, k: int, reference: complex, origin: float
) -> InfiniteBeginning:
    """Cut where the coefficients have come to their limit, or where the user says. Raises InputError where that is on the other side."""
    side = limit.direction
    if end.start is None and end.expansion is not None:
        distance = end.expansion.begins(k, reference) - side * origin
    elif end.start is None:
        distance = truncation_distance(Approach(pencil, limit, k, reference, origin), INFINITIES[side])
    else:
        distance = end.start - side * origin
    if distance <= 0.0 and end.start is None:
        distance = BEYOND_INTERFACE * abs(origin) - side * origin + FARTHER_THAN_ORIGIN
    if distance <= 0.0:
        raise InputError(f"at {INFINITIES[side]} start = {end.start:g}: allowed is a |z| beyond {origin:g}")
    return InfiniteBeginning(pencil, end, limit, k, reference, origin, distance)


def _null_space(W0: ComplexArray) -> ComplexArray:
    """The solutions (n, n−m) that rows (m, n) allow; unit vectors where rows are."""
    used = np.flatnonzero((W0 != 0).any(axis=0))
    if len(used) == len(W0):
        return np.delete(np.eye(W0.shape[1], dtype=np.complex128), used, axis=1)
    return np.asarray(scipy.linalg.null_space(W0), dtype=np.complex128)
