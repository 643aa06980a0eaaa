"""Whether a Hermitian form is positive at every point of an interval, in balls: Cholesky's pivots are positive on each piece of it."""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from typing import Any

from flint import acb, arb, ctx

from shootstab.formulation.enclosed import on_balls
from shootstab.formulation.expression import Expression
from shootstab.formulation.gaussian import ONE
from shootstab.formulation.sesquilinear_form import Form
from shootstab.multiprecision.enclosable import ball


def positive_everywhere(form: Form, low: Fraction, high: Fraction, bits: int, halvings: int) -> bool:
    """Whether form > 0 in all unknowns and derivatives that it holds at every z in [low, high], and all functions in it are real there."""
    jets = sorted({jet for at in form for jet in at})
    functions = _functions(form)

    def here(a: Fraction, b: Fraction) -> bool:
        middle, radius = ball((a + b) / 2), ball((b - a) / 2)
        at = on_balls(acb(middle + radius * arb(0, 1)), {})
        if not all(_real(at(f)) for f in functions):
            return False
        return _positive([[acb(at(form[u, v])) if (u, v) in form else acb(0) for v in jets] for u in jets])

    before = ctx.prec
    ctx.prec = bits
    try:
        return _on_pieces(here, low, high, halvings)
    finally:
        ctx.prec = before


def _on_pieces(holds: Callable[[Fraction, Fraction], bool], low: Fraction, high: Fraction, halvings: int) -> bool:
    if holds(low, high):
        return True
    middle = (low + high) / 2
    if halvings == 0 or not holds(middle, middle):
        return False
    return _on_pieces(holds, low, middle, halvings - 1) and _on_pieces(holds, middle, high, halvings - 1)


def _functions(form: Form) -> list[Expression]:
    """Every factor that is more than a natural power of z: its conjugate was taken to be itself."""
    held = {
        (atom, exponent)
        for c in form.values()
        for monomial in c.terms
        for atom, exponent in monomial
        if atom.argument is not None or Fraction(exponent).denominator != 1
    }
    return [Expression({(factor,): ONE}) for factor in held]


def _real(x: Any) -> bool:
    return bool(acb(x).imag.is_zero())


def _positive(matrix: list[list[Any]]) -> bool:
    """Whether a Hermitian matrix of balls is positive definite: only its lower half is read, the diagonal by its real parts."""
    n = len(matrix)
    rows = [[acb(x) for x in row] for row in matrix]
    for k in range(n):
        pivot = rows[k][k].real
        if not pivot > 0:
            return False
        for i in range(k + 1, n):
            factor = rows[i][k] / pivot
            for j in range(k + 1, i + 1):
                rows[i][j] = rows[i][j] - factor * rows[j][k].conjugate()
    return True
