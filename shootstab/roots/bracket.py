"""A zero of a real function between two points where it has different signs."""

from __future__ import annotations

from collections.abc import Callable

CLOSED_BRACKET = 1e-15  # chosen: width against the larger end, or absolutely next to 0; a few units in the last place
MOST_FALSE_POSITIONS = 200  # chosen: more than are ever needed; every third halves the interval where two others did not


def zero_between(f: Callable[[float], float], low: float, high: float) -> float:
    """The zero by false position with the weight of an end halved that stays (Illinois), and by bisection where that gains too little.

    Raises ValueError where the signs at the ends are alike.
    """
    f_low, f_high = f(low), f(high)
    if f_low == 0.0:
        return low
    if f_low * f_high > 0.0:
        raise ValueError(f"no change of sign between {low!r} and {high!r}")
    width = abs(high - low)
    for turn in range(MOST_FALSE_POSITIONS):
        if f_high == 0.0 or abs(high - low) <= CLOSED_BRACKET * max(1.0, abs(high)):
            break
        x = high - f_high * (high - low) / (f_high - f_low)
        if turn % 3 == 2:
            if abs(high - low) > 0.5 * width:
                x = 0.5 * (low + high)
            width = abs(high - low)
        value = f(x)
        if value * f_high < 0.0:
            low, f_low = high, f_high
        else:
            f_low *= 0.5
        high, f_high = x, value
    return high
