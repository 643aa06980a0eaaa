"""All modes in a region, without a guess, up to both sides of the continuous spectrum."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from shootstab.analyses.cut_region import RegionCount, count_in_region, end_discs
from shootstab.analyses.multiple import multiple
from shootstab.analyses.refine import refine
from shootstab.analyses.refine_double import tightened
from shootstab.analyses.resonances import find_resonances
from shootstab.analyses.zeros import accurate_count, polish
from shootstab.core.errors import ConvergenceError
from shootstab.core.records import Mode
from shootstab.core.regions import Disc, Region
from shootstab.discriminants.continuation import Continuation, Undecidable
from shootstab.discriminants.frame import Frame
from shootstab.discriminants.method import Method
from shootstab.problems.protocol import Problem
from shootstab.roots import search as roots
from shootstab.roots.search import Search, Zero
from shootstab.roots.winding import Winding

WIDER = 4.0  # from one circle around a multiple zero to the next
WIDEST = 1e-3  # of |σ|


@dataclass(frozen=True)
class Found:
    """All modes in a region, each with its error bar, the count that says that these are all, and resonances if they were looked for."""

    modes: tuple[Mode, ...]
    counted: RegionCount
    resonances: tuple[complex, ...] | None = None


def find(problem: Problem, region: Region, rtol: float = 1e-8, resonances: bool = False, method: Method | None = None) -> Found:
    """All modes in a region; a multiple one is one mode with its multiplicity, and the multiplicities add up to survey.count.

    What lies within survey.left_out, around ends of the continuous spectrum, is not looked for. Raises Undecidable or ConvergenceError
    where the region as a whole cannot be counted.
    """
    continuation = Continuation(problem, method or Frame(rtol=1e-9))
    zeros, whole = find_modes(continuation, region)
    modes = tuple(mode for zero in zeros for mode in modes_of(continuation, zero, rtol))
    return Found(modes, whole, tuple(find_resonances(continuation, region)) if resonances else None)


def find_modes(continuation: Continuation, region: Region, known: Sequence[Zero] = ()) -> tuple[list[Zero], RegionCount]:
    """The modes in the region that are not known yet, and the count of the whole.

    Raises Undecidable or ConvergenceError where the region as a whole cannot be counted.
    """
    whole = count_in_region(continuation, region)
    return roots.find(_everywhere(continuation), region, known, whole), whole


def modes_of(continuation: Continuation, zero: Zero, rtol: float) -> list[Mode]:
    """A zero as a mode with its error bar; a multiple one, or those into which it falls where D is computed more accurately."""
    if zero.radius == 0.0:
        return [refine(continuation.problem, zero.sigma, rtol)]
    tried: Method | None = tightened(continuation.method)
    while tried is not None:
        continuation, tried = Continuation(continuation.problem, tried), tightened(tried)
    parts = _in_a_circle(_everywhere(continuation), zero)
    return [
        refine(continuation.problem, z.sigma, rtol) if z.radius == 0.0 else multiple(continuation, z.sigma, z.multiplicity, z.radius, rtol)
        for z in parts
    ]


def _in_a_circle(search: Search, zero: Zero) -> list[Zero]:
    """The zeros into which a multiple one falls: a more accurate D may have them a little outside the circle that was counted.

    Raises ConvergenceError where no circle about it holds as many.
    """
    radius = zero.radius
    while radius <= WIDEST * abs(zero.sigma):
        disc = Disc(zero.sigma, radius)
        try:
            counted = search.closely(disc)
        except ConvergenceError:
            counted = None  # a zero lies on the circle, or D is not accurate enough for so small a one
        if counted is not None and counted.count >= zero.multiplicity:  # some of them may be known
            return roots.find(search, disc, counted=counted)
        radius *= WIDER
    raise ConvergenceError(f"{zero.multiplicity} zeros were counted at {zero.sigma:.12g}, but no circle is found in which they stay")


def _everywhere(continuation: Continuation) -> Search:
    """A search for modes along whatever paths suit them."""
    ends = [] if continuation.continuum is None else end_discs(continuation.continuum)

    def arrive(start: complex) -> complex | None:
        try:
            near = polish(continuation.at(start).discriminant)(start)
            # the path that suits the zero may be another one, on which this is no zero
            return None if near is None else polish(continuation.at(near).discriminant)(near)
        except ConvergenceError:
            return None

    def closely(disc: Disc) -> Winding:
        branches = continuation.branches(disc.centre, disc.radius)
        if len(branches) > 1:
            raise Undecidable(f"the continuous spectrum crosses the circle of {disc.radius:.1e}")
        return accurate_count(branches[0], disc)

    def holds(region: Region, sigma: complex) -> bool:
        return region.contains(sigma) and not any(disc.contains(sigma) and region.contains(disc.centre) for disc in ends)

    return Search(lambda region: count_in_region(continuation, region), closely, arrive, holds)
