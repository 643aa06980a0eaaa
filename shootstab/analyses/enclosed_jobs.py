"""Enclosures of D and bounds of |D| along a piece of a contour, as jobs that other processes can do; balls travel as integers."""

from __future__ import annotations

import pickle
from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

from shootstab.analyses.enclosables import factors
from shootstab.core.balls import acb, arb
from shootstab.core.errors import ConvergenceError
from shootstab.multiprecision.enclosable import BoundedDiscriminant, Enclosable
from shootstab.multiprecision.enclosure import at_bits
from shootstab.multiprecision.tails import largest
from shootstab.roots.ellipses import Square, ball_of, point, quarters
from shootstab.roots.pieces import ContourPiece

DEEPEST = 3  # chosen: how often a square is cut in four where |D| has no bound on it, or a poor one
THIN_SQUARE = 2.0**-6  # chosen: half a side of a square about a point, in t, for which an enclosure is made

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
    """ln |D| on a square of a piece's t-plane, which is cut up to `cuts` times where it has a bound above `allowed` or none."""

    piece: ContourPiece
    box: Square
    allowed: float
    cuts: int = DEEPEST


BallQuestion = PieceValue | SquareBound


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
    found = _bound(D, job.piece, job.box, job.allowed, job.cuts)
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


def next_to(piece: ContourPiece, places: Sequence[complex]) -> list[Any]:
    """Balls of σ about places t of a piece, for which an enclosure is made."""
    thin = acb(arb(0, THIN_SQUARE), arb(0, THIN_SQUARE))
    return [piece.at(acb(t) + thin) for t in places]
