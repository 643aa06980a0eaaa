"""A list whose claims are modes at another value of one parameter: the wavenumber or the Reynolds number of another run.

A claim v is a mode at p where D(v; p) = 0, two real equations for one real p, so that a claim by itself says whether there is one; the
others are tested there. Newton's step s(p) = −D/∂_vD at v is about the distance from v to a mode at p, whatever factor D has. Secants in
ln p bring it to zero from values that are near enough. What is found is only proposed.
"""

from __future__ import annotations

import cmath
import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass

from shootstab.analyses.hypotheses import LEAST, ROUGHLY, TRIED, agreed, enough
from shootstab.core.errors import ShootstabError
from shootstab.core.records import INACCURATE, SPURIOUS, Report
from shootstab.discriminants.continuation import Continuation
from shootstab.problems.protocol import Problem

WIDEST_CHANGE = 0.7  # chosen: the largest |ln p/here| that is tried: half and twice the parameter
VALUES_APART = 0.025  # chosen: the distance of values that are tried; where modes move by more, others come next to the claim
PROMISING = 3.0  # chosen: how far from such a value a secant may lead, in VALUES_APART; with 2 half of the parameters are missed
MORE_SECANTS = 8  # chosen: further secants from there
SHORT_STEP = 1e-6  # chosen: Newton's step in the claim, so short that the claim is a mode to more digits than are asked to agree
FIGURES = range(2, 7)  # chosen: figures of the value that is proposed, the fewest that do as well; people take round ones
AS_WELL = 0.5  # chosen: digits of claims that a rounder value may cost


@dataclass(frozen=True)
class Variation:
    """A parameter, its value here, and the problem at any other one."""

    here: float
    problem: Callable[[float], Problem]


@dataclass(frozen=True)
class OtherValue:
    """The value of a parameter at which so many of the claims tried are modes, and the fewest digits that these share."""

    parameter: str
    here: float
    value: float
    tried: int
    agreeing: int
    digits: float


def other_values(variations: Mapping[str, Variation], report: Report, digits: int) -> tuple[OtherValue, ...]:
    """Those that hold, one for a parameter, if the report calls every claim spurious or inaccurate; nothing otherwise."""
    claims = sorted((v.claimed for v in report.verdicts if v.claimed != 0.0), key=abs)[:TRIED]
    if len(claims) < LEAST or any(v.verdict not in (SPURIOUS, INACCURATE) for v in report.verdicts):
        return ()
    found = (_of_parameter(name, variation, claims, digits) for name, variation in variations.items() if variation.here != 0.0)
    return tuple(value for value in found if value is not None)


def _of_parameter(name: str, variation: Variation, claims: Sequence[complex], digits: int) -> OtherValue | None:
    """The first value found at which enough of the claims are modes; one of the claims that are followed is a mode if there is such."""
    for claim in claims[: len(claims) - enough(len(claims)) + 1]:
        for t in _arrivals(variation, claim):
            exact = variation.here * math.exp(t)
            values = [float(f"{exact:.{figures}g}") for figures in FIGURES]
            best = _shared(variation, values[-1], claims, digits)
            if len(best) < enough(len(claims)):
                continue
            for value in values:
                shared = _shared(variation, value, claims, digits)
                if len(shared) == len(best) and min(shared) >= min(best) - AS_WELL:
                    return OtherValue(name, variation.here, value, len(claims), len(shared), min(shared))
    return None


def _shared(variation: Variation, value: float, claims: Sequence[complex], digits: int) -> list[float]:
    """The digits that claims share with modes at a value."""
    try:
        return agreed(variation.problem(value), digits, claims)
    except ShootstabError:
        return []


def _arrivals(variation: Variation, claim: complex) -> Iterator[float]:
    """The ln(p/here) at which the claim is a mode, as far as secants between neighbouring values lead there, the nearest first."""
    steps = round(WIDEST_CHANGE / VALUES_APART)
    known: dict[int, complex] = {}
    for k in sorted(range(-steps, steps), key=abs):
        for i in (k, k + 1):
            if i not in known:
                known[i] = _distance(variation, claim, i * VALUES_APART)
        step = _secant(known[k + 1], known[k], VALUES_APART)
        if abs(step) <= PROMISING * VALUES_APART:
            arrived = _followed(variation, claim, (k + 1) * VALUES_APART, known[k + 1], step.real)
            if arrived is not None:
                yield arrived


def _secant(now: complex, before: complex, apart: float) -> complex:
    """The step in t to where a line through both is zero; infinite where there is none."""
    change = now - before
    step = -now * apart / change if change != 0.0 else complex(math.inf)
    return step if cmath.isfinite(step) else complex(math.inf)


def _followed(variation: Variation, claim: complex, t: float, at_t: complex, step: float) -> float | None:
    """The t at which secants from here arrive; None where they do not."""
    for _ in range(MORE_SECANTS):
        if abs(at_t) <= SHORT_STEP * abs(claim):
            return t
        if not 0.0 < abs(step) <= PROMISING * VALUES_APART:
            return None
        before, t = at_t, t + step
        at_t = _distance(variation, claim, t)
        step = _secant(at_t, before, step).real
    return None


def _distance(variation: Variation, claim: complex, t: float) -> complex:
    """Newton's step from the claim at ln(p/here) = t, infinite where D has none or there is no problem."""
    try:
        problem = variation.problem(variation.here * math.exp(t))
        step = Continuation(problem, ROUGHLY).along(claim)[0].with_derivative(claim).newton_step
    except ShootstabError:
        return complex(math.inf)
    return step if cmath.isfinite(step) else complex(math.inf)
