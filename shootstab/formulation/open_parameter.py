"""Equations in balls with one parameter left open: the reduction is made once, for every value of it."""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from typing import TYPE_CHECKING, Any

from shootstab.formulation.atoms import Atom
from shootstab.formulation.expression import number
from shootstab.formulation.first_order import first_order
from shootstab.formulation.gaussian import Gaussian
from shootstab.formulation.state_pencil import in_states, state_pencil
from shootstab.formulation.statement import Statement

if TYPE_CHECKING:
    from shootstab.multiprecision.enclosable import Enclosable


def places(statement: Statement) -> tuple[Fraction, Fraction]:
    """The two finite ends."""
    left, right = (Fraction(Gaussian.of(end.at).re) for end in (statement.left, statement.right))  # type: ignore[union-attr]
    return left, right


def varied(statement: Statement, name: str) -> Callable[[Any], Enclosable]:
    """p ↦ the problem with the value p, an acb, of this parameter.

    A pivot of the reduction that depends on it and vanishes somewhere in a ball p leaves no finite enclosure. Raises InputError for a name
    that is none of a parameter.
    """
    from shootstab.formulation.enclosed import EquationEnclosable
    from shootstab.multiprecision.enclosure import BetweenEnds

    opened = statement.varied(name)
    atom = Atom("parameter", name, 0, number(statement.names.parameters[name]))
    first = first_order(opened.system, opened.domain.vanishing, opened.domain.regular)
    system = state_pencil(first, *(in_states(list(rows), first) for rows in (opened.left_rows, opened.right_rows)))
    return lambda value: BetweenEnds(EquationEnclosable(system, *places(statement), {atom: value}))
