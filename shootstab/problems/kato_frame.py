"""A frame of the decaying space at infinity that is analytic in σ and nowhere degenerate.

Around any anchor a with R a basis of the space there, P(σ) R is a basis as long as the spaces at σ and a are not orthogonal in the sense
that det ℓR = 0; P = Xℓ is the projector of splitting.py. Another anchor gives another frame, and D another factor. Kato's transport,
X′ = P′X from one reference σ0, has no such zeros; and of it the determinant is all that D sees:

    det[W X(σ)] = det[W P(σ) R] · c exp(−∫_a^σ f ds),   f = tr[(ℓR)⁻¹ ℓ P′ R],

because L′ = ℓ P′ for the dual rows of X, and det ℓR does not depend on which rows ℓ are. f is analytic: its integral is a power series
in a cell around each anchor, a square of such a size that the series converges, and c follows from cell to cell along a path to σ0. The
result does not depend on the path, as transport by an analytic equation does not, as long as two paths do not enclose a part of the
continuous spectrum.

The solutions at a distance are X e^{Λ·distance}, Λ the matrix on the space: without that factor D(σ) would go as e^{−distance·tr Λ(σ)},
and Newton's iteration would see little else.

The factor is exact to 1e-9 or so. It has no zeros, so that those of D are not touched by its error.
"""

from __future__ import annotations

import cmath
import heapq
import math
from dataclasses import dataclass, replace

import numpy as np

from shootstab.core.errors import Undecidable
from shootstab.problems.protocol import ComplexArray
from shootstab.problems.splitting import AsymptoticPencil, SpectralSplitting

CIRCLE_SAMPLES = 32  # chosen: samples of f on the circle, from which the series is found
KEPT_TERMS = 24  # chosen: kept of the series; a cell's corner is 2.8 times nearer than the circle, and 2.8^-24 is 2e-11
SAMPLE_RADIUS = 2.0  # chosen: radius of the circle of samples, in sides of the cell
WALK = 1.05  # chosen: the way from an anchor to a place in a neighbouring cell, in the same unit
SERIES_TAIL = 1e-7  # chosen: the last terms of the series of f on the circle; in the cell they are smaller by 2.8^24
MOST_HALVINGS = 60  # chosen: halvings of the side, more than a double has bits
MOST_CELLS = 600  # chosen: cells looked at for one path, some seconds
MOST_STRAIGHT = 48  # chosen: cells on a straight line, more than lie on one that keeps off the continuous spectrum
PER_DOUBLING = 3.0  # chosen: steps that a change of the cell's size counts for in the search of a path
EIGHT_DIRECTIONS = np.exp(0.25j * np.pi * np.arange(8)).tolist()  # chosen: directions of a path around a branch point

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
            f = self._slopes(anchor + circle, R)
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
        """Find c of a cell along the straight line to σ0, or else along neighbours that lead to σ0 or to a cell whose c is known.

        Those come first that seem nearest to σ0: so a path leads away from a cut first, to where cells are large. Raises Undecidable where
        none is found.
        """
        straight = self._straight(key)
        if straight is not None:
            self._walk_back(*straight)
            return
        queue: list[tuple[float, int, CellKey]] = [(0.0, 0, key)]
        came: dict[CellKey, tuple[CellKey, complex] | None] = {key: None}
        while queue and len(came) < MOST_CELLS:
            _, _, here = heapq.heappop(queue)
            if here in self._joined or here[1:] == (0, 0):
                self._joined.setdefault(here, self._cell_at(here))
                self._walk_back(here, came)
                return
            cell = self._cell_at(here)
            for direction in EIGHT_DIRECTIONS:
                place = cell.anchor + WALK * cell.side * direction
                try:
                    there = self._key(place)
                except Undecidable:
                    continue
                if there not in came:
                    came[there] = here, place
                    heapq.heappush(queue, (self._steps_left(self._cell_at(there)), len(came), there))
        raise Undecidable(f"no path from {self.reference:.3g} to sigma = {sigma:.6g} was found around the continuous spectrum at infinity")

    def _straight(self, key: CellKey) -> tuple[CellKey, dict[CellKey, tuple[CellKey, complex] | None]] | None:
        """The cells on the line from one to σ0 or to the first whose c is known, each with that it came from; None if a cut is near it."""
        came: dict[CellKey, tuple[CellKey, complex] | None] = {key: None}
        here = key
        while here not in self._joined and here[1:] != (0, 0):
            cell = self._cell_at(here)
            way = self.reference - cell.anchor
            place = cell.anchor + min(WALK * cell.side, abs(way)) * way / abs(way)
            try:
                there = self._key(place)
            except Undecidable:
                return None
            if there in came or len(came) == MOST_STRAIGHT:
                return None
            came[there] = here, place
            here = there
        self._joined.setdefault(here, self._cell_at(here))
        return here, came

    def _steps_left(self, cell: SeriesCell) -> float:
        """The estimated number of cells between one and σ0: as many as the way has sides, and some for every doubling of the side on it."""
        at_reference = self._cell_at(self._key(self.reference)).side
        return abs(cell.anchor - self.reference) / cell.side + PER_DOUBLING * abs(math.log2(cell.side / at_reference))

    def _walk_back(self, here: CellKey, came: dict[CellKey, tuple[CellKey, complex] | None]) -> None:
        """c of every cell on the path: at the place where two meet, their determinants are the same."""
        step = came[here]
        while step is not None:
            key, place = step
            before, cell = self._joined[here], self._cell_at(key)
            left = self.limit.splitting(place, self.k).left
            ratio = complex(np.linalg.det(left @ before.R) / np.linalg.det(left @ cell.R))
            self._joined[key] = replace(cell, log_c=cmath.log(ratio) + before.logarithm(place) - cell.logarithm(place))
            here, step = key, came[key]

    def _cell_at(self, key: CellKey) -> SeriesCell:
        cell = self._plain[key]
        assert cell is not None
        return cell

    def _slopes(self, sigmas: ComplexArray, R: ComplexArray) -> ComplexArray:
        """f at many σ, from eigenvectors; from Schur forms where the eigenvectors are no basis."""
        k = self.k
        A, slope = self.limit.matrices(sigmas)
        rates, V = np.linalg.eig(A)
        order = np.argsort(rates.real, axis=1)
        rates = np.take_along_axis(rates, order, axis=1)
        V = np.take_along_axis(V, order[:, None, :], axis=2)
        try:
            dual = np.linalg.inv(V)
        except np.linalg.LinAlgError:
            return np.array([self.limit.splitting(s, k).slope(R) for s in sigmas.tolist()])
        B = dual[:, :k] @ slope @ V[:, :, k:]
        with np.errstate(divide="ignore", invalid="ignore"):
            G = B / (rates[:, :k, None] - rates[:, None, k:])
        if not np.isfinite(G).all():
            raise Undecidable("on the circle two rates that are to be told apart are one")
        try:
            inner = np.linalg.solve(dual[:, :k] @ R, G @ (dual[:, k:] @ R))
        except np.linalg.LinAlgError:
            raise Undecidable("the spaces on the circle do not project onto that of its centre") from None
        return np.asarray(np.trace(inner, axis1=1, axis2=2))
