"""Expressions on numbers and on power series of any precision."""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from functools import partial
from operator import mul
from typing import Any

import mpmath

from shootstab.formulation.analytic_series import SeriesFunctions
from shootstab.formulation.evaluation import Evaluator
from shootstab.formulation.gaussian import Gaussian
from shootstab.formulation.relaxed_functions import RelaxedFunctions
from shootstab.multiprecision.arithmetic import Arithmetic
from shootstab.multiprecision.relaxed_series import RelaxedSeries, RelaxedSystem
from shootstab.multiprecision.taylor import Taylor

# the derivative, of this order, of a base flow's function by name, in what the evaluator computes with
BaseFields = Callable[[Evaluator, str, int], Any]
# a function of a number by its name, and a power of one, where others than the midpoints of numbers count
NumberFunctions = tuple[Callable[[str, Any], Any], Callable[[Any, Fraction], Any]]


def on_numbers(arithmetic: Arithmetic, z: Any, fields: BaseFields | None = None) -> Evaluator:
    """Expressions at one z, in numbers of the arithmetic."""
    seed = partial(_seed, arithmetic)
    given = _FieldDerivatives(fields)
    given.at = Evaluator(partial(_number, arithmetic), seed, partial(_root, arithmetic), {"z": z, "pi": arithmetic.pi}, given)
    return given.at


def on_relaxed(system: RelaxedSystem, z: RelaxedSeries, fields: BaseFields, numbers: NumberFunctions | None = None) -> Evaluator:
    """Expressions, real ones, on a series z that is known only as far as it has been computed."""
    arithmetic = system.arithmetic
    seed, root = numbers or (partial(_seed, arithmetic), partial(_root, arithmetic))

    def exponent(e: Fraction) -> Any:
        return arithmetic.number(e)

    functions = RelaxedFunctions(system, seed, root, exponent)

    def applied(name: str, x: Any) -> Any:
        return functions.apply(name, x) if isinstance(x, RelaxedSeries) else seed(name, x)

    def power(x: Any, e: Fraction) -> Any:
        return functions.power(x, e) if isinstance(x, RelaxedSeries) else root(x, e)

    given = _FieldDerivatives(fields)
    given.at = Evaluator(partial(_number, arithmetic), applied, power, {"z": z, "pi": arithmetic.pi}, given)
    return given.at


def on_series(arithmetic: Arithmetic, z: Taylor, sigma: Any = None, fields: BaseFields | None = None) -> Evaluator:
    """Expressions on the power series z, at one eigenvalue where they hold it."""
    real, wide = (
        SeriesFunctions(dot, partial(_seed, arithmetic), partial(_root, arithmetic)) for dot in (arithmetic.dot, partial(_dot, arithmetic))
    )

    def computed(x: Taylor, do: Callable[[SeriesFunctions, list[Any]], list[Any]], branches: bool) -> Taylor:
        """The value in real numbers where x is real, and a function with branches is not at a negative one."""
        coefficients = x.coefficients(z.terms)
        is_real = x.im is None and not (branches and coefficients[0] < 0)
        return _wrapped(arithmetic, do(real, coefficients) if is_real else do(wide, [arithmetic.complex(c) for c in coefficients]))

    def applied(name: str, x: Any) -> Any:
        if not isinstance(x, Taylor):
            return _seed(arithmetic, name, x)
        return computed(x, lambda functions, a: functions.apply(name, a), name in ("log", "sqrt"))

    def power(x: Any, exponent: Fraction) -> Any:
        if not isinstance(x, Taylor):
            return _root(arithmetic, x, exponent)
        if exponent.denominator == 1:
            return 1 / x ** -int(exponent)
        return computed(x, lambda functions, a: functions.power(a, exponent), True)

    given = _FieldDerivatives(fields)
    given.at = Evaluator(partial(_number, arithmetic), applied, power, {"z": z, "pi": arithmetic.pi, "sigma": sigma}, given)
    return given.at


class _FieldDerivatives:
    """Functions that no formula defines, of the evaluator that asks for them."""

    at: Evaluator

    def __init__(self, fields: BaseFields | None) -> None:
        self._fields = fields

    def __call__(self, name: str, order: int) -> Any:
        assert self._fields is not None, f"{name} has no digits: refused where the problem offers its capabilities"
        return self._fields(self.at, name, order)


def _number(arithmetic: Arithmetic, c: Gaussian) -> Any:
    re = arithmetic.number(Fraction(c.re))
    return re + 1j * arithmetic.complex(Fraction(c.im)) if c.im else re


def _dot(arithmetic: Arithmetic, a: Any, b: Any) -> Any:
    """Σ a_j b_j of complex numbers; 0 of none."""
    return arithmetic.rounded(sum(map(mul, a, b), arithmetic.complex(0)))


def _seed(arithmetic: Arithmetic, name: str, x: Any) -> Any:
    """A function of a number, by mpmath at the working precision."""
    if name == "pi":
        return arithmetic.pi
    value = getattr(mpmath, name)(arithmetic.to_mpmath(x))
    return arithmetic.complex(value) if isinstance(value, mpmath.mpc) else arithmetic.number(value)


def _root(arithmetic: Arithmetic, x: Any, exponent: Fraction) -> Any:
    value = mpmath.power(arithmetic.to_mpmath(x), mpmath.mpf(exponent.numerator) / exponent.denominator)
    return arithmetic.complex(value) if isinstance(value, mpmath.mpc) else arithmetic.number(value)


def _wrapped(arithmetic: Arithmetic, coefficients: list[Any]) -> Taylor:
    parts = [arithmetic.parts(x) for x in coefficients]
    nothing = arithmetic.number(0)
    re, im = ([p[k] for p in parts] for k in (0, 1))
    made = [
        arithmetic.series([nothing if x is None else x for x in part]) if any(x is not None for x in part) else None for part in (re, im)
    ]
    return Taylor(arithmetic, len(coefficients), *made)
