"""The first-order system with its conditions by powers of σ: what the engine takes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from shootstab.core.errors import InputError
from shootstab.formulation.expression import Expression
from shootstab.formulation.first_order import ExpressionEntries, FirstOrder
from shootstab.formulation.system import EquationRow, coefficients, degree

Condition = dict[int, Expression]  # the coefficients of states by their number, polynomials in σ
Powers = tuple[ExpressionEntries, ...]  # the matrices of σ⁰, σ¹, …, by their non-zero entries


@dataclass(frozen=True, eq=False)
class StatePencil:
    """C(z, σ) ψ′ = D(z, σ) ψ, as many powers of C as of D, and the rows (W0, W1, …) at the ends, by (row, state); two powers at least."""

    size: int
    C: Powers
    D: Powers
    left: Powers
    right: Powers
    left_rows: int
    right_rows: int


def state_pencil(first: FirstOrder, left: Sequence[Condition], right: Sequence[Condition]) -> StatePencil:
    """left and right are the conditions at the ends that hold any."""
    highest = max(1, first.degree)
    rows = [{(r, j): c for r, row in enumerate(end) for j, c in row.items()} for end in (left, right)]
    at_left, at_right = (_powers(entries, max(1, *map(degree, entries.values())) if entries else 1) for entries in rows)
    return StatePencil(first.order, _powers(first.C, highest), _powers(first.D, highest), at_left, at_right, len(left), len(right))


def in_states(rows: list[tuple[str, EquationRow]], first: FirstOrder) -> list[Condition]:
    """The conditions on the states. Raises InputError for one that holds already, by the equations."""
    number_of = {state: i for i, state in enumerate(first.states)}
    out = []
    for where, row in rows:
        reduced = first.in_states(row)
        if not reduced:
            raise InputError(f"{where} says nothing: the equations themselves make it true; allowed are conditions that they leave open")
        out.append({number_of[at]: c for at, c in reduced.items()})
    return out


def independent_states(system: StatePencil) -> list[list[int]]:
    """The states by their places, those together that an equation or a condition connects, directly or over others."""
    rows: dict[tuple[str, int], set[int]] = {}
    for name, powers in (("equation", (*system.C, *system.D)), ("left", system.left), ("right", system.right)):
        for part in powers:
            for i, j in part:
                rows.setdefault((name, i), set()).add(j)
    parts = [{j} for j in range(system.size)]
    for row in rows.values():
        connected = [part for part in parts if part & row]
        parts = [part for part in parts if not part & row] + [set().union(*connected)]
    return sorted(map(sorted, parts))


def by_powers(entries: ExpressionEntries) -> Powers:
    """Entries by powers of σ, up to the highest that occurs."""
    return _powers(entries, max(map(degree, entries.values()), default=0))


def _powers(entries: ExpressionEntries, highest: int) -> Powers:
    out: Powers = tuple({} for _ in range(highest + 1))
    for at, entry in entries.items():
        for power, c in coefficients(entry).items():
            out[power][at] = c
    return out
