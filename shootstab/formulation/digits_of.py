"""The way to many digits that a problem in equations has, by its ends and interfaces."""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from fractions import Fraction

import mpmath

from shootstab.core.errors import InputError
from shootstab.formulation.asymptotic_end import asymptotic_end
from shootstab.formulation.axis import RegularSpace
from shootstab.formulation.base_digits import FlowDigits
from shootstab.formulation.conditions import Axis, Conditions, CoupledEnd, Periodic
from shootstab.formulation.coupled_ends import over_both_ends
from shootstab.formulation.digit_beginnings import AtInfinity, AtSingularEnd, AtWall, AugmentedBeginning, Begin
from shootstab.formulation.equation_digits import EquationDigits
from shootstab.formulation.evaluation import on_mpmath
from shootstab.formulation.exponentials import exponential_end
from shootstab.formulation.expression import number
from shootstab.formulation.far_coefficients import Text
from shootstab.formulation.gaussian import Gaussian
from shootstab.formulation.joint_conditions import rows_over_states
from shootstab.formulation.joints import INTERFACE_SIDES, Joint, on_side
from shootstab.formulation.reduced_layers import ReducedLayer
from shootstab.formulation.regular_digits import RegularStart
from shootstab.formulation.shown_in_digits import Shown
from shootstab.formulation.state_pencil import Powers, StatePencil, by_powers
from shootstab.formulation.stated_unknowns import shown_in_states
from shootstab.formulation.statement import Statement
from shootstab.formulation.subdomain_digits import ArrivalConditions, DigitSubdomain, SubdomainDigits
from shootstab.formulation.system import EquationRow
from shootstab.formulation.vanishing import AGREEING, EVALUATED
from shootstab.multiprecision.integration import MultiprecisionProblem
from shootstab.problems.decaying_space import StartingSpace
from shootstab.problems.ends import Infinity
from shootstab.problems.two_point import TwoPointReduction


def digits_of(
    statement: Statement,
    system: StatePencil,
    layers: Sequence[ReducedLayer],
    reduction: TwoPointReduction,
    coupled: Sequence[EquationRow] = (),
) -> MultiprecisionProblem:
    """The problem in any precision; coupled are all conditions of coupled ends.

    Raises InputError, with the reason, where there is no such way.
    """
    try:
        if statement.doubles_only:
            raise InputError(f"{', '.join(statement.doubles_only)} are given to doubles only: allowed are formulas")
        if isinstance(statement.left, Periodic) and isinstance(statement.right, Periodic):
            shown = shown_in_states(statement.names.unknowns, layers[0].first_order)
            return _between_periodic_ends(statement, system, shown, (statement.left.at, statement.right.at))
        flow = None if statement.base is None else FlowDigits(statement.base)
        if isinstance(statement.left, CoupledEnd):
            shown = shown_in_states(statement.names.unknowns, layers[0].first_order)
            begin, target = _place(statement.left), _place(statement.right)
            arrival = ArrivalConditions(over_both_ends(coupled, layers[0].first_order), system.size, target)
            return SubdomainDigits([DigitSubdomain(system, AugmentedBeginning(begin), target, shown)], [arrival], flow)
        if statement.joints:
            return _in_layers(statement, system, layers, reduction, flow)
        places = [_place(end) for end in (statement.left, statement.right) if not isinstance(end, Infinity)]
        if all(statement.holding):
            shown = shown_in_states(statement.names.unknowns, layers[0].first_order)
            return EquationDigits(system, (places[0], places[1]), shown, flow=flow)
        if any(statement.holding) and len(places) == 2:
            space = reduction.subdomains[0].far
            shown = shown_in_states(statement.names.unknowns, layers[0].first_order)
            return EquationDigits(system, (places[0], places[1]), shown, _regular(space), backwards=statement.holding[0])
        shown = shown_in_states(statement.names.unknowns, layers[0].first_order)
        return _towards_one_place(statement, system, reduction, shown, flow)
    except InputError as error:
        raise InputError(f"more than 12 digits: {error}") from None


def _between_periodic_ends(statement: Statement, system: StatePencil, shown: Shown, ends: tuple[float, float]) -> MultiprecisionProblem:
    """(a, ψ) from the left end, a = ψ at the right one. Raises InputError for a period in doubles only, as 3.14159… of cos(2z)."""
    n, one, (begin, target) = system.size, number(1), (Fraction(Gaussian.of(at).re) for at in ends)
    if statement.base is not None:
        raise InputError("a base flow between periodic ends is known to doubles only: allowed are formulas")
    with mpmath.workdps(EVALUATED):
        first, last = (on_mpmath(mpmath.mpf(at.numerator) / at.denominator, {}) for at in (begin, target))
        for entry in (entry for part in (*system.C, *system.D) for entry in part.values()):
            a, b = mpmath.mpmathify(first(entry)), mpmath.mpmathify(last(entry))
            if abs(a - b) > mpmath.mpf(10) ** -AGREEING * max(abs(a), abs(b)):
                told = f"{statement.names.text(entry)} has the period {float(target - begin)!r} to the digits of a double only"
                raise InputError(f"{told}: allowed is one that is exact in decimals, as 1 is that of cos(2*pi*{statement.names.variable})")
    same = {(i, i): one for i in range(n)} | {(i, n + i): -one for i in range(n)}
    return SubdomainDigits([DigitSubdomain(system, AugmentedBeginning(begin), target, shown)], [ArrivalConditions((same,), n, target)])


def _towards_one_place(
    statement: Statement, system: StatePencil, reduction: TwoPointReduction, shown: Shown, flow: FlowDigits | None
) -> MultiprecisionProblem:
    """The way from an end at infinity to the conditions at the other, or from two ends, infinite or singular, to where the sides meet."""
    n, one = system.size, number(1)
    ends = {side: end for side, end in ((-1, statement.left), (1, statement.right)) if not isinstance(end, Conditions)}
    spaces = {side: subdomain.far for side, subdomain in zip(_sides(reduction), reduction.subdomains, strict=True)}
    if len(ends) == 1:
        (side,) = ends
        rows, count = (system.left, system.left_rows) if side > 0 else (system.right, system.right_rows)
        target = _place(statement.left if side > 0 else statement.right)
        begin = _at_end(ends[side], side, system, spaces[side], statement.names.text)
        return SubdomainDigits([DigitSubdomain(system, begin, target, shown)], [ArrivalConditions(rows, count, target)], flow)
    first = reduction.subdomains[0]
    meeting = Fraction(first.offset + first.scale * reduction.end)
    subdomains = [
        DigitSubdomain(system, _at_end(end, side, system, spaces[side], statement.names.text), meeting, shown) for side, end in ends.items()
    ]
    same = {(i, i): one for i in range(n)} | {(i, n + i): -one for i in range(n)}
    return SubdomainDigits(subdomains, [ArrivalConditions((same,), n, meeting)], flow)


def _in_layers(
    statement: Statement, system: StatePencil, layers: Sequence[ReducedLayer], reduction: TwoPointReduction, flow: FlowDigits | None
) -> MultiprecisionProblem:
    """A subdomain a layer, to the interface next to it. Where all arrive the conditions at interfaces hold, and those with σ in them."""
    n, places = system.size, [Fraction(Gaussian.of(joint.at).re) for joint in statement.joints]
    systems = [system, *(layer.states for layer in layers[1:])]
    subdomains, arrivals, first = [], [], 0
    own: list[tuple[int, int]] = []  # the first component of each layer where it meets the layer before and the one behind
    for j, layer in enumerate(systems):
        side = -1 if j == 0 else 1
        outer = j in (0, len(systems) - 1)
        target = places[0] if j == 0 else places[-1] if outer else places[j]
        begin: Begin = AugmentedBeginning(places[j - 1])
        if outer:
            end, rows, count = (
                (statement.left, system.left, system.left_rows) if j == 0 else (statement.right, system.right, system.right_rows)
            )
            if isinstance(end, Conditions) and any(rows[1:]):
                begin = AugmentedBeginning(_place(end))
                arrivals.append(ArrivalConditions(_shifted(rows, first), count, _place(end)))
            elif isinstance(end, Conditions):
                begin = AtWall(_place(end), rows[0], count)
            else:
                begin = _at_end(end, side, layer, reduction.subdomains[0 if j == 0 else -1].far, statement.names.text)
        subdomains.append(DigitSubdomain(layer, begin, target, shown_in_states(statement.names.unknowns, layers[j].first_order)))
        last = first + subdomains[-1].size - n
        own.append((last, last) if outer else (first, last))
        first += subdomains[-1].size
    for joint, place, (before, behind), pair in zip(
        statement.joints, places, itertools.pairwise(own), itertools.pairwise(layers), strict=True
    ):
        arrivals.append(ArrivalConditions(_joint_rows(joint, pair, before[1], behind[0]), n, place))
    return SubdomainDigits(subdomains, arrivals, flow)


def _joint_rows(joint: Joint, layers: tuple[ReducedLayer, ReducedLayer], before: int, behind: int) -> Powers:
    """The conditions over the components of all subdomains, of which the states on the two sides begin at these."""
    pair = layers[0].first_order, layers[1].first_order
    shifts = zip(INTERFACE_SIDES, pair, (before, behind), strict=True)
    places = {on_side(side, state): shift + i for side, layer, shift in shifts for i, state in enumerate(layer.states)}
    return by_powers({(r, places[at]): c for r, row in enumerate(rows_over_states(joint, pair)) for at, c in row.items()})


def _shifted(rows: Powers, by: int) -> Powers:
    return tuple({(i, j + by): entry for (i, j), entry in part.items()} for part in rows)


def _at_end(end: object, side: int, system: StatePencil, space: StartingSpace, text: Text) -> Begin:
    if isinstance(end, Infinity):
        return _at_infinity(system, side, space.columns, text)
    return AtSingularEnd(_place(end), -side, _regular(space))


def _at_infinity(system: StatePencil, side: int, columns: int, text: Text) -> AtInfinity:
    """The series that the coefficients allow: in an exponential, in inverse powers beside what is exponentially small, or both."""
    try:
        exponential, refused = exponential_end(system, side, text), None
    except InputError as error:
        exponential, refused = None, error
    try:
        powers = asymptotic_end(system, side, text)
    except InputError as error:
        if refused is not None:
            raise InputError(f"{refused}, and {error}") from error
        powers = None
    return AtInfinity(exponential, powers, columns)


def _regular(space: StartingSpace) -> RegularStart:
    assert isinstance(space, RegularSpace)
    return RegularStart(space.end, Fraction(space.x))


def _sides(reduction: TwoPointReduction) -> list[int]:
    """The side of the domain at which each subdomain begins."""
    return [1 if subdomain.scale * (reduction.start - reduction.end) > 0 else -1 for subdomain in reduction.subdomains]


def _place(end: object) -> Fraction:
    assert isinstance(end, Conditions | Axis | CoupledEnd)
    return Fraction(Gaussian.of(end.at).re)
