"""Series of the decaying space at a regular singular point: (C0 + C1 x + …) x dψ/dx = (D0 + D1 x + …) ψ, ψ = P(x) x^Λ."""

from __future__ import annotations

import numpy as np
from numba import njit

from shootstab.kernels.transport import solve_small


@njit(cache=True, error_model="numpy")
def series_terms(C, D, sigma, rate, nilpotent, P, dP):  # type: ignore[no-untyped-def]
    """Fill P and dP (M, n, k), whose first terms are given, by

        (m C_0 − D_0) P_m + C_0 P_m Λ = Σ_{j≥1} [D_j P_{m−j} − C_j S_{m−j}],   S_m = m P_m + P_m Λ,

    for C = C[0] + σ C[1] and D likewise, each (2, M, n, n), and Λ = rate·I + N with N² = 0: then with E = ((m + rate) C_0 − D_0)⁻¹ the
    solution is E (R − C_0 E R N). dP is the derivative with respect to σ.
    """
    terms, n, k = P.shape
    S, dS = np.zeros_like(P), np.zeros_like(P)
    R, dR = np.empty((n, k), dtype=np.complex128), np.empty((n, k), dtype=np.complex128)
    E, right, first = np.empty((n, n), dtype=np.complex128), np.empty((n, k), dtype=np.complex128), np.empty((n, k), dtype=np.complex128)
    for m in range(terms):
        if m > 0:
            R[:] = 0j
            dR[:] = 0j
            for j in range(1, m + 1):
                for a in range(n):
                    for b in range(n):
                        dc, dd = C[1, j, a, b], D[1, j, a, b]
                        c, d = C[0, j, a, b] + sigma * dc, D[0, j, a, b] + sigma * dd
                        if c != 0j or d != 0j or dc != 0j or dd != 0j:
                            for q in range(k):
                                R[a, q] += d * P[m - j, b, q] - c * S[m - j, b, q]
                                dR[a, q] += d * dP[m - j, b, q] + dd * P[m - j, b, q] - c * dS[m - j, b, q] - dc * S[m - j, b, q]
            _solve_order(C, D, sigma, m + rate, nilpotent, R, E, right, first, P[m])
            # the derivative of the equation, its left side's dependence on σ moved to the right
            for a in range(n):
                for b in range(n):
                    dc, dd = C[1, 0, a, b], D[1, 0, a, b]
                    for q in range(k):
                        dR[a, q] -= ((m + rate) * dc - dd) * P[m, b, q]
                        for p in range(k):
                            dR[a, q] -= dc * P[m, b, p] * nilpotent[p, q]
            _solve_order(C, D, sigma, m + rate, nilpotent, dR, E, right, first, dP[m])
        for a in range(n):
            for q in range(k):
                S[m, a, q] = (m + rate) * P[m, a, q]
                dS[m, a, q] = (m + rate) * dP[m, a, q]
                for p in range(k):
                    S[m, a, q] += P[m, a, p] * nilpotent[p, q]
                    dS[m, a, q] += dP[m, a, p] * nilpotent[p, q]


@njit(cache=True, error_model="numpy")
def _solve_order(C, D, sigma, exponent, nilpotent, R, E, right, first, out):  # type: ignore[no-untyped-def]
    """out = E (R − C_0 E R N) with E = (exponent C_0 − D_0)⁻¹."""
    n, k = R.shape
    for turn in range(2):
        for a in range(n):
            for b in range(n):
                E[a, b] = exponent * (C[0, 0, a, b] + sigma * C[1, 0, a, b]) - D[0, 0, a, b] - sigma * D[1, 0, a, b]
        if turn == 0:
            for a in range(n):
                for q in range(k):
                    total = 0j
                    for p in range(k):
                        total += R[a, p] * nilpotent[p, q]
                    first[a, q] = total
            solve_small(E, first)
        else:
            for a in range(n):
                for q in range(k):
                    total = R[a, q]
                    for b in range(n):
                        total -= (C[0, 0, a, b] + sigma * C[1, 0, a, b]) * first[b, q]
                    right[a, q] = total
            solve_small(E, right)
    out[:] = right
