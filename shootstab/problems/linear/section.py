"""A frame of the decaying space at infinity that is analytic in σ and nowhere degenerate.

Around any anchor a with R a basis of the space there, P(σ) R is a basis as long as the spaces at σ and a are not orthogonal in the sense
that det ℓR = 0; P = Xℓ is the spectral projector of split.py. Another anchor gives another frame, and D another factor. Kato's transport,
X′ = P′X from one reference σ0, has no such zeros; and of it the determinant is all that D sees:

    det[W X(σ)] = det[W P(σ) R] · c exp(−∫_a^σ f ds),   f = tr[(ℓR)⁻¹ ℓ P′ R],

because L′ = ℓ P′ for the dual rows of X, and det ℓR does not depend on which rows ℓ are. f is analytic: its integral is a power series
in a cell around each anchor, a square of such a size that the series converges, and c follows from cell to cell along a path to σ0. The
result does not depend on the path, as transport by an analytic equation does not, as long as two paths do not enclose a part of the
continuous spectrum.

The factor is exact to 1e-9 or so. It has no zeros, so that those of D are not touched by its error.
"""

from __future__ import annotations

import cmath
import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from shootstab.problems.linear.split import Limit, Split
from shootstab.problems.protocol import ComplexArray
from shootstab.vocabulary.errors import Undecidable

SAMPLES = 32
TERMS = 24  # kept of the series
CIRCLE = 2.0  # radius of the circle of samples, in sides of the cell
WALK = 1.05  # from an anchor towards σ0, out of its cell, in the same unit
TAIL = 1e-7  # of the series of f: its last terms on the circle; in the cell they are smaller by 2.8^24
LEVELS = 60  # halvings of the side
MOST = 4000  # cells: a path along a cut, instead of away from it, would need more


@dataclass(frozen=True, eq=False)
class Cell:
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


class Section:
    """The frame of the k solutions that decay fastest at an end, for any σ off the continuous spectrum."""

    def __init__(self, limit: Limit, k: int, reference: complex) -> None:
        self.limit, self.k, self.reference = limit, k, reference
        self._cells: dict[tuple[int, int, int], Cell | None] = {}

    def frame(self, sigma: complex) -> tuple[ComplexArray, ComplexArray, float, Split]:
        """The frame (n, k), its σ-derivative, the logarithm of a factor on its determinant, and the split they come from.

        Raises Undecidable on the continuous spectrum, and where no path leads to σ around it.
        """
        split = self.limit.split(sigma, self.k)
        if self.k in (0, len(split.A)):
            return split.X, np.zeros_like(split.X), 0.0, split
        cell = self._cell(sigma)
        frame, tangent = split.projected(cell.R)
        logarithm = cell.logarithm(sigma)
        turn = cmath.exp(1j * logarithm.imag / self.k)
        return turn * frame, turn * (tangent - split.slope(cell.R) / self.k * frame), logarithm.real, split

    def _cell(self, sigma: complex) -> Cell:
        """The largest cell around σ in which the series converges."""
        scale = max(abs(sigma - self.reference), abs(self.reference))
        top = math.ceil(math.log2(scale)) + 1
        for level in range(top, top - LEVELS, -1):
            side = 2.0**level
            offset = (sigma - self.reference) / side
            key = level, math.floor(offset.real + 0.5), math.floor(offset.imag + 0.5)
            if key not in self._cells:
                if len(self._cells) >= MOST:
                    break
                self._cells[key] = None  # as long as it is being made: no path to σ0 leads back into it
                self._cells[key] = self._made(self.reference + side * complex(key[1], key[2]), side)
            cell = self._cells[key]
            if cell is not None:
                return cell
        raise Undecidable(f"the decaying space at infinity cannot be continued to sigma = {sigma:.6g}: the continuous spectrum")

    def _made(self, anchor: complex, side: float) -> Cell | None:
        """The cell, joined to that of σ0; None if its series does not converge or σ0 cannot be reached."""
        circle = CIRCLE * side * np.exp(2j * np.pi * np.arange(SAMPLES) / SAMPLES)
        try:
            R = self.limit.split(anchor, self.k).X
            f = self._slopes(anchor + circle, R)
        except Undecidable:
            return None
        if not np.isfinite(f).all():
            return None
        series = np.fft.fft(f * CIRCLE * side) / SAMPLES
        if np.abs(series[TERMS:]).max() > TAIL * max(1.0, np.abs(series).max()):
            return None
        m = np.arange(TERMS)
        integral = np.concatenate(([0j], series[:TERMS] / ((m + 1) * CIRCLE ** (m + 1.0))))
        cell = Cell(anchor, side, R, integral)
        if abs(anchor - self.reference) < 0.25 * side:
            return cell
        up = 1j if anchor.imag >= self.reference.imag else -1j
        for away in (up, 1, -up, -1):
            try:
                return self._joined(cell, self._towards_reference(anchor, WALK * side, away))
            except Undecidable:
                continue
        return None

    def _joined(self, cell: Cell, place: complex) -> Cell:
        """With the c at which its determinant at a place in a cell nearer to σ0 is that cell's."""
        before = self._cell(place)
        left = self.limit.split(place, self.k).left
        ratio = complex(np.linalg.det(left @ before.R) / np.linalg.det(left @ cell.R))
        log_c = cmath.log(ratio) + before.logarithm(place) - cell.logarithm(place)
        return Cell(cell.anchor, cell.side, cell.R, cell.integral, log_c)

    def _towards_reference(self, anchor: complex, length: float, away: complex) -> complex:
        """So far along a path to σ0 that first goes away from the cut that may lie between, where cells are large, and then straight."""
        off = (anchor - self.reference) / away
        if off.real < abs(off.imag) and abs(off) > length:
            return anchor + length * away
        return anchor - min(1.0, length / abs(off)) * off * away

    def _slopes(self, sigmas: ComplexArray, R: ComplexArray) -> ComplexArray:
        """f at many σ, from eigenvectors; from Schur forms where the eigenvectors are no basis."""
        k = self.k
        A, slope = zip(*(self.limit.matrix(s) for s in sigmas.tolist()), strict=True)
        rates, V = np.linalg.eig(np.array(A))
        order = np.argsort(rates.real, axis=1)
        rates = np.take_along_axis(rates, order, axis=1)
        V = np.take_along_axis(V, order[:, None, :], axis=2)
        try:
            dual = np.linalg.inv(V)
        except np.linalg.LinAlgError:
            return np.array([self.limit.split(s, k).slope(R) for s in sigmas.tolist()])
        B = dual[:, :k] @ np.array(slope) @ V[:, :, k:]
        with np.errstate(divide="ignore", invalid="ignore"):
            G = B / (rates[:, :k, None] - rates[:, None, k:])
        try:
            inner = np.linalg.solve(dual[:, :k] @ R, G @ (dual[:, k:] @ R))
        except np.linalg.LinAlgError:
            raise Undecidable("the spaces on the circle do not project onto that of its centre") from None
        return np.asarray(np.trace(inner, axis1=1, axis2=2))


def reference_points() -> NDArray[np.complex128]:
    """Candidates for σ0, from small to large in every direction of the axes, growth first."""
    sizes = 10.0 ** np.arange(-4, 5)
    return np.array([s * d for d in (1, -1, 1j, -1j) for s in sizes], dtype=np.complex128)
