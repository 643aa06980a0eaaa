"""Series of the decaying space at a regular singular point: (C_0 + C_1 x + …) x dψ/dx = (D_0 + D_1 x + …) ψ, ψ = P(x) x^Λ."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from shootstab.core.scaled import TINY
from shootstab.kernels.elimination import LANES, factorize, substitute


class Recurrence(NamedTuple):
    """D_j and −C_j, each A_j + σ B_j for j < M, without what is zero in all of them: entry e stands at (row[e], column[e]).

    The first `fluxes` entries are those of D. values (E, M) are of A_j, slopes (E1, M) of B_j, for the entries listed in moving (E1,).
    Real or complex.
    """

    row: NDArray[np.uint64]
    column: NDArray[np.uint64]
    moving: NDArray[np.uint64]
    fluxes: int
    values: NDArray[np.inexact]
    slopes: NDArray[np.inexact]


def recurrence(C: NDArray[np.inexact], D: NDArray[np.inexact]) -> Recurrence:
    """The recurrence of the matrices C and D, each (2, M, n, n)."""
    places = [np.nonzero((matrices != 0).any(axis=(0, 1))) for matrices in (D, C)]
    row, column = (np.concatenate(at) for at in zip(*places, strict=True))
    values, slopes = (
        np.concatenate([sign * matrices[power][:, *at].T for sign, matrices, at in zip((1, -1), (D, C), places, strict=True)])
        for power in range(2)
    )
    moving = np.flatnonzero(slopes.any(axis=1))
    numbers = np.ascontiguousarray(values), np.ascontiguousarray(slopes[moving])
    return Recurrence(row.astype(np.uint64), column.astype(np.uint64), moving.astype(np.uint64), len(places[0][0]), *numbers)


def series_terms(
    system: Recurrence,
    sigma: complex,
    rate: float,
    left: NDArray[Any],
    right: NDArray[Any],
    P: NDArray[Any],
    dP: NDArray[Any],
    tangent: bool,
) -> None:
    """Fill P and, if tangent, dP (M, n, k), whose first terms are given, by

        (m C_0 − D_0) P_m + C_0 P_m Λ = Σ_{j≥1} [D_j P_{m−j} − C_j S_{m−j}],   S_m = m P_m + P_m Λ,

    for Λ = rate·I + N, N = left rightᵀ (k,) and (k,) with N² = 0: then with F = (m + rate) C_0 − D_0 the solution is
    P_m = F⁻¹ (R − C_0 F⁻¹ R N). dP is the derivative with respect to σ.
    """
    terms, n, k = P.shape
    kind = P.dtype
    values: NDArray[Any] = system.values.copy()
    values[system.moving] += sigma * system.slopes
    X = np.zeros((2 if tangent else 1, 2, terms, n, k + -k % LANES), kind)  # the terms and S, for P and for dP
    for part, given in zip(X, (P, dP), strict=False):
        part[0, 0, :, :k] = given[0]
    work = np.empty((n, X.shape[4] + 1), kind)
    vectors = np.zeros((2, X.shape[4]), kind)
    vectors[:, :k] = left, right
    F, pivots = np.empty((n, n), kind), np.empty(n, np.int64)
    row, column, moving, fluxes, _, slopes = system
    every = np.arange(len(values), dtype=np.uint64)
    fill_terms(row, column, every, moving, fluxes, values, slopes, rate, vectors[0], vectors[1], X, work, F, pivots)
    P[:] = X[0, 0, :, :, :k]
    if tangent:
        dP[:] = X[1, 0, :, :, :k]


@njit(cache=True, error_model="numpy", fastmath={"contract"})
def fill_terms(row, column, every, moving, fluxes, values, slopes, rate, left, right, X, R, F, pivots):  # type: ignore[no-untyped-def] # fmt: skip
    """The terms of `series_terms` in X (parts, 2, M, n, q), q a multiple of LANES; R (n, q + 1), F (n, n) and pivots (n,) are work."""
    parts, _, terms, n, q = X.shape
    for m in range(terms):
        for a in range(n):
            for b in range(n):
                F[a, b] = 0.0
        for e in range(len(every)):
            F[row[e], column[e]] -= values[e, 0] * (1.0 if e < fluxes else m + rate)
        if m > 0:
            factorize(F, pivots)
        for part in range(parts):
            if m > 0:
                for a in range(n):
                    for b in range(q + 1):
                        R[a, b] = 0.0
                # the dependence of the left side on σ is moved to the right to make the derivative
                for turn in range(part + 1):
                    entries, numbers = (every, values) if turn == 0 else (moving, slopes)
                    for p in range(len(entries)):
                        e = entries[p]
                        r, c, kind = row[e], column[e], 0 if e < fluxes else 1
                        for d in range(0, q, LANES):
                            w, x, y, z = R[r, d], R[r, d + 1], R[r, d + 2], R[r, d + 3]
                            for j in range(1 - turn, m + 1):
                                v = numbers[p, j]
                                w += v * X[part - turn, kind, m - j, c, d]
                                x += v * X[part - turn, kind, m - j, c, d + 1]
                                y += v * X[part - turn, kind, m - j, c, d + 2]
                                z += v * X[part - turn, kind, m - j, c, d + 3]
                            R[r, d], R[r, d + 1], R[r, d + 2], R[r, d + 3] = w, x, y, z
                # the columns become F⁻¹ R, and the last one F⁻¹ of −C_0 F⁻¹ R left
                for turn in range(2):
                    substitute(F, pivots, R, q * turn, q + turn)
                    for e in range(fluxes if turn == 0 else len(every), len(every)):
                        for d in range(q):
                            R[row[e], q] += values[e, 0] * R[column[e], d] * left[d]
                for a in range(n):
                    for d in range(q):
                        X[part, 0, m, a, d] = R[a, d] + R[a, q] * right[d]
            for a in range(n):
                along = 0 * left[0]
                for d in range(q):
                    along += X[part, 0, m, a, d] * left[d]
                for d in range(q):
                    X[part, 1, m, a, d] = (m + rate) * X[part, 0, m, a, d] + along * right[d]


@njit(cache=True, error_model="numpy")
def series_value(P, x):  # type: ignore[no-untyped-def]
    """Σ P_m x^m (n, k), for real x."""
    terms, n, k = P.shape
    out = P[terms - 1].copy()
    for m in range(terms - 2, -1, -1):
        for a in range(n):
            for q in range(k):
                out[a, q] = out[a, q] * x + P[m, a, q]
    return out


@njit(cache=True, error_model="numpy")
def row_sizes(P, sizes):  # type: ignore[no-untyped-def]
    """sizes (M,) ← of each term the largest max_q |P_m[a, q]|/max_q |P_0[a, q]| over the rows a."""
    terms, n, k = P.shape
    for m in range(terms):
        sizes[m] = 0.0
    for a in range(n):
        base = TINY
        for q in range(k):
            base = max(base, abs(P[0, a, q]))
        for m in range(terms):
            for q in range(k):
                sizes[m] = max(sizes[m], abs(P[m, a, q]) / base)  # its square may overflow
