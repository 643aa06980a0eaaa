"""Coefficients far out, without what is exponentially small there: 1 for tanh z, 0 for exp(−z²) and sech z.

Every monomial is a product of powers of atoms; its logarithm at two places far out tells whether it decays or grows faster than any power.
What neither does is kept, algebraic in the coordinate. What oscillates, as sin z, has no limit; beside what decays, as in sin(z) sech(z),
it is left out with that.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from shootstab.core.errors import InputError
from shootstab.formulation.atoms import Atom, Exponent
from shootstab.formulation.evaluation import on_arrays
from shootstab.formulation.expression import VARIABLE, Expression, function, number, of_atom
from shootstab.formulation.gaussian import ONE

FAR_PLACES = (1e6, 2e6)  # chosen: two distances far out; an argument that grows is there larger than any constant of a problem
GROWING_ARGUMENT = 1.2  # chosen: ratio of an argument at the two places from which on it counts as growing, as z^(1/4) does
CLEAR_EXPONENT = 50.0  # chosen: a logarithm at the first place beyond which an exponential is small or large
STEPS = {"tanh": 1, "erf": 1}  # derived: functions that come to ±1 where their argument goes to ±∞
EXPONENTIAL = {"exp": 1, "sinh": 1, "cosh": 1, "sech": -1}  # derived: the power of e^|a| as which each goes, e^a for exp
OSCILLATING = {"sin": -1j, "cos": -1j, "exp": 1, "sinh": 1, "cosh": 1}  # derived: a times this has the real part that each grows with
Text = Callable[[Expression], str]  # a formula in the user's names


@dataclass(frozen=True)
class FarExpression:
    """What is left of an expression, or, where it is exponentially small or large, its logarithm at the two places."""

    kept: Expression
    logarithm: tuple[float, float] | None = None


def kept_far_out(expression: Expression, direction: int, where: str, text: Text = str) -> Expression:
    """The expression without what is exponentially small towards this end. Raises InputError where it grows so, or has no limit."""
    far = _far(expression, direction, where, text)
    if far.logarithm is None:
        return far.kept
    if far.logarithm[1] > 0.0:
        raise InputError(f"{where} the coefficient {text(expression)} grows exponentially: allowed are coefficients that go as powers")
    return number(0)


def _far(expression: Expression, direction: int, where: str, text: Text) -> FarExpression:
    kept, largest = number(0), None
    for monomial, c in expression.terms.items():
        product, logarithm, turning = Expression({(): c}), (0.0, 0.0), None
        for atom, e in monomial:
            found = _power(atom, e, direction, where, text)
            if found is None:
                turning = atom
                continue
            factor, own = found
            product = product * factor
            logarithm = logarithm[0] + own[0], logarithm[1] + own[1]
        if logarithm == (0.0, 0.0) and turning is not None:
            told = "allowed are coefficients that go as powers, and exponentials that decay"
            raise InputError(f"{where} {text(of_atom(turning))} has no limit: {told}")
        if logarithm == (0.0, 0.0):
            kept = kept + product
            continue
        if abs(logarithm[0]) < CLEAR_EXPONENT or abs(logarithm[1]) <= abs(logarithm[0]):
            raise InputError(f"{where} exponentials in the coefficient {text(expression)} cancel: allowed are ones that decay, or none")
        largest = logarithm if largest is None or logarithm[1] > largest[1] else largest
    if largest is not None and (largest[1] > 0.0 or not kept):
        return FarExpression(kept, largest)
    return FarExpression(kept)


def _power(atom: Atom, e: Exponent, direction: int, where: str, text: Text) -> tuple[Expression, tuple[float, float]] | None:
    """What is left of a power of an atom, and its logarithm where that is large; None for what oscillates and stays bounded."""
    whole, shown = Expression({((atom, e),): ONE}), text(of_atom(atom))
    if atom.kind == "given":
        raise InputError(f"{where} the function {shown} has no formula: allowed are formulas")
    if atom.argument is None or VARIABLE not in atom.argument.atoms():
        return whole, (0.0, 0.0)
    inner = _far(atom.argument, direction, where, text)
    if inner.logarithm is not None and atom.kind == "base":
        return number(1), (float(e) * inner.logarithm[0], float(e) * inner.logarithm[1])
    if inner.logarithm is not None and inner.logarithm[1] > 0.0:
        raise InputError(f"{where} {shown} has an argument that grows exponentially: allowed are arguments that go as powers")
    argument = inner.kept if inner.logarithm is None else number(0)
    if atom.kind == "base":
        return argument**e, (0.0, 0.0)
    places = direction * np.array(FAR_PLACES)
    a, b = np.ravel(on_arrays(places, {})(argument) * np.ones(2)).astype(np.complex128).tolist()
    if abs(b) < GROWING_ARGUMENT * abs(a):
        return function(atom.name, argument) ** e, (0.0, 0.0)
    if atom.name == "log":
        raise InputError(f"{where} {shown} grows as a logarithm: allowed are coefficients that go as powers, and exponentials that decay")
    if atom.name == "sqrt":
        return function(atom.name, argument) ** e, (0.0, 0.0)
    if e > 0 and atom.name in OSCILLATING:
        sizes = [(OSCILLATING[atom.name] * x).real for x in (a, b)]
        if abs(sizes[1]) < GROWING_ARGUMENT * abs(sizes[0]) or sizes == [0.0, 0.0]:
            return None
        if atom.name in ("sin", "cos"):
            return number(1), (float(e) * abs(sizes[0]), float(e) * abs(sizes[1]))
    if atom.name not in (*STEPS, *EXPONENTIAL) or (abs(b.real) <= abs(b.imag) and (atom.name in STEPS or not b.real)):
        raise InputError(f"{where} {shown} has no limit: allowed are coefficients that go as powers, and exponentials that decay")
    if atom.name in STEPS:
        return number(1 if b.real > 0.0 else -1) ** int(e), (0.0, 0.0)
    sizes = [a.real, b.real] if atom.name == "exp" else [abs(a.real), abs(b.real)]
    power = float(e) * EXPONENTIAL[atom.name]
    sign = -1 if atom.name == "sinh" and b.real < 0.0 and int(e) % 2 else 1
    return number(sign), (power * sizes[0], power * sizes[1])


def in_inverse(expression: Expression, direction: int, root: int) -> Expression:
    """The expression with z = direction · t^(−root), in t, which its variable then stands for; powers of t are taken out of bases."""
    t = of_atom(VARIABLE)
    place = number(direction) * t**-root
    total = number(0)
    for monomial, c in expression.terms.items():
        product = Expression({(): c})
        for atom, e in monomial:
            if atom == VARIABLE:
                product = product * place**e
            elif atom.argument is None or VARIABLE not in atom.argument.atoms():
                product = product * Expression({((atom, e),): ONE})
            elif atom.kind == "base":
                inner = in_inverse(atom.argument, direction, root)
                lowest = min(dict(m).get(VARIABLE, 0) for m in inner.terms)
                product = product * t ** (lowest * e) * (inner * t**-lowest) ** e
            else:
                product = product * function(atom.name, in_inverse(atom.argument, direction, root)) ** e
        total = total + product
    return total
