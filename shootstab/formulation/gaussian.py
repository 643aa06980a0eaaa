"""Gaussian rationals: the exact numbers that coefficients are made of."""

from __future__ import annotations

from fractions import Fraction
from typing import Any

from shootstab.core.errors import InputError


class Gaussian:
    """re + i im with rational parts."""

    __slots__ = ("im", "re")

    def __init__(self, re: int | Fraction, im: int | Fraction = 0) -> None:
        self.re, self.im = re, im

    @staticmethod
    def of(x: Any) -> Gaussian:
        """The number that was meant: a float is the shortest decimal that it stands for. Raises InputError for what is no finite number."""
        if isinstance(x, Gaussian):
            return x
        if isinstance(x, int | Fraction) and not isinstance(x, bool):
            return Gaussian(x)
        try:
            if isinstance(x, str | bool):
                raise TypeError
            value = complex(x)
            return Gaussian(_decimal(value.real), _decimal(value.imag))
        except (TypeError, ValueError, OverflowError):
            raise InputError(f"{x!r} is no finite number: allowed is an int, a Fraction, a float or a complex") from None

    def __bool__(self) -> bool:
        return bool(self.re) or bool(self.im)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Gaussian) and self.re == other.re and self.im == other.im

    def __hash__(self) -> int:
        return hash((self.re, self.im))

    def __neg__(self) -> Gaussian:
        return Gaussian(-self.re, -self.im)

    def __add__(self, other: Gaussian) -> Gaussian:
        return Gaussian(self.re + other.re, self.im + other.im)

    def __mul__(self, other: Gaussian) -> Gaussian:
        if not self.im and not other.im:
            return Gaussian(self.re * other.re)
        return Gaussian(self.re * other.re - self.im * other.im, self.re * other.im + self.im * other.re)

    @property
    def inverse(self) -> Gaussian:
        """1/x. Raises ZeroDivisionError at 0."""
        size = Fraction(self.re * self.re + self.im * self.im)
        return Gaussian(self.re / size, -self.im / size)

    def power(self, n: int) -> Gaussian:
        """x^n for any integer n."""
        base, result = (self.inverse if n < 0 else self), ONE
        for _ in range(abs(n)):
            result = result * base
        return result

    def __complex__(self) -> complex:
        """The number in doubles. Raises InputError beyond their range."""
        try:
            return complex(self.re, self.im)
        except OverflowError:
            raise InputError("a coefficient comes to a number beyond 1e308: allowed are numbers that doubles hold") from None

    def __str__(self) -> str:
        if not self.im:
            return _plain(self.re)
        imaginary = "i" if self.im == 1 else "-i" if self.im == -1 else f"{_plain(self.im)}*i"
        return imaginary if not self.re else f"({_plain(self.re)}{'' if self.im < 0 else '+'}{imaginary})"


ONE, I = Gaussian(1), Gaussian(0, 1)  # noqa: E741 - the imaginary unit


def _decimal(x: float) -> Fraction:
    return Fraction(repr(float(x)))


def _plain(x: int | Fraction) -> str:
    """A short fraction, or its decimal."""
    text = str(x)
    return text if len(text) <= 8 else f"{float(x):.10g}"
