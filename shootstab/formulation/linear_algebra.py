"""Linear algebra over functions of z and polynomials in σ: small sparse matrices, without more division than need be."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TypeVar

from shootstab.formulation.expression import Expression, number, quotient
from shootstab.formulation.system import degree
from shootstab.formulation.vanishing import Vanishing

K = TypeVar("K")
SparseRow = dict[str, Expression]


def left_null_vector(L: Sequence[SparseRow], columns: Sequence[str], vanishing: Vanishing) -> dict[int, Expression] | None:
    """λ ≠ 0 with λᵀ L = 0, by its non-zero entries, without common factors as far as they are seen; None if L is nonsingular.

    L has as many rows as columns. Elimination is free of fractions but for division by numbers.
    """
    work = [({name: c for name, c in row.items() if not vanishing(c)}, {i: number(1)}) for i, row in enumerate(L)]
    left = list(columns)
    while work:
        for row, history in work:
            if not row:
                return _primitive(history)
        options = [(i, name) for i, (row, _) in enumerate(work) for name in row if name in left]
        i, name = min(options, key=lambda at: (degree(work[at[0]][0][at[1]]), len(work[at[0]][0][at[1]].terms), len(work[at[0]][0])))
        pivot_row, pivot_history = work.pop(i)
        left.remove(name)
        pivot = pivot_row[name]
        following = []
        for row, history in work:
            if name in row:
                p, x = coprime(pivot, row[name])
                row = minus(row, pivot_row, p, x, vanishing)
                history = minus(history, pivot_history, p, x, vanishing)
                row.pop(name, None)
            following.append((row, history))
        work = following
    return None


def determinant(L: Sequence[SparseRow], columns: Sequence[str]) -> Expression:
    """The determinant by expansion along the sparsest row, which keeps polynomials polynomials."""
    if not L:
        return number(1)
    i = min(range(len(L)), key=lambda r: sum(name in columns for name in L[r]))
    total = number(0)
    rest = [row for r, row in enumerate(L) if r != i]
    for j, name in enumerate(columns):
        if name in L[i]:
            term = L[i][name] * determinant(rest, [*columns[:j], *columns[j + 1 :]])
            total = total - term if (i + j) % 2 else total + term
    return total


def coprime(pivot: Expression, x: Expression) -> tuple[Expression, Expression]:
    """p, x′ with p·x = x′·pivot, both short."""
    if pivot.constant is not None:
        return number(1), x / pivot
    for a, b, swap in ((x, pivot, False), (pivot, x, True)):
        whole = x / pivot if len(b.terms) == 1 and not swap and degree(b) == 0 else quotient(a, b)
        if whole is not None:
            return (whole, number(1)) if swap else (number(1), whole)
    return pivot, x


def minus(
    row: dict[K, Expression], other: dict[K, Expression], p: Expression, x: Expression, vanishing: Callable[[Expression], bool]
) -> dict[K, Expression]:
    """p · row − x · other, without the coefficients that vanish."""
    total = {at: p * c for at, c in row.items()}
    for at, c in other.items():
        term = x * c
        total[at] = total[at] - term if at in total else -term
    return {at: c for at, c in total.items() if not vanishing(c)}


def _primitive(history: dict[int, Expression]) -> dict[int, Expression]:
    """Divided by one of its own entries that divides all."""
    for divisor in sorted(history.values(), key=lambda c: (-degree(c), -len(c.terms))):
        if divisor.constant is None and len(divisor.terms) > 1:
            found = {i: quotient(c, divisor) for i, c in history.items()}
            if all(c is not None for c in found.values()):
                return {i: c for i, c in found.items() if c is not None}
    return history
