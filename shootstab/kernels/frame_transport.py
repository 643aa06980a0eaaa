"""Transport of an orthonormal frame, and of its σ-derivative, along a fixed mesh through a linear system (see reduced_system.py).

On a fixed mesh every operation but the orthonormalization is a rational function of σ, and of that one the R factors are carried
along: D(σ) computed here is analytic to rounding, whatever the accuracy of the mesh. Arrays are real or complex, as the system's are.
"""

from __future__ import annotations

import numpy as np
from numba import njit

from shootstab.kernels.elimination import solve_small, square
from shootstab.kernels.reduced_system import add_carried, evaluate, multiply, multiply_with_slope, small_entry, workspace
from shootstab.kernels.stages import combine, reals
from shootstab.kernels.step_control import FLOOR, local_error
from shootstab.kernels.tableau import STAGES, WEIGHTS
from shootstab.kernels.tableau import A as RK_A


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


@njit(cache=True, error_model="numpy", fastmath={"contract"})
def transport(system, sigma, Y, dY, tangent, errors):  # type: ignore[no-untyped-def]
    """Carry Y (n×k), and dY if tangent, through all steps; both are overwritten, Y by an orthonormal frame.

    errors (N,) receives the local error of every step, each row of the frame relative to its own size. Returns (log_det, trace):
    what Y stands for is Y·R with ln det R = log_det, and d ln D/dσ = trace + what Y and dY give.
    """
    start, column, linear, higher, powers, carries, P, V, G = system
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
            evaluate(P, G, linear, higher, powers, s, i, sigma, values, slopes, small)
            combine(y, ks, RK_A, i, i, z)
            if not tangent:
                multiply(start, column, 0, values, Z, K, i)
                if m > 0:
                    multiply(start, column, n, values, Z, t, 0)
                    solve_small(small, t0)
                    add_carried(V, carries, s, i, t0, K)
                continue
            combine(dy, ls, RK_A, i, i, w)
            multiply_with_slope(start, column, 0, values, slopes, Z, W, K, L, i)
            if m > 0:
                # γ t = τ Z and γ dt = τ W + τ′ Z − γ′ t
                multiply_with_slope(start, column, n, values, slopes, Z, W, t, dt, 0)
                solve_small(small, t0)
                for a in range(m):
                    for b in range(m):
                        small[a, b], turn = small_entry(G, s, i, a, b, sigma)
                        for d in range(k):
                            dt0[a, d] -= turn * t0[b, d]
                solve_small(small, dt0)
                add_carried(V, carries, s, i, t0, K)
                add_carried(V, carries, s, i, dt0, L)
        E[:] = 0.0
        combine(fifth, ks, WEIGHTS, 1, STAGES, fifth)
        combine(third, ks, WEIGHTS, 2, STAGES, third)
        errors[s] = _error_of_step(Y, K, E)
        combine(y, ks, WEIGHTS, 0, STAGES, y)
        log_det += orthonormalize(Y, R)
        if tangent:
            combine(dy, ls, WEIGHTS, 0, STAGES, dy)
            trace += reduce_tangent(Y, dY, R)
    return log_det, trace


@njit(cache=True, error_model="numpy")
def _error_of_step(Y, K, E):  # type: ignore[no-untyped-def]
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
        error = 0.0 if e5 == 0.0 else local_error(e5, e3) / np.sqrt(size)
        if worst == worst and not error <= worst:
            worst = error
    return worst
