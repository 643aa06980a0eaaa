"""D along a piece of a contour: a polynomial between enclosures at Chebyshev's points, and an ellipse on which |D| is bounded.

Let f(t) = D(σ(t)) be analytic with |f| ≤ M on the closed ellipse with foci ±1 whose half axes add up to ρ > 1 (theory, lemma E13). The
polynomial p with f's values at t_j = cos((2j + 1)π/2K), j < K,

    p = Σ_{k<K} a_k T_k,   a_k = ((2 − δ_k0)/K) Σ_j f(t_j) cos(k(2j + 1)π/2K),   obeys   |f − p| ≤ 4 M ρ^{1−K}/(ρ − 1) on [−1, 1].
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from fractions import Fraction
from typing import Any

from shootstab.core.balls import acb, acb_poly, arb, ctx, fmpz_poly
from shootstab.roots.pellet import CONDITION_BITS, PolynomialModel

Square = tuple[Fraction, Fraction, Fraction]  # real and imaginary part of the middle, and half a side

SIDES_PER_UNIT = 1 << 16  # chosen: half a side of a square is a fraction with a denominator of this at most
AXES_SLACK = 1 + 2.0**-40  # chosen: it exceeds the rounding of an ellipse's half axes


def point(j: int, K: int) -> Any:
    """t_j, a thin ball."""
    return (arb(2 * j + 1) / (2 * K)).cos_pi()


def points_on_ellipse(log_bound: float, log_size: float, rho: float) -> int:
    """K for which the bound of |f − p| is below the size given; a choice, not a bound."""
    return max(2, math.ceil((log_bound - log_size + math.log(4 / (rho - 1))) / math.log(rho)) + 1)


def ellipse_model(values: Sequence[Any], log_bound: Any, rho: Any) -> PolynomialModel:
    """D on −1 ≤ t ≤ 1 from the values at all t_j, and ln M ≤ log_bound; see the head of this module."""
    K = len(values)
    cosines = [(arb(m) / (2 * K)).cos_pi() for m in range(4 * K)]
    spread = 4 * log_bound.exp() * rho ** (1 - K) / (rho - 1)
    exact = []
    for k in range(K):
        a = sum((v * cosines[k * (2 * j + 1) % (4 * K)] for j, v in enumerate(values)), acb(0)) * (2 if k else 1) / K
        exact.append(a.mid())
        spread = spread + abs(a - exact[-1])
    with ctx.workprec(ctx.prec + CONDITION_BITS * K):
        p = acb_poly([0])
        for k, a in enumerate(exact):
            p = p + acb_poly(fmpz_poly.chebyshev_t(k)) * a
    return PolynomialModel(acb(0), arb(1), p, spread.upper())


def boxes(rho: float, longest: float, mirrored: bool) -> Iterator[Square]:
    """Squares with half a side of at most `longest` that cover the ellipse; of a mirrored piece those with Re t ≥ 0."""
    across, up = (rho + 1 / rho) / 2, (rho - 1 / rho) / 2
    half = Fraction(longest).limit_denominator(SIDES_PER_UNIT)
    rows, columns = (math.ceil(Fraction(AXES_SLACK * reach) / (2 * half)) for reach in (up, across))
    for i in range(0 if mirrored else -columns, columns):
        for j in range(-rows, rows):
            box = (2 * i + 1) * half, (2 * j + 1) * half, half
            if meets(box, rho):
                yield box


def quarters(box: Square) -> Iterator[Square]:
    """The four squares that make it up."""
    x, y, half = box
    for i in (-1, 1):
        for j in (-1, 1):
            yield x + i * half / 2, y + j * half / 2, half / 2


def meets(box: Square, rho: float) -> bool:
    """Whether a square may hold a point of the ellipse |t − 1| + |t + 1| ≤ ρ + 1/ρ; no square that does is left out."""
    t = ball_of(box)
    return not abs(t - 1) + abs(t + 1) > arb(rho) + 1 / arb(rho)


def ball_of(box: Square) -> Any:
    """The square as a ball."""
    x, y, half = (arb(v.numerator) / v.denominator for v in box)
    wide = arb(0, half.upper())
    return acb(x + wide, y + wide)
