"""A problem in equations as the engine integrates it: its ends, by their kinds, and what lies between."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

from shootstab.core.errors import InputError
from shootstab.formulation.conditions import Axis, Conditions, CoupledEnd, Periodic
from shootstab.formulation.coupled_ends import between_coupled_ends, over_both_ends
from shootstab.formulation.joint_conditions import between
from shootstab.formulation.limits import with_limit
from shootstab.formulation.reduced_layers import ReducedLayer
from shootstab.formulation.singular_ends import between_periodic_ends, between_singular_ends, singular_end
from shootstab.formulation.state_pencil import StatePencil
from shootstab.formulation.statement import Statement
from shootstab.formulation.system import EquationRow
from shootstab.formulation.walls import wall_at
from shootstab.problems.ends import Infinity
from shootstab.problems.pencil_function import PencilFunction
from shootstab.problems.two_point import TwoPointReduction, reduce_to_two_points


def laid_out(
    statement: Statement,
    layers: Sequence[ReducedLayer],
    systems: Sequence[StatePencil],
    matrices: PencilFunction,
    coupled: Sequence[EquationRow],
    fold: float | None,
    reference: complex | None,
    starts: Mapping[int, float],
) -> TwoPointReduction:
    """systems are those of the layers, the first with the conditions; coupled are all conditions of coupled ends; starts are of ends at
    infinity, by side. Raises InputError for ends that do not fit together.
    """
    ends, domain, system = (statement.left, statement.right), statement.domain, systems[0]
    first = layers[0].first_order
    if isinstance(ends[0], CoupledEnd) and isinstance(ends[1], CoupledEnd):
        return between_coupled_ends(matrices, (ends[0], ends[1]), over_both_ends(coupled, first))
    if isinstance(ends[0], Periodic) and isinstance(ends[1], Periodic):
        return between_periodic_ends(matrices, ends[0].at, ends[1].at)
    made: list[Any] = []
    for end, rows, count, side in zip(ends, (system.left, system.right), (system.left_rows, system.right_rows), (-1, 1), strict=True):
        if isinstance(end, Conditions):
            made.append(wall_at(end.at, rows, count, system.size, domain.given))
        elif isinstance(end, Axis):
            bounded = [i for i, (name, order) in enumerate(first.states) if order == 0 and name in statement.names.unknowns]
            made.append(singular_end(system, end.at, -side, bounded, f"{statement.names.variable} = {end.at:g}", domain))
        elif isinstance(end, Infinity):
            limited = with_limit(end, matrices, side, systems[0 if side < 0 else -1], domain.given, statement.names.text)
            made.append(replace(limited, start=starts.get(side, limited.start)))
    if any(isinstance(end, Axis) for end in ends):
        if layers[0].spectrum_inside.curves:
            raise InputError("C is singular for some sigma at every point up to a regular singular end: that is not offered")
        return between_singular_ends(matrices, made[0], made[1], reference)
    interfaces = between(statement.joints, [layer.first_order for layer in layers], domain.given)
    return reduce_to_two_points(matrices, made[0], made[1], interfaces, fold, reference)
