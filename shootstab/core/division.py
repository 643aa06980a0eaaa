"""Regions of the σ-plane divided by straight cuts into two regions that cover them exactly."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from typing import Any

from shootstab.core.regions import Region

CUTS = (0.5, 0.47, 0.55, 0.41, 0.62, 0.36)  # chosen: places of a cut, as fractions of the region's length; the next where one will not do
TIPS = (0.2, 0.8, 0.07, 0.93, 0.02, 0.98)  # chosen: cuts at the tips of a region that is not convex, which others may cross often
CUT_SAMPLES = 8  # chosen: points between two corners of a boundary at which the side of the cut is looked at
BISECTIONS = 60  # derived: 2^−60 is below the rounding of t


@dataclass(frozen=True)
class Section:
    """What a chord cuts off a region: its boundary from t = first on to t = last, first < last < first + 1, and straight back.

    The chord may meet the boundary of the region nowhere else.
    """

    region: Region
    first: float
    last: float

    @cached_property
    def chord(self) -> tuple[complex, complex]:
        """Where the chord begins, at t = last, and where it ends, at t = first; the section lies on its left."""
        return self.region.boundary(self.last % 1.0), self.region.boundary(self.first % 1.0)

    @cached_property
    def corners(self) -> tuple[float, ...]:
        turns = [c + n for n in (0, 1) for c in self.region.corners[:-1]]
        inner = [self._inward(c) for c in sorted(turns) if self.first < c < self.last]
        return (0.0, *inner, 0.5, 1.0)

    @cached_property
    def hull(self) -> tuple[complex, ...]:
        a, b = self.chord
        return clipped(self.region.hull, a, b)

    def boundary(self, t: float) -> complex:
        """The boundary of the region for t ≤ 1/2, the chord beyond."""
        if t <= 0.5:
            return self.region.boundary((self.first + 2 * t * (self.last - self.first)) % 1.0)
        a, b = self.chord
        return a + (2 * t - 1) * (b - a)

    def parameter(self, sigma: complex) -> float:
        a, b = self.chord
        along = min(1.0, max(0.0, ((sigma - a) * (b - a).conjugate()).real / abs(b - a) ** 2))
        on_chord = 0.5 * (1 + along)
        outer = self.region.parameter(sigma)
        outer += 1.0 if outer < self.first else 0.0
        if outer > self.last:
            return on_chord
        return min((on_chord, self._inward(outer)), key=lambda t: abs(self.boundary(t) - sigma))

    def contains(self, sigma: complex) -> bool:
        a, b = self.chord
        return left_of(a, b, sigma) > 0.0 and self.region.contains(sigma)

    def as_dict(self) -> dict[str, Any]:
        return {"shape": "section", "of": self.region.as_dict(), "from": self.first, "to": self.last}

    def _inward(self, outer: float) -> float:
        """The t of this boundary at that of the region's."""
        return 0.5 * (outer - self.first) / (self.last - self.first)


def divisions(region: Region) -> Iterator[tuple[Section, Section]]:
    """Ways to cut a region in two by a chord: across its longer side, then across the other, in the middle first.

    There is one at least for every region with a boundary that does not cross itself.
    """
    re, im = [v.real for v in region.hull], [v.imag for v in region.hull]
    across_real = (1.0 + 0j, min(re), max(re))
    across_imaginary = (-1j, min(im), max(im))
    directions = [across_real, across_imaginary]
    if max(im) - min(im) > max(re) - min(re):
        directions.reverse()
    for cuts in (CUTS, TIPS):
        for turn, low, high in directions:
            for cut in cuts:
                parts = divided(region, turn, low + cut * (high - low))
                if parts is not None:
                    yield parts


def divided(region: Region, turn: complex, at: float) -> tuple[Section, Section] | None:
    """The parts of a region on both sides of the line Re(turn·σ) = at; None unless that crosses the boundary just twice."""
    crossings = _crossings(region, turn, at)
    if len(crossings) != 2:
        return None
    first, last = crossings
    return Section(region, first, last), Section(region, last, first + 1.0)


def _crossings(region: Region, turn: complex, at: float) -> list[float]:
    """The t at which the boundary crosses the line Re(turn·σ) = at."""

    def beyond(t: float) -> bool:
        return (turn * region.boundary(t % 1.0)).real > at

    ts = [a + (b - a) * i / CUT_SAMPLES for a, b in pairwise(region.corners) for i in range(CUT_SAMPLES)] + [1.0]
    found = []
    for low, high in pairwise(ts):
        side = beyond(low)
        if beyond(high) == side:
            continue
        for _ in range(BISECTIONS):
            middle = 0.5 * (low + high)
            low, high = (middle, high) if beyond(middle) == side else (low, middle)
        found.append(0.5 * (low + high))
    return found


def clipped(vertices: tuple[complex, ...], a: complex, b: complex) -> tuple[complex, ...]:
    """The part of a convex polygon on the left of the line from a to b."""
    out: list[complex] = []
    for p, q in zip(vertices, vertices[1:] + vertices[:1], strict=True):
        here, ahead = left_of(a, b, p), left_of(a, b, q)
        if here >= 0.0:
            out.append(p)
        if here * ahead < 0.0:
            out.append(p + here / (here - ahead) * (q - p))
    return tuple(out)


def left_of(a: complex, b: complex, sigma: complex) -> float:
    """Twice the signed area of the triangle: above 0 on the left of the line from a to b, below 0 on its right."""
    return ((b - a).conjugate() * (sigma - a)).imag


def distance_outside(points: tuple[complex, ...], sigma: complex) -> float:
    """How far σ lies outside a convex polygon (its corners counter-clockwise), or from a segment or a point; 0 inside."""
    sides = list(zip(points, points[1:] + points[:1], strict=True))
    if len(points) > 2 and all(left_of(a, b, sigma) >= 0.0 for a, b in sides):
        return 0.0
    return min(_from_segment(a, b, sigma) for a, b in sides)


def _from_segment(a: complex, b: complex, sigma: complex) -> float:
    if a == b:
        return abs(sigma - a)
    along = min(1.0, max(0.0, ((sigma - a) * (b - a).conjugate()).real / abs(b - a) ** 2))
    return abs(sigma - a - along * (b - a))
