"""How much |D| can be: the logarithmic norm of A^(k), integrated along the way (theory, lemma E4)."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np

from shootstab.core.balls import acb, arb
from shootstab.multiprecision.minors import MinorEntries, compound
from shootstab.multiprecision.tailed_series import NO_TAIL
from shootstab.multiprecision.tails import largest, perron


def log_bound(
    n: int, k: int, cells: Iterable[tuple[Any, MinorEntries]], start: Sequence[Any], end: Sequence[Any], weights: Sequence[float]
) -> Any:
    """An upper bound of ln |Σ_I w_I y_I| from y at the start, w at the end, and cells (length, A) along the way, all as balls.

    |y| is bounded in the weighted maximum norm; A holds C⁻¹ D on the whole cell.
    """
    w = [arb(weight) for weight in weights]
    total = largest([abs(y) / weight for y, weight in zip(start, w, strict=True)]).log()
    for length, A in cells:
        entries = compound(n, k, A)
        rates = [(entries.get((row, row), acb(0)) * length).real for row in range(len(w))]
        for (i, j), entry in entries.items():
            if i != j:
                rates[i] += abs(entry) * abs(length) * (w[j] / w[i])
        total += largest(rates)
    ends = sum((abs(x) * weight for x, weight in zip(end, w, strict=True)), NO_TAIL)
    return total + ends.upper().log()


def weights(n: int, k: int, samples: Iterable[MinorEntries]) -> list[float]:
    """A scaling of the components in which |A^(k)| grows little: Perron's vector of some A, in doubles. Any positive one would do."""
    size = math.comb(n, k)
    dense = np.zeros((size, size))
    for A in samples:
        for (i, j), entry in compound(n, k, A).items():
            dense[i, j] += float(abs(entry).mid())
    return perron(dense)
