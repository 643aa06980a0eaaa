"""A problem as its user stated it, read but not changed: what both ways to its eigenvalues begin with."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from shootstab.core.errors import InputError
from shootstab.formulation.conditions import Conditions, End, Periodic, end_of, rows_of
from shootstab.formulation.domain import Domain
from shootstab.formulation.evaluation import Given
from shootstab.formulation.names import Names
from shootstab.formulation.system import Row, System
from shootstab.problems.ends import Infinity


@dataclass(frozen=True, eq=False)
class Statement:
    """The equations and the conditions at both ends as rows over the unknowns, with the names in them.

    An end without conditions (an axis, infinity) has no rows.
    """

    names: Names
    system: System
    left: End
    right: End
    left_rows: tuple[tuple[str, Row], ...]
    right_rows: tuple[tuple[str, Row], ...]
    domain: Domain

    @property
    def finite(self) -> tuple[bool, bool]:
        """Which ends are."""
        return not isinstance(self.left, Infinity), not isinstance(self.right, Infinity)

    @property
    def holding(self) -> tuple[bool, bool]:
        """Which ends hold conditions."""
        return isinstance(self.left, Conditions), isinstance(self.right, Conditions)


def stated(
    unknowns: Sequence[str],
    equations: Sequence[Any],
    left: Any,
    right: Any,
    parameters: Mapping[str, Any],
    where: Mapping[str, Any],
    eigenvalue: str,
    variable: str,
    given: Given,
) -> Statement:
    """See problem.equations. Raises InputError."""
    for name, value in (("unknowns", unknowns), ("equations", equations)):
        if isinstance(value, str) or not isinstance(value, Sequence):
            raise InputError(f"{name} = {value!r}: allowed is a list")
    names = Names(tuple(unknowns), dict(parameters), dict(where), eigenvalue, variable, tuple(given))
    ends = end_of(left, "left"), end_of(right, "right")
    low = -np.inf if isinstance(ends[0], Infinity) else ends[0].at
    high = np.inf if isinstance(ends[1], Infinity) else ends[1].at
    if not low < high:
        raise InputError(f"the ends lie at {variable} = {low:g} and {high:g}: allowed is a left end below the right one")
    if isinstance(ends[0], Periodic) != isinstance(ends[1], Periodic):
        raise InputError("one end is periodic and the other is not: allowed are two periodic ends")
    read = {f"equation {i}": names.expression(e, f"equation {i}") for i, e in enumerate(equations, 1)}
    system = System.of(names.unknowns, read)
    rows = [tuple(rows_of(end, side, names)) for end, side in zip(ends, ("left", "right"), strict=True)]
    return Statement(names, system, *ends, rows[0], rows[1], Domain(float(low), float(high), dict(given)))
