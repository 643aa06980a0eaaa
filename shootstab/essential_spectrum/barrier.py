"""Continuous spectra that no path in z leads around: those of ends at infinity, which the asymptotic pencil gives, and crossings.

σ lies on one where a solution neither grows nor decays, det(D − iℓ C) = 0 for a real ℓ. There the decaying space is not
analytic in σ, or it is and what it decays like is not: nothing is counted across such a curve, nor beyond it.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from shootstab.core.regions import Region
from shootstab.essential_spectrum.asymptotic import essential_curve
from shootstab.essential_spectrum.curves import Curve, curve_through
from shootstab.problems.capabilities import ASYMPTOTICS, CROSSINGS
from shootstab.problems.protocol import ComplexArray, Problem
from shootstab.problems.splitting import AsymptoticPencil


@dataclass(frozen=True, eq=False, repr=False)
class Barrier:
    """The curves, and the asymptotic pencils of the ends, each with the number of solutions that count as decaying there."""

    curves: tuple[Curve, ...]
    asymptotics: tuple[tuple[AsymptoticPencil, int], ...]

    def __repr__(self) -> str:
        return f"Barrier({len(self.curves)} curves, {len(self.asymptotics)} ends at infinity)"

    def distance(self, sigma: complex) -> float:
        """The distance of σ to the nearest of the curves; 0 where it lies on one to rounding."""
        return min(curve.distance(sigma) for curve in self.curves)

    @property
    def points(self) -> ComplexArray:
        """Points (m,) on all curves."""
        return np.concatenate([curve.begin for curve in self.curves])

    @property
    def name(self) -> str:
        """What the curves are, for a sentence."""
        inside = len(self.curves) > len(self.asymptotics)
        origin = ["of an end at infinity"] * bool(self.asymptotics) + ["of the inside"] * inside
        return f"the continuous spectrum {' or '.join(origin)}, around which no path leads,"

    @property
    def rightmost(self) -> float:
        """The largest real part on the curves."""
        return float(self.points.real.max(initial=-np.inf))

    def enters(self, region: Region) -> bool:
        """Whether a curve has a point in the region or on its boundary."""
        return any(curve.enters(region) for curve in self.curves)

    def beyond(self, sigma: complex) -> bool:
        """Whether a solution that counts as decaying grows at σ, or one that does not decays."""
        for pencil, k in self.asymptotics:
            rates = pencil.rates(sigma).real
            if (k > 0 and rates[k - 1] >= 0.0) or (k < len(rates) and rates[k] <= 0.0):
                return True
        return False


@lru_cache(maxsize=32)
def barrier_of(problem: Problem) -> Barrier | None:
    """The barrier of a problem, None if it has none."""
    asymptotics = ASYMPTOTICS.of(problem)
    curves = [essential_curve(pencil) for pencil, _ in asymptotics]
    curves += [curve_through(sigma, z) for z, sigma in CROSSINGS.of(problem)]
    return Barrier(tuple(curves), tuple(asymptotics)) if curves else None
