"""Newton and Muller iterations on D(σ). They find; they prove nothing: a proof is a count (see winding.py)."""

from __future__ import annotations

import cmath
from collections.abc import Iterator
from dataclasses import dataclass

from shootstab.core.discriminant import Discriminant, Value
from shootstab.core.scaled import Scaled

SHRINKS = 0.1  # from step to step, near enough to a simple zero for its curvature to be used
FORESIGHT = 0.1  # of the tolerance, what the step foreseen may be
NOISE = 1e-6  # relative steps below this that stop shrinking have reached the noise of D


@dataclass(frozen=True)
class Root:
    """Where an iteration stopped: sigma, the length of its last step (or of the next one, foreseen), and whether that met the tolerance."""

    sigma: complex
    step: float
    iterations: int
    converged: bool


def newton(discriminant: Discriminant, guess: complex, tolerance: float, most: int = 40) -> Root:
    """Newton's iteration with the exact derivative, each step improved by what the last two D and D′ tell of the curvature of σ(D).

    It ends where the next step would be below tolerance·|σ|. Far from a zero the steps are −D/D′; where they shrink, the zero is taken
    of Hermite's cubic through both points: order 1 + √3 for a simple zero, at no evaluation more.
    """
    return _run(_newton_steps(discriminant, complex(guess)), tolerance, most)


def muller(discriminant: Discriminant, guess: complex, tolerance: float, most: int = 60) -> Root:
    """Muller's iteration: the nearer zero of the parabola through the last three values. Needs no derivative."""
    return _run(_muller_steps(discriminant, complex(guess)), tolerance, most)


def _run(steps: Iterator[tuple[complex, complex, float]], tolerance: float, most: int) -> Root:
    """Follow (iterate, step, length foreseen of the next step) until one is short enough, no longer a number, or there were too many.

    Steps that are short and no longer shrink are the noise of D: the iteration has arrived, and the step says how exactly.
    """
    best = float("inf")
    for count in range(1, most + 1):
        sigma, step, ahead = next(steps)
        length = abs(step)
        if not cmath.isfinite(sigma):
            return Root(sigma, float("inf"), count, False)
        if length <= tolerance * abs(sigma) or (best <= NOISE * abs(sigma) and length >= 0.5 * best):
            return Root(sigma, length, count, True)
        if ahead <= FORESIGHT * tolerance * abs(sigma):
            return Root(sigma, ahead, count, True)
        best = min(best, length)
    return Root(sigma, length, most, False)


def _newton_steps(discriminant: Discriminant, sigma: complex) -> Iterator[tuple[complex, complex, float]]:
    before: Value | None = None
    step_before = 0j
    while True:
        value = discriminant.with_derivative(sigma)
        step, ahead = value.newton_step, float("inf")
        if before is not None and abs(step) < SHRINKS * abs(step_before):
            bend = _curvature(before, value)
            # with e the errors of both points, bend is of size e₁² and what it leaves of size e₀² e₁², times e₁/e₀² to make it one of those
            if abs(bend) < SHRINKS * abs(step):
                step, ahead = step + bend, abs(bend) * abs(step / step_before) ** 2
        before, step_before = value, step
        sigma += step
        yield sigma, step, ahead


def _curvature(a: Value, b: Value) -> complex:
    """What Hermite's cubic σ(D) through (D, D′) at a and at b, taken at D = 0, adds to Newton's step at b; NaN where it is not defined."""
    A, B, dA = a.D.at_scale(b.D.log_scale), b.D.mantissa, Scaled(a.dD, a.D.log_scale).at_scale(b.D.log_scale)
    if 0.0 in (dA, b.dD, A - B):
        return complex("nan")
    chord = (a.sigma - b.sigma) / (A - B)
    second = (chord - 1 / b.dD) / (A - B)
    third = ((1 / dA - chord) / (A - B) - second) / (A - B)
    return B * B * (second - third * A)


def _muller_steps(discriminant: Discriminant, guess: complex) -> Iterator[tuple[complex, complex, float]]:
    spread = 1e-3 * (abs(guess) or 1.0)
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
        yield new, step, float("inf")
        if step == 0.0 or not cmath.isfinite(new):
            while True:
                yield new, step, float("inf")
        points, values = [b, c, new], [values[1], values[2], discriminant(new)]
