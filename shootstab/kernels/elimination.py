"""Elimination with partial pivoting for small matrices, most of whose entries are zero. A singular one gives NaN."""

from __future__ import annotations

import numpy as np
from numba import njit

LANES = 4  # chosen: the number of columns that are multiplied together; those that a matrix lacks are zero


@njit(cache=True, error_model="numpy", inline="always")
def solve_small(M):  # type: ignore[no-untyped-def]
    """M = [G, T] ← [1, G⁻¹ T] for m×m G, by elimination with partial pivoting; a singular one gives NaN."""
    m, n = M.shape
    for p in range(m):
        best = p
        for i in range(p + 1, m):
            if abs(M[i, p]) > abs(M[best, p]):
                best = i
        pivot = M[best, p]
        inverse = pivot.conjugate() * (1.0 / (pivot.real * pivot.real + pivot.imag * pivot.imag))
        for c in range(p, n):
            M[p, c], M[best, c] = M[best, c], M[p, c]
            M[p, c] *= inverse
        for i in range(m):
            if i != p:
                factor = M[i, p]
                for c in range(p, n):
                    M[i, c] -= factor * M[p, c]


@njit(cache=True, error_model="numpy", inline="always")
def square(x):  # type: ignore[no-untyped-def]
    """|x|²."""
    return x.real * x.real + x.imag * x.imag


@njit(cache=True, error_model="numpy", inline="always")
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


@njit(cache=True, error_model="numpy", inline="always")
def substitute(F, pivots, R, first, last):  # type: ignore[no-untyped-def]
    """Solve for columns first ≤ q < last: R (n, ·) ← F⁻¹ R with the factors that `factorize` left in F (n, n)."""
    n = len(F)
    for p in range(n):
        best = pivots[p]
        for q in range(first, last):
            R[p, q], R[best, q] = R[best, q], R[p, q]
    for turn in range(2):
        # down through the lower factor, up through the upper one
        for step in range(n):
            p = step if turn == 0 else n - 1 - step
            if turn == 1:
                for q in range(first, last):
                    R[p, q] *= F[p, p]
            for i in range(p + 1 if turn == 0 else 0, n if turn == 0 else p):
                factor = F[i, p]
                if factor != 0.0:
                    for q in range(first, last):
                        R[i, q] -= factor * R[p, q]


@njit(cache=True, error_model="numpy")
def solve_each(F, R):  # type: ignore[no-untyped-def]
    """R[p] ← F[p]⁻¹ R[p] for every p; F (m, n, n) is destroyed, R (m, n, q)."""
    pivots = np.empty(F.shape[1], dtype=np.int64)
    for p in range(len(F)):
        factorize(F[p], pivots)
        substitute(F[p], pivots, R[p], 0, R.shape[2])


@njit(cache=True, error_model="numpy")
def wall_determinant(W, dW, Y, dY):  # type: ignore[no-untyped-def]
    """det[W Y] and its σ-derivative; W, dW (k, n), Y, dY (n, k), complex."""
    k, n = W.shape
    M, dM = np.zeros((k, k), dtype=np.complex128), np.zeros((k, k), dtype=np.complex128)
    for a in range(k):
        for c in range(n):
            if W[a, c] != 0.0 or dW[a, c] != 0.0:
                for b in range(k):
                    M[a, b] += W[a, c] * Y[c, b]
                    dM[a, b] += W[a, c] * dY[c, b] + dW[a, c] * Y[c, b]
    return det_with_slope(M, dM)


@njit(cache=True, error_model="numpy", inline="always")
def det_with_slope(M, dM):  # type: ignore[no-untyped-def]
    """det M and its derivative, the sum of the determinants with one column differentiated; complex k×k.

    It holds where M is singular, and elimination keeps the accuracy of rows of very different size.
    """
    k = len(M)
    F, det, slope = np.empty_like(M), 0j, 0j
    for j in range(-1, k):
        for a in range(k):
            for b in range(k):
                F[a, b] = dM[a, b] if b == j else M[a, b]
        value = determinant(F)
        if j < 0:
            det = value
        else:
            slope += value
    return det, slope


@njit(cache=True, error_model="numpy", inline="always")
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
            det = 0j
            break
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
