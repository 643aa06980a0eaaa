"""All zeros of D inside a region, without a guess: count, take starting points from the moments of the contour, polish, divide if need be.

The n zeros inside have the power sums s_k = (1/2πi)∮ σ^k d ln D (Delves & Lyness, Math. Comp. 21 (1967) 543), s_1 … s_n give the polynomial
that has them as its zeros (Newton's identities), and an iteration on D polishes those. That is done while n is a handful; where it
is more, or the iterations do not arrive at n zeros, the region is divided. Zeros that lie close together are counted one by one in
small circles; those that no circle separates are one multiple zero.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Protocol

import numpy as np

from shootstab.core.errors import ConvergenceError
from shootstab.core.regions import Disc, Region, halves, size
from shootstab.roots.winding import Pieces, power_sums

HANDFUL = 5  # zeros taken from the moments of one contour
CLOSE = 1e-5  # relative distance of two zeros that an iteration may confuse: such are counted one by one
SAME = 1e-7  # relative distance below which two numbers mean one zero
SMALLEST = 1e-9  # of the first region's size: what is left in so small a part is one multiple zero
RESOLVED = 1e-12  # of |σ|: nothing is divided further
CUTS = (0.5, 0.47, 0.55, 0.41, 0.62, 0.36)  # where a region is divided; the next if a zero lies on the cut


class Counted(Protocol):
    """A contour around zeros: how many there are, and the samples of D along it."""

    @property
    def count(self) -> int: ...

    @property
    def pieces(self) -> Pieces: ...


@dataclass(frozen=True)
class Zero:
    """A zero, or several within radius of sigma that are not told apart, of which multiplicity are meant; radius is 0 for a simple one."""

    sigma: complex
    multiplicity: int = 1
    radius: float = 0.0


@dataclass(frozen=True)
class Search:
    """What a search asks of D.

    count tells the zeros in any region; closely does so in a small disc, and raises ConvergenceError where D is not accurate enough for
    it; polish leads from a starting point to a zero, or to None; holds says whether a point of a region is one of those that it counts.
    """

    count: Callable[[Region], Counted]
    closely: Callable[[Disc], Counted]
    polish: Callable[[complex], complex | None]
    holds: Callable[[Region, complex], bool] = lambda region, sigma: region.contains(sigma)


def find(search: Search, region: Region, known: Sequence[Zero] = (), counted: Counted | None = None) -> list[Zero]:
    """The zeros in the region that are not known yet; counted is the count of the region, if that has been made.

    Raises ConvergenceError when a zero lies on the boundary of the region, or more are known than there are.
    """
    whole = search.count(region) if counted is None else counted
    smallest = max(SMALLEST * size(region), RESOLVED * max(map(abs, region.hull)))
    return _search(search, region, whole, list(known), smallest)


def _search(search: Search, region: Region, counted: Counted, known: list[Zero], smallest: float) -> list[Zero]:
    here = [k for k in known if search.holds(region, k.sigma)]
    lacking = counted.count - sum(k.multiplicity for k in here)
    if lacking < 0:
        raise ConvergenceError(f"{counted.count} zeros were counted near {region.hull[0]:.6g}, fewer than are known there")
    if lacking == 0:
        return []
    if counted.count <= HANDFUL:
        found = _from_moments(search, region, counted, here)
        if found is not None:
            return found
    if size(region) < smallest:
        centroid, _ = moments(counted)
        return [Zero(centroid, lacking, size(region))]
    return _divided(search, region, counted, known, smallest)


def _divided(search: Search, region: Region, counted: Counted, known: list[Zero], smallest: float) -> list[Zero]:
    """The zeros of both halves of the region's hull, those outside the region left out."""
    why = ""
    for cut in CUTS:
        parts = halves(region, cut)
        try:
            counts = [search.count(part) for part in parts]
        except ConvergenceError as error:
            why = str(error)  # a zero on the cut, say: cut elsewhere
            continue
        found = [z for part, n in zip(parts, counts, strict=True) for z in _search(search, part, n, known, smallest)]
        inside = [z for z in found if search.holds(region, z.sigma)]
        total = sum(z.multiplicity for z in (*inside, *(k for k in known if search.holds(region, k.sigma))))
        if total != counted.count:
            raise ConvergenceError(f"{counted.count} zeros were counted near {region.hull[0]:.6g}, but {total} found")
        return inside
    raise ConvergenceError(f"no way was found to divide a region at {region.hull[0]:.6g} of size {size(region):.1e}: {why}")


def moments(counted: Counted) -> tuple[complex, list[complex]]:
    """The mean of the zeros inside, and approximations to each, from the moments of the contour."""
    n = counted.count
    samples = [v.sigma for _, values in counted.pieces for v in values]
    middle = sum(samples) / len(samples)
    scale = max(abs(s - middle) for s in samples)
    s = power_sums(counted.pieces, middle, scale, n)
    # Newton's identities: k e_k = Σ_{i=1}^k (−1)^{i−1} e_{k−i} s_i
    e = [1.0 + 0j]
    for k in range(1, n + 1):
        e.append(sum((-1) ** (i - 1) * e[k - i] * s[i] for i in range(1, k + 1)) / k)
    zeros = np.roots([(-1) ** k * e[k] for k in range(n + 1)])
    return middle + scale * complex(s[1]) / n, [middle + scale * complex(z) for z in zeros]


def _from_moments(search: Search, region: Region, counted: Counted, here: list[Zero]) -> list[Zero] | None:
    """The zeros that are not known, or None where they are not all found in this way."""
    found = [k.sigma for k in here]
    for start in moments(counted)[1]:
        zero = search.polish(start)
        if zero is not None and search.holds(region, zero) and all(abs(zero - f) > SAME * abs(zero) for f in found):
            found.append(zero)
    groups = _groups(found)
    if len(found) == counted.count and len(groups) == counted.count:
        return [Zero(z) for z in found[len(here) :]]
    try:
        parts = [_resolved(search, region, group, [g for g in groups if g is not group]) for group in groups]
    except ConvergenceError:
        return None
    zeros = [z for part in parts for z in part]
    if sum(z.multiplicity for z in zeros) != counted.count:
        return None
    lacking = []
    for z in zeros:
        known = sum(k.multiplicity for k in here if abs(z.sigma - k.sigma) <= max(z.radius, k.radius, SAME * abs(z.sigma)))
        if known < z.multiplicity:
            lacking.append(replace(z, multiplicity=z.multiplicity - known))
    return lacking


def _groups(found: list[complex]) -> list[list[complex]]:
    """The numbers in groups of those that lie close together."""
    groups: list[list[complex]] = []
    for z in found:
        near = [g for g in groups if any(abs(z - other) < CLOSE * abs(z) for other in g)]
        groups = [g for g in groups if not any(g is n for n in near)] + [[z, *(other for g in near for other in g)]]
    return groups


def _resolved(search: Search, region: Region, group: list[complex], others: list[list[complex]]) -> list[Zero]:
    """The zeros in a circle around a group: each simple if circles tell them apart, else one multiple zero.

    Raises ConvergenceError where the circle cannot be counted.
    """
    centre = sum(group) / len(group)
    gap = min((abs(z - centre) for g in others for z in g), default=size(region))
    radius = min(0.3 * gap, max(3 * max(abs(z - centre) for z in group), CLOSE * abs(centre)))
    disc = Disc(centre, radius)
    if not all(region.contains(disc.boundary(k / 8)) for k in range(8)):
        raise ConvergenceError("zeros lie too near to the boundary")
    counted = search.closely(disc)
    if counted.count == 0:
        raise ConvergenceError("an iteration stopped where no zero is")
    if counted.count == 1:
        return [Zero(group[0])]
    centroid, starts = moments(counted)
    apart: list[complex] = []
    for start in starts:
        zero = search.polish(start)
        if zero is not None and disc.contains(zero) and all(abs(zero - a) > SAME * abs(zero) for a in apart):
            apart.append(zero)
    if len(apart) == counted.count and all(_alone(search, z, [a for a in apart if a != z]) for z in apart):
        return [Zero(z) for z in apart]
    return [Zero(centroid, counted.count, radius)]


def _alone(search: Search, zero: complex, others: list[complex]) -> bool:
    """Whether a circle that leaves the others out holds one zero, as far as D can tell."""
    try:
        return search.closely(Disc(zero, min(abs(zero - o) for o in others) / 3)).count == 1
    except ConvergenceError:
        return False
