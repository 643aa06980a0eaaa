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
    """The reduced system at the S abscissae (STAGES of the tableau) of each of N steps, the length of the step multiplied into X and V.

    [X; τ], n + m rows, is stored by rows without what is zero at every abscissa: entry e of row i stands in column[e] for start[i] ≤ e <
    start[i + 1]; all rows of τ have the same columns. P (N, S, E + E1 + E2) are the entries at σ = 0, then the factors of σ of those
    entries that have one, E1 of them listed in linear, and of higher powers, E2 listed in higher with their exponents in powers. Likewise V
    by its rows carries (v,) that are not zero, V (N, S, v, m). G (N, S, g, m, m) are the coefficients of γ, the constant one first,
    g ≥ 2. The lists are unsigned.
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
        """P (N, S, E + E1 + E2), V (N, S, v, m), G (N, S, g, m, m)."""
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
    """The entries (E,) of X and of γ⁻¹τ, and their σ-derivatives, at abscissa i of step s.

    small (m, 2m + 2w) is work, w the entries of a row of τ.
    """
    E, E1, m, top = len(values), len(linear), small.shape[0], G.shape[2] - 1
    for e in range(E):
        values[e], slopes[e] = P[s, i, e], 0.0
    for q in range(E1):
        slope = P[s, i, E + q]
        values[linear[q]] += sigma * slope
        slopes[linear[q]] = slope
    for q in range(len(higher)):
        factor, power = sigma * P[s, i, E + E1 + q], int(powers[q])
        for _ in range(power - 2):
            factor *= sigma
        values[higher[q]] += sigma * factor
        slopes[higher[q]] += float(power) * factor
    if m == 0:
        return
    # U = γ⁻¹ τ and U′ follow from γ U = τ, γ U′ = τ′ − γ′ U, solved at once on [γ, γ′, τ, τ′]
    width = small.shape[1] // 2 - m
    first = E - m * width
    for a in range(m):
        for b in range(m):
            value, slope = G[s, i, top, a, b], 0 * sigma
            for j in range(top):
                slope = value + sigma * slope
                value = G[s, i, top - 1 - j, a, b] + sigma * value
            small[a, b], small[a, m + b] = value, slope
        for c in range(width):
            e = first + a * width + c
            small[a, 2 * m + c], small[a, 2 * m + width + c] = values[e], slopes[e]
    solve_small(small)
    for a in range(m):
        for c in range(width):
            e = first + a * width + c
            values[e], slope = small[a, 2 * m + c], small[a, 2 * m + width + c]
            for b in range(m):
                slope -= small[a, m + b] * small[b, 2 * m + c]
            slopes[e] = slope


@njit(cache=True, error_model="numpy", inline="always")
def system_matrix(system, s, i, sigma, A, dA, work):  # type: ignore[no-untyped-def]
    """hA(σ) (n, n) and its σ-derivative at abscissa i of step s; work is for `workspace` to make."""
    start, column, linear, higher, powers, carries, P, V, G = system
    values, slopes, small = work
    n, m = A.shape[0], G.shape[3]
    evaluate(P, G, linear, higher, powers, s, i, sigma, values, slopes, small)
    for r in range(n):
        for c in range(n):
            A[r, c] = 0.0
            dA[r, c] = 0.0
        for e in range(start[r], start[r + 1]):
            A[r, column[e]], dA[r, column[e]] = values[e], slopes[e]
    for c in range(len(carries)):
        for q in range(m):
            v = V[s, i, c, q]
            for e in range(start[n + q], start[n + q + 1]):
                A[carries[c], column[e]] += v * values[e]
                dA[carries[c], column[e]] += v * slopes[e]


@njit(cache=True, error_model="numpy")
def workspace(system, n):  # type: ignore[no-untyped-def]
    """Memory for `system_matrix`: values and slopes (E,), and [γ, γ′, τ, τ′] (m, 2m + 2w)."""
    P, m, E = system.P, system.G.shape[3], len(system.column)
    width = (E - int(system.start[n])) // m if m > 0 else 0
    return np.empty(E, P.dtype), np.empty(E, P.dtype), np.empty((m, 2 * (m + width)), P.dtype)


# The loops below index whole arrays: slices of them would be counted references, which cost more than the arithmetic.
# So do the arguments of calls: what has much to pass and little to do is inlined, and called at one place only, for every place is
# compiled anew.


@njit(cache=True, error_model="numpy", fastmath={"contract"}, inline="always")
def multiply(start, column, values, slopes, Z, at, k, tangent, out, place):  # type: ignore[no-untyped-def]
    """out[place] = AZ, Z = Z[at] (n, q), q a multiple of four; if tangent Z is [Y, Y′, …], Y (n, k), and A′Y is added to AY′.

    A by its rows, the entries values (E,), and A′ likewise.
    """
    columns, zero = Z.shape[2], 0 * Z[0, 0, 0]
    for r in range(out.shape[1]):
        for d in range(0, columns, 4):
            a, b, c, f = zero, zero, zero, zero
            for e in range(start[r], start[r + 1]):
                x, j = values[e], column[e]
                a += x * Z[at, j, d]
                b += x * Z[at, j, d + 1]
                c += x * Z[at, j, d + 2]
                f += x * Z[at, j, d + 3]
            out[place, r, d] = a
            out[place, r, d + 1] = b
            out[place, r, d + 2] = c
            out[place, r, d + 3] = f
        if tangent:
            for e in range(start[r], start[r + 1]):
                x, j = slopes[e], column[e]
                if x != 0.0:
                    for d in range(k):
                        out[place, r, k + d] += x * Z[at, j, d]


@njit(cache=True, error_model="numpy", fastmath={"contract"}, inline="always")
def add_carried(V, carries, s, i, out, n):  # type: ignore[no-untyped-def]
    """out[i, :n] ← out[i, :n] + V t with V = V[s, i], t (m, q) the rows of out[i] from n on."""
    for c in range(len(carries)):
        r = carries[c]
        for q in range(V.shape[3]):
            v = V[s, i, c, q]
            for d in range(out.shape[2]):
                out[i, r, d] += v * out[i, n + q, d]
