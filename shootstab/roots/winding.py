"""The argument principle: how many zeros of D a closed curve holds.

The change of ln D between neighbouring samples is known twice: from the two values, up to a multiple of 2πi, and from the exact
logarithmic derivatives at the two ends by the trapezoidal rule. A piece of the curve is accepted when both agree and are short,
and is halved otherwise, so that no turn is missed between samples.
"""

from __future__ import annotations

import cmath
import itertools
import math
from dataclasses import dataclass

from shootstab.discriminants.protocol import Discriminant, Value
from shootstab.vocabulary.errors import ConvergenceError
from shootstab.vocabulary.regions import Region

LONGEST = 1.2  # |Δ ln D| over one piece
MISMATCH = 0.3  # between its two values
DEEPEST = 40  # halvings of one piece
FIRST_PIECES = 8


@dataclass(frozen=True)
class Winding:
    """count zeros inside; closure is the distance of (1/2πi)∮ d ln D, taken from the derivatives alone, to it.

    moment is (1/2πi)∮ (σ − centre) d ln D, the sum of the zeros' distances from centre, the mean of the samples.
    """

    count: int
    closure: float
    centre: complex
    moment: complex
    samples: tuple[Value, ...]


def wind(discriminant: Discriminant, region: Region) -> Winding:
    """Count the zeros inside a region on whose closure D is analytic.

    Raises ConvergenceError when a zero lies on the boundary, or so near to it that no sampling tells the side.
    """
    corners = region.corners
    pieces = FIRST_PIECES if len(corners) == 2 else 2
    stops = [a + (b - a) * i / pieces for a, b in itertools.pairwise(corners) for i in range(pieces)]
    samples = [(t, discriminant.with_slope(region.boundary(t))) for t in stops]
    samples.append((1.0, samples[0][1]))
    followed = [samples[0]]
    for ahead in samples[1:]:
        _follow(discriminant, region, followed, ahead, 0)
    values = [v for _, v in followed]
    turns = sum(_change(a, b).imag for a, b in itertools.pairwise(values)) / (2 * math.pi)
    count = round(turns)
    if abs(turns - count) > 1e-6:
        raise ConvergenceError(f"the phase of D does not close: {turns:.6f} turns")
    centre = sum(v.sigma for v in values[:-1]) / (len(values) - 1)
    total, moment = 0j, 0j
    for a, b in itertools.pairwise(values):
        total += _predicted(a, b)
        moment += 0.5 * (a.sigma + b.sigma - 2 * centre) * _change(a, b)
    closure = abs(total / (2j * math.pi) - count)
    return Winding(count, closure, centre, moment / (2j * math.pi), tuple(values[:-1]))


def _follow(
    discriminant: Discriminant, region: Region, followed: list[tuple[float, Value]], ahead: tuple[float, Value], depth: int
) -> None:
    """Append the samples that lead from the last one to the one ahead."""
    t, value = followed[-1]
    if _settled(value, ahead[1]):
        followed.append(ahead)
        return
    if depth == DEEPEST or value.D.mantissa == 0.0 or ahead[1].D.mantissa == 0.0:
        raise ConvergenceError(f"a zero of D lies on the boundary, or too near to it, at sigma = {value.sigma:.12g}")
    middle = (t + ahead[0]) / 2
    between = (middle, discriminant.with_slope(region.boundary(middle)))
    _follow(discriminant, region, followed, between, depth + 1)
    _follow(discriminant, region, followed, ahead, depth + 1)


def _settled(a: Value, b: Value) -> bool:
    predicted = _predicted(a, b)
    chord = abs(b.sigma - a.sigma)
    steep = max(abs(a.slope), abs(b.slope)) * chord
    return steep < 2 * LONGEST and abs(predicted) < LONGEST and abs(predicted - _change(a, b)) < MISMATCH


def _predicted(a: Value, b: Value) -> complex:
    """∫ d ln D from the derivatives at both ends."""
    return 0.5 * (a.slope + b.slope) * (b.sigma - a.sigma)


def _change(a: Value, b: Value) -> complex:
    """ln D(b) − ln D(a), on the branch nearest to zero."""
    ratio = b.D.mantissa / a.D.mantissa
    if ratio == 0.0 or not cmath.isfinite(ratio):
        return complex("nan")
    return cmath.log(ratio) + (b.D.log_scale - a.D.log_scale)
