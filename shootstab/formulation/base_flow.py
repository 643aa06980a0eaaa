"""A base flow that solves ordinary differential equations of its own: y′ = F(y, z) with conditions at a place, and at the ends.

Its unknowns are functions in the equations of the perturbation, with all their derivatives: those below the highest are the state y, the
others follow from F. Equations may be nonlinear, but for the highest derivative of each unknown, in which they are linear.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from fractions import Fraction

from shootstab.core.errors import InputError
from shootstab.formulation.atoms import Atom
from shootstab.formulation.expression import Expression, number, of_atom
from shootstab.formulation.system import Jet


@dataclass(frozen=True)
class BaseEnd:
    """Where a base flow has conditions, expressions that vanish there; infinity, to which its derivatives die away, is None."""

    at: Fraction | None
    conditions: tuple[Expression, ...]


@dataclass(frozen=True)
class BaseFlow:
    """states: the derivatives (unknown, order) that F takes; slopes: F. Integrations begin at the origin, towards the ends, each with its
    direction ±1. guess: the states as a first guess, functions of the coordinate.
    """

    states: tuple[Jet, ...]
    slopes: tuple[Expression, ...]
    origin: BaseEnd
    ends: tuple[tuple[int, BaseEnd], ...]
    guess: tuple[Expression, ...]
    _higher: dict[Jet, Expression] = field(default_factory=dict, compare=False, repr=False)

    @property
    def unknowns(self) -> tuple[str, ...]:
        """The names of the base flow's functions."""
        return tuple(dict.fromkeys(name for name, _ in self.states))

    def higher(self, name: str, order: int) -> Expression:
        """A derivative that is no state, in states and in lower ones that are none."""
        at = name, order
        if at not in self._higher:
            top = (name, order - 1)
            self._higher[at] = self.slopes[self.states.index(top)] if top in self.states else self.higher(*top).derivative()
        return self._higher[at]


def of_state(state: Jet) -> Expression:
    """A derivative of an unknown of the base flow."""
    return of_atom(Atom("given", *state))


def solved_for_highest(equations: Sequence[tuple[str, Expression]], unknowns: Sequence[str]) -> dict[str, tuple[int, Expression]]:
    """The highest derivative of each unknown: its order, and what it is in lower ones.

    Raises InputError, which names the equation: not linear in the highest derivatives, or none that determines one of them.
    """
    held = {atom for _, expression in equations for atom in expression.atoms() if atom.kind == "given"}
    orders = {name: max((atom.order for atom in held if atom.name == name), default=0) for name in unknowns}
    for name in unknowns:
        if not orders[name]:
            raise InputError(f"base: no equation holds a derivative of {name}: allowed are differential equations for every unknown")
    tops = [Atom("given", name, orders[name]) for name in unknowns]
    rows, rest = [], []
    for where, expression in equations:
        row, remaining = {}, number(0)
        for outer, coefficient in expression.collected(lambda atom: atom in tops):
            if sum(e for _, e in outer) not in (0, 1) or coefficient.atoms() & set(tops):
                told = f"{where} is not linear in the highest derivatives {', '.join(map(str, tops))}"
                raise InputError(f"{told}: allowed is any function of lower ones")
            if outer:
                row[tops.index(outer[0][0])] = coefficient
            else:
                remaining = coefficient
        rows.append(row)
        rest.append(-remaining)
    _eliminate(rows, rest, [where for where, _ in equations], tops)
    return {name: (orders[name], rest[i] / rows[i][i]) for i, name in enumerate(unknowns)}


def _eliminate(rows: list[dict[int, Expression]], rest: list[Expression], names: list[str], tops: Sequence[Atom]) -> None:
    """Bring the rows to a diagonal, in place; row i then has the i-th highest derivative alone. Raises InputError where there is none."""
    for j, top in enumerate(tops):
        options = [i for i in range(j, len(rows)) if rows[i].get(j)]
        if not options:
            raise InputError(
                f"base: {', '.join(names)} do not determine {top}: allowed is one equation for the highest derivative of each unknown"
            )
        i = min(options, key=lambda i: (rows[i][j].constant is None, len(rows[i]), len(rows[i][j].terms)))
        rows[i], rows[j], rest[i], rest[j], names[i], names[j] = rows[j], rows[i], rest[j], rest[i], names[j], names[i]
        for other, row in enumerate(rows):
            if other != j and row.get(j):
                factor = row.pop(j) / rows[j][j]
                for k, c in rows[j].items():
                    if k != j:
                        row[k] = row.get(k, number(0)) - factor * c
                rest[other] = rest[other] - factor * rest[j]


def fixed_at_origin(flow: BaseFlow) -> tuple[dict[int, Expression], tuple[Expression, ...]]:
    """The states that a condition at the origin gives alone, by their places, and the other conditions there."""
    fixed: dict[int, Expression] = {}
    others = []
    atoms = {Atom("given", *state): i for i, state in enumerate(flow.states)}
    for condition in flow.origin.conditions:
        parts = dict(condition.collected(lambda atom: atom in atoms))
        rest = parts.pop((), number(0))
        (outer, factor), *more = parts.items()
        alone = not more and len(outer) == 1 and outer[0][1] == 1 and factor.constant is not None and not rest.atoms() & set(atoms)
        if alone and atoms[outer[0][0]] not in fixed:
            fixed[atoms[outer[0][0]]] = -rest / factor
        else:
            others.append(condition)
    return fixed, tuple(others)


def highest_derivatives(flow: BaseFlow) -> list[tuple[Jet, Expression]]:
    """The highest derivative of each unknown, and F for it."""
    tops = [((name, order + 1), slope) for (name, order), slope in zip(flow.states, flow.slopes, strict=True)]
    return [(top, slope) for top, slope in tops if top not in flow.states]
