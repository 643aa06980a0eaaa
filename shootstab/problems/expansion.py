"""An end at infinity whose decaying space is known by an asymptotic series: what the engine asks of it."""

from __future__ import annotations

import cmath
from dataclasses import dataclass
from typing import Protocol

from shootstab.problems.protocol import ComplexArray, FarFrame
from shootstab.problems.splitting import AsymptoticPencil, SpectralSplitting


@dataclass(frozen=True)
class Expanded:
    """The decaying space at one place: the range of X + X2 Y for X (n, k), X2 (n, n−k), where slope is dY/dσ, (n−k, k), with X and X2 held.

    The determinant of its solutions is exp(logarithm), with the σ-derivative log_slope; error is the relative one of Y.
    """

    X: ComplexArray
    X2: ComplexArray
    Y: ComplexArray
    slope: ComplexArray
    logarithm: complex
    log_slope: complex
    error: float

    def frame(self, frame: ComplexArray, tangent: ComplexArray, log_scale: float, split: SpectralSplitting) -> FarFrame:
        """The frame of the limit, (n, k) in the space of X, with its σ-derivative, carried from infinity to this place."""
        k = max(frame.shape[1], 1)
        M, moved = split.left @ frame, split.left @ tangent
        here = self.X + self.X2 @ self.Y
        at, turn = here @ M, cmath.exp(1j * self.logarithm.imag / k)
        slope = self.X2 @ (self.slope @ M) + here @ moved + self.log_slope / k * at
        return FarFrame(turn * at, turn * slope, log_scale + self.logarithm.real, self.error)


class AsymptoticSeries(Protocol):
    """The asymptotic series of an end."""

    @property
    def limit(self) -> AsymptoticPencil:
        """The leading pencil, whose rates are those of solutions over r^{q + 1}/(q + 1), r = |z|."""
        ...

    @property
    def bounded(self) -> bool:
        """Whether q = 0: the leading pencil is the limit of the problem's own, and its essential spectrum that of the problem."""
        ...

    def begins(self, k: int, reference: complex) -> float:
        """The nearest r at which the series of k decaying solutions holds to rounding, for σ of the size of the reference.

        Raises InputError where it holds nowhere.
        """
        ...

    def at(self, r: float, sigma: complex, split: SpectralSplitting) -> Expanded:
        """The decaying space at r; split is that of the leading pencil."""
        ...
