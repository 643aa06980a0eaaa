"""Small matrices of numbers of any arithmetic, as lists of rows. Exact zeros stay exact."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

from shootstab.core.errors import ConvergenceError
from shootstab.multiprecision.arithmetic import Arithmetic, Matrix

LARGEST_BINARY = 1000.0  # derived: powers of two up to this are doubles, which end at 2^1024


def product(arithmetic: Arithmetic, A: Matrix, B: Matrix) -> Matrix:
    """A B for A (n, m) and B (m, l)."""
    return arithmetic.multiplier(A)(B)


def combined(A: Matrix, B: Matrix, factor: Any) -> Matrix:
    """A + factor B, both (n, m)."""
    return [[a + factor * b for a, b in zip(x, y, strict=True)] for x, y in zip(A, B, strict=True)]


def polynomial(coefficients: Sequence[Matrix], sigma: Any) -> Matrix:
    """Σ σ^k A_k of coefficients A_k, all (m, n), by Horner's rule."""
    total = coefficients[-1]
    for A in reversed(coefficients[:-1]):
        total = combined(A, total, sigma)
    return total


def scaled(A: Matrix, factor: Any) -> Matrix:
    """factor A, (n, m)."""
    return [[factor * a for a in row] for row in A]


def vanishes(x: Any) -> bool:
    """Whether x is exactly zero."""
    return bool(x == 0)


def inverse(arithmetic: Arithmetic, A: Matrix) -> Matrix:
    """A⁻¹ (n, n), after the rows and columns of A were scaled to size one.

    Raises ConvergenceError where A is singular.
    """
    n = range(len(A))
    rows = [_unit(arithmetic, row) for row in A]
    columns = [_unit(arithmetic, [rows[i] * A[i][j] for i in n]) for j in n]
    try:
        inverse = arithmetic.inverse([[rows[i] * A[i][j] * columns[j] for j in n] for i in n])
    except ZeroDivisionError:
        raise ConvergenceError("the pencil's C is singular: sigma lies on the continuous spectrum") from None
    return [[columns[j] * inverse[j][i] * rows[i] for i in n] for j in n]


def _unit(arithmetic: Arithmetic, numbers: Sequence[Any]) -> Any:
    """The power of two that brings the largest of the numbers to about one."""
    size = max(map(arithmetic.log2, numbers))
    return arithmetic.number(2.0 ** -round(size)) if -LARGEST_BINARY < size < LARGEST_BINARY else arithmetic.number(1)


def eliminated(arithmetic: Arithmetic, A: Matrix) -> Matrix:
    """A⁻¹ (n, n) by elimination. Raises ZeroDivisionError where a pivot vanishes."""
    n = len(A)
    return solve(arithmetic, A, [[arithmetic.number(int(i == j)) for j in range(n)] for i in range(n)])


def solve(arithmetic: Arithmetic, A: Matrix, B: Matrix) -> Matrix:
    """A⁻¹ B for A (n, n) and B (n, m) by elimination with partial pivoting."""
    n = len(A)
    rows = [[*a, *b] for a, b in zip(A, B, strict=True)]
    for i in range(n):
        pivot = max(range(i, n), key=lambda r: arithmetic.log2(rows[r][i]))
        rows[i], rows[pivot] = rows[pivot], rows[i]
        inverse = 1 / rows[i][i]
        rows[i] = [arithmetic.rounded(x * inverse) if not vanishes(x) else x for x in rows[i]]
        for r in range(n):
            factor = rows[r][i]
            if r != i and not vanishes(factor):
                rows[r] = [x if vanishes(y) else arithmetic.rounded(x - factor * y) for x, y in zip(rows[r], rows[i], strict=True)]
    return [row[n:] for row in rows]


def determinant(arithmetic: Arithmetic, A: Matrix) -> Any:
    """det A of A (n, n) by elimination with partial pivoting, after the rows were scaled to size one."""
    rows, n = [list(row) for row in A], len(A)
    det: Any = arithmetic.number(1)
    for i in range(n):
        sizes = [arithmetic.log2(rows[r][i]) - max(arithmetic.log2(x) for x in rows[r]) for r in range(i, n)]
        best = i + max(range(n - i), key=lambda r: sizes[r] if sizes[r] == sizes[r] else -math.inf)
        if vanishes(rows[best][i]):
            return arithmetic.number(0)
        if best != i:
            rows[i], rows[best], det = rows[best], rows[i], -det
        det = arithmetic.rounded(det * rows[i][i])
        for r in range(i + 1, n):
            if not vanishes(rows[r][i]):
                factor = rows[r][i] / rows[i][i]
                rows[r] = [x if vanishes(y) else arithmetic.rounded(x - factor * y) for x, y in zip(rows[r], rows[i], strict=True)]
    return det


def pivots(arithmetic: Arithmetic, Y: Matrix) -> list[int]:
    """k rows of Y (n, k) that are well independent, by elimination with full pivoting."""
    rows = {i: list(row) for i, row in enumerate(Y)}
    left, chosen = list(range(len(Y[0]))), []
    while left:
        i, q = max(((i, q) for i in rows for q in left), key=lambda at: arithmetic.log2(rows[at[0]][at[1]]))
        top = rows.pop(i)
        chosen.append(i)
        left.remove(q)
        if vanishes(top[q]):
            continue
        for row in rows.values():
            if not vanishes(row[q]):
                factor = row[q] / top[q]
                for c in left:
                    row[c] = arithmetic.rounded(row[c] - factor * top[c])
    return chosen
