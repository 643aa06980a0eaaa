"""Across the neutral curve: the modes of growing points, followed one step of the grid to the neighbours at which nothing grows.

Between a growth rate above zero and one below it the neutral curve is interpolated, to the square of the spacing; from the growing side
alone it would be extrapolated. D is taken along the path that holds its branch next to the continuous spectrum. A step is made in two
halves at least, and the second one must end where the first one leads, so that no other mode is taken for the one that is followed.
What is found is drawn and told; no count and no dominance rests on it.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace

from shootstab.analyses.sweep.following import ARRIVED, FollowedMode, follow
from shootstab.analyses.sweep.grid import GridLine, Point, SweepGrid
from shootstab.analyses.sweep.outcomes import NONE_GROWS, Outcome
from shootstab.analyses.sweep.walk import MESH, WalkSettings
from shootstab.core.discriminant import Discriminant
from shootstab.core.errors import ConvergenceError
from shootstab.core.records import UNRESOLVED
from shootstab.discriminants.continuation import Continuation
from shootstab.discriminants.frame import Frame
from shootstab.problems.capabilities import Family

STEP_HALVINGS = 4  # chosen: halvings of a half step that is not safe


@dataclass(frozen=True)
class NeutralStep:
    """A point at which nothing grows, and from each growing neighbour the line to it with the mode that dominates there."""

    point: Point
    begins: tuple[tuple[GridLine, complex], ...]


def neutral_steps(grid: SweepGrid, outcomes: Mapping[Point, Outcome]) -> Iterator[NeutralStep]:
    """The steps from growing points to neighbours along the axes at which nothing grows."""
    places = [{value: i for i, value in enumerate(axis.values)} for axis in grid.axes]
    for point, outcome in outcomes.items():
        if outcome.status != NONE_GROWS:
            continue
        begins = []
        for k, axis in enumerate(grid.axes):
            here = places[k][point[k]]
            for other in (here - 1, here + 1):
                if 0 <= other < len(axis.values):
                    neighbour = (*point[:k], axis.values[other], *point[k + 1 :])
                    sigma = outcomes[neighbour].sigma
                    if sigma is not None:
                        begins.append((GridLine(axis.name, grid.names, (neighbour, point)), sigma))
        if begins:
            yield NeutralStep(point, tuple(begins))


def stepped(family: Family, settings: WalkSettings, step: NeutralStep) -> complex | None:
    """The fastest of the modes followed to the point; None where none arrives."""
    found = [_followed(family, settings, line, sigma) for line, sigma in step.begins]
    return max((s for s in found if s is not None), key=lambda s: (s.real, s.imag), default=None)


def _followed(family: Family, settings: WalkSettings, line: GridLine, sigma: complex) -> complex | None:
    method = Frame(rtol=min(MESH, 10.0**-settings.digits))
    followed = FollowedMode([0.0], [sigma])

    def at(place: float) -> Discriminant:
        values = line.values(place)
        absent = family.absent(values)
        if absent is not None:
            raise ConvergenceError(absent)
        return Continuation(family.problem(values), method).along(followed.predicted(place))[0]

    arrived = all(follow(followed, place, at, STEP_HALVINGS, least=-math.inf) == ARRIVED for place in (0.5, 1.0))
    return followed.last if arrived else None


def with_below(outcomes: Mapping[Point, Outcome], below: Mapping[Point, complex | None], settings: WalkSettings) -> dict[Point, Outcome]:
    """The outcomes with what was followed to them. Where that grows after all, a point without a count of its own is unresolved."""
    floor = max([settings.floor, *(o.floor for o in outcomes.values() if o.status == NONE_GROWS and o.floor is not None)])
    told = dict(outcomes)
    for point, sigma in below.items():
        if sigma is None or point not in told:
            continue
        outcome = replace(told[point], below=sigma)
        if sigma.real > (floor if outcome.floor is None else outcome.floor):
            why = f"{UNRESOLVED}: the mode {sigma:.6g} of a neighbouring point grows here, where the counts told of none"
            outcome = replace(outcome, status=why, proved=False)
        told[point] = outcome
    return told
