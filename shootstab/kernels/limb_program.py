"""y′ = f(y) by its Taylor recurrence in fixed point: a formula as a list of instructions on series in limbs (kernels.limbs)."""

from __future__ import annotations

import numpy as np
from numba import njit

from shootstab.kernels.limbs import LIMB_MARGIN, add_convolution, add_number, add_product, divide, power_term, quotient_term, store

NEG, ADD, COPY, SCALE, MUL, OVER, INTO, POW = range(8)  # exact: the instructions; COPY is a series but for its first coefficient


@njit(cache=True, error_model="numpy")
def term(operation, left, right, constants, exponents_of, weighted, ends_w, data, ends, exponents, node, m):  # type: ignore[no-untyped-def]
    """The m-th coefficient of one node, m ≥ 1. Whether it fits.

    constants[node] (L,) is what SCALE multiplies with, or 1/b_0 of a quotient's divisor b, or 1/a_0 of a power's base a, and
    exponents_of[node, 0] its exponent; a power has r + 1 as the constant behind that, and exponents_of[node, 1].
    """
    c, out, L = data[node], ends[node], data.shape[1]
    code, a, e = operation[node], left[node], exponents[node]
    b = right[node]
    if code in (NEG, COPY, ADD):
        acc = np.zeros(LIMB_MARGIN + L + 1, dtype=np.int64)
        top = e + LIMB_MARGIN
        fits = add_number(acc, top - exponents[a], -1 if code == NEG else 1, data[a, :, m])
        if code == ADD:
            fits &= add_number(acc, top - exponents[b], 1, data[b, :, m])
        return fits and store(acc, LIMB_MARGIN, c, out, m)
    first = exponents_of[node, 0]
    if code in (SCALE, MUL):
        both = exponents[a] + (first if code == SCALE else exponents[b])
        top = max(e, both) + LIMB_MARGIN
        acc = np.zeros(top - e + L + 1, dtype=np.int64)
        if code == SCALE:
            add_product(acc, top - both, 1, data[a, :, m], constants[node, 0])
        else:
            add_convolution(acc, top - both, 1, data[a], ends[a], data[b], ends[b], m, 0)
        return store(acc, top - e, c, out, m)
    if code == POW:
        add_product_of = weighted[node]
        row = np.zeros(L + LIMB_MARGIN, dtype=np.int64)
        factor = np.zeros(1, dtype=np.int64)
        factor[0] = m
        add_product(row, LIMB_MARGIN, 1, factor, data[a, :, m])
        store(row, 1, add_product_of, ends_w[node], m)
        both, second = exponents[a] + e, exponents_of[node, 1]
        top = both + max(1 + LIMB_MARGIN + second, 0) + LIMB_MARGIN
        drift = top + first - e
        room = max(LIMB_MARGIN, drift + LIMB_MARGIN)
        size = L + 2 * LIMB_MARGIN + max(0, drift)
        return power_term(
            room,
            size,
            data[a],
            ends[a],
            top - both,
            add_product_of,
            ends_w[node],
            LIMB_MARGIN,
            constants[node, 1],
            top - both - 1 - LIMB_MARGIN - second,
            constants[node, 0],
            room - drift,
            c,
            out,
            m,
        )
    # what is left is OVER, node a over node b, and INTO, a constant over it, whose coefficients from m = 1 on are zero
    numerator = exponents[a] if code == OVER else exponents[b] + e
    top = max(numerator, exponents[b] + e) + LIMB_MARGIN
    drift = top + first - e
    room = max(LIMB_MARGIN, drift + LIMB_MARGIN)
    size = L + 2 * LIMB_MARGIN + max(0, drift)
    over = data[a] if code == OVER else np.zeros((1, m + 1), dtype=np.int64)
    return quotient_term(
        room, size, over, top - numerator, data[b], ends[b], top - exponents[b] - e, constants[node, 0], room - drift, c, out, m
    )


@njit(cache=True, error_model="numpy")
def solve(operation, left, right, constants, exponents_of, slopes, step, step_exponent, data, ends, exponents):  # type: ignore[no-untyped-def]
    """The coefficients of all nodes, given those of order 0; node q = 0, … has y_q, whose slope is node slopes[q], step the unit of t.

    data (nodes, L, N), ends (nodes, L) and exponents (nodes,) are as in kernels.limbs. The first node whose coefficients do not fit
    with its exponent, or −1.
    """
    nodes, L, N = data.shape
    weighted, ends_w = np.zeros((nodes, L + 1, N), dtype=np.int64), np.zeros((nodes, L + 1), dtype=np.int64)
    for m in range(1, N):
        for q in range(slopes.shape[0]):
            s = slopes[q]
            both = exponents[s] + step_exponent
            top = max(exponents[q], both) + LIMB_MARGIN
            acc = np.zeros(top - exponents[q] + L + 1, dtype=np.int64)
            add_product(acc, top - both, 1, data[s, :, m - 1], step)
            divide(acc, m)
            if not store(acc, top - exponents[q], data[q], ends[q], m):
                return q
        if m == N - 1:
            break
        for node in range(slopes.shape[0], nodes):
            if not term(operation, left, right, constants, exponents_of, weighted, ends_w, data, ends, exponents, node, m):
                return node
    return -1


@njit(cache=True, error_model="numpy")
def solve_singular(operation, left, right, constants, exponents_of, slopes, shifts, data, ends, exponents):  # type: ignore[no-untyped-def]
    """The same for t dy_q/dt + shift_q y_q = f_q(t, y): node 0 is a multiple of t, given; nodes q = 1, … have y_q, slopes[q − 1] has f_q.

    On the right of no equation a coefficient of order m counts but those that shift_q accounts for: every order is computed with zeros
    for its unknowns first, and again with what came out.
    """
    nodes, L, N = data.shape
    count = slopes.shape[0] + 1
    weighted, ends_w = np.zeros((nodes, L + 1, N), dtype=np.int64), np.zeros((nodes, L + 1), dtype=np.int64)
    for m in range(1, N):
        for again in range(2):
            for node in range(count, nodes):
                if not term(operation, left, right, constants, exponents_of, weighted, ends_w, data, ends, exponents, node, m):
                    return node
            for q in range(1, count if again == 0 else 1):
                s = slopes[q - 1]
                acc = np.zeros(LIMB_MARGIN + L + 1, dtype=np.int64)
                fits = add_number(acc, LIMB_MARGIN + exponents[q] - exponents[s], 1, data[s, :, m])
                divide(acc, m + shifts[q - 1])
                if not (fits and store(acc, LIMB_MARGIN, data[q], ends[q], m)):
                    return q
    return -1
