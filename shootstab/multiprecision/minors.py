"""The linear system of a closed form in any ring: at one σ, solved for the derivative, and carried over to minors."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations
from typing import Any

from shootstab.core.balls import acb, acb_mat, acb_series, arb_series
from shootstab.core.errors import ConvergenceError
from shootstab.multiprecision.tailed_series import TailedSeries

MinorEntries = dict[tuple[int, int], Any]


def at_sigma(parts: Sequence[Any], sigma: Any) -> MinorEntries:
    """Σ σ^k (part k), entry by entry."""
    out: MinorEntries = {}
    factor = acb(1)
    for k, part in enumerate(parts):
        factor = factor * sigma if k else factor
        for at, e in part.items():
            term = e if isinstance(e, TailedSeries) else acb(e)
            term = term * factor if k else term
            out[at] = out[at] + term if at in out else term
    return out


def solved(n: int, C: MinorEntries, D: MinorEntries) -> MinorEntries:
    """C⁻¹ D by elimination in the ring of the entries; the pivot is the entry whose first coefficient is largest."""
    rows: list[dict[int, Any]] = [
        {**{j: C[i, j] for j in range(n) if (i, j) in C}, **{n + j: D[i, j] for j in range(n) if (i, j) in D}} for i in range(n)
    ]
    for column in range(n):
        pivot = max(range(column, n), key=lambda r: _size(rows[r].get(column)))
        rows[column], rows[pivot] = rows[pivot], rows[column]
        if not _size(rows[column].get(column)) > 0.0:
            raise ConvergenceError("C may be singular, as far as its enclosure tells: sigma lies on the continuous spectrum, or next to it")
        top = rows[column].pop(column)
        rows[column] = {j: e / top for j, e in rows[column].items()}
        for r in range(n):
            factor = rows[r].pop(column, None) if r != column else None
            if factor is not None:
                for j, e in rows[column].items():
                    term = -(factor * e)
                    rows[r][j] = rows[r][j] + term if j in rows[r] else term
    return {(i, j - n): e for i, row in enumerate(rows) for j, e in row.items() if j >= n}


def _size(entry: Any) -> float:
    if entry is None:
        return 0.0
    first = entry.c[0] if isinstance(entry, TailedSeries) else entry[0] if isinstance(entry, acb_series | arb_series) else entry
    return float(abs(first).lower())


def minors(rows: Sequence[Sequence[Any]], k: int) -> list[Any]:
    """All k-minors of rows (n, k), the subsets in lexicographic order."""
    return [acb_mat([list(rows[i]) for i in subset]).det() for subset in combinations(range(len(rows)), k)]


def compound(n: int, k: int, A: MinorEntries) -> MinorEntries:
    """A^(k) of Λ^k: (A^(k))_{IJ} = Σ ± a_ij where J is I with i replaced by j."""
    subsets = list(combinations(range(n), k))
    place = {s: i for i, s in enumerate(subsets)}
    out: MinorEntries = {}
    for row, subset in enumerate(subsets):
        for at, i in enumerate(subset):
            for j in range(n):
                if (i, j) not in A or (j in subset and j != i):
                    continue
                J = list(subset)
                J[at] = j
                order = sorted(J)
                sign = (-1) ** sum(1 for a in range(k) for b in range(a + 1, k) if J[a] > J[b])
                cell = (row, place[tuple(order)])
                term = A[i, j] if sign > 0 else -A[i, j]
                out[cell] = out[cell] + term if cell in out else term
    return out
