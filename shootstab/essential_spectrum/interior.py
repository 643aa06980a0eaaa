"""The continuous spectrum σ_c(z), its distance from a point, and the singular points z_s(σ) where σ_c(z_s) = σ."""

from __future__ import annotations

import cmath
import math
from collections.abc import Hashable
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache

import numpy as np
from numpy.typing import NDArray

from shootstab.core.errors import ConvergenceError
from shootstab.essential_spectrum.curves import SLOPE_STEP
from shootstab.problems.capabilities import INTERIOR, Continuum
from shootstab.problems.protocol import ComplexArray, Problem

NO_LENGTH = 1e-200  # chosen: a segment no longer than this is a point: the inverse of its length times any |σ| would overflow
CURVE_SAMPLES = 2001  # chosen: samples of the curve; its scale and slope are differences of them
CURVE_NEWTON_STEPS = 30  # chosen: the most steps of Newton; each is held to half the curve's scale
SINGULAR_SETTLED = 1e-12  # chosen: the last step to a singular point, in the scale of the curve
RESOLVED_LENGTH = 0.0625  # chosen: length of segments in a disc, in its radius; one of a curve as bent as the disc is off by 1/2000
SEGMENT_PARTS = 8  # chosen: into so many a segment is cut that is too long
CURVE_NOISE = 1e-14  # chosen: segments shorter than this part of σ are the rounding of σ_c
Z_NOISE = 1e-14  # chosen: heights that differ by less are not told apart
POLE = 1e10  # chosen: a sample at an end that is so many times the next one is that of a pole
NEXT_TO_POLE = 1e-8  # chosen: a pole at an end is followed up to there, in the distance of the samples
MOST_SAMPLES = 200_000  # chosen: samples at most; a region so thin and so long that it wants more keeps coarser segments
SINGULAR_KNOWN = 1e-6  # chosen: the last step with which one is known, where rounding lets it get no smaller


@dataclass(frozen=True, eq=False)
class SampledContinuum:
    """σ_c as a function of z, and sampled: sigma (m,) at real heights z (m,), from the wall up."""

    curve: Continuum
    z: NDArray[np.float64]
    sigma: ComplexArray

    def at(self, z: float) -> complex:
        """σ_c at a real height."""
        return complex(self.curve(np.array([z + 0j]))[0])

    def nearest(self, sigma: complex) -> tuple[float, float]:
        """The distance of σ to the segments between the samples, and the real height at which they come so near."""
        offsets, z = self._offsets(sigma)
        i = offsets.argmin()
        return float(offsets[i]), float(z[i])

    def distance(self, sigma: complex) -> float:
        """The distance of σ to the curve, which between samples may be nearer than their segments, or farther."""
        curve, last, offset = self, math.inf, self.nearest(sigma)[0]
        while 0.0 < offset < 0.5 * last:
            curve, last = curve.resolved(sigma, offset), offset
            offset = curve.nearest(sigma)[0]
        return offset

    def resolved(self, centre: complex, radius: float, width: float = math.inf) -> SampledContinuum:
        """The same curve with so many more samples that segments which a disc may hold are shorter than RESOLVED_LENGTH of its radius.

        width is that of what matters in the disc, if it is thinner. Between samples a curve leaves its segments by much less than their
        length, which tells those that the disc may hold. Segments as short as the rounding of σ_c stay whole.
        """
        shortest = max(RESOLVED_LENGTH * min(radius, width), CURVE_NOISE * (abs(centre) + radius))
        fine = self
        while len(fine.z) < MOST_SAMPLES:
            lengths, rises = np.abs(np.diff(fine.sigma)), np.diff(fine.z)
            held = fine._offsets(centre)[0] < radius + lengths
            wide = np.flatnonzero(held & (lengths > shortest) & (rises > Z_NOISE * np.abs(fine.z[1:])))
            if wide.size == 0:
                break
            z = (fine.z[wide, None] + np.outer(rises[wide], np.arange(1, SEGMENT_PARTS) / SEGMENT_PARTS)).ravel()
            places = np.repeat(wide + 1, SEGMENT_PARTS - 1)
            sigma = np.insert(fine.sigma, places, self.curve(z.astype(np.complex128)))
            fine = replace(self, z=np.insert(fine.z, places, z), sigma=sigma)
        return fine

    def passes(self, sigma: complex, radius: float) -> list[float]:
        """One height for each time that the curve comes nearer to σ than radius: of each run of segments, the nearest."""
        if radius <= 0.0:  # nothing is nearer than that, and a point of the curve would be looked at ever more closely
            return []
        offsets, z = self.resolved(sigma, radius)._offsets(sigma)
        inside = np.flatnonzero(offsets < radius)
        if inside.size == 0:
            return []
        runs = np.split(inside, np.flatnonzero(np.diff(inside) > 1) + 1)
        return [float(z[run[offsets[run].argmin()]]) for run in runs]

    def slope(self, z: float) -> complex:
        """dσ_c/dz at a real height, by differences of the samples."""
        i = int(np.clip(np.searchsorted(self.z, z), 1, len(self.z) - 2))
        return complex((self.sigma[i + 1] - self.sigma[i - 1]) / (self.z[i + 1] - self.z[i - 1]))

    def scale(self, z: float) -> float:
        """The length over which the slope of σ_c changes around a real height: the smallest s with |σ_c′/σ_c″| ≤ s somewhere within s.

        An inflection, where the ratio alone is infinite, has the scale of its neighbourhood. At most a quarter of the samples' range.
        """
        lengths = np.maximum(np.abs(self.z - z), self._ratios)
        return float(min(lengths.min(), 0.25 * (self.z[-1] - self.z[0])))

    @cached_property
    def _ratios(self) -> NDArray[np.float64]:
        first = np.gradient(self.sigma, self.z)
        second = np.gradient(first, self.z)
        with np.errstate(divide="ignore", invalid="ignore"):
            ratios = np.where(second != 0.0, np.abs(first / second), np.inf)
        # one-sided differences at the ends, and the last samples next to infinity, say nothing
        ratios[:2] = ratios[-2:] = np.inf
        return np.asarray(ratios)

    def singular_point(self, sigma: complex) -> complex | None:
        """z_s with σ_c(z_s) = σ, continued from the nearest real height by Newton; None if that leads nowhere, or where σ_c is unknown."""
        z = complex(self.nearest(sigma)[1])
        scale = self.scale(z.real)
        step, last = SLOPE_STEP * scale, math.inf
        for _ in range(CURVE_NEWTON_STEPS):
            try:
                here, ahead, behind = self.curve(np.array([z, z + step, z - step]))
            except ConvergenceError:  # no base flow is continued to every complex height; the real axis serves all σ off the curve
                return None
            slope = (ahead - behind) / (2 * step)
            change = (sigma - complex(here)) / complex(slope) if slope != 0.0 else math.inf
            if not cmath.isfinite(change):
                return None
            change *= min(1.0, 0.5 * scale / abs(change)) if change != 0.0 else 1.0
            z += change
            if abs(z.imag) > 2 * scale:
                return None
            # what no longer shrinks is the rounding of σ_c
            if abs(change) < SINGULAR_SETTLED * scale or 0.5 * last <= abs(change) < SINGULAR_KNOWN * scale:
                return z
            last = abs(change)
        return z if abs(change) < SINGULAR_KNOWN * scale else None

    def _offsets(self, sigma: complex) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """The distance of each segment of the curve to σ, and the height of the nearest point on it.

        Both are measured from the end of the segment that is nearer to σ: next to a pole of σ_c the other one may lie at 1e17.
        """
        along, inverse, rise = self._segments
        from_first, from_last = sigma - self.sigma[:-1], sigma - self.sigma[1:]
        forward = np.abs(from_first) <= np.abs(from_last)
        away, sign = np.where(forward, from_first, from_last), np.where(forward, 1.0, -1.0)
        t = sign * np.clip(sign * (away.real * inverse.real - away.imag * inverse.imag), 0.0, 1.0)
        return np.abs(away - t * along), np.where(forward, self.z[:-1], self.z[1:]) + t * rise

    @cached_property
    def _segments(self) -> tuple[ComplexArray, ComplexArray, NDArray[np.float64]]:
        """The length d of each segment, a complex number, d*/|d|² (0 where it has NO_LENGTH), and its height."""
        along = np.diff(self.sigma)
        inverse = np.zeros_like(along)
        np.divide(1.0, along, out=inverse, where=np.abs(along) > NO_LENGTH)
        return along, inverse, np.diff(self.z)


@lru_cache(maxsize=32)
def continuum_of(problem: Problem) -> SampledContinuum | None:
    """The continuous spectrum of a problem, None if it has none."""
    curve: Continuum | None = INTERIOR.of(problem)
    if curve is None:
        return None
    return _sampled(curve) if isinstance(curve, Hashable) else _sampled.__wrapped__(curve)


@lru_cache(maxsize=8)
def _sampled(curve: Continuum) -> SampledContinuum:
    """The samples of a curve, which problems may share: those of a chute with one flow and one k_x do."""
    z = curve.heights(CURVE_SAMPLES)
    sigma = curve(z.astype(np.complex128))
    for end, beside in ((0, 1), (-1, -2)):
        if abs(sigma[end]) > POLE * abs(sigma[beside]):  # it is noise there, with any sign
            z[end] += NEXT_TO_POLE * (z[beside] - z[end])
            sigma[end] = curve(z[[end]].astype(np.complex128))[0]
    return SampledContinuum(curve, z, sigma)
