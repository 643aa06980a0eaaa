"""Newton's and Muller's iterations on D(σ). They find; they prove nothing: a proof is a count (see winding.py)."""

from __future__ import annotations

import cmath
import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import NamedTuple

from shootstab.core.allowed import LARGEST_GUESS
from shootstab.core.discriminant import Discriminant, Value
from shootstab.core.scaled import Scaled

SHRINKS = 0.1  # chosen: steps that shrink by so much are near enough to a simple zero for the curvature of σ(D) to be used
FORESIGHT = 0.1  # chosen: the part of the tolerance that the step foreseen may be
STEP_NOISE = 1e-6  # chosen, far above the 1e-13 of D and D′: see `_run`
LEAST_D_ERROR = 1e-14  # chosen: the least error of D against D one step away; by its m-th root an m-fold zero is off
SAME_MULTIPLICITY = 0.1  # chosen: two estimates of a multiplicity that differ by less are the same
MOST_FOLD = 8  # chosen: the largest multiplicity that an iteration suspects; 1/(1 − q) of the next ones differ too little
MOST_NEWTONS = 40  # chosen: steps of Newton at most
MOST_MULLERS = 60  # chosen: those of Muller, whose order is 1.84
FIRST_SPREAD = 1e-3  # chosen: distance of the first three points of Muller, in the guess


@dataclass(frozen=True)
class Root:
    """Where an iteration stopped.

    step is the length of the last step, or of the next one, foreseen; converged says whether that met the tolerance or the noise of D was
    reached. multiplicity above 1 is what the steps looked like: it is to be counted. passed are the σ at which steps began.
    """

    sigma: complex
    step: float
    iterations: int
    converged: bool
    multiplicity: int = 1
    passed: tuple[complex, ...] = ()


class Step(NamedTuple):
    """Where a step began, the iterate that it led to and the step itself; the length foreseen of the next one; how much the slope of D
    changed, relatively, over the last one; how often a zero as multiple as the steps look counts."""

    start: complex
    sigma: complex
    step: complex
    ahead: float
    change: float
    multiplicity: int = 1


def newton(discriminant: Discriminant, guess: complex, tolerance: float, most: int = MOST_NEWTONS) -> Root:
    """Newton's iteration with the exact derivative, each step improved by what the last two D and D′ tell of the curvature of σ(D).

    It ends where the next step would be below tolerance·|σ|, or in the noise of D. Far from a zero the steps are −D/D′; where they
    shrink, the zero is taken of Hermite's cubic through both points: order 1 + √3 for a simple zero, at no evaluation more. Next to an
    m-fold zero they shrink by 1 − 1/m from one to the next; where they have done so twice, −m D/D′ is quadratic again.
    """
    return _run(newton_steps(discriminant, complex(guess)), tolerance, most)


def muller(discriminant: Discriminant, guess: complex, tolerance: float, most: int = MOST_MULLERS) -> Root:
    """Muller's iteration: the nearer zero of the parabola through the last three values. Needs no derivative."""
    return _run(_muller_steps(discriminant, complex(guess)), tolerance, most)


def _run(steps: Iterator[Step], tolerance: float, most: int) -> Root:
    """Follow the steps until one is short enough, an iterate no number or larger than a guess may be, or there were too many.

    Steps that no longer shrink are the noise of D, and the iteration has arrived as exactly as the step says, where they are short against
    the way to where they were shortest, or where D has one slope over a step: then the step to the zero would be the last one. Both hold at
    σ = 0 too. Next to a multiple zero noise throws an iterate anywhere: there the one before is kept.
    """
    best, way, farthest, before, fold = float("inf"), 0.0, 0.0, complex("nan"), 1  # way: how far the iteration had come at its best step
    passed: list[complex] = []
    for count in range(1, most + 1):
        start, sigma, step, ahead, change, multiplicity = next(steps)
        passed.append(start)
        length = math.hypot(step.real, step.imag)
        if multiplicity == fold > 1 and not length < 0.5 * best:
            return Root(before, max(best, LEAST_D_ERROR ** (1 / multiplicity) * farthest), count, True, multiplicity)
        if not math.hypot(sigma.real, sigma.imag) <= LARGEST_GUESS:
            return Root(sigma, float("inf"), count, False)
        short = best <= STEP_NOISE * way or change <= STEP_NOISE
        if length <= tolerance * abs(sigma) or (short and length >= 0.5 * best):
            return Root(sigma, length, count, True, multiplicity, tuple(passed))
        if ahead <= FORESIGHT * tolerance * abs(sigma):
            return Root(sigma, ahead, count, True, multiplicity, tuple(passed))
        farthest, before, fold = max(farthest, length), sigma, multiplicity
        if length < best:
            best, way = length, max(abs(sigma), farthest)
    return Root(sigma, length, most, False)


def newton_steps(discriminant: Discriminant, sigma: complex) -> Iterator[Step]:
    """The steps of `newton`, without end."""
    before: Value | None = None
    step_before, estimate, multiplicity = 0j, complex("nan"), 1
    while True:
        value = discriminant.with_derivative(sigma)
        step, ahead, change = multiplicity * value.newton_step, float("inf"), float("inf")
        if before is not None:
            change = slope_change(before, value)
        if before is not None and multiplicity == 1 and abs(step) < abs(step_before):
            if abs(step) < SHRINKS * abs(step_before):
                curved = _curvature(before, value)
                # errors e₀, e₁ and the curvature c = e₁/e₀² make curved c e₁²; it leaves about c³ e₀² e₁², that is curved (e₁/e₀)²
                if abs(curved) < SHRINKS * abs(step):
                    step, ahead = step + curved, abs(curved) * abs(step / step_before) ** 2
            estimate_before, estimate = estimate, step_before / (step_before - step)
            fold = round(min(estimate.real, MOST_FOLD + 1.0)) if cmath.isfinite(estimate) else 0
            if 2 <= fold <= MOST_FOLD and abs(estimate - fold) < SAME_MULTIPLICITY and abs(estimate_before - fold) < SAME_MULTIPLICITY:
                multiplicity, step = fold, fold * step
        before, step_before = value, step
        start, sigma = sigma, sigma + step
        yield Step(start, sigma, step, ahead, change, multiplicity)


def slope_change(a: Value, b: Value) -> float:
    """|D′(b)/D′(a) − 1|: twice the curvature |D″/(2D′)| times the distance, for near points; infinite where D′(a) vanishes."""
    slope = Scaled(a.dD, a.D.log_scale).at_scale(b.D.log_scale)
    return abs(b.dD / slope - 1.0) if slope != 0.0 else float("inf")


def _curvature(a: Value, b: Value) -> complex:
    """What Hermite's cubic σ(D) through (D, D′) at a and at b, taken at D = 0, adds to Newton's step at b; NaN where it is not defined."""
    A, B, dA = a.D.at_scale(b.D.log_scale), b.D.mantissa, Scaled(a.dD, a.D.log_scale).at_scale(b.D.log_scale)
    if 0.0 in (dA, b.dD, A - B):
        return complex("nan")
    chord = (a.sigma - b.sigma) / (A - B)
    second = (chord - 1 / b.dD) / (A - B)
    third = ((1 / dA - chord) / (A - B) - second) / (A - B)
    return B * B * (second - third * A)


def _muller_steps(discriminant: Discriminant, guess: complex) -> Iterator[Step]:
    spread = FIRST_SPREAD * (abs(guess) or 1.0)
    points = [guess - spread, guess + spread * 1j, guess]
    values: list[Scaled] = [discriminant(p) for p in points]
    while True:
        a, b, c = points
        scale = max(v.log_scale for v in values)
        fa, fb, fc = (v.at_scale(scale) for v in values)
        first, second = (fb - fa) / (b - a), (fc - fb) / (c - b)
        curvature = (second - first) / (c - a)
        slope = second + curvature * (c - b)
        root = cmath.sqrt(slope * slope - 4 * curvature * fc)
        denominator = slope + root if abs(slope + root) > abs(slope - root) else slope - root
        step = -2 * fc / denominator if denominator != 0.0 else (0j if fc == 0.0 else complex("inf"))
        new = c + step
        change = abs(curvature * step / slope) if slope != 0.0 else float("inf")
        yield Step(c, new, step, float("inf"), change)
        if step == 0.0 or not cmath.isfinite(new):
            while True:
                yield Step(c, new, step, float("inf"), change)
        points, values = [b, c, new], [values[1], values[2], discriminant(new)]
