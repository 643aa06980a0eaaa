"""Verdicts as theorems: that a claim is confirmed, or that no eigenvalue lies near it, proved in ball arithmetic.

A confirmed claim is proved where exactly as many eigenvalues as the verdict says lie in the circle that its digits mean; a spurious one
where none lies in it. The verdicts stand: what is not proved says why, and a proof that finds another number says so.
"""

from __future__ import annotations

from dataclasses import dataclass

from shootstab.analyses.proof import at_most
from shootstab.analyses.prove import prove_disc
from shootstab.analyses.verdicts import radius_of
from shootstab.core.errors import ConvergenceError, InputError
from shootstab.core.records import CONFIRMED, SPURIOUS, Report, Verdict
from shootstab.problems.protocol import Problem


@dataclass(frozen=True)
class ProvedVerdict:
    """proved says the theorem in words, None where there is none; why not is then said in reason.

    contradicts: the theorem is not what the verdict says. within is the radius of the disc about the claim for which it holds.
    """

    proved: str | None = None
    reason: str | None = None
    contradicts: bool = False
    within: float | None = None


def proved_verdicts(problem: Problem, report: Report) -> tuple[ProvedVerdict, ...]:
    """A proof of each verdict of a report, or why there is none; the problem has an enclosure, as analyses.prove.factors finds."""
    return tuple(_proved(problem, verdict, report.digits) for verdict in report.verdicts)


def _proved(problem: Problem, verdict: Verdict, digits: int) -> ProvedVerdict:
    if verdict.verdict not in (CONFIRMED, SPURIOUS):
        return ProvedVerdict(reason=f"only what is {CONFIRMED} or {SPURIOUS} can be proved")
    claim = verdict.claimed
    try:
        proof = prove_disc(problem, claim, max(radius_of(claim, digits), verdict.atol), alone=verdict.verdict == SPURIOUS)
    except (ConvergenceError, InputError) as error:
        return ProvedVerdict(reason=str(error))
    within = float(proof.region["radius"]) if proof.alone is None else proof.alone
    if verdict.verdict == SPURIOUS and proof.count == 0:
        return ProvedVerdict(f"{proof.premise} no eigenvalue lies within {at_most(within, 3)} of it".lstrip(), within=within)
    expected = verdict.multiplicity if verdict.verdict == CONFIRMED else 0
    return ProvedVerdict(proof.statement, contradicts=proof.count != expected, within=within)
