"""Tails of a solution by Schauder's theorem (theory, lemma C1), and how far a step goes for which they hold."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import Any

from shootstab.core.balls import acb, arb
from shootstab.multiprecision.tailed_series import NO_TAIL, TailedSeries

TAIL_ATTEMPTS, TAIL_ROOM = 12, 1.5  # chosen: guesses of the tails, and by what each exceeds what the inequality asked for
SHORTER = 0.75  # chosen: the factor from one attempt at a step, or at a start of the far field, to the next where nothing is known
# chosen: the contraction that is aimed at, in units of what is allowed, and by what a step, or a start, changes at most
AIM, MOST_CHANGE = 0.85, 4.0

SolutionSeries = tuple[TailedSeries, ...]  # the functions that solve a system


def tailed(
    terms: Sequence[Sequence[Any]], scale: Any, needed: Callable[[SolutionSeries], Sequence[Any]], real: bool = True
) -> SolutionSeries | None:
    """The series of these terms times scale^m with tails r for which needed(r) ≤ r; None where none of the guesses will do."""
    N = len(terms[0])
    powers = [arb(1)]
    for _ in range(N - 1):
        powers.append(powers[-1] * scale)
    coefficients = [[acb(c * p) for c, p in zip(y, powers, strict=True)] for y in terms]
    tails = [(2 * sum((abs(x) for x in c[-2:]), NO_TAIL)).upper() for c in coefficients]
    for _ in range(TAIL_ATTEMPTS):
        fields = tuple(TailedSeries(c, N, r, real) for c, r in zip(coefficients, tails, strict=True))
        asked = needed(fields)
        if not all(a.is_finite() for a in asked):
            return None
        if all(a <= r for a, r in zip(asked, tails, strict=True)):
            return fields
        tails = [r if a <= r else (TAIL_ROOM * a).upper() for a, r in zip(asked, tails, strict=True)]
    return None


def change(reached: float) -> float:
    """The factor to a shorter step, or a smaller start, from the contraction of one that is not admitted."""
    return min(SHORTER, max(AIM / reached, 1 / MOST_CHANGE)) if reached < math.inf else 0.5


def following(reached: float) -> float:
    """The factor to the next step from the contraction of one that is admitted."""
    return min(MOST_CHANGE, AIM / max(reached, AIM / MOST_CHANGE))
