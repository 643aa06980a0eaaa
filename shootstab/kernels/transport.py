"""Transport of an orthonormal frame, and of its σ-derivative, along a fixed mesh through a linear system ψ′ = A(z; σ) ψ.

The system comes sampled at the Runge–Kutta abscissae of every step and reduced so that no linear system of size n is left to solve
(see discriminants/table.py): with t from 0 to 1 over a step of length h, dψ/dt = hA ψ and

    hA(σ) = X(σ) + V γ(σ)⁻¹ τ(σ),   γ = G0 + σ G1 (m×m),   X and τ (m×n) polynomials in σ.

On a fixed mesh every operation but the orthonormalization is a rational function of σ, and of that one the R factors are carried
along: D(σ) computed here is analytic to rounding, whatever the accuracy of the mesh. Arrays are float64 where all is real, σ too, and
complex128 otherwise; the loops are the same.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from shootstab.kernels.tableau import STAGES, WEIGHTS
from shootstab.kernels.tableau import A as RK_A

FLOOR = 1e-9  # of the largest row: rows smaller than this count as so large


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


@njit(cache=True, error_model="numpy")
def orthonormalize(Y, R):  # type: ignore[no-untyped-def]
    """Y = QR in place (n×k), by modified Gram–Schmidt; returns ln det R. A column of zeros gives −∞ or NaN."""
    n, k = Y.shape
    log_det = 0.0
    for j in range(k):
        for i in range(j):
            r = 0 * R[i, j]
            for c in range(n):
                r += Y[c, i].conjugate() * Y[c, j]
            R[i, j] = r
            for c in range(n):
                Y[c, j] -= r * Y[c, i]
        square = 0.0
        for c in range(n):
            square += Y[c, j].real ** 2 + Y[c, j].imag ** 2
        size = np.sqrt(square)
        R[j, j] = size
        log_det += np.log(size)
        inverse = 1.0 / size
        for c in range(n):
            Y[c, j] *= inverse
    return log_det


@njit(cache=True, error_model="numpy")
def reduce_tangent(Y, dY, R):  # type: ignore[no-untyped-def]
    """dY ← dY R⁻¹ less what lies in the span of Y: that changes ln D by its trace only, which is returned, and would grow if it stayed.

    R is overwritten.
    """
    n, k = Y.shape
    for j in range(k):
        for i in range(j):
            for c in range(n):
                dY[c, j] -= R[i, j] * dY[c, i]
        inverse = 1.0 / R[j, j].real
        for c in range(n):
            dY[c, j] *= inverse
    trace = 0 * R[0, 0]
    for j in range(k):
        for i in range(k):
            along = 0 * R[0, 0]
            for c in range(n):
                along += Y[c, i].conjugate() * dY[c, j]
            R[i, j] = along
        trace += R[j, j]
    for j in range(k):
        for i in range(k):
            for c in range(n):
                dY[c, j] -= R[i, j] * Y[c, i]
    return trace


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


@njit(cache=True, error_model="numpy", fastmath={"contract"})
def evaluate(P, G, s, i, sigma, values, slopes, small, tangent):  # type: ignore[no-untyped-def]
    """The entries of [X; τ] (E,), if tangent their σ-derivatives, and γ (m, m), at abscissa i of step s."""
    if P.shape[2] == 2:
        for e in range(len(values)):
            values[e] = P[s, i, 0, e] + sigma * P[s, i, 1, e]
            slopes[e] = P[s, i, 1, e]
    else:
        for e in range(len(values)):
            values[e] = P[s, i, 0, e] + sigma * (P[s, i, 1, e] + sigma * P[s, i, 2, e])
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
    evaluate(P, G, s, i, sigma, values, slopes, small, tangent)
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


@njit(cache=True, error_model="numpy", fastmath={"contract"})
def combine(y, K, weights, row, count, out):  # type: ignore[no-untyped-def]
    """out = y + Σ_j weights[row, j] K_j over the first count stages, all as real numbers: y, out (p,), K (12, p)."""
    for p in range(len(out)):
        out[p] = y[p]
    for j in range(count):
        w = weights[row, j]
        if w != 0.0:
            for p in range(len(out)):
                out[p] += w * K[j, p]


@njit(cache=True, error_model="numpy")
def transport(system, sigma, Y, dY, tangent, errors):  # type: ignore[no-untyped-def]
    """Carry Y (n×k), and dY if tangent, through all steps; both are overwritten, Y by an orthonormal frame.

    errors (N,) receives the local error of every step, each row of the frame relative to its own size. Returns (log_det, trace):
    what Y stands for is Y·R with ln det R = log_det, and d ln D/dσ = trace + what Y and dY give.
    """
    start, column, carries, P, V, G = system
    n, k = Y.shape
    m = G.shape[3]
    K, L = np.empty((STAGES, n, k), Y.dtype), np.empty((STAGES, n, k), Y.dtype)
    Z, W = np.empty_like(Y), np.empty_like(Y)
    t, dt = np.empty((1, m, k), Y.dtype), np.empty((1, m, k), Y.dtype)
    E = np.empty((2, n, k), Y.dtype)
    R = np.zeros((k, k), Y.dtype)
    values, slopes, small, _, _ = workspace(system, n)
    # the same memory as real numbers, for what is real-linear
    y, dy, z, w, fifth, third = reals(Y), reals(dY), reals(Z), reals(W), reals(E[0]), reals(E[1])
    ks, ls, t0, dt0 = reals(K).reshape(STAGES, -1), reals(L).reshape(STAGES, -1), t[0], dt[0]
    log_det = orthonormalize(Y, R)
    trace = reduce_tangent(Y, dY, R) if tangent else 0 * R[0, 0]
    for s in range(len(errors)):
        for i in range(STAGES):
            evaluate(P, G, s, i, sigma, values, slopes, small, tangent)
            combine(y, ks, RK_A, i, i, z)
            multiply(start, column, 0, values, Z, K, i, True)
            if m > 0:
                multiply(start, column, n, values, Z, t, 0, True)
                solve_small(small, t0)
                add_carried(V, carries, s, i, t0, K)
            if tangent:
                combine(dy, ls, RK_A, i, i, w)
                multiply(start, column, 0, values, W, L, i, True)
                multiply(start, column, 0, slopes, Z, L, i, False)
                if m > 0:
                    # γ dt = τ dZ + τ′ Z − G1 t
                    multiply(start, column, n, values, W, dt, 0, True)
                    multiply(start, column, n, slopes, Z, dt, 0, False)
                    for a in range(m):
                        for b in range(m):
                            small[a, b] = G[s, i, 0, a, b] + sigma * G[s, i, 1, a, b]
                            for d in range(k):
                                dt0[a, d] -= G[s, i, 1, a, b] * t0[b, d]
                    solve_small(small, dt0)
                    add_carried(V, carries, s, i, dt0, L)
        E[:] = 0.0
        combine(fifth, ks, WEIGHTS, 1, STAGES, fifth)
        combine(third, ks, WEIGHTS, 2, STAGES, third)
        errors[s] = _local_error(Y, K, E)
        combine(y, ks, WEIGHTS, 0, STAGES, y)
        log_det += orthonormalize(Y, R)
        if tangent:
            combine(dy, ls, WEIGHTS, 0, STAGES, dy)
            trace += reduce_tangent(Y, dY, R)
    return log_det, trace


@njit(cache=True, error_model="numpy")
def reals(a):  # type: ignore[no-untyped-def]
    """The real numbers in a contiguous array, real and imaginary parts in turn: a view (p,)."""
    return a.reshape(-1).view(np.float64)


@njit(cache=True, error_model="numpy")
def _local_error(Y, K, E):  # type: ignore[no-untyped-def]
    """The estimate of Dormand & Prince, largest over the components, each relative to the size of its row in the frame."""
    n, k = Y.shape
    worst, floor = 0.0, 0.0
    for c in range(n):
        for d in range(k):
            floor = max(floor, square(Y[c, d]))
    floor *= FLOOR * FLOOR
    for c in range(n):
        size, e5, e3 = floor, 0.0, 0.0
        for d in range(k):
            # a row that starts from zero is as large as the step makes it
            size = max(size, square(Y[c, d]), square(K[0, c, d]), square(K[STAGES - 1, c, d]))
            size5, size3 = square(E[0, c, d]), square(E[1, c, d])
            # written so that a NaN wins
            if e5 == e5 and not size5 <= e5:
                e5 = size5
            if e3 == e3 and not size3 <= e3:
                e3 = size3
        error = 0.0 if e5 == 0.0 else e5 / np.sqrt((e5 + 0.01 * e3) * size)
        if worst == worst and not error <= worst:
            worst = error
    return worst

