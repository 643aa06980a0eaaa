"""The decaying space at an end where coefficients go as powers, in doubles, by its asymptotic series.

With A of asymptotic_end.py and the invariant spaces X and X2 of A_0 (splitting.py), ℓ and ℓ2 their dual rows, the decaying space at r is
the range of S (X + X2 Y), S = diag(r^s), where

    r^{−q} Y′ = a21 + a22 Y − Y h,   h = a11 + a12 Y,   a11 = ℓAX, a12 = ℓAX2, a21 = ℓ2AX, a22 = ℓ2AX2.

With Y = Σ Y_j t^j each order is one Sylvester equation with the two blocks of A_0, which have no eigenvalue in common: exponents and
logarithms, which stand inside the space, never enter. Solutions in it have the determinant exp ∫ r^q tr h dr, by which D does not depend
on where the integration begins. The series diverges, and is cut at its least term, which bounds its error in the order of magnitude.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from shootstab.core import polynomial
from shootstab.core.errors import ConvergenceError, InputError, Undecidable
from shootstab.core.scaled import EPSILON, TINY
from shootstab.formulation.asymptotic_end import AsymptoticEnd
from shootstab.formulation.evaluation import filled, on_arrays
from shootstab.formulation.regular_singular import COMPLEX_GENERIC_SIGMA, SeriesArrays, coefficient_arrays
from shootstab.problems.ends import INFINITIES
from shootstab.problems.expansion import Expanded
from shootstab.problems.pencil_function import PencilFunction
from shootstab.problems.protocol import ComplexArray, Pencil
from shootstab.problems.splitting import AsymptoticPencil, SpectralSplitting, sylvester

ZERO_RATE = 1e-3  # chosen: a rate of several that are zero scatters by a root of rounding, and is below this part of the largest
SERIES_TERMS = 64  # chosen: terms of the series in doubles at most
LAST_ASYMPTOTIC = 1e-19  # chosen: the series ends where its terms are so small against the first
START_ERROR = 1e-17  # chosen: the least term at the place where an integration begins, at the σ that it is chosen for
NEARER_SIGMAS = (1.0, 0.3, 0.1)  # chosen: these, in the reference: modes lie nearer to the essential spectrum than it does
FIRST_PLACE, LAST_PLACE, PLACE_RATIO = 1.0, 1e5, 1.2  # chosen: distances tried, in rising order
DROPPED_SAMPLES = np.geomspace(1.0, 3.0, 24)  # chosen: multiples of a distance at which what was left out is looked at
DROPPED = 1e-18  # chosen: relative size of what is left out of the coefficients from the start on


@dataclass(frozen=True, eq=False)
class AsymptoticExpansion:
    """See problems.expansion.AsymptoticSeries."""

    end: AsymptoticEnd
    size: int
    pencil: PencilFunction

    @cached_property
    def limit(self) -> AsymptoticPencil:
        C, D = ([part[0] for part in parts] for parts in self._arrays)
        while len(C) < 2:
            C, D = [*C, np.zeros_like(C[0])], [*D, np.zeros_like(D[0])]
        if not np.linalg.cond(polynomial.value(C, COMPLEX_GENERIC_SIGMA)) < 1.0 / EPSILON:
            where = INFINITIES[self.end.direction]
            raise InputError(f"at {where} the highest derivatives are dependent in the limit: that is not offered")
        return AsymptoticPencil(Pencil.of(C, D), self.end.direction)

    @property
    def bounded(self) -> bool:
        return self.end.rank == 0

    def require_one_power(self) -> None:
        """Raise InputError where rates are zero beside coefficients that grow: those solutions go as another power of the coordinate.

        Raises it for coefficients that are no series too.
        """
        rates = np.abs(self.limit.rates(COMPLEX_GENERIC_SIGMA))
        if not self.bounded and rates.min() < ZERO_RATE * rates.max():
            told = f"at {INFINITIES[self.end.direction]} some solutions go as the exponential of another power than others"
            raise InputError(f"{told}: that is not offered")

    def begins(self, k: int, reference: complex) -> float:
        splits = []
        for part in NEARER_SIGMAS:
            try:
                splits.append((part * reference, self.limit.splitting(part * reference, k)))
            except Undecidable:  # that σ, which lies on the essential spectrum, tells nothing
                continue
        r = FIRST_PLACE
        while r < LAST_PLACE:
            if self._left_out(r) <= DROPPED and all(self._series(r, sigma, split)[2] <= START_ERROR for sigma, split in splits):
                return r
            r *= PLACE_RATIO
        where = INFINITIES[self.end.direction]
        raise InputError(
            f"at {where} the coefficients come to their asymptotic series slower than is offered: allowed is Infinity(start=...)"
        )

    def at(self, r: float, sigma: complex, split: SpectralSplitting) -> Expanded:
        """The decaying space at r by its series. Raises ConvergenceError where no partial sum of it is a double."""
        Y, slope, error, logarithm, log_slope = self._series(r, sigma, split)
        if error == math.inf:
            where = INFINITIES[self.end.direction]
            raise ConvergenceError(f"at {where} the series in inverse powers of the coordinate overflows for sigma = {sigma:.6g}")
        scale = (r ** (np.array(self.end.shifts) / self.end.root))[:, None]
        left_out = self._left_out(r)
        return Expanded(scale * split.X, scale * split.X2, Y, slope, logarithm, log_slope, error + left_out)

    @cached_property
    def _arrays(self) -> SeriesArrays:
        """Ĉ and D̂, (SERIES_TERMS, n, n) for every power of σ."""
        try:
            return coefficient_arrays((self.end.C, self.end.D), self.size, SERIES_TERMS)
        except InputError:
            where = INFINITIES[self.end.direction]
            raise InputError(f"at {where} a coefficient is no series in inverse powers of the coordinate: allowed are such ones") from None

    @cached_property
    def _window(self) -> int:
        nonzero = np.any([part.any(axis=(1, 2)) for parts in self._arrays for part in parts], axis=0)
        return min(self.end.window(nonzero.tolist()), SERIES_TERMS // 2)

    def _left_out(self, r: float) -> float:
        """The relative size of what was left out of the coefficients at and beyond r."""
        if not self.end.dropped:
            return 0.0
        d, p = self.end.direction, self.end.root
        z = (d * r * DROPPED_SAMPLES).astype(np.complex128)
        t = (np.abs(z) ** (-1.0 / p)).astype(np.complex128)
        whole, n = self.pencil(z), self.size
        shifts, rows = np.array(self.end.shifts), np.array(self.end.own)
        powers = (rows + shifts)[:, None] - shifts[None, :]
        largest = 0.0
        at = on_arrays(t.real, {})
        for own, entries, rank in ((whole.C, self.end.C, 0), (whole.D, self.end.D, self.end.rank)):
            size = max(float(max(np.abs(filled(part, (n, n), t, at)).max() for part in entries)), TINY)
            for M, part in zip(own, entries, strict=False):
                kept = filled(part, (n, n), t, at)
                scaled = M * t[:, None, None] ** (rank + powers)
                largest = max(largest, _distance(scaled, kept) / size)
        return largest

    @np.errstate(over="ignore", invalid="ignore")  # the series ends before the first term that is no double
    def _series(self, r: float, sigma: complex, split: SpectralSplitting) -> tuple[ComplexArray, ComplexArray, float, complex, complex]:
        """Y and its σ-derivative at r, with the basis of the splitting held, the relative error, ∫ r^q tr h dr and its derivative."""
        p, Q, n = self.end.root, self.end.rank, self.size
        k = split.X.shape[1]
        A, dA = self._matrices(sigma)
        left, left2, X, X2 = split.left, split.left2, split.X, split.X2
        (a11, b11), (a12, b12), (a21, b21), (a22, b22) = (
            (rows @ A @ x, rows @ dA @ x) for rows, x in ((left, X), (left, X2), (left2, X), (left2, X2))
        )
        a12[0], a21[0] = 0.0, 0.0
        T11, T22 = np.triu(a11[0]), np.triu(a22[0])
        Y, dY = (np.zeros((SERIES_TERMS, n - k, k), dtype=np.complex128) for _ in range(2))
        h, dh = np.zeros((SERIES_TERMS, k, k), dtype=np.complex128), np.zeros((SERIES_TERMS, k, k), dtype=np.complex128)
        t, window = r ** (-1.0 / p), self._window
        sizes = np.full(SERIES_TERMS, np.inf)
        terms, overflown = SERIES_TERMS, False
        both = 0 < k < n
        for j in range(SERIES_TERMS):
            h[j] = a11[j] + _sum(a12, Y, 1, j)
            if both:
                back = j - Q - p
                E = a21[j] + _sum(a22, Y, 1, j) - _sum(Y, h, 0, j)
                if back > 0:
                    E = E + (back / p) * Y[back]
                Y[j] = -sylvester(T22, T11, E) if j else 0.0
                dh[j] = b11[j] + _sum(b12, Y, 0, j) + _sum(a12, dY, 1, j)
                dE = b21[j] + _sum(b22, Y, 0, j) + _sum(a22, dY, 1, j) - _sum(dY, h, 1, j, last=j - 1) - _sum(Y, dh, 0, j)
                if j:
                    dE = dE - dY[0] @ h[j]
                if back > 0:
                    dE = dE + (back / p) * dY[back]
                dY[j] = -sylvester(T22, T11, dE)
            else:
                dh[j] = b11[j]
            sizes[j] = max(float(np.abs(Y[j]).max(initial=0.0)), float(np.abs(h[j]).max(initial=0.0)) * (j > 0)) * t**j
            if not all(np.isfinite(part[j]).all() for part in (Y, dY, h, dh)):
                terms, overflown = max(j, 1), True
                break
            if j > Q + p + window and sizes[j - window + 1 : j + 1].max() <= LAST_ASYMPTOTIC:
                terms = j + 1
                break
        rolling = np.array([sizes[max(1, j - window + 1) : j + 1].max(initial=0.0) for j in range(terms)])
        rolling[: window if overflown else min(window, terms - 1)] = np.inf
        terms = int(np.argmin(rolling)) + 1
        powers = t ** np.arange(terms)
        antiderivative = np.array([_power_integral(Q - j + p, p, r) for j in range(terms)])
        traces, slopes = (np.trace(part[:terms], axis1=1, axis2=2) for part in (h, dh))
        value, slope = (np.tensordot(powers, part[:terms], axes=1) for part in (Y, dY))
        return value, slope, float(rolling[terms - 1]), complex(traces @ antiderivative), complex(slopes @ antiderivative)

    def _matrices(self, sigma: complex) -> tuple[ComplexArray, ComplexArray]:
        """A and dA/dσ, (SERIES_TERMS, n, n). Raises Undecidable where Ĉ_0 is singular."""
        p, Q, d = self.end.root, self.end.rank, self.end.direction
        C, D = (np.asarray(polynomial.value(part, sigma)) for part in self._arrays)
        dC, dD = (np.asarray(polynomial.slope(part, sigma)) if len(part) > 1 else np.zeros_like(part[0]) for part in self._arrays)
        try:
            inverse = np.linalg.inv(C[0])
        except np.linalg.LinAlgError:
            raise Undecidable(f"C is singular at infinity for sigma = {sigma:.6g}: it lies on the continuous spectrum") from None
        A, dA = np.zeros_like(D), np.zeros_like(D)
        moving = bool(np.abs(C[1:]).any() or np.abs(dC).any())
        for j in range(SERIES_TERMS):
            A[j] = inverse @ (d * D[j] - (_sum(C, A, 1, j) if moving else 0.0))
            dA[j] = inverse @ (d * dD[j] - (_sum(C, dA, 1, j) + _sum(dC, A, 0, j) if moving else 0.0))
        if p + Q < SERIES_TERMS:
            A[p + Q] -= np.diag(np.array(self.end.shifts) / p)
        return A, dA


def _sum(a: ComplexArray, b: ComplexArray, first: int, j: int, last: int | None = None) -> ComplexArray:
    """Σ a_i b_{j−i} for first ≤ i ≤ last, by default j."""
    i = np.arange(first, (j if last is None else last) + 1)
    return np.asarray((a[i] @ b[j - i]).sum(axis=0))


def _distance(a: ComplexArray, b: ComplexArray) -> float:
    with np.errstate(invalid="ignore"):
        off = np.abs(a - b)
    return float(off.max()) if np.isfinite(off).all() else math.inf


def _power_integral(numerator: int, p: int, r: float) -> float:
    """∫ r^{numerator/p − 1} dr."""
    return math.log(r) if numerator == 0 else p / numerator * r ** (numerator / p)
