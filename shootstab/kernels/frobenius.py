"""Series of the decaying space at a regular singular point: (C_0 + C_1 x + …) x dψ/dx = (D_0 + D_1 x + …) ψ, ψ = P(x) x^Λ."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from shootstab.kernels.elimination import factorize, substitute


class Sparse(NamedTuple):
    """Matrices A_m + σ B_m, m < M, without what is zero in all of them: entry e stands at (row[e], column[e]).

    values (E, M) are those of A_m; slopes (E1, M) those of B_m, which has no entry but the first E1. Real or complex.
    """

    row: NDArray[np.uint64]
    column: NDArray[np.uint64]
    values: NDArray[np.inexact]
    slopes: NDArray[np.inexact]


def sparse(matrices: NDArray[np.inexact]) -> Sparse:
    """From (2, M, n, n)."""
    present = (matrices != 0).any(axis=1)
    row, column = (
        np.concatenate(at).astype(np.uint64) for at in zip(np.nonzero(present[1]), np.nonzero(present[0] & ~present[1]), strict=True)
    )
    values, slopes = np.ascontiguousarray(matrices[:, :, row, column].swapaxes(1, 2))
    return Sparse(row, column, values, slopes[: np.count_nonzero(present[1])])


@njit(cache=True, error_model="numpy")
def series_terms(C, D, sigma, rate, left, right, P, dP, tangent):  # type: ignore[no-untyped-def]
    """Fill P and, if tangent, dP (M, n, k), whose first terms are given, by

        (m C_0 − D_0) P_m + C_0 P_m Λ = Σ_{j≥1} [D_j P_{m−j} − C_j S_{m−j}],   S_m = m P_m + P_m Λ,

    for Λ = rate·I + N, N = left rightᵀ (k,) and (k,) with N² = 0: then with F = (m + rate) C_0 − D_0 the solution is
    P_m = F⁻¹ (R − C_0 F⁻¹ R N). dP is the derivative with respect to σ.
    """
    terms, n, k = P.shape
    c, d = _at(C, sigma), _at(D, sigma)
    S, dS = np.zeros_like(P), np.zeros_like(P)
    R, dR = np.empty((n, k), P.dtype), np.empty((n, k), P.dtype)
    F, pivots = np.empty((n, n), P.dtype), np.empty(n, dtype=np.int64)
    f = np.empty((n, 1), P.dtype)
    for m in range(terms):
        if m > 0:
            clear(R)
            convolve(D, d, 1.0, P, m, 1, R)
            convolve(C, c, -1.0, S, m, 1, R)
            clear(F)
            for e in range(len(C.row)):
                F[C.row[e], C.column[e]] += (m + rate) * c[e, 0]
            for e in range(len(D.row)):
                F[D.row[e], D.column[e]] -= d[e, 0]
            factorize(F, pivots)
            _solve_order(C, c, left, right, F, pivots, f, R)
            keep(R, P, m)
        _shifted(P, S, m, m + rate, left, right)
        if m > 0 and tangent:
            # the derivative of the equation, its left side's dependence on σ moved to the right
            clear(dR)
            convolve(D, d, 1.0, dP, m, 1, dR)
            convolve(C, c, -1.0, dS, m, 1, dR)
            convolve(D, D.slopes, 1.0, P, m, 0, dR)
            convolve(C, C.slopes, -1.0, S, m, 0, dR)
            _solve_order(C, c, left, right, F, pivots, f, dR)
            keep(dR, dP, m)
        if tangent:
            _shifted(dP, dS, m, m + rate, left, right)


# Loops: assignments to slices would take seconds to compile


@njit(cache=True, error_model="numpy")
def clear(R):  # type: ignore[no-untyped-def]
    """R = 0, in two dimensions."""
    for a in range(R.shape[0]):
        for q in range(R.shape[1]):
            R[a, q] = 0.0


@njit(cache=True, error_model="numpy")
def keep(R, P, m):  # type: ignore[no-untyped-def]
    """P[m] = R."""
    for a in range(R.shape[0]):
        for q in range(R.shape[1]):
            P[m, a, q] = R[a, q]


@njit(cache=True, error_model="numpy")
def _at(M, sigma):  # type: ignore[no-untyped-def]
    """The entries (E, terms) at a σ."""
    out = M.values.copy()
    for e in range(len(M.slopes)):
        for m in range(out.shape[1]):
            out[e, m] += sigma * M.slopes[e, m]
    return out


@njit(cache=True, error_model="numpy", fastmath={"contract"})
def convolve(matrices, values, factor, P, m, first, out):  # type: ignore[no-untyped-def]
    """out ← out + factor Σ_j M_j P[m−j] over first ≤ j ≤ m, M_j the entries values[:, j]; P (M, n, k), up to four columns at a time."""
    k = P.shape[2]
    for q in range(0, k, 4):
        width = min(4, k - q)
        for e in range(len(values)):
            r, s = matrices.row[e], matrices.column[e]
            w, x, y, z = 0 * P[0, 0, 0], 0 * P[0, 0, 0], 0 * P[0, 0, 0], 0 * P[0, 0, 0]
            for j in range(first, m + 1):
                v = values[e, j]
                w += v * P[m - j, s, q]
                if width > 1:
                    x += v * P[m - j, s, q + 1]
                if width > 2:
                    y += v * P[m - j, s, q + 2]
                if width > 3:
                    z += v * P[m - j, s, q + 3]
            out[r, q] += factor * w
            if width > 1:
                out[r, q + 1] += factor * x
            if width > 2:
                out[r, q + 2] += factor * y
            if width > 3:
                out[r, q + 3] += factor * z


@njit(cache=True, error_model="numpy")
def _shifted(P, S, m, exponent, left, right):  # type: ignore[no-untyped-def]
    """S[m] = exponent·P[m] + P[m] N."""
    for a in range(P.shape[1]):
        along = 0 * left[0]
        for q in range(P.shape[2]):
            along += P[m, a, q] * left[q]
        for q in range(P.shape[2]):
            S[m, a, q] = exponent * P[m, a, q] + along * right[q]


@njit(cache=True, error_model="numpy")
def _solve_order(C, c, left, right, F, pivots, f, R):  # type: ignore[no-untyped-def]
    """R ← F⁻¹ (R − C_0 F⁻¹ R N), F factorized; f (n, 1) is work."""
    n, k = R.shape
    for a in range(n):
        f[a, 0] = 0.0
        for q in range(k):
            f[a, 0] += R[a, q] * left[q]
    substitute(F, pivots, f)
    for e in range(len(C.row)):
        for q in range(k):
            R[C.row[e], q] -= c[e, 0] * f[C.column[e], 0] * right[q]
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
