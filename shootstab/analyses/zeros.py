"""The modes in a disc, near the continuous spectrum too: zeros of D, each counted on its own side."""

from __future__ import annotations

from dataclasses import dataclass

from shootstab.analyses.accuracy import otherwise, require_accurate
from shootstab.analyses.error_budget import SAFETY
from shootstab.core.errors import ConvergenceError
from shootstab.core.numerus import number_of
from shootstab.core.regions import Disc
from shootstab.discriminants.continuation import Branch, Continuation
from shootstab.problems.protocol import Problem
from shootstab.roots.search import Search, Zero, find, polish, together
from shootstab.roots.winding import Limited, Winding, wind

MOST_TO_SEPARATE = 1000  # chosen: evaluations to tell a few zeros in a disc apart, some ten circles' worth; more are spent in noise only


MOST_MOVED = 0.5  # derived: the zero of a linear D moves by 2·TOLERATED_CHANGE of the radius, and so by less
SEEDS = (1, 2)  # chosen: draws of the errors of D, so that none is small by accident


class Crowded(ConvergenceError):  # noqa: N818 - it is a finding, not a fault
    """More zeros lie in the disc than were to be told apart."""

    def __init__(self, count: int, radius: float) -> None:
        super().__init__(f"{number_of(count, 'zero lies', 'zeros lie')} within {radius:.1e}")
        self.count = count


@dataclass(frozen=True)
class Zeros:
    """modes and resonances in a disc; path tells along which path D was computed."""

    modes: tuple[Zero, ...]
    resonances: tuple[Zero, ...]
    path: str


def zeros_in(continuation: Continuation, disc: Disc, most: int | None = None) -> Zeros:
    """All zeros in a disc, by counting; where the continuous spectrum crosses it, on each side of it those of the continuation from there.

    Raises ConvergenceError (Undecidable among them) when that cannot be decided, and Crowded when one branch has more zeros than most.
    """
    modes: list[Zero] = []
    resonances: list[Zero] = []
    branches = continuation.branches(disc.centre, disc.radius)
    for branch in branches:
        winding = wind(branch.discriminant, disc)
        if most is not None and winding.count > most:
            raise Crowded(winding.count, disc.radius)
        require_accurate(continuation.problem, [(branch.discriminant, value) for value in winding.samples])
        if winding.count == 0:
            continue
        for zero in _told_apart(continuation.problem, branch, disc, winding):
            own = continuation.own_side(branch, zero.sigma, _error(continuation, branch, zero, disc.radius))
            (modes if own else resonances).append(zero)
    return Zeros(tuple(modes), tuple(resonances), " and ".join(c.path for c in branches))


def _error(continuation: Continuation, branch: Branch, zero: Zero, radius: float) -> float:
    """The error of a zero in a disc so far as it may put the zero on another side of the continuous spectrum, and 0 where it cannot.

    Where D is accurate to TOLERATED_CHANGE of itself on the circle, and about linear in it, its zero moves by less than half of the radius.
    Nearer to the spectrum than that it is asked how far D with all errors drawn anew has its zero.
    """
    if zero.radius > 0.0 or branch.side == 0 or continuation.distance(zero.sigma) > MOST_MOVED * radius:
        return zero.radius
    steps = [
        otherwise(continuation.problem, branch.discriminant, zero.sigma, seed).with_derivative(zero.sigma).newton_step for seed in SEEDS
    ]
    return SAFETY * max(map(abs, steps))


def _told_apart(problem: Problem, branch: Branch, disc: Disc, counted: Winding) -> list[Zero]:
    """The zeros counted in a disc; where D is noise around them and does not tell them apart, one multiple zero."""
    D = branch.discriminant
    limited = Limited(D, D.evaluations + MOST_TO_SEPARATE)
    search = Search(lambda region: wind(limited, region), lambda part: accurate_count(problem, branch, part), polish(limited))
    try:
        return find(search, disc, counted=counted)
    except ConvergenceError:
        if counted.count == 1:
            raise
        return [together(counted, counted.count, disc)]


def search_on(problem: Problem, branch: Branch) -> Search:
    """A search for the zeros of one branch."""
    D = branch.discriminant
    return Search(lambda region: wind(D, region), lambda disc: accurate_count(problem, branch, disc), polish(D))


def accurate_count(problem: Problem, branch: Branch, disc: Disc) -> Winding:
    """The count of a disc. Raises Inaccurate where D is not accurate enough for it."""
    winding = wind(branch.discriminant, disc)
    require_accurate(problem, [(branch.discriminant, value) for value in winding.samples])
    return winding
