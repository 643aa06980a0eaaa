"""Power series in fixed point, their numbers cut into limbs: products, quotients and powers by compiled loops.

A series is an array (L, N) of limbs and an exponent e: the coefficient of t^m is Σ_i limbs[i, m] 2^(LIMB_BITS (e − i)). Limbs are balanced,
from −HALF_LIMB to HALF_LIMB − 1. The ends (L,) of a series say for each plane how many coefficients there are up to the last one that
is not zero there: coefficients that die away cost ever less.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from llvmlite import ir
from numba import njit, types
from numba.extending import intrinsic

LIMB_BITS = 56  # chosen: whole bytes; 2^17 products of 2 LIMB_BITS − 2 bits add up in 128 bits, and 2^7 limbs in 64
HALF_LIMB, LIMB_MASK = 1 << (LIMB_BITS - 1), (1 << LIMB_BITS) - 1  # derived: the limbs are balanced, from −HALF_LIMB to HALF_LIMB − 1
WORD_BITS = 64  # exact: bits of an int64
LIMB_MARGIN = 2  # derived: limbs before a product that sums of products carry into
HALF_BITS = LIMB_BITS // 2  # derived: half a limb, which division takes at a time


def _multiply_add(context, high, low, a, b):  # type: ignore[no-untyped-def]
    """(high, low) + a b in 128 bits, low without sign: numba has no such integers."""

    def generated(context, builder, signature, given):  # type: ignore[no-untyped-def]
        wide, word = ir.IntType(2 * WORD_BITS), ir.IntType(WORD_BITS)
        high, low, a, b = given
        product = builder.mul(builder.sext(a, wide), builder.sext(b, wide))
        before = builder.or_(builder.shl(builder.sext(high, wide), wide(WORD_BITS)), builder.zext(low, wide))
        total = builder.add(before, product)
        parts = builder.trunc(builder.lshr(total, wide(WORD_BITS)), word), builder.trunc(total, word)
        return context.make_tuple(builder, signature.return_type, parts)

    pair: Any = types.Tuple((types.int64, types.uint64))  # type: ignore[no-untyped-call]
    return pair(types.int64, types.uint64, types.int64, types.int64), generated


multiply_add: Any = intrinsic(_multiply_add)


@njit(cache=True, error_model="numpy", inline="always")
def spill(acc, s, sign, high, low):  # type: ignore[no-untyped-def]
    """Add sign (high, low), of which limb s of acc is the unit."""
    acc[s] += sign * np.int64(low & np.uint64(LIMB_MASK))
    acc[s - 1] += sign * (np.int64((low >> np.uint64(LIMB_BITS)) | (np.uint64(high) << np.uint64(WORD_BITS - LIMB_BITS))) & LIMB_MASK)
    acc[s - 2] += sign * (high >> (2 * LIMB_BITS - WORD_BITS))


@njit(cache=True, error_model="numpy")
def balance(acc):  # type: ignore[no-untyped-def]
    """Limbs from −HALF_LIMB to HALF_LIMB − 1, the first one but for the carry into it."""
    carry = np.int64(0)
    for s in range(acc.shape[0] - 1, 0, -1):
        value = acc[s] + carry
        acc[s] = ((value + HALF_LIMB) & LIMB_MASK) - HALF_LIMB
        carry = (value - acc[s]) >> LIMB_BITS
    acc[0] += carry


@njit(cache=True, error_model="numpy")
def add_convolution(acc, at, sign, a, ends_a, b, ends_b, m, first):  # type: ignore[no-untyped-def]
    """Add sign Σ_j a_j b_{m−j}, j from first to m, where limb 0 of each meets at acc[at], at ≥ 2; what falls off the end is left out."""
    size = acc.shape[0]
    for i in range(a.shape[0]):
        last = min(m, ends_a[i] - 1)
        if last < first:
            continue
        for k in range(b.shape[0]):
            s = at + i + k
            if s >= size:
                break
            start = max(first, m - ends_b[k] + 1)
            if start > last:
                continue
            x, y, high, low = a[i, start : last + 1], b[k, m - last : m - start + 1], np.int64(0), np.uint64(0)
            for j in range(last - start + 1):
                high, low = multiply_add(high, low, x[np.uint64(j)], y[np.uint64(last - start - j)])
            spill(acc, s, sign, high, low)
    balance(acc)


@njit(cache=True, error_model="numpy")
def add_number(acc, at, sign, x):  # type: ignore[no-untyped-def]
    """Add sign x, whose limb 0 stands for acc[at]. Whether no limb but zeros stands before acc[0]."""
    for i in range(min(x.shape[0], acc.shape[0] - at)):
        if at + i >= 0:
            acc[at + i] += sign * x[i]
        elif x[i] != 0:
            return False
    balance(acc)
    return True


@njit(cache=True, error_model="numpy")
def add_product(acc, at, sign, x, y):  # type: ignore[no-untyped-def]
    """Add sign x y, likewise, for two numbers."""
    size = acc.shape[0]
    for i in range(x.shape[0]):
        if x[i] == 0:
            continue
        for k in range(y.shape[0]):
            s = at + i + k
            if s >= size:
                break
            high, low = multiply_add(np.int64(0), np.uint64(0), x[i], y[k])
            spill(acc, s, sign, high, low)
    balance(acc)


@njit(cache=True, error_model="numpy")
def divide(acc, divisor):  # type: ignore[no-untyped-def]
    """Divide limbs by a whole number below 2^(LIMB_BITS/2), towards −∞ in the last place."""
    rest = np.int64(0)
    for s in range(acc.shape[0]):
        value = (rest << HALF_BITS) + (acc[s] >> HALF_BITS)
        upper = value // divisor
        value = ((value - upper * divisor) << HALF_BITS) + (acc[s] & ((1 << HALF_BITS) - 1))
        lower = value // divisor
        rest = value - lower * divisor
        acc[s] = (upper << HALF_BITS) + lower
    balance(acc)


@njit(cache=True, error_model="numpy")
def store(acc, skipped, out, ends, m):  # type: ignore[no-untyped-def]
    """The m-th coefficient: acc from acc[skipped] on. Whether it fits, that is, nothing stands before."""
    for s in range(skipped):
        if acc[s] != 0:
            return False
    for i in range(out.shape[0]):
        out[i, m] = acc[skipped + i]
        if out[i, m] != 0:
            ends[i] = m + 1
    return True


@njit(cache=True, error_model="numpy")
def quotient_term(room, size, a, at_a, b, ends_b, at_b, inverse, at_c, c, ends, m):  # type: ignore[no-untyped-def]
    """c_m = (a_m − Σ_{j≥1} b_j c_{m−j})/b_0. Whether it fits.

    The numerator is formed in size limbs, at_a and at_b are where its parts begin; at_c is where its product with inverse = 1/b_0 does,
    of whose limbs c takes those from room on.
    """
    numerator = np.zeros(size, dtype=np.int64)
    add_number(numerator, at_a, 1, a[:, m])
    add_convolution(numerator, at_b, -1, b, ends_b, c, ends, m, 1)
    out = np.zeros(room + c.shape[0] + 1, dtype=np.int64)
    add_product(out, at_c, 1, numerator, inverse)
    return store(out, room, c, ends, m)


@njit(cache=True, error_model="numpy")
def power_term(room, size, a, ends_a, at_a, weighted, ends_w, at_w, raised, at_r, inverse, at_c, c, ends, m):  # type: ignore[no-untyped-def]
    """c_m = ((r + 1) Σ j a_j c_{m−j}/m − Σ a_j c_{m−j})/a_0, j from 1 to m, for c = a^r, m ≥ 1. Whether it fits.

    weighted is j a_j, at_w where its sum begins, raised the number r + 1, at_r where the product of both begins, at_a where the other sum
    does; inverse, at_c and room as in quotient_term.
    """
    slow = np.zeros(size, dtype=np.int64)
    add_convolution(slow, at_w, 1, weighted, ends_w, c, ends, m, 1)
    divide(slow, m)
    numerator = np.zeros(size, dtype=np.int64)
    add_convolution(numerator, at_a, -1, a, ends_a, c, ends, m, 1)
    add_product(numerator, at_r, 1, slow, raised)
    out = np.zeros(room + c.shape[0] + 1, dtype=np.int64)
    add_product(out, at_c, 1, numerator, inverse)
    return store(out, room, c, ends, m)
