"""Solutions of a first-order system as Taylor series in mpmath, put into the equations that it came from."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from typing import Any

import mpmath

from shootstab.core.series import Series, constant
from shootstab.formulation.analytic_series import SeriesFunctions
from shootstab.formulation.evaluation import Evaluator
from shootstab.formulation.expression import Expression
from shootstab.formulation.first_order import FirstOrder
from shootstab.formulation.system import System

TERMS = 18


def on_mpmath_series(z0: Any, sigma: Any) -> Evaluator:
    def dot(a: Sequence[Any], b: Sequence[Any]) -> Any:
        return mpmath.fdot(list(zip(a, b, strict=False)))

    def seed(name: str, x: Any) -> Any:
        return mpmath.pi + 0 if name == "pi" else getattr(mpmath, name)(x)

    def root(x: Any, e: Fraction) -> Any:
        return mpmath.power(x, mpmath.mpf(e.numerator) / e.denominator)

    functions = SeriesFunctions(dot, seed, root)

    def number(c: Any) -> Any:
        return mpmath.mpc(*(mpmath.mpf(Fraction(x).numerator) / Fraction(x).denominator for x in (c.re, c.im)))

    def apply(name: str, x: Any) -> Any:
        return Series(functions.apply(name, list(x.coefficients))) if isinstance(x, Series) else seed(name, x)

    def power(x: Any, e: Fraction) -> Any:
        return Series(functions.power(list(x.coefficients), e)) if isinstance(x, Series) else root(x, e)

    z = Series([mpmath.mpc(z0), mpmath.mpc(1), *[mpmath.mpc(0)] * (TERMS - 2)])

    def given(name: str, order: int) -> Any:
        raise AssertionError(name)

    return Evaluator(number, apply, power, {"z": z, "sigma": mpmath.mpc(sigma), "pi": mpmath.pi + 0}, given)


def series(at: Evaluator, expression: Expression) -> Series:
    value = at(expression)
    return value if isinstance(value, Series) else constant(mpmath.mpc(value), TERMS)


def solution(first: FirstOrder, z0: Any, sigma: Any, start: Sequence[Any]) -> dict[str, Series]:
    """Every unknown as a series about z0, from the states there."""
    at, n = on_mpmath_series(z0, sigma), first.order
    C, D = ({place: series(at, e) for place, e in part.items()} for part in (first.C, first.D))
    psi = [list(start)]
    leading = mpmath.matrix(n, n)
    for (i, j), e in C.items():
        leading[i, j] = e[0]
    for m in range(TERMS - 1):
        right = mpmath.matrix(n, 1)
        for (i, j), e in D.items():
            right[i] += sum(e[k] * psi[m - k][j] for k in range(m + 1))
        for (i, j), e in C.items():
            right[i] -= sum(e[k] * (m + 1 - k) * psi[m + 1 - k][j] for k in range(1, m + 1))
        psi.append(list(mpmath.lu_solve(leading, right) / (m + 1)))
    found = {(name, order): Series([p[i] for p in psi]) for i, (name, order) in enumerate(first.states)}

    def value(name: str, order: int) -> Series:
        """A jet, from the states and from the rules for what is no state."""
        if (name, order) in found:
            return found[name, order]
        if (name, 0) in found and order:
            result = value(name, order - 1).derivative()
            return Series([*result.coefficients, mpmath.mpc(0)])
        (_, top), rule = first.rules[name]
        assert top == 0 == order, "a removed unknown comes from its rule, undifferentiated"
        total: Any = constant(mpmath.mpc(0), TERMS)
        for (other, k), c in rule.items():
            if other != name:
                total = total + series(at, c) * value(other, k)
        found[name, 0] = -total / series(at, rule[name, 0])
        return found[name, 0]

    return {name: value(name, 0) for name in [*first.rules, *(s[0] for s in first.states)]}


def residual(system: System, first: FirstOrder, z0: Any, sigma: Any, start: Sequence[Any]) -> Any:
    """The largest coefficient of all equations with the solution put in, against the sum of the sizes of the terms."""
    at, unknowns = on_mpmath_series(z0, sigma), solution(first, z0, sigma, start)
    worst = mpmath.mpf(0)
    for row in system.rows:
        total: Any = 0
        size = mpmath.mpf(0)
        for (name, order), c in row.items():
            u = unknowns[name]
            for _ in range(order):
                u = u.derivative()
            term = series(at, c) * u
            kept = Series(term.coefficients[: TERMS - 8])  # the last terms are not known, by the derivatives
            total, size = total + kept, max([size, *(abs(x) for x in kept.coefficients)])
        if size:  # zero unknowns satisfy anything
            worst = max([worst, *(abs(x) / size for x in total.coefficients)])
    return worst
