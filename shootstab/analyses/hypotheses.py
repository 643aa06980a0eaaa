"""A whole list that is off by one thing: before all claims are called spurious, the usual mistakes are tested against the modes.

A spectrum v may be meant as σ = f v or σ = f v̄, with f of a sign, of i (frequencies), of units of length and velocity, or of a
wavenumber (phase speeds). f = ±1, ±i are tried on the claims themselves; any other f is that of a claim and a mode of the
pseudospectral reference, where the problem has one. Or only the real parts of the spectrum were written. What is found is only proposed:
nothing is judged by it.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from shootstab.analyses import reference
from shootstab.analyses.verify import verify
from shootstab.core.records import CONFIRMED, INACCURATE, SPURIOUS, Report, digits_between
from shootstab.problems.protocol import Problem

TRIED = 4  # claims on which a hypothesis is tested: chosen, as each costs a verdict, and four do not agree by chance
LEAST = 2  # derived: one claim agrees with some mode under some factor
AGREE = 3.0  # chosen: digits of a claim that must agree with a mode under the hypothesis: a thousand times less than by chance
# factors between conventions of sign and of time, exp(σt) and exp(∓iωt), before any scale is looked for
UNITS = (1.0, -1.0, 1j, -1j)  # exact: the fourth roots of 1


@dataclass(frozen=True)
class Hypothesis:
    """σ = factor·v, of the conjugate of v if so: how many of the claims tried are then modes, and the fewest digits that agree."""

    factor: complex
    conjugate: bool
    tried: int
    digits: float
    real_parts: bool = False  # instead: the claims are the real parts of eigenvalues of the reference

    def applied(self, claim: complex) -> complex:
        """The claim as it may have been meant."""
        return self.factor * (claim.conjugate() if self.conjugate else claim)


def hypotheses(problem: Problem, report: Report, digits: int) -> tuple[Hypothesis, ...]:
    """Those that hold for every claim tried, if the report calls all claims spurious; nothing otherwise."""
    claims = [v.claimed for v in report.verdicts if v.claimed != 0.0]
    if len(claims) < LEAST or any(v.verdict != SPURIOUS for v in report.verdicts):
        return ()
    claims = sorted(claims, key=abs)[:TRIED]
    for factors in (lambda conjugate: UNITS, lambda conjugate: _factors(problem, claims, digits, conjugate)):
        found = [h for h in _holding(problem, digits, claims, factors) if h is not None]
        if found:
            return tuple(found)
    return _as_real_parts(problem, claims, digits)


def _as_real_parts(problem: Problem, claims: Sequence[complex], digits: int) -> tuple[Hypothesis, ...]:
    """Whether claims without imaginary parts are the real parts of eigenvalues of the reference that have one."""
    modes = reference.eigenvalues(problem, digits)
    modes = modes[modes.imag != 0.0]
    if not len(modes) or any(c.imag != 0.0 for c in claims):
        return ()
    own = np.array([c.real for c in claims])
    off = float((np.abs(modes.real - own[:, None]).min(axis=1) / np.abs(own)).max())
    return () if off > 10.0**-AGREE else (Hypothesis(1.0, False, len(claims), digits_between(off, 1.0), True),)


def _holding(problem: Problem, digits: int, claims: Sequence[complex], factors: Callable[[bool], Sequence[complex]]) -> list[Hypothesis]:
    """The hypotheses under which every claim is a mode; the first of those that map the claims to the same numbers."""
    found: list[Hypothesis] = []
    for conjugate in (False, True):
        for factor in factors(conjugate):
            wanted = Hypothesis(factor, conjugate, len(claims), 0.0)
            meant = [wanted.applied(c) for c in claims]
            if (factor == 1.0 and not conjugate) or any(np.allclose(meant, [h.applied(c) for c in claims]) for h in found):
                continue
            agreed = _agreed(problem, digits, meant)
            if agreed is not None:
                found.append(Hypothesis(factor, conjugate, len(claims), agreed))
    return found


def _agreed(problem: Problem, digits: int, claims: Sequence[complex]) -> float | None:
    """The fewest digits that a claim shares with its mode; None as soon as one is no mode."""
    fewest = 99.0
    for claim in claims:
        (verdict,) = verify(problem, [claim], digits, missing="none").verdicts
        if verdict.verdict not in (CONFIRMED, INACCURATE) or (verdict.digits_agreed or 0.0) < AGREE:
            return None
        fewest = min(fewest, verdict.digits_agreed or 0.0)
    return fewest


def _factors(problem: Problem, claims: Sequence[complex], digits: int, conjugate: bool) -> list[complex]:
    """The factor that takes the first claim to a mode and all others to modes as well, to AGREE digits; of several the nearest to 1."""
    modes = reference.eigenvalues(problem, digits)
    own = np.array([c.conjugate() if conjugate else c for c in claims])
    good = []
    for factor in modes[modes != 0.0] / own[0]:
        meant = factor * own
        nearest = np.abs(meant[:, None] - modes[None, :]).min(axis=1)
        if np.all(nearest <= 10.0**-AGREE * np.abs(meant)):
            good.append(complex(factor))
    return sorted(good, key=lambda f: abs(np.log(f)))[:1]
