"""Conditions that couple the two ends of a finite domain, as they are stated, in the language of the equations.

left(f) and right(f) are f at either end, with coefficients and definitions as they are there; the eigenvalue may occur in them. Conditions
that hold at one end alone may stand beside.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from typing import Any

from shootstab.core.errors import InputError
from shootstab.formulation.conditions import CoupledEnd
from shootstab.formulation.expression import VARIABLE, Expression, number
from shootstab.formulation.grammar import FormulaReader
from shootstab.formulation.joints import on_side
from shootstab.formulation.names import Names
from shootstab.formulation.substitution import substituted
from shootstab.formulation.system import Denominators, EquationRow, jet, row_of

END_SIDES = ("left", "right")  # chosen: the words of the language for the two ends
NamedRow = tuple[str, EquationRow]  # a condition, and what errors call it


def read_coupled(formulas: Sequence[Any], names: Names, ends: Sequence[CoupledEnd]) -> tuple[tuple[NamedRow, ...], Denominators]:
    """The conditions over left(u) and right(u), and the denominators they were multiplied by. Raises InputError with the place."""
    places = {side: float(end.at) for side, end in zip(END_SIDES, ends, strict=True)}

    def listed() -> str:
        return f"left(...), right(...), {names.listed()}"

    rows: list[NamedRow] = []
    denominators: list[tuple[str, Expression]] = []
    for i, formula in enumerate(formulas, 1):
        where = f"coupled condition {i}"

        def outside(name: str, where: str = where) -> Expression:
            found = names.meaning(name)
            if _along(found):
                raise InputError(f"{where}: {name} stands without an end: allowed are left({name}) and right({name})")
            return found

        placed = {side: partial(_on_side_at, side, at, where) for side, at in places.items()}
        reader = FormulaReader(formula, where, outside, listed, dict.fromkeys(END_SIDES, names.meaning), placed)
        row, found = row_of(reader.equation(), where, names.text)
        rows.append((where, row))
        denominators += found
    return tuple(rows), tuple(denominators)


def _along(expression: Expression) -> bool:
    """Whether it varies with the coordinate."""
    return any(atom == VARIABLE or atom.kind in ("given", "jet") for atom in expression.atoms())


def _on_side_at(side: str, place: float, where: str, expression: Expression) -> Expression:
    """The expression at an end, of which the unknowns are named on_side."""
    for atom in [atom for atom in expression.atoms() if atom.kind == "jet"]:
        expression = substituted(expression, atom, jet(*on_side(side, (atom.name, atom.order))))
    return at_place(place, where, expression)


def at_place(place: float, where: str, expression: Expression) -> Expression:
    """The expression at a place, of which the unknowns keep their names. Raises InputError for what is known to doubles, or infinite."""
    if any(atom.kind == "given" for atom in expression.atoms()):
        raise InputError(f"{where} holds a function that is given otherwise, or solved for: allowed are formulas where ends are coupled")
    try:
        return substituted(expression, VARIABLE, number(place))
    except ZeroDivisionError:
        raise InputError(f"{where} is not finite at {place:g}: allowed are finite coefficients") from None
