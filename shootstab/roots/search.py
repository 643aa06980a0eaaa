"""All zeros of D inside a region, without a guess: count, take starting points from the moments of the contour, polish, divide if need be.

The n zeros inside have the power sums s_k = (1/2πi)∮ σ^k d ln D (Delves & Lyness, Math. Comp. 21 (1967) 543), s_1 … s_n give the polynomial
that has them as its zeros (Newton's identities), and an iteration on D polishes those. That is done while n is a handful; where it
is more, or the iterations do not arrive at n zeros, the region is divided. Zeros that lie close together are counted one by one in
small circles; those that no circle separates are one multiple zero.

Every length that decides anything is a fraction of the region at hand, so that a search does the same wherever the region lies: a zero at
σ = 0 is one like any other.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Protocol

import numpy as np

from shootstab.core.discriminant import Discriminant
from shootstab.core.division import divisions
from shootstab.core.errors import ConvergenceError, Inaccurate
from shootstab.core.numerus import number_of
from shootstab.core.regions import Disc, Region, size
from shootstab.roots.iterations import newton
from shootstab.roots.winding import Legs, power_sums

HANDFUL = 5  # chosen: zeros taken from the moments of one contour; the polynomial of more is ill-conditioned
# chosen: distances of zeros, in the region's size, that an iteration may confuse: such are counted one by one
CLOSE_ZEROS = (1e-6, 1e-4, 1e-2)
SAME_ZERO = 1e-8  # chosen: two numbers nearer to each other than this part of the region's size mean one zero
POLISHED_ZERO = 0.1 * SAME_ZERO  # derived: how exactly an iteration is to arrive for two arrivals at one zero to be the same
ZERO_NEWTON_STEPS = 20  # chosen: Newton's steps at most; to a simple zero it takes some 4, from a start that the moments give
# chosen, some ten times the rounding of D for an ordinary problem: of |σ|, the last step of an iteration that arrived
ARRIVAL_NOISE = 1e-11
LINEAR = 1e-4  # chosen: the last step, in sizes of the region, of an iteration that converges linearly, to a multiple zero
SMALLEST_REGION = 1e-9  # chosen: what is left in a part so small against the first region is one multiple zero
UNDIVIDED = 1e-3  # chosen: part of the first region that may stay one multiple zero where D is too inaccurate for a cut inside
RESOLVED_SIGMA = 1e-12  # chosen, some thousand times the rounding of σ: nothing smaller than this part of |σ| is divided or told apart
WIDER_CIRCLE = 8.0  # chosen: the radius of the next circle over that of one in which D is not accurate enough for a count
WIDEST_TO_NEXT = 0.3  # chosen: radius of a circle around zeros that belong together, in the distance to the next others


class Counted(Protocol):
    """A contour around zeros: how many there are, and the samples of D along it."""

    @property
    def count(self) -> int: ...

    @property
    def legs(self) -> Legs: ...


@dataclass(frozen=True)
class Zero:
    """A zero, or several within radius of sigma that are not told apart, of which multiplicity are meant; radius is 0 for a simple one."""

    sigma: complex
    multiplicity: int = 1
    radius: float = 0.0


@dataclass(frozen=True)
class Arrival:
    """Where an iteration came to: off is 0 next to a simple zero, and a bound on the distance to a multiple one, or to several."""

    sigma: complex
    off: float = 0.0


@dataclass(frozen=True)
class Search:
    """What a search asks of D.

    count tells the zeros in any region; closely does so in a small disc, and raises ConvergenceError where D is not accurate enough for
    it; polish leads from a starting point to a zero, known to the length given, or into the neighbourhood of several, or to None; holds
    says whether a point of a region is one of those that it counts.
    """

    count: Callable[[Region], Counted]
    closely: Callable[[Disc], Counted]
    polish: Callable[[complex, float], Arrival | None]
    holds: Callable[[Region, complex], bool] = lambda region, sigma: region.contains(sigma)


def polish(discriminant: Discriminant) -> Callable[[complex, float], Arrival | None]:
    """Newton's iteration, which leads from a starting point to a zero known to a length, or into the neighbourhood of several, or to None.

    Where the noise of D stops it earlier, it has arrived if its steps are short enough for SAME_ZERO. Next to an m-fold zero they become
    shorter by 1 − 1/m only, and are 1/m of the distance.
    """

    def arrive(start: complex, length: float) -> Arrival | None:
        root = newton(discriminant, start, length / max(abs(start), length), ZERO_NEWTON_STEPS)
        if root.step <= max(length * SAME_ZERO / POLISHED_ZERO, ARRIVAL_NOISE * abs(root.sigma)):
            return Arrival(root.sigma)
        return Arrival(root.sigma, HANDFUL * root.step) if root.step <= length * LINEAR / POLISHED_ZERO else None

    return arrive


def find(search: Search, region: Region, known: Sequence[Zero] = (), counted: Counted | None = None) -> list[Zero]:
    """The zeros in the region that are not known yet; counted is the count of the region, if that has been made.

    Raises ConvergenceError when a zero lies on the boundary of the region, or more are known than there are.
    """
    whole = search.count(region) if counted is None else counted
    return _search(search, region, whole, list(known), region)


def _rounding(region: Region) -> float:
    """The length below which numbers of the region are not told apart."""
    return RESOLVED_SIGMA * max(map(abs, region.hull))


def _said(counted: Counted) -> str:
    return number_of(counted.count, "zero was counted", "zeros were counted")


def _search(search: Search, region: Region, counted: Counted, known: list[Zero], first: Region) -> list[Zero]:
    here = [k for k in known if search.holds(region, k.sigma)]
    lacking = counted.count - sum(k.multiplicity for k in here)
    if lacking < 0:
        raise ConvergenceError(f"{_said(counted)} near {region.hull[0]:.6g}, fewer than are known there")
    if lacking == 0:
        return []
    if lacking <= HANDFUL:
        found = _from_moments(search, region, counted, here)
        if found is not None:
            return found
    if size(region) >= max(SMALLEST_REGION * size(first), _rounding(first)):
        try:
            parts = _parts(search, region, counted)
        except ConvergenceError:
            if size(region) > UNDIVIDED * size(first):
                raise
        else:
            return [z for part, n in parts for z in _search(search, part, n, known, first)]
    return [together(counted, lacking, region)]


def together(counted: Counted, multiplicity: int, region: Region) -> Zero:
    """The zeros of a region as one multiple zero, at their mean. Raises Inaccurate where that lies outside: D is noise on the contour."""
    mean = moments(counted)[0]
    if not all(abs(mean - corner) <= size(region) for corner in region.hull):
        raise Inaccurate(f"D is not known well enough near sigma = {region.hull[0]:.6g}: by it {_said(counted)} whose mean lies elsewhere")
    return Zero(mean, multiplicity, size(region))


def _parts(search: Search, region: Region, counted: Counted) -> list[tuple[Region, Counted]]:
    """Both parts of the region with their counts, cut where both can be counted and add up; ConvergenceError where nowhere."""
    why = "every straight cut crosses its boundary more than twice"
    for parts in divisions(region):
        try:
            counts = [search.count(part) for part in parts]
        except ConvergenceError as error:
            why = str(error)  # a zero on the cut, say: cut elsewhere
            continue
        total = sum(c.count for c in counts)
        if total != counted.count:
            why = f"{_said(counted)} in it and {' + '.join(str(c.count) for c in counts)} in its parts"
            continue
        return list(zip(parts, counts, strict=True))
    raise ConvergenceError(f"no way was found to divide a region at {region.hull[0]:.6g} of size {size(region):.1e}: {why}")


def moments(counted: Counted, known: Sequence[Zero] = ()) -> tuple[complex, list[complex]]:
    """The mean of the zeros inside that are not known, and approximations to each, from the moments of the contour."""
    n = counted.count - sum(k.multiplicity for k in known)
    samples = [v.sigma for _, values in counted.legs for v in values]
    middle = sum(samples) / len(samples)
    scale = max(abs(s - middle) for s in samples)
    s = power_sums(counted.legs, middle, scale, n)
    for zero in known:
        s -= zero.multiplicity * ((zero.sigma - middle) / scale) ** np.arange(n + 1)
    # Newton's identities: k e_k = Σ_{i=1}^k (−1)^{i−1} e_{k−i} s_i
    e = [1.0 + 0j]
    for k in range(1, n + 1):
        e.append(sum((-1) ** (i - 1) * e[k - i] * s[i] for i in range(1, k + 1)) / k)
    zeros = np.roots([(-1) ** k * e[k] for k in range(n + 1)])
    return middle + scale * complex(s[1]) / n, [middle + scale * complex(z) for z in zeros]


def _from_moments(search: Search, region: Region, counted: Counted, here: list[Zero]) -> list[Zero] | None:
    """The zeros that are not known, or None where they are not all found in this way."""
    found = _arrivals(search, region, moments(counted, here)[1], here)
    if counted.count > HANDFUL:  # circles around all that is known would cost more than parts of the region
        simple = len(found) == counted.count and all(a.off == 0.0 for a in found)
        return [Zero(a.sigma) for a in found[len(here) :]] if simple else None
    for close in CLOSE_ZEROS:
        groups = _groups(found, max(close * size(region), _rounding(region)))
        if len(found) == len(groups) == counted.count and all(a.off == 0.0 for a in found):
            return [Zero(a.sigma) for a in found[len(here) :]]
        try:
            parts = [_resolved(search, region, group, [g for g in groups if g is not group], close) for group in groups]
        except ConvergenceError:
            continue
        if sum(z.multiplicity for zeros, _ in parts for z in zeros) == counted.count:
            return [z for zeros, disc in parts for z in _unknown(zeros, [k for k in here if disc.contains(k.sigma)])]
    return None


def _unknown(zeros: list[Zero], known: list[Zero]) -> list[Zero]:
    """The zeros in a circle without those that are known there: each known one is the nearest that is left."""
    left = list(zeros)
    for k in known:
        for _ in range(k.multiplicity):
            nearest = min(left, key=lambda z: abs(z.sigma - k.sigma), default=None)
            if nearest is not None:
                left.remove(nearest)
                if nearest.multiplicity > 1:
                    left.append(replace(nearest, multiplicity=nearest.multiplicity - 1))
    return left


def _arrivals(search: Search, region: Region, starts: Sequence[complex], known: Sequence[Zero] = ()) -> list[Arrival]:
    """The known zeros, and the different ones at which iterations from these starts arrive in the region."""
    length = size(region)
    same = max(SAME_ZERO * length, _rounding(region))
    found = [Arrival(k.sigma) for k in known]
    for start in starts:
        zero = search.polish(start, POLISHED_ZERO * length)
        if zero is None or not search.holds(region, zero.sigma):
            continue
        if all(abs(zero.sigma - f.sigma) > max(same, zero.off, f.off) for f in found):
            found.append(zero)
    return found


def _groups(found: list[Arrival], close: float) -> list[list[Arrival]]:
    """The arrivals in groups of those that lie close together."""
    groups: list[list[Arrival]] = []
    for z in found:
        near = [g for g in groups if any(abs(z.sigma - other.sigma) < close + z.off + other.off for other in g)]
        groups = [g for g in groups if not any(g is n for n in near)] + [[z, *(other for g in near for other in g)]]
    return groups


def _resolved(search: Search, region: Region, group: list[Arrival], others: list[list[Arrival]], close: float) -> tuple[list[Zero], Disc]:
    """The zeros in a circle around a group, each simple if circles tell them apart, else one multiple zero; and the circle.

    Raises ConvergenceError where no circle around the group can be counted.
    """
    disc, counted = _circle(search, region, group, others, close)
    if counted.count == 0 or (counted.count == 1 and group[0].off > 0.0):
        raise ConvergenceError("an iteration stopped where no zero is")
    if counted.count == 1:
        return [Zero(group[0].sigma)], disc
    apart = _arrivals(search, disc, moments(counted)[1])
    if len(apart) == counted.count and all(_alone(search, z, [a for a in apart if a is not z]) for z in apart):
        return [Zero(z.sigma) for z in apart], disc
    return [Zero(moments(counted)[0], counted.count, disc.radius)], disc


def _circle(search: Search, region: Region, group: list[Arrival], others: list[list[Arrival]], close: float) -> tuple[Disc, Counted]:
    """The smallest circle around a group, clear of the others and inside the region, in which D is accurate enough for a count.

    Raises ConvergenceError where there is none.
    """
    centre = sum(a.sigma for a in group) / len(group)
    widest = WIDEST_TO_NEXT * min((abs(a.sigma - centre) for g in others for a in g), default=size(region))
    spread = max(abs(a.sigma - centre) + a.off for a in group)
    radius = min(widest, max(3 * spread, close * size(region), 3 * _rounding(region)))
    while True:
        disc = Disc(centre, radius)
        if not all(region.contains(disc.boundary(k / 8)) for k in range(8)):
            raise ConvergenceError("zeros lie too near to the boundary")
        try:
            return disc, search.closely(disc)
        except ConvergenceError:
            if radius >= widest:
                raise
        radius = min(widest, WIDER_CIRCLE * radius)


def _alone(search: Search, zero: Arrival, others: list[Arrival]) -> bool:
    """Whether a circle that leaves the others out holds one zero, as far as D can tell."""
    if zero.off > 0.0:
        return False
    try:
        return search.closely(Disc(zero.sigma, min(abs(zero.sigma - o.sigma) for o in others) / 3)).count == 1
    except ConvergenceError:
        return False
