"""Exactly n zeros in a disc: Pellet's theorem on enclosures of D at points of a circle, with as many bits as it takes."""

from __future__ import annotations

import math
from dataclasses import dataclass
from time import perf_counter
from typing import Any

import mpmath

from shootstab.analyses.proof import Decimals, Proof, lemmas, named, rounded
from shootstab.core.balls import acb, arb
from shootstab.core.errors import ConvergenceError
from shootstab.multiprecision.enclosable import Enclosable
from shootstab.multiprecision.enclosure import Enclosure, at_bits, decimal
from shootstab.roots.pellet import SPARE_POINTS, TaylorModel, nats_for, points_for, taylor_model

SPARE_BITS = 96  # chosen: bits beyond the digits asked for; more are taken where the enclosure of D is too wide
MORE_BITS, MOST_BITS = 1.6, 4096  # chosen: the factor of bits from one attempt to the next, and a budget of some minutes
KNOWN_BITS = 40  # chosen: bits of D on the circle: an inequality that fails with so many fails for another reason than too few bits
TOLD, MOST_PROBES = 4, 12  # chosen: bits of D from which on it is told from 0, and how often more are tried
MOST_POINTS = 96  # chosen: values of D on a circle
OUTER = 0.5  # chosen: the circle on which |D| is bounded, in |σ|; nearer circles need more points, wider ones more bits
# chosen: the first disc, in |σ|, in the search for the largest in which a mode is alone, and the factor to the next
WIDEST, NARROWER = 0.125, 1.25
SECANTS = 80  # chosen: steps towards a zero, which for a simple one are six or so
SEED = 10  # chosen: digits that a mode in double precision has at least


@dataclass(frozen=True)
class _Counted:
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
    )


def polished(form: Enclosable, seed: complex, places: int) -> Decimals:
    """The zero of D next to the seed to so many decimals, by secants through the midpoints of enclosures; proved by whoever asks for it.

    Raises ConvergenceError where they go elsewhere.
    """
    start = repr(seed.real), repr(seed.imag)
    near = 10.0 ** (math.floor(math.log10(abs(seed))) - SEED)
    bits, _ = _enough_bits(form, start, repr(near), 64)
    bits += math.ceil(math.log2(10) * max(0.0, places + math.log10(near)))
    with at_bits(bits), mpmath.workprec(bits):
        enclosure = Enclosure(form, bits)
        x = [_number(start), _number(start) + arb(near)]
        D = [enclosure(s).mid() for s in x]
        for _ in range(SECANTS):
            if D[1] == D[0] or not abs(x[1] - x[0]) < arb(1e3 * near):
                break
            step = (D[1] * (x[1] - x[0]) / (D[1] - D[0])).mid()
            x = [x[1], (x[1] - step).mid()]
            if abs(step) < arb(10) ** -places:
                return rounded(mpmath.mpf(x[1].real.mid().str(bits, radius=False)), places), rounded(
                    mpmath.mpf(x[1].imag.mid().str(bits, radius=False)), places
                )
            D = [D[1], enclosure(x[1]).mid()]
    raise ConvergenceError(f"no mode to prove: the secants leave the mode that double precision found at {seed:.12g}")


def _counted(form: Enclosable, centre: Decimals, radius: str, alone: bool) -> _Counted:
    size = max(abs(complex(float(centre[0]), float(centre[1]))), float(radius))
    outer = max(OUTER * size, 4.0 * float(radius))
    bits, spent = _enough_bits(form, centre, radius, SPARE_BITS + max(0, math.ceil(math.log2(size / float(radius)))))
    with at_bits(bits):
        enclosure, at, r = Enclosure(form, bits), _number(centre), decimal(radius)
        model = _model(enclosure, at, r, outer)
        count = model.proved()
        if count is None:
            raise ConvergenceError(
                f"no term dominates the Taylor series of D on the circle of radius {radius}: take a smaller disc, or another centre"
            )
        spent += len(model.sizes) + 1
        widest = float(radius)
        if alone:
            wider = _wide_model(enclosure, at, float(radius), size)
            widest = max(_alone(wider, count, float(radius)), float(radius))
            spent += len(wider.sizes) + 2
    return _Counted(count, model.margin(count), bits, len(model.sizes), spent, widest)


def _enough_bits(form: Enclosable, centre: Decimals, radius: str, bits: int) -> tuple[int, int]:
    """Bits with which D on the circle is known to KNOWN_BITS, and how many values it took to find out."""
    for spent in range(1, MOST_PROBES):
        with at_bits(bits):
            known = int(Enclosure(form, bits)(_number(centre) + decimal(radius)).rel_accuracy_bits())
        if known >= KNOWN_BITS:
            return bits, spent
        bits = bits + KNOWN_BITS - known if known >= TOLD else math.ceil(MORE_BITS * bits)
        if bits > MOST_BITS:
            break
    raise ConvergenceError(f"{MOST_BITS} bits do not enclose D well enough on the circle of radius {radius}")


def _model(enclosure: Enclosure, centre: Any, radius: Any, outer: float) -> TaylorModel:
    """The Taylor model on a circle; it takes a value of D more than it has points."""
    log_bound, log_size = enclosure.growth(disc(centre, arb(outer))), _log_size(enclosure, centre + radius)
    points = points_for(log_bound, log_size, radius, arb(outer), MOST_POINTS)
    return taylor_model(enclosure, log_bound, centre, radius, arb(outer), points)


def _wide_model(enclosure: Enclosure, centre: Any, radius: float, size: float) -> TaylorModel:
    """The same on a circle of WIDEST·|σ|, or a smaller one for which MOST_POINTS do."""
    outer = max(OUTER * size, 8.0 * radius)
    log_bound, log_size = enclosure.growth(disc(centre, arb(outer))), _log_size(enclosure, centre + arb(radius))
    log_size += math.log(WIDEST * size / radius) if radius < WIDEST * size else 0.0  # D grows about so much, being linear
    far = outer * math.exp(-nats_for(log_bound, log_size) / (MOST_POINTS - SPARE_POINTS))
    return _model(enclosure, centre, arb(max(min(WIDEST * size, far), radius)), outer)


def _log_size(enclosure: Enclosure, sigma: Any) -> Any:
    """ln |D|; where D is not told from 0 some number, which serves to choose points."""
    found = abs(enclosure(sigma)).log()
    return found if found.is_finite() else arb(-200)


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


def _number(at: Decimals) -> Any:
    return acb(decimal(at[0]), decimal(at[1]))
