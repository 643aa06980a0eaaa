"""Numbers that a user gives, and the sentences that refuse what is none or lies outside what is allowed.

Text, True and False are no numbers, and neither is an integer that no double can hold.
"""

from __future__ import annotations

import cmath
import math
from collections.abc import Callable
from numbers import Complex, Integral, Real
from typing import Any

from shootstab.core.allowed import LARGEST_FLOOR
from shootstab.core.errors import InputError, shortened


def is_real(value: Any) -> bool:
    """Whether this is one finite real number, NumPy's and mpmath's among them."""
    try:
        return isinstance(value, Real) and not isinstance(value, bool) and math.isfinite(value)
    except OverflowError:
        return False


def require_real(name: str, value: Any, holds: Callable[[float], bool], allowed: str) -> None:
    """Raise InputError with the name, the value and what is allowed, unless it is a finite real number of which `holds` is true."""
    if not (is_real(value) and holds(value)):
        raise InputError(f"{name} = {shortened(value)}: allowed is {allowed}")


def require_whole(name: str, value: Any, least: int, most: int | None = None) -> None:
    """Raise InputError unless the value is an integer from least to most, or from least on."""
    top = math.inf if most is None else most
    if not (isinstance(value, Integral) and not isinstance(value, bool) and least <= int(value) <= top):
        raise InputError(f"{name} = {shortened(value)}: allowed is {least} {'or more' if most is None else f'to {most}'}")


def require_rtol(rtol: Any, least: float) -> None:
    """Raise InputError unless a relative accuracy is at least so large, and below 1."""
    require_real("rtol", rtol, lambda r: least <= r < 1.0, f"a number from {least:g} to 1")


def is_complex(value: Any) -> bool:
    """Whether this is one finite number, real or complex."""
    try:
        return isinstance(value, Complex) and not isinstance(value, bool) and cmath.isfinite(value)
    except OverflowError:
        return False


def require_above_0(name: str, value: Any) -> None:
    """Raise InputError unless the value is a finite real number above 0."""
    require_real(name, value, lambda x: x > 0.0, "a finite number above 0")


def require_floor(floor: Any) -> None:
    """Raise InputError unless modes may be counted above this growth rate."""
    require_real("floor", floor, lambda f: 0.0 < f < LARGEST_FLOOR, f"a number above 0 and below {LARGEST_FLOOR:g}")


def complex_of(name: str, value: Any) -> complex:
    """The value as a complex number. Raises InputError where it is none, or not finite."""
    try:
        number = complex(math.nan if isinstance(value, str | bool) else value)
    except (TypeError, ValueError, OverflowError):
        number = complex(math.nan)
    if not cmath.isfinite(number):
        raise InputError(f"{name} = {shortened(value)}: allowed is a finite number")
    return number
