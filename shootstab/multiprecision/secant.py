"""Secants from one precision to the next: a zero, the slope of F there, and a measure of how far off both may be.

With K = |F″/(2F′)| and the slope of F known at the place m, the step from x to x − F(x)/slope ends 2K |m − (x + x_new)/2| |step| from the
zero: a secant has its slope in the middle of its two points. K comes from two slopes at two places. Slopes, places and K outlive a
precision; so nothing has to be evaluated once more only to see that it is done.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import mpmath

from shootstab.core.errors import ConvergenceError

SECANT_STEPS = 10  # chosen: most secants; each multiplies the digits by 1.6 or more, and the next precision has 2.7 times as many
Values = tuple[Any, ...]  # F and, if wanted, more functions of x: mpmath numbers


@dataclass(frozen=True)
class Slope:
    """Divided differences of the functions, the middle of the two points, and what noise may have done to that of F, relatively."""

    rates: Values
    middle: Any
    noise: Any


class Secant:
    """The zero x of F, as mpmath numbers; better with every `settle`.

    scale is what errors are relative to where x is smaller, as at a zero at 0. error bounds |x − zero| by the theory of secants. others
    are the values at x of the functions that come along with F. last is where F was evaluated at last, and what came out.
    """

    def __init__(self, x: Any, scale: float = 0.0) -> None:
        self.x, self.scale = x, scale
        self.error: Any = mpmath.inf
        self.others: Values = ()
        self.last: tuple[Any, Values] = (x, ())
        self._slope: Slope | None = None
        self._curvature: Any = None

    @property
    def slopes(self) -> Values:
        """The derivatives of F and of the functions that come along."""
        assert self._slope is not None
        return self._slope.rates

    @property
    def slope(self) -> Any:
        """F′."""
        return self.slopes[0]

    def settle(self, functions: Callable[[Any], Values], digits: float, least: int = 1) -> None:
        """Go on until the error is below 10^−digits |x|, or of the scale; at least so many times. F is as good as so many digits of it.

        Raises ConvergenceError if it never is.
        """
        x = self.x
        before: tuple[Any, Values] | None = None
        goal = mpmath.mpf(10) ** -digits
        for count in range(1, SECANT_STEPS + 1):
            values = functions(x)
            if self._slope is None and before is None:
                aside = x + (x if abs(x) >= self.scale else self.scale) * mpmath.mpf(10) ** -round(digits / 2)
                before = aside, functions(aside)
            if before is not None and before[0] != x:
                self._learn(before, (x, values), goal)
            assert self._slope is not None
            step = values[0] / self._slope.rates[0]
            before, x = (x, values), x - step
            error = abs(step) * self._off(self._slope, before[0] - step / 2)
            if count >= least and error <= goal * self._size(x):
                self.x, self.error, self.last = x, error, before
                self.others = tuple(v - r * step for v, r in zip(values[1:], self._slope.rates[1:], strict=True))
                return
        raise ConvergenceError(f"the secants do not settle to {digits:.0f} digits")

    def _size(self, x: Any) -> Any:
        return max(abs(x), self.scale)

    def _off(self, slope: Slope, place: Any) -> Any:
        """The relative error of a slope used at a place; as long as nothing is known of K, it is 1/|x|, or one over the scale."""
        curvature = 1 / self._size(self.x) if self._curvature is None else self._curvature
        return 2 * curvature * abs(slope.middle - place) + slope.noise

    def _learn(self, one: tuple[Any, Values], other: tuple[Any, Values], goal: Any) -> None:
        """The slope between two points, if it is better than the one known."""
        gap = other[0] - one[0]
        rates = tuple((b - a) / gap for a, b in zip(one[1], other[1], strict=True))
        new = Slope(rates, (one[0] + other[0]) / 2, goal * self._size(self.x) / abs(gap))
        old = self._slope
        if old is not None and old.middle != new.middle and new.noise < 1:
            self._curvature = abs(new.rates[0] - old.rates[0]) / (2 * abs(new.rates[0]) * abs(new.middle - old.middle))
        if old is None or self._off(new, other[0]) < self._off(old, other[0]):
            self._slope = new
