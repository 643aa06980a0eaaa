"""Conditions at a finite end of a problem in equations, as the rows of a wall."""

from __future__ import annotations

import numpy as np

from shootstab.core.errors import InputError
from shootstab.formulation.conditions import Conditions
from shootstab.formulation.evaluation import Given, filled, on_arrays
from shootstab.formulation.state_pencil import Powers
from shootstab.formulation.statement import Statement
from shootstab.problems.ends import Wall
from shootstab.problems.pencil_function import PencilFunction


def require_finite(matrices: PencilFunction, statement: Statement) -> None:
    """Raise InputError where the coefficients are not finite at an end with conditions."""
    for side, end in (("left", statement.left), ("right", statement.right)):
        if isinstance(end, Conditions) and not all(np.isfinite(part).all() for part in matrices.function(np.array([complex(end.at)]))):
            place = f"{statement.names.variable} = {end.at:g}"
            raise InputError(
                f"at the {side} end, {place}, the equations are singular, or beyond 1e308: allowed is st.Axis({end.at:g}), or another end"
            )


def wall_at(z: float, rows: Powers, count: int, size: int, given: Given) -> Wall:
    """The rows W0, W1, … (count, size) at z."""
    place = np.array([float(z)])
    at = on_arrays(place, given)
    W0, *later = (filled(part, (count, size), place.astype(np.complex128), at)[0] for part in rows)
    return Wall(float(z), W0, np.array(later))
