"""Conditions at an interface between two layers as they are stated, in the language of the equations.

before(f) and behind(f) are f on the side of smaller and of larger coordinate, with the definitions of that layer, and jump(f) is behind(f)
− before(f). Amplitudes are unknown numbers that occur in the conditions alone, such as the elevation of a free surface.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from shootstab.core.errors import InputError
from shootstab.formulation.expression import Expression
from shootstab.formulation.grammar import FormulaReader, Scope
from shootstab.formulation.names import Names
from shootstab.formulation.system import Denominators, EquationRow, Jet, jet, row_of

INTERFACE_SIDES = ("before", "behind")  # chosen: the words of the language for the sides of smaller and of larger coordinate


@dataclass(frozen=True, eq=False)
class InterfaceConditions:
    """`conditions` hold at the coordinate `at` inside, formulas with before(f), behind(f), jump(f) and the amplitudes: see joints.py."""

    at: float
    conditions: Sequence[str]
    amplitudes: Sequence[str] = ()


@dataclass(frozen=True, eq=False)
class Joint:
    """An interface whose conditions have been read: rows over before(u), behind(u) and the amplitudes, times their denominators.

    names are those of the layer before it.
    """

    at: float
    rows: tuple[tuple[str, EquationRow], ...]
    amplitudes: tuple[str, ...]
    names: Names
    denominators: Denominators = ()


def read_joint(given: InterfaceConditions, names: tuple[Names, Names], layered: Sequence[str]) -> Joint:
    """layered are the definitions that differ from layer to layer. Raises InputError with the place."""
    where = f"the interface {given.at:g}"
    for name in given.amplitudes:
        if name in names[0].unknowns or not isinstance(name, str):
            raise InputError(f"{where}: the amplitude {name!r} is an unknown of the equations too: allowed is one meaning")

    def outside(name: str) -> Expression:
        if name in given.amplitudes:
            return jet(name)
        if name in names[0].unknowns or name in layered:
            raise InputError(f"{where}: {name} stands without a side: allowed are before({name}), behind({name}) and jump({name})")
        return names[0].meaning(name)

    def on(side: str, layer: Names) -> Scope:
        def scope(name: str) -> Expression:
            if name in given.amplitudes:
                return jet(name)
            return jet(f"{side}({name})") if name in layer.unknowns else layer.meaning(name)

        return scope

    scopes = {side: on(side, layer) for side, layer in zip(INTERFACE_SIDES, names, strict=True)}

    def listed() -> str:
        return ", ".join([*given.amplitudes, "before(...)", "behind(...)", "jump(...)", names[0].listed()])

    rows: list[tuple[str, EquationRow]] = []
    denominators: list[tuple[str, Expression]] = []
    for i, formula in enumerate(given.conditions, 1):
        place = f"{where}, condition {i}"
        row, found = row_of(FormulaReader(formula, place, outside, listed, scopes).equation(), place, names[0].text)
        denominators += found
        for name, order in row:
            if name in given.amplitudes and order:
                raise InputError(f"{place}: a derivative of the amplitude {name}, which is a number: allowed is {name} alone")
        rows.append((place, row))
    return Joint(float(given.at), tuple(rows), tuple(given.amplitudes), names[0], tuple(denominators))


def on_side(side: str, at: Jet) -> Jet:
    """The jet of an unknown on one side of an interface, or at one end."""
    return f"{side}({at[0]})", at[1]
