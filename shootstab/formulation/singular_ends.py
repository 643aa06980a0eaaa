"""Problems with a regular singular end, or two, or with periodic ends, laid out for the engine."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

import numpy as np

from shootstab.core.errors import InputError
from shootstab.formulation.axis import RegularSpace, starting_distance
from shootstab.formulation.domain import Domain
from shootstab.formulation.gaussian import Gaussian
from shootstab.formulation.regular_singular import regular_singular_end
from shootstab.formulation.state_pencil import StatePencil
from shootstab.problems.beginnings import infinite_beginning
from shootstab.problems.consistent_splitting import EndConditions, consistent_splitting
from shootstab.problems.decaying_space import ConstantSpace, StartingSpace
from shootstab.problems.ends import Infinity, Wall
from shootstab.problems.pencil_function import PencilFunction
from shootstab.problems.subdomains import Subdomain
from shootstab.problems.two_point import TwoPointReduction, limit_of_end

SERIES_LENGTHS = 4.0  # chosen: lengths of the series of the coefficients that stand for the length of an infinite domain
MEETING = 0.5  # chosen: the part of the way to infinity, at most, at which the solutions from both ends meet
PERIODIC_TOLERANCE = 1e-12  # chosen: coefficients at two periodic ends, relative to their size


@dataclass(frozen=True, eq=False)
class SingularEnd:
    """The regular solutions, known at z inside the domain, which the integration leaves in this direction."""

    space: RegularSpace
    z: float
    direction: int
    where: str

    @property
    def reach(self) -> float:
        """How far from the point the integration begins."""
        return self.space.x


def singular_end(system: StatePencil, at: float, direction: int, bounded: list[int], where: str, domain: Domain) -> SingularEnd:
    """Raises InputError where the point is no regular singular one."""
    if domain.given:
        raise InputError(
            f"a regular singular end at {where} asks for coefficients in formulas: {', '.join(domain.given)} are given otherwise"
        )
    end = regular_singular_end(system, Fraction(Gaussian.of(at).re), direction, bounded, where)
    length = domain.right - domain.left
    x = starting_distance(end, length if np.isfinite(length) else SERIES_LENGTHS * end.length, where)
    return SingularEnd(RegularSpace(end, x, where, at), at + direction * x, direction, where)


def between_singular_ends(matrices: PencilFunction, left: Any, right: Any, reference: complex | None) -> TwoPointReduction:
    """The subdomains and the rows at their end. Raises InputError where conditions and solutions that begin at the ends do not fit."""
    size = matrices.size
    end, side = (left, 1) if isinstance(left, SingularEnd) else (right, -1)
    other = right if side > 0 else left
    if isinstance(other, SingularEnd):
        found = [left.space.columns, right.space.columns]
        if sum(found) != size:
            told = f"{found[0]} of {size} solutions are regular at {left.where} and {found[1]} at {right.where}"
            raise InputError(f"{told}: allowed are {size} in all")
        return _meeting(size, [(left.z, left.space), (right.z, right.space)], 0.5 * (left.z + right.z))
    if isinstance(other, Infinity):
        return _towards_infinity(matrices, end, other, side, reference)
    assert isinstance(other, Wall)
    rows = other.matrices(size, "left" if end is right else "right")
    k = end.space.columns
    if len(rows[0]) != k:
        told = f"{k} of {size} solutions are regular at {end.where}, and the other end holds {len(rows[0])} conditions"
        raise InputError(f"{told}: allowed are {k}")
    return TwoPointReduction((Subdomain(0.0, 1.0, end.space),), end.z, other.z, rows)


def _towards_infinity(
    matrices: PencilFunction, end: SingularEnd, other: Infinity, side: int, reference: complex | None
) -> TwoPointReduction:
    """The solutions that are regular at one end and those that decay at infinity, on that side, which meet between."""
    limit = limit_of_end(matrices, other, side)
    given = {} if other.decaying is None else {side: other.decaying}
    splitting = consistent_splitting(EndConditions(matrices.size, {-side: end.space.columns}, {side: limit}, given), reference)
    begun = infinite_beginning(matrices, other, limit, splitting.counts[side], splitting.reference, end.z)
    meeting = end.z + side * min(MEETING * abs(begun.z - end.z), float(np.sqrt(end.reach * abs(begun.z - end.z))))
    ends: list[tuple[float, StartingSpace]] = [(end.z, end.space), (begun.z, begun.space(begun.distance))]
    return _meeting(matrices.size, ends[::side], meeting)


def _meeting(size: int, ends: Sequence[tuple[float, StartingSpace]], middle: float) -> TwoPointReduction:
    """Both sides run from t = 1 to t = 0, where they meet."""
    parts = tuple(Subdomain(middle, z - middle, space, ends=()) for z, space in ends)
    identity = np.eye(size, dtype=np.complex128)
    rows = np.concatenate((identity, -identity), axis=1)
    return TwoPointReduction(parts, 1.0, 0.0, (rows, np.zeros_like(rows)))


def between_periodic_ends(matrices: PencilFunction, left: float, right: float) -> TwoPointReduction:
    """(a, ψ) from (1, 1) at the left end, a = ψ at the right one: det(1 − the monodromy matrix). Raises InputError without a period."""
    n = matrices.size
    for (name, a), b in zip(matrices.at(left).named.items(), matrices.at(right).named.values(), strict=True):
        if np.abs(a - b).max() > PERIODIC_TOLERANCE * max(float(np.abs(a).max()), float(np.abs(b).max())):
            raise InputError(
                f"between periodic ends {name} of the first-order system is not the same at both: allowed are periodic coefficients"
            )
    identity = np.eye(n, dtype=np.complex128)
    rows = np.concatenate((identity, -identity), axis=1)
    part = Subdomain(0.0, 1.0, ConstantSpace(identity), augmented=True)
    return TwoPointReduction((part,), left, right, (rows, np.zeros_like(rows)))
