"""A problem as its user stated it, read but not changed: what both ways to its eigenvalues begin with."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from shootstab.core.errors import InputError
from shootstab.formulation.atoms import Atom
from shootstab.formulation.base_flow import BaseFlow
from shootstab.formulation.base_solution import functions
from shootstab.formulation.base_table import base_flow, base_unknowns
from shootstab.formulation.conditions import Axis, Conditions, CoupledEnd, End, Periodic, end_of, rows_of
from shootstab.formulation.coupled_conditions import read_coupled
from shootstab.formulation.domain import Domain
from shootstab.formulation.evaluation import Given
from shootstab.formulation.expression import Expression, number, of_atom
from shootstab.formulation.joints import InterfaceConditions, Joint, read_joint
from shootstab.formulation.layers import Layer, own_definitions
from shootstab.formulation.names import Names
from shootstab.formulation.system import Denominators, EquationRow, System
from shootstab.problems.ends import Infinity


@dataclass(frozen=True, eq=False)
class Statement:
    """The equations and the conditions at both ends as rows over the unknowns, with the names in them; domain is the whole one.

    An end without conditions (an axis, infinity) has no rows. Layers are one more than joints, from left to right. denominators are
    those of equations and conditions that hold the eigenvalue, each once in a layer. varied(name) is the
    same statement in which a parameter is left open. base is the flow that solves equations of its own, if there is one. coupled are the
    conditions that join values at both ends, over left(u) and right(u).
    """

    left: End
    right: End
    left_rows: tuple[tuple[str, EquationRow], ...]
    right_rows: tuple[tuple[str, EquationRow], ...]
    domain: Domain
    layers: tuple[Layer, ...]
    joints: tuple[Joint, ...]
    denominators: Denominators
    varied: Callable[[str], Statement]
    base: BaseFlow | None = None
    coupled: tuple[tuple[str, EquationRow], ...] = ()

    @property
    def names(self) -> Names:
        """The names of the first layer."""
        return self.layers[0].names

    @property
    def system(self) -> System:
        """The system of the first layer."""
        return self.layers[0].system

    @property
    def doubles_only(self) -> tuple[str, ...]:
        """The functions that are known to doubles alone: those given, without the unknowns of a base flow."""
        return tuple(name for name in self.domain.given if self.base is None or name not in self.base.unknowns)

    @property
    def finite(self) -> tuple[bool, bool]:
        """The ends that are finite."""
        return not isinstance(self.left, Infinity), not isinstance(self.right, Infinity)

    @property
    def closed(self) -> tuple[bool, bool]:
        """The ends at which conditions hold, those that couple them among them."""
        left, right = (isinstance(end, Conditions | CoupledEnd) for end in (self.left, self.right))
        return left, right

    @property
    def holding(self) -> tuple[bool, bool]:
        """The ends that hold conditions."""
        return isinstance(self.left, Conditions), isinstance(self.right, Conditions)


def stated(
    unknowns: Sequence[str],
    equations: Sequence[Any],
    left: Any,
    right: Any,
    interfaces: Sequence[Any],
    parameters: Mapping[str, Any],
    where: Mapping[str, Any],
    eigenvalue: str,
    variable: str,
    given: Given,
    base: Mapping[str, Any] | None = None,
    coupled: Sequence[Any] = (),
) -> Statement:
    """See problem.equations. Raises InputError."""
    for name, value in (("unknowns", unknowns), ("equations", equations), ("coupled", coupled)):
        if isinstance(value, str) or not isinstance(value, Sequence):
            raise InputError(f"{name} = {value!r}: allowed is a list")
    ends = end_of(left, "left"), end_of(right, "right")
    if isinstance(ends[0], Periodic) != isinstance(ends[1], Periodic):
        raise InputError("one end is periodic and the other is not: allowed are two periodic ends")
    ends = _coupled(ends, interfaces) if coupled else ends
    joints = _interfaces(interfaces, ends)
    low, high = (math.inf * side if isinstance(end, Infinity) else float(end.at) for side, end in zip((-1, 1), ends, strict=True))
    places = [low, *(float(joint.at) for joint in joints), high]
    if not all(a < b for a, b in itertools.pairwise(places)):
        told = f"the ends lie at {variable} = {low:g} and {high:g}"
        if joints:
            told = f"ends and interfaces lie at {variable} = {', '.join(f'{place:g}' for place in places)}"
        raise InputError(f"{told}: allowed is a left end below the right one{', and interfaces between' if joints else ''}")
    count = len(places) - 1
    layered = [name for table in (parameters, where) for name, value in table.items() if isinstance(value, list | tuple)]
    named = (*given, *(() if base is None else base_unknowns(base)))
    systems = []
    for j in range(count):
        own_parameters = own_definitions(parameters, j, count, "the parameter")
        names = Names(tuple(unknowns), own_parameters, own_definitions(where, j, count, "where"), eigenvalue, variable, named)
        read = {f"equation {i}": names.expression(e, f"equation {i}") for i, e in enumerate(equations, 1)}
        systems.append((names, System.of(names.unknowns, read, names.text)))
    flow: BaseFlow | None = None
    if base is not None:
        alike, formulas = ({name: value for name, value in table.items() if name not in layered} for table in (parameters, where))
        names = Names(tuple(unknowns), alike, formulas, eigenvalue, variable, named)
        flow = base_flow(base, names, _reach(systems, places, base_unknowns(base)))
    functions_of_z: dict[str, Any] = {**given, **functions(flow)}
    singular = tuple(float(end.at) for end in ends if isinstance(end, Axis))
    layers = [Layer(*pair, Domain(*at, functions_of_z, singular)) for pair, at in zip(systems, itertools.pairwise(places), strict=True)]
    read_joints = [read_joint(joint, (a.names, b.names), layered) for joint, (a, b) in zip(joints, itertools.pairwise(layers), strict=True)]
    rows = [rows_of(end, side, layers[j].names) for end, side, j in zip(ends, ("left", "right"), (0, -1), strict=True)]
    held = [layer.system.denominators for layer in layers] + [joint.denominators for joint in read_joints] + [found for _, found in rows]
    couples: tuple[tuple[str, EquationRow], ...] = ()
    if isinstance(ends[0], CoupledEnd) and isinstance(ends[1], CoupledEnd):
        couples, found = read_coupled(coupled, layers[0].names, (ends[0], ends[1]))
        held.append(found)
    denominators = [pair for found in held for pair in found]
    whole = Domain(low, high, functions_of_z, singular)

    def varied(name: str) -> Statement:
        if name not in parameters:
            raise InputError(f"{name} is no parameter of the equations: allowed is one of {', '.join(parameters) or 'none'}")
        others = {other: value for other, value in parameters.items() if other != name}
        left_open = {**where, name: open_parameter(name, parameters[name])}
        return stated(unknowns, equations, left, right, interfaces, others, left_open, eigenvalue, variable, given, base, coupled)

    return Statement(*ends, rows[0][0], rows[1][0], whole, tuple(layers), tuple(read_joints), tuple(denominators), varied, flow, couples)


def _coupled(ends: tuple[End, End], interfaces: Sequence[Any]) -> tuple[End, End]:
    """The ends that conditions join. Raises InputError for any but finite ones, and for layers."""
    if interfaces:
        raise InputError("interfaces beside coupled ends: that is not offered; allowed are coupled ends, or interfaces")
    left, right = ends
    if not (isinstance(left, Conditions) and isinstance(right, Conditions)):
        raise InputError("coupled conditions join two finite ends: allowed are st.Conditions(at, [...]) at both, the lists empty or not")
    return CoupledEnd(left.at, left.conditions), CoupledEnd(right.at, right.conditions)


def _reach(systems: Sequence[tuple[Names, System]], places: Sequence[float], names: Sequence[str]) -> tuple[float, float]:
    """Where a base flow has to be known: from the first of the layers whose equations hold it to the last; everywhere, if none does."""
    holding = [
        j
        for j, (_, system) in enumerate(systems)
        if any(atom.kind == "given" and atom.name in names for row in system.rows for c in row.values() for atom in c.atoms())
    ]
    return (places[holding[0]], places[holding[-1] + 1]) if holding else (places[0], places[-1])


def _interfaces(given: Sequence[Any], ends: tuple[End, End]) -> list[InterfaceConditions]:
    """The interfaces from left to right. Raises InputError for what is none, and beside ends that offer none."""
    out = []
    for joint in given:
        if isinstance(joint, dict) and {"at", "conditions"} <= set(joint) <= {"at", "conditions", "amplitudes"}:
            joint = InterfaceConditions(**joint)
        allowed = "allowed is { at = ..., conditions = [...], amplitudes = [...] }, in Python st.InterfaceConditions"
        if not isinstance(joint, InterfaceConditions):
            raise InputError(f"the interface {joint!r}: {allowed}")
        if isinstance(joint.at, bool) or not isinstance(joint.at, int | float) or not math.isfinite(joint.at):
            raise InputError(f"the interface at = {joint.at!r}: allowed is a finite number")
        for name, value in (("conditions", joint.conditions), ("amplitudes", joint.amplitudes)):
            if isinstance(value, str) or not isinstance(value, Sequence) or not all(isinstance(x, str) for x in value):
                raise InputError(f"the interface {joint.at:g}: {name} = {value!r}: allowed is a list of texts")
        out.append(joint)
    if out and not all(isinstance(end, Conditions | Infinity) for end in ends):
        raise InputError(
            "interfaces beside an axis or periodic ends: that is not offered; allowed are ends with conditions, or at infinity"
        )
    return sorted(out, key=lambda joint: float(joint.at))


def open_parameter(name: str, value: Any) -> Expression:
    """A parameter that stands for this number where it is given no other."""
    return of_atom(Atom("parameter", name, 0, number(value)))
