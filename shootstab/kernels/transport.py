"""Transport of an orthonormal frame, and of its σ-derivative, along a fixed mesh through a linear system ψ′ = A(z; σ) ψ.

The system comes as a table, sampled at the Runge–Kutta abscissae of every step and reduced so that no linear system of size n is left
to solve (see discriminants/table.py):

    A(σ) = X0 + σ X1 + V γ(σ)⁻¹ t(σ),   γ = γ0 + σ γ1 (m×m),   t = t0 + σ t1 + σ² t2 (m×n).

On a fixed mesh every operation but the orthonormalization is a rational function of σ, and of that one the R factors are carried
along: D(σ) computed here is analytic to rounding, whatever the accuracy of the mesh.
"""

from __future__ import annotations

import numpy as np
from numba import njit

from shootstab.kernels.tableau import E3, E5, STAGES
from shootstab.kernels.tableau import A as RK_A
from shootstab.kernels.tableau import B as RK_B


@njit(cache=True, error_model="numpy")
def orthonormalize(Y, R):  # type: ignore[no-untyped-def]
    """Y = QR in place (n×k), by modified Gram–Schmidt; returns Σ ln r_ii. A column of zeros gives −∞."""
    n, k = Y.shape
    log_det = 0.0
    for j in range(k):
        for i in range(j):
            r = 0j
            for c in range(n):
                r += Y[c, i].conjugate() * Y[c, j]
            R[i, j] = r
            for c in range(n):
                Y[c, j] -= r * Y[c, i]
        size = 0.0
        for c in range(n):
            size += Y[c, j].real ** 2 + Y[c, j].imag ** 2
        size = np.sqrt(size)
        R[j, j] = size
        log_det += np.log(size)
        for c in range(n):
            Y[c, j] /= size
    return log_det


@njit(cache=True, error_model="numpy")
def reduce_tangent(Y, dY, R):  # type: ignore[no-untyped-def]
    """dY ← dY R⁻¹ − Q tr-part: what lies in span Q changes ln D by its trace only, which is returned and taken out."""
    n, k = Y.shape
    for j in range(k):
        for i in range(j):
            for c in range(n):
                dY[c, j] -= R[i, j] * dY[c, i]
        for c in range(n):
            dY[c, j] /= R[j, j]
    trace = 0j
    for j in range(k):
        for i in range(k):
            s = 0j
            for c in range(n):
                s += Y[c, i].conjugate() * dY[c, j]
            R[i, j] = s
        trace += R[j, j]
    for j in range(k):
        for i in range(k):
            for c in range(n):
                dY[c, j] -= R[i, j] * Y[c, i]
    return trace


@njit(cache=True, error_model="numpy")
def solve_small(G, T):  # type: ignore[no-untyped-def]
    """T ← G⁻¹ T for m×m G, by elimination with partial pivoting; G is destroyed."""
    m, n = T.shape
    for p in range(m):
        best = p
        for i in range(p + 1, m):
            if abs(G[i, p]) > abs(G[best, p]):
                best = i
        if best != p:
            for c in range(m):
                G[p, c], G[best, c] = G[best, c], G[p, c]
            for c in range(n):
                T[p, c], T[best, c] = T[best, c], T[p, c]
        # numba raises on complex division by zero: a singular matrix gives NaN here, and the step is refused
        inverse = 1.0 / G[p, p] if G[p, p] != 0j else complex(np.nan, np.nan)
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
def system_matrix(X, V, G, T, sigma, A, dA, work, tangent):  # type: ignore[no-untyped-def]
    """A(σ) and, if tangent, dA/dσ at one point. X (2,n,n), V (n,m), G (2,m,m), T (3,m,n); work (3,max(m,1),n)."""
    n = A.shape[0]
    m = V.shape[1]
    for i in range(n):
        for j in range(n):
            A[i, j] = X[0, i, j] + sigma * X[1, i, j]
            if tangent:
                dA[i, j] = X[1, i, j]
    if m == 0:
        return
    small, right, slope = work[0, :, :m], work[1], work[2]
    for i in range(m):
        for j in range(m):
            small[i, j] = G[0, i, j] + sigma * G[1, i, j]
        for j in range(n):
            right[i, j] = T[0, i, j] + sigma * (T[1, i, j] + sigma * T[2, i, j])
    solve_small(small, right)
    if tangent:
        # (γ⁻¹ t)′ = γ⁻¹ (t′ − γ1 γ⁻¹ t)
        for i in range(m):
            for j in range(m):
                small[i, j] = G[0, i, j] + sigma * G[1, i, j]
            for j in range(n):
                slope[i, j] = T[1, i, j] + 2.0 * sigma * T[2, i, j]
                for q in range(m):
                    slope[i, j] -= G[1, i, q] * right[q, j]
        solve_small(small, slope)
    for i in range(n):
        for q in range(m):
            v = V[i, q]
            if v != 0j:
                for j in range(n):
                    A[i, j] += v * right[q, j]
                    if tangent:
                        dA[i, j] += v * slope[q, j]


@njit(cache=True, error_model="numpy")
def transport(h, X, V, G, T, sigma, Y, dY, tangent, errors):  # type: ignore[no-untyped-def]
    """Carry Y (n×k), and dY if tangent, through all steps; both are overwritten, Y by an orthonormal frame.

    h (N,), X (N,12,2,n,n), V (N,12,n,m), G (N,12,2,m,m), T (N,12,3,m,n). errors (N,) receives the local error of every step,
    each row of the frame relative to its own size. Returns (log_det, trace): what Y stands for is Y·R with ln det R = log_det, and
    d ln D/dσ = trace + what Y and dY give.
    """
    steps = len(h)
    n, k = Y.shape
    A = np.empty((n, n), dtype=np.complex128)
    dA = np.empty((n, n), dtype=np.complex128)
    work = np.empty((3, max(V.shape[3], 1), n), dtype=np.complex128)
    K = np.empty((STAGES, n, k), dtype=np.complex128)
    L = np.empty((STAGES, n, k), dtype=np.complex128)
    Z = np.empty((n, k), dtype=np.complex128)
    W = np.empty((n, k), dtype=np.complex128)
    R = np.zeros((k, k), dtype=np.complex128)
    log_det = orthonormalize(Y, R)
    trace = reduce_tangent(Y, dY, R) if tangent else 0j
    for s in range(steps):
        step = h[s]
        for i in range(STAGES):
            Z[:] = Y
            W[:] = dY
            for j in range(i):
                a = RK_A[i, j]
                if a != 0.0:
                    w = step * a
                    for c in range(n):
                        for d in range(k):
                            Z[c, d] += w * K[j, c, d]
                    if tangent:
                        for c in range(n):
                            for d in range(k):
                                W[c, d] += w * L[j, c, d]
            system_matrix(X[s, i], V[s, i], G[s, i], T[s, i], sigma, A, dA, work, tangent)
            for c in range(n):
                for d in range(k):
                    K[i, c, d] = 0j
                for q in range(n):
                    a_cq = A[c, q]
                    if a_cq != 0j:
                        for d in range(k):
                            K[i, c, d] += a_cq * Z[q, d]
            if tangent:
                for c in range(n):
                    for d in range(k):
                        L[i, c, d] = 0j
                    for q in range(n):
                        a_cq = A[c, q]
                        da_cq = dA[c, q]
                        for d in range(k):
                            L[i, c, d] += a_cq * W[q, d] + da_cq * Z[q, d]
        errors[s] = _local_error(abs(step), K, Y)
        for i in range(STAGES):
            w = step * RK_B[i]
            if w != 0j:
                for c in range(n):
                    for d in range(k):
                        Y[c, d] += w * K[i, c, d]
                        if tangent:
                            dY[c, d] += w * L[i, c, d]
        log_det += orthonormalize(Y, R)
        if tangent:
            trace += reduce_tangent(Y, dY, R)
    return log_det, trace


@njit(cache=True, error_model="numpy")
def _local_error(length, K, Y):  # type: ignore[no-untyped-def]
    """The estimate of Dormand & Prince, largest over the components, each relative to the size of its row in the frame."""
    stages, n, k = K.shape
    worst = 0.0
    floor = 0.0
    for c in range(n):
        for d in range(k):
            floor = max(floor, abs(Y[c, d]))
    floor *= 1e-9
    for c in range(n):
        size, e5, e3 = floor, 0.0, 0.0
        for d in range(k):
            # a row that starts from zero is as large as the step makes it
            size = max(size, abs(Y[c, d]), length * abs(K[0, c, d]), length * abs(K[stages - 1, c, d]))
            sum5, sum3 = 0j, 0j
            for i in range(stages):
                sum5 += E5[i] * K[i, c, d]
                sum3 += E3[i] * K[i, c, d]
            size5, size3 = sum5.real**2 + sum5.imag**2, sum3.real**2 + sum3.imag**2
            # written so that a NaN wins
            if e5 == e5 and not size5 <= e5:
                e5 = size5
            if e3 == e3 and not size3 <= e3:
                e3 = size3
        error = 0.0 if e5 == 0.0 else length * e5 / np.sqrt(e5 + 0.01 * e3) / size
        if worst == worst and not error <= worst:
            worst = error
    return worst
