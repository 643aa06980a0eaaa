"""Where along one real number t a claim becomes a mode: t is a parameter of the problem, or the unit of the claims, in logarithms.

A claim v is a mode at t where D(v; t) = 0, two real equations for one real t, so that a claim by itself says whether there is one.
Newton's step s(t) = −D/∂_vD at v is about the distance from v to a mode at t, whatever factor D has. Secants bring it to zero from
values that are near enough.
"""

from __future__ import annotations

import cmath
import math
from collections.abc import Callable, Iterator, Sequence

from shootstab.core.allowance import Allowance

VALUES_APART = 0.025  # chosen: the distance of values that are tried; where modes move by more, others come next to the claim
PROMISING = 3.0  # chosen: how far from such a value a secant may lead, in VALUES_APART; with 2 half of the parameters are missed
MORE_SECANTS = 8  # chosen: further secants from there
SHORT_STEP = 1e-6  # chosen: Newton's step in the claim, so short that the claim is a mode to more digits than are asked to agree

Steps = Callable[[complex], complex]  # Newton's step from a claim at some t, infinite where there is none


def arrivals(at: Callable[[float], Steps], claims: Sequence[complex], widest: float, allowance: Allowance) -> Iterator[float]:
    """The t between −widest and widest at which one of the claims is a mode, as far as secants between neighbouring values lead there.

    They come from 0 outwards, until the allowance is spent.
    """
    values = round(widest / VALUES_APART)
    known: dict[int, list[complex]] = {}
    for k in sorted(range(-values, values), key=abs):
        if allowance.spent:
            return
        for i in (k, k + 1):
            if i not in known:
                steps = at(i * VALUES_APART)
                known[i] = [steps(claim) for claim in claims]
        for claim, here, before in zip(claims, known[k + 1], known[k], strict=True):
            step = _secant(here, before, VALUES_APART)
            if abs(step) <= PROMISING * VALUES_APART:
                arrived = _followed(at, claim, (k + 1) * VALUES_APART, here, step.real)
                if arrived is not None:
                    yield arrived


def _secant(now: complex, before: complex, apart: float) -> complex:
    """The step in t to where a line through both is zero; infinite where there is none."""
    change = now - before
    step = -now * apart / change if change != 0.0 else complex(math.inf)
    return step if cmath.isfinite(step) else complex(math.inf)


def _followed(at: Callable[[float], Steps], claim: complex, t: float, at_t: complex, step: float) -> float | None:
    """The t at which secants from here arrive; None where they do not."""
    for _ in range(MORE_SECANTS):
        if abs(at_t) <= SHORT_STEP * abs(claim):
            return t
        if not 0.0 < abs(step) <= PROMISING * VALUES_APART:
            return None
        before, t = at_t, t + step
        at_t = at(t)(claim)
        step = _secant(at_t, before, step).real
    return None
