"""The arithmetic of mpmath. Series are Python integers with a common exponent: their products are fast without another library."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from fractions import Fraction
from operator import mul
from typing import Any

from mpmath import libmp, mp

from shootstab.multiprecision import small_matrices as matrices
from shootstab.multiprecision.arithmetic import TAIL_TERMS, Matrix, Payloads
from shootstab.multiprecision.integer_series import Block, conv, fixed, inverse_conv, power_conv, shifted, trimmed

GUARD_BITS = 40  # chosen: bits of the integers beyond the working precision: one exponent serves a whole series
SPARE_OF_SUM = 16  # chosen: bits of a sum of products below those asked for


class MpmathArithmetic:
    """mpmath's numbers, series as blocks of integers."""

    name = "mpmath"

    @contextmanager
    def working(self, digits: int) -> Iterator[None]:
        with mp.workprec(math.ceil(digits * math.log2(10)) + 8):
            yield

    @property
    def _bits(self) -> int:
        return int(mp.prec) + GUARD_BITS

    def number(self, x: Any) -> Any:
        return mp.mpf(x.numerator) / x.denominator if isinstance(x, Fraction) else +mp.mpf(x)

    def complex(self, x: Any) -> Any:
        return mp.mpc(self.number(x)) if isinstance(x, Fraction) else +mp.mpc(x)

    def parts(self, x: Any) -> tuple[Any, Any]:
        if isinstance(x, mp.mpc | complex):
            re, im = mp.mpf(x.real), mp.mpf(x.imag)
            return (re if re else None), (im if im else None)
        return (x if x else None), None

    def rounded(self, x: Any) -> Any:
        return x

    def log2(self, x: Any) -> float:
        _, mantissa, exponent, _ = abs(mp.convert(x))._mpf_
        return exponent + math.log2(mantissa) if mantissa else -math.inf

    def to_mpmath(self, x: Any) -> Any:
        return x

    @property
    def pi(self) -> Any:
        return +mp.pi

    def dot(self, a: Sequence[Any], b: Sequence[Any]) -> Any:
        """Exact products, summed as integers."""
        products = []
        top = None
        for x, y in zip(a, b, strict=False):
            s, m, e, c = x._mpf_
            t, n, f, d = y._mpf_
            if m and n:
                products.append((m * n if s == t else -m * n, e + f))
                if top is None or e + f + c + d > top:
                    top = e + f + c + d
        if top is None:
            return mp.zero
        low = top - mp.prec - SPARE_OF_SUM
        total = 0
        for value, exponent in products:
            lift = exponent - low
            total += value << lift if lift >= 0 else value >> -lift
        return mp.make_mpf(libmp.from_man_exp(total, low, mp.prec, "n"))

    def recurrence(self, system: Any, unknowns: Sequence[Any], slopes: Sequence[Any]) -> None:
        """There are no compiled loops for mpmath's numbers."""

    def series(self, coefficients: Sequence[Any]) -> Block:
        return fixed(coefficients, self._bits)

    def coefficients(self, series: Block, terms: int) -> list[Any]:
        values, exponent = series
        found = [mp.make_mpf(libmp.from_man_exp(v, exponent, mp.prec, "n")) for v in values[:terms]]
        return found + [mp.zero] * (terms - len(found))

    def plus(self, a: Block, b: Block) -> Block:
        (x, e), (y, f) = a, b
        low = min(e, f)
        return trimmed(([u + v for u, v in zip(shifted(x, e - low), shifted(y, f - low), strict=False)], low), self._bits)

    def plus_number(self, a: Block, x: Any) -> Block:
        other = fixed([x], self._bits)
        return self.plus(a, ([*other[0], *([0] * (len(a[0]) - 1))], other[1]))

    def negative(self, a: Block) -> Block:
        return [-v for v in a[0]], a[1]

    def scaled(self, a: Block, x: Any) -> Block:
        (factor,), exponent = fixed([x], self._bits)
        return trimmed(([v * factor for v in a[0]], a[1] + exponent), self._bits)

    def times(self, a: Block, b: Block) -> Block:
        return trimmed((conv(a[0], b[0]), a[1] + b[1]), self._bits)

    def over(self, a: Block, b: Block) -> Block:
        return trimmed(inverse_conv(a, b, self._bits), self._bits)

    def power(self, a: Block, exponent: Any) -> Block:
        first = mp.make_mpf(libmp.from_man_exp(a[0][0], a[1])) ** exponent
        return trimmed(power_conv(a, first, mp.mpf(exponent), self._bits), self._bits)

    def convolution(self, A: Payloads) -> Dots:
        return Dots(self._bits, A)

    def carried(self, A: Payloads, left: Matrix, Y: Matrix, terms: int) -> tuple[Callable[[float], Matrix], Sequence[Matrix]]:
        found = self.expanded(A, left, Y, terms)

        def at(t: float) -> Matrix:
            return [[mp.polyval(list(x[::-1]), mp.mpf(t)) for x in zip(*rows, strict=True)] for rows in zip(*found, strict=True)]

        return at, found[-TAIL_TERMS:]

    def expanded(self, A: Payloads, left: Matrix, Y: Matrix, terms: int) -> list[Matrix]:
        n = len(Y)
        convolution, solved = self.convolution(A), self.multiplier(left)
        found = [Y]
        for m in range(1, terms):
            convolution.push(found[-1])
            both = convolution.value()
            found.append(solved([[e / m - f for e, f in zip(x, y, strict=True)] for x, y in zip(both[:n], both[n:], strict=True)]))
        return found

    def multiplier(self, A: Matrix) -> Callable[[Matrix], Matrix]:
        rows = [[(j, a) for j, a in enumerate(row) if a] for row in A]
        return lambda B: [[sum((a * B[j][q] for j, a in row if B[j][q]), mp.zero) for q in range(len(B[0]))] for row in rows]

    def inverse(self, A: Matrix) -> Matrix:
        return matrices.eliminated(self, A)


class Dots:
    """Σ_j A_j Y_{m−j} as dot products of integers; Y has one exponent, chosen by its first term."""

    def __init__(self, bits: int, A: Payloads) -> None:
        self._bits = bits
        self._rows = [[(b, self._backwards(re), self._backwards(im)) for b, (re, im) in enumerate(row) if re or im] for row in A]
        self._Y: list[list[tuple[list[int], list[int]]]] = []
        self._exponent: int | None = None

    @staticmethod
    def _backwards(block: Block | None) -> Block | None:
        return None if block is None else (block[0][::-1], block[1])

    def push(self, term: Matrix) -> None:
        parts = [[(x.real, x.imag) for x in row] for row in term]
        if self._exponent is None:
            top = max((sum(p._mpf_[2:4]) for row in parts for x in row for p in x if p), default=0)
            self._exponent = top - self._bits
            self._Y = [[([], []) for _ in row] for row in term]
        for row, out in zip(parts, self._Y, strict=True):
            for x, (re, im) in zip(row, out, strict=True):
                re.append(libmp.to_int(libmp.mpf_shift(x[0]._mpf_, -self._exponent)))
                im.append(libmp.to_int(libmp.mpf_shift(x[1]._mpf_, -self._exponent)))

    def value(self) -> Matrix:
        columns = range(len(self._Y[0]))
        moving = [[any(self._Y[b][q][1]) for q in columns] for b in range(len(self._Y))]
        zero = [[not (moving[b][q] or any(self._Y[b][q][0])) for q in columns] for b in range(len(self._Y))]
        return [[self._entry(row, q, moving, zero) for q in columns] for row in self._rows]

    def _entry(self, row: Sequence[Any], q: int, moving: list[list[bool]], zero: list[list[bool]]) -> Any:
        assert self._exponent is not None
        real, imag = mp.zero, mp.zero
        for b, A_re, A_im in row:
            y_re, y_im = self._Y[b][q]
            if zero[b][q]:
                continue
            if A_re is not None:
                real += self._dot(A_re, y_re)
                if moving[b][q]:
                    imag += self._dot(A_re, y_im)
            if A_im is not None:
                imag += self._dot(A_im, y_re)
                if moving[b][q]:
                    real -= self._dot(A_im, y_im)
        return mp.mpc(real, imag) if imag else real

    def _dot(self, backwards: Block, y: list[int]) -> Any:
        values, exponent = backwards
        skip = len(values) - len(y)
        assert self._exponent is not None
        total = sum(map(mul, values[skip:], y)) if skip >= 0 else sum(map(mul, values, y[-skip:]))
        return mp.make_mpf(libmp.from_man_exp(total, exponent + self._exponent, mp.prec + 10, "n"))
