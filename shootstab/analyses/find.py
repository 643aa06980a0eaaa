"""All modes in a region, without a guess, up to both sides of the continuous spectrum."""

from __future__ import annotations

import math
import pickle
from collections.abc import Iterable, Sequence
from contextlib import closing
from dataclasses import dataclass, replace
from functools import lru_cache, partial

from shootstab.analyses.accuracy import Tightening
from shootstab.analyses.count import counted_twice
from shootstab.analyses.cut_region import RegionCount, count_in_region, end_discs
from shootstab.analyses.multiple import cluster, multiple
from shootstab.analyses.refine import refine
from shootstab.analyses.refine_double import require_atol, tightened
from shootstab.analyses.resonances import find_resonances
from shootstab.analyses.workers import parcel, spread
from shootstab.analyses.zeros import MOST_TO_SEPARATE, accurate_count
from shootstab.core.allowed import FINDING_RTOL, LEAST_MODE_RTOL
from shootstab.core.errors import ConvergenceError
from shootstab.core.given import require_rtol
from shootstab.core.numerus import number_of
from shootstab.core.progress import StepDone
from shootstab.core.records import Mode
from shootstab.core.regions import Disc, Region, size
from shootstab.discriminants.continuation import Continuation, Undecidable
from shootstab.discriminants.frame import Frame
from shootstab.discriminants.method import Method
from shootstab.discriminants.named import METHODS, method_named
from shootstab.problems.protocol import Problem
from shootstab.roots import search as roots
from shootstab.roots.search import Arrival, Search, Zero, moments, polish
from shootstab.roots.winding import Winding

SEARCHING = 1e-9  # chosen: local error of the method on whose meshes zeros are polished, to be refined on others
KNOWN_WITHIN = 1e-2  # chosen: how well modes are to be known, in the size of their region, for their number to mean something
LEAST_ON_PART, MORE_ON_PART = 200, 4  # chosen: samples that a part's contour may take in any case, and in those of the whole region
WIDER_AROUND = 4.0  # chosen: the radius of the next circle around a multiple zero over that of one
LARGEST_CIRCLE = 1e3  # chosen: the last of them, in the first: beyond, the zero was not multiple to any purpose


@dataclass(frozen=True, repr=False)
class Found:
    """All modes in a region, each with its error bar, the count that says that these are all, and resonances if they were looked for."""

    modes: tuple[Mode, ...]
    counted: RegionCount
    resonances: tuple[complex, ...] | None = None

    def __repr__(self) -> str:
        beyond = "" if self.resonances is None else f", {number_of(len(self.resonances), 'resonance')}"
        return f"Found({', '.join(map(repr, self.modes)) or 'no mode'}{beyond})"


def find(
    problem: Problem,
    region: Region,
    rtol: float = FINDING_RTOL,
    resonances: bool = False,
    method: Method | str | None = None,
    atol: float | None = None,
    workers: int | None = 1,
    cluster: str | None = None,
) -> Found:
    """All modes in a region, each to rtol, and to KNOWN_WITHIN of the region's size at least.

    Those that grow most come first; a multiple one is one mode with its multiplicity, and the multiplicities add up to counted.count.

    What lies within counted.left_out, around ends of the continuous spectrum, is not looked for. workers: processes of this machine that
    compute error bars, None: one a core where that saves time; cluster: the address of a Dask scheduler, in place of them; the modes do not
    depend on it. Raises Undecidable or ConvergenceError where the region as a whole cannot be counted, InputError for a problem that cannot
    be sent to other processes.
    """
    require_rtol(rtol, LEAST_MODE_RTOL)
    require_atol(atol)
    continuation, zeros, whole = find_modes(Continuation(problem, method_named(method, SEARCHING) or Frame(rtol=SEARCHING)), region)
    within = max(KNOWN_WITHIN * size(region), LEAST_MODE_RTOL * max(map(abs, region.hull)))
    jobs = [(i, zero, min(rtol, within / max(abs(zero.sigma), within))) for i, zero in enumerate(zeros)]
    with closing(
        spread(
            partial(_bounded, continuation, atol),
            lambda: partial(_bounded_elsewhere, parcel(problem, continuation.method, atol)),
            jobs,
            workers,
            cluster,
        )
    ) as results:
        each = {i: some for (i, _, _), some in results}
    modes = without_repetition(zeros, [each[i] for i in range(len(zeros))])
    modes = tuple(sorted(modes, key=lambda mode: -mode.sigma.real))
    return Found(modes, whole, tuple(find_resonances(continuation, region)) if resonances else None)


def _bounded(continuation: Continuation, atol: float | None, job: tuple[int, Zero, float]) -> list[Mode]:
    """The modes that a zero is; the job has its place in the list and the accuracy that is asked for."""
    return modes_of(continuation, *job[1:], atol)


def _bounded_elsewhere(known: bytes, job: tuple[int, Zero, float]) -> list[Mode]:
    """The same in another process."""
    return _bounded(*_sent(known), job)


@lru_cache(maxsize=1)
def _sent(known: bytes) -> tuple[Continuation, float | None]:
    problem, method, atol = pickle.loads(known)
    return Continuation(problem, method), atol


def find_modes(
    continuation: Continuation, region: Region, known: Sequence[Zero] = (), step_done: StepDone = lambda: None
) -> tuple[Continuation, list[Zero], RegionCount]:
    """A continuation accurate enough for the region, the modes in it that are not known yet, and the count of the whole.

    step_done is called with every contour and every iteration.

    Raises Undecidable or ConvergenceError where the region as a whole cannot be counted.
    """
    tightening = Tightening(continuation)
    accurate, whole = counted_twice(tightening, region)
    step_done()
    return accurate, roots.find(_everywhere(tightening, accurate, whole.evaluations, step_done), region, known, whole), whole


def without_repetition(zeros: Sequence[Zero], modes: Iterable[Sequence[Mode]]) -> tuple[Mode, ...]:
    """The modes of each of the zeros, in their order, together: one that stands for several zeros comes once.

    Zeros that one mesh tells apart may be one multiple mode to the bounds of another; that stands for so many zeros at least.
    """
    out: list[Mode] = []
    spent: list[int] = []  # the number of zeros that each of the modes stands for
    for zero, some in zip(zeros, modes, strict=True):
        for mode in some:
            own = min(mode.multiplicity, zero.multiplicity)
            known = next((i for i, other in enumerate(out) if _one_cluster(other, mode)), None)
            if known is None:
                out.append(mode)
                spent.append(own)
                continue
            spent[known] += own
            if mode.multiplicity > out[known].multiplicity:
                out[known] = mode
    return tuple(replace(m, multiplicity=max(n, m.multiplicity)) for m, n in zip(out, spent, strict=True))


def _one_cluster(a: Mode, b: Mode) -> bool:
    """Whether two modes, one of them multiple, may be the same within their bounds."""
    return max(a.multiplicity, b.multiplicity) > 1 and abs(a.sigma - b.sigma) <= a.error + b.error


def modes_of(continuation: Continuation, zero: Zero, rtol: float, atol: float | None = None) -> list[Mode]:
    """A zero as a mode with its error bar; a multiple one, or those into which it falls where D is computed more accurately."""
    method = continuation.method.name if continuation.method.name in METHODS else continuation.method
    if zero.radius == 0.0:
        return [refine(continuation.problem, zero.sigma, rtol, method=method, atol=atol)]
    tried: Method | None = tightened(continuation.method)
    while tried is not None:
        continuation, tried = Continuation(continuation.problem, tried), tightened(tried)
    parts = _in_a_circle(_everywhere(Tightening(continuation), continuation, in_all=MOST_TO_SEPARATE), zero)
    each = (
        refine(continuation.problem, z.sigma, rtol, method=method, atol=atol)
        if z.radius == 0.0
        else multiple(continuation, cluster(continuation, z.sigma, z.radius, z.multiplicity), rtol)
        for z in parts
    )
    return list(without_repetition(parts, ([mode] for mode in each)))


def _in_a_circle(search: Search, zero: Zero) -> list[Zero]:
    """The zeros into which a multiple one falls: a more accurate D may have them a little outside the circle that was counted.

    Raises ConvergenceError where no circle about it holds as many.
    """
    radius = zero.radius
    while radius <= LARGEST_CIRCLE * zero.radius:
        disc = Disc(zero.sigma, radius)
        try:
            counted = search.closely(disc)
        except ConvergenceError:
            counted = None  # a zero lies on the circle, or D is not accurate enough for so small a one
        if counted is not None and counted.count >= zero.multiplicity:  # some of them may be known
            try:
                return roots.find(search, disc, counted=counted)
            except ConvergenceError:  # D is noise around them, and does not tell them apart
                return [Zero(moments(counted)[0], counted.count, radius)]
        radius *= WIDER_AROUND
    many = number_of(zero.multiplicity, "zero was", "zeros were")
    raise ConvergenceError(f"{many} counted at {zero.sigma:.12g}, but no circle is found in which they stay")


def _everywhere(
    tightening: Tightening, continuation: Continuation, samples: int = 0, step_done: StepDone = lambda: None, in_all: float = math.inf
) -> Search:
    """A search for modes along whatever paths suit them: the continuation polishes, and those of the tightening count.

    samples are those that the contour of the whole region took. Those of its parts are shorter, and one that needs some times as many is
    noise: halving it would not end. in_all are samples beyond which no more parts are counted.
    """
    spent = 0
    ends = [] if continuation.continuum is None else end_discs(continuation.continuum)

    def arrive(start: complex, length: float) -> Arrival | None:
        step_done()
        try:
            near = polish(continuation.at(start).discriminant)(start, length)
            # the path that suits the zero may be another one, on which this is no zero
            return None if near is None else polish(continuation.at(near.sigma).discriminant)(near.sigma, length)
        except ConvergenceError:
            return None

    def count(region: Region) -> RegionCount:
        nonlocal spent
        step_done()
        if spent > in_all:
            raise ConvergenceError(f"{spent} samples of D do not tell the zeros apart")
        most = max(LEAST_ON_PART, MORE_ON_PART * samples)
        spent += most  # unless fewer suffice
        counted = tightening.first(lambda c: count_in_region(c, region, most))[1]
        spent += counted.evaluations - most
        return counted

    def in_circle(c: Continuation, disc: Disc) -> Winding:
        branches = c.branches(disc.centre, disc.radius)
        if len(branches) > 1:
            raise Undecidable(f"the continuous spectrum crosses the circle of {disc.radius:.1e}")
        return accurate_count(c.problem, branches[0], disc)

    def closely(disc: Disc) -> Winding:
        step_done()
        return tightening.first(lambda c: in_circle(c, disc))[1]

    def holds(region: Region, sigma: complex) -> bool:
        return region.contains(sigma) and not any(disc.contains(sigma) and region.contains(disc.centre) for disc in ends)

    return Search(count, closely, arrive, holds)
