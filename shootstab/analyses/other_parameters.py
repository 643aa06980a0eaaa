"""A list whose claims are modes at another value of one parameter, or of two: the wavenumber and the Reynolds number of another run.

A claim by itself says at which values of p it is a mode (see `arrivals`, in ln p), and nearby at which values of two: D = 0 are two real
equations. The other claims are tested there. What is found is only proposed.
"""

from __future__ import annotations

import cmath
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from itertools import combinations

import numpy as np

from shootstab.analyses.arrivals import SHORT_STEP, Steps, arrivals
from shootstab.analyses.hypotheses import LEAST, ROUGHLY, TRIED, agreed, enough, newton_step
from shootstab.core.allowance import Allowance
from shootstab.core.errors import ShootstabError
from shootstab.core.records import INACCURATE, SPURIOUS, Report
from shootstab.discriminants.continuation import Continuation
from shootstab.problems.protocol import Problem

WIDEST_CHANGE = 0.7  # chosen: the largest |ln p/here| that is tried: half and twice the parameter
FIGURES = range(2, 7)  # chosen: figures of the value that is proposed, the fewest that do as well; people take round ones
AS_WELL = 0.5  # chosen: digits of claims that a rounder value may cost
PAIR_STEPS = 10  # chosen: Newton's steps in two parameters; the last of them are quadratic
PAIR_DIFFERENCE = 1e-4  # chosen: differences in ln p that stand for derivatives there
LONGEST_PAIR_STEP = 0.2  # chosen: longer steps in ln p leave what a derivative tells
SINGLE, PAIRS = 0.7, 0.9  # chosen: the parts of what is left that one parameter after the other may take, and two at once


@dataclass(frozen=True)
class Variation:
    """A parameter, its value here, and the problem at any other one."""

    here: float
    problem: Callable[[float], Problem]


@dataclass(frozen=True)
class OtherValue:
    """The value of a parameter at which so many of the claims tried are modes, and the fewest digits that these share.

    second is another parameter that differs too, with its value here and there; None where one is enough.
    """

    parameter: str
    here: float
    value: float
    tried: int
    agreeing: int
    digits: float
    second: tuple[str, float, float] | None = None


@dataclass(frozen=True)
class Searched:
    """What was found, and between which values of each parameter was looked."""

    found: tuple[OtherValue, ...]
    ranges: Mapping[str, tuple[float, float]]
    pairs: tuple[tuple[str, str], ...] = ()


Together = Callable[[Mapping[str, float]], Problem]


def other_values(
    variations: Mapping[str, Variation],
    report: Report,
    digits: int,
    allowance: Allowance | None = None,
    together: Together | None = None,
) -> Searched:
    """Those that hold, one for a parameter, if the report calls every claim spurious or inaccurate; nothing otherwise.

    Where none does, two parameters at once are tried if `together` makes the problem at values of both.
    """
    allowance = allowance or Allowance()
    claims = sorted((v.claimed for v in report.verdicts if v.claimed != 0.0), key=abs)[:TRIED]
    if len(claims) < LEAST or any(v.verdict not in (SPURIOUS, INACCURATE) for v in report.verdicts):
        return Searched((), {})
    varied = {name: variation for name, variation in variations.items() if variation.here != 0.0}
    found: list[OtherValue] = []
    ranges: dict[str, tuple[float, float]] = {}
    for i, (name, variation) in enumerate(varied.items()):
        with allowance.share(SINGLE / (len(varied) - i)) as own:
            one, ranges[name] = _of_parameter(name, variation, claims, digits, own)
        found += [] if one is None else [one]
    tried: list[tuple[str, str]] = []
    for first, second in combinations(varied, 2) if together is not None and not found and len(claims) > LEAST else ():
        assert together is not None
        if allowance.spent:
            break
        tried.append((first, second))
        with allowance.share(PAIRS) as own:
            pair = _of_pair(first, second, varied, together, claims, digits, own)
        if pair is not None:
            return Searched((pair,), ranges, tuple(tried))
    return Searched(tuple(found), ranges, tuple(tried))


def _of_parameter(
    name: str, variation: Variation, claims: Sequence[complex], digits: int, allowance: Allowance
) -> tuple[OtherValue | None, tuple[float, float]]:
    """The first value found at which enough of the claims are modes, of which one that is followed is one; and the range looked at."""
    followed = claims[: len(claims) - enough(len(claims)) + 1]
    looked = [0.0]

    def steps(t: float) -> Steps:
        looked.append(t)
        return _steps(variation.problem, variation.here * math.exp(t))

    found = None
    for t in arrivals(steps, followed, WIDEST_CHANGE, allowance):
        exact = variation.here * math.exp(t)
        found = _rounded(name, variation, exact, claims, digits)
        if found is not None:
            break
    low, high = sorted((variation.here * math.exp(min(looked)), variation.here * math.exp(max(looked))))
    return found, (low, high)


def _rounded(name: str, variation: Variation, exact: float, claims: Sequence[complex], digits: int) -> OtherValue | None:
    """The roundest value next to this one at which the claims are modes as well as there; None where too few are there."""
    values = [float(f"{exact:.{figures}g}") for figures in FIGURES]
    best = _shared(variation.problem, values[-1], claims, digits)
    if len(best) < enough(len(claims)):
        return None
    for value in values:
        shared = _shared(variation.problem, value, claims, digits)
        if len(shared) == len(best) and min(shared) >= min(best) - AS_WELL:
            return OtherValue(name, variation.here, value, len(claims), len(shared), min(shared))
    return None


def _of_pair(
    first: str,
    second: str,
    varied: Mapping[str, Variation],
    together: Together,
    claims: Sequence[complex],
    digits: int,
    allowance: Allowance,
) -> OtherValue | None:
    """Values of two parameters, next to those here, at which enough of the claims are modes."""
    here = np.array([varied[first].here, varied[second].here])

    def problem(values: Sequence[float]) -> Problem:
        return together({first: values[0], second: values[1]})

    for claim in claims[: len(claims) - enough(len(claims)) + 1]:
        logarithms = _meeting(lambda t: _steps(problem, here * np.exp(t))(claim), claim, allowance)  # noqa: B023 - called at once
        if logarithms is None:
            continue
        exact = here * np.exp(logarithms)
        best: list[float] = []
        for figures in reversed(FIGURES):  # the fewest that do as well as the most
            value = [float(f"{x:.{figures}g}") for x in exact]
            shared = _shared(problem, value, claims, digits)
            if len(shared) < max(enough(len(claims)), len(best)) or (best and min(shared) < min(best) - AS_WELL):
                break
            best, kept = best or shared, (value, shared)
        if best:
            (one, other), shared = kept
            second_value = (second, varied[second].here, other)
            return OtherValue(first, varied[first].here, one, len(claims), len(shared), min(shared), second_value)
    return None


def _meeting(step: Callable[[np.ndarray], complex], claim: complex, allowance: Allowance) -> np.ndarray | None:
    """The two logarithms at which the claim is a mode, by Newton's method with differences; None where it leads nowhere."""
    t = np.zeros(2)
    for _ in range(PAIR_STEPS):
        if allowance.spent:
            return None
        value = step(t)
        if not cmath.isfinite(value):
            return None
        if abs(value) <= SHORT_STEP * abs(claim):
            return t
        slopes = [(step(t + PAIR_DIFFERENCE * unit) - value) / PAIR_DIFFERENCE for unit in np.eye(2)]
        J = np.array([[s.real for s in slopes], [s.imag for s in slopes]])
        if not np.isfinite(J).all() or np.linalg.matrix_rank(J) < 2:
            return None
        change = np.linalg.solve(J, [-value.real, -value.imag])
        t = t + change * min(1.0, LONGEST_PAIR_STEP / float(np.abs(change).max()))
        if np.abs(t).max() > WIDEST_CHANGE:
            return None
    return None


def _shared(problem: Callable[..., Problem], value: object, claims: Sequence[complex], digits: int) -> list[float]:
    """The digits that claims share with modes at a value."""
    try:
        return agreed(problem(value), digits, claims)
    except ShootstabError:
        return []


def _steps(problem: Callable[..., Problem], value: object) -> Steps:
    """Newton's steps at a value, infinite where D has none or there is no problem."""
    try:
        continuation = Continuation(problem(value), ROUGHLY)
    except ShootstabError:
        return lambda claim: complex(math.inf)
    return partial(newton_step, continuation)
