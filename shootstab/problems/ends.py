"""What holds at the ends of a problem, and at points inside it where its coefficients or its solutions jump."""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from shootstab.core import polynomial
from shootstab.core.errors import InputError, shortened
from shootstab.core.given import is_real
from shootstab.problems.expansion import AsymptoticSeries
from shootstab.problems.protocol import GENERIC_SIGMA, ComplexArray

WALLS = {-1: "left", 1: "right"}  # words for the sides
INFINITIES = {-1: "-infinity", 1: "+infinity"}


@dataclass(frozen=True, eq=False)
class Wall:
    """A finite end at z with m conditions (rows + σ moving) ψ = 0; rows and moving are (m, n), or moving (q, m, n) for σ, …, σ^q.

    approximates is a singular point, as r = 0 of a pipe, in place of which the wall stands next to it at z = ε with rows that hold there in
    the limit. Every mode then errs by what the rest of the way does. It is measured, with the wall twice as far from the point, and is
    a part of the bound on each mode (far_field), as long as it falls at least as fast as the distance: a logarithm does not.
    """

    z: float
    rows: ArrayLike
    moving: ArrayLike | None = None
    approximates: float | None = None

    @property
    def twice_as_far(self) -> Wall:
        """The same wall at twice the distance from the point that it approximates; itself if there is none."""
        return self if self.approximates is None else replace(self, z=2.0 * self.z - self.approximates)

    def require_place(self, where: str) -> None:
        """Raise InputError unless the wall stands at a finite place."""
        if not is_real(self.z):
            raise InputError(f"the {where} wall is at z = {shortened(self.z)}: allowed is a finite number, or st.Infinity()")

    def matrices(self, n: int, where: str) -> tuple[ComplexArray, ...]:
        """W0, W1, … (m, n). Raises InputError for a place that is none, and for rows of the wrong shape, not finite or dependent."""
        self.require_place(where)
        side = -1 if where == WALLS[-1] else 1
        beyond = self.approximates
        if beyond is not None and not (is_real(beyond) and side * (beyond - self.z) > 0.0):
            told = f"the {where} wall at z = {self.z:g} approximates {shortened(beyond)}"
            raise InputError(f"{told}: allowed is a finite point beyond it, {'below' if side < 0 else 'above'} {self.z:g}")
        return _rows(self.rows, self.moving, (None, n), f"the rows at the {where} wall, z = {self.z:g},")


@dataclass(frozen=True, eq=False)
class Infinity:
    """An end at infinity: solutions decay towards it.

    decaying is the number of solutions that do, found from the limiting matrix if it is not given. limit is the pencil there, D0, D1 or
    C0, C1, D0, D1, all (n, n), by default what the function gives at ±∞. start is the |z| at which to begin. Without a limit beside it,
    it says that the coefficients have none (x² in a potential), and the decaying space is that of the pencil frozen there; with one, the
    space is that of the limit. What either misses is a part of the bound. By default the start is where the coefficients are at their
    limit to rounding, to which they have to come exponentially.

    Raises InputError for a start that is no finite number above 0.
    """

    decaying: int | None = None
    start: float | None = None
    limit: tuple[ArrayLike, ...] | None = None
    expansion: AsymptoticSeries | None = None

    def __post_init__(self) -> None:
        if self.start is not None and not (is_real(self.start) and self.start > 0.0):
            raise InputError(f"Infinity has start = {shortened(self.start)}: allowed is a finite number above 0, the |z| to begin at")


@dataclass(frozen=True, eq=False)
class Interface:
    """Conditions inside, at z: (before + σ before_moving) ψ(z−) + (behind + σ behind_moving) ψ(z+) = 0, all (n, n).

    What moves may be (q, n, n), for σ, …, σ^q.
    """

    z: float
    before: ArrayLike
    behind: ArrayLike
    before_moving: ArrayLike | None = None
    behind_moving: ArrayLike | None = None

    @classmethod
    def jump(cls, z: float, J: ArrayLike, moving: ArrayLike | None = None) -> Interface:
        """ψ(z+) = (J + σ moving) ψ(z−), J and moving (n, n); moving may be (q, n, n), for σ, …, σ^q."""
        at: Any = np.asarray(J)
        return cls(z, at, -np.eye(*at.shape[:1]), moving)

    def matrices(self, n: int) -> tuple[ComplexArray, ...]:
        """M0, M1, … (n, 2n) over (ψ(z−), ψ(z+)). Raises InputError for matrices of the wrong shape, not finite or of dependent rows."""
        named = f"the conditions at the interface z = {self.z:g}"
        parts = []
        for side, fixed, moving in (("before", self.before, self.before_moving), ("behind", self.behind, self.behind_moving)):
            parts.append(_rows(fixed, moving, (n, n), f"{named}, {side}", independent=False))
        nothing = np.zeros((n, n), dtype=np.complex128)
        matrices = tuple(np.concatenate((a, b), axis=1) for a, b in itertools.zip_longest(*parts, fillvalue=nothing))
        require_independent(matrices, named)
        return matrices


def _rows(
    fixed: ArrayLike, moving: ArrayLike | None, shape: tuple[int | None, int], named: str, independent: bool = True
) -> tuple[ComplexArray, ...]:
    """All coefficients, that of σ zero if it is not given. Raises InputError."""
    W0 = as_matrix(fixed, shape, named)
    if moving is None:
        later = [np.zeros_like(W0)]
    else:
        given = list(moving) if _is_stack(moving) else [moving]  # type: ignore[arg-type]
        powers = ["sigma", *(f"sigma**{k}" for k in range(2, len(given) + 1))]
        later = [as_matrix(W, (len(W0), shape[1]), f"{named} times {power}") for W, power in zip(given, powers, strict=True)]
    if independent:
        require_independent((W0, *later), named)
    return (W0, *later)


def _is_stack(moving: Any) -> bool:
    """Whether its members are matrices, of one shape or not."""
    try:
        return np.ndim(next(iter(moving))) == 2
    except (TypeError, ValueError, StopIteration):
        return False  # what it is instead is told where it is made a matrix


def as_matrix(values: ArrayLike, shape: tuple[int | None, int], named: str) -> ComplexArray:
    """The values as a finite complex matrix (n, m) of this shape; None stands for any number above 0. Raises InputError."""
    allowed = f"({'m' if shape[0] is None else shape[0]}, {shape[1]})"
    try:
        matrix = np.array(values, dtype=np.complex128)
    except (ValueError, TypeError) as error:
        raise InputError(f"{named} are no matrix ({error}): allowed is an array of shape {allowed}") from None
    if matrix.ndim != 2 or matrix.shape[1] != shape[1] or (shape[0] is not None and len(matrix) != shape[0]) or len(matrix) == 0:
        empty = ", with one condition at least: where there is none, the other end holds them all" if len(matrix) == 0 else ""
        raise InputError(f"{named} have shape {matrix.shape}: allowed is {allowed}{empty}")
    if not np.isfinite(matrix).all():
        raise InputError(f"{named} are not finite: allowed are finite numbers")
    return matrix


def require_independent(rows: Sequence[ComplexArray], named: str) -> None:
    """Raise InputError if the rows of W0 + σ W1 + …, (k, n), are dependent whatever σ is."""
    sizes = np.abs(rows).max(axis=(0, 2))
    matrix = polynomial.value(rows, GENERIC_SIGMA * (1 + 1j)) / np.where(sizes == 0.0, 1.0, sizes)[:, None]
    rank = int(np.linalg.matrix_rank(matrix))
    if rank < len(rows[0]):
        raise InputError(f"{named} are {len(rows[0])} conditions of rank {rank}: allowed are independent ones")
