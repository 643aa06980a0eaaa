"""The Taylor terms of a linear system by compiled loops: the recurrence of `Arithmetic.carried` on numbers of python-flint in limbs."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from flint import acb, arb, ctx

from shootstab.kernels.limb_recurrence import evaluate, recur
from shootstab.multiprecision.arithmetic import TAIL_TERMS, Matrix, Payloads
from shootstab.multiprecision.limb_numbers import (
    HEAD_BITS,
    MOST_LIMB_BITS,
    Limbs,
    binary,
    ends_of,
    exponent_of,
    limbs_of,
    numbers_of,
    planes,
)

EXPONENTS = 3  # chosen: exponents of Y that are tried, each a limb above the one before


@dataclass(frozen=True, eq=False)
class LimbTerms:
    """Terms Y_m of a series as limbs (n, c, L, N), Re Y beside Im Y if wide."""

    limbs: Limbs
    exponent: int
    wide: bool

    def at(self, t: float) -> Matrix:
        """Σ Y_m t^m (n, k), 0 < t ≤ 1."""
        n, c, L, _ = self.limbs.shape
        out, x = np.zeros((n, c, L + 1), dtype=np.int64), binary(arb(t))
        exponent = exponent_of([x]) or 0
        evaluate(self.limbs, self.exponent, limbs_of([x], [exponent])[:, 0].copy(), exponent, out)
        return self._matrix(out, self.exponent + 1)

    def term(self, m: int) -> Matrix:
        """Y_m (n, k)."""
        return self._matrix(self.limbs[:, :, :, m], self.exponent)

    def _matrix(self, values: Limbs, exponent: int) -> Matrix:
        n, c, L = values.shape
        flat = numbers_of(np.ascontiguousarray(values.reshape(n * c, L).T), [exponent] * (n * c), [0] * (n * c))
        rows = [flat[c * i : c * (i + 1)] for i in range(n)]
        k = c // 2
        return [[acb(x, y) for x, y in zip(row[:k], row[k:], strict=True)] for row in rows] if self.wide else rows


def terms_of(A: Payloads, left: Matrix, Y: Matrix, terms: int) -> LimbTerms | None:
    """The terms Y_m (n, k) of `Arithmetic.carried`, for left (n, n); None where they are not found that way."""
    n = len(Y)
    if ctx.prec > MOST_LIMB_BITS:
        return None
    entries, coefficients = [], []
    for i in range(n):
        for below in (0, 1):
            for j, pair in enumerate(A[i + n * below]):
                for part, payload in enumerate(pair):
                    found = [] if payload is None else payload.coeffs()[:terms]
                    if any(found):
                        entries.append((i, j, part, below))
                        coefficients.append(found)
    lefts = [x for row in left for number in row for x in _parts(number)]
    start = [[_parts(x) for x in row] for row in Y]
    wide = any(entry[2] for entry in entries) or not all(
        im.is_zero() for row in (zip(lefts[::2], lefts[1::2], strict=True), *start) for _, im in row
    )
    flat = [x for row in start for part in range(1 + wide) for x in (number[part] for number in row)]
    try:
        first, sides, series = ([binary(x) for x in part] for part in (flat, lefts, [x for found in coefficients for x in found]))
    except ValueError:  # a number that is not finite
        return None
    largest = exponent_of(first, HEAD_BITS)
    if largest is None:
        return None
    L, lengths = planes(), [len(found) for found in coefficients]
    ranges = [slice(sum(lengths[:s]), sum(lengths[: s + 1])) for s in range(len(lengths))]
    exponents = [exponent_of(series[part]) or 0 for part in ranges]
    columns = limbs_of(series, [e for e, count in zip(exponents, lengths, strict=True) for _ in range(count)])
    limbs_A = np.zeros((len(entries), L, terms), dtype=np.int64)
    for s, there in enumerate(ranges):
        limbs_A[s, :, : lengths[s]] = columns[:, there]
    ends = np.array([ends_of(one) for one in limbs_A], dtype=np.int64).reshape(-1, L)
    sizes = [exponent_of([x]) or 0 for x in sides]
    matrix = limbs_of(sides, sizes).T.reshape(n, n, 2, L).copy()
    places = np.array([sum(entry[0] < i for entry in entries) for i in range(n + 1)])
    width = len(flat) // n
    for exponent in range(largest, largest + EXPONENTS):
        limbs = np.zeros((n, width, L, terms), dtype=np.int64)
        limbs[:, :, :, 0] = limbs_of(first, [exponent] * len(first)).T.reshape(n, width, L)
        reached = (limbs[:, :, :, 0] != 0).astype(np.int64)
        parts = np.array(entries, dtype=np.int64).reshape(-1, 4), limbs_A, ends, np.array(exponents, dtype=np.int64), places
        if recur(*parts, matrix, np.array(sizes).reshape(n, n, 2), wide, limbs, reached, exponent):
            return LimbTerms(limbs, exponent, wide)
    return None


def carried_by(found: LimbTerms) -> tuple[Callable[[float], Matrix], Sequence[Matrix]]:
    """The sum of the terms at t, and the last ones."""
    N = found.limbs.shape[3]
    return found.at, [found.term(m) for m in range(max(0, N - TAIL_TERMS), N)]


def _parts(x: Any) -> tuple[Any, Any]:
    return (x.real, x.imag) if isinstance(x, acb) else (x, NO_PART)


NO_PART = arb(0)
