"""Newton and Muller iterations on D(σ). They find; they prove nothing: a proof is a count (see winding.py)."""

from __future__ import annotations

import cmath
from collections.abc import Iterator
from dataclasses import dataclass

from shootstab.discriminants.protocol import Discriminant
from shootstab.vocabulary.scaled import Scaled

SHRINKS = 0.1  # from step to step, where Newton is taken to be quadratic
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
    """Newton's iteration σ ← σ − 1/(d ln D/dσ), with the exact derivative, until the next step would be below tolerance·|σ|.

    Next to a simple zero steps δ shrink as δ_{k+1} = c δ_k², so the next one is foreseen from the last two.
    """
    return _run(_newton_steps(discriminant, complex(guess)), tolerance, most, quadratic=True)


def muller(discriminant: Discriminant, guess: complex, tolerance: float, most: int = 60) -> Root:
    """Muller's iteration: the nearer zero of the parabola through the last three values. Needs no derivative."""
    return _run(_muller_steps(discriminant, complex(guess)), tolerance, most)


def _run(steps: Iterator[tuple[complex, complex]], tolerance: float, most: int, quadratic: bool = False) -> Root:
    """Follow (iterate, step) pairs until a step is short enough, no longer a number, or there were too many.

    Steps that are short and no longer shrink are the noise of D: the iteration has arrived, and the step says how exactly.
    """
    best = before = float("inf")
    for count in range(1, most + 1):
        sigma, step = next(steps)
        length = abs(step)
        if not cmath.isfinite(sigma):
            return Root(sigma, float("inf"), count, False)
        if length <= tolerance * abs(sigma) or (best <= NOISE * abs(sigma) and length >= 0.5 * best):
            return Root(sigma, length, count, True)
        ahead = length * (length / before) ** 2
        if quadratic and length < SHRINKS * before < float("inf") and ahead <= FORESIGHT * tolerance * abs(sigma):
            return Root(sigma, ahead, count, True)
        best, before = min(best, length), length
    return Root(sigma, length, most, False)


def _newton_steps(discriminant: Discriminant, sigma: complex) -> Iterator[tuple[complex, complex]]:
    while True:
        step = discriminant.with_slope(sigma).newton_step
        sigma += step
        yield sigma, step


def _muller_steps(discriminant: Discriminant, guess: complex) -> Iterator[tuple[complex, complex]]:
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
        yield new, step
        if step == 0.0 or not cmath.isfinite(new):
            while True:
                yield new, step
        points, values = [b, c, new], [values[1], values[2], discriminant(new)]
