"""C dψ/dt = D ψ on power series, without C⁻¹: what falls apart is solved apart, and C and D stay as sparse as they are.

Written as (C ψ)′ = (D + C′) ψ, the coefficients of t^m give

    (m + 1) C_0 Y_{m+1} = Σ_j [(D + C′)_j − (m + 1) C_{j+1}] Y_{m−j},

two convolutions with the same Y and one small product an order.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

from shootstab.core.errors import ConvergenceError
from shootstab.multiprecision import small_matrices as matrices
from shootstab.multiprecision.arithmetic import TAIL_TERMS, Arithmetic, Matrix, Payloads
from shootstab.multiprecision.taylor import Taylor

TaylorEntries = Mapping[tuple[int, int], Taylor]
BlockPlaces = tuple[list[int], list[int]]  # rows and unknowns


def at_sigma(parts: Sequence[TaylorEntries], sigma: Any) -> dict[tuple[int, int], Taylor]:
    """Σ σ^k (part k), entry by entry; what is exactly zero is left out."""
    out: dict[tuple[int, int], Taylor] = {}
    factor: Any = 1
    for k, part in enumerate(parts):
        factor = sigma if k == 1 else factor * sigma
        for at, entry in part.items():
            term = factor * entry if k else entry
            out[at] = out[at] + term if at in out else term
    return {at: entry for at, entry in out.items() if not entry.zero}


def subsystems(n: int, C: TaylorEntries, D: TaylorEntries) -> list[BlockPlaces]:
    """The parts into which the system falls apart, each with its equations and its unknowns."""
    group = list(range(n))
    columns: dict[int, list[int]] = {i: [j for r, j in (*C, *D) if r == i] for i in range(n)}
    for row in columns.values():
        for j in row[1:]:
            a, b = group[row[0]], group[j]
            group = [a if g == b else g for g in group]
    found = []
    for name in sorted(set(group)):
        found.append(([i for i, row in columns.items() if row and group[row[0]] == name], [j for j, g in enumerate(group) if g == name]))
    if any(len(rows) != len(unknowns) for rows, unknowns in found):
        raise ConvergenceError("the pencil's C is singular for every z")
    return found


def carried(
    arithmetic: Arithmetic, n: int, C: TaylorEntries, D: TaylorEntries, Y: Matrix, terms: int
) -> tuple[Callable[[float], Matrix], list[Matrix]]:
    """t ↦ ψ(t) (n, k), 0 < t ≤ 1, from ψ(0) = Y by a series of so many terms, and the last of them."""
    k, nothing = len(Y[0]), arithmetic.number(0)
    found = []
    last = [[[nothing] * k for _ in range(n)] for _ in range(TAIL_TERMS)]

    def put(out: Matrix, unknowns: Sequence[int], columns: Sequence[int], part: Matrix) -> None:
        for i, row in zip(unknowns, part, strict=True):
            for q, x in zip(columns, row, strict=True):
                out[i][q] = x

    for rows, unknowns in subsystems(n, C, D):
        columns = [q for q in range(k) if not all(matrices.vanishes(Y[i][q]) for i in unknowns)]
        if not columns:
            continue
        inverse = matrices.inverse(arithmetic, leading(arithmetic, C, rows, unknowns))
        start = [[Y[i][q] for q in columns] for i in unknowns]
        at, tail = arithmetic.carried(stacked(arithmetic, C, D, rows, unknowns, terms, shift=1), inverse, start, terms)
        found.append((unknowns, columns, at))
        for out, part in zip(last, tail, strict=True):
            put(out, unknowns, columns, part)

    def end(t: float) -> Matrix:
        out = [[nothing] * k for _ in range(n)]
        for unknowns, columns, at in found:
            put(out, unknowns, columns, at(t))
        return out

    return end, last


def series(arithmetic: Arithmetic, n: int, C: TaylorEntries, D: TaylorEntries, Y: Matrix, terms: int) -> list[Matrix]:
    """The first coefficients (n, k) of ψ(t) from ψ(0) = Y, as many as are asked for."""
    k, nothing = len(Y[0]), arithmetic.number(0)
    out = [[[nothing] * k for _ in range(n)] for _ in range(terms)]
    for rows, unknowns in subsystems(n, C, D):
        start = [Y[i] for i in unknowns]
        if all(matrices.vanishes(x) for row in start for x in row):
            continue
        inverse = matrices.inverse(arithmetic, leading(arithmetic, C, rows, unknowns))
        found = arithmetic.expanded(stacked(arithmetic, C, D, rows, unknowns, terms, shift=1), inverse, start, terms)
        for term, values in zip(out, found, strict=True):
            for i, row in zip(unknowns, values, strict=True):
                term[i] = row
    return out


def leading(arithmetic: Arithmetic, C: TaylorEntries, rows: Sequence[int], unknowns: Sequence[int]) -> Matrix:
    """C_0 (n, n) of one subsystem."""
    return [[C[i, j].coefficients(1)[0] if (i, j) in C else arithmetic.number(0) for j in unknowns] for i in rows]


def stacked(
    arithmetic: Arithmetic, C: TaylorEntries, D: TaylorEntries, rows: Sequence[int], unknowns: Sequence[int], terms: int, shift: int
) -> Payloads:
    """The rows of D + C′ over those of C, as payloads (Re, Im) of series: in t from C_1 on (shift = 1), or, where t d/dt stands
    for d/dt, all of both but the terms of order zero (shift = 0).
    """
    above = [[_changed(arithmetic, C.get((i, j)), D.get((i, j)), terms, shift) for j in unknowns] for i in rows]
    below = [[_tail(arithmetic, C.get((i, j)), terms) for j in unknowns] for i in rows]
    return above + below


def _changed(arithmetic: Arithmetic, c: Taylor | None, d: Taylor | None, terms: int, shift: int) -> tuple[Any, Any]:
    """(D + C′)_j, or from j = 1 on (D + t C′)_j."""
    slope = None if c is None else c.derivative(1 - shift)
    total = d if slope is None else slope if d is None else d + slope
    if total is None:
        return None, None
    return (total.re, total.im) if shift else _tail(arithmetic, total, terms)


def _tail(arithmetic: Arithmetic, entry: Taylor | None, terms: int) -> tuple[Any, Any]:
    """(entry − entry_0)/t as payloads."""
    if entry is None:
        return None, None

    def of(part: Any) -> Any:
        if part is None:
            return None
        later = arithmetic.coefficients(part, terms)[1:]
        return None if all(matrices.vanishes(x) for x in later) else arithmetic.series(later)

    return of(entry.re), of(entry.im)
