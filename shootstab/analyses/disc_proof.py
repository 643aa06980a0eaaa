"""Exactly n zeros in a disc: Pellet's theorem on enclosures of D at points of a circle, with as many bits as it takes."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from time import perf_counter
from typing import Any

import mpmath

from shootstab.analyses.proof import Decimals, Proof, lemmas, named, premise, rounded
from shootstab.core.balls import acb, arb, ctx
from shootstab.core.errors import ConvergenceError
from shootstab.multiprecision.enclosable import BoundedDiscriminant, Enclosable
from shootstab.multiprecision.enclosure import at_bits, decimal
from shootstab.multiprecision.tails import largest
from shootstab.roots.pellet import LEAST_POINTS, SPARE_POINTS, TaylorModel, nats_for, points_for, taylor_model

# chosen: bits beyond the digits asked for, more where the enclosure of D is too wide; twenty digits are then two words of FLINT's, whose
# products take half the time of three
SPARE_BITS = 66
MORE_BITS, MOST_BITS = 1.6, 4096  # chosen: the factor of bits from one attempt to the next, and a budget of some minutes
KNOWN_BITS = 30  # chosen: bits of D on the circle: an inequality that fails with so many fails for another reason than too few bits
TOLD, MOST_PROBES = 4, 12  # chosen: bits of D from which on it is told from 0, and how often more are tried
LEAST_GAIN = 0.1  # chosen: bits of D gained by one more bit, at least: longer series on longer steps lose some of it
WIDEST_CIRCLE = 4.0  # chosen: the circle on which |D| is bounded is at least so many times that of the values
SMALLER_OUTER = 4.0  # chosen: ratio of an outer circle on which D has no bound to the next
# chosen: the first disc, in |σ|, in the search for the largest in which a mode is alone, and the factor to the next
WIDEST, NARROWER = 0.125, 1.25
WIDE_SHARE = 3  # chosen: part of the values that a circle may take which that search takes
SPARE_PART = 6  # chosen: points in so many that are SPARE_POINTS
RIM_ARCS = 8  # chosen: arcs of the outer circle on which |D| is bounded by itself, where what one ball gives would ask for many points
SECANTS = 80  # chosen: steps towards a zero, which for a simple one are six or so
LEAST_NEAR = 1e-6  # chosen: the first two points of a secant differ in a double
SEED = 10  # chosen: digits that a mode in double precision has at least
FARTHEST_SECANT = 1e3  # chosen: the longest step of a secant, in the accuracy of the seed, that still leads to its zero
UNTOLD = -200  # chosen: ln |D| that is taken, for a choice of points, where D is not told from 0


@dataclass(frozen=True)
class _CountedFactor:
    """What Pellet's theorem gave for one factor of D."""

    count: int
    margin: float
    bits: int
    points: int
    evaluations: int
    alone: float


def around(forms: tuple[Enclosable, ...], centre: Decimals, radius: str, alone: bool) -> Proof:
    """The zeros of every factor of D in the disc. Raises ConvergenceError where their number is not proved."""
    began = perf_counter()
    found = [_counted(form, centre, radius, alone) for form in forms]
    shape = {"shape": "disc", "centre": named(centre), "radius": radius}
    counts = tuple(part.count for part in found)
    return Proof(
        counts,
        shape,
        min(part.margin for part in found),
        max(part.bits for part in found),
        max(part.points for part in found),
        sum(part.evaluations for part in found),
        perf_counter() - began,
        lemmas(forms),
        alone=min(part.alone for part in found) if alone else None,
        premise=premise(forms),
    )


def polished(form: Enclosable, seed: complex, error: float, places: int, radius: str) -> Decimals:
    """The zero of D next to the seed to so many decimals, by secants through the midpoints of enclosures; proved by whoever asks for it.

    error is about that of the seed, radius that of the disc it is wanted for. Raises ConvergenceError where the secants go elsewhere.
    """
    start = repr(seed.real), repr(seed.imag)
    near = 10.0 ** (math.floor(math.log10(abs(seed))) - SEED)
    near = min(near, max(2.0 * error, LEAST_NEAR * near))  # two points as near to the zero as the seed save a step
    extra = math.ceil(math.log2(10) * max(0.0, places + math.log10(near)))
    bits, _ = enough_bits(form, start, repr(near), max(SPARE_BITS + extra, _first_bits(abs(seed), radius)), TOLD + extra)
    with at_bits(bits), mpmath.workprec(bits):
        enclosure = form.enclosure(bits, disc(number(start), arb(form.outer * abs(seed))))
        x = [number(start), number(start) + decimal(repr(near))]  # the point that the bits were found with, asked for once
        D = [enclosure(s).mid() for s in x]
        for _ in range(SECANTS):
            if D[1] == D[0] or not abs(x[1] - x[0]) < arb(FARTHEST_SECANT * near):
                break
            step = (D[1] * (x[1] - x[0]) / (D[1] - D[0])).mid()
            x = [x[1], (x[1] - step).mid()]
            if abs(step) < arb(10) ** -places:
                return rounded(mpmath.mpf(x[1].real.mid().str(bits, radius=False)), places), rounded(
                    mpmath.mpf(x[1].imag.mid().str(bits, radius=False)), places
                )
            D = [D[1], enclosure(x[1]).mid()]
    raise ConvergenceError(f"no mode to prove: the secants leave the mode that double precision found at {seed:.12g}")


def _counted(form: Enclosable, centre: Decimals, radius: str, alone: bool) -> _CountedFactor:
    size = max(abs(complex(float(centre[0]), float(centre[1]))), float(radius))
    bits, spent = enough_bits(form, centre, radius, _first_bits(size, radius), KNOWN_BITS)
    with at_bits(bits):
        at, r = number(centre), decimal(radius)
        surrounded = _surrounded(form, bits, at, size, float(radius))
        if not alone:
            model, widest = _model(surrounded, r), float(radius)
            spent += len(model.sizes) + 1
        else:
            wider = _wide_model(surrounded, r, size).with_first(surrounded.D(at))
            model = wider.shrunk(r)
            spent += len(wider.sizes) + 3
        count = model.proved()
        if count is None and alone:
            model = _model(surrounded, r)
            count = model.proved()
            spent += len(model.sizes)
        if count is None:
            raise ConvergenceError(
                f"no term dominates the Taylor series of D on the circle of radius {radius}: take a smaller disc, or another centre"
            )
        if alone:
            widest = max(_alone(wider, count, float(radius)), float(radius))
    return _CountedFactor(count, model.margin(count), bits, len(model.sizes), spent, widest)


def _first_bits(size: float, radius: str) -> int:
    """Bits to begin with, for a disc of that radius about a σ of that size."""
    return SPARE_BITS + max(0, math.ceil(math.log2(size / float(radius))))


def enough_bits(form: Enclosable, centre: Decimals, radius: str, bits: int, wanted: int) -> tuple[int, int]:
    """Bits with which D on the circle is known to so many as are wanted, and how many values it took to find out."""
    size = abs(complex(float(centre[0]), float(centre[1])))
    before: tuple[int, int] | None = None
    for spent in range(1, MOST_PROBES):
        tried = bits
        with at_bits(bits):
            enclosure = form.enclosure(bits, disc(number(centre), arb(_outer(form, size, float(radius)))))
            known = int(enclosure(number(centre) + decimal(radius)).rel_accuracy_bits())
        if known >= wanted:
            return bits, spent
        if known >= TOLD:
            gain = 1.0 if before is None else min(1.0, max(LEAST_GAIN, (known - before[1]) / (bits - before[0])))
            before = bits, known
            bits += math.ceil((wanted - known + TOLD) / gain)
        else:
            bits = math.ceil(MORE_BITS * bits)
        if bits > MOST_BITS:
            break
    raise ConvergenceError(f"{tried} bits do not enclose D well enough on the circle of radius {radius}")


@dataclass(frozen=True)
class _Surrounded:
    """D about a centre, ln |D| ≤ bound within outer of it, and how many values of it a circle may take."""

    D: BoundedDiscriminant
    centre: Any
    outer: float
    bound: Any
    most: int


def _outer(form: Enclosable, size: float, radius: float) -> float:
    return max(form.outer * size, WIDEST_CIRCLE * radius)


def _surrounded(form: Enclosable, bits: int, centre: Any, size: float, radius: float) -> _Surrounded:
    """D within the outer circle, or a smaller one where that holds what is no eigenvalue, such as a continuous spectrum.

    So it is where a smaller one has a bound that fewer values do for: an enclosure for thick σ bounds |D| much better where there is one.
    """
    outer = _outer(form, size, radius)
    best, fewest, log_size = None, math.inf, None
    while True:
        region = disc(centre, arb(outer))
        D = form.enclosure(bits, region)
        try:
            bound = D.growth(region)
            if not bound.is_finite():
                raise ConvergenceError(f"|D| has no bound on the circle of radius {outer:.3g}")
        except ConvergenceError:
            if outer <= WIDEST_CIRCLE * radius and best is None:
                raise
        else:
            log_size = _log_size(D, centre + arb(radius)) if log_size is None else log_size
            nats = nats_for(bound, log_size)
            points = math.ceil(nats / math.log(outer / radius))
            if points < fewest:
                best, fewest = _Surrounded(D, centre, outer, bound, form.most_points), points
        if best is not None and (fewest <= form.most_points or outer <= WIDEST_CIRCLE * radius):
            return best
        outer = max(outer / SMALLER_OUTER, WIDEST_CIRCLE * radius)


def _model(about: _Surrounded, radius: Any, spare: int = 0) -> TaylorModel:
    """The Taylor model on a circle; it takes a value of D more than it has points."""
    points = points_for(about.bound, _log_size(about.D, about.centre + radius), radius, arb(about.outer), about.most, spare)
    return taylor_model(about.D, about.bound, about.centre, radius, arb(about.outer), points, about.D.real)


def _wide_model(about: _Surrounded, r: Any, size: float) -> TaylorModel:
    """The polynomial model of D on a circle of WIDEST·|σ|, or a smaller one for which the points that may be taken do; r at least.

    There D is larger than on the circle of radius r, for which its bits are, by the ratio of the two: as many fewer do.
    """
    radius = float(r)
    wide = min(WIDEST * size, about.outer / WIDEST_CIRCLE)
    log_size = _log_size(about.D, about.centre + arb(radius))
    log_size += math.log(wide / radius) if radius < wide else 0.0  # D grows about so much, being linear
    values = max(about.most // WIDE_SHARE, LEAST_POINTS + 1)
    few = replace(about, most=2 * values - 4 if _halved(about) else values)
    spare = min(SPARE_POINTS, few.most // SPARE_PART)
    if nats_for(about.bound, log_size) > (few.most - spare) * math.log(about.outer / wide):
        few = replace(few, bound=_rim_bound(about))
    far = min(wide, about.outer * math.exp(-nats_for(few.bound, log_size) / (few.most - spare)))
    if far <= radius:
        return _model(few, r, spare)
    bits = min(ctx.prec, max(SPARE_BITS, ctx.prec - math.floor(math.log2(far / radius))))
    few = replace(few, D=about.D.rougher(bits))
    with at_bits(ctx.prec if few.D is about.D else bits):
        return _model(few, arb(far), spare)


def _halved(about: _Surrounded) -> bool:
    """Whether half of the values on a circle are conjugates of the others."""
    return about.D.real and bool(about.centre.imag.is_zero())


def _rim_bound(about: _Surrounded) -> Any:
    """ln |D| on the outer circle, arc by arc, or the bound for the whole disc, in which D is analytic and no larger than on the circle."""
    arcs = []
    for k in range(RIM_ARCS // 2 if _halved(about) else RIM_ARCS):
        angle = (arb(2 * k) / RIM_ARCS).union(arb(2 * k + 2) / RIM_ARCS)
        try:
            bound = about.D.growth(about.centre + arb(about.outer) * acb(angle).exp_pi_i())
        except ConvergenceError:  # what is told apart of a thick σ may be more than of its parts' hull
            return about.bound
        arcs.append(bound if bound.is_finite() and bound < about.bound else about.bound)
    return largest(arcs)


def _log_size(enclosure: BoundedDiscriminant, sigma: Any) -> Any:
    """ln |D|; where D is not told from 0 some number, which serves to choose points."""
    found = abs(enclosure(sigma)).log()
    return found if found.is_finite() else arb(UNTOLD)


def _alone(model: TaylorModel, count: int, least: float) -> float:
    """The largest disc up to that of the model, by factors, in which the same number is proved; 0 where it is none above the least."""
    radius = float(model.radius)
    while radius > least:
        if model.shrunk(arb(radius)).proved() == count:
            return radius
        radius /= NARROWER
    return 0.0


def disc(centre: Any, radius: Any) -> Any:
    """A square ball that holds the disc."""
    spread = arb(0, radius.upper())
    return acb(centre.real + spread, centre.imag + spread)


def number(at: Decimals) -> Any:
    return acb(decimal(at[0]), decimal(at[1]))
