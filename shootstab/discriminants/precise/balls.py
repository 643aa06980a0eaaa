"""The arithmetic of python-flint: arb and acb. Of the balls only the midpoints count: where radii would pile up they are dropped."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from fractions import Fraction
from operator import mul
from typing import Any

import mpmath
from flint import acb, acb_mat, arb, arb_mat, arb_series, ctx, fmpq

from shootstab.discriminants.precise.arithmetic import Matrix

LONGEST = 10**6  # terms, more than any series has


class Balls:
    """Arb's numbers and series."""

    name = "flint"

    @contextmanager
    def working(self, digits: int) -> Iterator[None]:
        saved = ctx.prec, ctx.cap
        ctx.prec, ctx.cap = math.ceil(digits * math.log2(10)) + 8, LONGEST
        try:
            yield
        finally:
            ctx.prec, ctx.cap = saved

    def number(self, x: Any) -> Any:
        if isinstance(x, Fraction):
            return arb(fmpq(x.numerator, x.denominator)).mid()
        return arb(x).mid()

    def complex(self, x: Any) -> Any:
        return acb(self.number(x)) if isinstance(x, Fraction) else acb(x).mid()

    def parts(self, x: Any) -> tuple[Any, Any]:
        if isinstance(x, complex):
            x = acb(x)
        if not isinstance(x, acb):
            return (None if x == 0 else x), None
        return (None if x.real.is_zero() else x.real), (None if x.imag.is_zero() else x.imag)

    def rounded(self, x: Any) -> Any:
        return x.mid()

    def log2(self, x: Any) -> float:
        size = abs(x.mid())
        if size == 0:
            return -math.inf
        mantissa, exponent = size.mid().man_exp()
        return int(exponent) + math.log2(int(mantissa))

    def to_mpmath(self, x: Any) -> Any:
        if isinstance(x, acb):
            return mpmath.mp.make_mpc((x.real.mid()._mpf_, x.imag.mid()._mpf_))
        return mpmath.mp.make_mpf(arb(x).mid()._mpf_)

    @property
    def pi(self) -> Any:
        return arb.pi().mid()

    def dot(self, a: Sequence[Any], b: Sequence[Any]) -> Any:
        return sum(map(mul, a, b), arb(0)).mid()

    def series(self, coefficients: Sequence[Any]) -> Any:
        return arb_series([*coefficients], prec=len(coefficients))

    def coefficients(self, series: Any, terms: int) -> list[Any]:
        found = [c.mid() for c in series.coeffs()]
        return found[:terms] + [arb(0)] * (terms - len(found))

    def plus(self, a: Any, b: Any) -> Any:
        return a + b

    def plus_number(self, a: Any, x: Any) -> Any:
        return a + x

    def negative(self, a: Any) -> Any:
        return -a

    def scaled(self, a: Any, x: Any) -> Any:
        return a * x

    def times(self, a: Any, b: Any) -> Any:
        return a * b

    def over(self, a: Any, b: Any) -> Any:
        return a / b

    def power(self, a: Any, exponent: Any) -> Any:
        return a.sqrt() if exponent == 0.5 else a ** arb(exponent)

    def convolution(self, A: Sequence[Sequence[Any]], terms: int) -> Products:
        return Products(self, A, terms)


class Products:
    """Σ_j A_j Y_{m−j} as a sum of matrix products, real where everything is."""

    def __init__(self, ring: Balls, A: Sequence[Sequence[Any]], terms: int) -> None:
        self._real = all(im is None for row in A for _, im in row)
        n = len(A)
        nothing = [arb(0)] * terms
        re = [[nothing if e[0] is None else ring.coefficients(e[0], terms) for e in row] for row in A]
        im = [[nothing if e[1] is None else ring.coefficients(e[1], terms) for e in row] for row in A]
        cells = range(n)
        self._A: list[Any] = [arb_mat([[re[i][j][m] for j in cells] for i in cells]) for m in range(terms)]
        if not self._real:
            self._A = [acb_mat([[acb(re[i][j][m], im[i][j][m]) for j in cells] for i in cells]) for m in range(terms)]
        self._Y: list[Any] = []

    def push(self, term: Matrix) -> None:
        real = self._real and not any(isinstance(x, acb) for row in term for x in row)
        self._Y.append(arb_mat(term) if real else acb_mat(term))

    def value(self) -> Matrix:
        A, Y = self._A, self._Y
        m = len(Y) - 1
        total = A[0] * Y[m]
        for j in range(1, min(m + 1, len(A))):
            total = total + A[j] * Y[m - j]
        return [[x.mid() for x in row] for row in total.tolist()]
