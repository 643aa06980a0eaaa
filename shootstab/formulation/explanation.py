"""What the reduction found, in words: order, states, what was done to the equations, the continuous spectrum, the conditions."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterable, Mapping, Sequence
from fractions import Fraction
from functools import partial
from typing import Any

from shootstab.formulation.base_flow import highest_derivatives
from shootstab.formulation.base_solution import found_values, limit_of
from shootstab.formulation.conditions import Axis, Conditions, CoupledEnd, Periodic
from shootstab.formulation.constraints import constraints
from shootstab.formulation.continuous_spectrum import InteriorSpectrum
from shootstab.formulation.coupled_ends import row_texts
from shootstab.formulation.dispersion import FlowLimit, dispersion_relation, free_name, zero_in_sigma
from shootstab.formulation.expression import VARIABLE, Expression, number
from shootstab.formulation.joint_conditions import rows_over_states
from shootstab.formulation.mirror import mirror_signs
from shootstab.formulation.names import Names
from shootstab.formulation.reduced_layers import ReducedLayer
from shootstab.formulation.state_pencil import Condition, StatePencil, independent_states
from shootstab.formulation.statement import Statement
from shootstab.formulation.system import EquationRow, coefficients, degree, shown
from shootstab.problems.ends import INFINITIES

Lines = list[tuple[str, str]]


def explanation(
    statement: Statement,
    layers: Sequence[ReducedLayer],
    conditions: tuple[list[Condition], list[Condition]],
    system: StatePencil,
    coupled: Sequence[EquationRow] = (),
) -> Lines:
    """Pairs of a heading and what belongs to it; formulas in the user's names, parameters by their values. coupled are all conditions of
    coupled ends.
    """
    names, first = statement.names, layers[0].first_order

    text, row_text = names.text, names.row_text

    def condition_text(condition: Condition) -> str:
        return row_text({first.states[j]: c for j, c in condition.items()}) + " = 0"

    lines: Lines = [
        ("unknowns", ", ".join(names.unknowns)),
        ("order", f"{first.order}: as many conditions, or solutions that decay, are needed in all"),
        ("states", ", ".join(map(shown, first.states))),
    ]
    apart = [] if statement.joints or coupled else independent_states(system)
    if len(apart) > 1:
        told = "; ".join(", ".join(shown(first.states[j]) for j in part) for part in apart)
        lines.append(("subsystems", f"{len(apart)}, which no equation or condition connects: {told}"))
    mirror = mirror_signs(statement)
    if mirror is not None:
        lines.append(("symmetry", _symmetry(*mirror, names)))
    if statement.base is not None:
        lines += [("base flow", f"{shown(top)} = {text(slope)}") for top, slope in highest_derivatives(statement.base)]
        lines += [("base flow", told) for told in found_values(statement.base, names.variable)]
    for flux, row in first.fluxes.items():
        lines.append(("flux", f"{flux} = {row_text(row)}, a state in place of a division"))
    for at, others, factor in constraints(statement.system, first):
        over = "" if factor == number(1) else f" / ({text(factor)})"
        lines.append(("constraint", f"{shown(at)} = [{row_text(others) or '0'}]{over}, by the equations and their derivatives"))
    states = {name for name, _ in first.states}
    for name, ((_, top), row) in first.rules.items():
        if name not in states and top == 0:
            others = {at: -c for at, c in row.items() if at != (name, 0)}
            lines.append(("removed", f"{name} = ({row_text(others) or '0'}) / ({text(row[name, 0])})"))
    for denominator in dict.fromkeys(d for _, d in statement.denominators):
        holders = ", ".join(dict.fromkeys(where for where, d in statement.denominators if d == denominator))
        lines.append(("denominator", f"{holders} times {text(denominator)}; {_pole(denominator, names, text)}"))
    for factor, where in first.factors:
        lines.append(("multiplied", f"{where} by {text(factor)}, which may vanish"))
    highest = max(len(part) for part in (system.C, system.left, system.right)) - 1
    occurs = "to the first power" if highest == 1 else f"up to the power {highest}"
    lines.append(("eigenvalue", f"{names.eigenvalue} occurs {occurs}"))
    for j, layer in enumerate(layers, 1):
        of_layer = f" of layer {j}" if len(layers) > 1 else ""
        powers = [f"({text(c)})*{names.eigenvalue}**{k}" if k else f"({text(c)})" for k, c in layer.first_order.determinant.items()]
        lines.append((f"det C{of_layer}", " + ".join(powers)))
        curve = "none: det C does not hold the eigenvalue"
        if layer.spectrum_inside.curves:
            curve = _curves(layer.spectrum_inside, names, text)
        lines.append((f"continuous spectrum inside{of_layer}", curve))
    for joint, pair in zip(statement.joints, itertools.pairwise(layers), strict=True):
        rows_there = rows_over_states(joint, (pair[0].first_order, pair[1].first_order))
        lines += [(f"interface, {names.variable} = {joint.at:g}", row_text(row) + " = 0") for row in rows_there]
    for side, end, rows in zip(("left", "right"), (statement.left, statement.right), conditions, strict=True):
        if isinstance(end, Conditions):
            lines += [(f"{side}, {names.variable} = {end.at:g}", condition_text(row)) for row in rows]
        elif isinstance(end, Axis):
            lines.append((f"{side}, {names.variable} = {end.at:g}", "a regular singular end: solutions are regular"))
        elif isinstance(end, CoupledEnd):
            lines.append((f"{side}, {names.variable} = {end.at:g}", "coupled to the other end"))
        elif isinstance(end, Periodic):
            lines.append((f"{side}, {names.variable} = {end.at:g}", "periodic: every state is the same at both ends"))
        else:
            lines.append((f"{side}, infinity", "solutions decay"))
            layer = layers[0 if side == "left" else -1]
            direction = -1 if side == "left" else 1
            limit = None if statement.base is None else partial(limit_of, statement.base, direction)
            lines += _essential(layer.states, direction, limit, names, text)
    lines += [("ends", told) for told in row_texts(coupled, names)]
    return lines


def rates_at(ends: Iterable[Any], eigenvalue: str, sigma: complex) -> Lines:
    """What solutions do at ends at infinity at one value of the eigenvalue."""
    return [
        (
            f"at {at.where}",
            f"{at.decaying} of {len(at.rates)} solutions decay at {eigenvalue} = {sigma:.4g}, "
            f"the rates are {', '.join(f'{rate:.4g}' for rate in at.rates)}",
        )
        for at in ends
    ]


def _essential(states: StatePencil, direction: int, limit: FlowLimit | None, names: Names, text: Callable[[Expression], str]) -> Lines:
    """The essential spectrum of an end at infinity, where it is known as a formula."""
    wavenumber = free_name([*names.unknowns, names.variable, names.eigenvalue])
    relation = dispersion_relation(states, direction, wavenumber, limit)
    if relation is None:
        return []
    if not degree(relation):
        return [(f"essential spectrum, {INFINITIES[direction]}", f"none: {text(relation)} does not hold the eigenvalue")]
    alone = zero_in_sigma(relation)
    what = f"{names.eigenvalue} = {text(alone)}" if alone is not None else f"the zeros in {names.eigenvalue} of {text(relation)}"
    varies = any(atom.name == wavenumber for atom in (relation if alone is None else alone).atoms())
    return [(f"essential spectrum, {INFINITIES[direction]}", f"{what}, {wavenumber} real" if varies else what)]


def _symmetry(middle: Fraction, signs: Mapping[str, int], names: Names) -> str:
    """What a mirror at z = middle says of modes."""
    even, odd = (", ".join(name for name, sign in signs.items() if sign == wanted) for wanted in (1, -1))
    kinds = f"{even} even and {odd} odd" if odd else f"{even} even"
    return f"about {names.variable} = {float(middle):g}: a basis of modes has {kinds}, or the reverse"


def _curves(inside: InteriorSpectrum, names: Names, text: Callable[[Expression], str]) -> str:
    """The curves on which C is singular, in words."""
    alone = inside.expression
    known = [alone] if alone is not None else list(dict.fromkeys(inside.factors))
    told = [f"{names.eigenvalue} = {text(curve)}" for curve in known]
    others = 0 if alone is not None else max(inside.rest, default=0)
    if others:
        what = f"{others} {'more curves' if known else 'curves'}" if others > 1 else "one more curve"
        told.append(f"{what}, zeros of det C in {names.eigenvalue}")
    return f"{' and '.join(told)}, {names.variable} along the domain"


def _pole(denominator: Expression, names: Names, text: Callable[[Expression], str]) -> str:
    """Where a denominator vanishes, and what that is."""
    powers = coefficients(denominator)
    along = f", {names.variable} along the domain," if VARIABLE in denominator.atoms() else ""
    place = f"its zeros in {names.eigenvalue}"
    if set(powers) <= {0, 1}:
        place = f"{names.eigenvalue} = {text(-powers.get(0, number(0)) / powers[1])}"
    return f"at {place}{along} what is written has no meaning, and a zero of D is no eigenvalue"
