"""A curve of the σ-plane by straight segments, its distance from a point, and whether it enters a region."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from shootstab.core.errors import Undecidable
from shootstab.core.regions import Region, size
from shootstab.problems.protocol import ComplexArray

NEAR_SEGMENT = 0.5  # chosen: a σ nearer to a segment than this part of its length asks the curve itself and not the segment
NEAREST_STEPS = 12  # chosen: the most steps of Gauss–Newton towards the nearest point of the curve; on it each gains several digits
SIGMA_ROUNDING = 1e-14  # chosen: part of |σ| and of the curve's scale; eigenvalues of a small pencil err by some 10 units of rounding
EIGHTHS = np.arange(8) / 8.0  # derived: an arc of a circle up to this long is nowhere farther from its middle than at its ends
SAGITTA = 0.9  # chosen: the curve lies no farther from a segment than a tenth of its length; 1 percent where σ ~ ℓ^p
MOST_BOUNDARY_PARTS = 4000  # chosen: parts of a boundary that are looked at for one curve; they take a second or two
SEGMENT_CUTS = 8  # chosen: parts into which a segment is cut that is too long for its chord
SHORTEST_TOUCH = 1e-9  # chosen: the length of boundary, in the size of a region, on which a curve counts as touching it
SLOPE_STEP = 1e-4  # chosen: the step of a central difference of a curve, in its scale: its square and the rounding over it are small


@dataclass(frozen=True, eq=False)
class Curve:
    """Segments with σ from begin to end (m,), as a parameter runs from low to high (m,).

    at, where the curve has it, gives all σ at a parameter. scale is a size of σ on the curve, to which its points round.
    """

    begin: ComplexArray
    end: ComplexArray
    low: NDArray[np.float64]
    high: NDArray[np.float64]
    at: Callable[[float], list[complex]] | None = None
    scale: float = 0.0

    def distance(self, sigma: complex) -> float:
        """The distance of σ to the curve, less what rounding makes of both: 0 where σ may lie on it."""
        if not self.begin.size:
            return np.inf
        return max(0.0, self._offset(sigma) - self._rounding(sigma))

    def _rounding(self, sigma: complex) -> float:
        """What σ and the curve are not known to."""
        return SIGMA_ROUNDING * (abs(sigma) + self.scale)

    def enters(self, region: Region) -> bool:
        """Whether a point of the curve lies in the region or on its boundary.

        A curve that is nowhere on the boundary is inside or outside as a whole. The boundary is cut until every part of it is shorter
        than its distance to the curve, or its chord apart from every segment where the curve is these. Raises Undecidable where that takes
        more than MOST_BOUNDARY_PARTS.
        """
        if not self.begin.size:
            return False
        if any(region.contains(complex(s)) for s in (*self._inside_hull(self.begin, region), *self._inside_hull(self.end, region))):
            return True
        parts = list(pairwise(np.union1d(region.corners, [*EIGHTHS, 1.0]).tolist()))
        thinnest = SHORTEST_TOUCH * size(region)
        looked_at = 0
        while parts:
            looked_at += 1
            first, last = parts.pop()
            middle = 0.5 * (first + last)
            here, before, behind = (region.boundary(t) for t in (middle, first, last))
            if looked_at > MOST_BOUNDARY_PARTS:
                near = f"within {self.distance(here):.1e} of sigma = {here:.6g}"
                raise Undecidable(f"the continuous spectrum runs along the boundary, {near}")
            length = max(abs(before - here), abs(behind - here))
            if self._at_least(here) > length:
                continue
            bow = abs(here - 0.5 * (before + behind))  # the height of the boundary over its chord
            if self._clear_of(before, behind, 2.0 * bow + self._rounding(here)):
                continue
            distance = self.distance(here)
            if SAGITTA * distance > length:
                continue
            if distance == 0.0 or length < thinnest:
                return True
            parts += [(first, middle), (middle, last)]
        return False

    @staticmethod
    def _inside_hull(points: ComplexArray, region: Region) -> ComplexArray:
        """The points that lie in the box around the region."""
        hull = np.array(region.hull)
        across = (points.real >= hull.real.min()) & (points.real <= hull.real.max())
        return np.asarray(points[across & (points.imag >= hull.imag.min()) & (points.imag <= hull.imag.max())])

    def _at_least(self, sigma: complex) -> float:
        """A lower bound on the distance, from the segments and their scale alone."""
        return float((self._segments(sigma)[1] - (1.0 - SAGITTA) * np.abs(self.end - self.begin)).min())

    def _offset(self, sigma: complex) -> float:
        """The distance of σ to the segments; where that is small against their length, to the curve itself."""
        t, offsets = self._segments(sigma)
        i = int(offsets.argmin())
        if self.at is None or offsets[i] > NEAR_SEGMENT * abs(self.end[i] - self.begin[i]):
            return float(offsets[i])
        width = float(self.high[i] - self.low[i])
        return self._to_curve(self.at, sigma, float(self.low[i] + t[i] * width), width)

    def _clear_of(self, p: complex, q: complex, margin: float) -> bool:
        """Whether the curve is seen to keep more than a margin from the chord from p to q.

        It keeps within a tenth of a segment's length of it. Segments too long for that are cut where `at` has the curve between their ends,
        as long as there are no more of them than MOST_BOUNDARY_PARTS.
        """
        distances = self._from_chord(p, q)
        if self.at is None:
            return bool(distances.min() > margin)
        lengths = np.abs(self.end - self.begin)
        near = np.flatnonzero(distances <= (1.0 - SAGITTA) * lengths + margin)
        if near.size == 0:
            return True
        if near.size * SEGMENT_CUTS > MOST_BOUNDARY_PARTS or lengths[near].min() < margin:
            return False
        return self._cut(near)._clear_of(p, q, margin)

    def _cut(self, which: NDArray[np.intp]) -> Curve:
        """The segments of these indices in SEGMENT_CUTS parts each, with the points of the curve that are nearest to theirs."""
        assert self.at is not None
        t = np.arange(SEGMENT_CUTS + 1) / SEGMENT_CUTS
        places = self.low[which, None] + (self.high - self.low)[which, None] * t
        sigma = self.begin[which, None] + (self.end - self.begin)[which, None] * t
        for i, j in np.ndindex(len(which), SEGMENT_CUTS - 1):
            sigma[i, j + 1] = _nearest(self.at(float(places[i, j + 1])), complex(sigma[i, j + 1]))
        low, high = places[:, :-1].ravel(), places[:, 1:].ravel()
        return Curve(sigma[:, :-1].ravel(), sigma[:, 1:].ravel(), low, high, self.at, self.scale)

    def _from_chord(self, p: complex, q: complex) -> NDArray[np.float64]:
        """The distance of each segment (m,) to the one from p to q; 0 where it crosses it."""
        a, b = self.begin, self.end
        chord = Curve(np.array([p]), np.array([q]), np.zeros(1), np.ones(1))
        ends = [chord._segments(end)[1] for end in (a, b)]
        nearest = np.min([*ends, self._segments(p)[1], self._segments(q)[1]], axis=0)
        return np.where(_crossed(a - p, b - p, q - p) & _crossed(p - a, q - a, b - a), 0.0, nearest)

    def _segments(self, sigma: complex | ComplexArray) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """The place, from 0 to 1, of the point of each segment (m,) nearest to σ, and its distance."""
        a, d = self.begin, self.end - self.begin
        with np.errstate(divide="ignore", invalid="ignore"):
            t = np.where(d != 0.0, ((sigma - a) * d.conj()).real / np.abs(d) ** 2, 0.0)
        t = np.clip(t, 0.0, 1.0)
        return t, np.abs(sigma - a - t * d)

    @staticmethod
    def _to_curve(at: Callable[[float], list[complex]], sigma: complex, parameter: float, width: float) -> float:
        """The least |σ_c − σ| met by Gauss–Newton, Re (σ_c − σ)* (σ_c + σ_c′ δ − σ) = 0, from a parameter on."""
        best, step = np.inf, SLOPE_STEP * width
        for _ in range(NEAREST_STEPS):
            here = _nearest(at(parameter), sigma)
            if not abs(here - sigma) < 0.5 * best:
                return float(min(best, abs(here - sigma)))
            best = abs(here - sigma)
            slope = (_nearest(at(parameter + step), sigma) - _nearest(at(parameter - step), sigma)) / (2.0 * step)
            if not np.isfinite(slope) or slope == 0.0:
                break
            parameter += min(max(((sigma - here) / slope).real, -width), width)
        return float(best)


def _crossed(a: ComplexArray, b: ComplexArray, along: complex | ComplexArray) -> NDArray[np.bool_]:
    """Whether a and b lie on different sides of the line through 0 along a direction, or on it."""
    return np.asarray((a * np.conj(along)).imag * (b * np.conj(along)).imag <= 0.0)


def _nearest(points: list[complex], sigma: complex) -> complex:
    """The one of the points that is nearest to σ; infinity if there is none."""
    return min(points, key=lambda s: abs(s - sigma), default=complex(np.inf))


def curve_through(sigma: ComplexArray, parameter: NDArray[np.float64]) -> Curve:
    """The curve through points sigma (m,), in this order, each with its value of the parameter (m,)."""
    return Curve(sigma[:-1], sigma[1:], parameter[:-1], parameter[1:], scale=float(np.median(np.abs(sigma))))
