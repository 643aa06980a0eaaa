"""D(σ, τ) as one polynomial of both from enclosures at points of two circles: what a count for every τ rests on.

D is analytic on |u| ≤ 1/q, |τ| ≤ 1/s with |D| ≤ M there, u = (σ − c)/r. From K L values at |u| = |τ| = 1 the discrete Fourier transform
gives its coefficients a_kl of u^k τ^l (theory, lemma E10):

    |a_kl − â_kl| ≤ M q^k s^l (1/((1 − q^K)(1 − s^L)) − 1),   Σ_{k≥K or l≥L} |a_kl| ≤ M (q^K + s^L)/((1 − q)(1 − s)).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

from shootstab.core.balls import acb, acb_poly
from shootstab.roots.pellet import NO_RADIUS, EnclosedDiscriminant, PolynomialModel


def two_variable_model(
    D: Sequence[EnclosedDiscriminant],
    log_bound: Any,
    centre: Any,
    radius: Any,
    q: Any,
    s: Any,
    points: int,
    progress: Callable[[int, int], None] | None = None,
) -> PolynomialModel:
    """D holds σ ↦ D(σ, τ_l) for the L-th roots of unity τ_l; points is K."""
    K, L = points, len(D)
    places = [centre + radius * (2 * acb(j) / K).exp_pi_i() for j in range(K)]
    rows = []
    for at, D_l in enumerate(D):
        rows.append([value / K for value in acb.dft([D_l(sigma) for sigma in places])])
        if progress is not None:
            progress(at + 1, L)
    found = [[value / L for value in acb.dft(list(column))] for column in zip(*rows, strict=True)]  # (K, L)
    M = log_bound.exp()
    alias = (q**K + s**L - q**K * s**L) / ((1 - q**K) * (1 - s**L))  # 1/((1 − q^K)(1 − s^L)) − 1, without cancellation
    spread = M * (q**K + s**L + alias) / ((1 - q) * (1 - s))
    for row in found:
        spread = spread + sum((abs(a - a.mid()) for a in row), NO_RADIUS)
    polynomials = [acb_poly([row[i].mid() for row in found]) for i in range(L)]
    return PolynomialModel(centre, radius, polynomials[0], spread.upper(), tuple(polynomials[1:]))
