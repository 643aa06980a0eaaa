"""Certificates for the checker of plane Poiseuille flow, with settings chosen in doubles: it trusts none of them."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

from shootstab.analyses.certificate import disc_of, sides_of
from shootstab.analyses.contour_proof import RIM
from shootstab.analyses.disc_proof import disc
from shootstab.analyses.enclosables import whole
from shootstab.analyses.proof import Proof
from shootstab.core.balls import acb, arb
from shootstab.multiprecision.enclosure import at_bits, decimal
from shootstab.roots.pellet import TAIL_NATS

NORM_WEIGHTS = 1.1 ** np.arange(-12, 8)  # chosen: weights of the norm in which the growth is bounded, in units of the rate √|p|
FARTHEST = 16.0  # chosen: the largest circle on which |D| is bounded, in |σ| or the circle of values; they are tried by factors of two
ABSOLUTE_BITS = 64  # chosen: bits of the checker's numbers beyond what the growth of their errors takes
RATE_SAMPLES = 129  # chosen: places at which the rate of growth is sampled
STEP_PLACES = 6  # chosen: decimals of a step of the integration
LEAST_ORDER = 24  # chosen: terms of its Taylor series at least, twice what the checker allows
# chosen: values of D and bits that the checker has beyond what was needed here; where they are too few there are more attempts
CHECKER_POINTS, CHECKER_BITS = 2, 24
CERTIFICATE_ATTEMPTS = 3  # chosen: attempts, each with more points and bits, before a proof is said to have no certificate
MORE_EACH_ATTEMPT = 1.3  # chosen: factor of points and bits from one attempt to the next


def certificates(problem: Any, proof: Proof, count: int, spare_bits: int) -> Iterator[dict[str, Any]]:
    """Certificates of discs, rectangles and all that grows, each with more points and bits.

    Raises InputError for a proof on another region.
    """
    if proof.region["shape"] == "rectangle":
        region: dict[str, str] = {"floor": repr(proof.floor)} if proof.floor is not None else sides_of(proof)
        low, high = (complex(float(at["re"]), float(at["im"])) for at in proof.region["corners"])
        corners = [low, complex(high.real, low.imag), high, complex(low.real, high.imag)]
        sides = zip(corners, [*corners[1:], corners[0]], strict=True)
        sampled = [a + (b - a) * x / RIM for a, b in sides for x in range(RIM)]
        centre, radius, nats = (low + high) / 2, abs(high - low) / 2, spare_bits * math.log(2)
    else:
        at, size = disc_of(proof, "one on a disc, a rectangle, or on all eigenvalues that grow")
        region = {**at, "radius": size}
        centre, radius, nats = complex(float(at["re"]), float(at["im"])), float(size), TAIL_NATS
        with at_bits(proof.bits):
            sampled = [acb(decimal(at["re"]), decimal(at["im"])) + decimal(size)]
    with at_bits(proof.bits):
        enclosure = whole(problem).enclosure(proof.bits, disc(acb(centre), arb(radius)))
        least = min(float(abs(enclosure(acb(sigma))).log().mid()) for sigma in sampled)
    settings = settings_for(problem.certified, centre, radius, least, nats)
    for attempt in range(CERTIFICATE_ATTEMPTS):
        points = math.ceil(settings["points"] * MORE_EACH_ATTEMPT**attempt) + CHECKER_POINTS
        bits = math.ceil(settings["bits"] * MORE_EACH_ATTEMPT**attempt) + CHECKER_BITS
        yield {"format": 2, "problem": problem.certified, "count": count, "region": region, **settings, "points": points, "bits": bits}


def settings_for(named: Mapping[str, str], centre: complex, radius: float, least: float, nats: float) -> dict[str, Any]:
    """Outer circle, weight, points, bits, order and steps for values of D on a circle.

    least is the smallest ln |D| where D must be told from 0, and the rest of its Taylor series is to lie below it by so many nats.
    """
    R, alpha = float(named["reynolds"]), float(named["alpha"])
    y = np.linspace(0.0, 1.0, RATE_SAMPLES)
    s = centre + 1j * alpha * (1 - y * y)
    p, q = np.abs(2 * alpha**2 + R * s), np.abs(-(alpha**4) - R * alpha**2 * s + 2j * alpha * R)
    rate = math.sqrt(float(p.max()) + R * radius)
    power = 1 if named["modes"] == "even" else 3

    def growth(weight: float, radius_of_bound: float) -> float:
        """The bound on ln |D| in |σ − centre| ≤ radius_of_bound."""
        thick = math.sqrt(2.0) * R * radius_of_bound
        rates = 1 + (p + thick) / weight**2 + (q + alpha**2 * thick) / weight**4
        return float(weight * np.maximum(2.0, rates).mean()) - power * math.log(weight)

    farthest = math.ceil(math.log2(FARTHEST * max(abs(centre), radius) / radius))
    needed = {
        (w, wider): (growth(w, wider * radius) - least + nats) / math.log(wider)
        for w in (rate * NORM_WEIGHTS).tolist()
        for wider in (2.0**j for j in range(1, farthest + 1))
    }
    weight, wider = min(needed, key=lambda at: needed[at])
    errors = min(growth(w, radius) for w in (rate * NORM_WEIGHTS).tolist()) - least + nats
    bits = math.ceil(errors / math.log(2)) + ABSOLUTE_BITS
    count = max(2, math.ceil(rate * 8 / bits))
    step = math.floor(10.0**STEP_PLACES / count) / 10.0**STEP_PLACES
    order, size = 1, 0.0
    while size > -bits or order < LEAST_ORDER:
        size += math.log2(2.0 * rate * step / order)
        order += 1
    return {
        "outer": repr(wider * radius),
        "weight": f"{weight:.4g}",
        "points": max(4, math.ceil(needed[weight, wider])),
        "bits": bits,
        "order": order,
        "steps": [f"{step:.{STEP_PLACES}f}"] * (count - 1),
    }
