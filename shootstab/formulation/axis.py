"""The regular solutions at a regular singular end, as the space that an integration in doubles begins with."""

from __future__ import annotations

from contextlib import suppress
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from shootstab.core import polynomial
from shootstab.core.errors import ConvergenceError
from shootstab.formulation.regular_singular import COMPLEX_GENERIC_SIGMA, MOST_TERMS, RegularSingularEnd, SolutionFamily, blocks
from shootstab.problems.protocol import ComplexArray, FarFrame

FARTHEST_START = 0.25  # chosen: an integration begins so far out at most, in lengths of the domain
NEAREST_START = 1e-6  # chosen: an integration begins at least so far from the axis, in the same length
START_ROUNDING = 4e-15  # chosen, some twenty units of rounding: relative error of the frame at the start, for these σ
# σ of no property, at which the series is looked at
AXIS_SIGMAS = (COMPLEX_GENERIC_SIGMA, -COMPLEX_GENERIC_SIGMA, 1j * COMPLEX_GENERIC_SIGMA)  # derived from the one
WORST_START = 1e-11  # chosen: relative error of a frame beyond which nothing is begun; what is below counts in the budget
LAST_TERM = 1e-19  # chosen: the series ends where its terms are so small against the first ones
TERM_ROUNDING = 4e-16  # chosen: the relative rounding of one term of the series, two units
FIRST_ROUNDING = 2e-15  # chosen, some ten units: first coefficients below this part of the largest are zeros that rounding has left
AT_THE_END = 1e-200  # chosen: the hair, in x: powers x^0.1 of it are far below all rounding, and x⁻¹ is a double still
AT_THE_END_OF_POLES = 1e-60  # chosen: the same where states go as higher inverse powers, down to x⁻⁵
NEARER_START = 0.7  # chosen: the next place of the start, in the distance of the last


@dataclass(frozen=True, eq=False)
class RegularSpace:
    """See problems.decaying_space.StartingSpace: the regular solutions at the distance x from the end, without a σ-dependent factor.

    place is the z of the end.
    """

    end: RegularSingularEnd
    x: float
    where: str
    place: float

    @property
    def columns(self) -> int:
        return self.end.columns

    def frame(self, sigma: complex) -> FarFrame:
        """The frame (n, k) at x and its σ-derivative. Raises ConvergenceError where the series does not hold at x for this σ."""
        with np.errstate(over="ignore", invalid="ignore"):  # too far out for a double: the error is infinite or no number
            parts = [self._family(family, sigma) for family in self.end.families]
        frame, tangent = (np.concatenate([part[i] for part in parts], axis=1) for i in (0, 1))
        error = float(np.max([part[2] for part in parts]))
        if not error <= WORST_START:
            raise ConvergenceError(f"at {self.where} the regular solutions are known to {error:.1e} only for sigma = {sigma:.6g}")
        return FarFrame(frame, tangent, 0.0, error)

    @property
    def inner(self) -> RegularSpace:
        """Itself: it is known all the way to the end (see problems.unknowns.InnerSpace)."""
        return self

    def nearer(self, z: NDArray[np.float64], sigma: complex) -> ComplexArray:
        """The same solutions (m, n, k) at points z (m,) between the end and x, where their series holds better still.

        At the end itself they are taken a hair from it, where unknowns that have a value there have it to all digits.
        """
        S = np.array(self.end.shifts, dtype=float)
        x = np.maximum(np.abs(z - self.place) / self.x, AT_THE_END if S.min() >= -1.0 else AT_THE_END_OF_POLES)
        parts = []
        for family in self.end.families:
            phi = self._series(family, sigma)[0]
            first = phi[: family.count]
            first[np.abs(first) < FIRST_ROUNDING * np.abs(first).max()] = 0.0
            m = np.arange(len(phi))
            exponents = m[:, None] + S + (family.exponent - self.lowest)
            sizes = phi * (self.x / self.end.length) ** m[:, None, None] * self.x ** (exponents - m[:, None])[:, :, None]
            with np.errstate(over="ignore", invalid="ignore"):  # what is infinite there is no unknown
                powers = np.exp((exponents + self.lowest) * np.log(x)[:, None, None])
                terms = powers[..., None] * sizes
            parts.append(np.where(sizes == 0.0, 0.0, terms).sum(axis=1))
        return np.concatenate(parts, axis=2)

    def _family(self, family: SolutionFamily, sigma: complex) -> tuple[ComplexArray, ComplexArray, float]:
        """ψ, dψ/dσ (n, k) and the relative error of the largest column."""
        rho, S, ratio = family.exponent, np.array(self.end.shifts, dtype=float), self.x / self.end.length
        phi, slope = self._series(family, sigma)
        powers = ratio ** np.arange(len(phi))
        values, slopes = (part * powers[:, None, None] for part in (phi, slope))
        total = values.sum(axis=0)
        scale = self.x ** (S + (rho - self.lowest))[:, None]
        sizes = np.abs(total).max(axis=0)
        lost = np.abs(values).max(axis=(0, 1)) * TERM_ROUNDING + np.abs(values[-4:]).max(axis=(0, 1))
        return scale * total, scale * slopes.sum(axis=0), float((lost / sizes).max())

    def _series(self, family: SolutionFamily, sigma: complex) -> tuple[ComplexArray, ComplexArray]:
        """The coefficients of ψ x^−(ρ + s) and their σ-derivatives, (terms, n, k), as many as count at x."""
        n, k, rho = len(self.end.shifts), len(family.free), family.exponent
        C, D = (polynomial.value(part, sigma) for part in self.end.arrays)
        C_slope, D_slope = (polynomial.slope(part, sigma) for part in self.end.arrays)
        S = np.array(self.end.shifts, dtype=float)
        ratio = self.x / self.end.length
        phi, slope, turned, turned_slope = (np.zeros((MOST_TERMS, n, k), dtype=np.complex128) for _ in range(4))
        for out, part in zip((phi, slope), self._first(family, sigma), strict=True):
            out[: family.count] = part.reshape(family.count, n, k)
        for m in range(family.count):
            factor = (rho + m + S)[:, None]
            turned[m], turned_slope[m] = factor * phi[m], factor * slope[m]
        terms = MOST_TERMS
        largest = (np.abs(phi[: family.count]).max(axis=(1, 2)) * ratio ** np.arange(family.count)).max()
        for m in range(family.count, MOST_TERMS):
            # L_q φ_{m−q} summed over q ≥ 1, and what σ changes in it
            right = _sum(D, phi, m) - _sum(C, turned, m)
            right_slope = _sum(D, slope, m) - _sum(C, turned_slope, m) + _sum(D_slope, phi, m) - _sum(C_slope, turned, m)
            factor = (rho + m + S)[:, None]
            L, dL = C[0] * factor.T - D[0], C_slope[0] * factor.T - D_slope[0]
            phi[m] = np.linalg.solve(L, right)
            slope[m] = np.linalg.solve(L, right_slope - dL @ phi[m])
            turned[m], turned_slope[m] = factor * phi[m], factor * slope[m]
            ends = np.arange(max(m - 3, 0), m + 1)
            last = np.abs(phi[ends]).max(axis=(1, 2)) * ratio**ends
            if m > family.count + 4 and last.max() < LAST_TERM * largest:
                terms = m + 1
                break
        return phi[:terms], slope[:terms]

    def _first(self, family: SolutionFamily, sigma: complex) -> tuple[ComplexArray, ComplexArray]:
        """The coefficients for m < count and their σ-derivatives, (count n, k)."""
        n, k = len(self.end.shifts), len(family.free)
        powers = blocks(self.end.arrays, self.end.shifts, family.exponent, family.count)
        rows, free = list(family.rows), list(family.free)
        dependent = [i for i in range(len(family.allowed)) if i not in free]
        allowed = np.array(family.allowed)
        M, dM = ((part[:, allowed])[rows] for part in (polynomial.value(powers, sigma), polynomial.slope(powers, sigma)))
        values = np.zeros((len(allowed), k), dtype=np.complex128)
        values[free] = np.eye(k)
        values[dependent] = np.linalg.solve(M[:, dependent], -M[:, free])
        slopes = np.zeros_like(values)
        slopes[dependent] = np.linalg.solve(M[:, dependent], -dM @ values)
        out = [np.zeros((family.count * n, k), dtype=np.complex128) for _ in range(2)]
        out[0][allowed], out[1][allowed] = values, slopes
        return out[0], out[1]

    @property
    def lowest(self) -> complex:
        """The exponent of the first family, taken out of all: a factor that does not depend on σ."""
        return self.end.families[0].exponent


def _sum(A: ComplexArray, y: ComplexArray, m: int) -> ComplexArray:
    """Σ_{q ≥ 1} A_q y_{m−q}."""
    q = np.arange(1, m + 1)
    return np.asarray(np.einsum("qij,qjk->ik", A[q], y[m - q]))


def starting_distance(end: RegularSingularEnd, length: float, where: str) -> float:
    """How far from the end to begin: the largest of some distances at which the series holds to rounding for σ of the size 1."""
    x = FARTHEST_START * length
    while x > NEAREST_START * length:
        with suppress(ConvergenceError):  # too far for the series: nearer is tried
            if all(RegularSpace(end, x, where, 0.0).frame(sigma).error <= START_ROUNDING for sigma in AXIS_SIGMAS):
                return x
        x *= NEARER_START
    raise ConvergenceError(f"at {where} the series of the regular solutions holds nowhere")
