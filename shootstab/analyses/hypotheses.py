"""A whole list that is off by one thing: before all claims are called spurious, the usual mistakes are tested against the modes.

A spectrum v may be meant as σ = f v or σ = f v̄, with f of a sign, of i (frequencies), of a wavenumber (phase speeds, σ = −iαc), or of
units. f = ±1, ±i and, for a known α, ±iα are tried on the claims themselves; any other f is that of a claim and a mode of the
pseudospectral reference that takes a second claim to another of its modes. Where the reference has no mode to offer, units alone are
tried, f = |f|, −i|f| and −iα|f|: the |f| at which a claim is a mode (see `arrivals`). Or only one of the two parts of each eigenvalue
was written. One claim in four may be wrong in itself. What is found is only proposed: nothing is judged by it.
"""

from __future__ import annotations

import cmath
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from shootstab.analyses import reference
from shootstab.analyses.arrivals import Steps, arrivals
from shootstab.analyses.verify import verify
from shootstab.core.allowance import Allowance
from shootstab.core.errors import ShootstabError
from shootstab.core.records import CONFIRMED, INACCURATE, SPURIOUS, Report, digits_between
from shootstab.discriminants.continuation import Continuation
from shootstab.discriminants.frame import Frame
from shootstab.problems.protocol import ComplexArray, Problem

TRIED = 4  # claims on which a hypothesis is tested: chosen, as each costs a verdict, and three of four do not agree by chance
MAY_FAIL = 4  # chosen: one claim in so many may be no mode under a hypothesis that is proposed
LEAST = 2  # derived: one claim agrees with some mode under some factor
AGREE = 3.0  # chosen: digits of a claim that must agree with a mode under the hypothesis: a thousand times less than by chance
NEIGHBOURS = 10.0  # chosen: Newton's step may be so many times the distance of a mode that has others beside it
ROUGHLY = Frame(rtol=1e-6)  # chosen: a step needs few digits
HELD_AGAINST_REFERENCE = 40  # chosen: claims that are held against the reference for each factor
WIDEST_UNIT = 1.4  # chosen: the largest |ln |f|| of units without a reference: a quarter and four times
# factors between conventions of sign and of time, exp(σt) and exp(∓iωt), before any scale is looked for
UNITS = (1.0, -1.0, 1j, -1j)  # exact: the fourth roots of 1
PARTS = {"real parts": 1.0, "imaginary parts": -1j, "imaginary parts with the other sign": 1j}  # exact: the part of σ is Re(factor σ)


@dataclass(frozen=True)
class Hypothesis:
    """σ = factor·v, of the conjugate of v if so: how many of the claims tried are then modes, and the fewest digits that these share.

    parts: instead, which parts of eigenvalues of the reference the claims are.
    """

    factor: complex
    conjugate: bool
    tried: int
    digits: float
    agreeing: int
    parts: str = ""

    def applied(self, claim: complex) -> complex:
        """The claim as it may have been meant."""
        return self.factor * (claim.conjugate() if self.conjugate else claim)


def hypotheses(
    problem: Problem, report: Report, digits: int, factors: Sequence[complex] = UNITS, allowance: Allowance | None = None
) -> tuple[Hypothesis, ...]:
    """The hypotheses that hold for the claims tried, if the report calls all claims spurious, else none. factors are tried first.

    The allowance is for the units that are tried where no reference lists modes.
    """
    claims = [v.claimed for v in report.verdicts if v.claimed != 0.0]
    if len(claims) < LEAST or any(v.verdict != SPURIOUS for v in report.verdicts):
        return ()
    claims = sorted(claims, key=abs)
    modes = reference.eigenvalues(problem, digits)
    for factors_of in (lambda conjugate: factors, lambda conjugate: _factors(modes, claims, conjugate)):
        found = _holding(problem, digits, claims[:TRIED], factors_of)
        if found:
            return tuple(found)
    return (
        _as_parts(modes, claims[:TRIED])
        if len(modes)
        else _in_other_units(problem, claims[:TRIED], digits, factors, allowance or Allowance())
    )


def _in_other_units(
    problem: Problem, claims: Sequence[complex], digits: int, factors: Sequence[complex], allowance: Allowance
) -> tuple[Hypothesis, ...]:
    """The first unit found in which the claims are modes: a positive multiple of a factor that is 1 or a clockwise turn."""
    continuation = Continuation(problem, ROUGHLY)
    turns = tuple(dict.fromkeys(f for f in map(complex, factors) if f.real > 0.0 or f.imag < 0.0))
    for i, unit in enumerate(turns):

        def steps(t: float, unit: complex = unit) -> Steps:
            factor = unit * math.exp(t)
            return lambda v: newton_step(continuation, factor * v) / factor

        with allowance.share(1.0 / (len(turns) - i)) as own:
            for t in arrivals(steps, claims[: len(claims) - enough(len(claims)) + 1], WIDEST_UNIT, own):
                factor = unit * math.exp(t)
                shared = agreed(problem, digits, [factor * claim for claim in claims])
                if len(shared) >= enough(len(claims)):
                    return (Hypothesis(factor, False, len(claims), min(shared), len(shared)),)
    return ()


def enough(claims: int) -> int:
    """How many of the claims tried must be modes."""
    return max(LEAST, claims - claims // MAY_FAIL)


def _as_parts(reference_modes: ComplexArray, claims: Sequence[complex]) -> tuple[Hypothesis, ...]:
    """Whether real claims are the real or the imaginary parts of eigenvalues of the reference that have both."""
    modes = reference_modes[(reference_modes.imag != 0.0) & (reference_modes.real != 0.0)]
    if not len(modes) or any(c.imag != 0.0 for c in claims):
        return ()
    own = np.array([c.real for c in claims])
    for parts, factor in PARTS.items():
        off = np.abs((factor * modes).real - own[:, None]).min(axis=1) / np.abs(own)
        close = off <= 10.0**-AGREE
        if close.sum() >= enough(len(own)):
            return (Hypothesis(1.0, False, len(own), digits_between(float(off[close].max()), 1.0), int(close.sum()), parts),)
    return ()


def _holding(problem: Problem, digits: int, claims: Sequence[complex], factors: Callable[[bool], Sequence[complex]]) -> list[Hypothesis]:
    """The hypotheses under which the claims are modes; the first of those that map the claims to the same numbers."""
    found: list[Hypothesis] = []
    continuation = Continuation(problem, ROUGHLY)
    for conjugate in (False, True):
        for factor in factors(conjugate):
            wanted = Hypothesis(factor, conjugate, len(claims), 0.0, 0)
            meant = [wanted.applied(c) for c in claims]
            if (factor == 1.0 and not conjugate) or any(np.allclose(meant, [h.applied(c) for c in claims]) for h in found):
                continue
            if sum(_may_mean_a_mode(continuation, claim) for claim in meant) < enough(len(meant)):
                continue
            shared = agreed(problem, digits, meant)
            if len(shared) >= enough(len(claims)):
                found.append(Hypothesis(factor, conjugate, len(claims), min(shared), len(shared)))
    return found


def _may_mean_a_mode(continuation: Continuation, claim: complex) -> bool:
    """Whether Newton's step from the claim, about the distance of the nearest zero, is short; that takes one value of D, a verdict many."""
    return bool(abs(newton_step(continuation, claim)) <= NEIGHBOURS * 10.0**-AGREE * abs(claim))


def newton_step(continuation: Continuation, claim: complex) -> complex:
    """Newton's step from the claim along the path that the branch of D there takes; infinite where there is none."""
    try:
        step = complex(continuation.along(claim)[0].with_derivative(claim).newton_step)
    except ShootstabError:
        return complex(math.inf)
    return step if cmath.isfinite(step) else complex(math.inf)


def agreed(problem: Problem, digits: int, claims: Sequence[complex]) -> list[float]:
    """The digits that claims share with their modes; an empty list as soon as too many are no modes."""
    shared: list[float] = []
    for done, claim in enumerate(claims, 1):
        (verdict,) = verify(problem, [claim], digits, missing="none").verdicts
        if verdict.verdict in (CONFIRMED, INACCURATE) and (verdict.digits_agreed or 0.0) >= AGREE:
            shared.append(verdict.digits_agreed or 0.0)
        elif done - len(shared) > len(claims) - enough(len(claims)):
            return []
    return shared


def _factors(reference_modes: ComplexArray, claims: Sequence[complex], conjugate: bool) -> list[complex]:
    """The factor that takes a claim to a mode and the most others to modes as well, to AGREE digits; of several the nearest to 1."""
    modes = reference_modes[reference_modes != 0.0]
    own = np.array([c.conjugate() if conjugate else c for c in claims[:HELD_AGAINST_REFERENCE]])
    candidates = (modes[:, None] / own[None, : LEAST * MAY_FAIL]).ravel()
    hits = [(_hits(factor * own, modes), complex(factor)) for factor in candidates]
    most = max((n for n, _ in hits), default=0)
    return sorted((f for n, f in hits if n == most >= LEAST), key=lambda f: abs(np.log(f)))[:1]


def _hits(meant: ComplexArray, modes: ComplexArray) -> int:
    """How many modes the claims (m,) mean, to AGREE digits."""
    off = np.abs(meant[:, None] - modes[None, :])
    close = off.min(axis=1) <= 10.0**-AGREE * np.abs(meant)
    return len(set(off[close].argmin(axis=1).tolist()))
