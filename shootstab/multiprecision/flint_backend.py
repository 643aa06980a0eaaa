"""The arithmetic of python-flint: arb and acb.

Where digits are asked for only the midpoints count, and radii are dropped where they would pile up; where an enclosure is asked for
(radii=True) none is dropped, and the recurrences give the terms of a series as balls that hold them. A series is then known as far as its
terms go: what lies behind them has its own bound (tails.py).
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from fractions import Fraction
from operator import mul
from typing import Any

import mpmath
from flint import acb, acb_mat, arb, arb_mat, arb_series, ctx, fmpq

from shootstab.multiprecision.arithmetic import TAIL_TERMS, CompiledRecurrence, Matrix, Payloads
from shootstab.multiprecision.limb_transport import carried_by, terms_of
from shootstab.multiprecision.relaxed_program import RelaxedProgram

LONGEST_SERIES = 10**6  # chosen: terms, more than any series has
GROUP = 6  # chosen: terms of a convolution that one matrix product takes
ZERO = arb(0)


class FlintArithmetic:
    """Arb's numbers and series, as midpoints or, with radii, as balls."""

    name = "flint"

    def __init__(self, radii: bool = False) -> None:
        self._kept: Callable[[Any], Any] = _ball if radii else _midpoint

    @contextmanager
    def working(self, digits: int) -> Iterator[None]:
        saved = ctx.prec, ctx.cap
        ctx.prec, ctx.cap = math.ceil(digits * math.log2(10)) + 8, LONGEST_SERIES
        try:
            yield
        finally:
            ctx.prec, ctx.cap = saved

    def number(self, x: Any) -> Any:
        if isinstance(x, Fraction):
            return self._kept(arb(fmpq(x.numerator, x.denominator)))
        return self._kept(arb(x))

    def complex(self, x: Any) -> Any:
        return acb(self.number(x)) if isinstance(x, Fraction) else self._kept(acb(x))

    def parts(self, x: Any) -> tuple[Any, Any]:
        if isinstance(x, complex):
            x = acb(x)
        if not isinstance(x, acb):
            return (None if x == 0 else x), None
        return (None if x.real.is_zero() else x.real), (None if x.imag.is_zero() else x.imag)

    def rounded(self, x: Any) -> Any:
        return self._kept(x)

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
        return self._kept(arb.pi())

    def dot(self, a: Sequence[Any], b: Sequence[Any]) -> Any:
        return self._kept(sum(map(mul, a, b), ZERO))

    def recurrence(self, system: Any, unknowns: Sequence[Any], slopes: Sequence[Any]) -> CompiledRecurrence | None:
        return RelaxedProgram.of(system, unknowns, slopes) if self._kept is _midpoint else None

    def series(self, coefficients: Sequence[Any]) -> Any:
        return arb_series([*coefficients], prec=len(coefficients))

    def coefficients(self, series: Any, terms: int) -> list[Any]:
        found = [self._kept(c) for c in series.coeffs()]
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

    def convolution(self, A: Payloads) -> Products:
        return Products(A, self._kept)

    def carried(self, A: Payloads, left: Matrix, Y: Matrix, terms: int) -> tuple[Callable[[float], Matrix], Sequence[Matrix]]:
        loops = terms_of(A, left, Y, terms) if self._kept is _midpoint else None
        if loops is not None:
            return carried_by(loops)
        products, found = self._packed_terms(A, left, Y, terms)

        def at(t: float) -> Matrix:
            total, x = found[-1], arb(t)
            for term in found[-2::-1]:
                total = self._kept(total * x + term)
            return products.unpacked(total)

        return at, [products.unpacked(term) for term in found[-TAIL_TERMS:]]

    def expanded(self, A: Payloads, left: Matrix, Y: Matrix, terms: int) -> list[Matrix]:
        products, found = self._packed_terms(A, left, Y, terms)
        return [products.unpacked(term) for term in found]

    def _packed_terms(self, A: Payloads, left: Matrix, Y: Matrix, terms: int) -> tuple[Products, list[Any]]:
        """Nothing is unpacked on the way: the products go from one matrix to the next."""
        products = Products(A, self._kept)
        found = [products.packed(Y)]
        products.push_packed(found[0])
        turn = products.turn
        (E, iE), (F, iF) = (products.after(left, range(start, start + len(Y))) for start in (0, len(Y)))
        for m in range(1, terms):
            P = products.sums()
            new = E * P * (1 / arb(m)) - F * P
            if products.wide:
                iP = P * turn
                new = new + iE * iP * (1 / arb(m)) - iF * iP
            found.append(self._kept(new))
            products.push_packed(found[-1])
        return products, found

    def multiplier(self, A: Matrix) -> Callable[[Matrix], Matrix]:
        left = _matrix(A)

        def multiply(B: Matrix) -> Matrix:
            product: Matrix = self._kept(left * _matrix(B)).tolist()
            return product

        return multiply

    def inverse(self, A: Matrix) -> Matrix:
        inverse: Matrix = self._kept(_matrix(A).inv()).tolist()
        return inverse


class Products:
    """Σ_j A_j Y_{m−j} by products of real matrices, GROUP terms at a time, the rows of Re A and of Im A and the columns Re Y beside Im Y.

    Rows that vanish in every A_j are left out. A Y is real (n, k), or packed as Re Y beside Im Y (n, 2k) if anything is complex.
    """

    def __init__(self, A: Payloads, kept: Callable[[Any], Any]) -> None:
        """kept: what of a matrix of balls counts, its midpoints or all of it."""
        self._kept = kept
        self._n, self._places = len(A[0]), []  # where the real and the imaginary part of each row went
        rows: list[list[Any]] = []
        for row in A:
            place: list[int | None] = []
            for part in (0, 1):
                series = [[] if e[part] is None else e[part].coeffs() for e in row]
                place.append(len(rows) if any(series) else None)
                if any(series):
                    rows.append(series)
            self._places.append(place)
        self._rows = len(rows)
        self.wide = any(im is not None for _, im in self._places)
        terms = max((len(c) for row in rows for c in row), default=0)
        nothing = arb(0)
        self._A = [
            kept(arb_mat([[c[m] if m < len(c) else nothing for m in range(start, start + GROUP) for c in row] for row in rows]))
            for start in range(0, terms, GROUP)
        ]
        self._last: list[Any] = []  # the last GROUP terms of Y, the newest first, row by row
        self._Y: list[Any] = []  # those terms, one matrix for each m

    def push(self, term: Matrix) -> None:
        self.push_packed(self.packed(term))

    def packed(self, term: Matrix) -> Any:
        """The term as one real matrix (n, m). The first one decides whether Y is complex."""
        if not self._last:
            self._k = len(term[0])
            self.wide = self.wide or any(isinstance(x, acb) for row in term for x in row)
            self._last = [arb(0)] * (self._n * self._k * (1 + self.wide) * GROUP)
        if not self.wide:
            return arb_mat(term)
        return arb_mat([[*(_real(x) for x in row), *(_imag(x) for x in row)] for row in term])

    def push_packed(self, term: Any) -> None:
        """The next term of Y."""
        flat = term.entries()
        self._last = flat + self._last[: len(self._last) - len(flat)]
        self._Y.append(self._kept(arb_mat(self._n * GROUP, self._k * (1 + self.wide), self._last)))

    def sums(self) -> Any:
        """The rows of Σ_j A_j Y_{m−j} that do not vanish, the packed columns."""
        A, Y = self._A, self._Y
        if not A:
            return arb_mat(self._rows, self._k * (1 + self.wide))
        m = len(Y) - 1
        total = A[0] * Y[m]
        for i in range(1, min(m // GROUP + 1, len(A))):
            total = total + A[i] * Y[m - GROUP * i]
        return self._kept(total)

    def value(self) -> Matrix:
        k, found = self._k, self.sums().tolist()
        nothing = [arb(0)] * (k * (1 + self.wide))
        pairs = [[nothing if at is None else found[at] for at in place] for place in self._places]
        if not self.wide:
            return [re for re, _ in pairs]
        return [[acb(re[q] - im[k + q], re[k + q] + im[q]) for q in range(k)] for re, im in pairs]

    def after(self, left: Matrix, part: range) -> tuple[Any, Any]:
        """U, V (r, n) with left · (these rows of Σ_j A_j Y_{m−j}) = U P + V (iP), where left is (r, s) and P is `sums`."""
        U, V = ([[arb(0)] * self._rows for _ in left] for _ in range(2))
        for u, v, row in zip(U, V, left, strict=True):
            for place, x in zip((self._places[i] for i in part), row, strict=True):
                for at, here, there in ((place[0], _real(x), _imag(x)), (place[1], -_imag(x), _real(x))):
                    if at is not None:
                        u[at], v[at] = here, there
        return arb_mat(U), arb_mat(V)

    @property
    def turn(self) -> Any:
        """The matrix that takes packed columns to those of i times them."""
        k = self._k
        return arb_mat([[(j == i + k) - (i == j + k) for j in range(2 * k)] for i in range(2 * k)])

    def unpacked(self, term: Any) -> Matrix:
        """The numbers (n, m) of a packed term."""
        k, rows = self._k, self._kept(term).tolist()
        return [[acb(x, y) for x, y in zip(row[:k], row[k:], strict=True)] for row in rows] if self.wide else rows


def _midpoint(x: Any) -> Any:
    return x.mid()


def _ball(x: Any) -> Any:
    return x


def _matrix(A: Matrix) -> Any:
    """Real if every entry is."""
    return acb_mat(A) if any(isinstance(x, acb) for row in A for x in row) else arb_mat(A)


def _real(x: Any) -> Any:
    return x.real if isinstance(x, acb) else x


def _imag(x: Any) -> Any:
    return x.imag if isinstance(x, acb) else arb(0)
