"""Exactly n zeros in a region by its boundary alone: D on pieces of it, each a polynomial on a curve, whose phase is followed (lemma E13).

Of the inside it is only asked whether D is analytic there, and nothing of a disc around the region: a continuous spectrum may come near,
as at 0 for the chute.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from contextlib import closing, suppress
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import partial
from time import perf_counter
from typing import Any

from shootstab.analyses.enclosables import factors
from shootstab.analyses.enclosed_jobs import (
    BallAnswer,
    BallQuestion,
    EllipseSample,
    ExactBall,
    PieceValue,
    Setting,
    SquareBound,
    answered,
    answered_elsewhere,
    ball_from,
    exact_ball,
    next_to,
    number_from,
)
from shootstab.analyses.proof import Proof, gathered, in_order, lemmas, premise
from shootstab.analyses.workers import parcel, spread
from shootstab.core.balls import acb, arb
from shootstab.core.errors import ConvergenceError
from shootstab.core.progress import Progress
from shootstab.multiprecision.enclosable import BoundedDiscriminant, Enclosable
from shootstab.multiprecision.enclosure import at_bits
from shootstab.multiprecision.tails import largest
from shootstab.problems.protocol import Problem
from shootstab.roots.ellipses import boxes, ellipse_model, point, points_on_ellipse
from shootstab.roots.interiors import require_analytic
from shootstab.roots.pieces import Bounded, ContourPiece, pieces

ELLIPSES = (5.0, 3.0, 2.2, 1.8, 1.5, 1.35, 1.2)  # chosen: ρ of the ellipses that are tried; the one that costs least
LONGEST_BOX, SIDES_OF_PIECE = 0.05, 16  # chosen: half a side of a square for |D|, in |dσ/dt| over |σ − centre|; sides of one on a segment
LARGEST_BOX = 0.25  # chosen: half a side of a square at most, for −1 ≤ t ≤ 1: of a short piece one would reach far beyond its ellipse
PIECE_BITS = 64  # chosen: bits to begin with
KNOWN_ON_BOUNDARY = 6  # chosen: bits of D on the contour beyond those to spare
MORE_PIECE_BITS, MOST_PIECE_BITS = 1.4, 512  # chosen: the factor to the next number of bits, and a budget
FEWEST_SPARE, MORE_SPARE = 3, 8  # chosen: spare bits to begin with, which do where no zero is near, and those added where they do not
SQUARE_ROOM = 12.0  # chosen: nats of a square's bound, above what was seen next to points on the ellipse, from which on it is cut
USUAL_ROOM = 6.0  # chosen: nats of the largest bound above that, by which the cost of an ellipse is judged
MOST_CUTS = 12  # chosen: how often a piece is halved: each time where it fails alone, so that a few dozen more are planned
DEAREST = 600  # chosen: enclosures and bounds above which a piece is rather halved
FIRST_ELLIPSE = 1.5  # chosen: the first of them that is tried
SQUARE = 0.25  # chosen: the time of a bound of |D| over that of a value of D
SAMPLES_OF_PIECE = 6  # chosen: points of a piece at which the size of D is judged
SHARED_PARTS = (1, 4, 16)  # chosen: parts of each piece with an ellipse of their own, more where wide ones meet the continuous spectrum


@dataclass(frozen=True)
class _Planned:
    """A piece with the ellipse of its t-plane, ln |D| above which squares on it are cut, and the logarithm of the spread that is allowed.

    bound is that of ln |D| which its points are chosen for.
    """

    piece: ContourPiece
    rho: float
    allowed: float
    least: float
    bound: float

    @property
    def squares(self) -> list[SquareBound]:
        """What covers the ellipse; of a mirrored piece the right half of it."""
        longest = min(LONGEST_BOX / self.piece.rate, LARGEST_BOX) if self.piece.rate else 1 / SIDES_OF_PIECE
        return [SquareBound(self.piece, box, self.allowed) for box in boxes(self.rho, longest, self.piece.mirrored)]

    @property
    def points(self) -> int:
        """K of lemma E13."""
        return points_on_ellipse(self.bound, self.least, self.rho)

    @property
    def values(self) -> list[PieceValue]:
        """What is asked of D on it; of a mirrored piece those with t ≥ 0, the others being conjugates."""
        asked = math.ceil(self.points / 2) if self.piece.mirrored else self.points
        return [PieceValue(self.piece, j, self.points) for j in range(asked)]

    @property
    def cost(self) -> float:
        """Its cost, in values of D."""
        return SQUARE * len(self.squares) + len(self.values)

    def turn(self, asked: Sequence[ExactBall | None], bound: Any) -> tuple[Any, float]:
        """The growth of the phase of D along it, and the margin, from its values and ln |D| ≤ bound.

        Raises ConvergenceError where they do not tell.
        """
        values = [ball_from(x) for x in asked]  # type: ignore[arg-type]
        values += [v.conjugate() for v in reversed(values[: self.points - len(values)])]
        return ellipse_model(values, bound, arb(self.rho)).turn(acb(-1), acb(1))


@dataclass
class _Sum:
    """What pieces of a boundary have given together, the growth of the phase in radians, and those that are still unclear."""

    phase: Any
    margin: float = math.inf
    points: int = 0
    evaluations: int = 0
    unclear: tuple[ContourPiece, ...] = ()

    def and_of(self, other: _Sum) -> _Sum:
        """Both together, and what is unclear in the other."""
        margin, points = min(self.margin, other.margin), self.points + other.points
        return _Sum(self.phase + other.phase, margin, points, self.evaluations + other.evaluations, other.unclear)


@dataclass(frozen=True)
class _Boundary:
    """One factor of D around a region: who answers questions about it."""

    problem: Problem
    setting: Setting
    D: BoundedDiscriminant
    spare: int
    workers: int | None

    def plan(self, piece: ContourPiece) -> list[_Planned]:
        """The piece, or parts of it, with ellipses that cost little: ρ up from the first one while it gains, or else down."""
        with suppress(ConvergenceError):
            rim = [PieceValue(piece, j, SAMPLES_OF_PIECE) for j in range(SAMPLES_OF_PIECE)]
            least = min(_nats(ball_from(answered(self.D, job).value)) for job in rim) - self.spare * math.log(2)  # type: ignore[arg-type]
            best, place, step = None, ELLIPSES.index(FIRST_ELLIPSE), 0
            while 0 <= place < len(ELLIPSES):
                found = self._on_ellipse(piece, ELLIPSES[place], least)
                if found is not None and (best is None or found.cost < best.cost):
                    best, step = found, step or 1
                elif best is None and step <= 0:
                    step = -1
                elif step == 1 and best is not None and best.rho == FIRST_ELLIPSE:
                    place, step = ELLIPSES.index(FIRST_ELLIPSE), -1
                else:
                    break
                place += step
            if best is not None and best.cost < DEAREST:
                return [best]
        return self._halved(piece, "D is not enclosed")

    def _on_ellipse(self, piece: ContourPiece, rho: float, least: float) -> _Planned | None:
        seen = answered(self.D, EllipseSample(piece, rho)).log
        if seen is None:
            return None
        there = float(number_from(seen))
        return _Planned(piece, rho, there + SQUARE_ROOM, least, there + USUAL_ROOM)

    def _halved(self, piece: ContourPiece, why: str) -> list[_Planned]:
        if piece.high - piece.low <= Fraction(2, 2**MOST_CUTS):
            raise ConvergenceError(f"{why} next to the boundary of the region {_between(piece)}")
        return [planned for half in piece.halves() for planned in self.plan(half)]

    def _nearer(self, plan: _Planned) -> list[_Planned]:
        """The same piece with the next smaller ellipse, or its halves, where |D| had no bound on all squares."""
        smaller = [rho for rho in ELLIPSES if rho < plan.rho]
        found = self._on_ellipse(plan.piece, smaller[0], plan.least) if smaller else None
        if found is not None and found.cost < DEAREST:
            return [found]
        return self._halved(plan.piece, "|D| has no bound")

    def along(self, whole: Sequence[ContourPiece], progress: Progress | None) -> _Sum:
        """The growth of the phase of D along these pieces: |D| is bounded on all squares, then as many values asked for as it takes."""
        planned, found = [plan for piece in whole for plan in self.plan(piece)], _Sum(arb(0))
        bounded: list[tuple[_Planned, Any]] = []
        while planned:
            known = self._asked([job for plan in planned for job in plan.squares], progress)
            found.evaluations += len(known)
            again = []
            for plan in planned:
                logs = [known[job].log for job in plan.squares]
                if None in logs:
                    again += self._nearer(plan)
                else:
                    bound = largest([number_from(log) for log in logs])  # type: ignore[arg-type]
                    bounded.append((replace(plan, bound=float(bound)), bound))
            planned = again
        known = self._asked([job for plan, _ in bounded for job in plan.values], progress)
        found.evaluations += len(known)
        for plan, bound in bounded:
            found.points += plan.points
            try:
                phase, margin = plan.turn([known[job].value for job in plan.values], bound)
            except ConvergenceError:
                found.unclear = (*found.unclear, plan.piece)
                continue
            found.phase, found.margin = found.phase + plan.piece.times * phase, min(found.margin, margin)
        return found

    def _asked(self, jobs: Sequence[BallQuestion], progress: Progress | None) -> dict[BallQuestion, BallAnswer]:
        found: dict[BallQuestion, BallAnswer] = {}
        here = partial(answered, self.D)
        with closing(spread(here, self._elsewhere, jobs, self.workers, None)) as done:
            for job, answer in done:
                if answer.multiple != self.D.multiple:
                    raise ConvergenceError("two processes enclosed different multiples of D, or different base flows: ask one worker")
                found[job] = answer
                if progress is not None:
                    progress(len(found), len(jobs))
        return found

    def _elsewhere(self) -> Callable[[BallQuestion], BallAnswer]:
        return partial(answered_elsewhere, parcel(self.problem, self.setting))


def by_pieces(problem: Problem, region: Bounded, spare: int, progress: Progress | None, workers: int | None) -> Proof:
    """The zeros of every factor of D in the region, with so many spare bits. workers as for `find`: processes that share the work.

    Raises ConvergenceError where a zero is too near to the boundary, or D is not enclosed there.
    """
    began, forms = perf_counter(), factors(problem)
    found = [_counted(problem, place, form, region, spare, progress, workers) for place, form in enumerate(forms)]
    return replace(gathered(found, region, perf_counter() - began, in_order((*lemmas(forms), "E13"))), premise=premise(forms))


@dataclass(frozen=True)
class _FactorAlong:
    """What one factor of D gave."""

    count: int
    margin: float
    bits: int
    points: int
    evaluations: int


def _counted(
    problem: Problem, place: int, form: Enclosable, region: Bounded, most_spare: int, progress: Progress | None, workers: int | None
) -> _FactorAlong:
    bits, spare = PIECE_BITS, min(FEWEST_SPARE, most_spare)
    found, todo = _Sum(arb(0)), None
    while True:
        with at_bits(bits):
            contour, whole = _contour(problem, place, form, region, bits, spare, workers)
            if todo is None:
                todo = whole
                require_analytic(contour.D.analytic, region)
            places = [piece.at(point(j, SAMPLES_OF_PIECE)) for piece in todo for j in range(SAMPLES_OF_PIECE)]
            known = min(int(contour.D(sigma).rel_accuracy_bits()) for sigma in places)
            if known >= spare + KNOWN_ON_BOUNDARY:
                part = contour.along(todo, progress)
                found = found.and_of(part)
                if not part.unclear:
                    break
                if spare == most_spare:
                    raise ConvergenceError(f"an eigenvalue lies on the boundary or too near to it, {_between(part.unclear[0])}")
                todo, spare = [half for piece in part.unclear for half in piece.halves()], min(spare + MORE_SPARE, most_spare)
                continue
        bits = math.ceil(MORE_PIECE_BITS * bits)
        if bits > MOST_PIECE_BITS:
            raise ConvergenceError("D is not enclosed well enough on the boundary of the region: an eigenvalue may be there")
    with at_bits(bits):
        count = (found.phase / (2 * arb.pi())).unique_fmpz()
    if count is None:
        raise ConvergenceError("the enclosures of D on the contour do not determine a whole number of turns")
    return _FactorAlong(int(count), found.margin, bits, found.points, found.evaluations)


def _contour(
    problem: Problem, place: int, form: Enclosable, region: Bounded, bits: int, spare: int, workers: int | None
) -> tuple[_Boundary, list[ContourPiece]]:
    for parts in SHARED_PARTS:
        setting = Setting(place, bits, tuple(map(exact_ball, next_to(region, parts))))
        try:
            D = setting.enclosure(form)
        except ConvergenceError:
            if parts == SHARED_PARTS[-1]:
                raise
        else:
            break
    return _Boundary(problem, setting, D, spare, workers), pieces(region, D.real)


def _between(piece: ContourPiece) -> str:
    """Where a piece lies, in words."""
    start, end = (complex(piece.at(acb(t)).mid()) for t in (-1, 1))
    return f"from {start:.6g} to {end:.6g}"


def _nats(D: Any) -> float:
    return float(abs(D).log().mid())
