"""SymPy expressions as formulas: symbols and functions of the coordinate by their names, derivatives along it, the same functions."""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from typing import Any

from shootstab.core.errors import InputError
from shootstab.formulation.expression import FUNCTIONS, PI, Expression, function, held_kinds, number
from shootstab.formulation.gaussian import I
from shootstab.formulation.grammar import MOST_POWER


def converted(formula: Any, where: str, meaning: Callable[[str], Expression], listed: Callable[[], str], variable: str) -> Expression:
    """The expression that a SymPy one means; Eq(a, b) stands for a − b. Raises InputError for what has no meaning here."""
    import sympy

    def error(x: Any, why: str) -> InputError:
        return InputError(f"{where}, at {x}: {why}")

    def named(x: Any) -> Expression:
        name = x.name if isinstance(x, sympy.Symbol) else x.func.__name__
        try:
            return meaning(name)
        except KeyError:
            raise error(x, f"unknown name {name!r}: allowed are {listed()}") from None

    def walk(x: Any) -> Expression:
        if isinstance(x, sympy.Equality):
            return walk(x.lhs) - walk(x.rhs)
        if isinstance(x, sympy.Symbol):
            return named(x)
        if isinstance(x, sympy.Rational):
            return number(Fraction(int(x.p), int(x.q)))
        if isinstance(x, sympy.Float):
            return number(Fraction(str(x)))
        if x is sympy.I:
            return number(I)
        if x is sympy.pi:
            return PI
        if x is sympy.E:
            return function("exp", number(1))
        if isinstance(x, sympy.Add | sympy.Mul):
            parts = [walk(a) for a in x.args]
            total = parts[0]
            for part in parts[1:]:
                total = total + part if isinstance(x, sympy.Add) else total * part
            return total
        if isinstance(x, sympy.Pow):
            return power(x)
        if isinstance(x, sympy.Derivative):
            return derivative(x)
        if isinstance(x, sympy.core.function.AppliedUndef):
            if [str(a) for a in x.args] != [variable]:
                raise error(x, f"allowed are functions of {variable} alone")
            return named(x)
        name = x.func.__name__
        if name in FUNCTIONS and len(x.args) == 1:
            argument = walk(x.args[0])
            if any(atom.kind in ("jet", "eigenvalue") for atom in argument.atoms()):
                raise error(x, "a function of an unknown or of the eigenvalue: the problem is not linear, or not rational in it")
            return function(name, argument)
        raise error(x, f"{name} has no meaning here: allowed are +, *, **, derivatives, {', '.join(FUNCTIONS)}")

    def power(x: Any) -> Expression:
        base, exponent = walk(x.base), walk(x.exp)
        value = exponent.constant
        held = held_kinds(base, exponent)
        whole = value is not None and not value.im and value.re in range(-MOST_POWER, MOST_POWER + 1)
        if ("jet" in held and not (whole and value is not None and value.re >= 0)) or ("eigenvalue" in held and not whole):
            raise error(x, f"a power of an unknown or of the eigenvalue: allowed are whole ones up to {MOST_POWER}, natural of an unknown")
        if value is not None and not value.im:
            return base ** (int(value.re) if Fraction(value.re).denominator == 1 else value.re)
        return function("exp", exponent * function("log", base))

    def derivative(x: Any) -> Expression:
        total = walk(x.expr)
        for along, times in x.variable_count:
            if str(along) != variable:
                raise error(x, f"allowed are derivatives along {variable}")
            for _ in range(int(times)):
                total = total.derivative()
        return total

    return walk(formula)
