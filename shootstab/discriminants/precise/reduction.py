"""A = C⁻¹ D on power series: the system in explicit form, dψ/dt = A(t) ψ."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

from shootstab.discriminants.precise.arithmetic import Arithmetic
from shootstab.discriminants.precise.taylor import Taylor
from shootstab.vocabulary.errors import ConvergenceError

Row = dict[int, Taylor]


def explicit(ring: Arithmetic, n: int, C: Mapping[tuple[int, int], Taylor], D: Mapping[tuple[int, int], Taylor]) -> list[Row]:
    """The rows of C⁻¹ D, zeros left out, by elimination of a sparse C.

    Pivots are rows with few entries whose leading coefficient is not small against the row: most rows of C have one entry.
    """
    left = [{j: e for (r, j), e in C.items() if r == i and not e.zero} for i in range(n)]
    right = [{j: e for (r, j), e in D.items() if r == i and not e.zero} for i in range(n)]
    open_rows, solved = set(range(n)), {}
    while open_rows:
        r, j = _pivot(ring, left, open_rows)
        open_rows.remove(r)
        solved[j] = r
        inverse = 1 / left[r][j]
        left[r] = {c: e * inverse for c, e in left[r].items() if c != j}
        right[r] = {c: e * inverse for c, e in right[r].items()}
        for i in range(n):
            factor = left[i].pop(j, None) if i != r else None
            if factor is not None:
                _subtract(left[i], factor, left[r])
                _subtract(right[i], factor, right[r])
    return [right[solved[j]] for j in range(n)]


def affine(part0: Mapping[tuple[int, int], Taylor], part1: Mapping[tuple[int, int], Taylor], sigma: Any) -> dict[tuple[int, int], Taylor]:
    """part0 + σ part1, entry by entry."""
    out = dict(part0)
    for at, entry in part1.items():
        out[at] = out[at] + sigma * entry if at in out else sigma * entry
    return out


def block(rows: list[Row], members: Iterable[int]) -> list[list[tuple[Any, Any]]]:
    """Rows and columns of these indices, as pairs of payloads (Re, Im)."""
    inside = list(members)
    return [[(rows[i][j].re, rows[i][j].im) if j in rows[i] else (None, None) for j in inside] for i in inside]


def components(rows: list[Row]) -> list[list[int]]:
    """The index sets into which the system falls apart."""
    group = list(range(len(rows)))
    for i, row in enumerate(rows):
        for j in row:
            a, b = group[i], group[j]
            group = [a if g == b else g for g in group]
    return [[i for i, g in enumerate(group) if g == name] for name in sorted(set(group))]


def _pivot(ring: Arithmetic, left: list[Row], open_rows: set[int]) -> tuple[int, int]:
    best: tuple[float, int, int] | None = None
    for r in sorted(open_rows):
        sizes = {j: max(ring.log2(x) for x in e.coefficients(1)) for j, e in left[r].items()}
        if not sizes:
            continue
        j = max(sizes, key=lambda c: sizes[c])
        badness = float(len(sizes))
        if best is None or badness < best[0]:
            best = badness, r, j
    if best is None or max(ring.log2(x) for x in left[best[1]][best[2]].coefficients(1)) == -float("inf"):
        raise ConvergenceError("the pencil's C is singular: sigma lies on the continuous spectrum")
    return best[1], best[2]


def _subtract(row: Row, factor: Taylor, other: Row) -> None:
    for j, entry in other.items():
        change = factor * entry
        row[j] = row[j] - change if j in row else -change
