"""The arithmetic of python-flint: arb and acb. Of the balls only the midpoints count: where radii would pile up they are dropped."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from fractions import Fraction
from operator import mul
from typing import Any

import mpmath
from flint import acb, acb_mat, arb, arb_mat, arb_series, ctx, fmpq

from shootstab.discriminants.precise.arithmetic import Matrix

LONGEST = 10**6  # terms, more than any series has
GROUP = 4  # terms of a convolution that one matrix product takes


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

    def convolution(self, A: Sequence[Sequence[Any]]) -> Products:
        return Products(A)

    def multiplier(self, A: Matrix) -> Callable[[Matrix], Matrix]:
        left = _matrix(A)

        def multiply(B: Matrix) -> Matrix:
            product: Matrix = (left * _matrix(B)).mid().tolist()
            return product

        return multiply

    def inverse(self, A: Matrix) -> Matrix:
        inverse: Matrix = _matrix(A).inv().mid().tolist()
        return inverse


class Products:
    """Σ_j A_j Y_{m−j} by products of real matrices, GROUP terms at a time, the rows Re A over Im A and the columns Re Y beside Im Y.

    Rows that vanish in every A_j are left out.
    """

    def __init__(self, A: Sequence[Sequence[Any]]) -> None:
        self._n, self._places = len(A[0]), []
        rows: list[list[Any]] = []
        for row in A:
            place: list[int | None] = []
            for part in (0, 1):
                series = [None if e[part] is None else e[part].coeffs() for e in row]
                place.append(len(rows) if any(series) else None)
                if any(series):
                    rows.append([[] if c is None else c for c in series])
            self._places.append(place)
        self._wide = any(im is not None for _, im in self._places)
        terms = max((len(c) for row in rows for c in row), default=0)
        nothing = arb(0)
        self._A = [
            arb_mat([[c[m].mid() if m < len(c) else nothing for m in range(start, start + GROUP) for c in row] for row in rows])
            for start in range(0, terms, GROUP)
        ]
        self._last: list[Any] = []  # the last GROUP terms of Y, the newest first, row by row
        self._Y: list[Any] = []  # those terms, one matrix for each m

    def push(self, term: Matrix) -> None:
        k = len(term[0])
        if not self._last:
            self._k, self._wide = k, self._wide or any(isinstance(x, acb) for row in term for x in row)
            self._last = [arb(0)] * (self._n * k * (1 + self._wide) * GROUP)
        flat = [x for row in term for x in ([*(_real(x) for x in row), *(_imag(x) for x in row)] if self._wide else row)]
        self._last = flat + self._last[: len(self._last) - len(flat)]
        self._Y.append(arb_mat(self._n * GROUP, k * (1 + self._wide), self._last).mid())

    def value(self) -> Matrix:
        k, A, Y = self._k, self._A, self._Y
        m = len(Y) - 1
        if not A:
            return [[arb(0)] * k for _ in self._places]
        total = A[0] * Y[m]
        for i in range(1, min(m // GROUP + 1, len(A))):
            total = total + A[i] * Y[m - GROUP * i]
        found = total.mid().tolist()
        nothing = [arb(0)] * (2 * k)
        if not self._wide:
            return [nothing[:k] if re is None else found[re] for re, _ in self._places]
        out = []
        for re, im in self._places:
            a, b = (nothing if at is None else found[at] for at in (re, im))
            out.append([acb(a[q] - b[k + q], a[k + q] + b[q]) for q in range(k)])
        return out


def _matrix(A: Matrix) -> Any:
    """Real if every entry is."""
    return acb_mat(A) if any(isinstance(x, acb) for row in A for x in row) else arb_mat(A)


def _real(x: Any) -> Any:
    return x.real if isinstance(x, acb) else x


def _imag(x: Any) -> Any:
    return x.imag if isinstance(x, acb) else arb(0)
