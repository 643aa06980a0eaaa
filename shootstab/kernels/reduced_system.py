"""A linear system dψ/dt = hA(σ) ψ, sampled along a mesh and reduced so that no linear system of size n is left to solve.

With t from 0 to 1 over a step of length h (see discriminants/sampled_system.py for how it comes about),

    hA(σ) = X(σ) + V γ(σ)⁻¹ τ(σ),   γ (m×m), X and τ (m×n) polynomials in σ.

Arrays are float64 where all is real, σ too, and complex128 otherwise; the loops are the same.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from shootstab.kernels.elimination import solve_small


class ReducedSystem(NamedTuple):
    """The reduced system at the 12 abscissae of each of N steps, the length of the step multiplied into X and V.

    [X; τ], n + m rows, is stored by rows without what is zero at every abscissa: entry e of row i stands in column[e] for start[i] ≤ e <
    start[i + 1]. P (N, 12, E + E1 + E2) are the entries at σ = 0, then the factors of σ of those entries that have one, E1 of them listed
    in linear, and of higher powers, E2 listed in higher with their exponents in powers. Likewise V by its rows carries (v,) that are not
    zero, V (N, 12, v, m). G (N, 12, g, m, m) are the coefficients of γ, the constant one first, g ≥ 2. The lists are unsigned.
    """

    start: NDArray[np.uint64]
    column: NDArray[np.uint64]
    linear: NDArray[np.uint64]
    higher: NDArray[np.uint64]
    powers: NDArray[np.uint64]
    carries: NDArray[np.uint64]
    P: NDArray[np.inexact]
    V: NDArray[np.inexact]
    G: NDArray[np.inexact]

    @property
    def structure(self) -> tuple[NDArray[np.uint64], ...]:
        """The lists start (n + m + 1,), column (E,), linear (E1,), higher (E2,), powers (E2,) and carries (v,)."""
        return self[:6]

    @property
    def numbers(self) -> tuple[NDArray[np.inexact], ...]:
        """P (N, 12, E + E1 + E2), V (N, 12, v, m), G (N, 12, g, m, m)."""
        return self[6:]

    def in_complex_numbers(self) -> ReducedSystem:
        """The same in complex128."""
        P, V, G = (part.astype(np.complex128, copy=False) for part in self.numbers)
        return self._replace(P=P, V=V, G=G)

    def in_real_numbers(self) -> ReducedSystem | None:
        """The same in float64; None if it is not real."""
        if self.P.dtype.kind == "f":
            return self
        if any(part.imag.any() for part in self.numbers):
            return None
        P, V, G = (np.ascontiguousarray(part.real) for part in self.numbers)
        return self._replace(P=P, V=V, G=G)


@njit(cache=True, error_model="numpy", fastmath={"contract"}, inline="always")
def evaluate(P, G, linear, higher, powers, s, i, sigma, values, slopes, small):  # type: ignore[no-untyped-def]
    """The entries of [X; τ] (E,), their σ-derivatives, and γ (m, m), at abscissa i of step s."""
    E, E1 = len(values), len(linear)
    q = 0
    for e in range(E):
        value, slope = P[s, i, e], 0 * sigma
        if q < E1 and linear[q] == e:
            slope = P[s, i, E + q]
            value += sigma * slope
            q += 1
        values[e], slopes[e] = value, slope
    for q in range(len(higher)):
        factor, power = sigma * P[s, i, E + E1 + q], int(powers[q])
        for _ in range(power - 2):
            factor *= sigma
        values[higher[q]] += sigma * factor
        slopes[higher[q]] += float(power) * factor
    for a in range(small.shape[0]):
        for b in range(small.shape[0]):
            small[a, b], _ = small_entry(G, s, i, a, b, sigma)


@njit(cache=True, error_model="numpy", fastmath={"contract"}, inline="always")
def small_entry(G, s, i, a, b, sigma):  # type: ignore[no-untyped-def]
    """γ_ab and its σ-derivative, by Horner's rule."""
    top = G.shape[2] - 1
    value, slope = G[s, i, top, a, b], 0 * sigma
    for j in range(top):
        slope = value + sigma * slope
        value = G[s, i, top - 1 - j, a, b] + sigma * value
    return value, slope


@njit(cache=True, error_model="numpy", inline="always")
def system_matrix(system, s, i, sigma, A, dA, work, tangent):  # type: ignore[no-untyped-def]
    """hA(σ) (n, n) and, if tangent, its σ-derivative at abscissa i of step s; work is for `workspace` to make."""
    start, column, linear, higher, powers, carries, P, V, G = system
    values, slopes, small, right, slope = work
    n, m = A.shape[0], G.shape[3]
    evaluate(P, G, linear, higher, powers, s, i, sigma, values, slopes, small)
    for r in range(n):
        for c in range(n):
            A[r, c] = 0.0
            dA[r, c] = 0.0
    for r in range(m):
        for c in range(n):
            right[r, c] = 0.0
            slope[r, c] = 0.0
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
        # (γ⁻¹ τ)′ = γ⁻¹ (τ′ − γ′ γ⁻¹ τ)
        for a in range(m):
            for b in range(m):
                small[a, b], turn = small_entry(G, s, i, a, b, sigma)
                for j in range(n):
                    slope[a, j] -= turn * right[b, j]
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
    P, m, E = system.P, system.G.shape[3], len(system.column)
    return np.empty(E, P.dtype), np.empty(E, P.dtype), np.empty((m, m), P.dtype), np.empty((m, n), P.dtype), np.empty((m, n), P.dtype)


# The loops below index whole arrays: slices of them would be counted references, which cost more than the arithmetic.
# So do the arguments of calls: what has much to pass and little to do is inlined.


@njit(cache=True, error_model="numpy", fastmath={"contract"}, inline="always")
def multiply(start, column, first, values, Z, out, place):  # type: ignore[no-untyped-def]
    """out[place] = AZ, A the rows from the first on; Z (n, k), up to four columns at a time."""
    k, zero = Z.shape[1], 0 * Z[0, 0]
    for d in range(0, k, 4):
        width = min(4, k - d)
        for r in range(out.shape[1]):
            a, b, c, f = zero, zero, zero, zero
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


@njit(cache=True, error_model="numpy", fastmath={"contract"}, inline="always")
def multiply_with_slope(start, column, first, values, slopes, Z, W, out, slope, place):  # type: ignore[no-untyped-def]
    """out[place] = AZ and slope[place] = AW + A′Z, A and A′ the rows from the first on; two columns at a time."""
    k, zero = Z.shape[1], 0 * Z[0, 0]
    for d in range(0, k, 2):
        pair = d + 1 < k
        for r in range(out.shape[1]):
            a, b, da, db = zero, zero, zero, zero
            for e in range(start[first + r], start[first + r + 1]):
                x, dx, j = values[e], slopes[e], column[e]
                z = Z[j, d]
                a += x * z
                da += x * W[j, d]
                da += dx * z
                if pair:
                    z = Z[j, d + 1]
                    b += x * z
                    db += x * W[j, d + 1]
                    db += dx * z
            out[place, r, d], slope[place, r, d] = a, da
            if pair:
                out[place, r, d + 1], slope[place, r, d + 1] = b, db


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
