"""The decaying space at a regular singular point, C x dψ/dx = D ψ, ψ = P(x) x^Λ, without C⁻¹ and without logarithms.

With E = D + x dC/dx the coefficients of x^m give (m C_0 − D_0) P_m + C_0 P_m Λ = Σ_{j≥1} [E_j P_{m−j} − C_j P_{m−j} (m + Λ)].
"""

from __future__ import annotations

from typing import Any

from shootstab.core.errors import ConvergenceError
from shootstab.multiprecision import small_matrices as matrices
from shootstab.multiprecision.arithmetic import Arithmetic, Matrix
from shootstab.multiprecision.linear_step import TaylorEntries, leading, stacked, subsystems


def decaying_series(
    arithmetic: Arithmetic, C: TaylorEntries, D: TaylorEntries, P0: Matrix, rate: Any, nilpotent: Matrix, terms: int
) -> list[Matrix]:
    """P_m (n, k), m < terms, from P0 (n, k) and Λ = rate I + N, N = nilpotent (k, k) with N² = 0.

    P_m = G (R − C_0 G R N), G = ((m + rate) C_0 − D_0)⁻¹, with R as in kernels.frobenius.
    """
    n, k = len(P0), len(P0[0])
    nothing = arithmetic.number(0)
    P = [P0, *([[nothing] * k for _ in range(n)] for _ in range(terms - 1))]
    for rows, unknowns in subsystems(n, C, D):
        columns = [q for q in range(k) if not all(matrices.vanishes(P0[i][q]) for i in unknowns)]
        if not columns:
            continue
        size = len(rows)
        N = [[nilpotent[p][q] for q in columns] for p in columns]

        def times_N(A: Matrix, N: Matrix = N) -> Matrix:
            return matrices.product(arithmetic, A, N)

        C0, D0 = leading(arithmetic, C, rows, unknowns), leading(arithmetic, D, rows, unknowns)
        times_C0 = arithmetic.multiplier(C0)
        convolution = arithmetic.convolution(stacked(arithmetic, C, D, rows, unknowns, terms, shift=0))
        part = [[P0[i][q] for q in columns] for i in unknowns]
        for m in range(1, terms):
            convolution.push(part)
            both = convolution.value()
            E, CP = both[:size], both[size:]
            R = matrices.combined(matrices.combined(E, CP, -(m + rate)), times_N(CP), -1)
            try:
                G = arithmetic.multiplier(matrices.inverse(arithmetic, matrices.combined(matrices.scaled(C0, m + rate), D0, -1)))
            except ConvergenceError:
                told = f"two rates of solutions at an end differ by {m}, a power of the coefficients there, or may do so"
                raise ConvergenceError(f"{told}: a series with a logarithm is not taken in") from None
            part = G(matrices.combined(R, times_C0(times_N(G(R))), -1))
            for i, row in zip(unknowns, part, strict=True):
                for q, x in zip(columns, row, strict=True):
                    P[m][i][q] = x
    return P
