"""Combination of the stages of a Runge–Kutta step with real weights, which all transports have in common."""

from __future__ import annotations

import numpy as np
from numba import njit


@njit(cache=True, error_model="numpy", fastmath={"contract"}, inline="always")
def combine(y, base, K, weights, row, count, out, place):  # type: ignore[no-untyped-def]
    """out[place] = y[base] + Σ_j weights[row, j] K_j over the first count stages, all as real numbers: y, out (·, p), K (STAGES, p)."""
    for p in range(y.shape[1]):
        out[place, p] = y[base, p]
    for j in range(count):
        w = weights[row, j]
        if w != 0.0:
            for p in range(y.shape[1]):
                out[place, p] += w * K[j, p]


@njit(cache=True, error_model="numpy")
def reals(a):  # type: ignore[no-untyped-def]
    """The real numbers in a contiguous array, real and imaginary parts in turn: a view (1, p)."""
    return a.reshape(1, -1).view(np.float64)
