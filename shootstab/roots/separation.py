"""How far from a zero D is linear: about the distance to the other zeros, and a scale for a zero at σ = 0, which has none of its own.

With D = Π (σ − z_j) e^{g(σ)} and z one of the zeros, D″/(2D′) at z is Σ 1/(z − z_j) over the others, plus g′. A zero at 0 cannot be known
to digits of itself; it can to digits of |2D′/D″|.
"""

from __future__ import annotations

from shootstab.core.discriminant import Discriminant, Value
from shootstab.roots.iterations import slope_change

FIRST = 1e-3  # chosen: of |σ|, the first distance at which D′ is looked at again
SMALLEST = 1e-24  # chosen: that distance where σ is 0, below any σ of interest and far above where a double underflows
FURTHER = 1e3  # from one distance to the next: a change of SEEN becomes one of a tenth, still nearly linear
SEEN = 1e-4  # chosen: a relative change of D′ so far above its noise, which is 1e-12 or so, that it shows two digits
MOST = 12  # distances: from the smallest to 1e9


def separation(discriminant: Discriminant, at_zero: Value) -> float:
    """|2D′/D″| at a simple zero, with D and D′ next to it, to some 10 %; smaller than that of 1e−3 |σ| it is known only to be so small."""
    zero = at_zero.sigma
    distance = max(FIRST * abs(zero), SMALLEST)
    for _ in range(MOST):
        change = slope_change(at_zero, discriminant.with_derivative(zero + distance))
        if change >= SEEN:
            break
        distance *= FURTHER
    return 2.0 * distance / change if change > 0.0 else float("inf")
