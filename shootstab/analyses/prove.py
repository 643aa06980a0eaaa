"""Theorems on eigenvalues: exactly n in a disc, in a rectangle, or above a growth rate, with multiplicity, proved in ball arithmetic.

Not an error bar but an enclosure: D is enclosed at points (multiprecision.enclosure), bounded on a larger circle, and Pellet's theorem
counts (roots.pellet). A proof rests on the lemmas of the guide's theory that it names, on the correctness of python-flint's balls, and on
the equations as the problem's closed form writes them, with every parameter the decimal that was typed. Discs and rectangles have exact
decimals for their numbers.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from time import perf_counter
from typing import Any

import mpmath
from flint import acb, arb

from shootstab.analyses.refine import refine
from shootstab.core.errors import ConvergenceError, InputError
from shootstab.core.regions import Rectangle
from shootstab.multiprecision.enclosable import ClosedFormEnclosable, Enclosable
from shootstab.multiprecision.enclosure import Enclosure, at_bits, decimal
from shootstab.problems.capabilities import CLOSED_FORM, ENCLOSABLE, GROWING_REGION
from shootstab.problems.protocol import Problem
from shootstab.roots.pellet import SPARE_POINTS, TaylorModel, nats_for, points_for, polynomial_model, taylor_model

LEMMAS = ("E1", "E2", "E3", "E4", "E5", "E6", "E7")  # of the guide's page on proofs: E7 is what "with multiplicity" rests on
SPARE_BITS = 96  # chosen: beyond the digits asked for; more are taken where the enclosure of D is too wide
MORE_BITS, MOST_BITS = 1.6, 4096  # chosen: the factor of bits from one attempt to the next, and a budget of some minutes
KNOWN_BITS = 40  # chosen: of D on the circle: an inequality that fails with so many fails for another reason than too few bits
TOLD, MOST_PROBES = 4, 12  # chosen: bits of D from which on it is told from 0, and how often more are tried
MOST_POINTS = 96  # chosen: values of D on a circle
OUTER = 0.5  # chosen: the circle on which |D| is bounded, in |σ|; nearer circles need more points, wider ones more bits
# chosen: of |σ|, the first disc in the search for the largest in which a mode is alone, and the factor to the next
WIDEST, NARROWER = 0.125, 1.25
SPARE_DIGITS = 6  # chosen: of the mode beyond the digits of the disc around it
CONTOUR_SAMPLES_BITS = 192  # chosen: of the values of D that tell how many bits and points a contour needs
# chosen: spare bits of D on a contour, for a zero 2^−12 of the contour away; how often they are raised
CONTOUR_BITS, CONTOUR_ATTEMPTS = 24, 3
RIM = 12  # chosen: values of D on a circle, and on a side of a contour, by which its size is judged
RECTANGLE_SLACK = 1.0625  # chosen: the disc on which D is one polynomial, over the half diagonal of the rectangle

Progress = Callable[[int, int], None]
Decimals = tuple[str, str]  # real and imaginary part


@dataclass(frozen=True)
class Proof:
    """Proved: exactly `count` eigenvalues, with multiplicity, lie in the region, and none on its boundary.

    region is {"shape": "disc", "centre", "radius"} or {"shape": "rectangle", "corners"}, its numbers exact decimals. margin is the factor
    by which the decisive inequality holds, the least one of a contour. alone is the radius of the largest disc about the same centre in
    which the count was proved too; floor
    stands where the count is that of all eigenvalues with Re σ ≥ floor. bits, points and evaluations say
    what it took, lemmas what it relies on.
    """

    count: int
    region: dict[str, Any]
    margin: float
    bits: int
    points: int
    evaluations: int
    seconds: float
    lemmas: tuple[str, ...] = LEMMAS
    alone: float | None = None
    floor: float | None = None

    @property
    def statement(self) -> str:
        """The theorem in words."""
        many = f"exactly {self.count} eigenvalues"
        if self.floor is not None:
            subject = {0: "no eigenvalue has", 1: "exactly one eigenvalue has"}.get(self.count, f"{many} have")
            return f"{subject} Re σ ≥ {self.floor!r}"
        subject = {0: "no eigenvalue lies", 1: "exactly one eigenvalue lies"}.get(self.count, f"{many} lie")
        if self.region["shape"] == "disc":
            return f"{subject} in |σ − ({_shown(self.region['centre'])})| < {self.region['radius']}"
        low, high = self.region["corners"]
        return f"{subject} in the rectangle from {_shown(low)} to {_shown(high)}"


def prove(problem: Problem, guess: Any, digits: int = 12) -> Proof:
    """Exactly one eigenvalue (or m, where it is m-fold) in a disc of radius at most 10^−digits |σ| about the mode next to guess.

    Raises InputError for a problem without a closed form, ConvergenceError where the mode is not found or the inequality does not hold.
    """
    if not 1 <= digits <= 1000:
        raise InputError(f"digits = {digits}: allowed is 1 to 1000")
    form = enclosable(problem)
    began = perf_counter()
    mode = refine(problem, guess, digits=max(digits + SPARE_DIGITS, 13))
    if not mode.converged:
        raise ConvergenceError(f"no mode to prove: {mode.status}")
    with mpmath.workdps(digits + 2 * SPARE_DIGITS):
        places = digits - math.floor(float(mpmath.log10(abs(mode.sigma))))
        centre = tuple(_rounded(part, places + SPARE_DIGITS) for part in (mode.sigma.real, mode.sigma.imag))
    return _around(form, centre, f"1e-{places}" if places >= 0 else f"1e{-places}", began, True)  # type: ignore[arg-type]


def prove_disc(problem: Problem, centre: complex, radius: float) -> Proof:
    """Exactly n eigenvalues in this disc, n found; floats stand for their shortest decimals.

    Raises ConvergenceError where none is proved.
    """
    if not 0.0 < radius < math.inf:
        raise InputError(f"radius = {radius!r}: allowed is a finite number above 0")
    at = complex(centre)
    return _around(enclosable(problem), (repr(at.real), repr(at.imag)), repr(float(radius)), perf_counter(), False)


def prove_rectangle(problem: Problem, region: Rectangle, progress: Progress | None = None) -> Proof:
    """Exactly n eigenvalues in this rectangle, n found: D is one polynomial on a disc around it, whose phase is followed in proved pieces.

    progress(done, total) counts values of D. Raises ConvergenceError where an eigenvalue lies on the boundary or too near to it.
    """
    form = enclosable(problem)
    began = perf_counter()
    corners = [(repr(v.real), repr(v.imag)) for v in region.vertices]
    middle, half = (region.vertices[0] + region.vertices[2]) / 2, abs(region.vertices[2] - region.vertices[0]) / 2
    bits, points = _contour_settings(form, region.vertices, middle, half * RECTANGLE_SLACK)
    failure = ""
    for attempt in range(CONTOUR_ATTEMPTS):
        with at_bits(bits):
            enclosure, centre, radius = Enclosure(form, bits), acb(middle.real, middle.imag), arb(half * RECTANGLE_SLACK)
            log_bound = enclosure.growth(_disc(centre, 2 * radius))
            model = polynomial_model(enclosure, log_bound, centre, radius, 2 * radius, points, progress)
            try:
                count, margin = model.count([_number(c) for c in corners])
            except ConvergenceError as error:
                failure = str(error)
            else:
                shape = {"shape": "rectangle", "corners": [_named(corners[0]), _named(corners[2])]}
                return Proof(count, shape, margin, bits, points, (attempt + 1) * points, perf_counter() - began)
        bits, points = math.ceil(MORE_BITS * bits), math.ceil(1.25 * points)
    raise ConvergenceError(failure)


def prove_growing(problem: Problem, floor: float, progress: Progress | None = None) -> Proof:
    """Exactly n eigenvalues with Re σ ≥ floor, n found, where a theorem on the problem bounds all of them.

    Raises InputError where there is no such theorem, and as `prove_rectangle` does.
    """
    region, lemma = GROWING_REGION.required(problem)(floor)
    return replace(prove_rectangle(problem, region, progress), floor=floor, lemmas=(*LEMMAS, lemma))


def enclosable(problem: Problem) -> Enclosable:
    """The problem in balls: by its own formulation, or by its closed form. Raises InputError where it has neither."""
    form = CLOSED_FORM.of(problem)
    return ENCLOSABLE.required(problem) if form is None else ClosedFormEnclosable(form)  # type: ignore[no-any-return]


def _around(form: Enclosable, centre: Decimals, radius: str, began: float, alone: bool) -> Proof:
    """Pellet's theorem on a disc, with as many bits as it takes."""
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
        widest = None
        if alone and count > 0:
            wider = _wide_model(enclosure, at, float(radius), size)
            widest = max(_alone(wider, count, float(radius)), float(radius))
            spent += len(wider.sizes) + 1
    shape = {"shape": "disc", "centre": _named(centre), "radius": radius}
    return Proof(count, shape, model.margin(count), bits, len(model.sizes), spent, perf_counter() - began, alone=widest)


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
    log_bound, log_size = enclosure.growth(_disc(centre, arb(outer))), _log_size(enclosure, centre + radius)
    points = points_for(log_bound, log_size, radius, arb(outer), MOST_POINTS)
    return taylor_model(enclosure, log_bound, centre, radius, arb(outer), points)


def _wide_model(enclosure: Enclosure, centre: Any, radius: float, size: float) -> TaylorModel:
    """The same on a circle of WIDEST·|σ|, or a smaller one for which MOST_POINTS do."""
    outer = max(OUTER * size, 8.0 * radius)
    log_bound, log_size = enclosure.growth(_disc(centre, arb(outer))), _log_size(enclosure, centre + arb(radius))
    log_size += math.log(WIDEST * size / radius) if radius < WIDEST * size else 0.0  # D grows about so much, being linear
    far = outer * math.exp(-nats_for(log_bound, log_size) / (MOST_POINTS - SPARE_POINTS))
    return _model(enclosure, centre, arb(max(min(WIDEST * size, far), radius)), outer)


def _log_size(enclosure: Enclosure, sigma: Any) -> Any:
    """ln |D|; where D is not told from 0 some number, which serves to choose points."""
    found = abs(enclosure(sigma)).log()
    return found if found.is_finite() else arb(-200)


def _alone(model: TaylorModel, count: int, least: float) -> float:
    """The largest disc up to that of the model, by factors, in which the same is proved; 0 where it is none above the least."""
    radius = float(model.radius)
    while radius > least:
        if model.shrunk(arb(radius)).proved() == count:
            return radius
        radius /= NARROWER
    return 0.0


def _contour_settings(form: Enclosable, corners: Sequence[complex], middle: complex, radius: float) -> tuple[int, int]:
    """Bits and points, from the sizes of D on the contour and on the circle and from what an enclosure of D loses; choices, not bounds."""
    with at_bits(CONTOUR_SAMPLES_BITS):
        enclosure, centre, R = Enclosure(form, CONTOUR_SAMPLES_BITS), acb(middle.real, middle.imag), arb(radius)
        rim = [enclosure(centre + R * (acb(2 * j) / RIM).exp_pi_i()) for j in range(RIM)]
        sides = zip(corners, [*corners[1:], corners[0]], strict=True)
        edge = [enclosure(acb(s.real, s.imag)) for a, b in sides for s in (a + (b - a) * x / RIM for x in range(RIM))]
        least, largest = min(map(_nats, edge)), max(map(_nats, rim))
        loss = max(0, CONTOUR_SAMPLES_BITS - min(int(D.rel_accuracy_bits()) for D in (*rim, *edge)))
        bound = float(enclosure.growth(_disc(centre, 2 * R)).mid())
    bits = loss + math.ceil((largest - least) / math.log(2)) + CONTOUR_BITS
    return max(bits, 64), math.ceil((bound - least) / math.log(2)) + CONTOUR_BITS


def _nats(D: Any) -> float:
    return float(abs(D).log().mid())


def _disc(centre: Any, radius: Any) -> Any:
    """A square ball that holds the disc."""
    spread = arb(0, radius.upper())
    return acb(centre.real + spread, centre.imag + spread)


def _number(at: Decimals) -> Any:
    return acb(decimal(at[0]), decimal(at[1]))


def _named(at: Decimals) -> dict[str, str]:
    return {"re": at[0], "im": at[1]}


def _shown(at: dict[str, str]) -> str:
    sign, size = ("−", at["im"][1:]) if at["im"].startswith("-") else ("+", at["im"])
    return f"{at['re']} {sign} {size}i"


def _rounded(x: Any, places: int) -> str:
    """A decimal with so many places behind the point."""
    whole = int(mpmath.nint(x * mpmath.mpf(10) ** places))
    if places <= 0:
        return str(whole * 10**-places)
    digits = str(abs(whole)).rjust(places + 1, "0")
    return f"{'-' if whole < 0 else ''}{digits[:-places]}.{digits[-places:]}"
