"""Rational functions of the coordinate and the eigenvalue with Gaussian rational coefficients: (re + i im)/den, exact."""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction
from typing import Any

from shootstab.core.balls import Ordering, fmpq, fmpq_mpoly_ctx
from shootstab.core.errors import InputError
from shootstab.formulation.evaluation import Evaluator
from shootstab.formulation.expression import Expression
from shootstab.formulation.gaussian import Gaussian

CERTIFIED_RING = fmpq_mpoly_ctx.get(["x", "s"], Ordering.lex)
X, CERTIFIED_SIGMA = CERTIFIED_RING.gens()
IRRATIONAL = "a coefficient is no rational function with rational numbers"

GaussianPolynomial = dict[tuple[int, int], tuple[Fraction, Fraction]]  # coefficients of x^i s^j


class RationalFunction:
    """A function in lowest terms over the rationals."""

    def __init__(self, re: Any, im: Any, den: Any) -> None:
        common = re.gcd(im).gcd(den) if im else re.gcd(den)
        if common.total_degree() > 0:
            re, im, den = re // common, im // common, den // common
        self.re, self.im, self.den = re, im, den

    def __bool__(self) -> bool:
        return bool(self.re) or bool(self.im)

    def __neg__(self) -> RationalFunction:
        return RationalFunction(-self.re, -self.im, self.den)

    def __add__(self, other: RationalFunction) -> RationalFunction:
        return RationalFunction(self.re * other.den + other.re * self.den, self.im * other.den + other.im * self.den, self.den * other.den)

    def __sub__(self, other: RationalFunction) -> RationalFunction:
        return self + (-other)

    def __mul__(self, other: RationalFunction) -> RationalFunction:
        re, im = self.re * other.re - self.im * other.im, self.re * other.im + self.im * other.re
        return RationalFunction(re, im, self.den * other.den)

    def inverse(self) -> RationalFunction:
        """1/f. Raises InputError for 0."""
        if not self:
            raise InputError("the highest derivatives are dependent")
        return RationalFunction(self.re * self.den, -self.im * self.den, self.re * self.re + self.im * self.im)

    def times(self, polynomial: Any) -> GaussianPolynomial:
        """The polynomial f·p, p a multiple of the denominator."""
        factor = polynomial // self.den
        parts = [(part * factor).to_dict() for part in (self.re, self.im)]
        return {at: (_fraction(parts[0].get(at, 0)), _fraction(parts[1].get(at, 0))) for at in {*parts[0], *parts[1]}}


def constant(x: int | Fraction | Gaussian) -> RationalFunction:
    """A number."""
    c = x if isinstance(x, Gaussian) else Gaussian(x)
    re, im = (CERTIFIED_RING.constant(fmpq(y.numerator, y.denominator)) for y in (Fraction(c.re), Fraction(c.im)))
    return RationalFunction(re, im, CERTIFIED_RING.constant(1))


def polynomial(p: Any) -> RationalFunction:
    """A polynomial of the ring."""
    return RationalFunction(p, CERTIFIED_RING.constant(0), CERTIFIED_RING.constant(1))


def power(f: RationalFunction, exponent: int) -> RationalFunction:
    """f^exponent, a whole number."""
    base, out = f if exponent >= 0 else f.inverse(), constant(1)
    for _ in range(abs(exponent)):
        out = out * base
    return out


def in_coordinate(x: RationalFunction) -> Evaluator:
    """Expressions whose variable is this function; it raises InputError where one is not rational."""

    def refused(*_: Any) -> Any:
        raise InputError(IRRATIONAL)

    def raised(f: Any, exponent: Fraction) -> RationalFunction:
        return power(f, int(exponent)) if exponent.denominator == 1 else refused()

    return Evaluator(constant, refused, raised, _Coordinate(z=x), refused, power)


class _Coordinate(dict[str, RationalFunction]):
    """The coordinate alone: other names have no rational value."""

    def __missing__(self, name: str) -> RationalFunction:
        raise InputError(IRRATIONAL)


def evaluated(at: Evaluator, entry: Expression) -> RationalFunction:
    """The expression, 0 included."""
    found = at(entry)
    return found if isinstance(found, RationalFunction) else constant(found)


def solved(C: Mapping[tuple[int, int], RationalFunction], D: Mapping[tuple[int, int], RationalFunction], n: int) -> list[list[Any]]:
    """C⁻¹ D (n, n). Raises InputError where C is singular."""
    zero = constant(0)
    rows = [[*(C.get((i, j), zero) for j in range(n)), *(D.get((i, j), zero) for j in range(n))] for i in range(n)]
    for k in range(n):
        options = [i for i in range(k, n) if rows[i][k]]
        if not options:
            raise InputError("the highest derivatives are dependent")
        top = min(options, key=lambda i: len(rows[i][k].re.to_dict()) + len(rows[i][k].im.to_dict()))
        rows[k], rows[top] = rows[top], rows[k]
        inverse = rows[k][k].inverse()
        rows[k] = [x * inverse if x else x for x in rows[k]]
        for i in range(n):
            if i != k and rows[i][k]:
                factor = rows[i][k]
                rows[i] = [x - factor * y if y else x for x, y in zip(rows[i], rows[k], strict=True)]
    return [row[n:] for row in rows]


def common_denominator(entries: list[RationalFunction]) -> Any:
    """The least common multiple."""
    out = CERTIFIED_RING.constant(1)
    for f in entries:
        out = out * (f.den // out.gcd(f.den))
    return out


def _fraction(x: Any) -> Fraction:
    return Fraction(int(x.p), int(x.q)) if x else Fraction(0)
