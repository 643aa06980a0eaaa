"""What the formulas compute with: real and complex numbers of any precision, and real power series, of python-flint or of mpmath.

Everything above this module is written once and takes an `Arithmetic`; `FlintArithmetic` (python-flint) is fast,
`MpmathArithmetic` (mpmath) is always there, and each is the other's test.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from contextlib import AbstractContextManager
from fractions import Fraction
from typing import Any, Protocol

Matrix = list[list[Any]]  # a matrix of numbers, by rows
Payloads = Sequence[Sequence[tuple[Any, Any]]]  # a matrix of series, each as its real and its imaginary part, None for zero
TAIL_TERMS = 4  # chosen: last terms of a series that show where it holds


class Convolution(Protocol):
    """Σ_j A_j Y_{m−j} for m = 0, 1, …, with Y given one term at a time; where A and Y_0 are real, all of Y is."""

    def push(self, term: Matrix) -> None:
        """The next term of Y, (n, k)."""
        ...

    def value(self) -> Matrix:
        """Σ_j A_j Y_{m−j}, (r, k), with m the last term given."""
        ...


class CompiledRecurrence(Protocol):
    """The Taylor series of y′ = f(y) by compiled loops."""

    def expand(self, state: Sequence[Any], log_unit: int, terms: int) -> list[list[Any]] | None:
        """The coefficients in z of each y from its value at z = 0. Those of t = z/2^log_unit are as accurate, absolutely, as the largest.

        None where they are not found that way.
        """
        ...

    def expand_singular(self, state: Sequence[Any], shifts: Sequence[int], log_unit: int, terms: int) -> list[list[Any]] | None:
        """The same for z dy/dz + shift y = f(z, y), where the first unknown is z itself and has no slope, and f is without y at order m."""
        ...


class Arithmetic(Protocol):
    """Numbers, real ones and complex ones, that know +, −, ·, /, ** and the literals of Python; and series of real numbers.

    A series is a payload that only these methods look into.
    """

    name: str

    def working(self, digits: int) -> AbstractContextManager[None]:
        """A context in which everything is computed with so many decimal digits."""
        ...

    def number(self, x: Any) -> Any:
        """A real number from int, Fraction, float (its exact binary value), or a real mpmath number."""
        ...

    def complex(self, x: Any) -> Any:
        """A complex number, from anything."""
        ...

    def parts(self, x: Any) -> tuple[Any, Any]:
        """(Re x, Im x), with None for a part that is exactly zero."""
        ...

    def rounded(self, x: Any) -> Any:
        """x without any record of its own error."""
        ...

    def log2(self, x: Any) -> float:
        """log2 |x|, −∞ for zero; never overflows."""
        ...

    def to_mpmath(self, x: Any) -> Any:
        """An mpf, or an mpc if x is complex, with every digit of x."""
        ...

    @property
    def pi(self) -> Any:
        """π."""
        ...

    def dot(self, a: Sequence[Any], b: Sequence[Any]) -> Any:
        """Σ a_j b_j of real numbers; 0 of none."""
        ...

    def recurrence(self, system: Any, unknowns: Sequence[Any], slopes: Sequence[Any]) -> CompiledRecurrence | None:
        """Compiled loops for the unknowns y of a RelaxedSystem and their slopes f(y); None if there are none."""
        ...

    def series(self, coefficients: Sequence[Any]) -> Any:
        """The series with these real coefficients."""
        ...

    def coefficients(self, series: Any, terms: int) -> list[Any]:
        """The first coefficients of a series, as many as are asked for."""
        ...

    def plus(self, a: Any, b: Any) -> Any: ...

    def plus_number(self, a: Any, x: Any) -> Any: ...

    def negative(self, a: Any) -> Any: ...

    def scaled(self, a: Any, x: Any) -> Any: ...

    def times(self, a: Any, b: Any) -> Any: ...

    def over(self, a: Any, b: Any) -> Any: ...

    def power(self, a: Any, exponent: Any) -> Any: ...

    def convolution(self, A: Payloads) -> Convolution:
        """The products of a matrix (r, n) of series with the terms of another, one after the other."""
        ...

    def carried(self, A: Payloads, left: Matrix, Y: Matrix, terms: int) -> tuple[Callable[[float], Matrix], Sequence[Matrix]]:
        """t ↦ Σ Y_m t^m, 0 < t ≤ 1, and the last TAIL_TERMS of the terms, of Y_m = left (Σ_j E_j Y_{m−1−j}/m − Σ_j F_j Y_{m−1−j}).

        Y_0 = Y (n, k), and A is E (n, n) above F. All numbers are as accurate, absolutely, as the largest.
        """
        ...

    def expanded(self, A: Payloads, left: Matrix, Y: Matrix, terms: int) -> list[Matrix]:
        """All these Y_m (n, k), with the same left."""
        ...

    def multiplier(self, A: Matrix) -> Callable[[Matrix], Matrix]:
        """B (m, l) ↦ A B, rounded, for A (n, m)."""
        ...

    def inverse(self, A: Matrix) -> Matrix:
        """A⁻¹ of A (n, n). Raises ZeroDivisionError where A is singular as far as the precision can tell."""
        ...


def exact(x: float) -> Fraction:
    """The number that was meant: the shortest decimal that a float stands for, 0.8 = 8/10."""
    return Fraction(repr(float(x)))


def simplified(arithmetic: Arithmetic, x: Any) -> Any:
    """x as a real number if its imaginary part is exactly zero."""
    if isinstance(x, int | float | complex):
        x = arithmetic.complex(x)
    re, im = arithmetic.parts(x)
    return (arithmetic.number(0) if re is None else arithmetic.rounded(re)) if im is None else arithmetic.rounded(x)
