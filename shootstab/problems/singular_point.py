"""Points inside at which C is singular whatever σ is: the system is no regular one there, and its samples next to it are rounding."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from shootstab.core import polynomial
from shootstab.core.errors import InputError
from shootstab.problems.pencil_function import PencilFunction

POINT_PROBES = 65  # chosen: points of a line at which the sign of det C is looked at
REAL_SIGMAS = (0.83, -1.17)  # chosen: two real σ of no property, in the scale that the sizes of C0, C1, … give
HALVINGS_TO_POINT = 30  # chosen: halvings of the step between two probes, to nine digits
ONE_PLACE = 1e-6  # chosen: two zeros of det C nearer to each other than this part of the step between probes are one, whatever σ is


def require_regular(function: PencilFunction, line: NDArray[np.complexfloating]) -> None:
    """Raise InputError where det C changes its sign between points of a line (m,) for one σ and another: a zero that σ does not move.

    A complex C has such zeros at complex points only, unless it was made so, and is not looked at.
    """
    z = np.asarray(line[:: max(1, len(line) // POINT_PROBES)], dtype=np.complex128)
    C = function(z).C
    if any(M.imag.any() for M in C) or z.imag.any():
        return
    size = polynomial.size_of_root([float(np.abs(M).max()) for M in C])
    changes = [_signs(function, z, size * sigma) for sigma in REAL_SIGMAS]
    for i in np.flatnonzero((np.diff(changes[0]) != 0) & (np.diff(changes[1]) != 0)):
        places = [_zero(function, z[i].real, z[i + 1].real, size * sigma) for sigma in REAL_SIGMAS]
        if abs(places[0] - places[1]) <= ONE_PLACE * abs(z[i + 1] - z[i]):
            raise InputError(
                f"C is singular at z = {places[0]:.6g}, whatever sigma is: allowed is a C that is regular between the ends, with equations "
                "divided by what vanishes in all their terms there, or an end of the interval at that point"
            )


def _signs(function: PencilFunction, z: NDArray[np.complex128], sigma: float) -> NDArray[np.float64]:
    """The sign (m,) of det C(σ) at points (m,)."""
    return np.asarray(np.linalg.slogdet(polynomial.value(function(z).C, sigma).real)[0])


def _zero(function: PencilFunction, low: float, high: float, sigma: float) -> float:
    """Where det C(σ) changes its sign between two points, by halving."""
    first = _signs(function, np.array([low + 0j]), sigma)[0]
    for _ in range(HALVINGS_TO_POINT):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if _signs(function, np.array([middle + 0j]), sigma)[0] == first else (low, middle)
    return low
