"""The solutions that decay towards an end, as a graph over some components, in balls: a tube that solutions leave (theory, lemma E17).

With s rising towards the end and t falling, 0 ≤ t ≤ 1, solutions of dψ/ds = A(t) ψ that decay have ψ_c = X ψ_J, with J as many rows as
there are of them, and dX/ds = A_cJ + A_cc X − X A_JJ − X A_Jc X. X̂ is a polynomial in t that nearly solves this, ρ what it leaves, and
F = X − X̂:

    dF/ds = K F − F H − F A_Jc F + ρ,   K = A_cc − X̂ A_Jc,   H = A_JJ + A_Jc X̂.

In bases in which K and H are almost diagonal a tube |F_ij| ≤ δ is left everywhere where, with the sum a of all |A_Jc|,

    (Re K_ii − Re H_jj − Σ_{l≠i} |K_il| − Σ_{l≠j} |H_lj|) δ > a δ² + |ρ_ij|.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from shootstab.core.balls import acb, acb_mat, arb, ctx
from shootstab.core.errors import ConvergenceError
from shootstab.multiprecision.tailed_series import NO_TAIL, TailedSeries, widened
from shootstab.multiprecision.tails import largest

SeriesMatrix = list[list[TailedSeries]]  # a matrix of series in t, |t| ≤ 1
SeriesSlope = Callable[[TailedSeries], TailedSeries]  # df/ds of a series f in t, which is 0 at t = 0


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
    W, X0 = _bases(leading, k)
    try:
        inverse = W.inv()
    except ZeroDivisionError:
        raise ConvergenceError("the solutions that decay are no graph over the rows that were chosen") from None
    A = _product(_product(_constant(inverse, A[0][0]), A), _constant(W, A[0][0]))
    parts = [[row[j : j + m] for row in A[i : i + height]] for i, height in ((0, k), (k, n - k)) for j, m in ((0, k), (k, n - k))]
    (JJ, Jc, cJ, cc), zero = parts, A[0][0] * 0
    X = _approximate(parts, slope, orders, zero)
    H = _sum(JJ, _product(Jc, X))
    K = _sum(cc, _product([[-x for x in row] for row in X], Jc))
    left = _sum(
        _sum(cJ, _product(cc, X)), [[-(x + slope(y)) for x, y in zip(a, b, strict=True)] for a, b in zip(_product(X, H), X, strict=True)]
    )
    delta = _tube(H, K, Jc, left)
    found = acb_mat([[widened(x.at(1), delta) for x in row] for row in X])
    Wc, WJ = _block(W, k, n), _block(W, 0, k)
    return Wc * found * WJ.inv() + X0


def _bases(A: Any, k: int) -> tuple[Any, Any]:
    """W = (1 0; X_0 1) diag(V_J, V_c), in whose coordinates the leading matrix is almost diagonal, and X_0: midpoints, choices alone."""
    n = A.nrows()
    values, vectors = A.eig(right=True, algorithm="approx")
    chosen = sorted(range(n), key=lambda q: float(values[q].real.mid()))[:k]
    Y = acb_mat([[vectors[i, q].mid() for q in chosen] for i in range(n)])
    top, low = (acb_mat(Y.tolist()[a:b]) for a, b in ((0, k), (k, n)))
    try:
        X0 = (low * top.inv()).mid()
        table = A.tolist()
        Ac, Jc = acb_mat([row[k:] for row in table[k:]]), acb_mat([row[k:] for row in table[:k]])
        _, Vc = (Ac - X0 * Jc).mid().eig(right=True, algorithm="approx")
    except (ZeroDivisionError, ValueError):
        raise ConvergenceError("the solutions that decay are not told from the others: take more bits") from None
    VJ, Vc = top.mid(), Vc.mid()
    # X in these coordinates is V_c⁻¹ (X − X_0) V_J, small
    W = acb_mat(n, n)
    low = X0 * VJ
    for i in range(n):
        for j in range(n):
            if i < k and j < k:
                W[i, j] = VJ[i, j]
            elif i >= k and j < k:
                W[i, j] = low[i - k, j].mid()
            elif i >= k and j >= k:
                W[i, j] = Vc[i - k, j - k]
    return W, X0


def _block(W: Any, first: int, last: int) -> Any:
    return acb_mat([row[first:last] for row in W.tolist()[first:last]])


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


def _tube(H: SeriesMatrix, K: SeriesMatrix, Jc: SeriesMatrix, left: SeriesMatrix) -> Any:
    """δ."""
    k, m = len(H), len(K)
    a = sum((x.norm for row in Jc for x in row), NO_TAIL)
    beside_K = [sum((K[i][q].norm for q in range(m) if q != i), NO_TAIL) for i in range(m)]
    beside_H = [sum((H[q][j].norm for q in range(k) if q != j), NO_TAIL) for j in range(k)]
    gaps = [[_least(K[i][i]) + _least(-H[j][j]) - beside_K[i] - beside_H[j] for j in range(k)] for i in range(m)]
    least = min((gap.lower() for row in gaps for gap in row), default=arb(1))
    most = largest([x.norm for row in left for x in row]) if m and k else NO_TAIL
    if not least > 0:
        raise ConvergenceError("it is not proved that solutions decay or grow: sigma may lie on the essential spectrum, or next to it")
    delta = (2 * most / least).upper() + arb(2) ** (-2 * ctx.prec)
    decays = all(_least(-H[i][i]) - sum((H[i][q].norm for q in range(k) if q != i), NO_TAIL) - delta * a > 0 for i in range(k))
    grows = all(_least(K[i][i]) - beside_K[i] - delta * a > 0 for i in range(m))
    if not (decays and grows):
        raise ConvergenceError(
            "it is not proved that these solutions decay and the others grow: sigma may lie next to the essential spectrum"
        )
    if not least * delta > a * delta**2 + most:
        raise ConvergenceError("the solutions that decay are not enclosed: take more bits, or a smaller disc")
    return delta


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
