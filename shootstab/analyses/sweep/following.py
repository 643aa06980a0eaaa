"""A mode followed along a line of problems: predicted by extrapolation, corrected by Newton, in steps that shrink where they must."""

from __future__ import annotations

import cmath
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

from shootstab.core.discriminant import Discriminant
from shootstab.core.errors import ConvergenceError

CONTRACTION = 0.25  # chosen: ratio of the second Newton step to the first; another zero would be about 1/CONTRACTION times further away
FOLLOWING_SETTLED = 1e-11  # chosen: relative step at which Newton's next one is rounding
FOLLOWING_NOISE = 1e-7  # chosen: relative steps below this need not shrink: they are the noise of D on its mesh
ITERATIONS = 8  # chosen: steps of Newton at most; quadratic convergence from two digits takes three or four
HISTORY = 4  # chosen: points that the extrapolation runs through
MISPREDICTED = 0.5  # chosen: the prediction may be wrong by this part of the way that σ went
STILL_ENOUGH = 0.02  # chosen: it may be wrong by this part of |σ| in any case
DEEPEST_HALVING = 6  # chosen: halvings of a step
ARRIVED, FADED, LOST = "arrived", "faded", "lost"


@dataclass
class FollowedMode:
    """A mode at the places, real or complex, where it is known, in the order in which it was followed."""

    places: list[Any] = field(default_factory=list)
    sigmas: list[complex] = field(default_factory=list)

    def add(self, place: complex, sigma: complex) -> None:
        """Add one more place."""
        self.places.append(place)
        self.sigmas.append(sigma)

    @property
    def last(self) -> complex:
        """σ where the followed has got to."""
        return self.sigmas[-1]

    def predicted(self, place: complex) -> complex:
        """Extrapolation by the polynomial through the last places, at most HISTORY."""
        xs, ys = self.places[-HISTORY:], self.sigmas[-HISTORY:]
        total = 0j
        for i, (x, y) in enumerate(zip(xs, ys, strict=True)):
            weight: complex = 1.0
            for j, other in enumerate(xs):
                if j != i:
                    weight *= (place - other) / (x - other)
            total += weight * y
        return total


def land(discriminant: Discriminant, guess: complex, least: float = 0.0) -> complex | None:
    """The zero that is several times nearer to the guess than any other, by Newton; None if the steps do not shrink as it implies.

    Next to a simple zero with its nearest neighbour at distance d, a step δ is followed by one of about δ²/d. On the left of Re σ = least,
    where D may be singular, it is not evaluated.
    """
    sigma, before = guess, float("inf")
    for _ in range(ITERATIONS):
        if not (cmath.isfinite(sigma) and sigma.real > least):
            return None
        step = discriminant.with_derivative(sigma).newton_step
        sigma += step
        length = abs(step)
        if length <= FOLLOWING_SETTLED * abs(sigma):
            return sigma
        if length > FOLLOWING_NOISE * abs(sigma) and length > CONTRACTION * before:
            return None
        if length <= FOLLOWING_NOISE * abs(sigma) and length > 0.5 * before:
            return sigma
        before = length
    return None


def follow(
    followed: FollowedMode, place: float, at: Callable[[float], Discriminant], deepest: int = DEEPEST_HALVING, least: float = 0.0
) -> str:
    """Follow a mode to a place, in halved steps where the whole one is not safe, and add every place on the way to what is known of it.

    ARRIVED, FADED where its growth rate is about to reach the least one before that place, or LOST where the smallest step is not safe.
    """
    predicted = followed.predicted(place)
    if len(followed.places) > 1 and predicted.real <= least:
        return FADED
    found = _lands(followed, place, predicted, at, least)
    if found is not None:
        followed.add(place, found)
        return ARRIVED
    if deepest == 0:
        return LOST
    middle = (followed.places[-1] + place) / 2
    reached = follow(followed, middle, at, deepest - 1, least)
    return follow(followed, place, at, deepest - 1, least) if reached == ARRIVED else reached


def _lands(followed: FollowedMode, place: float, predicted: complex, at: Callable[[float], Discriminant], least: float) -> complex | None:
    try:
        found = land(at(place), predicted, least)
    except ConvergenceError:  # D cannot be had there: the mode runs into the continuous spectrum
        return None
    if found is None or found.real <= least:
        return None
    if len(followed.places) > 1:
        wrong, way = abs(found - predicted), abs(found - followed.last)
        if wrong > max(MISPREDICTED * way, STILL_ENOUGH * abs(found)):
            return None
    return found
