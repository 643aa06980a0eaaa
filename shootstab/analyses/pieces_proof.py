"""Exactly n zeros in a region by its boundary alone: D on pieces of it, each a polynomial on a curve, whose phase is followed (lemma E13).

Of the inside it is only asked whether D is analytic there, and nothing of a disc around the region: a continuous spectrum may come near,
as at 0 for the chute.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from contextlib import closing, suppress
from dataclasses import dataclass, replace
from functools import partial
from time import perf_counter
from typing import Any

from shootstab.analyses.enclosables import factors
from shootstab.analyses.enclosed_jobs import (
    BallAnswer,
    BallQuestion,
    ExactBall,
    Setting,
    answered,
    answered_elsewhere,
    ball_from,
    exact_ball,
    next_to,
    number_from,
)
from shootstab.analyses.piece_plan import (
    PlannedPiece,
    between,
    covered,
    sampled_places,
    samples,
    shortest,
    sigma_at,
    told_by,
    with_room,
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
from shootstab.roots.ellipses import ball_of, ellipse_model
from shootstab.roots.interiors import require_analytic
from shootstab.roots.pieces import Bounded, ContourPiece, pieces

ELLIPSES = (5.0, 3.0, 2.2, 1.8, 1.5, 1.35, 1.2)  # chosen: ρ of the ellipses that are tried; the one that costs least
FIRST_ELLIPSE = 1.8  # chosen: the first of them that is tried
SHARED_RHO = 1.8  # chosen: the ellipse for whose squares an enclosure is made
NEAREST_SHARED, FARTHEST_SHARED = 3, 3  # chosen: how many of them, those nearest to what is singular and farthest from it
PIECE_BITS = 48  # chosen: bits to begin with
KNOWN_ON_BOUNDARY = 6  # chosen: bits of D on the contour beyond those to spare
MORE_PIECE_BITS, MOST_PIECE_BITS = 1.4, 512  # chosen: the factor to the next number of bits, and a budget
FEWEST_SPARE, MORE_SPARE = 3, 8  # chosen: spare bits to begin with, which do where no zero is near, and those added where they do not
SQUARE_ROOM = 4.0  # chosen: nats of a square's bound, above the second largest of those seen on some squares, from which on it is cut
DEAREST = 600  # chosen: the cost, in values of D, above which a piece is rather halved


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

    def plan(self, piece: ContourPiece) -> list[PlannedPiece]:
        """The piece, or parts of it, with ellipses that cost little: ρ up from the first one while it gains, or else down."""
        with suppress(ConvergenceError):
            rim = [ball_from(answered(self.D, job).value) for job in samples(piece)]  # type: ignore[arg-type]
            if any(value.contains(0) for value in rim):
                raise ConvergenceError("D is not told from 0")
            least = min(map(_nats, rim)) - self.spare * math.log(2)
            first = ELLIPSES.index(FIRST_ELLIPSE)
            best: PlannedPiece | None = None
            for rho in ELLIPSES[first::-1]:
                found = self._on_ellipse(piece, rho, least)
                if found is None or (best is not None and found.cost >= best.cost):
                    break
                best = found
            for rho in ELLIPSES[first + 1 :] if best is None or best.rho == FIRST_ELLIPSE else ():
                found = self._on_ellipse(piece, rho, least)
                if found is not None and best is not None and found.cost >= best.cost:
                    break
                best = found or best
            if best is not None and best.cost < DEAREST:
                return [best]
        return self._halved(piece, "D is not enclosed")

    def _on_ellipse(self, piece: ContourPiece, rho: float, least: float) -> PlannedPiece | None:
        squares = covered(piece, rho, self.D.room)
        if squares is None:
            return None
        seen = [answered(self.D, job).log for job in told_by(squares, piece, self.D.room)]
        if None in seen:
            return None
        logs = sorted(float(number_from(log)) for log in seen)  # type: ignore[arg-type]
        allowed = logs[-2] + SQUARE_ROOM  # a few squares next to what is singular are rather cut than answered by more points
        return PlannedPiece(piece, rho, squares, allowed, least, allowed)

    def _halved(self, piece: ContourPiece, why: str) -> list[PlannedPiece]:
        if shortest(piece):
            raise ConvergenceError(f"{why} next to the boundary of the region {between(piece)}")
        return [planned for half in piece.halves() for planned in self.plan(half)]

    def _nearer(self, plan: PlannedPiece) -> list[PlannedPiece]:
        """The same piece with the next smaller ellipse, or its halves, where |D| had no bound on all squares."""
        smaller = [rho for rho in ELLIPSES if rho < plan.rho]
        found = self._on_ellipse(plan.piece, smaller[0], plan.least) if smaller else None
        if found is not None and found.cost < DEAREST:
            return [found]
        return self._halved(plan.piece, "|D| has no bound")

    def along(self, whole: Sequence[ContourPiece], progress: Progress | None) -> _Sum:
        """The growth of the phase of D along these pieces: |D| is bounded on all squares, then as many values asked for as it takes."""
        planned, found = [plan for piece in whole for plan in self.plan(piece)], _Sum(arb(0))
        bounded: list[tuple[PlannedPiece, Any]] = []
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
                phase, margin = _turn(plan, [known[job].value for job in plan.values], bound)
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
    found, todo, looked_at = _Sum(arb(0)), None, False
    while True:
        with at_bits(bits):
            contour, whole = _contour(problem, place, form, region, bits, spare, workers, looked_at)
            looked_at, todo = True, whole if todo is None else todo
            places = [acb(sigma) for piece in todo for sigma in sampled_places(piece)]
            known = min(int(contour.D(sigma).rel_accuracy_bits()) for sigma in places)
            if known >= spare + KNOWN_ON_BOUNDARY:
                part = contour.along(todo, progress)
                found = found.and_of(part)
                if not part.unclear:
                    break
                if spare == most_spare:
                    raise ConvergenceError(f"an eigenvalue lies on the boundary or too near to it, {between(part.unclear[0])}")
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
    problem: Problem, place: int, form: Enclosable, region: Bounded, bits: int, spare: int, workers: int | None, looked_at: bool
) -> tuple[_Boundary, list[ContourPiece]]:
    """D and the parts of the boundary that have room.

    What is singular is told by an enclosure made for one corner, that of fastest growth; D is then enclosed where the parts reach.
    looked_at says that D is known to be analytic inside. Raises ConvergenceError where it is not seen to be.
    """
    corners = [x for piece in pieces(region, False) for x in next_to(piece, (-1.0, 0.0))]
    setting = Setting(place, bits, (exact_ball(max(corners, key=lambda x: float(x.real.mid()))),))
    D = setting.enclosure(form)
    if not looked_at:
        require_analytic(D.analytic, region)
    whole = [part for piece in pieces(region, D.real) for part in with_room(piece, D.room)]
    reached = [(part, box) for part in whole for box in covered(part, SHARED_RHO, D.room) or ()]
    reached.sort(key=lambda at: D.room(sigma_at(at[0], complex(*at[1][:2]))))
    chosen = [part.at(ball_of(box)) for part, box in (*reached[:NEAREST_SHARED], *reached[NEAREST_SHARED:][-FARTHEST_SHARED:])]
    with suppress(ConvergenceError):  # what the first enclosure holds for may do
        nearer = Setting(place, bits, tuple(map(exact_ball, chosen)))
        D, setting = nearer.enclosure(form), nearer
    return _Boundary(problem, setting, D, spare, workers), whole


def _turn(plan: PlannedPiece, asked: Sequence[ExactBall | None], bound: Any) -> tuple[Any, float]:
    """The growth of the phase of D along a piece, and the margin, from its values and ln |D| ≤ bound.

    Raises ConvergenceError where they do not tell.
    """
    values = [ball_from(x) for x in asked]  # type: ignore[arg-type]
    values += [v.conjugate() for v in reversed(values[: plan.points - len(values)])]
    return ellipse_model(values, bound, arb(plan.rho)).turn(acb(-1), acb(1))


def _nats(D: Any) -> float:
    return float(abs(D).log().mid())
