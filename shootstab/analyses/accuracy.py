"""Whether D is accurate enough for a count, and discriminants that are where it is not.

On a contour, let D̃ be the D that was computed. Where |D/D̃ − 1| < 1 all along it, Rouché's theorem says that both have as many zeros
inside. The true D is not at hand; one that was computed in every respect otherwise is: on a mesh with every step halved, a little off its
middle, so that everything rounds otherwise; from a far frame changed by as much as it may be wrong; on a base flow of another error. Walls
next to singular points are set twice as far from them.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Sequence
from typing import TypeVar

from shootstab.analyses.error_budget import FLOWS, SAFETY, change_by_walls
from shootstab.analyses.refine_double import tightened
from shootstab.core.discriminant import Discriminant, Value
from shootstab.core.errors import ConvergenceError
from shootstab.core.errors import Inaccurate as Inaccurate
from shootstab.core.scaled import EPSILON
from shootstab.discriminants.continuation import Continuation
from shootstab.discriminants.method import MeshedDiscriminant
from shootstab.problems.protocol import Problem

TOLERATED_CHANGE = 0.1  # chosen: the part of D that may change; 1 would do if the change were the error and not one draw of it
LUCKY_DRAW = 1e-2  # chosen: a draw of rounding is a hundred times smaller than usual in 1 of 100 cases or less
DRAWS = 3  # chosen
CONTOUR_PROBES = 6  # chosen: samples of a contour at which D is computed otherwise
STEEPEST_PROBES = 2  # chosen: the probes with the largest |d ln D/dσ|, where an error of the zeros weighs most; and those of a second draw

MeshedValue = tuple[MeshedDiscriminant, Value]
Answer = TypeVar("Answer")


def require_accurate(problem: Problem, samples: Sequence[MeshedValue]) -> None:
    """Raise Inaccurate unless D, computed otherwise, is the same to TOLERATED_CHANGE at some of a contour's samples.

    One draw of the errors may be small by accident: where it is not LUCKY_DRAW of the limit, there are several, at the samples that the
    first one changed most.
    """
    probes = _probes(samples)
    if not (by_walls := change_by_walls(problem, probes)) < TOLERATED_CHANGE:
        raise ConvergenceError(
            f"walls next to singular points do not determine the count: twice as far from their points they change D'/D by {by_walls:.1e} "
            "of itself on the contour"
        )
    for seed in range(1, DRAWS + 1):
        changes = sorted(_changes(problem, probes, seed), key=lambda told: -told[0])
        worst, (_, value) = changes[0]
        if not worst < TOLERATED_CHANGE:
            raise Inaccurate(
                f"D is not known well enough for a count: at sigma = {value.sigma:.12g} on the contour, "
                f"another mesh, start and base flow change it by {worst:.1e} of itself"
            )
        if worst < LUCKY_DRAW * TOLERATED_CHANGE:
            return
        probes = [probe for _, probe in changes[:STEEPEST_PROBES]]


def known_at(problem: Problem, discriminant: MeshedDiscriminant, sigma: complex) -> bool:
    """Whether D at σ is known well enough to be told from 0, as it is not where σ is a zero of it to rounding."""
    value = discriminant(sigma)
    if value.mantissa == 0.0:
        return False
    changes = (abs(otherwise(problem, discriminant, sigma, seed)(sigma).over(value) - 1.0) for seed in range(1, DRAWS + 1))
    return all(change < TOLERATED_CHANGE for change in changes)


def _changes(problem: Problem, probes: Sequence[MeshedValue], seed: int) -> Iterator[tuple[float, MeshedValue]]:
    """The relative change of D at each of the probes; infinite where it is no number."""
    others: dict[int, Discriminant] = {}
    for discriminant, value in probes:
        if id(discriminant) not in others:
            others[id(discriminant)] = otherwise(problem, discriminant, value.sigma, seed)
        change = abs(others[id(discriminant)](value.sigma).over(value.D) - 1.0)
        yield change if change < math.inf else math.inf, (discriminant, value)


def otherwise(problem: Problem, discriminant: MeshedDiscriminant, sigma: complex, seed: int) -> Discriminant:
    """D with every error that it has next to σ drawn anew, that of integration much smaller."""
    crude = problem.with_base_flow_error(FLOWS[0])
    fine = discriminant.refined(seed, None if crude is problem else crude)
    return fine.with_perturbed_start(seed, SAFETY * max(discriminant.far_error(sigma), EPSILON))


def _probes(samples: Sequence[MeshedValue]) -> list[MeshedValue]:
    """Some that are spread over the contour, and the steepest."""
    spread = min(CONTOUR_PROBES - STEEPEST_PROBES, len(samples))
    chosen = [i * len(samples) // spread for i in range(spread)]
    steep = sorted(range(len(samples)), key=lambda i: -abs(samples[i][1].logarithmic_derivative))
    return [samples[i] for i in dict.fromkeys(chosen + steep[:STEEPEST_PROBES])]


class Tightening:
    """Continuations of one problem with local errors of falling size: each question goes to the first that is accurate enough for it."""

    def __init__(self, continuation: Continuation) -> None:
        self._made = [continuation]

    def __iter__(self) -> Iterator[Continuation]:
        for i in range(len(self._made)):
            yield self._made[i]
        while (method := tightened(self._made[-1].method)) is not None:
            self._made.append(Continuation(self._made[-1].problem, method))
            yield self._made[-1]

    def first(self, ask: Callable[[Continuation], Answer]) -> tuple[Continuation, Answer]:
        """The first continuation that does not raise Inaccurate, and its answer. Raises Inaccurate where all do."""
        return first_accurate(self, ask)


def first_accurate(continuations: Iterable[Continuation], ask: Callable[[Continuation], Answer]) -> tuple[Continuation, Answer]:
    """The first of some continuations that does not raise Inaccurate, and its answer; where all do, what the last one raises."""
    for continuation in continuations:
        try:
            return continuation, ask(continuation)
        except Inaccurate as error:
            refusal = type(error)(str(error))  # another one: what was raised holds every mesh that it was raised from
    raise refusal
