"""The ends of a problem in equations: conditions in its own language at a finite place, or an end at infinity."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from shootstab.core.errors import InputError, shortened
from shootstab.core.scene_keys import LARGEST_NUMBER
from shootstab.formulation.expression import Expression
from shootstab.formulation.names import Names
from shootstab.formulation.system import Denominators, EquationRow, row_of
from shootstab.problems.ends import Infinity


@dataclass(frozen=True, eq=False)
class Conditions:
    """A finite end: each formula in `conditions`, linear in the unknowns and their derivatives, vanishes at the coordinate `at`."""

    at: float
    conditions: Sequence[Any]


@dataclass(frozen=True, eq=False)
class Axis:
    """A regular singular end of the equations, such as r = 0: solutions are regular there, and there are no conditions."""

    at: float = 0.0


@dataclass(frozen=True, eq=False)
class Periodic:
    """One of two ends at which everything is the same: the coefficients have the period between them, and so have solutions."""

    at: float


@dataclass(frozen=True, eq=False)
class CoupledEnd:
    """One of two finite ends that conditions couple: see coupled_conditions.py. Its own are those that hold at it alone."""

    at: float
    conditions: Sequence[Any]


End = Conditions | Infinity | Axis | Periodic | CoupledEnd


def end_of(given: Any, side: str) -> End:
    """An end from what the user wrote. Raises InputError."""
    if isinstance(given, dict):
        if set(given) != {"at", "conditions"}:
            raise InputError(f"{side} has {', '.join(map(str, given)) or 'nothing'}: allowed is {{at = ..., conditions = [...]}}")
        given = Conditions(given["at"], given["conditions"])
    if isinstance(given, Infinity):
        return given
    if not isinstance(given, Conditions | Axis | Periodic):
        raise InputError(f"{side} = {shortened(given)}: allowed is st.Conditions(at, [...]), st.Axis(at), st.Periodic(at) or st.Infinity()")
    if isinstance(given.at, bool) or not isinstance(given.at, int | float) or not abs(given.at) < LARGEST_NUMBER:
        raise InputError(f"{side}: at = {shortened(given.at)}: allowed is a finite number, or st.Infinity()")
    if isinstance(given, Axis | Periodic):
        return given
    if isinstance(given.conditions, str) or not isinstance(given.conditions, Sequence):
        raise InputError(f"{side}: conditions = {shortened(given.conditions)}: allowed is a list of formulas")
    return given


def rows_of(end: End, side: str, names: Names) -> tuple[tuple[tuple[str, EquationRow], ...], Denominators]:
    """The conditions as the user means them, each with what errors call it, and the denominators that they were multiplied by."""
    if not isinstance(end, Conditions | CoupledEnd):
        return (), ()
    rows: list[tuple[str, EquationRow]] = []
    denominators: list[tuple[str, Expression]] = []
    for i, formula in enumerate(end.conditions, 1):
        where = f"{side} condition {i}"
        row, found = row_of(names.expression(formula, where), where, names.text)
        rows.append((where, row))
        denominators += found
    return tuple(rows), tuple(denominators)
