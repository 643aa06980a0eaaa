"""The table [dedalus] of a scene file: an eigenvalue problem in the spelling of Dedalus' scripts, as the table [problem] that it means.

    [dedalus]
    coordinate = "x"
    bounds = [0, 1]
    variables = ["u", "tau_1", "tau_2"]
    eigenvalue = "s"
    substitutions = { "ux" = "dx(u) + lift(tau_1, -1)" }
    equations = ["s*u + dx(ux) + lift(tau_2, -1) = 0", "u(x=0) = 0", "u(x=1) = 0"]

What is read are the texts of add_equation, add_bc and substitutions, `name` or `name(A, B)`: d and the coordinate's name in one is the
derivative, f(x=0), left(f), right(f) and interp(f, x=0) are values at an end, and an equation that holds any is a condition; one that holds
both ends couples them. A term lift(tau, n) stands for the error of the script's own discretization, and is left out with its tau: what is
solved is the problem that the script discretizes. Operators of vectors and tensors are not read.

axis = "left" or "right" says that this end is a regular singular point, at which the script's conditions stand for being regular.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import Any

from shootstab.core.errors import InputError, shortened
from shootstab.core.scene_keys import require_keys
from shootstab.formulation.dedalus_spelling import END_NAMES, Script, Substitution

DEDALUS_NEEDED = ("variables", "equations", "eigenvalue", "bounds")  # chosen: the keys of [dedalus], as the docstring says
DEDALUS_OPTIONAL = ("conditions", "coordinate", "basis", "parameters", "substitutions", "axis")  # chosen likewise
INTERVALS = ("Chebyshev", "ChebyshevT", "Legendre", "Jacobi", "Hermite", "Laguerre")  # chosen: bases that ask for conditions, or for decay
PERIODS = ("Fourier", "ComplexFourier", "RealFourier")  # chosen: bases over a period
SUBSTITUTION = re.compile(r"\s*([^\W\d]\w*)\s*(?:\(([^()]*)\))?\s*")


def problem_table(table: Mapping[str, Any]) -> tuple[dict[str, Any], tuple[str, ...]]:
    """The table [problem] in this language, and the variables of tau terms, which are left out.

    Raises InputError, which names the key, or the equation and what stands there.
    """
    require_keys("[dedalus]", table, DEDALUS_NEEDED, DEDALUS_NEEDED + DEDALUS_OPTIONAL)
    variables, formulas = _texts(table, "variables"), [*_texts(table, "equations"), *_texts(table, "conditions")]
    coordinate, basis = str(table.get("coordinate", "z")), table.get("basis", "Chebyshev")
    if basis not in (*INTERVALS, *PERIODS):
        raise InputError(f"[dedalus] basis = {shortened(basis)}: allowed is one of {', '.join((*INTERVALS, *PERIODS))}")
    bounds = table["bounds"]
    if not isinstance(bounds, list) or len(bounds) != 2:
        raise InputError(f'[dedalus] bounds = {shortened(bounds)}: allowed are two numbers, or "-infinity" and "infinity"')
    if not isinstance(table.get("parameters", {}), dict):
        raise InputError(f"[dedalus] parameters = {shortened(table['parameters'])}: allowed is a table of numbers by name")
    script = Script(variables, coordinate, bounds, _substitutions(table), table.get("parameters", {}))
    read = [script.translated(formula, f"equation {i}") for i, formula in enumerate(formulas, 1)]
    plain = {name: body for name, (arguments, body) in script.substitutions.items() if arguments is None}
    where = {name: script.translated(body, f"the substitution {name}").text for name, body in plain.items()}
    conditions: dict[str, list[str]] = {side: [one.text for one in read if one.sides == {side}] for side in END_NAMES}
    out: dict[str, Any] = {
        "unknowns": [name for name in variables if name not in script.lifted],
        "eigenvalue": table["eigenvalue"],
        "variable": coordinate,
        "parameters": table.get("parameters", {}),
        "where": where,
        "equations": [one.text for one in read if not one.sides],
    }
    axis = table.get("axis")
    if axis is not None and axis not in END_NAMES:
        raise InputError(f'[dedalus] axis = {shortened(axis)}: allowed is "left" or "right"')
    for side, bound in zip(END_NAMES, bounds, strict=True):
        out[side] = _end(side, bound, basis in PERIODS, side == axis, conditions[side])
    coupled = [one.text for one in read if len(one.sides) == 2]
    return ({**out, "coupled": coupled} if coupled else out), tuple(sorted(script.lifted))


def _end(side: str, bound: Any, periodic: bool, axis: bool, conditions: list[str]) -> Any:
    """An end as [problem] has it. Raises InputError where conditions stand at one that has none."""
    infinite = bound == ("-infinity" if side == "left" else "infinity")
    if conditions and (periodic or infinite):
        what = "a period has no ends" if periodic else "solutions decay at infinity by themselves"
        raise InputError(f"[dedalus] {conditions[0]} = 0 at the {side} end: {what}; allowed are none there")
    if infinite:
        return "infinity"
    return {"periodic": bound} if periodic else {"axis": bound} if axis else {"at": bound, "conditions": conditions}


def _substitutions(table: Mapping[str, Any]) -> dict[str, Substitution]:
    """The names of arguments, None without parentheses, and what stands for it, by name."""
    found: dict[str, Substitution] = {}
    given = table.get("substitutions", {})
    for key, body in given.items() if isinstance(given, dict) else [("substitutions", given)]:
        match = SUBSTITUTION.fullmatch(key)
        if match is None or not isinstance(body, str):
            raise InputError(f"[dedalus] substitutions: {shortened(key)} = {shortened(body)}: allowed are name or name(A, B), and a text")
        name, arguments = match[1], match[2]
        found[name] = (None if arguments is None else tuple(x.strip() for x in arguments.split(",")), body)
    return found


def _texts(table: Mapping[str, Any], key: str) -> list[str]:
    value = table.get(key, [])
    if not isinstance(value, list) or not all(isinstance(x, str) for x in value):
        raise InputError(f"[dedalus] {key} = {shortened(value)}: allowed is a list of strings")
    return value
