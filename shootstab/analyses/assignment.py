"""The mode that each claim means: as many claims as a mode is multiple, and of all ways to assign them the best as a whole.

A mode inside the circle that the digits of a claim mean is worth more than any number of looser matches; of equals the digits that agree
are summed, and the largest sum is taken (an assignment problem, solved by scipy.optimize.linear_sum_assignment). The nearest claim first
would leave a second claim without a mode where both could have one.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from shootstab.core.records import digits_between

INSIDE_WORTH = 1e3  # chosen: worth of a match inside the circle, above the 99 digits that any number of claims up to ten could sum to
NEARER = 0.1  # chosen: the most that nearness decides where digits do not, next to 0


@dataclass(frozen=True)
class Candidate:
    """A mode that a claim may mean: by its number, how often it may be given, and how far it is off, known to error.

    size is |σ| of the mode; radius is that of the circle that the claim's digits mean.
    """

    mode: int
    multiplicity: int
    off: float
    error: float
    size: float
    radius: float

    @property
    def worth(self) -> float:
        """What the match counts for; above 0."""
        inside = INSIDE_WORTH if self.off <= self.radius + self.error else 0.0
        return 1.0 + inside + digits_between(max(self.off, self.error), self.size) + NEARER / (1.0 + self.off / self.radius)


def assign(candidates: Sequence[Sequence[Candidate]]) -> list[int | None]:
    """The number of the mode given to each claim, or None; the problem falls apart where no candidates are shared.

    Where every claim can have the one that is worth most to it, no sum is larger.
    """
    dearest = [max(some, key=lambda c: c.worth) if some else None for some in candidates]
    wanted = Counter(c.mode for c in dearest if c is not None)
    if all(wanted[c.mode] <= c.multiplicity for c in dearest if c is not None):
        return [None if c is None else c.mode for c in dearest]
    from scipy.optimize import linear_sum_assignment  # only here: its import takes longer than most lists

    given: list[int | None] = [None] * len(candidates)
    for claims in shared(candidates):
        offered = {c.mode: c.multiplicity for i in claims for c in candidates[i]}
        copies = [mode for mode, multiplicity in offered.items() for _ in range(multiplicity)]
        if not copies:
            continue
        worth = np.zeros((len(claims), len(copies)))
        for row, i in enumerate(claims):
            by_mode = {c.mode: c.worth for c in candidates[i]}
            worth[row] = [by_mode.get(mode, 0.0) for mode in copies]
        for row, column in zip(*linear_sum_assignment(worth, maximize=True), strict=True):
            if worth[row, column] > 0.0:
                given[claims[row]] = copies[column]
    return given


def shared(candidates: Sequence[Sequence[Candidate]]) -> list[list[int]]:
    """The claims in groups of those that are tied by candidates."""
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    pairs = [(i, c.mode) for i, some in enumerate(candidates) for c in some]
    n = len(candidates)
    size = n + 1 + max((mode for _, mode in pairs), default=0)
    row, column = [i for i, _ in pairs], [n + mode for _, mode in pairs]
    graph = coo_array((np.ones(len(pairs)), (row, column)), shape=(size, size))
    labels = connected_components(graph, directed=False)[1][:n]
    groups: dict[int, list[int]] = {}
    for i, label in enumerate(labels.tolist()):
        groups.setdefault(label, []).append(i)
    return list(groups.values())
