"""Enclosures of D and bounds of |D| along a piece of a contour, as jobs that other processes can do; balls travel as integers."""

from __future__ import annotations

import math
import pickle
from collections.abc import Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import lru_cache
from itertools import pairwise
from typing import Any

from shootstab.analyses.enclosables import factors
from shootstab.core.balls import acb, arb
from shootstab.core.errors import ConvergenceError
from shootstab.multiprecision.enclosable import BoundedDiscriminant, Enclosable
from shootstab.multiprecision.enclosure import at_bits
from shootstab.multiprecision.tails import largest
from shootstab.roots.ellipses import Square, ball_of, point, quarters
from shootstab.roots.pieces import Bounded, ContourPiece, pieces

DEEPEST = 3  # chosen: how often a square is cut in four where |D| has no bound on it, or a poor one
THIN_SQUARE = 2.0**-6  # chosen: half a side of a square about a point on an ellipse, at which |D| is bounded to see what there is
SHARED_RHO = 1.5  # chosen: ellipse at whose vertices an enclosure is told to hold

Integers = tuple[int, int]  # m, e of m 2^e
ExactBall = tuple[Integers, Integers, Integers, Integers]  # middle and radius of the real part, and of the imaginary part


@dataclass(frozen=True)
class PieceValue:
    """D at the Chebyshev point j of K of a piece."""

    piece: ContourPiece
    j: int
    K: int


@dataclass(frozen=True)
class SquareBound:
    """ln |D| on a square of a piece's t-plane, which is cut where it has a bound above `allowed` or none."""

    piece: ContourPiece
    box: Square
    allowed: float


@dataclass(frozen=True)
class EllipseSample:
    """ln |D| next to some points on an ellipse of a piece, the largest; to choose an ellipse, and no bound."""

    piece: ContourPiece
    rho: float


BallQuestion = PieceValue | SquareBound | EllipseSample


@dataclass(frozen=True)
class BallAnswer:
    """What was found, and of which multiple of D."""

    multiple: tuple[Any, ...]
    value: ExactBall | None = None
    log: Integers | None = None


@dataclass(frozen=True)
class Setting:
    """The place of a factor of D, its bits, and the balls of σ that it is made for."""

    factor: int
    bits: int
    regions: tuple[ExactBall, ...]

    def enclosure(self, form: Enclosable) -> BoundedDiscriminant:
        """D, to be asked for at the bits of the setting."""
        return form.enclosure(self.bits, *map(ball_from, self.regions))


def exact_ball(x: Any) -> ExactBall:
    """A complex ball in integers."""
    x = acb(x)
    re, im, dre, dim = ((int(m), int(e)) for m, e in (y.man_exp() for y in (x.real.mid(), x.imag.mid(), x.real.rad(), x.imag.rad())))
    return re, dre, im, dim


def ball_from(found: ExactBall) -> Any:
    """The ball that these integers stand for, at a working precision that holds them."""
    re, dre, im, dim = (_number(x) for x in found)
    return acb(re + arb(0, dre), im + arb(0, dim))


def number_from(found: Integers) -> Any:
    """A real number."""
    return _number(found)


def _number(x: Integers) -> Any:
    return arb(x[0]) * arb(2) ** x[1]


def answered(D: BoundedDiscriminant, job: BallQuestion) -> BallAnswer:
    """The answer to a job, at the working precision. Raises ConvergenceError for a value that is not enclosed."""
    if isinstance(job, PieceValue):
        return BallAnswer(D.multiple, value=exact_ball(D(job.piece.at(point(job.j, job.K)))))
    found = _bound(D, job.piece, job.box, job.allowed, DEEPEST) if isinstance(job, SquareBound) else _largest(D, job.piece, job.rho)
    if not found.is_finite():
        return BallAnswer(D.multiple)
    man, exp = found.upper().man_exp()
    return BallAnswer(D.multiple, log=(int(man), int(exp)))


def answered_elsewhere(parcel: bytes, job: BallQuestion) -> BallAnswer:
    """The same in another process, which is told the problem and the setting."""
    D, bits = _made(parcel)
    with at_bits(bits):
        return answered(D, job)


@lru_cache(maxsize=1)
def _made(parcel: bytes) -> tuple[BoundedDiscriminant, int]:
    problem, setting = pickle.loads(parcel)
    with at_bits(setting.bits):
        return setting.enclosure(factors(problem)[setting.factor]), setting.bits


def _bound(D: BoundedDiscriminant, piece: ContourPiece, box: Square, allowed: float, depth: int) -> Any:
    """An upper bound, or what is not finite."""
    try:
        found = D.growth(piece.at(ball_of(box)))
    except ConvergenceError:
        found = arb.nan()
    if (found.is_finite() and found < allowed) or depth == 0:
        return found
    parts = []
    for part in quarters(box):
        parts.append(_bound(D, piece, part, allowed, depth - 1))
        if not parts[-1].is_finite():
            return parts[-1] if not found.is_finite() else found
    return largest(parts)


def _largest(D: BoundedDiscriminant, piece: ContourPiece, rho: float) -> Any:
    found = [arb(-math.inf)]
    for t in on_ellipse(rho, piece.mirrored):
        try:
            found.append(D.growth(piece.at(acb(t.real, t.imag) + acb(arb(0, THIN_SQUARE), arb(0, THIN_SQUARE)))).upper())
        except ConvergenceError:
            return arb.nan()
    return largest(found)


def on_ellipse(rho: float, mirrored: bool) -> Sequence[complex]:
    """Its vertices; of a mirrored piece without that to the left."""
    across, up = (rho + 1 / rho) / 2, (rho - 1 / rho) / 2
    return [complex(0, up), complex(0, -up), complex(across), *([] if mirrored else [complex(-across)])]


def next_to(region: Bounded, parts: int) -> list[Any]:
    """Balls of σ next to the boundary, for which an enclosure is made: vertices of ellipses about so many parts of each piece."""
    thin, ends = acb(arb(0, THIN_SQUARE), arb(0, THIN_SQUARE)), [Fraction(2 * k, parts) - 1 for k in range(parts + 1)]
    cut = [replace(piece, low=low, high=high) for piece in pieces(region, False) for low, high in pairwise(ends)]
    vertices = on_ellipse(SHARED_RHO, False)
    return [part.at(acb(t.real, t.imag) + thin) for part in cut for t in (vertices if parts == 1 else vertices[:2])]
