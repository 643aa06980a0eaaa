"""A curve of the σ-plane by straight pieces, and its distance from a point."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import scipy.optimize
from numpy.typing import NDArray

from shootstab.problems.protocol import ComplexArray

NEAR = 0.5  # chosen: a σ nearer to a piece than this part of its length asks the curve itself and not the piece


@dataclass(frozen=True, eq=False)
class Curve:
    """Pieces from low to high (m,) of a parameter with σ from begin to end (m,), and all σ of the curve at a parameter, if it has one."""

    begin: ComplexArray
    end: ComplexArray
    low: NDArray[np.float64]
    high: NDArray[np.float64]
    at: Callable[[float], list[complex]] | None = None

    def distance(self, sigma: complex) -> float:
        """The distance of σ to the pieces; where that is small against their length, to the curve between their ends."""
        if not self.begin.size:
            return np.inf
        a, d = self.begin, self.end - self.begin
        with np.errstate(divide="ignore", invalid="ignore"):
            t = np.where(d != 0.0, ((sigma - a) * d.conj()).real / np.abs(d) ** 2, 0.0)
        offsets = np.abs(sigma - a - np.clip(t, 0.0, 1.0) * d)
        i = int(offsets.argmin())
        at = self.at
        if at is None or offsets[i] > NEAR * abs(d[i]):
            return float(offsets[i])

        def offset(parameter: float) -> float:
            return min((abs(s - sigma) for s in at(parameter)), default=np.inf)

        width = self.high[i] - self.low[i]
        bounds = float(self.low[i] - width), float(self.high[i] + width)
        found = scipy.optimize.minimize_scalar(offset, bounds=bounds, method="bounded", options={"xatol": 1e-12 * width})
        return float(min(found.fun, abs(sigma - self.begin[i]), abs(sigma - self.end[i])))


def curve_through(sigma: ComplexArray, parameter: NDArray[np.float64]) -> Curve:
    """The curve through points (m,), in this order."""
    return Curve(sigma[:-1], sigma[1:], parameter[:-1], parameter[1:])
