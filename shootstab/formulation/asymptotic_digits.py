"""The decaying space at an end where coefficients go as powers, to any number of digits: the series of asymptotic_space.py.

The space is the range of S [I; X], with the identity in k rows that are chosen once, and X = Σ X_j t^j in the others,

    r^{−q} X′ = A21 + A22 X − X h,   h = A11 + A12 X.

Each order is one Sylvester equation. No exponent enters, so that solutions may have logarithms. What is exponentially small in the
coefficients was left out: the integration begins where it is smaller than the tolerance, and where the series comes to it.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from fractions import Fraction
from typing import Any

import mpmath
import numpy as np
import scipy.linalg
from numpy.typing import NDArray

from shootstab.core.errors import ConvergenceError
from shootstab.formulation.asymptotic_end import AsymptoticEnd
from shootstab.formulation.decaying_digits import (
    PLACE_BITS,
    SEED_DIGITS,
    SMALLEST_SPLITTING,
    chosen_rows,
    sylvester_in_digits,
    triangular,
)
from shootstab.formulation.series_digits import on_numbers, on_series
from shootstab.formulation.state_pencil import Powers, StatePencil
from shootstab.multiprecision import small_matrices as matrices
from shootstab.multiprecision.arithmetic import Arithmetic, Matrix
from shootstab.multiprecision.linear_step import at_sigma
from shootstab.multiprecision.settings import Settings
from shootstab.multiprecision.taylor import Taylor, real_series
from shootstab.problems.ends import INFINITIES

BESIDE_MODE = 1 / 64  # chosen: relative distance of the σ at which the growth of the terms is looked at
FARTHER_SERIES = 0.25  # chosen: part of the distance by which another integration begins farther out
PLACE_GROWTH = 1.15  # chosen: ratio of the distances at which what was left out is looked at
LARGEST_DISTANCE = 1e6  # chosen: the distance at which an integration begins at most
LEFT_OUT_PLACES = (1.0, 1.3, 2.0, 3.0)  # chosen: multiples of the distance at which it is looked at


class AsymptoticSpaceInDigits:
    """See subdomain_digits.Beginning: the decaying space of one end in one arithmetic."""

    def __init__(
        self, arithmetic: Arithmetic, settings: Settings, end: AsymptoticEnd, system: StatePencil, k: int, target: Fraction
    ) -> None:
        """target: where the integration goes, from farther out."""
        self._arithmetic, self._settings, self._end, self._system, self._k, self._target = arithmetic, settings, end, system, k, target
        self._n = system.size
        self._terms = 1 if end.constant else settings.far_terms
        self._parts = [self._series(part) for part in (end.C, end.D)]
        self._rows: list[int] = []
        self.place = target

    def begin(self, sigma: Any) -> None:
        """Choose the place, farther out than the target. Raises ConvergenceError where the series holds nowhere."""
        self._rows = chosen_rows(self._seed(self._matrices(sigma)[0]))
        # the series may end by itself at a mode, as that of hydrogen does: its growth is seen beside the mode
        beside = sigma + self._arithmetic.number(BESIDE_MODE) * (sigma if not matrices.vanishes(sigma) else 1)
        X, _ = self._solutions(self._matrices(beside))
        p, aim = self._end.root, -self._settings.far_tolerance * math.log2(10)
        sizes = [max((self._arithmetic.log2(x) for row in part for x in row), default=-math.inf) for part in X]
        window = self._window()
        needed = [
            max((max(sizes[i] - aim, 0.0) / i for i in range(max(1, j - window + 1), j + 1)), default=0.0)
            for j in range(min(window, self._terms - 1), self._terms)
        ]
        r = 2.0 ** (p * min(needed, default=0.0))
        direction = self._end.direction
        r = max(r, 1.0, direction * float(self._target) + 1.0)
        while self._left_out(r) > aim:
            r *= PLACE_GROWTH
            if r > LARGEST_DISTANCE:
                where = INFINITIES[direction]
                raise ConvergenceError(
                    f"at {where} the coefficients do not come to their series to {self._settings.far_tolerance:.0f} digits"
                )
        r *= 1.0 + FARTHER_SERIES * self._settings.far_shift
        self.place = direction * Fraction(round(r * 2**PLACE_BITS), 2**PLACE_BITS)

    def frame(self, sigma: Any) -> tuple[Matrix, Any]:
        """S [I; X] (n, k) at the place, and the determinant of the solutions there."""
        arithmetic, p, Q = self._arithmetic, self._end.root, self._end.rank
        X, traces = self._solutions(self._matrices(sigma))
        r = mpmath.mpf(abs(self.place).numerator) / abs(self.place).denominator
        root = mpmath.root(r, p)
        t, power = arithmetic.number(1 / root), arithmetic.number(1)
        total = [list(row) for row in X[0]]
        for part in X[1:]:
            power = arithmetic.rounded(power * t)
            total = [[a + power * b for a, b in zip(s, x, strict=True)] for s, x in zip(total, part, strict=True)]
        logarithm = mpmath.mpf(0)
        for j, b in enumerate(traces):
            e = Q - j + p
            logarithm += arithmetic.to_mpmath(b) * (mpmath.log(r) if e == 0 else mpmath.mpf(p) / e * root**e)
        whole: Matrix = [[] for _ in range(self._n)]
        for q, i in enumerate(self._rows):
            whole[i] = [arithmetic.number(int(q == c)) for c in range(self._k)]
        for i, row in zip(self._others, total, strict=True):
            whole[i] = row
        scales = [arithmetic.number(root**s) for s in self._end.shifts]
        return [[arithmetic.rounded(s * x) for x in row] for s, row in zip(scales, whole, strict=True)], arithmetic.complex(
            mpmath.exp(logarithm)
        )

    farthest = 0.0

    def beyond(self, sigma: Any, c: Matrix, place: Any, distance: Any) -> Matrix:
        """Nothing is asked for: the place is as far out as the solution is shown."""
        return []

    @property
    def _others(self) -> list[int]:
        return [i for i in range(self._n) if i not in self._rows]

    def _series(self, powers: Powers) -> list[dict[tuple[int, int], Taylor]]:
        zero, one = self._arithmetic.number(0), self._arithmetic.number(1)
        t = real_series(self._arithmetic, [zero, one] + [zero] * (self._settings.far_terms - 2))
        at = on_series(self._arithmetic, t)
        values = [{place: at(entry) for place, entry in part.items()} for part in powers]
        return [{place: value if isinstance(value, Taylor) else 0 * t + value for place, value in part.items()} for part in values]

    def _window(self) -> int:
        """See AsymptoticEnd.window."""
        held = [e.coefficients(self._terms) for powers in self._parts for part in powers for e in part.values()]
        return self._end.window([any(not matrices.vanishes(c[j]) for c in held) for j in range(self._terms)])

    def _matrices(self, sigma: Any) -> list[Matrix]:
        """A_j (n, n) for every j."""
        arithmetic, n, terms = self._arithmetic, range(self._n), self._terms
        C, D = ({at: e.coefficients(terms) for at, e in at_sigma(part, sigma).items()} for part in self._parts)
        nothing = arithmetic.number(0)
        inverse = matrices.inverse(arithmetic, [[C[i, j][0] if (i, j) in C else nothing for j in n] for i in n])
        moving = [(at, e) for at, e in C.items() if any(not matrices.vanishes(x) for x in e[1:])]
        A: list[Matrix] = []
        for m in range(terms):
            right = [[self._end.direction * D[i, j][m] if (i, j) in D else nothing for j in n] for i in n]
            for (i, j), e in moving:
                for order in range(1, m + 1):
                    if not matrices.vanishes(e[order]):
                        right[i] = [x - e[order] * y for x, y in zip(right[i], A[m - order][j], strict=True)]
            A.append(matrices.product(arithmetic, inverse, right))
        shifted = self._end.root + self._end.rank
        if shifted < terms:
            for i, s in enumerate(self._end.shifts):
                A[shifted][i][i] = A[shifted][i][i] - arithmetic.number(Fraction(s, self._end.root))
        return A

    def _seed(self, A: Matrix) -> NDArray[np.complex128]:
        """A basis (n, k) of the decaying space of A_0 in double precision. Raises ConvergenceError where it is not told apart."""
        double = np.array([[complex(self._arithmetic.to_mpmath(x)) for x in row] for row in A])
        rates = np.sort(np.linalg.eigvals(double).real)
        edges = [-np.inf, *rates, np.inf]
        low, high = edges[self._k], edges[self._k + 1]
        if not high - low > SMALLEST_SPLITTING * np.abs(rates).max():
            where = INFINITIES[self._end.direction]
            raise ConvergenceError(f"sigma lies on the essential spectrum: at {where} no gap is between what decays and what does not")
        middle = 0.5 * (low + high)  # infinite where all decay, or none
        _, Q, _ = scipy.linalg.schur(double, output="complex", sort=lambda x: x.real < middle)
        return np.asarray(Q[:, : self._k])

    def _solutions(self, A: Sequence[Matrix]) -> tuple[list[Matrix], list[Any]]:
        """X_j (n − k, k) and tr h_j for every j."""
        arithmetic, rows, others, k = self._arithmetic, self._rows, self._others, range(self._k)
        nothing, p, Q = arithmetic.number(0), self._end.root, self._end.rank

        def block(M: Matrix, i: list[int], j: list[int]) -> Matrix:
            return [[M[r][c] for c in j] for r in i]

        A11, A12, A21, A22 = ([block(M, i, j) for M in A] for i in (rows, others) for j in (rows, others))
        X = [self._invariant(A[0])]
        h = [_plus(A11[0], _sum(nothing, [(A12[0], X[0])], k))]
        B = [[a - b for a, b in zip(x, y, strict=True)] for x, y in zip(A22[0], _product(nothing, X[0], A12[0]), strict=True)]
        V, T, back = triangular(arithmetic, h[0])
        one = [[arithmetic.number(-int(r == s)) for s in range(len(others))] for r in range(len(others))]
        for j in range(1, len(A)):
            known = _plus(A11[j], _sum(nothing, [(A12[i], X[j - i]) for i in range(1, j + 1)], k))
            right = _plus(A21[j], _sum(nothing, [(A22[i], X[j - i]) for i in range(1, j + 1)], k))
            right = _minus(right, _sum(nothing, [(X[i], h[j - i]) for i in range(1, j)] + [(X[0], known)], k))
            earlier = j - Q - p
            if earlier > 0:
                factor = arithmetic.number(Fraction(earlier, p))
                right = [[a + factor * b for a, b in zip(x, y, strict=True)] for x, y in zip(right, X[earlier], strict=True)]
            # (A22 − X_0 A12) X_j − X_j h_0 = −right, column by column in the basis in which h_0 is triangular
            turned = matrices.product(arithmetic, matrices.scaled(right, -1), V) if others else right
            found = sylvester_in_digits(arithmetic, B, one, T, turned) if others else turned
            X.append(matrices.product(arithmetic, found, back) if others else found)
            h.append(_plus(known, _sum(nothing, [(A12[0], X[j])], k)))
        return X, [sum((part[q][q] for q in k), nothing) for part in h]

    def _invariant(self, A: Matrix) -> Matrix:
        """X_0, by Newton's iteration for A21 + A22 X − X (A11 + A12 X) = 0 from double precision."""
        arithmetic, rows, others = self._arithmetic, self._rows, self._others
        if not others:
            return []
        basis, nothing = self._seed(A), arithmetic.number(0)
        X = [[arithmetic.complex(complex(x)) for x in row] for row in np.linalg.solve(basis[rows].T, basis[others].T).T]
        A11, A12, A21, A22 = ([[A[r][c] for c in j] for r in i] for i in (rows, others) for j in (rows, others))
        one = [[arithmetic.number(-int(r == s)) for s in range(len(others))] for r in range(len(others))]
        for _ in range(max(1, math.ceil(math.log2(self._settings.digits / SEED_DIGITS))) + 1):
            h = _plus(A11, _product(nothing, A12, X))
            off = _minus(_plus(A21, _product(nothing, A22, X)), _product(nothing, X, h))
            B = _minus(A22, _product(nothing, X, A12))
            V, T, back = triangular(arithmetic, h)
            step = sylvester_in_digits(arithmetic, B, one, T, matrices.product(arithmetic, matrices.scaled(off, -1), V))
            step = matrices.product(arithmetic, step, back)
            X = [[arithmetic.rounded(a + b) for a, b in zip(x, y, strict=True)] for x, y in zip(X, step, strict=True)]
        return X

    def _left_out(self, r: float) -> float:
        """log2 of the relative size of what was left out of the coefficients at r and beyond."""
        if not self._end.dropped:
            return -math.inf
        arithmetic, end = self._arithmetic, self._end
        largest, size = -math.inf, -math.inf
        for factor in LEFT_OUT_PLACES:
            distance = Fraction(round(factor * r * 2**PLACE_BITS), 2**PLACE_BITS)
            root = mpmath.root(mpmath.mpf(distance.numerator) / distance.denominator, end.root)
            whole, kept = (
                on_numbers(arithmetic, arithmetic.number(end.direction * distance)),
                on_numbers(arithmetic, arithmetic.number(1 / root)),
            )
            for own, entries, rank in ((self._system.C, end.C, 0), (self._system.D, end.D, end.rank)):
                for own_part, part in zip(own, entries, strict=True):
                    for at, entry in own_part.items():
                        power = rank + end.own[at[0]] + end.shifts[at[0]] - end.shifts[at[1]]
                        value = whole(entry) * arithmetic.number(root**-power)
                        left = kept(part[at]) if at in part else arithmetic.number(0)
                        largest, size = max(largest, arithmetic.log2(value - left)), max(size, arithmetic.log2(1 * left))
        return largest - size


def _product(nothing: Any, A: Matrix, B: Matrix) -> Matrix:
    return [[sum((a * b for a, b in zip(row, column, strict=True)), nothing) for column in zip(*B, strict=True)] for row in A]


def _sum(nothing: Any, pairs: Sequence[tuple[Matrix, Matrix]], k: range) -> Matrix:
    """Σ M N of pairs (M, N), where zeros of M are left out; N has so many columns."""
    total = [[nothing for _ in k] for _ in pairs[0][0]] if pairs else []
    for M, N in pairs:
        for i, row in enumerate(M):
            for factor, other in zip(row, N, strict=True):
                if not matrices.vanishes(factor):
                    total[i] = [a + factor * b for a, b in zip(total[i], other, strict=True)]
    return total


def _plus(A: Matrix, B: Matrix) -> Matrix:
    return [[a + b for a, b in zip(x, y, strict=True)] for x, y in zip(A, B, strict=True)]


def _minus(A: Matrix, B: Matrix) -> Matrix:
    return [[a - b for a, b in zip(x, y, strict=True)] for x, y in zip(A, B, strict=True)]
