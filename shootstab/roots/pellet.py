"""Proved counts of zeros from enclosures of D at points: Cauchy's estimate and Pellet's theorem.

D is analytic on |σ − c| ≤ R with |D| ≤ M there. From K values on the circle of radius r < R, q = r/R, the discrete Fourier transform gives
d̂_k, and for the Taylor coefficients d_k of D about c (theory, lemma E5)

    |d_k r^k − d̂_k| ≤ M q^{k+K}/(1 − q^K),   Σ_{k≥K} |d_k| r^k ≤ M q^K/(1 − q).

Pellet: if |d_n| r^n > Σ_{k≠n} |d_k| r^k then D has exactly n zeros in |σ − c| < r, with multiplicity, and none on the circle (lemma
E6). With n = 0 and s ≤ r in place of r, D(σ)/d_0 has a positive real part on |σ − c| ≤ s: the phase of D differs from that at c by less
than a quarter turn. Balls are python-flint's; M enters by its logarithm.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Any

from shootstab.core.balls import acb, acb_poly, arb, ctx
from shootstab.core.errors import ConvergenceError

NO_RADIUS = arb(0)
TAIL_NATS = 7.0  # chosen: the rest of a Taylor series on a circle lies below D there by a factor of a thousand
# chosen: fewest values on a circle, and those beyond what the tail asks for where the series is to serve on smaller circles too
LEAST_POINTS, SPARE_POINTS = 2, 4
FIRST_LENGTH, SHORTEST_LENGTH = 1 / 64, 2.0**-48  # chosen: parts of a side of a polygon
STEP_OF_MARGIN = 0.7  # chosen: the next step over the last one, in the margin of that
CONDITION_BITS = 3  # derived: bits a degree, above the 2 log2(1 + √2) that powers of u lose where p is a sum of Chebyshev's, forth and back
EnclosedDiscriminant = Callable[[Any], Any]  # σ ↦ an enclosure of D(σ)


@dataclass(frozen=True, eq=False)
class TaylorModel:
    """|d_k| r^k ∈ sizes[k] for k < K, and Σ_{k≥K} |d_k| r^k ≤ tail; centre is c, radius r."""

    centre: Any
    radius: Any
    sizes: tuple[Any, ...]
    tail: Any

    def margin(self, n: int) -> float:
        """|d_n| r^n over the sum of all the others: above 1, exactly n zeros are proved."""
        others = sum((x for k, x in enumerate(self.sizes) if k != n), NO_RADIUS) + self.tail
        ratio = self.sizes[n].lower() / others.upper() if others.upper() > 0 else arb.pos_inf()
        return float(ratio) if ratio.is_finite() else math.inf

    def shrunk(self, radius: Any) -> TaylorModel:
        """The same series on a smaller circle."""
        ratio = radius / self.radius
        if ratio > 1:
            raise ValueError("a Taylor series is known on its own circle and on smaller ones")
        powers = [ratio**k for k in range(len(self.sizes) + 1)]
        return TaylorModel(self.centre, radius, tuple(x * p for x, p in zip(self.sizes, powers[:-1], strict=True)), self.tail * powers[-1])

    def with_first(self, value: Any) -> TaylorModel:
        """The same series where D(c) is known to be this."""
        return replace(self, sizes=(abs(value), *self.sizes[1:]))

    def proved(self) -> int | None:
        """The number of zeros, None where the inequality holds for no n."""
        for n, size in enumerate(self.sizes):
            others = sum((x for k, x in enumerate(self.sizes) if k != n), NO_RADIUS) + self.tail
            if size > others:
                return n
        return None


def taylor_model(
    D: EnclosedDiscriminant, log_bound: Any, centre: Any, radius: Any, outer: Any, points: int, real: bool = False
) -> TaylorModel:
    """A Taylor model from `points` values of D on |σ − centre| = radius, and ln |D| ≤ log_bound on |σ − centre| ≤ outer.

    real says that D(σ̄) is the conjugate of D(σ): about a real centre half of the values do.
    """
    K = points
    roots = [(2 * acb(j) / K).exp_pi_i() for j in range(K)]
    half = K // 2 if real and centre.imag.is_zero() else K - 1
    values = [D(centre + radius * w if j else centre + radius) for j, w in enumerate(roots[: half + 1])]
    values += [values[K - j].conjugate() for j in range(half + 1, K)]
    q = _ratio(radius, outer)
    M = log_bound.exp()
    spill = q**K
    sizes = []
    for k in range(K):
        d = sum((v * roots[-j * k % K] for j, v in enumerate(values)), acb(0)) / K
        size = abs(d)
        off = (M * q ** (k + K) / (1 - spill)).upper()
        sizes.append(arb(0).max(size.lower() - off).union(size.upper() + off))
    return TaylorModel(centre, radius, tuple(sizes), (M * spill / (1 - q)).upper())


def _ratio(radius: Any, outer: Any) -> Any:
    """q: of Cauchy's estimate nothing is left where it is not below 1."""
    q = radius / outer
    if not q < 1:
        raise ValueError("the circle on which |D| is bounded is not proved to be wider than that of the values")
    return q


def nats_for(log_bound: Any, log_size: Any) -> float:
    """The nats by which the tail has to fall below the bound to be about a thousandth of the size given."""
    return max(float((log_bound - log_size).mid()) + TAIL_NATS, TAIL_NATS)


def points_for(log_bound: Any, log_size: Any, radius: Any, outer: Any, most: int, spare: int = 0) -> int:
    """K for which the tail is about a thousandth of the size given, and some more; a choice, not a bound."""
    needed = math.ceil(nats_for(log_bound, log_size) / float((outer / radius).log().mid()))
    return min(most, max(LEAST_POINTS, needed) + spare)


@dataclass(frozen=True, eq=False)
class PolynomialModel:
    """D(σ) = p(u) + ε on |u| ≤ 1, u = (σ − centre)/radius, with |ε| ≤ spread; the coefficients of p are exact.

    With varying polynomials p_1, p_2, … it is D(σ, τ) = p(u) + Σ_l τ^l p_l(u) + ε on |τ| ≤ 1, and a count holds for each of these τ.
    Balls are boxes: a multiplication by a complex u widens one by up to √2, so that p is evaluated with half a bit more a degree.
    """

    centre: Any
    radius: Any
    polynomial: Any
    spread: Any
    varying: tuple[Any, ...] = ()

    def __call__(self, sigma: Any) -> Any:
        """A ball that holds D(σ)."""
        value = self.polynomial((sigma - self.centre) / self.radius)
        wide = arb(0, self.spread)
        return acb(value.real + wide, value.imag + wide)

    def margin(self, middle: Any, half: Any) -> float:
        """(|c_0| − spread)/(Σ_{k≥1} |c_k| s^k + 2 spread) on a segment |σ − middle| ≤ half, c_k about its middle, s the half in u.

        The coefficients c_k, k ≥ 0, of the varying polynomials belong to the sum.
        Above 1, D has no zero on the segment, and its phase differs from that at the middle by less than a quarter turn.
        """
        s, u = (half / self.radius).upper(), (middle - self.centre) / self.radius
        if not abs(u) + s <= 1:
            return 0.0  # the segment leaves the disc
        shifted = self.polynomial(acb_poly([u, 1])).coeffs()
        others = 2 * self.spread + s * _bounded(shifted[1:], s)
        for p in self.varying:
            others = others + _bounded(p(acb_poly([u, 1])).coeffs(), s)
        ratio = (abs(shifted[0]) - self.spread).lower() / others.upper()
        return float(ratio)

    def count(self, corners: Sequence[Any]) -> tuple[int, float]:
        """The zeros inside a polygon that lies in the disc, its corners counter-clockwise, and the least margin on its boundary.

        Raises ConvergenceError where a segment would have to be too short.
        """
        with ctx.workprec(ctx.prec + self.polynomial.degree()):
            values, least = self._followed(corners)
            whole = (phase_gained([*values, values[0]]) / (2 * arb.pi())).unique_fmpz()
        if whole is None:
            raise ConvergenceError("the enclosures of D on the contour do not determine a whole number of turns")
        return int(whole), least

    def _followed(self, corners: Sequence[Any]) -> tuple[list[Any], float]:
        """D at the ends and middles of the segments, in their order, and the least margin."""
        values: list[Any] = []
        least = math.inf
        for start, end in zip(corners, [*corners[1:], corners[0]], strict=True):
            passed, margin = self._along(start, end)
            values += passed
            least = min(least, margin)
        return values, least

    def turn(self, start: Any, end: Any) -> tuple[Any, float]:
        """The growth of the phase of D from start to end along the segment between, and the least margin on it.

        Raises ConvergenceError where a part of it would have to be too short.
        """
        with ctx.workprec(ctx.prec + CONDITION_BITS * self.polynomial.degree()):
            values, least = self._along(start, end)
            return phase_gained([*values, self(end)]), least

    def _along(self, start: Any, end: Any) -> tuple[list[Any], float]:
        """D at the beginnings and middles of parts of a segment, in their order, and the least margin."""
        values: list[Any] = []
        least = math.inf
        here, length = 0.0, FIRST_LENGTH
        while here < 1.0:
            ahead = min(1.0, here + length)
            a, b = (start + (end - start) * arb(x) for x in (here, ahead))
            margin = self.margin((a + b) / 2, abs(b - a) / 2)
            if not margin > 1.0:  # nor where it is no number
                length = 0.5 * (ahead - here)
                if length < SHORTEST_LENGTH:
                    raise ConvergenceError(f"an eigenvalue lies on the boundary or too near to it, at {complex(a.mid()):.12g}")
                continue
            values += [self(a), self((a + b) / 2)]  # either half turns the phase by less than a quarter: no branch is in doubt
            least = min(least, margin)
            here, length = ahead, (ahead - here) * min(2.0, max(1.0, STEP_OF_MARGIN * margin))
        return values, least


def phase_gained(values: Sequence[Any]) -> Any:
    """Σ_j arg(v_{j+1}/v_j) for numbers v_j in balls, principal arguments.

    Where no ball of a ratio meets the negative axis, each argument is that of the middles and what v_{j+1} and v_j are turned from theirs,
    so that the sum is that of the middles, and of all radii those of the first and the last ball alone are left. Raises ConvergenceError
    where one does.
    """
    total = NO_RADIUS
    for a, b in pairwise(values):
        ratio = b / a
        if not ratio.real > 0 and ratio.imag.contains(0):
            raise ConvergenceError("the enclosures of D on the contour do not determine how its phase grows")
        total += (b.mid() / a.mid()).arg()
    first, last = (v / v.mid() for v in (values[0], values[-1]))
    return total + last.arg() - first.arg()


def _bounded(coefficients: Sequence[Any], s: Any) -> Any:
    """Σ_k |c_k| s^k."""
    total = NO_RADIUS
    for c in reversed(coefficients):
        total = total * s + abs(c)
    return total


def polynomial_model(
    D: EnclosedDiscriminant,
    log_bound: Any,
    centre: Any,
    radius: Any,
    outer: Any,
    points: int,
    progress: Callable[[int, int], None] | None = None,
) -> PolynomialModel:
    """The Taylor polynomial of D on |σ − centre| ≤ radius from K = points values on the circle; see the head of this module."""
    K, values = points, []
    for j in range(K):
        values.append(D(centre + radius * (2 * acb(j) / K).exp_pi_i()))
        if progress is not None:
            progress(j + 1, K)
    q, M = _ratio(radius, outer), log_bound.exp()
    spill = q**K
    found = acb.dft(values)
    coefficients, spread = [], M * spill / (1 - q)
    for k, d in enumerate(found):
        exact = (d / K).mid()
        spread = spread + abs(d / K - exact) + M * q ** (k + K) / (1 - spill)
        coefficients.append(exact)
    return PolynomialModel(centre, radius, acb_poly(coefficients), spread.upper())
