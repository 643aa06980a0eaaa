"""How much |D| can be: a comparison system for the moduli of the minors, carried along the way (theory, lemma E4).

With y′ = A y on a cell, the moduli obey |y_i|′ ≤ (Re A_ii) |y_i| + Σ_{j≠i} |A_ij| |y_j|. If M holds upper bounds of these coefficients
on the cell, of length h, then |y(h)| ≤ e^{hM} |y(0)| entrywise. Doubles do that: numbers that are not negative are added and multiplied,
so that rounding changes a result by its relative size alone, which ROUNDED_UP exceeds.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from functools import lru_cache
from itertools import combinations
from typing import Any

import numpy as np
from numpy.typing import NDArray

from shootstab.core.balls import arb
from shootstab.multiprecision.minors import MinorEntries
from shootstab.multiprecision.tailed_series import NO_TAIL

# It exceeds the rounding of LONGEST_EXPONENTIAL terms, each of as many factors as its order, sums of 10⁴ numbers.
ROUNDED_UP = 1 + 2.0**-30  # derived: see above
UPWARDS = 2.0**-50  # derived: it exceeds the rounding of a ball's upper bound to a double
FAINTEST = 2.0**-100  # chosen: the least of the moduli, in the largest; raised so far, what underflows is below ROUNDED_UP of each
LARGEST_NORM = 64.0  # chosen: the norm of hM in one exponential, so that nothing overflows
LEAST_TERM, LONGEST_EXPONENTIAL = 2.0**-60, 400  # chosen: the last term in the largest modulus, and a budget never met with LARGEST_NORM

Moduli = NDArray[np.float64]
EntryPlaces = tuple[NDArray[np.intp], NDArray[np.intp]]


def log_bound(n: int, k: int, cells: Iterable[tuple[Any, MinorEntries]], start: Sequence[Any], end: Sequence[Any]) -> Any:
    """An upper bound of ln |Σ_I w_I y_I| from y at the start, w at the end, and cells (length, A) along the way, all as balls.

    A holds C⁻¹ D on the whole cell. What is not finite is no bound.
    """
    v, total = _scaled(np.array([_above(abs(y)) for y in start]), arb(0))
    for length, A in cells:
        rates = np.zeros((n, n))
        for (i, j), entry in A.items():
            rates[i, j] = _above((entry * length).real) if i == j else _above(abs(entry) * abs(length))
        M = _comparison(n, k, rates)
        if not (np.isfinite(M).all() and np.isfinite(v).all()):
            return arb.pos_inf()
        v, total = _carried(M, v, total)
    ends = sum((abs(x) * arb(size) for x, size in zip(end, v.tolist(), strict=True)), NO_TAIL)
    return total + ends.upper().log()


def _comparison(n: int, k: int, rates: Moduli) -> Moduli:
    """M (C(n,k), C(n,k)) from upper bounds (n, n) of Re A_ii and |A_ij|: A^(k) has Σ_{i∈I} A_ii, and ± A_ij where subsets differ in one."""
    members, changes, entries = _structure(n, k)
    M = np.zeros((len(members), len(members)))
    M[changes] = rates[entries]
    diagonal = rates.diagonal()
    M[np.diag_indices(len(members))] = members @ diagonal + UPWARDS * (members @ np.abs(diagonal))
    return M


@lru_cache
def _structure(n: int, k: int) -> tuple[Moduli, EntryPlaces, EntryPlaces]:
    """The rows that belong to each subset, and which entries of A^(k) beside the diagonal are which of A, up to their signs."""
    subsets = list(combinations(range(n), k))
    place = {s: i for i, s in enumerate(subsets)}
    members = np.array([[float(i in s) for i in range(n)] for s in subsets])
    found = [(row, place[tuple(sorted({*s, j} - {i}))], i, j) for row, s in enumerate(subsets) for i in s for j in range(n) if j not in s]
    rows, columns, i, j = np.array(found, dtype=np.intp).reshape(-1, 4).T
    return members, (rows, columns), (i, j)


def _carried(M: Moduli, v: Moduli, total: Any) -> tuple[Moduli, Any]:
    """Upper bounds of e^M v, in units of e^total."""
    shift = max(0.0, -float(M.diagonal().min()))
    B = M + shift * np.eye(len(v))
    parts = max(1, math.ceil(float(B.sum(axis=1).max()) / LARGEST_NORM))
    B /= parts
    norm = float(B.sum(axis=1).max()) * ROUNDED_UP
    for _ in range(parts):
        v = np.maximum(v, FAINTEST * v.max())
        term, found = v, v
        for order in range(1, LONGEST_EXPONENTIAL):
            term = B @ term / order
            found = found + term
            if order + 1 >= 2 * norm and term.max() < LEAST_TERM * found.max():
                break
        else:
            raise AssertionError("the series of an exponential has not ended within a budget that its norm does not exceed")
        v, total = _scaled(ROUNDED_UP * (found + term.max()), total)  # the terms left out are together at most as large as the last one
    return v, total - arb(shift)


def _scaled(v: Moduli, total: Any) -> tuple[Moduli, Any]:
    """v over a power of 2 next to its largest, and e^total times that power."""
    top = float(v.max())
    if not 0.0 < top < math.inf:
        return v, total
    exponent = math.frexp(top)[1]
    return np.ldexp(v, -exponent), total + exponent * arb(2).log()


def _above(x: Any) -> float:
    """A double that is no smaller than a real ball."""
    found = float(x.upper())
    return found + abs(found) * UPWARDS
