"""The modes that a claimed spectrum lacks, and in words where they were looked for and what could not be searched.

A list of eigenvalues claims that no other mode lies among them, and nothing about what lies beyond: it may be the first ten, those that
grow fastest, or those around a target. All of these are the modes in some convex part of the plane, and the convex hull of the list is a
part of that: a mode inside the hull that no claim means is missing, one outside is not. Anything more needs a region that is named.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import NamedTuple

from shootstab.analyses.cut_region import RegionCount
from shootstab.analyses.find import find_modes, modes_of, without_repetition
from shootstab.analyses.verdicts import NEAR_DIGITS, radius_of
from shootstab.core.allowed import RTOL, VERDICT_DIGITS
from shootstab.core.division import distance_outside, divided, divisions
from shootstab.core.errors import ConvergenceError, InputError
from shootstab.core.numerus import number_of
from shootstab.core.progress import StepDone
from shootstab.core.records import CONTINUUM, UNRESOLVED, Mode, Verdict
from shootstab.core.regions import Polygon, Rectangle, Region, convex_hull, size
from shootstab.discriminants.continuation import Continuation
from shootstab.essential_spectrum.interior import continuum_of
from shootstab.problems.protocol import Problem
from shootstab.roots.search import Zero

NONE, WITHIN, REGION = "none", "within", "region"
MISSING = (NONE, WITHIN, REGION)  # chosen: the words of --missing
NOT_SEARCHED = "missing modes were not looked for"
HULL_MARGIN = 0.05  # chosen: the contour runs around the hull at this part of its extent, clear of the claims at its corners
THINNEST_HULL = 0.1  # chosen: the extent of claims counts as this part of the largest |claim| at least
ON_HULL = 1e-6  # chosen: a mode no farther outside, in extents, lies among claims on a line, or claims that are a little wrong
CLEAR_OF_CONTINUUM = 1e-4  # chosen: a region that cannot be counted as a whole is cut so far right of the continuous spectrum, in its size
MOST_TURNS = 200.0  # chosen: turns of D's phase along the hull; beyond, a search takes minutes
FEWER = 0.7  # chosen: the part of the claims that stays where the contour around all is too long
HULL_POINTS = 6  # chosen: points on the length of the hull at which D is asked what a contour costs
DEEPEST_CUT = 4  # chosen: cuts of a region that cannot be counted as a whole
MOST_PARTS = 16  # chosen: parts of it that are tried
MANY_UNSTABLE = 10  # chosen: more unstable claims than these, where they are most, are no list of instabilities
ABOVE_EDGE = 1e-3  # chosen: where the box around the growing modes begins, in the largest growth rate


class Missing(NamedTuple):
    """Modes that no claim means; where they were looked for, in words; what was not searched, and why; the same as a region, None where
    nothing was searched; and how many of the claims lie in it."""

    modes: tuple[Mode, ...]
    searched: str
    undecided: tuple[str, ...]
    region: Region | None = None
    claims_inside: int = 0


@dataclass(frozen=True)
class _Part:
    """A part of a region that could be searched."""

    continuation: Continuation
    zeros: list[Zero]
    whole: RegionCount


def require_missing(missing: str | None, region: Region | None) -> str:
    """How missing modes are to be looked for; without a wish in the region if there is one, else within the claims.

    Raises InputError for a wish that is none of MISSING, or that does not go with the region.
    """
    wish = missing or (WITHIN if region is None else REGION)
    if wish not in MISSING:
        raise InputError(f"missing = {missing!r}: allowed is {', '.join(MISSING)}")
    if (wish == REGION) != (region is not None):
        needed = "a region, in which they are looked for" if region is None else f"no region with missing = {wish!r}"
        raise InputError(f"missing = {wish!r}: needed is {needed}")
    return wish


def find_missing(
    continuation: Continuation,
    verdicts: Sequence[Verdict],
    region: Region | None,
    loose: Continuation,
    farthest: float,
    step_done: StepDone = lambda: None,
) -> Missing:
    """The modes that no claim means: in the region, or without one inside the convex hull of the claims.

    The hull is that of the claims that mean modes, as long as these are several; of those with the largest growth rates where the contour
    around all would be too long, and of none beyond the reach of a mesh. The loose continuation tells what a contour would cost.
    """
    claims = [v.claimed for v in verdicts]
    known = claimed_modes(verdicts)
    if region is not None:
        return _searched(continuation, region, known, claims, region.contains, "in the region", (), step_done)
    chosen, hull_region = _chosen(loose, verdicts, farthest)
    if hull_region is None:
        return Missing((), NOT_SEARCHED, ("the claims span no part of the plane that is small enough to be searched: name a region",))
    corners = convex_hull(tuple(chosen))
    nearest = ON_HULL * _extent(chosen)

    def among(sigma: complex) -> bool:
        return distance_outside(corners, sigma) <= nearest

    left = sum(not among(claim) for claim in claims)
    more = f"{left} more of the claims {'adds' if left == 1 else 'add'}"
    undecided = (f"the part of the plane that {more}: name a region to search there",) if left else ()
    return _searched(continuation, hull_region, known, claims, among, "among the claims", undecided, step_done)


def _searched(
    continuation: Continuation,
    region: Region,
    known: list[Zero],
    claims: list[complex],
    meant: Callable[[complex], bool],
    where: str,
    undecided: tuple[str, ...],
    step_done: StepDone,
) -> Missing:
    """The modes of a region that are not known and meant, from its unstable side on."""
    parts, left = _parts(continuation, region, known, step_done)
    undecided += tuple(left)
    if not parts:
        return Missing((), NOT_SEARCHED, undecided)
    modes: tuple[Mode, ...] = ()
    for part in parts:
        bounded: list[tuple[Zero, list[Mode]]] = []
        for zero in part.zeros:
            if not meant(zero.sigma):
                continue
            try:
                bounded.append((zero, _apart_from_known(part.continuation, zero, known)))
            except ConvergenceError as error:
                undecided += (f"the {number_of(zero.multiplicity, 'mode')} counted near {zero.sigma:.6g}: {error}",)
        modes += without_repetition([zero for zero, _ in bounded], [some for _, some in bounded])
        undecided += tuple(
            f"what lies within {d.radius:.1e} of the end {d.centre:.6g} of the continuous spectrum" for d in part.whole.left_out
        )
    inside = sum(meant(c) for c in claims)
    low, high = _extremes(region)
    said = f"{where}, from {low:.6g} to {high:.6g}, where {_how_many(inside, len(claims))}"
    return Missing(modes, said, undecided, region, inside)


def _apart_from_known(continuation: Continuation, zero: Zero, known: Sequence[Zero]) -> list[Mode]:
    """The modes that a zero found beside the known ones is.

    Where an iteration from it comes to a known one, which was not counted again, both are looked for in a circle about them.
    """
    modes = modes_of(continuation, zero, RTOL)
    if len(modes) != 1:
        return modes
    (mode,) = modes
    taken = [k for k in known if k.multiplicity == mode.multiplicity == 1 and abs(k.sigma - mode.sigma) <= k.radius + mode.error]
    if not taken or abs(zero.sigma - mode.sigma) <= taken[0].radius + mode.error:
        return modes
    middle = (zero.sigma + taken[0].sigma) / 2
    return modes_of(continuation, Zero(middle, zero.multiplicity + 1, abs(zero.sigma - taken[0].sigma)), RTOL)


def _how_many(inside: int, claims: int) -> str:
    """How many of the claims lie in a region, as a clause."""
    if claims == 1:
        return "the claim lies" if inside else "the claim does not lie"
    if inside == claims:
        return "both claims lie" if claims == 2 else f"all {claims} claims lie"
    return f"{inside} of the {claims} claims {'lies' if inside == 1 else 'lie'}"


def _parts(continuation: Continuation, region: Region, known: list[Zero], step_done: StepDone) -> tuple[list[_Part], list[str]]:
    """The region, or the parts of it that can be searched, the unstable ones first; of the others, where they are, and why not."""
    found, left = [], []
    waiting = [(0, region)]
    tried = 0
    while waiting:
        depth, part = waiting.pop()
        low, high = _extremes(part)
        tried += 1
        try:
            found.append(_Part(*find_modes(continuation, part, known, step_done)))
            continue
        except ConvergenceError as error:
            why = f"from {low:.6g} to {high:.6g}: {error}"
        halves = None
        if depth < DEEPEST_CUT and tried + len(waiting) < MOST_PARTS:
            halves = _right_of_the_spectrum(continuation, part) or next(divisions(part), None)
        if halves is None:
            left.append(why)
            continue
        waiting += sorted(((depth + 1, half) for half in halves), key=lambda item: _extremes(item[1])[1].real)
    return found, left


def _right_of_the_spectrum(continuation: Continuation, region: Region) -> tuple[Region, Region] | None:
    """The region cut a little right of the continuous spectrum; None if that does not pass to the left of its right side."""
    low, high = _extremes(region)
    edge = continuation.rightmost + CLEAR_OF_CONTINUUM * size(region)
    return divided(region, 1.0 + 0j, edge) if low.real < edge - 2 * CLEAR_OF_CONTINUUM * size(region) and edge < high.real else None


def _chosen(continuation: Continuation, verdicts: Sequence[Verdict], farthest: float) -> tuple[list[complex], Polygon | None]:
    """The claims in whose hull modes are looked for, and the hull with a margin; no claim and None where every contour is too long."""
    near_enough = [v for v in verdicts if abs(v.claimed) <= farthest]
    meant = [v.claimed for v in near_enough if v.sigma is not None]
    claims = meant if len(meant) > 1 else [v.claimed for v in near_enough]
    chosen = sorted(claims, key=lambda c: -c.real)
    while chosen:
        around = _around(chosen)
        if around is not None and _turns(continuation, around) <= MOST_TURNS:
            return chosen, around
        chosen = chosen[: min(len(chosen) - 1, math.ceil(FEWER * len(chosen)))]
    return [], None


def _around(claims: Sequence[complex]) -> Polygon | None:
    """The convex hull with a margin, so that no claim lies on its boundary; None if all claims are 0."""
    margin = HULL_MARGIN * _extent(claims)
    if margin == 0.0:
        return None
    corners = tuple(c + margin * complex(a, b) for c in claims for a in (-1, 1) for b in (-1, 1))
    return Polygon(convex_hull(corners))


def _extent(claims: Sequence[complex]) -> float:
    re, im = [c.real for c in claims], [c.imag for c in claims]
    return max(max(re) - min(re), max(im) - min(im), THINNEST_HULL * max(map(abs, claims)))


def _turns(continuation: Continuation, polygon: Polygon) -> float:
    """An estimate of how often the phase of D turns along the boundary, or ln |D| changes by 2π: a measure of its cost."""
    turns = 0.0
    for a, b in pairwise((*polygon.vertices, polygon.vertices[0])):
        segments = max(1, round(HULL_POINTS * abs(b - a) / size(polygon)))
        for k in range(segments):
            sigma = a + (k + 0.5) / segments * (b - a)
            try:
                slope = continuation.at(sigma).discriminant.with_derivative(sigma).logarithmic_derivative
            except ConvergenceError:
                continue  # a part of the region that cannot be searched, which will be said
            turns += abs(slope) * abs(b - a) / segments / (2 * math.pi)
    return turns


def told_missing(missing: Sequence[Mode], verdicts: Sequence[Verdict]) -> tuple[tuple[Mode, ...], tuple[str, ...]]:
    """The modes that are missing whatever is true of the claims that could not be settled, and of the others what is not decided.

    A claim that is unresolved, or not told apart from the continuous spectrum, may mean the nearest mode within two digits.
    """
    left, unsure = list(missing), []
    for i, verdict in enumerate(verdicts, 1):
        if verdict.sigma is not None or verdict.verdict not in (UNRESOLVED, CONTINUUM) or not left:
            continue
        nearest = min(left, key=lambda mode: abs(complex(mode.sigma) - verdict.claimed))
        within = max(verdict.atol, radius_of(verdict.claimed, NEAR_DIGITS) if verdict.claimed != 0.0 else 0.0)
        if abs(complex(nearest.sigma) - verdict.claimed) <= within + nearest.error:
            left.remove(nearest)
            unsure.append(f"whether the mode {complex(nearest.sigma):.6g} is missing: claim {i}, which is {verdict.verdict}, may mean it")
            if nearest.multiplicity > 1:
                left.append(replace(nearest, multiplicity=nearest.multiplicity - 1))
    return tuple(left), tuple(unsure)


def claimed_modes(verdicts: Sequence[Verdict]) -> list[Zero]:
    """The modes that claims mean, a multiple one as often as it is claimed."""
    return [Zero(v.sigma, 1, v.error or 0.0) for v in verdicts if v.sigma is not None]


def _extremes(region: Region) -> tuple[complex, complex]:
    """The lower left and the upper right corner of the box around the region."""
    re, im = [v.real for v in region.hull], [v.imag for v in region.hull]
    return complex(min(re), min(im)), complex(max(re), max(im))


def modes_with_bounds(continuation: Continuation, zeros: list[Zero]) -> tuple[Mode, ...]:
    """The zeros as modes with their error bars. Raises ConvergenceError where one has none."""
    return without_repetition(zeros, (modes_of(continuation, zero, RTOL) for zero in zeros))


def unstable_box(problem: Problem, claims: Sequence[complex], digits: int = VERDICT_DIGITS) -> Rectangle | None:
    """The box of the unstable claims, half as large again, right of the continuous spectrum; None if no claim is unstable to its digits.

    None too where most of many claims are: then the spectrum has no end towards growth, and the list ends where the reference does.
    """
    unstable = [c for c in claims if c.real > 10.0**-digits * abs(c)]
    if not unstable or (len(unstable) > MANY_UNSTABLE and 2 * len(unstable) > len(claims)):
        return None
    curve = continuum_of(problem)
    edge = 0.0 if curve is None else max(float(curve.sigma.real.max()), 0.0)
    top, low, high = max(c.real for c in unstable), min(c.imag for c in unstable), max(c.imag for c in unstable)
    height = max(high - low, top)
    return Rectangle(complex(edge + ABOVE_EDGE * top, low - 0.5 * height), complex(1.5 * top, high + 0.5 * height))
