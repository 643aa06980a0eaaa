"""Conditions at one place of which one follows from others: named as their user counts them, with what the equations make of them there.

Coefficients at the place are polynomials in σ, and independence is that for almost every σ: no λ(σ) ≠ 0 with λᵀ W = 0.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from shootstab.core.errors import InputError
from shootstab.formulation.evaluation import Given, on_arrays
from shootstab.formulation.expression import VARIABLE, number
from shootstab.formulation.linear_algebra import left_null_vector
from shootstab.formulation.names import Names
from shootstab.formulation.substitution import substituted
from shootstab.formulation.system import EquationRow, shown
from shootstab.formulation.vanishing import Vanishing

TRIED_SIGMA = np.array([0.6180339887 + 0.4142135624j])  # chosen: a σ of no property, at which coefficients are finite or are not


def require_independent_conditions(
    stated: Sequence[tuple[str, EquationRow]], reduced: Sequence[EquationRow], at: float, names: Names, given: Given, vanishing: Vanishing
) -> None:
    """stated are conditions at a coordinate as they were written, reduced the same over the states. Raises InputError, which names them.

    Functions that are given are compared as functions: what they make dependent at this place alone is left to the rank in doubles, and so
    is what is not finite there.
    """
    values = on_arrays(np.array([float(at)]), given, TRIED_SIGMA)
    with np.errstate(all="ignore"):
        if not all(np.isfinite(values(c)).all() for row in reduced for c in row.values()):
            return
    place = f"{names.variable} = {at:g}"
    here = []
    for (where, row), over_states in zip(stated, reduced, strict=True):
        rest = {key: substituted(c, VARIABLE, number(at)) for key, c in over_states.items()}
        here.append({key: c for key, c in rest.items() if not vanishing(c)})
        if not here[-1]:
            told = f"what it multiplies {', '.join(map(shown, row))} by vanishes there"
            raise InputError(f"{where} says nothing at {place}: {told}; allowed are conditions that leave something open")
    require_independent_rows(stated, here, place, names, vanishing)


def require_independent_rows(
    stated: Sequence[tuple[str, EquationRow]], here: Sequence[EquationRow], place: str, names: Names, vanishing: Vanishing
) -> None:
    """Likewise for conditions whose coefficients at their place are known."""
    rows = [{shown(at): c for at, c in row.items()} for row in here]
    null = left_null_vector(rows, sorted({key for row in rows for key in row}), vanishing)
    if null is None:
        return
    *others, last = sorted(null)
    where, row = stated[last]
    made = "" if set(here[last]) <= set(row) else f" and the equations, by which it is {names.row_text(here[last])} = 0"
    from_ = ", ".join(stated[i][0] for i in others)
    raise InputError(f"{where} follows from {from_}{made}, at {place}: allowed are independent conditions")
