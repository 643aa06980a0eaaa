"""The limit of a pencil at an end at infinity, read off far out: formulas that come to it exponentially have come to it there."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from shootstab.core.errors import InputError
from shootstab.core.scaled import TINY
from shootstab.problems.ends import INFINITIES, Infinity
from shootstab.problems.pencil_function import PencilFunction

LIMIT_PLACES = (1e8, 2e8)  # chosen: e^{−z/L} is zero in doubles for every L below 1e5, and what is not constant differs at the two
AT_LIMIT = 1e-15  # chosen: relative change of coefficients between these places that is rounding


def with_limit(end: Infinity, matrices: PencilFunction, side: int) -> Infinity:
    """The end with its limit. Raises InputError where the coefficients have none, or come to it slower than exponentially."""
    if end.start is not None or end.limit is not None:
        return end
    advice = "allowed are coefficients that come to a constant exponentially, or Infinity(start=...)"
    try:
        with np.errstate(all="ignore"):
            near, far = (matrices.at(side * z) for z in LIMIT_PLACES)
    except InputError as error:
        raise InputError(f"at {INFINITIES[side]} the coefficients have no finite limit ({error}): {advice}") from error
    limit = []
    for a, b in zip(near.named.values(), far.named.values(), strict=True):
        if (np.abs(a - b) > AT_LIMIT * max(float(np.abs(b).max()), TINY)).any():
            raise InputError(f"at {INFINITIES[side]} the coefficients have no limit, or come to it slower than exponentially: {advice}")
        limit.append(b)
    return replace(end, limit=tuple(limit))
