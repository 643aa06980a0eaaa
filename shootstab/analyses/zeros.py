"""The modes in a disc, near the continuous spectrum too: zeros of D, each counted on its own side."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from shootstab.core.discriminant import Discriminant
from shootstab.core.errors import ConvergenceError
from shootstab.core.regions import Disc
from shootstab.discriminants.continuation import Branch, Continuation
from shootstab.roots.iterations import newton
from shootstab.roots.search import Search, Zero, find
from shootstab.roots.winding import Winding, wind

AGREEMENT = 0.3  # of D on a mesh and D on the halved one, on the boundary of a disc: by Rouché's theorem 1 would do
PROBES = 4
POLISHED = 1e-10  # relative length of the last Newton step
STEPS = 20  # of Newton: linear convergence to a double zero takes most of them


class Inaccurate(ConvergenceError):  # noqa: N818 - it is a finding, not a fault
    """D on its mesh is not accurate enough for a count in so small a disc."""


class Crowded(ConvergenceError):  # noqa: N818 - it is a finding, not a fault
    """More zeros lie in the disc than were to be told apart."""

    def __init__(self, count: int, radius: float) -> None:
        super().__init__(f"{count} zeros lie within {radius:.1e}")
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
        require_accurate(branch, winding)
        if winding.count == 0:
            continue
        for zero in find(_on(branch), disc, counted=winding):
            (modes if continuation.own_side(branch, zero.sigma) else resonances).append(zero)
    return Zeros(tuple(modes), tuple(resonances), " and ".join(c.path for c in branches))


def _on(branch: Branch) -> Search:
    """A search for the zeros of one branch."""
    return Search(lambda region: wind(branch.discriminant, region), lambda disc: accurate_count(branch, disc), polish(branch.discriminant))


def polish(discriminant: Discriminant) -> Callable[[complex], complex | None]:
    """Newton's iteration, to a zero or to None."""

    def arrive(start: complex) -> complex | None:
        root = newton(discriminant, start, POLISHED, STEPS)
        return root.sigma if root.converged else None

    return arrive


def accurate_count(branch: Branch, disc: Disc) -> Winding:
    """The count of a disc. Raises Inaccurate where D is not accurate enough for it."""
    winding = wind(branch.discriminant, disc)
    require_accurate(branch, winding)
    return winding


def require_accurate(branch: Branch, winding: Winding) -> None:
    """Raise Inaccurate unless D on the halved mesh is the same, but for a constant factor, to what the count needs.

    Both are analytic; where |D_fine/(c D) − 1| < 1 all along the boundary, Rouché's theorem says that they have as many zeros inside.
    It is looked at some of the samples; c is taken from the first.
    """
    fine = branch.discriminant.refined()
    # a circle that needed few samples is one on which D changes little
    probes = min(PROBES, len(winding.samples) // 2)
    ratios = [fine(v.sigma).over(v.D) for v in winding.samples[:: len(winding.samples) // probes]]
    off = max(abs(ratio / ratios[0] - 1) for ratio in ratios)
    if not off < AGREEMENT:
        raise Inaccurate(f"D is not accurate enough to count in so small a circle: halving the steps changes it by {off:.1e} of itself")
