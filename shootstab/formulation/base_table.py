"""The key base of a problem in equations: a base flow as its user writes it.

    base = { unknowns = ["f"], equations = ["d(f,3) + f*d(f,2)/2 = 0"],
             left = { at = 0, conditions = ["f", "d(f)"] }, right = { infinity = true, conditions = ["d(f) = 1"] } }

A place inside at which conditions hold is middle = { at, conditions }; needed where both ends are at infinity. guess = { f = "z" } holds
functions of the coordinate with which the solution begins where zero is too far from it.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from fractions import Fraction
from typing import Any

from shootstab.core.errors import InputError, shortened
from shootstab.core.scene_keys import require_keys
from shootstab.formulation.base_flow import BaseEnd, BaseFlow, of_state, solved_for_highest
from shootstab.formulation.conditions import Conditions
from shootstab.formulation.expression import Expression, number
from shootstab.formulation.gaussian import Gaussian
from shootstab.formulation.names import Names
from shootstab.formulation.system import equations_for

BASE_KEYS = ("unknowns", "equations", "left", "right")  # chosen: the keys that base must have
BASE_OPTIONS = ("middle", "guess")  # chosen: those that it may have
MOST_BASE_STATES = 24  # chosen: the order of a base flow, more than any similarity solution has


def base_unknowns(table: Any) -> tuple[str, ...]:
    """The names that a base flow defines. Raises InputError for what is no table of one."""
    if not isinstance(table, Mapping):
        raise InputError(f"base = {shortened(table)}: allowed is a table with the keys {', '.join(BASE_KEYS)}")
    require_keys("base", table, BASE_KEYS, BASE_KEYS + BASE_OPTIONS)
    for key in ("unknowns", "equations"):
        value = table[key]
        if isinstance(value, str) or not isinstance(value, Sequence) or not value:
            raise InputError(f"base {key} = {shortened(value)}: allowed is a list with one entry or more")
    return tuple(table["unknowns"])


def base_flow(table: Mapping[str, Any], names: Names, domain: tuple[float, float]) -> BaseFlow:
    """The base flow of a table, whose formulas have these names, on a domain from left to right.

    Raises InputError, which names the equation or condition: not real, with an unknown of the perturbation or its eigenvalue in it, not
    solvable for the highest derivatives, and conditions that are too many, too few, or hold these derivatives.
    """
    unknowns = base_unknowns(table)

    def read(formula: Any, where: str) -> Expression:
        expression = names.expression(formula, where)
        _require_base(expression, where, unknowns, names.eigenvalue)
        return expression

    equations = [(f"base equation {i}", read(e, f"base equation {i}")) for i, e in enumerate(table["equations"], 1)]
    if len(equations) != len(unknowns):
        raise InputError(f"base: {equations_for(len(equations), unknowns)}: allowed are as many")
    highest = solved_for_highest(equations, unknowns)
    states = tuple((name, k) for name in unknowns for k in range(highest[name][0]))
    if len(states) > MOST_BASE_STATES:
        raise InputError(f"base: the order is {len(states)}: allowed are orders up to {MOST_BASE_STATES}")
    slopes = tuple(of_state((name, k + 1)) if (name, k + 1) in states else highest[name][1] for name, k in states)

    def end(side: str) -> BaseEnd:
        at, formulas = _place(table[side], side)
        conditions = tuple(read(formula, f"base, {side} condition {i}") for i, formula in enumerate(formulas, 1))
        for i, condition in enumerate(conditions, 1):
            held = [atom for atom in condition.atoms() if atom.kind == "given"]
            if not held:
                raise InputError(f"base, {side} condition {i} holds none of {', '.join(unknowns)}: allowed are conditions for them")
            for atom in held:
                if (atom.name, atom.order) not in states:
                    top = highest[atom.name][0]
                    raise InputError(f"base, {side} condition {i} holds {atom}: allowed are derivatives of {atom.name} below order {top}")
        return BaseEnd(at, conditions)

    left, right = end("left"), end("right")
    middle = end("middle") if "middle" in table else None
    held = sum(len(e.conditions) for e in (left, right, middle) if e is not None)
    if held != len(states):
        raise InputError(f"base has {held} conditions: allowed are {len(states)}, the order of its equations")
    _require_places(left, middle, right, domain, names.variable)
    origin, ends = _from_origin(left, middle, right)
    guess = _guess(table.get("guess", {}), unknowns, names)
    first = [guess.get(name, number(0)) for name, _ in states]
    for i, (_, order) in enumerate(states):
        for _ in range(order):
            first[i] = first[i].derivative()
    return BaseFlow(states, slopes, origin, ends, tuple(first))


def _require_base(expression: Expression, where: str, unknowns: Sequence[str], eigenvalue: str) -> None:
    told = f"allowed are {', '.join((*unknowns, 'the coordinate'))} and real parameters"
    for atom in sorted(expression.atoms()):
        if atom.kind == "jet" or atom.kind == "eigenvalue" or (atom.kind == "given" and atom.name not in unknowns):
            raise InputError(f"{where} holds {eigenvalue if atom.kind == 'eigenvalue' else atom}: {told}")
    if _complex(expression):
        raise InputError(f"{where} is not real: {told}")


def _complex(expression: Expression) -> bool:
    return any(c.im for c in expression.terms.values()) or any(
        atom.argument is not None and _complex(atom.argument) for atom in expression.atoms()
    )


def _place(given: Any, side: str) -> tuple[Fraction | None, Sequence[Any]]:
    infinite = " or { infinity = true, conditions = [...] }" if side != "middle" else ""
    allowed = f"allowed is {{ at = ..., conditions = [...] }}{infinite}"
    if isinstance(given, Conditions):
        given = {"at": given.at, "conditions": given.conditions}
    if not isinstance(given, Mapping) or set(given) not in ({"at", "conditions"}, {"infinity", "conditions"}):
        raise InputError(f"base {side} = {shortened(given)}: {allowed}")
    formulas, at = given["conditions"], given.get("at")
    if isinstance(formulas, str) or not isinstance(formulas, Sequence):
        raise InputError(f"base {side}: conditions = {shortened(formulas)}: allowed is a list of formulas")
    if "infinity" in given:
        if given["infinity"] is not True or side == "middle":
            raise InputError(f"base {side} = {shortened(given)}: {allowed}")
        return None, formulas
    if isinstance(at, bool) or not isinstance(at, int | float) or not math.isfinite(at):
        raise InputError(f"base {side}: at = {shortened(at)}: allowed is a finite number")
    return Fraction(Gaussian.of(at).re), formulas


def _require_places(left: BaseEnd, middle: BaseEnd | None, right: BaseEnd, domain: tuple[float, float], variable: str) -> None:
    low = -math.inf if left.at is None else float(left.at)
    high = math.inf if right.at is None else float(right.at)
    if not low < high or (middle is not None and not low < float(middle.at or 0) < high):
        raise InputError(
            f"base lies between {variable} = {low:g} and {high:g}: allowed is a left end below the right one, and a middle between"
        )
    if low > domain[0] or high < domain[1]:
        told = f"base lies between {variable} = {low:g} and {high:g}, and what holds it between {domain[0]:g} and {domain[1]:g}"
        raise InputError(f"{told}: allowed is a base flow that is known wherever they are")
    if middle is None and left.at is None and right.at is None:
        raise InputError("base has both ends at infinity: needed is middle = { at = ..., conditions = [...] }, from which it is integrated")


def _from_origin(left: BaseEnd, middle: BaseEnd | None, right: BaseEnd) -> tuple[BaseEnd, tuple[tuple[int, BaseEnd], ...]]:
    if middle is not None:
        return middle, ((-1, left), (1, right))
    return (left, ((1, right),)) if left.at is not None else (right, ((-1, left),))


def _guess(given: Any, unknowns: Sequence[str], names: Names) -> dict[str, Expression]:
    if not isinstance(given, Mapping):
        raise InputError(f"base guess = {shortened(given)}: allowed is a table of functions of {names.variable}")
    out = {}
    for name, formula in given.items():
        if name not in unknowns:
            raise InputError(f"base guess of {shortened(name)}: allowed are {', '.join(unknowns)}")
        out[name] = names.expression(formula, f"base guess of {name}")
        _require_base(out[name], f"base guess of {name}", (), names.eigenvalue)
    return out
