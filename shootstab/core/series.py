"""Truncated power series over any ring: one arithmetic for derivatives, far-field expansions and Taylor steps.

A `Series` with coefficients (c0, c1, …) stands for c0 + c1 x + … + O(x^N). The coefficients may be floats, complex numbers,
NumPy arrays (one series for each node), mpmath numbers, or series in another variable: a formula written once for numbers
then yields its derivatives and expansions as well. A series of two terms is a dual number, f + f′ε.

Series nest. Of two operands the deeper one is the series in the outer variable, and takes the other as a constant.
"""

from __future__ import annotations

from typing import Any


class Series:
    """c0 + c1 x + … + c_{N−1} x^{N−1} + O(x^N)."""

    __slots__ = ("coefficients", "depth")
    __array_ufunc__ = None  # NumPy arrays are coefficients here, never the container

    def __init__(self, coefficients: Any, deep: int = 0) -> None:
        """deep is the depth if that is known already."""
        self.coefficients = tuple(coefficients)
        self.depth: int = deep or 1 + max(map(depth, self.coefficients))

    def __len__(self) -> int:
        return len(self.coefficients)

    def __getitem__(self, index: int) -> Any:
        return self.coefficients[index]

    def __repr__(self) -> str:
        return f"Series{self.coefficients!r}"

    def __neg__(self) -> Series:
        return Series([-c for c in self.coefficients], self.depth)

    def __add__(self, other: Any) -> Any:
        deep = depth(other)
        if deep > self.depth:
            return other + self
        if deep < self.depth:
            return Series((self.coefficients[0] + other, *self.coefficients[1:]), self.depth)
        return Series([a + b for a, b in zip(self.coefficients, other.coefficients, strict=False)], deep)

    __radd__ = __add__

    def __sub__(self, other: Any) -> Any:
        return self + (-other)

    def __rsub__(self, other: Any) -> Any:
        return (-self) + other

    def __mul__(self, other: Any) -> Any:
        deep = depth(other)
        if deep > self.depth:
            return other * self
        if deep < self.depth:
            return Series([a * other for a in self.coefficients], self.depth)
        a, b = self.coefficients, other.coefficients
        return Series([_convolve(a, b, m) for m in range(min(len(a), len(b)))], deep)

    __rmul__ = __mul__

    def __truediv__(self, other: Any) -> Series:
        deep = depth(other)
        if deep > self.depth:
            return _quotient((self,), other, len(other))
        if deep < self.depth:
            return Series([a / other for a in self.coefficients], self.depth)
        return _quotient(self.coefficients, other, min(len(self), len(other)))

    def __rtruediv__(self, other: Any) -> Series:
        return _quotient((other,), self, len(self))

    def __pow__(self, exponent: Any) -> Any:
        """a^r from a c′ = r a′ c with c = a^r; r = 0, 1, 2, 3 by multiplication, so that a0 = 0 is allowed."""
        if exponent == 0:
            return constant(1 + 0 * self[0], len(self))
        if exponent == 1:
            return self
        if exponent == 2:
            return self * self
        if exponent == 3:
            return self * self * self
        a = self.coefficients
        c: list[Any] = [a[0] ** exponent]
        for m in range(1, len(a)):
            c.append(sum((exponent * j - (m - j)) * (a[j] * c[m - j]) for j in range(1, m + 1)) / (m * a[0]))
        return Series(c, self.depth)

    def derivative(self) -> Series:
        """d/dx; one term shorter."""
        return Series(m * self[m] for m in range(1, len(self)))


def depth(x: Any) -> int:
    """How many series are nested in x: 0 for a number."""
    return x.depth if isinstance(x, Series) else 0


def constant(value: Any, terms: int) -> Series:
    """value + 0 x + … with the number of terms given."""
    return Series((value, *((0 * value,) * (terms - 1))))


def _quotient(a: tuple[Any, ...], divisor: Series, terms: int) -> Series:
    """c b = a, order by order; terms of a that are not given are zero."""
    b = divisor.coefficients
    c: list[Any] = [a[0] / b[0]]
    for m in range(1, terms):
        carried = sum(b[j] * c[m - j] for j in range(1, m + 1))
        c.append((a[m] - carried if m < len(a) else -carried) / b[0])
    return Series(c, divisor.depth)


def _convolve(a: tuple[Any, ...], b: tuple[Any, ...], m: int) -> Any:
    total = a[0] * b[m]
    for j in range(1, m + 1):
        total = total + a[j] * b[m - j]
    return total
