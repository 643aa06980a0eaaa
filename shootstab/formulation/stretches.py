"""A real domain in stretches, each with a coordinate over a bounded interval in which its coefficients are written.

Between finite ends the coordinate is z itself. Towards an end at infinity to whose limits coefficients come exponentially it is
x = e^{−κ d z} (exponentials.py), from 0, the end, to where the stretch begins: at z = 0, or at the finite end if that lies beyond.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from fractions import Fraction

import numpy as np

from shootstab.core.errors import InputError
from shootstab.formulation.domain import Domain
from shootstab.formulation.evaluation import on_arrays
from shootstab.formulation.exponentials import in_exponential
from shootstab.formulation.expression import Expression

STRETCH_MARGIN = 1.0 + 1e-9  # chosen: how much farther than e^{−κ d z} in doubles a stretch reaches, a million times the rounding of it


@dataclass(frozen=True, eq=False)
class Stretch:
    """The coordinate's interval, and what writes a coefficient in it; it raises InputError for one that grows towards infinity."""

    low: Fraction
    high: Fraction
    written: Callable[[Expression], Expression]


def stretches(domain: Domain, coefficients: Sequence[Expression]) -> tuple[Stretch, ...]:
    """Stretches that cover the domain. Raises InputError where coefficients do not come to their limits at infinity exponentially."""
    left, right = domain.left, domain.right
    inner = (left if math.isfinite(left) else min(0.0, right), right if math.isfinite(right) else max(0.0, left))
    found = [Stretch(_decimal(inner[0]), _decimal(inner[1]), lambda entry: entry)] if inner[0] < inner[1] else []
    for end, at, direction in ((left, inner[0], -1), (right, inner[1], 1)):
        if not math.isfinite(end):
            rate, written = in_exponential(coefficients, direction)
            reach = math.exp(-_at_zero(rate).real * direction * at) * STRETCH_MARGIN
            found.append(Stretch(Fraction(0), Fraction(reach), written))
    return tuple(found)


def has_limits(coefficients: Sequence[Expression], direction: int) -> bool:
    """Whether the coefficients come to finite limits exponentially at the end at infinity in this direction."""
    try:
        _, written = in_exponential(coefficients, direction)
        return all(math.isfinite(abs(_at_zero(written(c)))) for c in coefficients)
    except InputError:
        return False


def _at_zero(expression: Expression) -> complex:
    """An expression where its variable is 0."""
    with np.errstate(all="ignore"):
        return complex(np.ravel(on_arrays(np.array([0.0]), {})(expression))[0])


def _decimal(place: float) -> Fraction:
    """The number that was typed."""
    return Fraction(repr(float(place)))
