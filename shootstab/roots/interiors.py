"""The inside of a region in balls: D has to be analytic there for the phase along the boundary to count its zeros (lemma E13)."""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from typing import Any

from shootstab.core.balls import acb, arb
from shootstab.core.errors import ConvergenceError
from shootstab.core.regions import Disc, Rectangle
from shootstab.roots.pieces import Bounded, decimals, exact_point, exact_real

SMALLEST_CELL = Fraction(1, 2**12)  # chosen: the smallest part of a region, in either direction, on which D is asked to be analytic


def require_analytic(analytic: Callable[[Any], bool], region: Bounded) -> None:
    """Raises ConvergenceError where D is not seen to be analytic on balls that cover the region."""
    cell_at = _cells_of(region)
    cells = [(Fraction(0), Fraction(0), Fraction(1))]
    while cells:
        x, y, side = cells.pop()
        a, b, c, d = (exact_real(v) for v in (x, x + side, y, y + side))
        ball = cell_at(a.union(b), c.union(d))
        if ball is None or (ball.is_finite() and analytic(ball)):
            continue
        if side <= SMALLEST_CELL:
            at = complex(ball.mid())
            raise ConvergenceError(f"D is not seen to be analytic inside the region at {at:.6g}: the continuous spectrum may be there")
        cells += [(x + i * side / 2, y + j * side / 2, side / 2) for i in (0, 1) for j in (0, 1)]


def _cells_of(region: Bounded) -> Callable[[Any, Any], Any]:
    """The map of balls x, y in [0, 1] to balls of σ that together hold the region; None for a ball that holds nothing of it."""
    if isinstance(region, Rectangle):
        low, high = (exact_point(decimals(corner)) for corner in (region.vertices[0], region.vertices[2]))
        return lambda x, y: acb(low.real + (high - low).real * x, low.imag + (high - low).imag * y)
    at = exact_point(decimals(region.centre))
    if isinstance(region, Disc):
        radius = exact_real(Fraction(repr(float(region.radius))))

        def in_disc(x: Any, y: Any) -> Any:
            w = acb(2 * x - 1, 2 * y - 1)
            return None if abs(w) > 1 else at + radius * w

        return in_disc
    inner, outer = (exact_real(Fraction(repr(float(r)))).log() for r in (region.inner, region.outer))
    return lambda x, y: at + acb(inner + (outer - inner) * x, (y - arb("0.5")) * arb.pi()).exp()
