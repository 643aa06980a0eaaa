"""Conditions at a finite end of a problem in equations, as the rows of a wall."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from shootstab.core.errors import InputError
from shootstab.formulation.conditions import Conditions, CoupledEnd
from shootstab.formulation.dependent_conditions import require_independent_conditions
from shootstab.formulation.evaluation import Given, filled, on_arrays
from shootstab.formulation.first_order import FirstOrder
from shootstab.formulation.state_pencil import Condition, Powers
from shootstab.formulation.statement import Statement
from shootstab.problems.ends import Wall
from shootstab.problems.pencil_function import PencilFunction


def require_finite(matrices: PencilFunction, statement: Statement) -> None:
    """Raise InputError where the coefficients are not finite at an end with conditions."""
    for side, end in (("left", statement.left), ("right", statement.right)):
        if isinstance(end, Conditions | CoupledEnd) and not all(
            np.isfinite(part).all() for part in matrices.function(np.array([complex(end.at)]))
        ):
            place = f"{statement.names.variable} = {end.at:g}"
            raise InputError(
                f"at the {side} end, {place}, the equations are singular, or beyond 1e308: allowed is st.Axis({end.at:g}), or another end"
            )


def require_independent_ends(statement: Statement, first: FirstOrder, conditions: Sequence[Sequence[Condition]]) -> None:
    """Raise InputError where one of the conditions of an end, given over states, follows from others; layers have the same states."""
    domain = statement.domain
    for end, rows, own in zip((statement.left, statement.right), (statement.left_rows, statement.right_rows), conditions, strict=True):
        if isinstance(end, Conditions):
            over_states = [{first.states[j]: c for j, c in row.items()} for row in own]
            require_independent_conditions(rows, over_states, end.at, statement.names, domain.given, domain.vanishing)


def wall_at(z: float, rows: Powers, count: int, size: int, given: Given) -> Wall:
    """The rows W0, W1, … (count, size) at z."""
    place = np.array([float(z)])
    at = on_arrays(place, given)
    W0, *later = (filled(part, (count, size), place.astype(np.complex128), at)[0] for part in rows)
    return Wall(float(z), W0, np.array(later))
