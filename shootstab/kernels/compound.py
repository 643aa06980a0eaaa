"""Transport of Plücker coordinates, and of their σ-derivative, along a fixed mesh: y′ = A^(k)(z; σ) y.

The system comes as in transport.py. The share of the trace, y′ = (A − (tr A/n) I)^(k) y, is taken out and its integral returned; what
growth is left goes into a power of 2, step by step. Both are exact in σ: on a fixed mesh all is a rational function of σ, so
that D(σ) = w·y is analytic to rounding whatever the accuracy of the mesh.
"""

from __future__ import annotations

import numpy as np
from numba import njit

from shootstab.kernels.exterior import apply, row_sizes
from shootstab.kernels.tableau import E3, E5, STAGES
from shootstab.kernels.tableau import A as RK_A
from shootstab.kernels.tableau import B as RK_B
from shootstab.kernels.transport import system_matrix

LOG_2 = float(np.log(2.0))
FLOOR = 1e-9  # of the largest row: rows smaller than this count as so large


@njit(cache=True, error_model="numpy")
def transport_minors(h, X, V, G, T, sigma, subsets, row, column, sign, start, y, dy, tangent, errors):  # type: ignore[no-untyped-def]
    """Carry y (N,), and dy if tangent, through all steps; both are overwritten.

    errors receives the local error of every step. Returns (log_scale, trace, dtrace): what y stands for is y · exp(log_scale + trace),
    with trace = (k/n) ∫ tr A dz and dtrace its σ-derivative, not contained in dy.
    """
    n = X.shape[3]
    size = len(y)
    share = subsets.shape[1] / n
    A = np.empty((n, n), dtype=np.complex128)
    dA = np.zeros((n, n), dtype=np.complex128)
    work = np.empty((3, max(V.shape[3], 1), n), dtype=np.complex128)
    K = np.empty((STAGES, size), dtype=np.complex128)
    L = np.empty((STAGES, size), dtype=np.complex128)
    Z = np.empty(size, dtype=np.complex128)
    W = np.empty(size, dtype=np.complex128)
    before = np.empty(size, dtype=np.complex128)
    scales = np.empty((2, n))
    log_scale, trace, dtrace = LOG_2 * halve(y, dy), 0j, 0j
    for s in range(len(h)):
        step = h[s]
        for i in range(STAGES):
            Z[:] = y
            W[:] = dy
            for j in range(i):
                a = RK_A[i, j]
                if a != 0.0:
                    w = step * a
                    for c in range(size):
                        Z[c] += w * K[j, c]
                    if tangent:
                        for c in range(size):
                            W[c] += w * L[j, c]
            system_matrix(X[s, i], V[s, i], G[s, i], T[s, i], sigma, A, dA, work, tangent)
            mean = remove_trace(A)
            trace += step * RK_B[i] * share * mean * n
            K[i] = 0j
            apply(A, row, column, sign, start, Z, K[i])
            if tangent:
                mean = remove_trace(dA)
                dtrace += step * RK_B[i] * share * mean * n
                L[i] = 0j
                apply(A, row, column, sign, start, W, L[i])
                apply(dA, row, column, sign, start, Z, L[i])
        before[:] = y
        for i in range(STAGES):
            w = step * RK_B[i]
            if w != 0j:
                for c in range(size):
                    y[c] += w * K[i, c]
                    if tangent:
                        dy[c] += w * L[i, c]
        errors[s] = local_error(abs(step), K, before, y, subsets, scales)
        log_scale += LOG_2 * halve(y, dy)
    return log_scale, trace, dtrace


@njit(cache=True, error_model="numpy")
def remove_trace(A):  # type: ignore[no-untyped-def]
    """A ← A − (tr A/n) I; returns tr A/n."""
    n = A.shape[0]
    mean = 0j
    for i in range(n):
        mean += A[i, i] / n
    for i in range(n):
        A[i, i] -= mean
    return mean


@njit(cache=True, error_model="numpy")
def halve(y, dy):  # type: ignore[no-untyped-def]
    """Divide both by the power of 2 that brings the largest |y_I| to [1, 2), without rounding; returns the exponent."""
    largest = 0.0
    for c in range(len(y)):
        largest = max(largest, abs(y[c]))
    if not 0.0 < largest < np.inf:
        return 0.0
    exponent = np.floor(np.log2(largest))
    factor = 2.0**-exponent
    for c in range(len(y)):
        y[c] *= factor
        dy[c] *= factor
    return exponent


@njit(cache=True, error_model="numpy")
def local_error(length, K, y, ahead, subsets, scales):  # type: ignore[no-untyped-def]
    """The estimate of Dormand & Prince, largest over the coordinates, each relative to |y| Π_{i∈I} r_i with r_i the sizes of the rows.

    A minor of an orthonormal frame is no larger than the product of its rows' norms (Hadamard), and a frame whose rows are right to a
    relative ε has minors right to kε of that product: the coordinates are held as the frame's rows would be, however the rows are graded.
    """
    total = row_sizes(y, subsets, scales[0])
    # a row that starts from zero is as large as the step makes it
    row_sizes(ahead, subsets, scales[1])
    largest = 0.0
    for i in range(scales.shape[1]):
        scales[0, i] = max(scales[0, i], scales[1, i])
        largest = max(largest, scales[0, i])
    worst = 0.0
    for c in range(len(y)):
        sum5, sum3 = 0j, 0j
        for i in range(STAGES):
            sum5 += E5[i] * K[i, c]
            sum3 += E3[i] * K[i, c]
        e5, e3 = sum5.real**2 + sum5.imag**2, sum3.real**2 + sum3.imag**2
        if e5 != 0.0:
            size = np.sqrt(total)
            for d in range(subsets.shape[1]):
                size *= max(scales[0, subsets[c, d]], FLOOR * largest)
            error = length * e5 / np.sqrt(e5 + 0.01 * e3) / size
            # written so that a NaN wins
            if not error <= worst:
                worst = error
    return worst
