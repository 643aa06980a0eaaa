"""The solutions that decay towards an end, as a graph over some components, in balls: a tube that solutions leave (theory, lemma E17).

With s rising towards the end and t falling, 0 ≤ t ≤ 1, solutions of dψ/ds = A(t) ψ that decay have ψ_c = X ψ_J, with J as many rows as
there are of them, and dX/ds = A_cJ + A_cc X − X A_JJ − X A_Jc X. X̂ is a polynomial in t that nearly solves this, ρ what it leaves, and
F = X − X̂:

    dF/ds = K F − F H − F A_Jc F + ρ,   K = A_cc − X̂ A_Jc,   H = A_JJ + A_Jc X̂.

In a basis in which A is almost diagonal a tube |F_ij| ≤ δ u_i v_j, u_i > 0 and v_j > 0, is left everywhere where, with
a = Σ v_p |A_pq| u_q over the entries of A_Jc,

    (Re K_ii − Re H_jj − Σ_{l≠i} |K_il| u_l/u_i − Σ_{l≠j} |H_lj| v_l/v_j) δ > a δ² + |ρ_ij|/(u_i v_j).
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from shootstab.core.balls import acb, acb_mat, arb, ctx
from shootstab.core.errors import ConvergenceError
from shootstab.multiprecision.tailed_series import NO_TAIL, TailedSeries, widened
from shootstab.multiprecision.tails import largest

SeriesMatrix = list[list[TailedSeries]]  # a matrix of series in t, |t| ≤ 1
SeriesSlope = Callable[[TailedSeries], TailedSeries]  # df/ds of a series f in t, which is 0 at t = 0


LEAST_WEIGHT = 2.0**-40  # chosen: the least u_i and v_j, in the largest


def decaying_rows(A: Any, k: int) -> tuple[int, ...]:
    """The k rows (of an acb_mat) over which the space of its k eigenvalues with the smallest real parts is the flattest graph: a choice."""
    dense = np.array([[complex(x.mid()) for x in row] for row in A.tolist()])
    values, vectors = np.linalg.eig(dense)
    Y, rows = vectors[:, np.argsort(values.real)[:k]], list[int]()
    for _ in range(k):
        rest = Y - Y @ np.linalg.pinv(Y[rows]) @ Y[rows] if rows else Y
        rows.append(int(np.argmax(np.abs(rest).sum(axis=1))))
    return tuple(sorted(rows))


def graph(A: SeriesMatrix, rows: Sequence[int], slope: SeriesSlope, orders: int) -> Any:
    """X at t = 1, an acb_mat (n − k, k) that holds the graph of the solutions that decay, all others growing.

    orders are the terms of X̂. Raises ConvergenceError where that is not shown.
    """
    n, k = len(A), len(rows)
    order = [*rows, *(i for i in range(n) if i not in rows)]
    A = [[A[i][j] for j in order] for i in order]
    leading = acb_mat([[entry.c[0].mid() for entry in row] for row in A])
    W = _basis(leading)
    try:
        inverse = W.inv()
    except ZeroDivisionError:
        raise ConvergenceError("the solutions that decay are not told from the others: take more bits") from None
    A = _product(_product(_constant(inverse, A[0][0]), A), _constant(W, A[0][0]))
    parts = [[row[j : j + m] for row in A[i : i + height]] for i, height in ((0, k), (k, n - k)) for j, m in ((0, k), (k, n - k))]
    (H, Jc, left, K), zero = parts, A[0][0] * 0
    X = _approximate(parts, slope, orders, zero)
    left = _sum(left, _product(K, X))
    H = _sum(H, _product(Jc, X))
    K = _sum(K, _product([[-x for x in row] for row in X], Jc))
    left = _sum(left, [[-(x + slope(y)) for x, y in zip(a, b, strict=True)] for a, b in zip(_product(X, H), X, strict=True)])
    tube = _tube(H, K, Jc, left)
    found = acb_mat([[widened(x.at(1), radius) for x, radius in zip(*rows_, strict=True)] for rows_ in zip(X, tube, strict=True)])
    (JJ, Jc), (cJ, cc) = ([_block(W, rows_, columns) for columns in (range(k), range(k, n))] for rows_ in (range(k), range(k, n)))
    one = acb_mat([[int(i == j) for j in range(k)] for i in range(k)])
    try:  # (W_cJ + W_cc F)(W_JJ + W_Jc F)⁻¹, and what F makes of it apart
        back = JJ.inv()
        return cJ * back + (cc - cJ * back * Jc) * (found * back) * (one + Jc * (found * back)).inv()
    except ZeroDivisionError:
        raise ConvergenceError("the solutions that decay are no graph over the rows that were chosen") from None


def _basis(A: Any) -> Any:
    """W, the eigenvectors, those of the smallest real parts first, in whose coordinates the leading matrix is almost diagonal: midpoints, a
    choice alone.
    """
    n = A.nrows()
    try:
        values, vectors = A.eig(right=True, algorithm="approx")
    except ValueError:
        raise ConvergenceError("the solutions that decay are not told from the others: take more bits") from None
    order = sorted(range(n), key=lambda q: float(values[q].real.mid()))
    return acb_mat([[vectors[i, q].mid() for q in order] for i in range(n)])


def _block(W: Any, rows: Sequence[int], columns: Sequence[int]) -> Any:
    return acb_mat([[W[i, j] for j in columns] for i in rows])


def _approximate(parts: Sequence[SeriesMatrix], slope: SeriesSlope, orders: int, zero: TailedSeries) -> SeriesMatrix:
    """X̂ by orders of t, each from what the terms before it leave: midpoints, whatever they are."""
    JJ, Jc, cJ, cc = parts
    k, m = len(JJ), len(cc)
    rates = [[cc[i][i].c[0].mid() - JJ[j][j].c[0].mid() for j in range(k)] for i in range(m)]
    X = [[zero for _ in range(k)] for _ in range(m)]
    for p in range(orders):
        H = _sum(JJ, _product(Jc, X))
        left = _sum(_product(cc, X), cJ)
        moved = _product(X, H)
        unit = slope(TailedSeries([acb(0)] * p + [acb(1)], zero.terms))
        own = unit.c[p].mid() if p < len(unit.c) else acb(0)  # d t^p/ds = own t^p + …
        out = [list(row) for row in X]
        for i in range(m):
            for j in range(k):
                rest = left[i][j] - moved[i][j] - slope(X[i][j])
                value = rest.c[p].mid() if p < len(rest.c) else acb(0)
                if not value.is_zero():
                    out[i][j] = X[i][j] + TailedSeries([acb(0)] * p + [-(value / (rates[i][j] - own)).mid()], zero.terms)
        X = [[TailedSeries([c.mid() for c in x.c], zero.terms) for x in row] for row in out]
    return X


def _tube(H: SeriesMatrix, K: SeriesMatrix, Jc: SeriesMatrix, left: SeriesMatrix) -> list[list[Any]]:
    """δ u_i v_j (n − k, k)."""
    k, m = len(H), len(K)
    rise, fall = [_least(K[i][i]) for i in range(m)], [_least(-H[j][j]) for j in range(k)]
    u, v = _weights([[float(x.norm.upper()) for x in row] for row in left])
    a = sum((v[p] * Jc[p][q].norm * u[q] for p in range(k) for q in range(m)), NO_TAIL)
    rise = [rise[i] - sum((K[i][q].norm * u[q] / u[i] for q in range(m) if q != i), NO_TAIL) for i in range(m)]
    fall = [fall[j] - sum((H[q][j].norm * v[q] / v[j] for q in range(k) if q != j), NO_TAIL) for j in range(k)]
    least = min(((x + y).lower() for x in rise for y in fall), default=arb(1))
    most = largest([left[i][j].norm / (u[i] * v[j]) for i in range(m) for j in range(k)]) if m and k else NO_TAIL
    if not least > 0:
        raise ConvergenceError("it is not proved that solutions decay or grow: sigma may lie on the essential spectrum, or next to it")
    delta = (2 * most / least).upper() + arb(2) ** (-2 * ctx.prec)
    if not all(x - delta * a > 0 for x in (*rise, *fall)):
        raise ConvergenceError(
            "it is not proved that these solutions decay and the others grow: sigma may lie next to the essential spectrum"
        )
    if not least * delta > a * delta**2 + most:
        raise ConvergenceError("the solutions that decay are not enclosed: take more bits, or a smaller disc")
    return [[delta * x * y for y in v] for x in u]


def _weights(sizes: list[list[float]]) -> tuple[list[Any], list[Any]]:
    """u and v with u_i v_j next to the sizes (n − k, k), or not far below: a choice."""
    found = np.array(sizes).reshape(len(sizes), -1)
    top = found.max(initial=0.0)
    if not 0.0 < top < math.inf:
        found, top = np.ones_like(found), 1.0
    u = np.maximum(found.max(axis=1, initial=0.0) / top, LEAST_WEIGHT)
    v = np.maximum((found / (top * u[:, None])).max(axis=0, initial=0.0), LEAST_WEIGHT)
    return [arb(x) for x in u.tolist()], [arb(x) for x in v.tolist()]


def _least(f: TailedSeries) -> Any:
    """A lower bound of Re f on 0 ≤ t ≤ 1."""
    return f.c[0].real - (f.norm - abs(f.c[0]))


def _constant(A: Any, like: TailedSeries) -> SeriesMatrix:
    return [[TailedSeries([x], like.terms) for x in row] for row in A.tolist()]


def _product(A: SeriesMatrix, B: SeriesMatrix) -> SeriesMatrix:
    columns = list(zip(*B, strict=True))
    return [[_dot(row, column) for column in columns] for row in A]


def _dot(a: Sequence[TailedSeries], b: Sequence[TailedSeries]) -> TailedSeries:
    total = a[0] * b[0]
    for x, y in zip(a[1:], b[1:], strict=True):
        total = total + x * y
    return total


def _sum(A: SeriesMatrix, B: SeriesMatrix) -> SeriesMatrix:
    return [[x + y for x, y in zip(a, b, strict=True)] for a, b in zip(A, B, strict=True)]
