"""Continuous spectra that no path in z leads around: those of ends at infinity, which the limiting matrix gives.

σ lies on one where a solution neither grows nor decays, det[D0 + σ D1 − iℓ (C0 + σ C1)] = 0 for a real ℓ. There the decaying space is not
analytic in σ, or it is and what it decays like is not: nothing is counted across such a curve, nor beyond it.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Protocol

import numpy as np
import scipy.optimize
from numpy.typing import NDArray

from shootstab.problems.protocol import ComplexArray
from shootstab.vocabulary.regions import Region

NEAR = 0.5  # of its length, how near to a piece of a curve σ lies where the curve itself is asked


class Ending(Protocol):
    """The limiting pencil at an end at infinity."""

    def rates(self, sigma: complex) -> ComplexArray:
        """By rising real part, growth outwards positive."""
        ...


@dataclass(frozen=True, eq=False)
class Curve:
    """Pieces from low to high (m,) of a parameter with σ from begin to end (m,), and all σ of the curve at a parameter, if it has one."""

    begin: ComplexArray
    end: ComplexArray
    low: NDArray[np.float64]
    high: NDArray[np.float64]
    at: Callable[[float], list[complex]] | None = None

    def distance(self, sigma: complex) -> float:
        """Of σ to the curve: to its pieces, and where that is near, to the curve between their ends."""
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


@dataclass(frozen=True, eq=False)
class Barrier:
    """The curves, and the ends with the number of solutions that decay there; in an eigenvalue v, where σ = unit·v."""

    curves: tuple[Curve, ...]
    endings: tuple[tuple[Ending, int], ...]
    unit: complex = 1.0

    def distance(self, sigma: complex) -> float:
        """Of σ to the barrier."""
        return min(curve.distance(self.unit * sigma) for curve in self.curves) / abs(self.unit)

    @property
    def points(self) -> ComplexArray:
        """Points on all curves."""
        return np.concatenate([curve.begin for curve in self.curves]) / self.unit

    @property
    def rightmost(self) -> float:
        """The largest real part on it."""
        return float(self.points.real.max(initial=-np.inf))

    def enters(self, region: Region) -> bool:
        """Whether a part of it lies in the region."""
        edge = np.array([region.boundary(t) for t in np.linspace(0.0, 1.0, 65)])
        points = self.points
        low, high = complex(edge.real.min(), edge.imag.min()), complex(edge.real.max(), edge.imag.max())
        near = points[(points.real >= low.real) & (points.real <= high.real) & (points.imag >= low.imag) & (points.imag <= high.imag)]
        return any(region.contains(complex(s)) for s in near)

    def beyond(self, sigma: complex) -> bool:
        """Whether a solution that counts as decaying grows at σ, or one that does not decays."""
        for ending, k in self.endings:
            rates = ending.rates(self.unit * sigma).real
            if (k > 0 and rates[k - 1] >= 0.0) or (k < len(rates) and rates[k] <= 0.0):
                return True
        return False

    def rescaled(self, unit: complex) -> Barrier:
        """The same for v with σ = unit·v."""
        return replace(self, unit=self.unit * unit)


def barrier_of(problem: object) -> Barrier | None:
    """The barrier of a problem, None if it has none."""
    found = getattr(problem, "barrier", None)
    return found if isinstance(found, Barrier) else None


def curve_through(sigma: ComplexArray, parameter: NDArray[np.float64]) -> Curve:
    """The curve through points (m,), in this order."""
    return Curve(sigma[:-1], sigma[1:], parameter[:-1], parameter[1:])
