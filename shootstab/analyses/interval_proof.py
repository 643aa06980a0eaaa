"""Exactly n zeros in a rectangle for every value of a parameter in an interval: subintervals on each of which none crosses the boundary."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from fractions import Fraction
from time import perf_counter
from typing import Any

from shootstab.analyses.contour_proof import LEAST_CONTOUR_BITS, RECTANGLE_SLACK, RIM, along, settings
from shootstab.analyses.disc_proof import MOST_BITS, disc
from shootstab.analyses.proof import Proof, gathered, lemmas
from shootstab.core.balls import acb, arb
from shootstab.core.errors import ConvergenceError
from shootstab.core.progress import TOTAL, Progress
from shootstab.core.regions import Rectangle
from shootstab.multiprecision.enclosable import Enclosable, ball
from shootstab.multiprecision.enclosure import at_bits, decimal
from shootstab.roots.two_variables import two_variable_model

AWAY = (2.0, 4.0, 8.0, 16.0, 32.0)  # chosen: circles about a subinterval of the interval on which |D| is bounded, over its half length
LARGEST_CHANGE = 0.5  # chosen: the change of D on the boundary over half a subinterval; below 1 it may succeed, the likelier the smaller
MOST_SUBINTERVALS = 512  # chosen, a budget

EnclosableAt = Callable[[Any], Enclosable]  # the problem in balls at a value of the parameter, acb


@dataclass(frozen=True)
class _Subinterval:
    count: int
    margin: float
    bits: int
    points: int
    evaluations: int


def over(make: EnclosableAt, name: str, low: Fraction, high: Fraction, region: Rectangle, spare: int, progress: Progress | None) -> Proof:
    """The zeros in the rectangle for every value from low to high. Raises ConvergenceError where one comes too near to its boundary."""
    began = perf_counter()
    at_ends = [_at(make, value, region, spare) for value in (low, high)]
    if at_ends[0] != at_ends[1]:
        counts = " and ".join(f"{count} at {name} = {float(value):.12g}" for count, value in zip(at_ends, (low, high), strict=True))
        raise ConvergenceError(f"the eigenvalues in the region are {counts}: one crosses its boundary between")
    waiting: list[tuple[Fraction, Fraction]] = [(low, high)]
    found: list[_Subinterval] = []
    while waiting:
        a, b = waiting.pop()
        if len(found) + len(waiting) > MOST_SUBINTERVALS:
            where = f"next to {name} = {float(a):.12g} an eigenvalue is on the boundary of the region or near to it"
            allowed = "allowed is a region whose boundary is farther from them, or a shorter interval"
            raise ConvergenceError(f"{MOST_SUBINTERVALS} subintervals do not do: {where}: {allowed}")
        subinterval = _on_subinterval(make, a, b, region, spare)
        if subinterval is None:
            middle = (a + b) / 2
            waiting += [(middle, b), (a, middle)]
            continue
        found.append(subinterval)
        if progress is not None:
            progress(math.floor(TOTAL * (b - low) / (high - low)), TOTAL)
    if {subinterval.count for subinterval in found} != {at_ends[0]}:
        raise AssertionError("proved counts differ between subintervals of an interval and its ends: one of them is computed wrongly")
    with at_bits(LEAST_CONTOUR_BITS):
        own = lemmas([make(acb(ball(low)))])
    whole = gathered(found, region, perf_counter() - began, (*own, "E10"))
    return replace(whole, counts=whole.counts[:1], interval={"name": name, "low": str(low), "high": str(high), "pieces": len(found)})


def _at(make: EnclosableAt, value: Fraction, region: Rectangle, spare: int) -> int:
    with at_bits(MOST_BITS):
        form = make(acb(ball(value)))
    return along((form,), region, spare, None).count


def _on_subinterval(make: EnclosableAt, low: Fraction, high: Fraction, region: Rectangle, spare: int) -> _Subinterval | None:
    """None where the subinterval has to be shorter."""
    vertices = region.vertices
    centre, radius = (vertices[0] + vertices[2]) / 2, abs(vertices[2] - vertices[0]) / 2 * RECTANGLE_SLACK
    with at_bits(MOST_BITS):
        middle = make(acb(ball((low + high) / 2)))
    chosen = settings(middle, vertices, centre, radius, spare)
    bits, wider = chosen.bits, chosen.wider
    with at_bits(bits):
        p, h = acb(ball((low + high) / 2)), ball((high - low) / 2)
        sampled = [a + (b - a) * x / RIM for a, b in zip(vertices, [*vertices[1:], vertices[0]], strict=True) for x in range(RIM)]
        R, thick = arb(radius), disc(acb(centre), wider * arb(radius))
        ends = [make(p + h * t).enclosure(bits, thick) for t in (-1, 0, 1)]
        for sigma in sampled:
            below, at, above = (D(acb(sigma)) for D in ends)
            if not (abs(below - at) < LARGEST_CHANGE * abs(at) and abs(above - at) < LARGEST_CHANGE * abs(at)):
                return None
        bounds = {away: make(disc(p, away * h)).enclosure(bits, thick).growth(thick) for away in AWAY}
        needed = {away: (float(bound.mid()) - chosen.least + spare * math.log(2)) for away, bound in bounds.items() if bound.is_finite()}
        if not needed:
            return None
        away = min(needed, key=lambda x: needed[x] / math.log(x) * needed[x] / math.log(wider))
        K, L = math.ceil(needed[away] / math.log(wider)), math.ceil(needed[away] / math.log(away))
        D = [make(p + h * (2 * acb(i) / L).exp_pi_i()).enclosure(bits, thick) for i in range(L)]
        model = two_variable_model(D, bounds[away], acb(centre), R, 1 / arb(wider), 1 / arb(away), K)
        try:
            count, margin = model.count([acb(decimal(repr(v.real)), decimal(repr(v.imag))) for v in vertices])
        except ConvergenceError:
            return None
    return _Subinterval(count, margin, bits, K, K * L)
