"""A frame of the decaying space at infinity that is analytic in σ and nowhere degenerate.

Around any anchor a with R a basis of the space there, P(σ) R is a basis as long as the spaces at σ and a are not orthogonal in the sense
that det ℓR = 0; P = Xℓ is the projector of splitting.py. Another anchor gives another frame, and D another factor. Kato's transport,
X′ = P′X from one reference σ0, has no such zeros; and of it the determinant is all that D sees:

    det[W X(σ)] = det[W P(σ) R] · c exp(−∫_a^σ f ds),   f = tr[(ℓR)⁻¹ ℓ P′ R],

because L′ = ℓ P′ for the dual rows of X, and det ℓR does not depend on which rows ℓ are. f is analytic: its integral is a power series
in a cell around each anchor, a square of such a size that the series converges, and c follows along a line to σ0 (kato_transport.py). The
result does not depend on the path, as transport by an analytic equation does not, as long as two paths do not enclose a part of the
continuous spectrum.

The solutions at a distance are X e^{Λ·distance}, Λ the matrix on the space: without that factor D(σ) would go as e^{−distance·tr Λ(σ)},
and Newton's iteration would see little else.

The factor is exact to 1e-9 or so. It has no zeros, so that those of D are not touched by its error.
"""

from __future__ import annotations

import cmath
import math
from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from shootstab.core.errors import Undecidable
from shootstab.problems.kato_transport import slopes, transported
from shootstab.problems.protocol import ComplexArray
from shootstab.problems.splitting import AsymptoticPencil, SpectralSplitting

CIRCLE_SAMPLES = 32  # chosen: samples of f on the circle, from which the series is found
KEPT_TERMS = 24  # chosen: kept of the series; a cell's corner is 2.8 times nearer than the circle, and 2.8^-24 is 2e-11
SAMPLE_RADIUS = 2.0  # chosen: radius of the circle of samples, in sides of the cell
SERIES_TAIL = 1e-7  # chosen: the last terms of the series of f on the circle; in the cell they are smaller by 2.8^24
MOST_HALVINGS = 60  # chosen: halvings of the side, more than a double has bits
NEIGHBOURHOOD = 4.0  # chosen: the distance of anchors, in the larger side, up to which a cell is joined to another one first
EIGHT_DIRECTIONS = np.exp(0.25j * np.pi * np.arange(8))  # chosen: directions of a path around a branch point
DETOURS = (0.5, 0.125, 2.0)  # chosen: how far it leads away, in the distance of σ0

CellKey = tuple[int, int, int]  # ln2 of the side, and the place of the anchor from σ0 in sides


@dataclass(frozen=True, eq=False)
class SeriesCell:
    """anchor, R (n, k), the coefficients of ∫f in powers of (σ − anchor)/side, and ln c."""

    anchor: complex
    side: float
    R: ComplexArray
    integral: ComplexArray
    log_c: complex = 0j

    def logarithm(self, sigma: complex) -> complex:
        """ln c − ∫f."""
        value = 0j
        x = (sigma - self.anchor) / self.side
        for coefficient in self.integral[::-1].tolist():
            value = value * x + coefficient
        return self.log_c - value


class KatoFrame:
    """The frame of the k solutions that decay fastest at an end, for any σ off the continuous spectrum."""

    def __init__(self, limit: AsymptoticPencil, k: int, reference: complex, distance: float = 0.0) -> None:
        self.limit, self.k, self.reference, self.distance = limit, k, reference, distance
        self._plain: dict[CellKey, SeriesCell | None] = {}
        self._joined: dict[CellKey, SeriesCell] = {}

    def frame(self, sigma: complex) -> tuple[ComplexArray, ComplexArray, float, SpectralSplitting]:
        """The frame (n, k), its σ-derivative, the logarithm of a factor on its determinant, and the split they come from.

        The solutions are what they would be at the given distance if they were those of the limiting matrix and began as X.

        Raises Undecidable on the continuous spectrum, and where no path leads to σ around it.
        """
        split = self.limit.splitting(sigma, self.k)
        if self.k in (0, len(split.A)):
            return self._whole(split)
        cell = self._cell(sigma)
        frame, tangent = split.projected(cell.R)
        logarithm = cell.logarithm(sigma) + self.distance * split.trace
        slope = self.distance * split.trace_slope - split.slope(cell.R)
        turn = cmath.exp(1j * logarithm.imag / self.k)
        return turn * frame, turn * (tangent + slope / self.k * frame), logarithm.real, split

    def _whole(self, split: SpectralSplitting) -> tuple[ComplexArray, ComplexArray, float, SpectralSplitting]:
        """Where all solutions decay, or none: a constant frame, but for the factor."""
        k = max(self.k, 1)
        logarithm, slope = self.distance * split.trace, self.distance * split.trace_slope
        turn = cmath.exp(1j * logarithm.imag / k)
        return turn * split.X, turn * slope / k * split.X, logarithm.real, split

    def _cell(self, sigma: complex) -> SeriesCell:
        """The largest cell around σ in which the series converges, joined to that of σ0."""
        key = self._key(sigma)
        if key not in self._joined:
            self._join(key, sigma)
        return self._joined[key]

    def _key(self, sigma: complex) -> CellKey:
        """Level and place of the largest cell around σ in which the series converges. Raises Undecidable if there is none."""
        scale = max(abs(sigma - self.reference), abs(self.reference))
        top = math.ceil(math.log2(scale)) + 1
        for level in range(top, top - MOST_HALVINGS, -1):
            offset = (sigma - self.reference) / 2.0**level
            key = level, math.floor(offset.real + 0.5), math.floor(offset.imag + 0.5)
            if key not in self._plain:
                self._plain[key] = self._made(self.reference + 2.0**level * complex(key[1], key[2]), 2.0**level)
            if self._plain[key] is not None:
                return key
        raise Undecidable(f"the decaying space at infinity is not analytic around sigma = {sigma:.6g}: the continuous spectrum")

    def _made(self, anchor: complex, side: float) -> SeriesCell | None:
        """The cell, with c = 1; None if its series does not converge."""
        circle = SAMPLE_RADIUS * side * np.exp(2j * np.pi * np.arange(CIRCLE_SAMPLES) / CIRCLE_SAMPLES)
        try:
            R = self.limit.splitting(anchor, self.k).X
            f, _ = slopes(self.limit, anchor + circle, R)
        except Undecidable:
            return None
        if not np.isfinite(f).all():
            return None
        series = np.fft.fft(f * SAMPLE_RADIUS * side) / CIRCLE_SAMPLES
        if np.abs(series[KEPT_TERMS:]).max() > SERIES_TAIL * max(1.0, np.abs(series).max()):
            return None
        m = np.arange(KEPT_TERMS)
        return SeriesCell(anchor, side, R, np.concatenate(([0j], series[:KEPT_TERMS] / ((m + 1) * SAMPLE_RADIUS ** (m + 1.0)))))

    def _join(self, key: CellKey, sigma: complex) -> None:
        """Find c of a cell by transport to σ0, or to a cell on the way whose c is known: on a straight line, or around what is in its way.

        Raises Undecidable where none of the lines is passable.
        """
        cell = self._cell_at(key)
        if key[1:] == (0, 0):
            self._joined[key] = cell
            return
        at_reference = self._key(self.reference)
        first = self._joined.setdefault(at_reference, self._cell_at(at_reference))
        for place, known in self._ways(cell, first):
            log_c = self._along(cell, place, known)
            if log_c is not None:
                self._joined[key] = replace(cell, log_c=log_c)
                return
        raise Undecidable(f"no path from {self.reference:.3g} to sigma = {sigma:.6g} was found around the continuous spectrum at infinity")

    def _ways(self, cell: SeriesCell, first: SeriesCell) -> Iterator[tuple[complex | None, SeriesCell]]:
        """Cells whose c is known, to which lines lead: a neighbour, and the one of σ0, straight and over other places.

        Those directions come first in which the gap between the rates grows most: away from the essential spectrum that is next to it.
        """
        a = cell.anchor
        near = min(self._joined.values(), key=lambda other: abs(other.anchor - a))
        if abs(near.anchor - a) <= NEIGHBOURHOOD * max(near.side, cell.side):
            yield None, near
        yield None, first
        rates = np.sort(self.limit.rates_at(a + SAMPLE_RADIUS * cell.side * EIGHT_DIRECTIONS).real, axis=1)
        for i in np.argsort(rates[:, self.k - 1] - rates[:, self.k]).tolist():
            for part in DETOURS:
                yield a + part * abs(self.reference - a) * complex(EIGHT_DIRECTIONS[i]), first

    def _along(self, cell: SeriesCell, place: complex | None, known: SeriesCell) -> complex | None:
        """ln c of a cell by transport along a line, over a place if one is given, to where c is known; None where it is not passable.

        A straight line is walked from the smaller of the two cells, since panels grow.
        """
        here, R, logarithm = cell.anchor, cell.R, 0j
        if place is None and known.side < cell.side:
            back = transported(self.limit, known.anchor, here, known.R, known.side)
            return None if back is None else known.log_c + back[1] + _log_ratio(self.limit.splitting(here, self.k).left, back[2], R)
        for goal in (known.anchor,) if place is None else (place, known.anchor):
            length = cell.side if here == cell.anchor else abs(goal - here)
            moved = transported(self.limit, here, goal, R, length, lambda at: self._holding(at) is not None)
            if moved is None:
                return None
            here, more, R = moved
            logarithm += more
            met = self._holding(here)
            if met is not None:
                return met.logarithm(here) + _log_ratio(self.limit.splitting(here, self.k).left, met.R, R) - logarithm
        return None

    def _holding(self, place: complex) -> SeriesCell | None:
        """The smallest cell whose c is known that holds a place."""
        held = [c for c in self._joined.values() if max(abs((place - c.anchor).real), abs((place - c.anchor).imag)) <= 0.5 * c.side]
        return min(held, key=lambda c: c.side, default=None)

    def _cell_at(self, key: CellKey) -> SeriesCell:
        cell = self._plain[key]
        assert cell is not None
        return cell


def _log_ratio(left: ComplexArray, R: ComplexArray, S: ComplexArray) -> complex:
    """ln (det ℓR / det ℓS) of two bases (n, k) by rows ℓ (k, n)."""
    return cmath.log(complex(np.linalg.det(left @ R) / np.linalg.det(left @ S)))
