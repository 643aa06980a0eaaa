"""Transport of a chart of the Grassmannian, and of its σ-derivative, along a fixed mesh.

A k-dimensional space near the coordinate space of k pivot rows p is the range of Y = [I; S] U, the pivot rows first, and ψ′ = Aψ means

    S′ = A_qp + A_qq S − S (A_pp + A_pq S),   (ln det U)′ = tr(A_pp + A_pq S)

with q the other rows (Scott, J. Comput. Phys. 12 (1973) 334). Where S grows, a row of it changes places with a pivot; so the
space is followed through the poles of S (Ledoux, Malham & Thümmler, Math. Comp. 79 (2010) 1585). An exchange of the i-th other row
with the j-th pivot multiplies det U by S_ij; with the largest of S chosen, |S| ends small and det Y[p] near its maximum over p.
"""

from __future__ import annotations

import numpy as np
from numba import njit

from shootstab.kernels.elimination import det_with_slope, factorize, substitute
from shootstab.kernels.reduced_system import system_matrix, workspace
from shootstab.kernels.stages import combine, reals
from shootstab.kernels.step_control import FLOOR, local_error
from shootstab.kernels.tableau import E3, E5, STAGES, WEIGHTS
from shootstab.kernels.tableau import A as RK_A
from shootstab.kernels.tableau import B as RK_B

SMALL = 1.1  # the charts chosen have no |S_ij| beyond this at a node; rounding grows with its square, and the steps are no fewer


@njit(cache=True, error_model="numpy", fastmath={"contract"})
def transport_chart(system, sigma, units, order, S, dS, tangent, errors, swaps, choose):  # type: ignore[no-untyped-def]
    """Carry S (n−k, k), and dS if tangent, through all steps; both are overwritten, and so is order.

    The equation is that of ψ̃_i = ψ_i/units_i. order (n,) lists the rows of the state, the k pivots first. swaps (M, 3) lists the
    exchanges (node, i, j); with choose they are chosen anew. errors (N,) receives the local error of every step. Returns (log_det,
    dlog_det, largest, swaps): ln det U and its σ-derivative, the largest |S_ij| at a node, and the exchanges made.
    """
    steps = len(errors)
    rest, k = S.shape
    n = rest + k
    A = np.empty((n, n), dtype=S.dtype)
    dA = np.zeros((n, n), dtype=S.dtype)
    B = np.empty((n, n), dtype=S.dtype)
    dB = np.empty((n, n), dtype=S.dtype)
    work = workspace(system, n)
    K = np.empty((STAGES, rest, k), dtype=S.dtype)
    L = np.empty((STAGES, rest, k), dtype=S.dtype)
    Z = np.empty((rest, k), dtype=S.dtype)
    W = np.empty((rest, k), dtype=S.dtype)
    M = np.empty((2, k, k), dtype=S.dtype)
    traces = np.empty(STAGES, dtype=S.dtype)
    ratios = units / units.reshape(n, 1)
    # the same memory as real numbers, for what is real-linear
    reals_of_S, reals_of_dS, z, w = reals(S), reals(dS), reals(Z), reals(W)
    stages, slopes = reals(K).reshape(STAGES, -1), reals(L).reshape(STAGES, -1)
    log_det, dlog_det, largest, made = 0j, 0j, 0.0, 0
    for s in range(steps + 1):
        while True:
            if choose:
                i, j = farthest(S)
                if i < 0 or not SMALL < abs(S[i, j]) < np.inf:
                    break
                if made == len(swaps):
                    longer = np.empty((2 * made + 8, 3), dtype=np.int64)
                    longer[:made] = swaps
                    swaps = longer
                swaps[made] = s, i, j
            else:
                if made == len(swaps) or swaps[made, 0] != s:
                    break
                i, j = swaps[made, 1], swaps[made, 2]
            made += 1
            if S[i, j] == 0.0:
                return log_det, dlog_det, np.inf, swaps[:made]
            log_det += np.log(S[i, j] + 0j)
            dlog_det += dS[i, j] / S[i, j]
            exchange(S, dS, i, j, tangent)
            order[j], order[k + i] = order[k + i], order[j]
        i, j = farthest(S)
        if i >= 0 and not abs(S[i, j]) <= largest:
            largest = abs(S[i, j])
        if s == steps:
            break
        for stage in range(STAGES):
            combine(reals_of_S, 0, stages, RK_A, stage, stage, z, 0)
            system_matrix(system, s, stage, sigma, A, dA, work)
            gather(A, order, ratios, B)
            traces[stage] = riccati(B, Z, M, K, stage)
            log_det += RK_B[stage] * traces[stage]
            if tangent:
                combine(reals_of_dS, 0, slopes, RK_A, stage, stage, w, 0)
                gather(dA, order, ratios, dB)
                dlog_det += RK_B[stage] * riccati_tangent(B, dB, Z, W, M, L, stage)
        errors[s] = error_of_step(K, traces, S)
        combine(reals_of_S, 0, stages, WEIGHTS, 0, STAGES, reals_of_S, 0)
        if tangent:
            combine(reals_of_dS, 0, slopes, WEIGHTS, 0, STAGES, reals_of_dS, 0)
    return log_det, dlog_det, largest, swaps[:made]


@njit(cache=True, error_model="numpy", inline="always")
def gather(A, order, ratios, B):  # type: ignore[no-untyped-def]
    """B ← A in the units, ratios[i, j] = units_j/units_i, and in the order of the chart."""
    for a in range(len(order)):
        for b in range(len(order)):
            B[a, b] = A[order[a], order[b]] * ratios[order[a], order[b]]


@njit(cache=True, error_model="numpy", inline="always")
def riccati(B, S, M, out, place):  # type: ignore[no-untyped-def]
    """out[place] = B_qp + B_qq S − S M[0] with M[0] = B_pp + B_pq S, B in the order of the chart; returns tr M[0]."""
    k = S.shape[1]
    set_block(B, 0, 0, M, 0)
    add_product(B, 0, k, S, M, 0)
    set_block(B, k, 0, out, place)
    add_product(B, k, k, S, out, place)
    subtract_product(S, M, 0, out, place)
    return trace(M, 0)


@njit(cache=True, error_model="numpy", inline="always")
def riccati_tangent(B, dB, S, dS, M, out, place):  # type: ignore[no-untyped-def]
    """out[place] = dB_qp + dB_qq S + B_qq dS − dS M[0] − S M[1] with M[1] = dB_pp + dB_pq S + B_pq dS, M[0] as `riccati` left it.

    Returns tr M[1].
    """
    k = S.shape[1]
    set_block(dB, 0, 0, M, 1)
    add_product(dB, 0, k, S, M, 1)
    add_product(B, 0, k, dS, M, 1)
    set_block(dB, k, 0, out, place)
    add_product(dB, k, k, S, out, place)
    add_product(B, k, k, dS, out, place)
    subtract_product(dS, M, 0, out, place)
    subtract_product(S, M, 1, out, place)
    return trace(M, 1)


# whole arrays are indexed, as in reduced_system.py: slices would be counted references


@njit(cache=True, error_model="numpy", inline="always")
def set_block(B, row, column, out, place):  # type: ignore[no-untyped-def]
    """out[place] = the block of B that begins at (row, column)."""
    for c in range(out.shape[1]):
        for d in range(out.shape[2]):
            out[place, c, d] = B[row + c, column + d]


@njit(cache=True, error_model="numpy", fastmath={"contract"}, inline="always")
def add_product(B, row, column, Q, out, place):  # type: ignore[no-untyped-def]
    """out[place] ← out[place] + P Q, P the block of B that begins at (row, column)."""
    for c in range(out.shape[1]):
        for e in range(Q.shape[0]):
            p = B[row + c, column + e]
            if p != 0.0:
                for d in range(out.shape[2]):
                    out[place, c, d] += p * Q[e, d]


@njit(cache=True, error_model="numpy", fastmath={"contract"}, inline="always")
def subtract_product(S, M, which, out, place):  # type: ignore[no-untyped-def]
    """out[place] ← out[place] − S M[which]."""
    for c in range(S.shape[0]):
        for e in range(S.shape[1]):
            s = S[c, e]
            for d in range(S.shape[1]):
                out[place, c, d] -= s * M[which, e, d]


@njit(cache=True, error_model="numpy", inline="always")
def trace(M, which):  # type: ignore[no-untyped-def]
    """tr M[which]."""
    total = 0 * M[0, 0, 0]
    for d in range(M.shape[1]):
        total += M[which, d, d]
    return total


@njit(cache=True, error_model="numpy")
def enter_chart(Y, dY, units, order):  # type: ignore[no-untyped-def]
    """Enter the chart of a frame Y (n, k) in these units: S (n−k, k) with Y ~ [I; S] U in the chart's order, dS, det U and its slope."""
    n, k = Y.shape
    F, pivots = np.empty((k, k), dtype=np.complex128), np.empty(k, dtype=np.int64)
    U, dU = np.empty((k, k), dtype=np.complex128), np.empty((k, k), dtype=np.complex128)
    S, dS = np.empty((k, n - k), dtype=np.complex128), np.empty((k, n - k), dtype=np.complex128)
    for a in range(n):
        r = order[a]
        for d in range(k):
            y, dy = Y[r, d] / units[r], dY[r, d] / units[r]
            if a < k:
                U[a, d], dU[a, d], F[d, a] = y, dy, y
            else:
                S[d, a - k], dS[d, a - k] = y, dy
    det, slope = det_with_slope(U, dU)
    factorize(F, pivots)
    # Uᵀ Sᵀ = Y_qᵀ and Uᵀ dSᵀ = dY_qᵀ − dUᵀ Sᵀ
    substitute(F, pivots, S, 0, n - k)
    for d in range(k):
        for a in range(k):
            for c in range(n - k):
                dS[d, c] -= dU[a, d] * S[a, c]
    substitute(F, pivots, dS, 0, n - k)
    return S.T.copy(), dS.T.copy(), det, slope


@njit(cache=True, error_model="numpy")
def leave_chart(S, dS, units, order):  # type: ignore[no-untyped-def]
    """The frame [I; S] (n, k) in the order and the units of the state, and its derivative."""
    rest, k = S.shape
    Y, dY = np.zeros((rest + k, k), dtype=np.complex128), np.zeros((rest + k, k), dtype=np.complex128)
    for d in range(k):
        Y[order[d], d] = units[order[d]]
        for c in range(rest):
            r = order[k + c]
            Y[r, d], dY[r, d] = units[r] * S[c, d], units[r] * dS[c, d]
    return Y, dY


@njit(cache=True, error_model="numpy")
def exchange(S, dS, i, j, tangent):  # type: ignore[no-untyped-def]
    """Exchange the i-th other row with the j-th pivot: with s = S_ij,

    s ← 1/s,   S_ic ← −S_ic/s,   S_rj ← S_rj/s,   S_rc ← S_rc − S_rj S_ic/s   (r ≠ i, c ≠ j).
    """
    rest, k = S.shape
    inverse = 1.0 / S[i, j]
    dinverse = -dS[i, j] * inverse * inverse
    for c in range(k):
        if c != j:
            if tangent:
                dS[i, c] = -(dS[i, c] * inverse + S[i, c] * dinverse)
            S[i, c] = -S[i, c] * inverse
    for r in range(rest):
        if r != i:
            for c in range(k):
                if c != j:
                    if tangent:
                        dS[r, c] += dS[r, j] * S[i, c] + S[r, j] * dS[i, c]
                    S[r, c] += S[r, j] * S[i, c]
            if tangent:
                dS[r, j] = dS[r, j] * inverse + S[r, j] * dinverse
            S[r, j] *= inverse
    S[i, j] = inverse
    if tangent:
        dS[i, j] = dinverse


@njit(cache=True, error_model="numpy")
def farthest(S):  # type: ignore[no-untyped-def]
    """The place of the largest |S_ij|, or of a NaN if there is one; (−1, −1) if S is empty."""
    i, j, largest = -1, -1, -1.0
    for c in range(S.shape[0]):
        for d in range(S.shape[1]):
            size = abs(S[c, d])
            if np.isnan(size):
                return c, d
            if size > largest:
                i, j, largest = c, d, size
    return i, j


@njit(cache=True, error_model="numpy")
def error_of_step(K, traces, S):  # type: ignore[no-untyped-def]
    """The estimate of Dormand & Prince, largest over the components: of S relative to the size of their row, of ln det U as it is.

    The pivot rows of [I; S] are of size 1 and S is small: the sizes of its rows are those of an orthonormal frame up to a factor.
    """
    rest, k = S.shape
    sum5, sum3 = 0 * S[0, 0], 0 * S[0, 0]
    for stage in range(STAGES):
        sum5 += E5[stage] * traces[stage]
        sum3 += E3[stage] * traces[stage]
    worst = local_error(sum5.real**2 + sum5.imag**2, sum3.real**2 + sum3.imag**2)
    if np.isnan(worst):
        return worst
    for c in range(rest):
        size, e5, e3 = FLOOR, 0.0, 0.0
        for d in range(k):
            # a row that starts from zero is as large as the step makes it
            size = max(size, abs(S[c, d]), abs(K[0, c, d]), abs(K[STAGES - 1, c, d]))
            sum5, sum3 = 0 * S[0, 0], 0 * S[0, 0]
            for stage in range(STAGES):
                sum5 += E5[stage] * K[stage, c, d]
                sum3 += E3[stage] * K[stage, c, d]
            size5, size3 = sum5.real**2 + sum5.imag**2, sum3.real**2 + sum3.imag**2
            if np.isnan(size5) or np.isnan(size3):
                return np.nan
            e5, e3 = max(e5, size5), max(e3, size3)
        error = local_error(e5, e3) / size
        if np.isnan(error):
            return error
        worst = max(worst, error)
    return worst
