"""Transport of Plücker coordinates, and of their σ-derivative, along a fixed mesh: y′ = A^(k)(z; σ) y.

The system comes as in frame_transport.py. Growth goes into a power of 2, step by step and without rounding: on a fixed mesh y is a rational
function of σ, and D(σ) = w·y analytic to rounding whatever the accuracy of the mesh. Matched at z above the wall instead, with u ∈ ∧^(n−k)
the space that meets the wall's conditions, carried up to z, D is (y ∧ u)(z) exp(∫ tr A from z to the wall): the trace enters there only.
Taking its share out of A^(k) here, as for a matching in between, was tried: the trace of the chute's A lies in directions that y does not
hold, and the steps became more (50 against 41 for the high flow at 1e−11).
"""

from __future__ import annotations

import numpy as np
from numba import njit

from shootstab.kernels.exterior import apply, row_sizes
from shootstab.kernels.reduced_system import system_matrix, workspace
from shootstab.kernels.stages import combine, reals
from shootstab.kernels.step_control import FLOOR, local_error
from shootstab.kernels.tableau import E3, E5, STAGES, WEIGHTS
from shootstab.kernels.tableau import A as RK_A

LOG_2 = float(np.log(2.0))  # exact


@njit(cache=True, error_model="numpy", fastmath={"contract"})
def transport_minors(system, sigma, subsets, row, column, sign, start, y, dy, tangent, errors):  # type: ignore[no-untyped-def]
    """Carry y (N,), and dy if tangent, through all steps; both are overwritten.

    errors (N,) receives the local error of every step. subsets, row, column, sign, start are those of exterior.Induced. Returns log_scale:
    what y stands for is y · exp(log_scale).
    """
    n = len(system.start) - 1 - system.G.shape[3]
    size = len(y)
    A = np.empty((n, n), dtype=y.dtype)
    dA = np.zeros((n, n), dtype=y.dtype)
    work = workspace(system, n)
    K = np.empty((STAGES, size), dtype=y.dtype)
    L = np.empty((STAGES, size), dtype=y.dtype)
    Z = np.empty(size, dtype=y.dtype)
    W = np.empty(size, dtype=y.dtype)
    before = np.empty(size, dtype=y.dtype)
    scales = np.empty((2, n))
    # the same memory as real numbers, for what is real-linear
    reals_of_y, reals_of_dy, z, w = reals(y), reals(dy), reals(Z), reals(W)
    stages, slopes = reals(K).reshape(STAGES, -1), reals(L).reshape(STAGES, -1)
    exponent = halve(y, dy)
    for s in range(len(errors)):
        for i in range(STAGES):
            combine(reals_of_y, 0, stages, RK_A, i, i, z, 0)
            system_matrix(system, s, i, sigma, A, dA, work)
            for c in range(size):
                K[i, c] = 0.0
                L[i, c] = 0.0
            apply(A, row, column, sign, start, Z, K, i)
            if tangent:
                combine(reals_of_dy, 0, slopes, RK_A, i, i, w, 0)
                apply(A, row, column, sign, start, W, L, i)
                apply(dA, row, column, sign, start, Z, L, i)
        before[:] = y
        combine(reals_of_y, 0, stages, WEIGHTS, 0, STAGES, reals_of_y, 0)
        if tangent:
            combine(reals_of_dy, 0, slopes, WEIGHTS, 0, STAGES, reals_of_dy, 0)
        errors[s] = error_of_step(K, before, y, subsets, scales)
        exponent += halve(y, dy)
    return LOG_2 * exponent


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
def error_of_step(K, y, ahead, subsets, scales):  # type: ignore[no-untyped-def]
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
        sum5, sum3 = 0 * y[0], 0 * y[0]
        for i in range(STAGES):
            sum5 += E5[i] * K[i, c]
            sum3 += E3[i] * K[i, c]
        e5, e3 = sum5.real**2 + sum5.imag**2, sum3.real**2 + sum3.imag**2
        if e5 != 0.0:
            size = np.sqrt(total)
            for d in range(subsets.shape[1]):
                size *= max(scales[0, subsets[c, d]], FLOOR * largest)
            error = local_error(e5, e3) / size
            if np.isnan(error):
                return error
            worst = max(worst, error)
    return worst
