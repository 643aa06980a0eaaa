"""Continuous spectra that no path in z leads around: those of ends at infinity, which the limiting matrix gives.

σ lies on one where a solution neither grows nor decays, det[D0 + σ D1 − iℓ (C0 + σ C1)] = 0 for a real ℓ. There the decaying space is not
analytic in σ, or it is and what it decays like is not: nothing is counted across such a curve, nor beyond it.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Protocol

import numpy as np

from shootstab.problems.protocol import ComplexArray
from shootstab.vocabulary.regions import Region


class Ending(Protocol):
    """The limiting pencil at an end at infinity."""

    def rates(self, sigma: complex) -> ComplexArray:
        """By rising real part, growth outwards positive."""
        ...


@dataclass(frozen=True, eq=False)
class Barrier:
    """points (m,) on the curves of the ends, lines of points on other curves, and the ends with the number of solutions that decay."""

    points: ComplexArray
    lines: tuple[ComplexArray, ...]
    endings: tuple[tuple[Ending, int], ...]
    unit: complex = 1.0

    def distance(self, sigma: complex) -> float:
        """Of σ to the barrier, to a hundredth or so."""
        near = [float(np.abs(self.points - sigma).min())] if self.points.size else []
        return min(near + [_distance_to_line(line, sigma) for line in self.lines])

    @property
    def rightmost(self) -> float:
        """The largest real part on it."""
        return max(float(part.real.max()) for part in (self.points, *self.lines) if part.size)

    def enters(self, region: Region) -> bool:
        """Whether a part of it lies in the region."""
        low, high = box(region)
        for part in (self.points, *self.lines):
            near = part[(part.real >= low.real) & (part.real <= high.real) & (part.imag >= low.imag) & (part.imag <= high.imag)]
            if any(region.contains(complex(s)) for s in near):
                return True
        return False

    def beyond(self, sigma: complex) -> bool:
        """Whether a solution that counts as decaying grows at σ, or one that does not decays."""
        for ending, k in self.endings:
            rates = ending.rates(self.unit * sigma).real
            if (k > 0 and rates[k - 1] >= 0.0) or (k < len(rates) and rates[k] <= 0.0):
                return True
        return False

    def rescaled(self, unit: complex) -> Barrier:
        """The same for v with σ = unit·v."""
        return replace(self, points=self.points / unit, lines=tuple(line / unit for line in self.lines), unit=self.unit * unit)


def box(region: Region) -> tuple[complex, complex]:
    """Lower left and upper right of points on the boundary."""
    edge = np.array([region.boundary(t) for t in np.linspace(0.0, 1.0, 65)])
    return complex(edge.real.min(), edge.imag.min()), complex(edge.real.max(), edge.imag.max())


def _distance_to_line(line: ComplexArray, sigma: complex) -> float:
    a, d = line[:-1], np.diff(line)
    with np.errstate(divide="ignore", invalid="ignore"):
        t = np.where(d != 0.0, ((sigma - a) * d.conj()).real / np.abs(d) ** 2, 0.0)
    return float(np.abs(sigma - a - np.clip(t, 0.0, 1.0) * d).min())


def barrier_of(problem: object) -> Barrier | None:
    """The barrier of a problem, None if it has none."""
    found = getattr(problem, "barrier", None)
    return found if isinstance(found, Barrier) else None
