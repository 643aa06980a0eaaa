"""No eigenvalue near a point, by the one value of D there: the lemma of Schwarz and Pick (theory, lemma E20).

A normalized |D| bounds the distance of σ to the spectrum from below (A. Bayliss & J. Bronski): where |D| ≤ M within R of σ, no zero is
nearer than R |D(σ)|/M. A disc by Pellet's theorem is larger, and takes many values; this one asks for nothing around it.
"""

from __future__ import annotations

from time import perf_counter
from typing import Any

from shootstab.analyses.disc_proof import SPARE_BITS, disc, enough_bits, number
from shootstab.analyses.proof import Decimals, Proof, at_most, in_order, lemmas, named, premise
from shootstab.core.balls import arb
from shootstab.core.errors import ConvergenceError
from shootstab.multiprecision.enclosable import Enclosable
from shootstab.multiprecision.enclosure import at_bits

ONE_VALUE = "E20"
BOUNDED_DISCS = 8  # chosen: discs in which |D| is bounded; a small one bounds it better
DISC_RATIO = 4.0  # chosen: the factor from one disc to the next
KNOWN = 20  # chosen: bits of D, so that its size is known to a millionth
SMALLEST = 1e-3  # chosen: the radius, in |σ|, on which D is known to so many bits; the value at σ itself is what counts
RADIUS_DIGITS = 6  # chosen: digits of the radius


def clear_of_zeros(forms: tuple[Enclosable, ...], centre: Decimals) -> Proof:
    """That no eigenvalue lies in a disc about the centre, the largest that one value of each factor of D gives.

    margin is M/|D(σ)|, the part of the disc in which D is bounded that is proved to be free of zeros being its inverse. Raises
    ConvergenceError where D is not told from 0 at the centre, or has no bound around it.
    """
    began = perf_counter()
    found = [_clear(form, centre) for form in forms]
    radius, ratio, bits = min(part[0] for part in found), max(part[1] for part in found), max(part[2] for part in found)
    return Proof(
        (0,) * len(forms),
        {"shape": "disc", "centre": named(centre), "radius": at_most(radius, RADIUS_DIGITS)},
        ratio,
        bits,
        1,
        sum(part[3] for part in found),
        perf_counter() - began,
        in_order({*lemmas(forms), ONE_VALUE}),
        premise=premise(forms),
    )


def _clear(form: Enclosable, centre: Decimals) -> tuple[float, float, int, int]:
    """The radius for one factor, M/|D| with it, the bits, and how many values of D it took."""
    size = abs(complex(float(centre[0]), float(centre[1])))
    bits, spent = enough_bits(form, centre, repr(SMALLEST * size), SPARE_BITS, KNOWN)
    best, ratio = 0.0, 0.0
    with at_bits(bits):
        at = number(centre)
        for k in range(BOUNDED_DISCS):
            outer = form.outer * size / DISC_RATIO**k
            bounded, value = _bound_and_size(form, bits, at, outer)
            spent += 1
            if bounded is None:
                continue
            radius = arb(outer) * (value - bounded).exp()
            if float(radius.lower()) > best:
                best, ratio = float(radius.lower()), float((bounded - value).exp().upper())
    if best <= 0.0:
        raise ConvergenceError("D is not told from 0 there, or has no bound around it")
    return best, ratio, bits, spent


def _bound_and_size(form: Enclosable, bits: int, at: Any, outer: float) -> tuple[Any, Any]:
    """ln M in the disc, None where there is no bound, and ln |D| at its centre."""
    region = disc(at, arb(outer))
    try:
        D = form.enclosure(bits, region)
        bound, size = D.growth(region), abs(D(at)).log()
    except ConvergenceError:
        return None, None
    return (bound, size) if bound.is_finite() and size.is_finite() else (None, None)
