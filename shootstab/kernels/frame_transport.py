"""Transport of an orthonormal frame, and of its σ-derivative, along a fixed mesh through a linear system (see reduced_system.py).

On a fixed mesh every operation but the orthonormalization is a rational function of σ, and of that one the R factors are carried
along: D(σ) computed here is analytic to rounding, whatever the accuracy of the mesh. Arrays are real or complex, as the system's are.

Numba compiles each kernel once for real and once for complex numbers, in seconds that somebody waits: memory is made outside, and every
loop stands at one place.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numba import njit
from numpy.typing import NDArray

from shootstab.kernels.elimination import LANES
from shootstab.kernels.reduced_system import ReducedSystem, add_carried, evaluate, multiply
from shootstab.kernels.stages import combine
from shootstab.kernels.step_control import FLOOR, local_error
from shootstab.kernels.tableau import STAGES, WEIGHTS
from shootstab.kernels.tableau import A as RK_A

TABLE = np.concatenate((RK_A, WEIGHTS))  # derived: rows of weights: one for each stage, one for the end of the step, two for its errors


def transport(
    system: ReducedSystem,
    sigma: complex,
    Y: NDArray[Any],
    dY: NDArray[Any],
    tangent: bool,
    errors: NDArray[np.float64],
    frames: NDArray[Any] | None = None,
) -> tuple[float, complex]:
    """Carry Y (n×k), and dY if tangent, through all steps; both are overwritten, Y by an orthonormal frame.

    errors (N,) receives the local error of every step, each row of the frame relative to its own size. Returns (log_det, trace):
    what Y stands for is Y·R with ln det R = log_det, and d ln D/dσ = trace + what Y and dY give. frames (N + 1, n, k) receive Y before
    each orthonormalization.
    """
    n, k = Y.shape
    m, kind = system.G.shape[3], Y.dtype
    width = (len(system.column) - int(system.start[n])) // m if m else 0
    columns = 2 * k if tangent else k
    frame = np.zeros((2, n, columns + -columns % LANES), kind)  # F is [Y, dY] and zeros, sums begin with zeros
    frame[0, :, :k] = Y
    if tangent:
        frame[0, :, k : 2 * k] = dY
    sums = np.empty((4, *frame.shape[1:]), kind)
    stages = np.empty((STAGES, n + m, frame.shape[2]), kind)
    entries = np.empty((2, len(system.column)), kind)
    small = np.empty((m, 2 * (m + width)), kind)
    kept = np.empty((0, n, k), kind) if frames is None else frames
    # the same memory seen as real numbers, for operations that are real-linear
    f, s, r = (a.view(np.float64).reshape(len(a), -1) for a in (frame, sums, stages))
    values, slopes = entries
    lists, numbers = system[:6], system[6:]
    result: tuple[float, complex] = carry(
        *lists, *numbers, sigma, k, tangent, frame[0], sums, stages, f, s, r, values, slopes, small, errors, kept
    )
    Y[:] = frame[0, :, :k]
    if tangent:
        dY[:] = frame[0, :, k : 2 * k]
    return result


@njit(cache=True, error_model="numpy", fastmath={"contract"})
def carry(  # type: ignore[no-untyped-def]
    start, column, linear, higher, powers, carries, P, V, G, sigma, k, tangent, F, sums, K, f, s, r, values, slopes, small, errors, kept
):
    """The steps of `transport` for F = [Y, dY]; f, s and r are F and zeros, sums and K as real numbers, kept the frames or empty."""
    n = F.shape[0]
    log_det, trace = 0.0, 0 * sigma
    for step in range(len(errors) + 1):
        if len(kept) > 0:
            for c in range(n):
                for d in range(k):
                    kept[step, c, d] = F[c, d]
        size, along = orthonormalize(F, k, tangent)
        log_det += size
        trace += along
        if step == len(errors):
            break
        for i in range(STAGES + 3):
            # each stage is made in sums[0], then the end of the step and its two errors in the three others
            combine(f, 1 if i > STAGES else 0, r, TABLE, i, min(i, STAGES), s, max(0, i - STAGES + 1))
            if i < STAGES:
                evaluate(P, G, linear, higher, powers, step, i, sigma, values, slopes, small)
                multiply(start, column, values, slopes, sums, 0, k, tangent, K, i)
                add_carried(V, carries, step, i, K, n)
        errors[step] = error_of_step(F, K, sums, k)
        for p in range(f.shape[1]):
            f[0, p] = s[1, p]
    return log_det, trace


@njit(cache=True, error_model="numpy", inline="always")
def orthonormalize(F, k, tangent):  # type: ignore[no-untyped-def]
    """Y = QR in place, F = [Y, dY], Y (n×k), by modified Gram–Schmidt, and if tangent dY ← dY R⁻¹ less what lies in the span of Q.

    What is left out of dY changes ln D by its trace only, and would grow if it stayed. Returns ln det R and this trace. A column of zeros
    gives −∞ or NaN.
    """
    n = F.shape[0]
    log_det, trace = 0.0, 0 * F[0, 0]
    for j in range(2 * k if tangent else k):
        for i in range(min(j, k)):
            along = 0 * trace
            for c in range(n):
                along += F[c, i].conjugate() * F[c, j]
            for c in range(n):
                F[c, j] -= along * F[c, i]
                if tangent and j < k:
                    F[c, k + j] -= along * F[c, k + i]
            if j == k + i:
                trace += along
        if j < k:
            square = 0.0
            for c in range(n):
                square += F[c, j].real * F[c, j].real + F[c, j].imag * F[c, j].imag
            size = np.sqrt(square)
            log_det += np.log(size)
            inverse = 1.0 / size
            for c in range(n):
                F[c, j] *= inverse
                if tangent:
                    F[c, k + j] *= inverse
    return log_det, trace


@njit(cache=True, error_model="numpy", inline="always")
def error_of_step(F, K, sums, k):  # type: ignore[no-untyped-def]
    """The estimate of Dormand & Prince, largest over the components, each relative to the size of its row in the frame."""
    n = F.shape[0]
    worst, floor = 0.0, 0.0
    for c in range(n):
        for d in range(k):
            x = F[c, d]
            floor = max(floor, x.real * x.real + x.imag * x.imag)
    for c in range(n):
        size, e5, e3 = floor * (FLOOR * FLOOR), 0.0, 0.0
        for d in range(k):
            for which in range(5):
                # a row that starts from zero is as large as the step makes it
                x = sums[2 + which, c, d] if which < 2 else F[c, d] if which == 2 else K[0 if which == 3 else STAGES - 1, c, d]
                square = x.real * x.real + x.imag * x.imag
                # written so that a NaN wins
                if which == 0:
                    e5 = e5 if e5 != e5 or square <= e5 else square
                elif which == 1:
                    e3 = e3 if e3 != e3 or square <= e3 else square
                else:
                    size = max(size, square)
        error = 0.0 if e5 == 0.0 else local_error(e5, e3) / np.sqrt(size)
        if worst == worst and not error <= worst:
            worst = error
    return worst
