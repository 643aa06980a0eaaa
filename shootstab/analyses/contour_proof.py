"""Exactly n zeros in a rectangle: D is one polynomial on a disc around it, its phase is followed along the boundary in proved segments."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from time import perf_counter
from typing import Any

from shootstab.analyses.disc_proof import MORE_BITS, disc
from shootstab.analyses.proof import Proof, gathered, lemmas, premise
from shootstab.core.balls import acb, arb
from shootstab.core.errors import ConvergenceError
from shootstab.core.progress import Progress
from shootstab.core.regions import Rectangle
from shootstab.multiprecision.enclosable import Enclosable
from shootstab.multiprecision.enclosure import at_bits, decimal
from shootstab.roots.pellet import PolynomialModel, polynomial_model

CONTOUR_SAMPLES_BITS = 192  # chosen: bits of the values of D that tell how many bits and points a contour needs
# chosen: spare bits of D on a contour, for a zero 2^−12 of the contour away; how often they are raised
CONTOUR_BITS, CONTOUR_ATTEMPTS = 24, 3
RIM = 12  # chosen: values of D on a circle, and on a side of a contour, by which its size is judged
RECTANGLE_SLACK = 1.0625  # chosen: the disc on which D is one polynomial, over the half diagonal of the rectangle
OUTER_CIRCLES = (2.0, 4.0, 8.0, 16.0)  # chosen: radii of the disc on which |D| is bounded, over that one; the one that needs fewest points
MORE_POINTS = 1.25  # chosen: factor of points from one attempt to the next, as MORE_BITS is that of bits
LEAST_CONTOUR_BITS = 64  # chosen: bits of D on a contour at least, beyond those of a double


@dataclass(frozen=True)
class ContourSettings:
    """Bits, points and the outer circle over the circle of values; least is the smallest ln |D| that was seen on the contour."""

    bits: int
    points: int
    wider: float
    least: float


@dataclass(frozen=True)
class _Followed:
    """What one factor of D gave."""

    count: int
    margin: float
    bits: int
    points: int
    evaluations: int


def along(forms: tuple[Enclosable, ...], region: Rectangle, spare: int, progress: Progress | None) -> Proof:
    """The zeros of every factor of D in the rectangle, with so many spare bits.

    Raises ConvergenceError where one is too near its boundary.
    """
    began = perf_counter()
    found = [_followed(form, region, spare, progress) for form in forms]
    return replace(gathered(found, region, perf_counter() - began, lemmas(forms)), premise=premise(forms))


def _followed(form: Enclosable, region: Rectangle, spare: int, progress: Progress | None) -> _Followed:
    middle, half = (region.vertices[0] + region.vertices[2]) / 2, abs(region.vertices[2] - region.vertices[0]) / 2
    chosen = settings(form, region.vertices, middle, half * RECTANGLE_SLACK, spare)
    bits, points, wider = chosen.bits, chosen.points, chosen.wider
    spent = 0
    for attempt in range(CONTOUR_ATTEMPTS):
        with at_bits(bits):
            model = _polynomial(form, bits, middle, half * RECTANGLE_SLACK, wider, points, progress)
            spent += points
            try:
                count, margin = model.count([acb(decimal(repr(v.real)), decimal(repr(v.imag))) for v in region.vertices])
            except ConvergenceError:
                if attempt == CONTOUR_ATTEMPTS - 1:
                    raise
            else:
                return _Followed(count, margin, bits, points, spent)
        bits, points = math.ceil(MORE_BITS * bits), math.ceil(MORE_POINTS * points)
    raise AssertionError("unreachable")


def _polynomial(
    form: Enclosable, bits: int, middle: complex, radius: float, wider: float, points: int, progress: Progress | None
) -> PolynomialModel:
    centre, R = acb(middle.real, middle.imag), arb(radius)
    region = disc(centre, wider * R)
    enclosure = form.enclosure(bits, region)
    return polynomial_model(enclosure, enclosure.growth(region), centre, R, wider * R, points, progress)


def settings(form: Enclosable, corners: Sequence[complex], middle: complex, radius: float, spare: int) -> ContourSettings:
    """Settings from the sizes of D on the contour and on the circle and from what an enclosure of D loses: choices, not bounds."""
    bits = CONTOUR_SAMPLES_BITS
    while True:
        with at_bits(bits):
            centre, R = acb(middle.real, middle.imag), arb(radius)
            enclosure = form.enclosure(bits, disc(centre, OUTER_CIRCLES[0] * R))
            rim = [enclosure(centre + R * (acb(2 * j) / RIM).exp_pi_i()) for j in range(RIM)]
            sides = zip(corners, [*corners[1:], corners[0]], strict=True)
            edge = [enclosure(acb(s.real, s.imag)) for a, b in sides for s in (a + (b - a) * x / RIM for x in range(RIM))]
            known = min(int(D.rel_accuracy_bits()) for D in (*rim, *edge))
            if known > 0 or bits > CONTOUR_SAMPLES_BITS * MORE_BITS**CONTOUR_ATTEMPTS:
                break
        bits = math.ceil(MORE_BITS * bits)
    with at_bits(bits):
        least, largest = min(map(_nats, edge)), max(map(_nats, rim))
        needed = {
            wider: (float(enclosure.growth(disc(centre, wider * R)).mid()) - least + spare * math.log(2)) / math.log(wider)
            for wider in OUTER_CIRCLES
        }
    wider = min(needed, key=lambda x: needed[x])
    enough = max(bits - known + math.ceil((largest - least) / math.log(2)) + spare, LEAST_CONTOUR_BITS)
    return ContourSettings(enough, math.ceil(needed[wider]), wider, least)


def _nats(D: Any) -> float:
    return float(abs(D).log().mid())
