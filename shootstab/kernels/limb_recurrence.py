"""A linear recurrence of power series in fixed point (kernels.limbs): Y_m = left (Σ_j E_j Y_{m−1−j}/m − Σ_j F_j Y_{m−1−j}).

Everything is real: the columns of Y (n, c) are those of Re Y, and where anything is complex those of Im Y behind them.
"""

from __future__ import annotations

import numpy as np
from numba import njit

from shootstab.kernels.limbs import LIMB_MARGIN, add_convolution, add_number, add_product, divide, store


@njit(cache=True, error_model="numpy")
def recur(entries, A, ends_A, exponents_A, places, left, exponents_left, wide, Y, ends, exponent):  # type: ignore[no-untyped-def]
    """Y (n, c, L, N) with the exponent, of which Y_0 is given. Whether all of it fits.

    entries (S, 4) is row, column, 1 for the imaginary part, and 1 for F, of each series A (S, L, N), sorted by rows;
    places (n + 1,) is where each row begins. left (n, n, 2, L) is Re and Im.
    """
    n, columns, L, N = Y.shape
    k = columns // 2 if wide else columns
    tops, sizes = np.zeros(n, dtype=np.int64), np.zeros(n, dtype=np.int64)
    rooms = np.zeros(n, dtype=np.int64)
    for i in range(n):
        for s in range(places[i], places[i + 1]):
            if s == places[i] or exponents_A[s] + exponent + LIMB_MARGIN > tops[i]:
                tops[i] = exponents_A[s] + exponent + LIMB_MARGIN
    for r in range(n):
        rooms[r] = LIMB_MARGIN
        for i in range(n):
            for p in range(2):
                if places[i + 1] > places[i] and left[r, i, p].any():
                    rooms[r] = max(rooms[r], tops[i] + exponents_left[r, i, p] + LIMB_MARGIN - exponent)
    there = np.zeros((n, n, 2), dtype=np.bool_)
    for r in range(n):
        for i in range(n):
            for p in range(2):
                there[r, i, p] = places[i + 1] > places[i] and left[r, i, p].any()
    for i in range(n):
        sizes[i] = L + 2 * LIMB_MARGIN + max(0, rooms.max() - LIMB_MARGIN)
    Z, scratch = np.zeros((n, columns, sizes.max()), dtype=np.int64), np.zeros(sizes.max(), dtype=np.int64)
    for m in range(1, N):
        for i in range(n):
            for q in range(columns):
                upper, lower = scratch[: sizes[i]], Z[i, q]
                upper[:], lower[:] = 0, 0
                for s in range(places[i], places[i + 1]):
                    at, source, sign = tops[i] - exponents_A[s] - exponent, q, 1
                    if entries[s, 2] == 1:
                        source, sign = (q + k, -1) if q < k else (q - k, 1)
                    b, ends_b = Y[entries[s, 1], source], ends[entries[s, 1], source]
                    if entries[s, 3] == 1:
                        add_convolution(lower, at, -sign, A[s], ends_A[s], b, ends_b, m - 1, 0)
                    else:
                        add_convolution(upper, at, sign, A[s], ends_A[s], b, ends_b, m - 1, 0)
                divide(upper, m)
                add_number(lower, 0, 1, upper)
        for r in range(n):
            for q in range(columns):
                acc = np.zeros(rooms[r] + L + 1, dtype=np.int64)
                for i in range(n):
                    top = exponent + rooms[r] - tops[i]
                    if there[r, i, 0]:
                        add_product(acc, top - exponents_left[r, i, 0], 1, Z[i, q], left[r, i, 0])
                    if there[r, i, 1]:
                        source, sign = (q + k, -1) if q < k else (q - k, 1)
                        add_product(acc, top - exponents_left[r, i, 1], sign, Z[i, source], left[r, i, 1])
                if not store(acc, rooms[r], Y[r, q], ends[r, q], m):
                    return False
    return True


@njit(cache=True, error_model="numpy")
def evaluate(Y, exponent, x, exponent_x, out):  # type: ignore[no-untyped-def]
    """Σ Y_m x^m by Horner's rule, |x| ≤ 1, into out (n, c, L + 1) of the exponent + 1."""
    n, columns, L, N = Y.shape
    top = max(exponent + 1, exponent + 1 + exponent_x) + LIMB_MARGIN
    room = top - exponent - 1
    for i in range(n):
        for q in range(columns):
            total = out[i, q]
            total[:] = 0
            for m in range(N - 1, -1, -1):
                acc = np.zeros(room + L + 1, dtype=np.int64)
                add_product(acc, top - exponent - 1 - exponent_x, 1, total, x)
                add_number(acc, room + 1, 1, Y[i, q, :, m])
                total[:] = acc[room:]
