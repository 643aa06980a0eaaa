"""The decaying space at a regular singular point, x dψ/dx = A(x) ψ, ψ = P(x) x^Λ: m P_m + P_m Λ − A_0 P_m = Σ_{j≥1} A_j P_{m−j}."""

from __future__ import annotations

from typing import Any

from shootstab.discriminants.precise import matrices
from shootstab.discriminants.precise.arithmetic import Arithmetic, Matrix
from shootstab.discriminants.precise.reduction import Row
from shootstab.discriminants.precise.taylor import Taylor


def decaying_series(ring: Arithmetic, A: list[Row], leading: Matrix, rate: Any, nilpotent: Matrix, terms: int) -> list[Matrix]:
    """P_m (n, k) for m below terms, from P_0 and Λ = rate I + N with N² = 0: P_m = E (R − E R N), E = (m + rate − A_0)⁻¹."""
    n = len(A)
    first = [[row[j].coefficients(1)[0] if j in row else ring.number(0) for j in range(n)] for row in A]
    later = [[_tail(ring, row[j], terms) if j in row else (None, None) for j in range(n)] for row in A]
    convolution = ring.convolution(later, terms - 1)
    P = [leading]
    for m in range(1, terms):
        convolution.push(P[-1])
        R = convolution.value()
        left = [[(m + rate if i == j else 0) - first[i][j] for j in range(n)] for i in range(n)]
        RN = matrices.product(ring, R, nilpotent)
        both = matrices.solve(ring, left, [a + b for a, b in zip(R, RN, strict=True)])
        k = len(leading[0])
        ER, ERN = [row[:k] for row in both], [row[k:] for row in both]
        P.append(matrices.combined(ER, matrices.solve(ring, left, ERN), -1))
    return P


def _tail(ring: Arithmetic, entry: Taylor, terms: int) -> tuple[Any, Any]:
    """(A − A_0)/x of one entry, as payloads."""
    re, im = (None if part is None else ring.series(ring.coefficients(part, terms)[1:]) for part in (entry.re, entry.im))
    return re, im
