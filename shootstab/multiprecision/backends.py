"""The library that does the arithmetic: python-flint where it is installed, mpmath everywhere."""

from __future__ import annotations

import importlib.util

from shootstab.core.errors import InputError
from shootstab.multiprecision.arithmetic import Arithmetic


def choose(name: str | None = None) -> Arithmetic:
    """The arithmetic called 'flint' or 'mpmath'; without a name python-flint where it is installed, else mpmath."""
    if name not in (None, "flint", "mpmath"):
        raise InputError(f"arithmetic = {name!r}: allowed is flint or mpmath")
    installed = importlib.util.find_spec("flint") is not None
    if name == "flint" and not installed:
        raise InputError("arithmetic = 'flint': python-flint is not installed (pip install 'shootstab[precise]'): allowed is mpmath")
    if installed and name != "mpmath":
        from shootstab.multiprecision.flint_backend import FlintArithmetic

        return FlintArithmetic()
    from shootstab.multiprecision.mpmath_backend import MpmathArithmetic

    return MpmathArithmetic()
