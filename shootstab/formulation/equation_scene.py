"""The table [problem] of a scene file that holds equations, as a problem.

    [problem]
    unknowns = ["u", "v", "p"]
    parameters = { R = 10000, a = 1 }
    where = { U = "1 - z**2" }
    equations = ["sigma*u + i*a*U*u + v*d(U) + i*a*p - (d(u,2) - a**2*u)/R", …]
    left = { at = -1, conditions = ["u", "v"] }
    right = { at = 1, conditions = ["u", "v"] }

An end is {at, conditions}; {axis = its place} where the equations have a regular singular point; {periodic = its place}, both ends;
"infinity"; or, where the coefficients neither have a limit there nor go as powers, {infinity = true, start = …}.
interfaces = [{ at, conditions, amplitudes }] divides the domain into layers, in which parameters and definitions that are lists have one
value each. coupled = [conditions that hold left(f) and right(f)] joins two finite ends, which may be { at = ... } alone. base is a flow
that solves equations of its own: see base_table.py. Further keys: eigenvalue and variable, their names (by
default sigma and z), fold, reference = [re, im], and knots = [places at which coefficients are not smooth, or hardly].
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from shootstab.core.errors import LISTED, InputError, shortened
from shootstab.core.scene_keys import LARGEST_NUMBER, require_keys
from shootstab.formulation.conditions import Axis, Conditions, End, Periodic
from shootstab.formulation.problem import EquationProblem, equations
from shootstab.problems.ends import Infinity

# chosen: the keys of [problem], as the docstring says
NEEDED = ("unknowns", "equations", "left", "right")
OPTIONAL = (
    "interfaces",
    "coupled",
    "parameters",
    "where",
    "base",
    "eigenvalue",
    "variable",
    "fold",
    "reference",
    "knots",
)  # chosen likewise


def from_table(table: Mapping[str, Any]) -> EquationProblem:
    """The problem that the table means. Raises InputError, which names the key and what is allowed."""
    require_keys("[problem]", table, NEEDED, NEEDED + OPTIONAL)
    fold, reference = table.get("fold"), table.get("reference")
    if fold is not None and not _is_number(fold):
        raise InputError(f"[problem] fold = {shortened(fold)}: allowed is a finite number")
    parts = [reference] if _is_number(reference) else reference
    if reference is not None and not (isinstance(parts, list) and len(parts) in (1, 2) and all(map(_is_number, parts))):
        raise InputError(f"[problem] reference = {shortened(reference)}: allowed is a number or [re, im]")
    return equations(
        _texts(table, "unknowns"),
        _texts(table, "equations"),
        _end(table["left"], "left", "coupled" in table),
        _end(table["right"], "right", "coupled" in table),
        interfaces=_interfaces(table),
        coupled=_texts(table, "coupled") if "coupled" in table else (),
        parameters=_table(table, "parameters"),
        where=_table(table, "where"),
        base=table.get("base"),
        eigenvalue=_text(table, "eigenvalue", "sigma"),
        variable=_text(table, "variable", "z"),
        fold=None if fold is None else float(fold),
        knots=_places(table),
        reference=None if parts is None else complex(*parts),
    )


def _end(given: Any, side: str, coupled: bool) -> End:
    allowed = (
        'allowed is { at = ..., conditions = [...] }, { axis = ... }, { periodic = ... }, "infinity" or { infinity = true, start = ... }'
    )
    if given == "infinity":
        return Infinity()
    if isinstance(given, dict) and set(given) == {"axis"}:
        return Axis(given["axis"])
    if isinstance(given, dict) and set(given) == {"periodic"}:
        return Periodic(given["periodic"])
    if not isinstance(given, dict):
        raise InputError(f"[problem] {side} = {shortened(given)}: {allowed}")
    if given.get("infinity") is True and set(given) <= {"infinity", "start", "decaying"}:
        start, decaying = given.get("start"), given.get("decaying")
        if start is not None and not _is_number(start):
            raise InputError(f"[problem] {side}: start = {shortened(start)}: allowed is a finite number")
        if decaying is not None and (not isinstance(decaying, int) or isinstance(decaying, bool)):
            raise InputError(f"[problem] {side}: decaying = {shortened(decaying)}: allowed is a count")
        return Infinity(decaying=decaying, start=None if start is None else float(start))
    if coupled and set(given) == {"at"}:
        return Conditions(given["at"], [])
    if set(given) != {"at", "conditions"}:
        raise InputError(f"[problem] {side} has the keys {', '.join(given)[:LISTED] or 'none'}: {allowed}")
    return Conditions(given["at"], given["conditions"])


def _interfaces(table: Mapping[str, Any]) -> list[Any]:
    """Tables with at, conditions and amplitudes; what is in them is checked where they are read."""
    value = table.get("interfaces", [])
    if not isinstance(value, list) or not all(isinstance(x, dict) for x in value):
        raise InputError(f"[problem] interfaces = {value!r}: allowed is a list of {{ at = ..., conditions = [...], amplitudes = [...] }}")
    return value


def _places(table: Mapping[str, Any]) -> list[float]:
    value = table.get("knots", [])
    if not isinstance(value, list) or not all(map(_is_number, value)):
        raise InputError(f"[problem] knots = {shortened(value)}: allowed is a list of numbers")
    return [float(x) for x in value]


def _texts(table: Mapping[str, Any], key: str) -> list[str]:
    value = table[key]
    if not isinstance(value, list) or not value or not all(isinstance(x, str) for x in value):
        raise InputError(f"[problem] {key} = {shortened(value)}: allowed is a list of strings")
    return value


def _text(table: Mapping[str, Any], key: str, default: str) -> str:
    value = table.get(key, default)
    if not isinstance(value, str):
        raise InputError(f"[problem] {key} = {shortened(value)}: allowed is a name")
    return value


def _table(table: Mapping[str, Any], key: str) -> dict[str, Any]:
    """Numbers or formulas by name."""
    value = table.get(key, {})
    if not isinstance(value, dict):
        raise InputError(f"[problem] {key} = {shortened(value)}: allowed is a table of names")
    for name, x in value.items():
        if not all(_is_number(y) or (key == "where" and isinstance(y, str)) for y in (x if isinstance(x, list) else [x])):
            told = f"a finite number{' or a formula' if key == 'where' else ''}, or a list with one for each layer"
            raise InputError(f"[problem] {key}: {name} = {shortened(x)}: allowed is {told}")
    return value


def _is_number(x: Any) -> bool:
    return isinstance(x, int | float) and not isinstance(x, bool) and abs(x) < LARGEST_NUMBER
