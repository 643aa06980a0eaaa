"""A prototype: the transport of frames for many σ through one sampled system, σ the fastest index, real and imaginary parts apart.

The loops of `shootstab.kernels.frame_transport`, with the innermost one over σ, so that the compiler's vectorizer takes it. No local errors
are estimated: on a mesh that serves them, values need none. One row of the reduced system at most may hold σ in C (m ≤ 1).
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from typing import Any

import numpy as np
from bench import best
from numba import njit

from shootstab.discriminants.shooting import Shooting
from shootstab.kernels.frame_transport import transport as one_by_one
from shootstab.kernels.reduced_system import ReducedSystem
from shootstab.kernels.tableau import STAGES, WEIGHTS
from shootstab.kernels.tableau import A as RK_A

Array = np.ndarray[Any, np.dtype[Any]]
TABLE = np.concatenate((RK_A, WEIGHTS[:1]))  # derived: rows of weights: one for each stage, one for the end of the step
REPEATED = 8  # chosen: single values timed together


@njit(cache=True, error_model="numpy", fastmath={"contract"}, inline="always")
def add_product(v, e, Z, at, j, c, out, place, r, d):  # type: ignore[no-untyped-def]
    """Row r, column d of out[place] += v[e] times row j, column c of Z[at], for all σ."""
    for lane in range(Z.shape[4]):
        x, y = v[e, 0, lane], v[e, 1, lane]
        a, b = Z[at, j, 0, c, lane], Z[at, j, 1, c, lane]
        out[place, r, 0, d, lane] += x * a - y * b
        out[place, r, 1, d, lane] += x * b + y * a


@njit(cache=True, error_model="numpy", fastmath={"contract"})
def carry(start, column, linear, higher, powers, carries, P, V, G, sigma, k, tangent, F, K, values, slopes, log_det, trace, work):  # type: ignore[no-untyped-def]
    """F[0] (n, 2, c, L) ← its columns carried through all steps; F (2, n, 2, c, L), K (STAGES, n + m, 2, c, L), values,
    slopes (E, 2, L), sigma (2, L), log_det (L,), trace (2, L), work (4, L)."""
    n, cols, L = F.shape[1], F.shape[3], F.shape[4]
    m = G.shape[3]
    E, E1 = len(column), len(linear)
    f = F.reshape(2, -1)
    s = K.reshape(STAGES, (n + m) * 2 * cols * L)
    size = n * 2 * cols * L
    steps = P.shape[0]
    width = (E - int(start[n])) // m if m > 0 else 0
    top = G.shape[2] - 1
    for step in range(steps + 1):
        orthonormalize(F, k, tangent, log_det, trace, work)
        if step == steps:
            break
        for i in range(STAGES + 1):
            for p in range(size):
                f[1, p] = f[0, p]
            for j in range(i):
                w = TABLE[i, j]
                if w != 0.0:
                    for p in range(size):
                        f[1, p] += w * s[j, p]
            if i == STAGES:
                for p in range(size):
                    f[0, p] = f[1, p]
                break
            # entries
            for e in range(E):
                a, b = P[step, i, e].real, P[step, i, e].imag
                for lane in range(L):
                    values[e, 0, lane] = a
                    values[e, 1, lane] = b
                    slopes[e, 0, lane] = 0.0
                    slopes[e, 1, lane] = 0.0
            for q in range(E1):
                a, b, e = P[step, i, E + q].real, P[step, i, E + q].imag, linear[q]
                for lane in range(L):
                    values[e, 0, lane] += sigma[0, lane] * a - sigma[1, lane] * b
                    values[e, 1, lane] += sigma[0, lane] * b + sigma[1, lane] * a
                    slopes[e, 0, lane] = a
                    slopes[e, 1, lane] = b
            for q in range(len(higher)):
                a, b, e = P[step, i, E + E1 + q].real, P[step, i, E + E1 + q].imag, higher[q]
                power = float(powers[q])
                for lane in range(L):
                    x, y = a, b
                    for _ in range(powers[q] - 1):
                        x, y = x * sigma[0, lane] - y * sigma[1, lane], x * sigma[1, lane] + y * sigma[0, lane]
                    slopes[e, 0, lane] += power * x
                    slopes[e, 1, lane] += power * y
                    values[e, 0, lane] += x * sigma[0, lane] - y * sigma[1, lane]
                    values[e, 1, lane] += x * sigma[1, lane] + y * sigma[0, lane]
            if m == 1:
                for lane in range(L):
                    x, y, u, v = G[step, i, top, 0, 0].real, G[step, i, top, 0, 0].imag, 0.0, 0.0
                    for j in range(top):
                        u, v = x + sigma[0, lane] * u - sigma[1, lane] * v, y + sigma[0, lane] * v + sigma[1, lane] * u
                        a, b = G[step, i, top - 1 - j, 0, 0].real, G[step, i, top - 1 - j, 0, 0].imag
                        x, y = a + sigma[0, lane] * x - sigma[1, lane] * y, b + sigma[0, lane] * y + sigma[1, lane] * x
                    inv = 1.0 / (x * x + y * y)
                    work[0, lane], work[1, lane], work[2, lane], work[3, lane] = x * inv, -y * inv, u, v
                for c in range(width):
                    e = int(start[n]) + c
                    for lane in range(L):
                        a, b = values[e, 0, lane], values[e, 1, lane]
                        x, y = a * work[0, lane] - b * work[1, lane], a * work[1, lane] + b * work[0, lane]
                        a = slopes[e, 0, lane] - (work[2, lane] * x - work[3, lane] * y)
                        b = slopes[e, 1, lane] - (work[2, lane] * y + work[3, lane] * x)
                        values[e, 0, lane], values[e, 1, lane] = x, y
                        slopes[e, 0, lane], slopes[e, 1, lane] = (
                            a * work[0, lane] - b * work[1, lane],
                            a * work[1, lane] + b * work[0, lane],
                        )
            # product
            for r in range(n + m):
                for p in range(2 * cols * L):
                    s[i, r * 2 * cols * L + p] = 0.0
                for e in range(start[r], start[r + 1]):
                    j = column[e]
                    for d in range(cols):
                        add_product(values, e, F, 1, j, d, K, i, r, d)
                    if tangent:
                        for d in range(k):
                            add_product(slopes, e, F, 1, j, d, K, i, r, k + d)
            if m == 1:
                for c in range(len(carries)):
                    r = carries[c]
                    a, b = V[step, i, c, 0].real, V[step, i, c, 0].imag
                    for d in range(cols):
                        for lane in range(L):
                            x, y = K[i, n, 0, d, lane], K[i, n, 1, d, lane]
                            K[i, r, 0, d, lane] += a * x - b * y
                            K[i, r, 1, d, lane] += a * y + b * x


@njit(cache=True, error_model="numpy", fastmath={"contract"}, inline="always")
def orthonormalize(F, k, tangent, log_det, trace, work):  # type: ignore[no-untyped-def]
    """Modified Gram–Schmidt, as in frame_transport.py, for all σ."""
    n, L = F.shape[1], F.shape[4]
    for j in range(2 * k if tangent else k):
        for i in range(min(j, k)):
            for lane in range(L):
                work[0, lane] = 0.0
                work[1, lane] = 0.0
            for c in range(n):
                for lane in range(L):
                    x, y, a, b = F[0, c, 0, i, lane], F[0, c, 1, i, lane], F[0, c, 0, j, lane], F[0, c, 1, j, lane]
                    work[0, lane] += x * a + y * b
                    work[1, lane] += x * b - y * a
            for c in range(n):
                for lane in range(L):
                    x, y = F[0, c, 0, i, lane], F[0, c, 1, i, lane]
                    F[0, c, 0, j, lane] -= work[0, lane] * x - work[1, lane] * y
                    F[0, c, 1, j, lane] -= work[0, lane] * y + work[1, lane] * x
                if tangent and j < k:
                    for lane in range(L):
                        x, y = F[0, c, 0, k + i, lane], F[0, c, 1, k + i, lane]
                        F[0, c, 0, k + j, lane] -= work[0, lane] * x - work[1, lane] * y
                        F[0, c, 1, k + j, lane] -= work[0, lane] * y + work[1, lane] * x
            if j == k + i:
                for lane in range(L):
                    trace[0, lane] += work[0, lane]
                    trace[1, lane] += work[1, lane]
        if j < k:
            for lane in range(L):
                work[2, lane] = 0.0
            for c in range(n):
                for lane in range(L):
                    x, y = F[0, c, 0, j, lane], F[0, c, 1, j, lane]
                    work[2, lane] += x * x + y * y
            for lane in range(L):
                size = np.sqrt(work[2, lane])
                log_det[lane] += np.log(size)
                work[3, lane] = 1.0 / size
            for c in range(n):
                for lane in range(L):
                    F[0, c, 0, j, lane] *= work[3, lane]
                    F[0, c, 1, j, lane] *= work[3, lane]
                if tangent:
                    for lane in range(L):
                        F[0, c, 0, k + j, lane] *= work[3, lane]
                        F[0, c, 1, k + j, lane] *= work[3, lane]


def transport(system: ReducedSystem, sigma: Array, Y: Array, dY: Array, tangent: bool) -> tuple[Array, Array, Array, Array]:
    """Orthonormal frames and tangents (L, n, k), ln det R (L,) and the traces (L,) for sigma (L,), from Y, dY (L, n, k)."""
    L, n, k = Y.shape
    m, E = system.G.shape[3], len(system.column)
    assert m <= 1, "more rows of C with sigma in them than one"
    columns = 2 * k if tangent else k
    F = np.empty((2, n, 2, columns, L))
    for place, part in ((0, Y), (k, dY))[: 1 + tangent]:
        F[0, :, 0, place : place + k] = part.real.transpose(1, 2, 0)
        F[0, :, 1, place : place + k] = part.imag.transpose(1, 2, 0)
    K = np.empty((STAGES, n + m, 2, columns, L))
    values, slopes, work = np.empty((E, 2, L)), np.empty((E, 2, L)), np.empty((4, L))
    log_det, trace = np.zeros(L), np.zeros((2, L))
    carry(*system, np.stack((sigma.real, sigma.imag)), k, tangent, F, K, values, slopes, log_det, trace, work)
    out = (F[0, :, 0] + 1j * F[0, :, 1]).transpose(2, 0, 1)
    return out[:, :, :k], out[:, :, k:], log_det, trace[0] + 1j * trace[1]


def singly(
    system: ReducedSystem, sigmas: Sequence[complex], Y: Array, dY: Array, tangent: bool, errors: Array
) -> list[tuple[float, complex, Array]]:
    """ln det R, the trace and the frame for each σ by the kernel of the package."""
    found = []
    for sigma, y, dy in zip(sigmas, Y.copy(), dY.copy(), strict=False):
        log_det, trace = one_by_one(system, sigma, y, dy, tangent, errors)
        found.append((log_det, trace, y))
    return found


def times(members: Sequence[Shooting], sigma: complex, tangent: bool, batches: Sequence[int]) -> tuple[float, list[float]]:
    """Seconds of one transport next to σ, alone and as one of so many, summed over subsystems; both give the same to rounding."""
    alone, together = 0.0, [0.0] * len(batches)
    for member in members:
        system, errors = member.sampled.system, np.empty(member.steps)
        sigmas = sigma * (1 + 1e-6 * np.arange(max(*batches, REPEATED)))
        far = [member.far(complex(s)) for s in sigmas]
        Y, dY = np.array([f.frame for f in far]), np.array([f.tangent for f in far])
        given = system, sigmas[:REPEATED].tolist(), Y, dY, tangent, errors
        singles = singly(*given)
        alone += best(partial(singly, *given)) / REPEATED
        for place, L in enumerate(batches):
            lanes = system, sigmas[:L], np.ascontiguousarray(Y[:L]), np.ascontiguousarray(dY[:L]), tangent
            frames, _, log_det, trace = transport(*lanes)
            for i, (log, along, y) in enumerate(singles[:L]):
                assert abs(log_det[i] - log) < 1e-11 and abs(trace[i] - along) < 1e-9 * (1 + abs(along)), "lanes differ"
                assert np.abs(frames[i] - y).max() < 1e-11, "lanes differ"
            together[place] += best(partial(transport, *lanes)) / L
    return alone, together
