"""The regular solutions at a regular singular end to any number of digits: the recurrence of regular_singular.py in an arithmetic.

Exponents that are no integers are eigenvalues of Ĉ_0⁻¹ D̂_0 − S, which no σ enters, known to as many digits; multiple ones, which scatter by
a root of rounding, to as many as are left of ROUNDING_ROOT times as many.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

import mpmath

from shootstab.core.errors import ConvergenceError
from shootstab.formulation.expression import Expression
from shootstab.formulation.regular_singular import RegularSingularEnd, SolutionFamily
from shootstab.formulation.series_digits import on_series
from shootstab.multiprecision import small_matrices as matrices
from shootstab.multiprecision.arithmetic import TAIL_TERMS, Arithmetic, Matrix
from shootstab.multiprecision.settings import Settings
from shootstab.multiprecision.taylor import Taylor, real_series

MOST_SERIES_TERMS = 4000  # chosen: terms of a series
ROUNDING_ROOT = 3  # chosen: digits with which exponents are computed, in the working digits
HAIR = 40  # chosen: digits of a hair, in the working digits: x^(1/40) of it is rounding
BITS_OF_DIGIT = 3.33  # chosen: bits of a digit, a little more than log2 10

SeriesEntries = Mapping[tuple[int, int], list[Any]]  # coefficients by entry


@dataclass(frozen=True, eq=False)
class RegularStart:
    """The end, and the distance from it at which an integration begins."""

    end: RegularSingularEnd
    x: Fraction

    def frame(self, arithmetic: Arithmetic, settings: Settings, sigma: Any) -> Matrix:
        """ψ (n, k) at the distance x, or nearer with a far_shift. Raises ConvergenceError where the series does not hold there."""
        return self.at(arithmetic, settings, sigma, arithmetic.number(self.reach(settings)))

    def reach(self, settings: Settings) -> Fraction:
        """The distance at which the integration begins."""
        return self.x / Fraction(2) ** round(settings.far_shift)

    def nearer(self, arithmetic: Arithmetic, settings: Settings, sigma: Any, x: Any) -> tuple[Matrix, Any]:
        """ψ (n, k) at a distance x from the end, nearer than the integration begins, and that distance.

        At the end itself they are taken a hair from it, of which the powers in them are no more than rounding.
        """
        hair = arithmetic.number(Fraction(1, 10 ** (HAIR * settings.digits)))
        x = hair if arithmetic.log2(x) < arithmetic.log2(hair) else arithmetic.rounded(x)
        return self.at(arithmetic, settings, sigma, x, settled=True), x

    def at(self, arithmetic: Arithmetic, settings: Settings, sigma: Any, x: Any, settled: bool = False) -> Matrix:
        """ψ (n, k) at a distance x from the end; settled: first coefficients that are rounding are 0, as a small x is to divide by."""
        columns = [self._family(arithmetic, settings, sigma, family, x, settled) for family in self.end.families]
        return [[value for part in columns for value in part[i]] for i in range(len(self.end.shifts))]

    def _family(self, arithmetic: Arithmetic, settings: Settings, sigma: Any, family: SolutionFamily, x: Any, settled: bool) -> Matrix:
        rho, shifts = self._exponent(arithmetic, settings, sigma, family), self.end.shifts
        terms = max(2 * settings.far_terms, 4 * family.count)
        C, D = self._series(arithmetic, sigma, terms)
        phi = self._first(arithmetic, family, rho, C, D)
        if settled:
            least = max(arithmetic.log2(value) for part in phi for row in part for value in row) - settings.digits * math.log2(10)
            nothing = arithmetic.number(0)
            phi = [[[value if arithmetic.log2(value) > least else nothing for value in row] for row in part] for part in phi]
        total = [list(row) for row in phi[0]]
        power, powers = arithmetic.number(1), []
        largest = 0.0
        last: list[float] = []
        for m in range(MOST_SERIES_TERMS):
            if m >= terms:
                break
            if m >= family.count:
                right = [[-value for value in row] for row in _carried(arithmetic, C, D, phi, rho, shifts, m)]
                phi.append(matrices.solve(arithmetic, _leading(arithmetic, C, D, rho + m, shifts), right))
            if m:
                power = arithmetic.rounded(power * x)
                total = [[a + power * b for a, b in zip(s, t, strict=True)] for s, t in zip(total, phi[m], strict=True)]
            powers.append(power)
            size = max(arithmetic.log2(power * value) for row in phi[m] for value in row)
            largest, last = max(largest, size) if m else size, [*last[1 - TAIL_TERMS :], size]
            if m > family.count + TAIL_TERMS and max(last) < largest - settings.far_tolerance * BITS_OF_DIGIT:
                return [[arithmetic.rounded(value * x ** (rho + shifts[i])) for value in row] for i, row in enumerate(total)]
        raise ConvergenceError("at a regular singular end the series of the regular solutions does not hold where the integration begins")

    def _exponent(self, arithmetic: Arithmetic, settings: Settings, sigma: Any, family: SolutionFamily) -> Any:
        """The lowest exponent of a family in this arithmetic: an integer, or a number that is real where it can be."""
        if family.exponent == round(family.exponent.real):
            return round(family.exponent.real)
        n = len(self.end.shifts)
        with arithmetic.working(ROUNDING_ROOT * settings.digits), mpmath.workdps(ROUNDING_ROOT * settings.digits):
            C, D = (
                mpmath.matrix([[arithmetic.to_mpmath(part[i, j][0]) if (i, j) in part else 0 for j in range(n)] for i in range(n)])
                for part in self._series(arithmetic, sigma, 2)
            )
            found = mpmath.eig(mpmath.inverse(C) * D - mpmath.diag(self.end.shifts), left=False, right=False)
            nearest = min(found, key=lambda rho: float(abs(rho - family.exponent)))
        real = abs(nearest.imag) <= mpmath.mpf(10) ** -settings.digits * abs(nearest)
        return arithmetic.number(nearest.real) if real else arithmetic.complex(nearest)

    def _series(self, arithmetic: Arithmetic, sigma: Any, terms: int) -> tuple[SeriesEntries, SeriesEntries]:
        """Ĉ and D̂ at this σ."""
        z = real_series(arithmetic, [arithmetic.number(0), arithmetic.number(1)] + [arithmetic.number(0)] * (terms - 2))
        at = on_series(arithmetic, z)

        def coefficients(entry: Expression) -> list[Any]:
            value = at(entry)
            return (value if isinstance(value, Taylor) else 0 * z + value).coefficients(terms)

        C, D = (_at_sigma([{place: coefficients(e) for place, e in part.items()} for part in powers], sigma) for powers in self.end.parts)
        return C, D

    def _first(self, arithmetic: Arithmetic, family: SolutionFamily, rho: Any, C: SeriesEntries, D: SeriesEntries) -> list[Matrix]:
        """φ_m (n, k) for m < count."""
        n, shifts = len(self.end.shifts), self.end.shifts
        nothing = arithmetic.number(0)
        place = {at: i for i, at in enumerate(family.allowed)}
        M = [[nothing] * len(family.allowed) for _ in family.rows]
        for r, row in enumerate(family.rows):
            m, i = divmod(row, n)
            for q in range(m + 1):
                for j in range(n):
                    at = (m - q) * n + j
                    if at in place:
                        M[r][place[at]] = _entry(C, D, (i, j), q, rho + m - q + shifts[j], nothing)
        dependent = [i for i in range(len(family.allowed)) if i not in family.free]
        solved = matrices.solve(arithmetic, [[row[i] for i in dependent] for row in M], [[-row[i] for i in family.free] for row in M])
        k = len(family.free)
        phi = [[[nothing] * k for _ in range(n)] for _ in range(family.count)]
        for i, at in enumerate(family.allowed):
            m, j = divmod(at, n)
            if i in family.free:
                phi[m][j] = [arithmetic.number(int(i == free)) for free in family.free]
            else:
                phi[m][j] = solved[dependent.index(i)]
        return phi


def _entry(C: SeriesEntries, D: SeriesEntries, at: tuple[int, int], q: int, factor: Any, nothing: Any) -> Any:
    """L_q = (…) Ĉ_q − D̂_q at one place."""
    value = nothing
    if at in C:
        value = value + factor * C[at][q]
    return value - D[at][q] if at in D else value


def _leading(arithmetic: Arithmetic, C: SeriesEntries, D: SeriesEntries, mu: Any, shifts: tuple[int, ...]) -> Matrix:
    n, nothing = range(len(shifts)), arithmetic.number(0)
    return [[_entry(C, D, (i, j), 0, mu + shifts[j], nothing) for j in n] for i in n]


def _carried(
    arithmetic: Arithmetic, C: SeriesEntries, D: SeriesEntries, phi: list[Matrix], rho: Any, shifts: tuple[int, ...], m: int
) -> Matrix:
    """Σ_{q≥1} L_q(ρ + m − q) φ_{m−q}."""
    n, k = len(shifts), len(phi[0][0])
    total = [[arithmetic.number(0)] * k for _ in range(n)]
    for part, is_C in ((C, True), (D, False)):
        for (i, j), series in part.items():
            for q in range(1, m + 1):
                if not matrices.vanishes(series[q]):
                    factor = (rho + m - q + shifts[j]) * series[q] if is_C else -series[q]
                    total[i] = [a + factor * b for a, b in zip(total[i], phi[m - q][j], strict=True)]
    return [[arithmetic.rounded(value) for value in row] for row in total]


def _at_sigma(powers: Sequence[SeriesEntries], sigma: Any) -> SeriesEntries:
    out = dict(powers[-1])
    for part in reversed(powers[:-1]):
        out = {at: [sigma * c if not matrices.vanishes(c) else c for c in series] for at, series in out.items()}
        for at, series in part.items():
            out[at] = [a + b for a, b in zip(series, out[at], strict=True)] if at in out else series
    return out
