"""Power series with complex coefficients as arithmetic elements: what the problems' formulas are evaluated on, a whole series at a time.

A `Taylor` is a pair of real series, either of which may be absent: products of real, of imaginary and of absent parts cost
what they must and no more. It is a number to `vocabulary.series.Series`, so that derivatives nest around it.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

from shootstab.core.series import Series
from shootstab.multiprecision.arithmetic import Arithmetic


class Taylor:
    """re + i im, series of the same number of terms; None stands for an exact zero."""

    __slots__ = ("arithmetic", "im", "re", "terms")
    __array_ufunc__ = None

    def __init__(self, arithmetic: Arithmetic, terms: int, re: Any, im: Any) -> None:
        self.arithmetic, self.terms, self.re, self.im = arithmetic, terms, re, im

    @property
    def zero(self) -> bool:
        """Whether it is exactly zero."""
        return self.re is None and self.im is None

    def coefficients(self, terms: int) -> list[Any]:
        """The first coefficients as numbers, as many as are asked for."""
        re, im = (None if part is None else self.arithmetic.coefficients(part, terms) for part in (self.re, self.im))
        if im is None:
            return re if re is not None else [self.arithmetic.number(0)] * terms
        return [1j * self.arithmetic.complex(y) if re is None else re[m] + 1j * self.arithmetic.complex(y) for m, y in enumerate(im)]

    def derivative(self, factor: int) -> Taylor:
        """d/dx, whose last coefficient is not known and set to zero, or x d/dx, for factor = 0 and 1: the powers of x in front."""
        arithmetic, n = self.arithmetic, self.terms

        def of(part: Any) -> Any:
            if part is None:
                return None
            slopes = [m * c for m, c in enumerate(arithmetic.coefficients(part, n))]
            return arithmetic.series(slopes if factor else [*slopes[1:], arithmetic.number(0)])

        return self._like(of(self.re), of(self.im))

    def _like(self, re: Any, im: Any) -> Taylor:
        return Taylor(self.arithmetic, self.terms, re, im)

    def __neg__(self) -> Taylor:
        arithmetic = self.arithmetic
        return self._like(*(None if part is None else arithmetic.negative(part) for part in (self.re, self.im)))

    def __add__(self, other: Any) -> Any:
        if isinstance(other, Series):
            return NotImplemented
        arithmetic = self.arithmetic
        if isinstance(other, Taylor):
            return self._like(_sum(arithmetic, self.re, other.re), _sum(arithmetic, self.im, other.im))
        parts = []
        for mine, theirs in zip((self.re, self.im), arithmetic.parts(_number(arithmetic, other)), strict=True):
            if theirs is None:
                parts.append(mine)
            elif mine is None:
                parts.append(arithmetic.series([theirs] + [arithmetic.number(0)] * (self.terms - 1)))
            else:
                parts.append(arithmetic.plus_number(mine, theirs))
        return self._like(*parts)

    __radd__ = __add__

    def __sub__(self, other: Any) -> Any:
        return NotImplemented if isinstance(other, Series) else self + (-other)

    def __rsub__(self, other: Any) -> Any:
        return (-self) + other

    def __mul__(self, other: Any) -> Any:
        if isinstance(other, Series):
            return NotImplemented
        arithmetic = self.arithmetic
        times: Callable[[Any, Any], Any] = arithmetic.times
        if isinstance(other, Taylor):
            a, b, c, d = self.re, self.im, other.re, other.im
        else:
            a, b, times = self.re, self.im, arithmetic.scaled
            c, d = arithmetic.parts(_number(arithmetic, other))
        ac, bd = _product(times, a, c), _product(times, b, d)
        re = _sum(arithmetic, ac, None if bd is None else arithmetic.negative(bd))
        return self._like(re, _sum(arithmetic, _product(times, a, d), _product(times, b, c)))

    __rmul__ = __mul__

    def __truediv__(self, other: Any) -> Any:
        if isinstance(other, Series):
            return NotImplemented
        arithmetic = self.arithmetic
        if not isinstance(other, Taylor):
            return self * (1 / _number(arithmetic, other))
        if other.im is None:
            return self._like(*(None if part is None else arithmetic.over(part, other.re) for part in (self.re, self.im)))
        size = _sum(arithmetic, _product(arithmetic.times, other.re, other.re), arithmetic.times(other.im, other.im))
        conjugate = self._like(other.re, arithmetic.negative(other.im))
        return (self * conjugate) / self._like(size, None)

    def __rtruediv__(self, other: Any) -> Any:
        return (self._like(None, None) + other) / self

    def __pow__(self, exponent: Any) -> Any:
        """Integer powers of anything, other powers of real series."""
        if isinstance(exponent, int) and exponent >= 0:
            result = self._like(None, None) + 1
            for _ in range(exponent):
                result = result * self if _ else self
            return result
        if self.im is not None:
            raise ValueError("a power that is no natural number asks for a real series")
        return self._like(self.arithmetic.power(self.re, exponent), None)


def real_series(arithmetic: Arithmetic, coefficients: Sequence[Any]) -> Taylor:
    """The series with these real coefficients."""
    return Taylor(arithmetic, len(coefficients), arithmetic.series(coefficients), None)


def _number(arithmetic: Arithmetic, x: Any) -> Any:
    if isinstance(x, int | float):
        return arithmetic.number(x)
    return arithmetic.complex(x) if isinstance(x, complex) else x


def _sum(arithmetic: Arithmetic, a: Any, b: Any) -> Any:
    if a is None or b is None:
        return b if a is None else a
    return arithmetic.plus(a, b)


def _product(times: Any, a: Any, b: Any) -> Any:
    return None if a is None or b is None else times(a, b)
