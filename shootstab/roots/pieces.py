"""The boundary of a region in pieces, each an analytic curve σ(t), −1 ≤ t ≤ 1, that goes on into the complex t-plane."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import Any, Protocol

from shootstab.core.balls import acb, arb, fmpq
from shootstab.core.half_annulus import HalfAnnulus
from shootstab.core.regions import Disc, Rectangle

DecimalPair = tuple[str, str]  # real and imaginary part


class AnalyticCurve(Protocol):
    """σ(t) for complex t."""

    @property
    def mirrored(self) -> bool:
        """Whether σ(−t) = σ(t)*, for real t."""
        ...

    @property
    def rate(self) -> float:
        """|dσ/dt| over the distance of a centre, roughly; 0 where it has none."""
        ...

    def at(self, t: Any) -> Any:
        """A ball that holds σ(t) for every t in one."""
        ...


@dataclass(frozen=True)
class Segment:
    """A straight side from start to end: σ = (start (1 − t) + end (1 + t))/2."""

    start: DecimalPair
    end: DecimalPair

    @property
    def mirrored(self) -> bool:
        (a, b), (c, d) = (tuple(map(Fraction, at)) for at in (self.start, self.end))
        return a == c and b == -d

    @property
    def rate(self) -> float:
        return 0.0

    def at(self, t: Any) -> Any:
        return (exact_point(self.start) + exact_point(self.end)) / 2 + (exact_point(self.end) - exact_point(self.start)) / 2 * t


@dataclass(frozen=True)
class Spiral:
    """σ = centre + exp(((1 − t) ln w_0 + (1 + t) ln w_1)/2), w = r e^{iπa}: a ray about the centre, or an arc.

    start and end are r, a decimal, and a.
    """

    centre: DecimalPair
    start: tuple[str, Fraction]
    end: tuple[str, Fraction]

    @property
    def mirrored(self) -> bool:
        return Fraction(self.centre[1]) == 0 and Fraction(self.start[0]) == Fraction(self.end[0]) and (self.start[1] + self.end[1]) % 2 == 0

    @property
    def rate(self) -> float:
        (r, a), (R, b) = self.start, self.end
        return math.hypot(math.log(float(R) / float(r)), math.pi * float(b - a)) / 2

    def at(self, t: Any) -> Any:
        a, b = (acb(exact_real(Fraction(r)).log(), exact_real(angle) * arb.pi()) for r, angle in (self.start, self.end))
        return exact_point(self.centre) + ((a + b) / 2 + (b - a) / 2 * t).exp()


@dataclass(frozen=True)
class ContourPiece:
    """The part of a curve between two of its t, for −1 ≤ t ≤ 1 again; a contour passes it, or mirror images of it, so many times.

    real says that D(σ*) = D(σ)*.
    """

    curve: AnalyticCurve
    real: bool
    times: int = 1
    low: Fraction = Fraction(-1)
    high: Fraction = Fraction(1)

    @property
    def mirrored(self) -> bool:
        """Whether D(σ(−t)) = D(σ(t))*."""
        return self.real and self.low == -self.high and self.curve.mirrored

    @property
    def rate(self) -> float:
        """The rate of the curve, in this t."""
        return self.curve.rate * float(self.high - self.low) / 2

    def at(self, t: Any) -> Any:
        """σ(t)."""
        return self.curve.at(exact_real((self.low + self.high) / 2) + exact_real((self.high - self.low) / 2) * t)

    def halves(self) -> tuple[ContourPiece, ...]:
        """The first and the second one; of a mirrored piece the first one alone, twice, since either gains the same phase."""
        middle = (self.low + self.high) / 2
        if self.mirrored:
            return (replace(self, high=middle, times=2 * self.times),)
        return replace(self, high=middle), replace(self, low=middle)


Bounded = Rectangle | HalfAnnulus | Disc


def pieces(region: Bounded, real: bool) -> list[ContourPiece]:
    """The boundary of a region, counter-clockwise, in pieces; floats stand for their shortest decimals.

    real says that D(σ*) = D(σ)*: of what lies as a mirror image of another piece, run through backwards, only one is there, twice.
    """
    curves: list[AnalyticCurve]
    if isinstance(region, Rectangle):
        corners = [decimals(corner) for corner in region.vertices]
        curves = [Segment(corners[i % 4], corners[(i + 1) % 4]) for i in range(1, 5)]
    elif isinstance(region, Disc):
        at, radius = decimals(region.centre), repr(float(region.radius))
        curves = [Spiral(at, (radius, Fraction(k - 1, 2)), (radius, Fraction(k + 1, 2))) for k in (0, 2)]
    else:
        at, inner, outer, quarter = decimals(region.centre), repr(float(region.inner)), repr(float(region.outer)), Fraction(1, 2)
        curves = [
            Spiral(at, (outer, -quarter), (outer, quarter)),
            Spiral(at, (outer, quarter), (inner, quarter)),
            Spiral(at, (inner, quarter), (inner, -quarter)),
            Spiral(at, (inner, -quarter), (outer, -quarter)),
        ]
    if real and curves[0].mirrored and len(curves) > 2:
        return [ContourPiece(curves[0], real), ContourPiece(curves[1], real, 2), ContourPiece(curves[2], real)]
    return [ContourPiece(curve, real) for curve in curves]


def decimals(x: complex) -> DecimalPair:
    """The shortest decimals of both parts."""
    x = complex(x)
    return repr(x.real), repr(x.imag)


def exact_real(x: Fraction) -> Any:
    """A ball that holds it."""
    return arb(fmpq(x.numerator, x.denominator))


def exact_point(at: DecimalPair) -> Any:
    """A ball that holds the complex number."""
    return acb(exact_real(Fraction(at[0])), exact_real(Fraction(at[1])))
