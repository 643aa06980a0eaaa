"""The real domain of a problem, and what a function of z does on it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from shootstab.formulation.evaluation import Given
from shootstab.formulation.expression import Expression
from shootstab.formulation.scaled_values import scaled_values
from shootstab.formulation.vanishing import Vanishing

LINE_SAMPLES = 801  # chosen: points of the domain at which a function is looked at; a zero in between of a hundredth of the domain is seen
FAR_SAMPLE = 1e3  # chosen: the z at which samples towards infinity end
NEAR_SAMPLE = 1e-6  # chosen: the distance from a finite end at which they begin
SINGULAR_SIDE = 0.02  # chosen: part of the length beside a singular end where nothing is looked at; x⁴ is above ZERO_TOLERANCE beyond
FINITE = 4.0  # chosen: length that stands for an infinite one where a function is tested for being zero
ZERO_TOLERANCE = 1e-9  # chosen: what is no larger than this, against the median of all values, is a zero, and what is so much larger a pole


@dataclass(frozen=True, eq=False)
class Domain:
    """The interval from left to right, either of them infinite; singular are ends at which coefficients may vanish as they like."""

    left: float
    right: float
    given: Given
    singular: tuple[float, ...] = ()

    @property
    def points(self) -> NDArray[np.float64]:
        """Points (m,) inside, denser towards the ends."""
        x = np.sin(0.5 * np.pi * np.arange(1 - LINE_SAMPLES, LINE_SAMPLES, 2) / LINE_SAMPLES)
        if np.isfinite(self.left) and np.isfinite(self.right):
            return np.asarray(0.5 * (self.left + self.right) + 0.5 * (self.right - self.left) * x)
        if np.isfinite(self.left):
            return np.asarray(self.left + np.geomspace(NEAR_SAMPLE, FAR_SAMPLE, LINE_SAMPLES))
        if np.isfinite(self.right):
            return np.asarray(self.right - np.geomspace(FAR_SAMPLE, NEAR_SAMPLE, LINE_SAMPLES))
        half = np.geomspace(NEAR_SAMPLE, FAR_SAMPLE, LINE_SAMPLES // 2)
        return np.concatenate((-half[::-1], [0.0], half))

    @property
    def vanishing(self) -> Vanishing:
        """The test for zero on it."""
        left = self.left if np.isfinite(self.left) else (self.right if np.isfinite(self.right) else 0.5 * FINITE) - FINITE
        right = self.right if np.isfinite(self.right) else left + FINITE
        return Vanishing(left, right, self.given)

    def regular(self, expression: Expression) -> bool:
        """Whether a function of z is finite and has no zero on the samples, nor changes its sign between them."""
        return self.zero(expression) is None

    def zero(self, expression: Expression) -> float | None:
        """A point at or next to which it vanishes or has a pole, of the samples that lie at no singular end; None if there is none."""
        z = self.points
        length = self.right - self.left if np.isfinite(self.right - self.left) else FINITE
        for end in self.singular:
            z = z[np.abs(z - end) > SINGULAR_SIDE * length]
        with np.errstate(all="ignore"):
            values = scaled_values(expression, z, self.given)[0]
        size = np.abs(values)
        bad = ~np.isfinite(size)
        if not bad.any():
            middle = float(np.median(size))
            bad = (size <= ZERO_TOLERANCE * middle) | (ZERO_TOLERANCE * size >= middle)
        if not bad.any() and not np.iscomplex(values).any():
            first = np.flatnonzero(np.diff(np.sign(values.real)))[:1]
            # where the chord between the two samples vanishes
            crossed = z[first] - values.real[first] * np.diff(z)[first] / np.diff(values.real)[first]
            return float(crossed[0]) if len(crossed) else None
        return float(z[bad][0]) if bad.any() else None
