"""Series of the decaying space at a regular singular point: (C_0 + C_1 x + …) x dψ/dx = (D_0 + D_1 x + …) ψ, ψ = P(x) x^Λ."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from shootstab.kernels.elimination import factorize, substitute


class Sparse(NamedTuple):
    """Matrices A_m + σ B_m, m < M, without what is zero in all of them: entry e stands at (row[e], column[e]); values (2, M, E)."""

    row: NDArray[np.uint64]
    column: NDArray[np.uint64]
    values: NDArray[np.complex128]


def sparse(matrices: NDArray[np.complex128]) -> Sparse:
    """From (2, M, n, n)."""
    row, column = np.nonzero((matrices != 0).any(axis=(0, 1)))
    return Sparse(row.astype(np.uint64), column.astype(np.uint64), np.ascontiguousarray(matrices[:, :, row, column]))


@njit(cache=True, error_model="numpy")
def series_terms(C, D, sigma, rate, left, right, P, dP, tangent):  # type: ignore[no-untyped-def]
    """Fill P and, if tangent, dP (M, n, k), whose first terms are given, by

        (m C_0 − D_0) P_m + C_0 P_m Λ = Σ_{j≥1} [D_j P_{m−j} − C_j S_{m−j}],   S_m = m P_m + P_m Λ,

    for Λ = rate·I + N, N = left rightᵀ (k,) and (k,) with N² = 0: then with F = (m + rate) C_0 − D_0 the solution is
    P_m = F⁻¹ (R − C_0 F⁻¹ R N). dP is the derivative with respect to σ.
    """
    terms, n, k = P.shape
    c, d = C.values[0] + sigma * C.values[1], D.values[0] + sigma * D.values[1]
    dc, dd = C.values[1], D.values[1]
    S, dS = np.zeros_like(P), np.zeros_like(P)
    R, dR = np.empty((n, k), dtype=np.complex128), np.empty((n, k), dtype=np.complex128)
    F, pivots = np.empty((n, n), dtype=np.complex128), np.empty(n, dtype=np.int64)
    f = np.empty((n, 1), dtype=np.complex128)
    for m in range(terms):
        if m > 0:
            R[:] = 0j
            dR[:] = 0j
            for j in range(1, m + 1):
                add_product(D.row, D.column, d, j, 1.0, P, m - j, R)
                add_product(C.row, C.column, c, j, -1.0, S, m - j, R)
                if tangent:
                    add_product(D.row, D.column, d, j, 1.0, dP, m - j, dR)
                    add_product(C.row, C.column, c, j, -1.0, dS, m - j, dR)
                    add_product(D.row, D.column, dd, j, 1.0, P, m - j, dR)
                    add_product(C.row, C.column, dc, j, -1.0, S, m - j, dR)
            F[:] = 0j
            for e in range(len(C.row)):
                F[C.row[e], C.column[e]] += (m + rate) * c[0, e]
            for e in range(len(D.row)):
                F[D.row[e], D.column[e]] -= d[0, e]
            factorize(F, pivots)
            _solve_order(C, c, left, right, F, pivots, f, R)
            P[m] = R
        _shifted(P, S, m, m + rate, left, right)
        if m > 0 and tangent:
            # the derivative of the equation, its left side's dependence on σ moved to the right
            add_product(D.row, D.column, dd, 0, 1.0, P, m, dR)
            add_product(C.row, C.column, dc, 0, -1.0, S, m, dR)
            _solve_order(C, c, left, right, F, pivots, f, dR)
            dP[m] = dR
        if tangent:
            _shifted(dP, dS, m, m + rate, left, right)


@njit(cache=True, error_model="numpy", fastmath={"contract"})
def add_product(row, column, values, j, factor, P, m, out):  # type: ignore[no-untyped-def]
    """out ← out + factor·M P[m], with M the entries values[j]; out (n, k)."""
    k = P.shape[2]
    for e in range(len(row)):
        v = factor * values[j, e]
        if v != 0j:
            r, b = row[e], column[e]
            for q in range(k):
                out[r, q] += v * P[m, b, q]


@njit(cache=True, error_model="numpy")
def _shifted(P, S, m, exponent, left, right):  # type: ignore[no-untyped-def]
    """S[m] = exponent·P[m] + P[m] N."""
    for a in range(P.shape[1]):
        along = 0j
        for q in range(P.shape[2]):
            along += P[m, a, q] * left[q]
        for q in range(P.shape[2]):
            S[m, a, q] = exponent * P[m, a, q] + along * right[q]


@njit(cache=True, error_model="numpy")
def _solve_order(C, c, left, right, F, pivots, f, R):  # type: ignore[no-untyped-def]
    """R ← F⁻¹ (R − C_0 F⁻¹ R N), F factorized; f (n, 1) is work."""
    n, k = R.shape
    for a in range(n):
        f[a, 0] = 0j
        for q in range(k):
            f[a, 0] += R[a, q] * left[q]
    substitute(F, pivots, f)
    for e in range(len(C.row)):
        for q in range(k):
            R[C.row[e], q] -= c[0, e] * f[C.column[e], 0] * right[q]
    substitute(F, pivots, R)


@njit(cache=True, error_model="numpy")
def series_value(P, x):  # type: ignore[no-untyped-def]
    """Σ P_m x^m (n, k), for real x."""
    terms, n, k = P.shape
    out = P[terms - 1].copy()
    for m in range(terms - 2, -1, -1):
        for a in range(n):
            for q in range(k):
                out[a, q] = out[a, q] * x + P[m, a, q]
    return out


@njit(cache=True, error_model="numpy")
def row_sizes(P, sizes):  # type: ignore[no-untyped-def]
    """sizes (M,) ← of each term the largest max_q |P_m[a, q]|/max_q |P_0[a, q]| over the rows a."""
    terms, n, k = P.shape
    sizes[:] = 0.0
    for a in range(n):
        base = 1e-300
        for q in range(k):
            base = max(base, abs(P[0, a, q]))
        for m in range(terms):
            for q in range(k):
                sizes[m] = max(sizes[m], abs(P[m, a, q]) / base)  # its square may overflow
