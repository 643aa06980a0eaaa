"""Numbers of python-flint in limbs and back: what the compiled loops of kernels.limbs take and give."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np
from flint import arb, ctx
from numpy.typing import NDArray

from shootstab.kernels.limbs import HALF_LIMB, LIMB_BITS, LIMB_MASK

Limbs = NDArray[np.int64]
Binary = tuple[int, int]  # a number m 2^p as m and p
SPARE_LIMB_BITS = 112  # chosen: bits beyond the working precision: LIMB_BITS for the grain of exponents, HEAD_BITS, and 48 for small rows
HEAD_BITS = 8  # chosen: bits by which later coefficients may exceed the first one before the exponent is raised
MOST_LIMB_BITS = 1400  # chosen: the fast products of integers are worth more than loops from about 400 digits on
WORD_BYTES = 8  # exact: bytes of an int64
LIMB_BYTES = LIMB_BITS // 8  # derived


def planes() -> int:
    """The limbs of a number in the working precision."""
    return -(-(ctx.prec + SPARE_LIMB_BITS) // LIMB_BITS)


def binary(x: Any) -> Binary:
    """The midpoint of a finite number."""
    mantissa, power = x.mid().man_exp()
    return int(mantissa), int(power)


def exponent_of(numbers: Iterable[Binary], head: int = 0) -> int | None:
    """The exponent that leaves so many bits before the largest of the numbers, None if all are zero."""
    bits = max([power + mantissa.bit_length() for mantissa, power in numbers if mantissa], default=None)
    return None if bits is None else -(-(bits + 2 + head) // LIMB_BITS) - 1


def limbs_of(numbers: Sequence[Binary], exponents: Sequence[int]) -> Limbs:
    """Numbers x as columns (L, N), |x| < 2^(LIMB_BITS (exponent + 1) − 2) each, rounded to the last limb."""
    L, N = planes(), len(numbers)
    width, low = LIMB_BYTES * (L + 1), LIMB_BITS * (L - 1)
    parts = ((m, p + low - LIMB_BITS * e) for (m, p), e in zip(numbers, exponents, strict=True))
    text = b"".join(
        (m << left if left >= 0 else (m + (1 << -left - 1)) >> -left).to_bytes(width, "little", signed=True) for m, left in parts
    )
    raw = np.zeros((N, L, WORD_BYTES), dtype=np.uint8)
    raw[:, :, :LIMB_BYTES] = np.frombuffer(text, dtype=np.uint8).reshape(N, L + 1, LIMB_BYTES)[:, :L]
    digits = raw.view("<i8")[:, :, 0]
    out, carry = np.empty((L, N), dtype=np.int64), np.zeros(N, dtype=np.int64)
    for i in range(L):
        value = digits[:, i] + carry
        out[L - 1 - i] = ((value + HALF_LIMB) & LIMB_MASK) - HALF_LIMB
        carry = (value - out[L - 1 - i]) >> LIMB_BITS
    return out


def numbers_of(limbs: Limbs, exponents: Sequence[int], shifts: Sequence[int]) -> list[Any]:
    """The numbers that the columns of limbs (L, N) with these exponents stand for, times 2^shift, in the working precision."""
    L, N = limbs.shape
    raw, carry = np.empty((N, L), dtype="<i8"), np.zeros(N, dtype=np.int64)
    for i in range(L):
        value = limbs[L - 1 - i] + carry
        raw[:, i] = value & LIMB_MASK
        carry = value >> LIMB_BITS
    text = raw.view(np.uint8).reshape(N, L, WORD_BYTES)[:, :, :LIMB_BYTES].tobytes()
    width, one = LIMB_BYTES * L, arb(1)
    whole = (int.from_bytes(text[width * m : width * (m + 1)], "little") + (int(top) << LIMB_BITS * L) for m, top in enumerate(carry))
    return [(arb((v, LIMB_BITS * (e - L + 1) + s)) * one).mid() for v, e, s in zip(whole, exponents, shifts, strict=True)]


def ends_of(limbs: Limbs) -> Limbs:
    """The number, for each plane of the columns limbs (L, N), of those up to the last one that is not zero, (L,)."""
    there = limbs[:, ::-1] != 0
    return np.where(there.any(axis=1), limbs.shape[1] - there.argmax(axis=1), 0)
