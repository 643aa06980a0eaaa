"""Elimination with partial pivoting for small matrices, most of whose entries are zero. A singular one gives NaN."""

from __future__ import annotations

import numpy as np
from numba import njit


@njit(cache=True, error_model="numpy")
def solve_small(G, T):  # type: ignore[no-untyped-def]
    """T ← G⁻¹ T for m×m G, by elimination with partial pivoting; G is destroyed, and a singular one gives NaN."""
    m, n = T.shape
    for p in range(m):
        best = p
        for i in range(p + 1, m):
            if square(G[i, p]) > square(G[best, p]):
                best = i
        if best != p:
            for c in range(m):
                G[p, c], G[best, c] = G[best, c], G[p, c]
            for c in range(n):
                T[p, c], T[best, c] = T[best, c], T[p, c]
        inverse = G[p, p].conjugate() * (1.0 / square(G[p, p]))
        for c in range(p, m):
            G[p, c] *= inverse
        for c in range(n):
            T[p, c] *= inverse
        for i in range(m):
            if i != p:
                factor = G[i, p]
                for c in range(p, m):
                    G[i, c] -= factor * G[p, c]
                for c in range(n):
                    T[i, c] -= factor * T[p, c]


@njit(cache=True, error_model="numpy")
def square(x):  # type: ignore[no-untyped-def]
    """|x|²."""
    return x.real * x.real + x.imag * x.imag


@njit(cache=True, error_model="numpy")
def factorize(F, pivots):  # type: ignore[no-untyped-def]
    """F ← its triangular factors, with partial pivoting, the diagonal inverted; a singular F gives NaN."""
    n = len(F)
    for p in range(n):
        best = p
        for i in range(p + 1, n):
            if square(F[i, p]) > square(F[best, p]):
                best = i
        pivots[p] = best
        if best != p:
            for c in range(n):
                F[p, c], F[best, c] = F[best, c], F[p, c]
        inverse = F[p, p].conjugate() * (1.0 / square(F[p, p]))
        F[p, p] = inverse
        for i in range(p + 1, n):
            if F[i, p] != 0.0:
                factor = F[i, p] * inverse
                F[i, p] = factor
                for c in range(p + 1, n):
                    F[i, c] -= factor * F[p, c]


@njit(cache=True, error_model="numpy")
def substitute(F, pivots, R):  # type: ignore[no-untyped-def]
    """R ← F⁻¹ R with the factors that `factorize` left; R (n, q)."""
    n, columns = R.shape
    for p in range(n):
        best = pivots[p]
        for q in range(columns):
            R[p, q], R[best, q] = R[best, q], R[p, q]
    for p in range(n):
        for i in range(p + 1, n):
            factor = F[i, p]
            if factor != 0.0:
                for q in range(columns):
                    R[i, q] -= factor * R[p, q]
    for i in range(n):
        p = n - 1 - i
        for q in range(columns):
            R[p, q] *= F[p, p]
        for above in range(p):
            factor = F[above, p]
            if factor != 0.0:
                for q in range(columns):
                    R[above, q] -= factor * R[p, q]


@njit(cache=True, error_model="numpy")
def solve_each(F, R):  # type: ignore[no-untyped-def]
    """R[p] ← F[p]⁻¹ R[p] for every p; F (m, n, n) is destroyed, R (m, n, q)."""
    pivots = np.empty(F.shape[1], dtype=np.int64)
    for p in range(len(F)):
        factorize(F[p], pivots)
        substitute(F[p], pivots, R[p])


@njit(cache=True, error_model="numpy")
def wall_determinant(W, dW, Y, dY):  # type: ignore[no-untyped-def]
    """det[W Y] and its σ-derivative; W, dW (k, n), Y, dY (n, k), real or complex."""
    k, n = W.shape
    M, dM = np.zeros((k, k), dtype=np.complex128), np.zeros((k, k), dtype=np.complex128)
    for a in range(k):
        for c in range(n):
            if W[a, c] != 0.0 or dW[a, c] != 0.0:
                for b in range(k):
                    M[a, b] += W[a, c] * Y[c, b]
                    dM[a, b] += W[a, c] * dY[c, b] + dW[a, c] * Y[c, b]
    return det_with_slope(M, dM)


@njit(cache=True, error_model="numpy")
def det_with_slope(M, dM):  # type: ignore[no-untyped-def]
    """det M and its derivative, the sum of the determinants with one column differentiated; complex k×k.

    It holds where M is singular, and elimination keeps the accuracy of rows of very different size.
    """
    k = len(M)
    F, slope = M.copy(), 0j
    det = determinant(F)
    for j in range(k):
        for a in range(k):
            for b in range(k):
                F[a, b] = dM[a, b] if b == j else M[a, b]
        slope += determinant(F)
    return det, slope


@njit(cache=True, error_model="numpy")
def determinant(F):  # type: ignore[no-untyped-def]
    """det F, by elimination with partial pivoting; F is destroyed."""
    k = len(F)
    det = 1 + 0j
    for p in range(k):
        best = p
        for i in range(p + 1, k):
            if square(F[i, p]) > square(F[best, p]):
                best = i
        if F[best, p] == 0j:
            return 0j
        if best != p:
            det = -det
            for c in range(p, k):
                F[p, c], F[best, c] = F[best, c], F[p, c]
        det *= F[p, p]
        inverse = 1.0 / F[p, p]
        for i in range(p + 1, k):
            factor = F[i, p] * inverse
            for c in range(p + 1, k):
                F[i, c] -= factor * F[p, c]
    return det
