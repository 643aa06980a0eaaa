"""Conditions that couple the two ends, over the states at both, and the problem that they make for the engine.

The integration carries a = ψ(left) beside ψ (problems/subdomains.py: the augmented state), so that where it arrives all conditions are
Σ σ^k (M_k a + N_k ψ) = 0. A period is the case ψ = a.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from shootstab.core.errors import InputError
from shootstab.formulation.conditions import CoupledEnd
from shootstab.formulation.coupled_conditions import END_SIDES, NamedRow, at_place
from shootstab.formulation.dependent_conditions import require_independent_rows
from shootstab.formulation.evaluation import on_arrays
from shootstab.formulation.first_order import FirstOrder, reduced_to
from shootstab.formulation.joints import on_side
from shootstab.formulation.names import Names
from shootstab.formulation.state_pencil import Powers, by_powers
from shootstab.formulation.system import EquationRow, Jet, shown
from shootstab.formulation.vanishing import Vanishing
from shootstab.problems.decaying_space import ConstantSpace
from shootstab.problems.pencil_function import PencilFunction
from shootstab.problems.subdomains import Subdomain
from shootstab.problems.two_point import TwoPointReduction


def coupled_rows(
    ends: Sequence[CoupledEnd], own: Sequence[Sequence[NamedRow]], coupled: Sequence[NamedRow], first: FirstOrder, names: Names
) -> list[EquationRow]:
    """All conditions over left(state) and right(state), own being those of each end.

    Raises InputError where they are not as many as the order, where one says nothing or follows from others, and where one end has none.
    """
    places = dict(zip(END_SIDES, (float(end.at) for end in ends), strict=True))
    stated = [
        (where, {on_side(side, at): at_place(places[side], where, c) for at, c in row.items()})
        for side, rows in zip(END_SIDES, own, strict=True)
        for where, row in rows
    ]
    stated += coupled
    n = first.order
    if len(stated) != n:
        told = f"{len(own[0])} conditions at the left end, {len(own[1])} at the right and {len(coupled)} that couple them"
        raise InputError(f"{told}: allowed are {n} in all, the order of the equations")
    states = {on_side(side, state) for side in END_SIDES for state in first.states}
    sided = {on_side(side, (name, 0))[0]: (side, name) for side in END_SIDES for name in first.rules}

    def rule_for(at: Jet) -> EquationRow:
        side, name = sided[at[0]]
        return {on_side(side, key): at_place(places[side], f"what finds {name}", c) for key, c in first.rule((name, at[1])).items()}

    vanishing = Vanishing(0.0, 0.0, {})
    rows = [reduced_to(row, states, rule_for, vanishing) for _, row in stated]
    for (where, _), row in zip(stated, rows, strict=True):
        if not row:
            raise InputError(f"{where} says nothing: the equations themselves make it true; allowed are conditions that they leave open")
    require_independent_rows(stated, rows, "the two ends", names, vanishing)
    for side in END_SIDES:
        if not any(at[0].startswith(f"{side}(") for row in rows for at in row):
            raise InputError(
                f"no condition holds what is at the {side} end: an initial-value problem, whose only solution is zero whatever "
                f"{names.eigenvalue} is; it has no eigenvalues"
            )
    return rows


def over_both_ends(rows: Sequence[EquationRow], first: FirstOrder) -> Powers:
    """The rows by powers of σ, entries by (row, component of (a, ψ))."""
    places = {on_side(side, state): k * first.order + i for k, side in enumerate(END_SIDES) for i, state in enumerate(first.states)}
    return by_powers({(r, places[at]): c for r, row in enumerate(rows) for at, c in row.items()})


def between_coupled_ends(matrices: PencilFunction, ends: Sequence[CoupledEnd], rows: Powers) -> TwoPointReduction:
    """(a, ψ) from (1, 1) at the left end, with the rows (n, 2n) at the right one."""
    n = matrices.size
    at = on_arrays(np.zeros(1), {})
    W = np.zeros((max(2, len(rows)), n, 2 * n), dtype=np.complex128)
    for power, part in enumerate(rows):
        for place, c in part.items():
            W[(power, *place)] = complex(np.ravel(at(c))[0])
    part_of_line = Subdomain(0.0, 1.0, ConstantSpace(np.eye(n, dtype=np.complex128)), augmented=True)
    return TwoPointReduction((part_of_line,), float(ends[0].at), float(ends[1].at), tuple(W))


def row_texts(rows: Sequence[EquationRow], names: Names) -> list[str]:
    """Conditions over both ends as their user would write them."""

    def sided(at: Jet) -> str:
        side, _, name = at[0].removesuffix(")").partition("(")
        return f"{side}({shown((name, at[1]))})"

    return [" + ".join(f"({names.text(c)})*{sided(at)}" for at, c in sorted(row.items())) + " = 0" for row in rows]
