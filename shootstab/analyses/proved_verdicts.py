"""Verdicts as theorems: that a claim is confirmed, or that no eigenvalue lies near it, proved in ball arithmetic.

A confirmed claim is proved where exactly as many eigenvalues as the verdict says lie in the circle that its digits mean; a spurious one
where none lies in it, or, where the circle is not enclosed, in the disc that one value of D gives. The verdicts stand: what is not proved
says why, and a proof that finds another number says so.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

from shootstab.analyses.enclosables import factors
from shootstab.analyses.one_value_proof import clear_of_zeros
from shootstab.analyses.proof import Proof, at_most
from shootstab.analyses.prove import prove_disc
from shootstab.analyses.verdicts import radius_of
from shootstab.core.errors import ConvergenceError, InputError
from shootstab.core.progress import Progress
from shootstab.core.records import CONFIRMED, SPURIOUS, Report, Verdict
from shootstab.problems.protocol import Problem


@dataclass(frozen=True)
class ProvedVerdict:
    """proved says the theorem in words, None where there is none; why not is then said in reason.

    contradicts: the theorem is not what the verdict says. within is the radius of the disc about the claim for which it holds. Else the
    verdict has become `upgraded`. premise, which the words begin with, says of what base flows it is proved; short are the words without.
    """

    proved: str | None = None
    reason: str | None = None
    contradicts: bool = False
    within: float | None = None
    upgraded: str | None = None
    premise: str = ""
    short: str | None = None


def proved_verdicts(problem: Problem, report: Report, progress: Progress | None = None) -> tuple[ProvedVerdict, ...]:
    """A proof of each verdict of a report, or why there is none; the problem has an enclosure, as analyses.prove.factors finds."""
    found = []
    for verdict in report.verdicts:
        found.append(_proved(problem, verdict, report.digits))
        if progress is not None:
            progress(len(found), len(report.verdicts))
    return tuple(found)


def _proved(problem: Problem, verdict: Verdict, digits: int) -> ProvedVerdict:
    if verdict.verdict not in (CONFIRMED, SPURIOUS):
        return ProvedVerdict(reason=f"only what is {CONFIRMED} or {SPURIOUS} can be proved")
    try:
        proof = _theorem(problem, verdict, max(radius_of(verdict.claimed, digits), verdict.atol))
    except (ConvergenceError, InputError) as error:
        return ProvedVerdict(reason=str(error))
    within = float(proof.region["radius"]) if proof.alone is None else proof.alone
    if verdict.verdict == SPURIOUS and proof.count == 0:
        near = f"within {at_most(within, 3)}"
        short = f"no eigenvalue lies {near} of it"
        return ProvedVerdict(
            f"{proof.premise} {short}".lstrip(), within=within, upgraded=f"proved: none {near}", premise=proof.premise, short=short
        )
    contradicts = proof.count != (verdict.multiplicity if verdict.verdict == CONFIRMED else 0)
    short = replace(proof, premise="").statement
    upgraded = None if contradicts else "proved"
    return ProvedVerdict(proof.statement, contradicts=contradicts, within=within, upgraded=upgraded, premise=proof.premise, short=short)


def _theorem(problem: Problem, verdict: Verdict, radius: float) -> Proof:
    """What is proved of the circle of a claim's digits; of a spurious one's, where that is nothing, what its value of D says."""
    if verdict.verdict != SPURIOUS:
        return prove_disc(problem, verdict.claimed, radius)
    try:
        return prove_disc(problem, verdict.claimed, radius, alone=True)
    except ConvergenceError as error:
        centre = repr(verdict.claimed.real), repr(verdict.claimed.imag)
        try:
            return clear_of_zeros(factors(problem), centre)
        except ConvergenceError:
            raise error from None
