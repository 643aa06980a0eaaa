"""Whether a claim has a size of its own for D, or stands for 0: digits of a number next to zero mean nothing without a scale."""

from __future__ import annotations

import math

from shootstab.core.discriminant import Discriminant
from shootstab.roots.iterations import slope_change

NUDGE = 1e-3  # chosen: distance from a claim, in its size, at which the slope of D is looked at again
FLAT_CHANGE = 1e-6  # chosen: a change of D′ over NUDGE below which the scale of D may be a thousand times the claim
NOISY_CHANGE = 0.1  # chosen: such a change above which it is noise, or a zero of D′ is near; and one of Newton's step by another mesh
NEAR_ZERO = 100.0  # chosen: |σD′/D| above which a zero lies within two digits of σ, which is then no noise around 0
WHOLE_AT_ZERO = 0.05  # chosen: how near σD′/D comes to a whole number next to zeros at 0


def has_a_size(discriminant: Discriminant, claim: complex) -> bool:
    """Whether D around a claim changes over distances of about |claim|, as it does not next to zeros that lie at 0 against other scales.

    There D′ is constant (one zero), D like a power of σ, flat, or noise.
    """
    here = discriminant.with_derivative(claim)
    change = slope_change(here, discriminant.with_derivative(claim * (1 + NUDGE)))
    zeros = claim * here.logarithmic_derivative
    whole = round(zeros.real) if math.isfinite(abs(zeros)) else 0
    near_zero = whole >= 1 and abs(zeros - whole) < WHOLE_AT_ZERO and abs(change - (whole - 1) * NUDGE) < NOISY_CHANGE * NUDGE
    noise = change > NOISY_CHANGE and not abs(zeros) > NEAR_ZERO
    if noise:  # a smooth function would change a thousand times less over so much less
        noise = slope_change(here, discriminant.with_derivative(claim * (1 + NUDGE * NUDGE))) > NOISY_CHANGE
    return change > FLAT_CHANGE and abs(zeros) > NUDGE and not noise and not near_zero
