"""The modes in a disc, near the continuous spectrum too: zeros of D, each counted on its own side."""

from __future__ import annotations

from dataclasses import dataclass

from shootstab.analyses.accuracy import require_accurate
from shootstab.core.errors import ConvergenceError
from shootstab.core.numerus import number_of
from shootstab.core.regions import Disc
from shootstab.discriminants.continuation import Branch, Continuation
from shootstab.problems.protocol import Problem
from shootstab.roots.search import Search, Zero, find, moments, polish
from shootstab.roots.winding import Limited, Winding, wind

MOST_TO_SEPARATE = 1000  # chosen: evaluations to tell a few zeros in a disc apart, some ten circles' worth; more are spent in noise only


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
            (modes if continuation.own_side(branch, zero.sigma) else resonances).append(zero)
    return Zeros(tuple(modes), tuple(resonances), " and ".join(c.path for c in branches))


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
        return [Zero(moments(counted)[0], counted.count, disc.radius)]


def search_on(problem: Problem, branch: Branch) -> Search:
    """A search for the zeros of one branch."""
    D = branch.discriminant
    return Search(lambda region: wind(D, region), lambda disc: accurate_count(problem, branch, disc), polish(D))


def accurate_count(problem: Problem, branch: Branch, disc: Disc) -> Winding:
    """The count of a disc. Raises Inaccurate where D is not accurate enough for it."""
    winding = wind(branch.discriminant, disc)
    require_accurate(problem, [(branch.discriminant, value) for value in winding.samples])
    return winding
