"""The argument principle: how many zeros of D a closed curve holds.

The change of ln D between neighbouring samples is known twice: from the two values, up to a multiple of 2πi, and from the exact
logarithmic derivatives at the two ends by the trapezoidal rule. A segment of the curve is accepted when both agree and are short,
and is halved otherwise, so that no turn is missed between samples.
"""

from __future__ import annotations

import cmath
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from shootstab.core.discriminant import Discriminant, Value
from shootstab.core.errors import ConvergenceError, Inaccurate
from shootstab.core.regions import Disc, Region
from shootstab.core.scaled import Scaled

LONGEST_TURN = 1.2  # chosen, far below π: |Δ ln D| over one segment
MISMATCH = 0.3  # chosen: the most by which Δ ln D may miss what the slopes at both ends predict
FLAT_SEGMENT = 1e-2  # chosen: |Δ ln D| by the slopes at both ends: a zero that the slopes do not see would be a hundred segments away
DEEPEST_SEGMENT = 40  # chosen: halvings of one segment
WELL_INSIDE = 0.75  # chosen: the part of a disc's radius within which a zero may be divided out: what it leaves is flat on the circle
FLAT_ACROSS = 0.1  # chosen: |d ln Q/dσ| in diameters at two opposite points of a circle: a tenth of the 1 that a zero inside makes of it
FLAT_SEGMENTS = 3  # chosen: segments of a circle on which D without its zero is flat; the slopes at their ends say whether it is
FIRST_SEGMENTS = 4  # chosen: segments of a circle or of the side of a polygon, before any is halved
TURN_SLACK = 1e-6  # chosen: part of a turn by which a sum of phases may miss a whole number, from rounding

Legs = tuple[tuple[int, tuple[Value, ...]], ...]  # the sides of a contour: samples, and the sign with which they count


@dataclass(frozen=True)
class Winding:
    """count zeros inside; closure is the distance of (1/2πi)∮ d ln D, taken from the derivatives alone, to it."""

    count: int
    closure: float
    samples: tuple[Value, ...]

    @property
    def legs(self) -> Legs:
        """The closed curve as one leg."""
        return ((1, (*self.samples, self.samples[0])),)


@dataclass(frozen=True)
class Limited:
    """A discriminant that may be asked so often and no more: on a circle where it is all noise a contour would never be fine enough."""

    discriminant: Discriminant
    last: int

    @property
    def evaluations(self) -> int:
        return self.discriminant.evaluations

    def __call__(self, sigma: complex) -> Scaled:
        return self.with_derivative(sigma).D

    def with_derivative(self, sigma: complex) -> Value:
        """D and D′ at sigma. Raises ConvergenceError beyond the limit."""
        if self.discriminant.evaluations > self.last:
            raise ConvergenceError("D is noise along the contour")
        return self.discriminant.with_derivative(sigma)


@dataclass(frozen=True)
class Deflated:
    """D(σ)/(σ − zero). Inside a curve around the zero it has one zero less than D, and −1 if D has none there: a pole.

    Where the zero is one of D, and others are far, the quotient is flat along the curve, and few samples tell its turns.
    """

    discriminant: Discriminant
    zero: complex

    @property
    def evaluations(self) -> int:
        return self.discriminant.evaluations

    def __call__(self, sigma: complex) -> Scaled:
        D = self.discriminant(sigma)
        return Scaled(D.mantissa / (sigma - self.zero), D.log_scale)

    def with_derivative(self, sigma: complex) -> Value:
        value, off = self.discriminant.with_derivative(sigma), sigma - self.zero
        quotient = value.D.mantissa / off
        return Value(sigma, Scaled(quotient, value.D.log_scale), (value.dD - quotient) / off)


def wind(discriminant: Discriminant, region: Region, segments: int = FIRST_SEGMENTS) -> Winding:
    """Count the zeros inside a region on whose closure D is analytic; a smooth boundary is first cut into so many segments.

    Raises ConvergenceError when a zero lies on the boundary, or so near to it that no sampling tells the side, and its kind Inaccurate
    where D is no smooth function along it.
    """
    values = follow(lambda t: discriminant.with_derivative(region.boundary(t)), region.corners, True, segments)
    count = whole_turns(sum(change(a, b).imag for a, b in pairwise(values)))
    total = sum(_predicted(a, b) for a, b in pairwise(values))
    return Winding(count, abs(total / (2j * math.pi) - count), tuple(values[:-1]))


def count_around(discriminant: Discriminant, disc: Disc, zero: complex) -> int:
    """The zeros in a disc, of which one is taken to lie well inside: it is divided out, and counted where there is one.

    Of a quotient Q with n zeros inside, Re[(σ − c) Q′/Q] on the circle is n/2 at least, but for what lies outside: Re 1/(1 − w) ≥ 1/2 where
    |w| ≤ 1. Where Q is flat against that at two opposite points, and the same at both, it has none. Otherwise its turns are counted. Raises
    as `wind` does.
    """
    if not abs(zero - disc.centre) < WELL_INSIDE * disc.radius:
        return wind(discriminant, disc).count
    quotient = Deflated(discriminant, zero)
    a, b = (quotient.with_derivative(disc.centre + r) for r in (disc.radius, -disc.radius))  # a real D stays real at these
    flat = max(abs(v.logarithmic_derivative) for v in (a, b)) * 2.0 * disc.radius < FLAT_ACROSS and abs(change(a, b)) < FLAT_ACROSS
    return 1 if flat else 1 + wind(quotient, disc, FLAT_SEGMENTS).count


def power_sums(legs: Legs, centre: complex, scale: float, most: int) -> NDArray[np.complex128]:
    """s_k = Σ ((z − centre)/scale)^k over the zeros z inside, (most + 1,): (1/2πi)∮ ((σ − centre)/scale)^k d ln D.

    Between two samples ln D is the cubic with its values and derivatives at both ends, and σ runs straight; that is integrated exactly.
    """
    sums = np.zeros(most + 1, dtype=np.complex128)
    nodes, weights = np.polynomial.legendre.leggauss(2 + most // 2)
    t = 0.5 + 0.5 * nodes
    for sign, values in legs:
        sigma = np.array([v.sigma for v in values])
        h = np.diff(sigma)
        slope = np.array([v.logarithmic_derivative for v in values])
        gain = np.array([change(a, b) for a, b in pairwise(values)])
        first, last = (slope[:-1] * h)[:, None], (slope[1:] * h)[:, None]
        rate = first * (1 - 4 * t + 3 * t * t) + last * (3 * t * t - 2 * t) + gain[:, None] * (6 * t * (1 - t))
        place = (sigma[:-1, None] + h[:, None] * t - centre) / scale
        for k in range(most + 1):
            sums[k] += sign * np.sum(rate * place**k @ (0.5 * weights))
    return sums / (2j * math.pi)


def whole_turns(phase: float, slack: float = TURN_SLACK) -> int:
    """The change of phase around closed curves as a number of turns.

    Raises ConvergenceError if it is not a whole one to the slack.
    """
    turns = phase / (2 * math.pi)
    if not abs(turns - round(turns)) <= slack:
        raise ConvergenceError(f"the phase of D does not close: {turns:.6f} turns")
    return round(turns)


def follow(
    evaluate: Callable[[float], Value], stops: Sequence[float], closed: bool = False, first_segments: int = FIRST_SEGMENTS
) -> list[Value]:
    """Samples of D along a curve t ↦ σ(t), from the first stop to the last, so dense that no turn of the phase is missed.

    The stops are those t at which the curve is not smooth, its ends included. On a closed curve the first sample serves as the last.
    """
    segments = first_segments if len(stops) == 2 else 2
    ts = [a + (b - a) * i / segments for a, b in pairwise(stops) for i in range(segments)]
    samples = [(t, evaluate(t)) for t in ts]
    samples.append((stops[-1], samples[0][1] if closed else evaluate(stops[-1])))
    followed = [samples[0]]
    for ahead in samples[1:]:
        _follow(evaluate, followed, ahead, 0)
    return [v for _, v in followed]


def _follow(evaluate: Callable[[float], Value], followed: list[tuple[float, Value]], ahead: tuple[float, Value], depth: int) -> None:
    """Append the samples that lead from the last one to the one ahead."""
    t, value = followed[-1]
    if _settled(value, ahead[1]):
        followed.append(ahead)
        return
    if depth == DEEPEST_SEGMENT or value.D.mantissa == 0.0 or ahead[1].D.mantissa == 0.0:
        raise ConvergenceError(f"a zero of D lies on the boundary, or too near to it, at sigma = {value.sigma:.12g}")
    if _noisy(value, ahead[1]):
        where = f"near sigma = {value.sigma:.12g}"
        raise Inaccurate(f"D is not known well enough along the boundary: {where} it jumps, by rounding or from one mesh to the next")
    middle = (t + ahead[0]) / 2
    between = (middle, evaluate(middle))
    _follow(evaluate, followed, between, depth + 1)
    _follow(evaluate, followed, ahead, depth + 1)


def _settled(a: Value, b: Value) -> bool:
    predicted = _predicted(a, b)
    chord = abs(b.sigma - a.sigma)
    steep = max(abs(a.logarithmic_derivative), abs(b.logarithmic_derivative)) * chord
    return steep < 2 * LONGEST_TURN and abs(predicted) < LONGEST_TURN and abs(predicted - change(a, b)) < MISMATCH


def _noisy(a: Value, b: Value) -> bool:
    """Whether D changes by MISMATCH where its slopes say that it is FLAT_SEGMENT: halving a segment of that would never end."""
    steep = max(abs(a.logarithmic_derivative), abs(b.logarithmic_derivative)) * abs(b.sigma - a.sigma)
    return steep < FLAT_SEGMENT and not abs(change(a, b)) < MISMATCH


def _predicted(a: Value, b: Value) -> complex:
    """∫ d ln D from the derivatives at both ends."""
    return 0.5 * (a.logarithmic_derivative + b.logarithmic_derivative) * (b.sigma - a.sigma)


def change(a: Value, b: Value) -> complex:
    """ln D(b) − ln D(a), on the branch nearest to zero."""
    ratio = b.D.mantissa / a.D.mantissa
    if ratio == 0.0 or not cmath.isfinite(ratio):
        return complex("nan")
    return cmath.log(ratio) + (b.D.log_scale - a.D.log_scale)
