"""Which way to many digits a problem in equations has, by its ends."""

from __future__ import annotations

from fractions import Fraction

from shootstab.core.errors import InputError
from shootstab.formulation.axis import RegularSpace
from shootstab.formulation.conditions import Axis, Conditions, Periodic
from shootstab.formulation.digits import EquationDigits, Shown
from shootstab.formulation.exponentials import exponential_end
from shootstab.formulation.first_order import FirstOrder
from shootstab.formulation.gaussian import Gaussian
from shootstab.formulation.line_digits import InfiniteSide, LineDigits
from shootstab.formulation.regular_digits import RegularStart
from shootstab.formulation.state_pencil import StatePencil
from shootstab.formulation.stated_unknowns import shown_in_states
from shootstab.formulation.statement import Statement
from shootstab.multiprecision.integration import MultiprecisionProblem
from shootstab.problems.ends import INFINITIES, Infinity
from shootstab.problems.two_point import TwoPointReduction


def digits_of(statement: Statement, first: FirstOrder, system: StatePencil, reduction: TwoPointReduction) -> MultiprecisionProblem:
    """The problem in any precision. Raises InputError, with the reason, where there is no such way."""
    try:
        if statement.domain.given:
            raise InputError(f"{', '.join(statement.domain.given)} are given to doubles only: allowed are formulas")
        if statement.joints:
            raise InputError("that is not offered in layers: allowed is a problem without interfaces")
        if all(statement.finite):
            return _between_finite_ends(statement, shown_in_states(statement.names.unknowns, first), system, reduction)
        return _on_a_line(statement, system, reduction)
    except InputError as error:
        raise InputError(f"more than 12 digits: {error}") from None


def _between_finite_ends(statement: Statement, shown: Shown, system: StatePencil, reduction: TwoPointReduction) -> MultiprecisionProblem:
    places = _place(statement.left), _place(statement.right)
    if all(statement.holding):
        return EquationDigits(system, places, shown)
    if not any(statement.holding):
        raise InputError("both ends are regular singular or periodic: allowed is one with conditions")
    space = reduction.subdomains[0].far
    if not (isinstance(space, RegularSpace) and space.end.integer):
        raise InputError("the exponents at the regular singular end are no integers")
    return EquationDigits(system, places, shown, RegularStart(space.end, Fraction(space.x)), backwards=statement.holding[0])


def _on_a_line(statement: Statement, system: StatePencil, reduction: TwoPointReduction) -> MultiprecisionProblem:
    """With one end at infinity the other holds conditions; with two the sides meet where those of the reduction do."""
    ends = {side: end for side, end in ((-1, statement.left), (1, statement.right)) if isinstance(end, Infinity)}
    for side, end in ends.items():
        if end.start is not None:
            raise InputError(f"at {INFINITIES[side]} the decaying space is that of coefficients frozen at a start: allowed is a limit")
    if len(ends) == 1:
        (side,) = ends
        rows, place = (system.left, system.left_rows), _place(statement.left if side > 0 else statement.right)
        if side < 0:
            rows = system.right, system.right_rows
        return LineDigits(system, [InfiniteSide(exponential_end(system, side), system.size - rows[1])], place, rows)
    first = reduction.subdomains[0]
    meeting = Fraction(first.offset + first.scale * reduction.end)
    sides = []
    for subdomain in reduction.subdomains:
        side = 1 if subdomain.scale * (reduction.start - reduction.end) > 0 else -1
        sides.append(InfiniteSide(exponential_end(system, side), subdomain.far.columns))
    return LineDigits(system, sides, meeting, ((), 0))


def _place(end: object) -> Fraction:
    assert isinstance(end, Conditions | Axis | Periodic)
    return Fraction(Gaussian.of(end.at).re)
