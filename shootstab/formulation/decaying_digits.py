"""The decaying space at an end at infinity to any number of digits, by its convergent series in the exponential.

With x = e^{−κ d z} (see exponentials.py), A = C_0⁻¹ D_0 and A P_0 = P_0 Λ on the k solutions that decay, ψ = P(x) x^Λ, P = Σ P_m x^m, where

    (m C_0 − D_0) P_m + C_0 P_m Λ = Σ_{j≥1} {D_j P_{m−j} − C_j [(m − j) P_{m−j} + P_{m−j} Λ]}.

P_0 has the identity in k of its rows and X in the others, so that it is analytic in σ, and so is D with det x^Λ as a factor: D does not
depend on where the integration begins. X is that of double precision, improved by Newton's iteration. An exponent may not exceed another
one that decays by a whole number: then the solutions have logarithms.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

import mpmath
import numpy as np
import scipy.linalg
from numpy.typing import NDArray

from shootstab.core.errors import ConvergenceError
from shootstab.formulation.base_digits import FlowSeries
from shootstab.formulation.exponentials import ExponentialEnd
from shootstab.formulation.regular_digits import SeriesEntries
from shootstab.formulation.series_digits import on_numbers, on_series
from shootstab.multiprecision import small_matrices as matrices
from shootstab.multiprecision.arithmetic import TAIL_TERMS, Arithmetic, Matrix
from shootstab.multiprecision.linear_step import at_sigma
from shootstab.multiprecision.settings import Settings, step_limit
from shootstab.multiprecision.taylor import Taylor, real_series
from shootstab.problems.ends import INFINITIES

SMALLEST_SPLITTING = 1e-9  # chosen: the least gap between decaying exponents and the others; below it σ is on the essential spectrum
PIVOT_PREFERENCE = 0.25  # chosen: the first row above this part of the largest entry is taken, so that roundings decide nothing
PLACE_BITS = 20  # chosen: a place has a fraction of so many bits
SEED_DIGITS = 10  # chosen: digits of X in double precision that the number of Newton steps rests on


class LogarithmsError(ConvergenceError):
    """Solutions that decay have logarithms in the exponential: the series without them does not hold."""


@dataclass(frozen=True, eq=False)
class Solutions:
    """P_m V (n, k) for every m, T = V⁻¹ Λ V upper triangular, and back = V⁻¹."""

    P: list[Matrix]
    T: Matrix
    back: Matrix


class DecayingSpaceInDigits:
    """The decaying space of one end in one arithmetic, begun at a place that `begin` chooses."""

    def __init__(
        self,
        arithmetic: Arithmetic,
        settings: Settings,
        end: ExponentialEnd,
        n: int,
        k: int,
        target: Fraction,
        flow: FlowSeries | None = None,
    ) -> None:
        """target: where the integration goes, from farther out: from the reach of a base flow, if there is one, where it has settled."""
        self._flow = flow
        self._arithmetic, self._settings, self._end, self._n, self._k, self._target = arithmetic, settings, end, n, k, target
        self._rate = arithmetic.rounded(on_numbers(arithmetic, arithmetic.number(0))(end.rate) * arithmetic.number(1))
        self._parts = [self._series(part) for part in (end.C, end.D)]
        self._terms = 1 if end.constant else settings.far_terms
        self._pivots: list[int] = []
        self._known: tuple[Any, Solutions] | None = None  # the σ of begin and the solutions there
        self.place = target

    def begin(self, sigma: Any) -> None:
        """Choose the place: as near as the series holds there, and farther out than the target. Raises ConvergenceError."""
        C, D = self._at(sigma)
        A = matrices.solve(self._arithmetic, _leading(C, self._n, self._nothing), _leading(D, self._n, self._nothing))
        self._pivots = chosen_rows(self._seed(A))
        self._known = sigma, self._solutions(sigma)
        P = self._known[1].P
        first, *last = [max(self._arithmetic.log2(x) for row in part for x in row) for part in (P[0], *P[1:][-TAIL_TERMS:])]
        holds = step_limit(last, self._terms, first, self._settings.far_tolerance) if last else math.inf
        kappa, d = float(self._arithmetic.to_mpmath(self._rate)), self._end.direction
        nearest = -kappa * d * float(self._target) / math.log(2) - 1.0
        z = -d * (min(holds, nearest) - self._settings.far_shift) * math.log(2) / kappa
        self.place = Fraction(round(z * 2**PLACE_BITS), 2**PLACE_BITS)
        if self._flow is not None:
            self.place = d * max(d * self._flow.reach(d), d * self._target + 1)

    def frame(self, sigma: Any) -> tuple[Matrix, Any]:
        """P (n, k) at the place, and det x^Λ there."""
        found = self._known[1] if self._known is not None and self._known[0] == sigma else self._solutions(sigma)
        arithmetic, d = self._arithmetic, self._end.direction
        log = -d * arithmetic.to_mpmath(self._rate) * mpmath.mpf(self.place.numerator) / self.place.denominator
        x, power = arithmetic.number(mpmath.exp(log)), arithmetic.number(1)
        total = [list(row) for row in found.P[0]]
        for part in found.P[1:]:
            power = arithmetic.rounded(power * x)
            total = [[a + power * b for a, b in zip(s, t, strict=True)] for s, t in zip(total, part, strict=True)]
        trace = sum((arithmetic.to_mpmath(found.T[q][q]) for q in range(self._k)), mpmath.mpf(0))
        return matrices.product(arithmetic, total, found.back), arithmetic.complex(mpmath.exp(log * trace))

    @property
    def farthest(self) -> float:
        """The solutions are known up to infinity, except on a base flow, which is known as far as its own series."""
        return math.inf if self._flow is None else 0.0

    def beyond(self, sigma: Any, c: Matrix, place: Any, distance: Any) -> Matrix:
        """ψ (n, 1) of a combination c (k, 1) of the frame, so far beyond the place: Σ P_m x^m (x/x_0)^T V⁻¹ c, x_0 being x there."""
        found = self._known[1] if self._known is not None and self._known[0] == sigma else self._solutions(sigma)
        arithmetic, d, rate = self._arithmetic, self._end.direction, self._arithmetic.to_mpmath(self._rate)
        way = arithmetic.to_mpmath(distance)
        at_place = -d * rate * mpmath.mpf(self.place.numerator) / self.place.denominator
        T = mpmath.matrix([[arithmetic.to_mpmath(t) for t in row] for row in found.T])
        decayed = mpmath.expm(T * (-rate * way))
        turned = [[arithmetic.complex(decayed[i, j]) for j in range(self._k)] for i in range(self._k)]
        x, power = arithmetic.number(mpmath.exp(at_place - rate * way)), arithmetic.number(1)
        total = [list(row) for row in found.P[0]]
        for part in found.P[1:]:
            power = arithmetic.rounded(power * x)
            total = [[a + power * b for a, b in zip(s, t, strict=True)] for s, t in zip(total, part, strict=True)]
        combined = matrices.product(arithmetic, turned, matrices.product(arithmetic, found.back, c))
        return matrices.product(arithmetic, total, combined)

    @property
    def _nothing(self) -> Any:
        return self._arithmetic.number(0)

    def _series(self, powers: Sequence[Mapping[tuple[int, int], Any]]) -> list[dict[tuple[int, int], Taylor]]:
        zero, one = self._arithmetic.number(0), self._arithmetic.number(1)
        x = real_series(self._arithmetic, [zero, one] + [zero] * (self._settings.far_terms - 2))
        at = on_series(self._arithmetic, x, fields=None if self._flow is None else self._flow.limit(self._end.direction))
        out = []
        for part in powers:
            values = {place: at(entry) for place, entry in part.items()}
            out.append({place: value if isinstance(value, Taylor) else 0 * x + value for place, value in values.items()})
        return out

    def _at(self, sigma: Any) -> tuple[SeriesEntries, SeriesEntries]:
        """C and −(d/κ) D at this σ."""
        C, D = (at_sigma(part, sigma) for part in self._parts)
        factor = -self._end.direction / self._rate
        terms = self._settings.far_terms
        return {at: e.coefficients(terms) for at, e in C.items()}, {at: (factor * e).coefficients(terms) for at, e in D.items()}

    def _seed(self, A: Matrix) -> NDArray[np.complex128]:
        """A basis (n, k) of the decaying space of A in double precision. Raises ConvergenceError where it is not told apart."""
        double = np.array([[complex(self._arithmetic.to_mpmath(x)) for x in row] for row in A])
        found, where = np.linalg.eigvals(double), INFINITIES[self._end.direction]
        exponents, size = [*np.sort(found.real)[::-1], -np.inf], np.abs(found).max()
        if not exponents[self._k - 1] - exponents[self._k] > SMALLEST_SPLITTING * size:
            raise ConvergenceError(f"sigma lies on the essential spectrum: at {where} no gap is between what decays and what does not")
        least = exponents[self._k] + 0.5 * min(exponents[self._k - 1] - exponents[self._k], size) if self._k < self._n else -np.inf
        decaying = found[found.real > least]
        apart = decaying[:, None] - decaying
        orders = np.round(apart.real)
        if self._terms > 1 and ((orders > 0) & (np.abs(apart - orders) <= SMALLEST_SPLITTING * size)).any():
            raise LogarithmsError(f"at {where} solutions that decay differ by a power of the coefficients: they have logarithms")
        _, Q, _ = scipy.linalg.schur(double, output="complex", sort=lambda x: x.real > least)
        return np.asarray(Q[:, : self._k])

    def _solutions(self, sigma: Any) -> Solutions:
        arithmetic, n, k = self._arithmetic, self._n, self._k
        C, D = self._at(sigma)
        C0, D0 = _leading(C, n, self._nothing), _leading(D, n, self._nothing)
        A = matrices.solve(arithmetic, C0, D0)
        P0 = self._invariant(A)
        growth = [[sum((A[i][j] * P0[j][q] for j in range(n)), self._nothing) for q in range(k)] for i in self._pivots]
        V, T, back = triangular(arithmetic, growth)
        P = [matrices.product(arithmetic, P0, V)]
        turned = [matrices.product(arithmetic, P[0], T)]
        for m in range(1, self._terms):
            right = [[self._nothing] * k for _ in range(n)]
            for series, terms, sign in ((D, P, 1), (C, turned, -1)):
                for (i, j), c in series.items():
                    for order in range(1, m + 1):
                        if not matrices.vanishes(c[order]):
                            factor = sign * c[order]
                            right[i] = [a + factor * b for a, b in zip(right[i], terms[m - order][j], strict=True)]
            P.append(sylvester_in_digits(arithmetic, matrices.combined(matrices.scaled(C0, m), D0, -1), C0, T, right))
            turned.append(matrices.combined(matrices.product(arithmetic, P[m], T), P[m], m))
        return Solutions(P, T, back)

    def _invariant(self, A: Matrix) -> Matrix:
        """P_0, by Newton's iteration for A_21 + A_22 X − X (A_11 + A_12 X) = 0."""
        arithmetic, k = self._arithmetic, self._k
        rows, others = self._pivots, [i for i in range(self._n) if i not in self._pivots]
        basis = self._seed(A)
        X = [[arithmetic.complex(complex(x)) for x in row] for row in np.linalg.solve(basis[rows].T, basis[others].T).T]
        for _ in range(max(1, math.ceil(math.log2(self._settings.digits / SEED_DIGITS))) + 1 if others else 0):
            growth = [
                [A[i][j] + sum((A[i][o] * x[q] for o, x in zip(others, X, strict=True)), self._nothing) for q, j in enumerate(rows)]
                for i in rows
            ]
            off = [
                [
                    A[i][j]
                    + sum((A[i][o] * x[q] for o, x in zip(others, X, strict=True)), self._nothing)
                    - sum((X[r][p] * growth[p][q] for p in range(k)), self._nothing)
                    for q, j in enumerate(rows)
                ]
                for r, i in enumerate(others)
            ]
            B = [
                [A[i][o] - sum((X[r][p] * A[j][o] for p, j in enumerate(rows)), self._nothing) for o in others]
                for r, i in enumerate(others)
            ]
            one = [[arithmetic.number(-int(r == s)) for s in range(len(others))] for r in range(len(others))]
            V, T, back = triangular(arithmetic, growth)
            step = sylvester_in_digits(arithmetic, B, one, T, matrices.product(arithmetic, matrices.scaled(off, -1), V))
            step = matrices.product(arithmetic, step, back)
            X = [[arithmetic.rounded(a + b) for a, b in zip(x, y, strict=True)] for x, y in zip(X, step, strict=True)]
        out: Matrix = [[] for _ in range(self._n)]
        for q, i in enumerate(rows):
            out[i] = [arithmetic.number(int(p == q)) for p in range(k)]
        for i, x in zip(others, X, strict=True):
            out[i] = x
        return out


def chosen_rows(basis: NDArray[np.complex128]) -> list[int]:
    """k rows of a basis (n, k) that are well independent, the first among about equal ones."""
    work, chosen = basis.copy(), []
    for _ in range(basis.shape[1]):
        sizes = np.linalg.norm(work, axis=1)
        row = int(np.argmax(sizes >= PIVOT_PREFERENCE * sizes.max()))
        chosen.append(row)
        along = work[row] / np.linalg.norm(work[row])
        work = work - np.outer(work @ along.conj(), along)
        work[row] = 0.0
    return sorted(chosen)


def _leading(series: SeriesEntries, n: int, nothing: Any) -> Matrix:
    return [[series[i, j][0] if (i, j) in series else nothing for j in range(n)] for i in range(n)]


def triangular(arithmetic: Arithmetic, growth: Matrix) -> tuple[Matrix, Matrix, Matrix]:
    """V, T, V⁻¹, all (k, k), with growth = V T V⁻¹ (k, k), T upper triangular, by Schur's form."""
    if not growth:
        return [], [], []
    k = range(len(growth))
    if len(growth) == 1:
        one = [[arithmetic.number(1)]]
        return one, growth, one
    V, T = mpmath.schur(mpmath.matrix([[arithmetic.to_mpmath(x) for x in row] for row in growth]))
    turned = [[arithmetic.complex(V[i, j]) for j in k] for i in k]
    upper = [[arithmetic.complex(T[i, j]) if i <= j else arithmetic.number(0) for j in k] for i in k]
    return turned, upper, [[arithmetic.complex(mpmath.conj(V[j, i])) for j in k] for i in k]


def sylvester_in_digits(arithmetic: Arithmetic, M: Matrix, C: Matrix, T: Matrix, R: Matrix) -> Matrix:
    """P (n, k) with M P + C P T = R for an upper triangular T, column by column."""
    columns: list[list[Any]] = []
    for q in range(len(T)):
        right = [row[q] for row in R]
        for p, column in enumerate(columns):
            right = [r - T[p][q] * x[0] for r, x in zip(right, matrices.product(arithmetic, C, [[y] for y in column]), strict=True)]
        found = matrices.solve(arithmetic, matrices.combined(M, C, T[q][q]), [[r] for r in right])
        columns.append([x for (x,) in found])
    return [list(row) for row in zip(*columns, strict=True)]
