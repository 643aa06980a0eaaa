"""A list whose claims are modes at another value of one parameter: the wavenumber or the Reynolds number of another run.

A claim by itself says at which values of p it is a mode (see `arrivals`, in ln p); the others are tested there. What is found is only
proposed.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial

from shootstab.analyses.arrivals import Steps, arrivals
from shootstab.analyses.hypotheses import LEAST, ROUGHLY, TRIED, agreed, enough, newton_step
from shootstab.core.errors import ShootstabError
from shootstab.core.records import INACCURATE, SPURIOUS, Report
from shootstab.discriminants.continuation import Continuation
from shootstab.problems.protocol import Problem

WIDEST_CHANGE = 0.7  # chosen: the largest |ln p/here| that is tried: half and twice the parameter
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
    followed = claims[: len(claims) - enough(len(claims)) + 1]
    for t in arrivals(partial(_steps, variation), followed, WIDEST_CHANGE):
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


def _steps(variation: Variation, t: float) -> Steps:
    """Newton's steps at ln(p/here) = t, infinite where D has none or there is no problem."""
    try:
        continuation = Continuation(variation.problem(variation.here * math.exp(t)), ROUGHLY)
    except ShootstabError:
        return lambda claim: complex(math.inf)
    return partial(newton_step, continuation)
