"""The solution at a zero of D and its left one, step by step, and what every number of the sampled system does to the zero.

From the frames that `frame_transport` kept, the solution is φ_s = Q_s c_s with c_s = R_{s+1}⁻¹ c_{s+1}, from the wall outwards; the left
one is χ_s = χ_{s+1} M_s, kept orthogonal to Q_s. With the stages x_i of the step from φ_s, a change of A_i adds κ_i δA_i x_i to χφ,

    κ_i = b_i χ_{s+1} + Σ_{j>i} a_ji κ_j A_j,   χ_s = χ_{s+1} + Σ κ_i A_i.
"""

from __future__ import annotations

import numpy as np
from numba import njit

from shootstab.kernels.elimination import square
from shootstab.kernels.frame_transport import TABLE
from shootstab.kernels.tableau import STAGES


@njit(cache=True, error_model="numpy", fastmath={"contract"})
def step(start, column, linear, higher, powers, carries, P, V, inverse, s, sigma, x, K, entries):  # type: ignore[no-untyped-def]
    """Step s of one vector x[S] to x[S + 1], S the stages: x (S + 2, n) receives these, K (S, n + m) their images, entries (S, E) A.

    inverse (N, S, m, m) are the γ⁻¹; the rows of K from n on are y = γ⁻¹ τ x, and those of the entries γ⁻¹ τ.
    """
    n, m = x.shape[1], inverse.shape[2]
    E, E1 = len(column), len(linear)
    width = (E - int(start[n])) // m if m > 0 else 0
    for i in range(STAGES + 1):
        to = STAGES + 1 if i == STAGES else i
        for c in range(n):
            x[to, c] = x[STAGES, c]
        for j in range(i):
            w = TABLE[i, j]
            if w != 0.0:
                for c in range(n):
                    x[to, c] += w * K[j, c]
        if i == STAGES:
            break
        for e in range(E):
            entries[i, e] = P[s, i, e]
        for q in range(E1):
            entries[i, linear[q]] += sigma * P[s, i, E + q]
        for q in range(len(higher)):
            factor = P[s, i, E + E1 + q]
            for _ in range(powers[q]):
                factor *= sigma
            entries[i, higher[q]] += factor
        for c in range(width):
            for a in range(m):
                K[i, n + a] = 0.0
                for b in range(m):
                    K[i, n + a] += inverse[s, i, a, b] * entries[i, E - (m - b) * width + c]
            for a in range(m):
                entries[i, E - (m - a) * width + c] = K[i, n + a]
        for r in range(n + m):
            total = 0 * sigma
            for e in range(start[r], start[r + 1]):
                total += entries[i, e] * x[i, column[e]]
            K[i, r] = total
        for c in range(len(carries)):
            for q in range(m):
                K[i, carries[c]] += V[s, i, c, q] * K[i, n + q]


@njit(cache=True, error_model="numpy", fastmath={"contract"})
def ends_of_steps(start, column, linear, higher, powers, carries, P, V, inverse, sigma, begin, phi, ends, x, K, entries):  # type: ignore[no-untyped-def] # fmt: skip
    """ends (N, n) of the steps, each begun at phi[begin], and where begin (N,) is negative at the end of the step before it."""
    for s in range(len(begin)):
        for c in range(x.shape[1]):
            x[STAGES, c] = x[STAGES + 1, c] if begin[s] < 0 else phi[begin[s], c]
        step(start, column, linear, higher, powers, carries, P, V, inverse, s, sigma, x, K, entries)
        for c in range(x.shape[1]):
            ends[s, c] = x[STAGES + 1, c]


@njit(cache=True, error_model="numpy", fastmath={"contract"})
def back_substitute(  # type: ignore[no-untyped-def]
    start, column, linear, higher, powers, carries, P, V, inverse, sigma, F, c, row, x, K, entries, R, left, phi, chi, gP, gV, gG, squares
):
    """φ and χ (N + 1, n) from c (k,) and the row χ (n,) at the wall, and the gradient of χφ there with respect to P, V and G.

    F (N + 1, n, k) are the frames before each orthonormalization and become orthonormal; c becomes that of φ in the far frame F[0].
    left (2, S, n + m), R (k, k) are work. squares receives Σ |χ_r|² |Q_rj c_j|² over all nodes, and Σ |κ_r A_rl x_l|² over
    all stages, x_l at least as large as the frame makes it there: what a rounding of every component, and of every product, sums up to.
    """
    n, m, k = x.shape[1], inverse.shape[2], len(c)
    N, E, E1 = len(F) - 1, len(column), len(linear)
    size = np.empty(n)
    for s in range(N, -1, -1):
        for j in range(k):
            for i in range(j):
                along = 0 * sigma
                for r in range(n):
                    along += F[s, r, i].conjugate() * F[s, r, j]
                R[i, j] = along
                for r in range(n):
                    F[s, r, j] -= along * F[s, r, i]
            total = 0.0
            for r in range(n):
                total += square(F[s, r, j])
            R[j, j] = np.sqrt(total)
            for r in range(n):
                F[s, r, j] /= R[j, j]
        for r in range(n):
            total, size[r] = 0 * sigma, 0.0
            for j in range(k):
                total += F[s, r, j] * c[j]
                size[r] += square(F[s, r, j]) * square(c[j])
            phi[s, r] = total
        if s < N:
            for r in range(n):
                x[STAGES, r] = phi[s, r]
            step(start, column, linear, higher, powers, carries, P, V, inverse, s, sigma, x, K, entries)
            for i in range(STAGES - 1, -1, -1):
                for r in range(n):
                    total = TABLE[STAGES, i] * chi[s + 1, r]
                    for j in range(i + 1, STAGES):
                        total += TABLE[j, i] * left[1, j, r]
                    left[0, i, r], left[1, i, r] = total, 0 * sigma
                for q in range(m):
                    total = 0 * sigma
                    for r in range(len(carries)):
                        total += left[0, i, carries[r]] * V[s, i, r, q]
                        gV[s, i, r, q] = left[0, i, carries[r]] * K[i, n + q]
                    left[0, i, n + q] = total
                for r in range(n + m):
                    for e in range(start[r], start[r + 1]):
                        d = column[e]
                        product = left[0, i, r] * entries[i, e]
                        left[1, i, d] += product
                        squares[1] += square(product) * max(size[d], square(x[i, d]))
                for a in range(m):  # χ V γ⁻¹
                    left[1, i, n + a] = 0.0
                    for b in range(m):
                        left[1, i, n + a] += left[0, i, n + b] * inverse[s, i, b, a]
                for a in range(m):
                    left[0, i, n + a] = left[1, i, n + a]
                    for b in range(m):
                        total = -left[0, i, n + a] * K[i, n + b]
                        for p in range(gG.shape[2]):
                            gG[s, i, p, a, b] = total
                            total *= sigma
                for r in range(n + m):
                    for e in range(start[r], start[r + 1]):
                        gP[s, i, e] = left[0, i, r] * x[i, column[e]]
                for q in range(E1):
                    gP[s, i, E + q] = sigma * gP[s, i, linear[q]]
                for q in range(len(higher)):
                    total = gP[s, i, higher[q]]
                    for _ in range(powers[q]):
                        total *= sigma
                    gP[s, i, E + E1 + q] = total
            for r in range(n):
                total = chi[s + 1, r]
                for i in range(STAGES):
                    total += left[1, i, r]
                row[r] = total
        for j in range(k):
            along = 0 * sigma
            for r in range(n):
                along += row[r] * F[s, r, j]
            for r in range(n):
                row[r] -= along * F[s, r, j].conjugate()
        for r in range(n):
            chi[s, r] = row[r]
            squares[0] += square(row[r]) * size[r]
        for j in range(k - 1, -1, -1):
            for i in range(j + 1, k):
                c[j] -= R[j, i] * c[i]
            c[j] /= R[j, j]


@njit(cache=True, error_model="numpy", fastmath={"contract"})
def entries_at_random(g, a, moved, knots, sums):  # type: ignore[no-untyped-def]
    """The sum of squares of Σ g δa where numbers a (N, S, p) are changed by their own sizes at random, real and imaginary parts apart.

    One change along all of the path, one at every stage, and one by place: the range of a over a step times moved (N,). On steps over a
    knot, where knots (N,) is not 0, all numbers change together, by so many times themselves. sums (2, p) is work.
    """
    total = 0.0
    for e in range(a.shape[2]):
        for part in range(2):
            sums[part, e] = 0.0
    for s in range(a.shape[0]):
        over_knot = 0 * sums[0, 0]
        for e in range(a.shape[2]):
            x = a[s, 0, e]
            low, high, left, right, weight = x.real, x.real, x.imag, x.imag, 0.0
            for i in range(a.shape[1]):
                x, w = a[s, i, e], g[s, i, e]
                total += square(w) * square(x)
                weight += square(w)
                sums[0, e] += w * x.real
                sums[1, e] += w * x.imag
                over_knot += w * x
                low, high, left, right = min(low, x.real), max(high, x.real), min(left, x.imag), max(right, x.imag)
            total += weight * moved[s] * moved[s] * ((high - low) * (high - low) + (right - left) * (right - left))
        total += square(over_knot) * knots[s] * knots[s]
    for e in range(a.shape[2]):
        total += square(sums[0, e]) + square(sums[1, e])
    return total
