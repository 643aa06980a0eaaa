"""What holds at every point of a domain, in balls on pieces of it: functions are real, Hermitian forms positive by Cholesky's pivots."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from fractions import Fraction
from typing import Any

from shootstab.core.balls import acb, arb, ctx
from shootstab.formulation.domain import Domain
from shootstab.formulation.enclosed import on_balls
from shootstab.formulation.expression import Expression
from shootstab.formulation.gaussian import ONE
from shootstab.formulation.sesquilinear_form import Form
from shootstab.formulation.stretches import Stretch, stretches
from shootstab.multiprecision.enclosable import ball


def real_everywhere(coefficients: Sequence[Expression], domain: Domain, bits: int, halvings: int) -> bool:
    """Whether the coefficients are finite and every function in them is real at every z of the domain: conjugates are then as written.

    Raises InputError as `stretches` does.
    """
    factors = _factors(coefficients)

    def on(part: Stretch) -> bool:
        real, finite = [part.written(factor) for factor in factors], [part.written(c) for c in coefficients]

        def here(x: Any) -> bool:
            at = on_balls(x, {})
            return all(acb(at(factor)).imag.is_zero() for factor in real) and all(acb(at(c)).is_finite() for c in finite)

        return _on_pieces(here, part.low, part.high, bits, halvings)

    return all(on(part) for part in stretches(domain, coefficients))


def positive_everywhere(form: Form, domain: Domain, bits: int, halvings: int) -> bool:
    """Whether form > 0 in all unknowns and derivatives that it holds at every z of the domain. Raises InputError as `stretches` does."""
    jets = sorted({jet for at in form for jet in at})

    def on(part: Stretch) -> bool:
        written = {at: part.written(c) for at, c in form.items()}

        def here(x: Any) -> bool:
            at = on_balls(x, {})
            return _positive([[acb(at(written[u, v])) if (u, v) in written else acb(0) for v in jets] for u in jets])

        return _on_pieces(here, part.low, part.high, bits, halvings)

    return all(on(part) for part in stretches(domain, list(form.values())))


def _on_pieces(holds: Callable[[Any], bool], low: Fraction, high: Fraction, bits: int, halvings: int) -> bool:
    """Whether what holds(z) says of balls z is so on pieces that cover the interval, halved where it is not; False where a middle fails."""

    def over(low: Fraction, high: Fraction, halvings: int) -> bool:
        middle = (low + high) / 2
        if holds(acb(ball(middle) + ball((high - low) / 2) * arb(0, 1))):
            return True
        if halvings == 0 or not holds(acb(ball(middle))):
            return False
        return over(low, middle, halvings - 1) and over(middle, high, halvings - 1)

    before = ctx.prec
    ctx.prec = bits
    try:
        return over(low, high, halvings)
    finally:
        ctx.prec = before


def _factors(coefficients: Sequence[Expression]) -> list[Expression]:
    """Every factor that is more than a natural power of z: its conjugate is taken to be itself."""
    held = {
        (atom, exponent)
        for c in coefficients
        for monomial in c.terms
        for atom, exponent in monomial
        if atom.argument is not None or Fraction(exponent).denominator != 1
    }
    return [Expression({(factor,): ONE}) for factor in held]


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
