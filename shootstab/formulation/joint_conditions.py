"""Conditions at an interface as matrices over the states on both sides.

Each amplitude is found from one of the conditions and removed from the others,

    (row) ← p (row) − x (pivot row),   p and x coprime polynomials in σ,

so that n conditions are left over the n + n states. By Schur's complement the determinant of all conditions is that of those that are left
times the pivot over the product of the p. What is lacking of it multiplies one row, and where more than it would be there the conditions
are refused: D has the zeros that are modes, and no others.
"""

from __future__ import annotations

import itertools
from collections.abc import Sequence

import numpy as np

from shootstab.core.errors import InputError
from shootstab.formulation.dependent_conditions import require_independent_rows
from shootstab.formulation.evaluation import Given, on_arrays
from shootstab.formulation.expression import VARIABLE, Expression, number, quotient
from shootstab.formulation.first_order import FirstOrder, reduced_to
from shootstab.formulation.joints import INTERFACE_SIDES, Joint, on_side
from shootstab.formulation.linear_algebra import coprime, minus
from shootstab.formulation.substitution import substituted
from shootstab.formulation.system import EquationRow, Jet, coefficients, degree
from shootstab.formulation.vanishing import Vanishing
from shootstab.problems.ends import Interface


def rows_over_states(joint: Joint, layers: tuple[FirstOrder, FirstOrder]) -> list[EquationRow]:
    """The rows over the states of both sides. Raises InputError where they are too many, too few, or say nothing."""
    states = {on_side(side, state) for side, layer in zip(INTERFACE_SIDES, layers, strict=True) for state in layer.states}
    states |= {(name, 0) for name in joint.amplitudes}
    sided = {
        on_side(side, (name, 0))[0]: (side, name, layer)
        for side, layer in zip(INTERFACE_SIDES, layers, strict=True)
        for name in layer.rules
    }

    def rule_for(at: Jet) -> EquationRow:
        side, name, layer = sided[at[0]]
        return {on_side(side, key): c for key, c in layer.rule((name, at[1])).items()}

    vanishing = Vanishing(joint.at, joint.at, layers[0].vanishing.given)
    reduced = [(where, reduced_to(row, states, rule_for, layers[0].vanishing)) for where, row in joint.rows]
    rows = [{at: _here(joint, where, c) for at, c in row.items()} for where, row in reduced]
    rows = [{at: c for at, c in row.items() if not vanishing(c)} for row in rows]
    for (where, _), row in zip(joint.rows, rows, strict=True):
        if not row:
            raise InputError(f"{where} says nothing: the equations themselves make it true; allowed are conditions that they leave open")
    written = rows
    for name in joint.amplitudes:
        rows = _without(joint, name, rows, vanishing)
    n = layers[0].order
    if len(rows) != n:
        told = f"{len(joint.rows)} conditions and {len(joint.amplitudes)} amplitudes at the interface {joint.at:g}"
        raise InputError(f"{told}: allowed are {n} conditions, the order of the equations, and one for each amplitude")
    require_independent_rows(joint.rows, written, f"{joint.names.variable} = {joint.at:g}", joint.names, vanishing)
    return rows


def _here(joint: Joint, where: str, coefficient: Expression) -> Expression:
    try:
        return substituted(coefficient, VARIABLE, number(joint.at))
    except ZeroDivisionError:
        raise InputError(f"{where}: {joint.names.text(coefficient)} is not finite there: allowed are finite coefficients") from None


def _without(joint: Joint, name: str, rows: list[EquationRow], vanishing: Vanishing) -> list[EquationRow]:
    """The conditions without an amplitude and the condition that finds it."""
    at = (name, 0)
    holders = [i for i, row in enumerate(rows) if at in row]
    if not holders:
        raise InputError(
            f"no condition at the interface {joint.at:g} holds the amplitude {name}: allowed are amplitudes that they determine"
        )
    pivot = min(holders, key=lambda i: (degree(rows[i][at]), len(rows[i][at].terms), len(rows[i])))
    out, factors = [], number(1)
    for i, row in enumerate(rows):
        if i == pivot:
            continue
        if at in row:
            p, x = coprime(rows[pivot][at], row[at])
            factors = factors * p if degree(p) else factors
            row = minus(row, rows[pivot], p, x, vanishing)
            row.pop(at, None)
        out.append(row)
    lacking = rows[pivot][at] if not degree(factors) else quotient(rows[pivot][at], factors)
    if lacking is None:
        raise InputError(
            f"at the interface {joint.at:g} {len(holders)} conditions multiply the amplitude {name} by the eigenvalue, not all in the same "
            "way: allowed are two such ones, or one in which a number multiplies it"
        )
    if degree(lacking) and out:
        out[0] = {key: lacking * c for key, c in out[0].items()}
    return out


def parts_over_states(
    joint: Joint, layers: tuple[FirstOrder, FirstOrder]
) -> tuple[dict[tuple[int, int], Expression], dict[tuple[int, int], Expression]]:
    """The conditions by (row, state), of the states before it and of those behind it."""
    rows = rows_over_states(joint, layers)
    before, behind = (
        {(i, j): row[at] for i, row in enumerate(rows) for j, state in enumerate(layer.states) if (at := on_side(side, state)) in row}
        for side, layer in zip(INTERFACE_SIDES, layers, strict=True)
    )
    return before, behind


def interface_of(joint: Joint, layers: tuple[FirstOrder, FirstOrder], given: Given) -> Interface:
    """The conditions as matrices over the states."""
    rows, n = rows_over_states(joint, layers), layers[0].order
    places = {
        on_side(side, state): k * n + j
        for k, (side, layer) in enumerate(zip(INTERFACE_SIDES, layers, strict=True))
        for j, state in enumerate(layer.states)
    }
    highest = max(1, *(degree(c) for row in rows for c in row.values()))
    M = np.zeros((highest + 1, n, 2 * n), dtype=np.complex128)
    at = on_arrays(np.array([float(joint.at)]), given)
    for i, row in enumerate(rows):
        for key, c in row.items():
            for power, part in coefficients(c).items():
                M[power, i, places[key]] = complex(np.ravel(at(part))[0])
    return Interface(float(joint.at), M[0, :, :n], M[0, :, n:], M[1:, :, :n], M[1:, :, n:])


def between(joints: Sequence[Joint], layers: Sequence[FirstOrder], given: Given) -> tuple[Interface, ...]:
    """All interfaces, from left to right, between as many layers and one more."""
    return tuple(interface_of(joint, pair, given) for joint, pair in zip(joints, itertools.pairwise(layers), strict=True))
