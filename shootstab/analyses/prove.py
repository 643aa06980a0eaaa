"""Theorems on eigenvalues: exactly n in a disc, in a region, or above a growth rate, with multiplicity, proved in ball arithmetic.

Not an error bar but an enclosure: D is enclosed at points (multiprecision.enclosure), bounded on a larger circle, and Pellet's theorem
counts (roots.pellet). A proof rests on the lemmas of the guide's page on proofs that it names, on the correctness of python-flint's balls,
and on the equations as the problem writes them, with every parameter the decimal that was typed. Discs and rectangles have exact decimals
for their numbers.
"""

from __future__ import annotations

import math
from dataclasses import replace
from time import perf_counter

from shootstab.analyses.contour_proof import CONTOUR_BITS, along
from shootstab.analyses.disc_proof import around, polished
from shootstab.analyses.enclosables import factors, one_polynomial
from shootstab.analyses.interval_proof import over
from shootstab.analyses.pieces_proof import by_pieces
from shootstab.analyses.proof import Decimals, Proof
from shootstab.analyses.refine import refine
from shootstab.core.allowed import MOST_PROOF_DIGITS, PROOF_DIGITS
from shootstab.core.errors import ConvergenceError, InputError
from shootstab.core.given import complex_of, require_above_0, require_whole
from shootstab.core.half_annulus import HalfAnnulus
from shootstab.core.progress import Progress
from shootstab.core.regions import Disc, Rectangle
from shootstab.multiprecision.arithmetic import exact
from shootstab.multiprecision.enclosable import Enclosable
from shootstab.problems.capabilities import GROWING_REGION, VARIED
from shootstab.problems.protocol import Problem

SPARE_DIGITS = 6  # chosen: digits of the mode beyond those of the disc around it


def prove(problem: Problem, guess: complex, digits: int = PROOF_DIGITS) -> Proof:
    """Exactly one eigenvalue (or m, where it is m-fold) in a disc of radius at most 10^−digits |σ| about the mode next to guess.

    Raises InputError for a problem that has no enclosure, ConvergenceError where the mode is not found or the inequality does not hold.
    """
    require_whole("digits", digits, 1, MOST_PROOF_DIGITS)
    forms, began = factors(problem), perf_counter()
    mode = refine(problem, guess)
    if not mode.converged:
        raise ConvergenceError(f"no mode to prove: {mode.status}")
    sigma = complex(mode.sigma)
    if abs(sigma) <= mode.error:
        raise ConvergenceError("no mode to prove: it may be at 0, which has no digits: ask for a disc about 0")
    places = digits - math.floor(math.log10(abs(sigma)))
    radius = f"1e-{places}" if places >= 0 else f"1e{-places}"
    centre = _centre(forms, sigma, float(mode.error), places + SPARE_DIGITS, radius)
    proof = around(forms, centre, radius, True)
    if proof.count == 0:
        raise ConvergenceError(f"{proof.statement}, next to what double precision took for one")
    return replace(proof, seconds=perf_counter() - began)


def prove_disc(
    problem: Problem, centre: complex, radius: float, alone: bool = False, progress: Progress | None = None, workers: int | None = 1
) -> Proof:
    """Exactly n eigenvalues in this disc, n found; floats stand for their shortest decimals.

    With alone the largest disc about the same centre is looked for in which there are as many. Where values of D are dear, as the chute's,
    and its series does not tell, D is followed along the circle, which workers processes share, as in `prove_region`. Raises
    ConvergenceError where none is proved.
    """
    require_above_0("radius", radius)
    at, forms = complex_of("centre", centre), factors(problem)
    try:
        return around(forms, (repr(at.real), repr(at.imag)), repr(float(radius)), alone)
    except ConvergenceError:
        if one_polynomial(forms):
            raise
        return by_pieces(problem, Disc(at, radius), CONTOUR_BITS, progress, workers)


def prove_region(
    problem: Problem,
    region: Rectangle | HalfAnnulus,
    progress: Progress | None = None,
    spare_bits: int = CONTOUR_BITS,
    workers: int | None = None,
) -> Proof:
    """Exactly n eigenvalues in this region, n found: in a rectangle by one polynomial where values of D are cheap, else along the boundary.

    progress(done, total) counts values of D. spare_bits are those of D on the boundary: n more for a zero 2^−n times as near to it. workers
    processes share what there is to do along a boundary, None as many as there are cores. Raises ConvergenceError where an eigenvalue lies
    on the boundary or too near to it, or a continuous spectrum does.
    """
    forms = factors(problem)
    if isinstance(region, Rectangle) and one_polynomial(forms):
        return along(forms, region, spare_bits, progress)
    return by_pieces(problem, region, spare_bits, progress, workers)


def prove_interval(
    problem: Problem,
    name: str,
    low: float,
    high: float,
    region: Rectangle | None = None,
    floor: float | None = None,
    progress: Progress | None = None,
    spare_bits: int = CONTOUR_BITS,
) -> Proof:
    """The theorem of `prove_region`, or with a floor of `prove_growing`, for every value of the parameter of that name from low to high.

    The numbers are the decimals that floats stand for. Raises InputError where the problem has no such parameter.
    """
    if (region is None) == (floor is None):
        raise InputError("an interval of a parameter: allowed is one of region and floor")
    if not -math.inf < low < high < math.inf:
        raise InputError(f"{name} from {low!r} to {high!r}: allowed are two finite numbers, the smaller one first")
    made, lemma = VARIED.required(problem)(name), None
    if floor is not None:
        if not low > 0.0:
            raise InputError(f"{name} from {low!r}: allowed is a number above 0")
        region, lemma = GROWING_REGION.required(problem)(floor, **{name: high})
    assert region is not None
    proof = over(made, name, exact(low), exact(high), region, spare_bits, progress)
    return proof if lemma is None else replace(proof, floor=floor, lemmas=(*proof.lemmas, lemma))


def prove_growing(problem: Problem, floor: float, progress: Progress | None = None, spare_bits: int = CONTOUR_BITS) -> Proof:
    """Exactly n eigenvalues with Re σ ≥ floor, n found, where a theorem on the problem bounds all of them.

    Raises InputError where there is no such theorem, and as `prove_region` does.
    """
    region, lemma = GROWING_REGION.required(problem)(floor)
    proof = prove_region(problem, region, progress, spare_bits)
    return replace(proof, floor=floor, lemmas=(*proof.lemmas, lemma))


def _centre(forms: tuple[Enclosable, ...], seed: complex, error: float, places: int, radius: str) -> Decimals:
    """The zero next to the seed of the first factor that has one there."""
    for form in forms[:-1]:
        try:
            return polished(form, seed, error, places, radius)
        except ConvergenceError:
            continue
    return polished(forms[-1], seed, error, places, radius)
