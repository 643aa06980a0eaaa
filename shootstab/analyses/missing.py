"""The modes that a claimed spectrum lacks, and in words where they were looked for and what could not be searched."""

from __future__ import annotations

import math
from collections.abc import Iterable

from shootstab.analyses.find import find_modes, modes_of
from shootstab.core.errors import ConvergenceError
from shootstab.core.records import Mode, Verdict
from shootstab.core.regions import Rectangle, Region
from shootstab.discriminants.continuation import Continuation, Undecidable
from shootstab.essential_spectrum.interior import continuum_of
from shootstab.problems.protocol import Problem
from shootstab.roots.search import Zero

MARGIN = 0.05  # of the box that the claims span
CLEAR = 1e-4  # of the box, how far right of the continuous spectrum a search begins
NOT_SEARCHED = "missing modes were not looked for"
MOST_TURNS = 60.0  # of D's phase along the box in which missing modes are looked for
FIRST_PART, LARGER = 4, 4.0  # the box of the smallest quarter of the claims is tried first, then those of claims so many times larger
POINTS = 12
MISSING_RTOL = 1e-10


def find_missing(
    continuation: Continuation, verdicts: list[Verdict], region: Region | None, loose: Continuation, reach: float
) -> tuple[tuple[Mode, ...], str, tuple[str, ...]]:
    """Modes in the region that no claim means; where they were looked for; what could not be searched.

    Without a region it is the box of those claims that are not beyond the reach of a mesh; the loose continuation tells what a box
    would cost.
    """
    claims = [v.claimed for v in verdicts]
    undecided: tuple[str, ...] = ()
    box = region
    if box is None:
        box, undecided = _searchable(loose, claims, reach)
        if box is None:
            return (), NOT_SEARCHED, undecided
    known = claimed_modes(verdicts)
    low, high = _extremes(box)
    try:
        _, zeros, whole = find_modes(continuation, box, known)
    except ConvergenceError as error:
        undecided += (f"from {low:.6g} to {high:.6g}: {error}",)
        if not isinstance(error, Undecidable) or not isinstance(box, Rectangle):
            return (), NOT_SEARCHED, undecided
        # the part right of the continuous spectrum, where instability is
        edge = max(continuation.rightmost, 0.0) + CLEAR * abs(high)
        if high.real <= edge:
            return (), NOT_SEARCHED, undecided
        low = complex(max(edge, low.real), low.imag)
        try:
            _, zeros, whole = find_modes(continuation, Rectangle(low, high), known)
        except ConvergenceError as again:
            return (), NOT_SEARCHED, (*undecided, f"from {low:.6g} to {high:.6g}: {again}")
    where = f"missing modes were looked for from {low:.6g} to {high:.6g}, which holds {whole.count}"
    left_out = tuple(f"what lies within {d.radius:.1e} of the end {d.centre:.6g} of the continuous spectrum" for d in whole.left_out)
    return modes_with_bounds(continuation, zeros), where, undecided + left_out


def _searchable(continuation: Continuation, claims: list[complex], reach: float) -> tuple[Rectangle | None, tuple[str, ...]]:
    """The box that the claims span, without the largest of them where the contour around it would be too long; what was left out.

    It is looked for from the smallest claims on: D at large |σ| is dear.
    """
    sizes = sorted(abs(c) for c in claims if abs(c) <= reach)
    chosen: Rectangle | None = None
    inside = 0
    limit = max(sizes[len(sizes) // FIRST_PART], 1e-300) if sizes else 0.0
    while inside < len(sizes):
        kept = [c for c in claims if abs(c) <= limit]
        box = _box(kept)
        if box is not None and _turns(continuation, box) > MOST_TURNS:
            break
        chosen, inside, limit = box, len(kept), limit * LARGER
    if chosen is None:
        return None, ("the claims span no box that is small enough to be searched: name a region",)
    if inside == len(claims):
        return chosen, ()
    return chosen, (f"the part of the box that the {len(claims) - inside} largest claims add: name a region to search there",)


def _turns(continuation: Continuation, box: Rectangle) -> float:
    """About how often the phase of D turns along the boundary, or ln |D| changes by 2π: a measure of its cost."""
    turns = 0.0
    for k in range(POINTS):
        sigma = box.boundary((k + 0.5) / POINTS)
        try:
            slope = continuation.at(sigma).discriminant.with_derivative(sigma).logarithmic_derivative
        except ConvergenceError:
            return math.inf
        turns += abs(slope) * abs(box.boundary((k + 1) / POINTS) - box.boundary(k / POINTS)) / (2 * math.pi)
    return turns


def claimed_modes(verdicts: list[Verdict]) -> list[Zero]:
    """The modes that claims mean, a multiple one as often as it is claimed."""
    return [Zero(v.sigma, 1, v.error or 0.0) for v in verdicts if v.sigma is not None]


def _extremes(region: Region) -> tuple[complex, complex]:
    """Lower left and upper right of what the region reaches over."""
    hull = region.hull
    re, im = [v.real for v in hull], [v.imag for v in hull]
    return complex(min(re), min(im)), complex(max(re), max(im))


def modes_with_bounds(continuation: Continuation, zeros: list[Zero]) -> tuple[Mode, ...]:
    return tuple(mode for zero in zeros for mode in modes_of(continuation, zero, MISSING_RTOL))


def _box(claims: list[complex]) -> Rectangle | None:
    """The box that the claims span, a little larger so that none of them lies on its boundary."""
    re, im = [c.real for c in claims], [c.imag for c in claims]
    size = max(max(re) - min(re), max(im) - min(im), 0.1 * max(map(abs, claims)))
    if size == 0.0:
        return None
    margin = MARGIN * size * complex(1, 1)
    return Rectangle(complex(min(re), min(im)) - margin, complex(max(re), max(im)) + margin)


def unstable_box(problem: Problem, claims: Iterable[complex]) -> Rectangle | None:
    """The box of the unstable claims, half as large again, right of the continuous spectrum; None if no claim is unstable."""
    unstable = [c for c in claims if c.real > 0.0]
    if not unstable:
        return None
    curve = continuum_of(problem)
    edge = 0.0 if curve is None else max(float(curve.sigma.real.max()), 0.0)
    top, low, high = max(c.real for c in unstable), min(c.imag for c in unstable), max(c.imag for c in unstable)
    height = max(high - low, top)
    return Rectangle(complex(edge + 1e-3 * top, low - 0.5 * height), complex(1.5 * top, high + 0.5 * height))
