"""The unknowns of the user's equations in terms of the states that the reduction kept: what an eigenfunction is shown in."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from shootstab.formulation.evaluation import Given, on_arrays
from shootstab.formulation.expression import Expression, number
from shootstab.formulation.first_order import FirstOrder
from shootstab.formulation.system import EquationRow, Jet
from shootstab.problems.protocol import ComplexArray
from shootstab.problems.unknowns import Unknowns

ITSELF: Jet = ("the unknown itself", 0)  # a name that no unknown can have


def stated_rows(names: Sequence[str], first: FirstOrder) -> list[EquationRow]:
    """The reduction of u − (itself) = 0 to states for each unknown u: it has the coefficients r_j, and −p before itself."""
    return [first.in_states({(name, 0): number(1), ITSELF: number(-1)}, beside=(ITSELF,)) for name in names]


def unknowns_of(names: Sequence[str], first: FirstOrder, size: int, given: Given, variable: str) -> Unknowns:
    """Each unknown u as Σ r_j ψ_j / p, for arrays of points of this variable."""
    rows = stated_rows(names, first)
    place = {state: j for j, state in enumerate(first.states)}

    def matrix(z: ComplexArray, sigma: complex) -> ComplexArray:
        at = on_arrays(z, given, sigma)
        out = np.zeros((len(z), len(names), size), dtype=np.complex128)
        for i, row in enumerate(rows):
            for jet, coefficient in row.items():
                if jet != ITSELF:
                    out[:, i, place[jet]] = -at(coefficient) / at(row[ITSELF])
        return out

    return Unknowns(tuple(names), matrix, variable)


def shown_in_states(names: Sequence[str], first: FirstOrder) -> dict[str, tuple[dict[int, Expression], Expression]]:
    """The r_j by the places of states, and −p, of each unknown u = Σ r_j ψ_j / p."""
    place = {state: j for j, state in enumerate(first.states)}
    rows = zip(names, stated_rows(names, first), strict=True)
    return {name: ({place[jet]: factor for jet, factor in row.items() if jet != ITSELF}, row[ITSELF]) for name, row in rows}
