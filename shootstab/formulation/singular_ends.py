"""Problems with a regular singular end, or two, or with periodic ends, laid out for the engine."""

from __future__ import annotations

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
from shootstab.problems.decaying_space import ConstantSpace
from shootstab.problems.ends import Wall
from shootstab.problems.pencil_function import PencilFunction
from shootstab.problems.subdomains import Subdomain
from shootstab.problems.two_point import TwoPointReduction

PERIODIC_TOLERANCE = 1e-12  # chosen: coefficients at two periodic ends, relative to their size


@dataclass(frozen=True, eq=False)
class SingularEnd:
    """The regular solutions, known at z inside the domain, which the integration leaves in this direction."""

    space: RegularSpace
    z: float
    direction: int
    where: str


def singular_end(system: StatePencil, at: float, direction: int, bounded: list[int], where: str, domain: Domain) -> SingularEnd:
    """Raises InputError where the point is no regular singular one, or the domain has no other end."""
    length = domain.right - domain.left
    if not np.isfinite(length):
        raise InputError(
            f"a regular singular end at {where} and another at infinity: that is not offered; allowed is Conditions or Axis there"
        )
    if domain.given:
        raise InputError(
            f"a regular singular end at {where} asks for coefficients in formulas: {', '.join(domain.given)} are given otherwise"
        )
    end = regular_singular_end(system, Fraction(Gaussian.of(at).re), direction, bounded, where)
    x = starting_distance(end, length, where)
    return SingularEnd(RegularSpace(end, x, where), at + direction * x, direction, where)


def between_singular_ends(size: int, left: Any, right: Any) -> TwoPointReduction:
    """The subdomains and the rows at their end. Raises InputError where conditions and regular solutions do not fit."""
    if isinstance(left, SingularEnd) and isinstance(right, SingularEnd):
        return _meeting(size, left, right)
    end, wall = (left, right) if isinstance(left, SingularEnd) else (right, left)
    assert isinstance(wall, Wall)
    rows = wall.matrices(size, "left" if end is right else "right")
    k = end.space.columns
    if len(rows[0]) != k:
        told = f"{k} of {size} solutions are regular at {end.where}, and the other end holds {len(rows[0])} conditions"
        raise InputError(f"{told}: allowed are {k}")
    return TwoPointReduction((Subdomain(0.0, 1.0, end.space),), end.z, wall.z, rows)


def _meeting(size: int, left: SingularEnd, right: SingularEnd) -> TwoPointReduction:
    """Both sides run from t = 1 to t = 0, where they meet."""
    found = [left.space.columns, right.space.columns]
    if sum(found) != size:
        told = f"{found[0]} of {size} solutions are regular at {left.where} and {found[1]} at {right.where}"
        raise InputError(f"{told}: allowed are {size} in all")
    middle = 0.5 * (left.z + right.z)
    parts = tuple(Subdomain(middle, end.z - middle, end.space, ends=()) for end in (left, right))
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
