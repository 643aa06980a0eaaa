"""Equations in balls, and with one parameter left open: the reduction is made once, for every value of it."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from contextlib import suppress
from fractions import Fraction
from itertools import pairwise
from typing import TYPE_CHECKING, Any

from shootstab.core.errors import InputError
from shootstab.formulation.asymptotic_end import asymptotic_end
from shootstab.formulation.atoms import Atom
from shootstab.formulation.axis import FARTHEST_START
from shootstab.formulation.conditions import Axis, Conditions, CoupledEnd, Periodic
from shootstab.formulation.coupled_ends import over_both_ends
from shootstab.formulation.exponentials import exponential_end
from shootstab.formulation.expression import number
from shootstab.formulation.first_order import first_order
from shootstab.formulation.gaussian import Gaussian
from shootstab.formulation.joint_conditions import parts_over_states
from shootstab.formulation.reduced_layers import ReducedLayer
from shootstab.formulation.regular_singular import regular_singular_end
from shootstab.formulation.singular_ends import SERIES_LENGTHS
from shootstab.formulation.state_pencil import StatePencil, in_states, state_pencil
from shootstab.formulation.statement import Statement
from shootstab.formulation.system import EquationRow
from shootstab.problems.ends import INFINITIES, Infinity

if TYPE_CHECKING:
    from shootstab.formulation.enclosed import EquationEnclosable
    from shootstab.formulation.enclosed_layers import EnclosedJoint
    from shootstab.multiprecision.enclosable import Enclosable


def places(statement: Statement) -> tuple[Fraction, Fraction]:
    """The two finite ends."""
    left, right = (Fraction(Gaussian.of(end.at).re) for end in (statement.left, statement.right))  # type: ignore[union-attr]
    return left, right


def enclosed(
    statement: Statement,
    layers: Sequence[ReducedLayer],
    system: StatePencil,
    ends: Callable[[complex], Any],
    reference: complex,
    coupled: Sequence[EquationRow] = (),
) -> Enclosable | None:
    """The problem in balls; system is that of the first layer with all conditions, ends(σ) are those at infinity, reference is an
    eigenvalue without any property, coupled are all conditions of coupled ends. None where it has no enclosure.
    """
    if statement.doubles_only or statement.denominators:
        return None
    if statement.base is not None:
        return _with_flow(statement, system, ends, reference)
    from shootstab.formulation.enclosed import EquationEnclosable
    from shootstab.formulation.enclosed_axis import EnclosedAxis, is_enclosed
    from shootstab.formulation.enclosed_layers import CoupledWay, EnclosedJoint, EnclosedWay, first_that_holds

    if isinstance(statement.left, Periodic | CoupledEnd):
        rows = over_both_ends(coupled, layers[0].first_order) if coupled else ()
        return None if statement.joints else EnclosedWay(CoupledWay(system, places(statement), rows))
    states = layers[0].first_order.states
    domain, bounded = statement.domain, bounded_states(statement, states)
    counted = {at.where: at.decaying for at in ends(reference)}
    out: list[Any] = []
    systems = [system, *(layer.states for layer in layers[1:])]
    for end, side, own in ((statement.left, -1, systems[0]), (statement.right, 1, systems[-1])):
        if isinstance(end, Conditions):
            out.append((Fraction(Gaussian.of(end.at).re),))
        elif isinstance(end, Axis):
            try:
                regular = regular_singular_end(own, Fraction(Gaussian.of(end.at).re), -side, bounded, f"z = {end.at:g}")
                if not is_enclosed(regular, bounded):
                    return None
            except InputError:
                return None
            length = min(domain.right - domain.left, SERIES_LENGTHS * regular.length)
            out.append((EnclosedAxis(regular, Fraction(Gaussian.of(end.at).re), -side, FARTHEST_START * length, reference),))
        elif isinstance(end, Infinity) and end.start is None and end.limit is None:
            out.append(_at_infinity(own, side, counted[INFINITIES[side]], reference))
            if not out[-1]:
                return None
        else:
            return None
    forms = [
        EquationEnclosable(system, left[j % len(left)], right[j % len(right)]) for left, right in (out,) for j in range(max(map(len, out)))
    ]
    joints = []
    for joint, pair in zip(statement.joints, pairwise(layers), strict=True):
        parts = parts_over_states(joint, (pair[0].first_order, pair[1].first_order))
        joints.append(EnclosedJoint(Fraction(Gaussian.of(joint.at).re), *parts, system.size))
    return first_that_holds([_form(ends_, systems, joints) for ends_ in forms])


def _with_flow(statement: Statement, system: StatePencil, ends: Callable[[complex], Any], reference: complex) -> Enclosable | None:
    """The problem on a base flow, a boundary layer from a wall on."""
    from shootstab.formulation.boundary_layer_form import boundary_layer_form
    from shootstab.formulation.boundary_layer_path import BoundaryLayerEnclosable
    from shootstab.formulation.enclosed_boundary_layer import BoundaryLayerFlow

    assert statement.base is not None
    form = None if statement.joints else boundary_layer_form(statement.base)
    if form is None or not isinstance(statement.left, Conditions) or not isinstance(statement.right, Infinity):
        return None
    left, (counted,) = Fraction(Gaussian.of(statement.left.at).re), (at.decaying for at in ends(reference))
    return BoundaryLayerEnclosable(BoundaryLayerFlow(form), system, left, counted, reference) if left >= form.wall else None


def _form(ends: EquationEnclosable, systems: Sequence[StatePencil], joints: Sequence[EnclosedJoint]) -> Enclosable:
    """One form of the problem in balls."""
    from shootstab.formulation.enclosed_layers import EnclosedWay, LayeredWay, MatchedWay
    from shootstab.multiprecision.enclosure import BetweenEnds

    if joints:
        return EnclosedWay(LayeredWay(ends, systems, joints))
    return EnclosedWay(MatchedWay(ends, systems[0])) if ends.matched else BetweenEnds(ends)


def _at_infinity(system: StatePencil, side: int, decaying: int, reference: complex) -> tuple[Any, ...]:
    """An end at infinity in the forms that it has, one to be tried after the other: none where coefficients are no series in an
    exponential, nor go as powers alone.
    """
    from shootstab.formulation.enclosed_graph import EnclosedGraph
    from shootstab.formulation.enclosed_infinity import EnclosedInfinity

    with suppress(InputError):  # coefficients that are no series in an exponential may go as powers
        found = exponential_end(system, side)
        return tuple(made(found, system.size, decaying, reference) for made in (EnclosedInfinity, EnclosedGraph))
    try:
        powers = asymptotic_end(system, side)
    except InputError:
        return ()
    return () if powers.dropped else (EnclosedGraph(powers, system.size, decaying, reference),)


def bounded_states(statement: Statement, states: Sequence[tuple[str, int]]) -> list[int]:
    """The states that are unknowns, which are power series at an axis."""
    return [i for i, (name, order) in enumerate(states) if order == 0 and name in statement.names.unknowns]


def with_polynomials(
    statement: Statement, system: StatePencil, at_infinity: Sequence[Any], states: Sequence[tuple[str, int]]
) -> dict[str, Any]:
    """See polynomial_form.py; at_infinity tells how many solutions decay, states as in `enclosed`. Raises InputError as it does."""
    from shootstab.formulation.polynomial_form import polynomial_pencil

    decaying = {at.where: at.decaying for at in at_infinity}
    return polynomial_pencil(statement, system, decaying, bounded_states(statement, states))


def varies(statement: Statement) -> bool:
    """Whether a parameter may be left open: in one layer between conditions at two finite ends."""
    return all(statement.holding) and not statement.joints


def varied(statement: Statement, name: str) -> Callable[[Any], Enclosable]:
    """p ↦ the problem with the value p, an acb, of this parameter.

    A pivot of the reduction that depends on it and vanishes somewhere in a ball p leaves no finite enclosure. Raises InputError for a name
    that is none of a parameter.
    """
    from shootstab.formulation.enclosed import EquationEnclosable
    from shootstab.multiprecision.enclosure import BetweenEnds

    left, right = (Fraction(Gaussian.of(end.at).re) for end in (statement.left, statement.right))  # type: ignore[union-attr]
    opened = statement.varied(name)
    atom = Atom("parameter", name, 0, number(statement.names.parameters[name]))
    first = first_order(opened.system, opened.domain.vanishing, opened.domain.regular)
    system = state_pencil(first, *(in_states(list(rows), first) for rows in (opened.left_rows, opened.right_rows)))
    return lambda value: BetweenEnds(EquationEnclosable(system, left, right, {atom: value}))
