"""A linear system dψ/dt = hA(σ) ψ, sampled along a mesh and reduced so that no linear system of size n is left to solve.

With t from 0 to 1 over a step of length h (see discriminants/table.py for how it comes about),

    hA(σ) = X(σ) + V γ(σ)⁻¹ τ(σ),   γ = G0 + σ G1 (m×m),   X and τ (m×n) polynomials in σ.

Arrays are float64 where all is real, σ too, and complex128 otherwise; the loops are the same.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from shootstab.kernels.elimination import solve_small


class Sampled(NamedTuple):
    """The reduced system at the 12 abscissae of each of N steps, the length of the step multiplied into X and V.

    [X; τ], n + m rows, is stored by rows without what is zero at every abscissa: P (N, 12, degree + 1, E) are the coefficients of the
    powers of σ, and entry e of row i stands in column[e] for start[i] ≤ e < start[i + 1]. Likewise V by its rows carries (v,) that are not
    zero, V (N, 12, v, m). G (N, 12, 2, m, m). start, column and carries are unsigned.
    """

    start: NDArray[np.uint64]
    column: NDArray[np.uint64]
    carries: NDArray[np.uint64]
    P: NDArray[np.inexact]
    V: NDArray[np.inexact]
    G: NDArray[np.inexact]


@njit(cache=True, error_model="numpy", fastmath={"contract"})
def evaluate(P, G, linear, s, i, sigma, values, slopes, small, tangent):  # type: ignore[no-untyped-def]
    """The entries of [X; τ] (E,), the first of them linear in σ, if tangent their σ-derivatives, and γ (m, m), at abscissa i of step s."""
    if P.shape[2] == 2:
        for e in range(len(values)):
            values[e] = P[s, i, 0, e] + sigma * P[s, i, 1, e]
            slopes[e] = P[s, i, 1, e]
    else:
        for e in range(len(values)):
            values[e] = P[s, i, 0, e] + sigma * P[s, i, 1, e]
        for e in range(linear, len(values)):
            values[e] += sigma * sigma * P[s, i, 2, e]
        if tangent:
            for e in range(len(values)):
                slopes[e] = P[s, i, 1, e] + 2.0 * sigma * P[s, i, 2, e]
    for a in range(small.shape[0]):
        for b in range(small.shape[0]):
            small[a, b] = G[s, i, 0, a, b] + sigma * G[s, i, 1, a, b]


@njit(cache=True, error_model="numpy")
def system_matrix(system, s, i, sigma, A, dA, work, tangent):  # type: ignore[no-untyped-def]
    """hA(σ) (n, n) and, if tangent, its σ-derivative at abscissa i of step s; work is for `workspace` to make."""
    start, column, carries, P, V, G = system
    values, slopes, small, right, slope = work
    n, m = A.shape[0], G.shape[3]
    evaluate(P, G, start[n], s, i, sigma, values, slopes, small, tangent)
    A[:] = 0.0
    dA[:] = 0.0
    right[:] = 0.0
    slope[:] = 0.0
    for r in range(n + m):
        for e in range(start[r], start[r + 1]):
            if r < n:
                A[r, column[e]], dA[r, column[e]] = values[e], slopes[e]
            else:
                right[r - n, column[e]], slope[r - n, column[e]] = values[e], slopes[e]
    if m == 0:
        return
    solve_small(small, right)
    if tangent:
        # (γ⁻¹ τ)′ = γ⁻¹ (τ′ − G1 γ⁻¹ τ)
        for a in range(m):
            for b in range(m):
                small[a, b] = G[s, i, 0, a, b] + sigma * G[s, i, 1, a, b]
                for j in range(n):
                    slope[a, j] -= G[s, i, 1, a, b] * right[b, j]
        solve_small(small, slope)
    for c in range(len(carries)):
        for q in range(m):
            v = V[s, i, c, q]
            for j in range(n):
                A[carries[c], j] += v * right[q, j]
                if tangent:
                    dA[carries[c], j] += v * slope[q, j]


@njit(cache=True, error_model="numpy")
def workspace(system, n):  # type: ignore[no-untyped-def]
    """Memory for `system_matrix`: values and slopes (E,), γ (m, m), γ⁻¹ τ and its derivative (m, n)."""
    P, m = system.P, system.G.shape[3]
    E = P.shape[3]
    return np.empty(E, P.dtype), np.empty(E, P.dtype), np.empty((m, m), P.dtype), np.empty((m, n), P.dtype), np.empty((m, n), P.dtype)


# The loops below index whole arrays: slices of them would be counted references, which cost more than the arithmetic


@njit(cache=True, error_model="numpy", fastmath={"contract"})
def multiply(start, column, first, values, Z, out, place, fresh):  # type: ignore[no-untyped-def]
    """out[place] = AZ, or out[place] + AZ unless fresh, A the rows from the first on; Z (n, k), up to four columns at a time."""
    k = Z.shape[1]
    for d in range(0, k, 4):
        width = min(4, k - d)
        for r in range(out.shape[1]):
            a, b, c, f = 0 * Z[0, 0], 0 * Z[0, 0], 0 * Z[0, 0], 0 * Z[0, 0]
            if not fresh:
                a = out[place, r, d]
                if width > 1:
                    b = out[place, r, d + 1]
                if width > 2:
                    c = out[place, r, d + 2]
                if width > 3:
                    f = out[place, r, d + 3]
            for e in range(start[first + r], start[first + r + 1]):
                x, j = values[e], column[e]
                a += x * Z[j, d]
                if width > 1:
                    b += x * Z[j, d + 1]
                if width > 2:
                    c += x * Z[j, d + 2]
                if width > 3:
                    f += x * Z[j, d + 3]
            out[place, r, d] = a
            if width > 1:
                out[place, r, d + 1] = b
            if width > 2:
                out[place, r, d + 2] = c
            if width > 3:
                out[place, r, d + 3] = f


@njit(cache=True, error_model="numpy", fastmath={"contract"})
def add_carried(V, carries, s, i, t, out):  # type: ignore[no-untyped-def]
    """out[i] ← out[i] + V t with V = V[s, i], t (m, k)."""
    m, k = t.shape
    for c in range(len(carries)):
        r = carries[c]
        for q in range(m):
            v = V[s, i, c, q]
            for d in range(k):
                out[i, r, d] += v * t[q, d]
