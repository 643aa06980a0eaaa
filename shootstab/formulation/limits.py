"""What coefficients do at an end at infinity: they come to a limit exponentially, as is read off far out, or go as powers."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from shootstab.core.errors import InputError
from shootstab.core.scaled import TINY
from shootstab.formulation.asymptotic_end import asymptotic_end
from shootstab.formulation.asymptotic_space import AsymptoticExpansion
from shootstab.formulation.evaluation import Given
from shootstab.formulation.exponentials import holds_coordinate
from shootstab.formulation.far_coefficients import Text
from shootstab.formulation.state_pencil import StatePencil
from shootstab.problems.ends import INFINITIES, Infinity
from shootstab.problems.pencil_function import PencilFunction
from shootstab.problems.protocol import ComplexArray

LIMIT_PLACES = (1e8, 2e8)  # chosen: e^{−z/L} is zero in doubles for every L below 1e5, and what is not constant differs at the two
AT_LIMIT = 1e-15  # chosen: relative change of coefficients between these places that is rounding


def with_limit(end: Infinity, matrices: PencilFunction, side: int, system: StatePencil, given: Given, text: Text) -> Infinity:
    """The end with its limit, or with the asymptotic series of its decaying space; as it is where it is to be frozen at a start.

    text shows a coefficient in the user's names.

    Raises InputError where the coefficients have neither.
    """
    if end.limit is not None or end.expansion is not None:
        return end
    refused = None
    if end.start is None:
        try:
            if not given and _goes_as_power(system, side):
                raise InputError(f"at {INFINITIES[side]} the coefficients come to their limit slower than exponentially")
            return replace(end, limit=_read_off(matrices, side))
        except InputError as error:
            refused = error
    try:
        if given:
            raise InputError(f"{', '.join(given)} have no formulas")
        expansion = AsymptoticExpansion(asymptotic_end(system, side, text), system.size, matrices)
        expansion.require_one_power()
        return replace(end, expansion=expansion)
    except InputError as error:
        if refused is None:
            return end
        advice = "allowed are coefficients that come to a constant exponentially, or go as powers, or Infinity(start=...)"
        raise InputError(f"{refused}, and no asymptotic series ({error}): {advice}") from error


def _goes_as_power(system: StatePencil, side: int) -> bool:
    """Whether coefficients have a limit and inverse powers of the coordinate beside it, which are rounding where limits are read off."""
    if not any(holds_coordinate(entry) for part in (*system.C, *system.D) for entry in part.values()):
        return False
    try:
        found = asymptotic_end(system, side)
    except InputError:
        return False
    return found.rank == 0 and not found.constant


def _read_off(matrices: PencilFunction, side: int) -> tuple[ComplexArray, ...]:
    """The limit. Raises InputError where there is none, or where coefficients come to it slower than exponentially."""
    try:
        with np.errstate(all="ignore"):
            near, far = (matrices.at(side * z) for z in LIMIT_PLACES)
    except InputError as error:
        raise InputError(f"at {INFINITIES[side]} the coefficients have no finite limit ({error})") from error
    for a, b in zip(near.named.values(), far.named.values(), strict=True):
        if (np.abs(a - b) > AT_LIMIT * max(float(np.abs(b).max()), TINY)).any():
            raise InputError(f"at {INFINITIES[side]} the coefficients have no limit, or come to it slower than exponentially")
    return tuple(far.named.values())
