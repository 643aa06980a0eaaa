"""Meshes that the points of one contour share, or neighbouring problems along a line.

A mesh of few steps serves σ of very different size, and a value on it costs less than to look for another one. What is kept belongs to one
contour, or to one line, whose points come in one order: which mesh serves a σ follows from that.
"""

from __future__ import annotations

import itertools
from collections import deque
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass, field

from shootstab.core.discriminant import Value
from shootstab.core.errors import ConvergenceError
from shootstab.core.scaled import Scaled
from shootstab.discriminants.method import AdaptiveDiscriminant, MeshedDiscriminant, Meshes, Method
from shootstab.discriminants.subsystems import Coupled
from shootstab.problems.protocol import Problem

MOST_LENT = 4000  # chosen: steps of all meshes that are kept for a neighbour, a hundred megabytes of tables at most
LENT_TRIED = 1  # chosen: meshes of a neighbour that are tried: the one that served what is nearest to σ there
MESHES_TRIED = 3  # chosen: meshes that are tried before another one is made
ASKED_LAST = 32  # chosen: the latest σ that were asked of a mesh, by which it is judged
OF_SIZE = 3.0  # chosen: weight of a difference in |σ|: of 0 to 50 counts of stable chutes need the fewest values of D with it
SHORT_MESH = 32  # chosen: steps up to which a mesh may serve any σ: a value on them costs less than a mesh
SHARED_WITHIN = 8.0  # chosen: the ratio of |σ| over which a longer mesh is shared; steps go with |σ|^(1/2) where there are many


@dataclass
class LentMesh:
    """D on a mesh that was made for a σ of this size, and the latest σ that it served, or did not."""

    made: MeshedDiscriminant
    size: float
    asked: deque[tuple[complex, bool]] = field(default_factory=lambda: deque(maxlen=ASKED_LAST))

    def serves(self, sigma: complex) -> bool:
        """Whether it serves σ, remembered."""
        self.asked.append((sigma, _serves(self.made, sigma)))
        return self.asked[-1][1]

    def nearest(self, sigma: complex) -> tuple[float, bool]:
        """How far σ is from the nearest of those that were asked, and whether it refused that one.

        What steps a mesh needs depends on |σ| more than on the direction of σ: (OF_SIZE ||σ| − |s|| + |σ − s|)/(|σ| + |s|).
        """
        size = abs(sigma)
        return min(((OF_SIZE * abs(size - abs(s)) + abs(sigma - s)) / ((size + abs(s)) or 1.0), not served) for s, served in self.asked)


class SharedMeshes:
    """Meshes of a discriminant, or of several; tried are those that served what was nearest to σ of all that they were asked.

    Meshes of at most `short` steps may serve any σ, longer ones those of a |σ| up to `within` times larger or smaller. lent are meshes of a
    neighbour's D, of the same method and path, on which D of `to` is tried before a mesh is made.
    """

    def __init__(
        self,
        short: int = SHORT_MESH,
        within: float = SHARED_WITHIN,
        lent: Sequence[LentMesh] = (),
        to: AdaptiveDiscriminant | None = None,
    ) -> None:
        self._short, self._within = short, within
        self._kept: dict[AdaptiveDiscriminant, list[LentMesh]] = {}
        self._lent, self._to = list(lent), to

    def at(self, discriminant: AdaptiveDiscriminant, sigma: complex) -> MeshedDiscriminant:
        """D on a mesh that serves σ, if it can be one that served a point before. Raises ConvergenceError where none is found."""
        kept = self._kept.setdefault(discriminant, [])
        for known in self._likely(kept, sigma)[:MESHES_TRIED]:
            if known.serves(sigma):
                return known.made
        for known in self._likely(self._lent, sigma)[:LENT_TRIED] if discriminant is self._to else ():
            self._lent.remove(known)
            with suppress(Coupled):  # the neighbour falls into subsystems, and this problem does not
                kept.append(LentMesh(known.made.on_same_mesh(discriminant.problem), known.size))
                if kept[-1].serves(sigma):
                    return kept[-1].made
        own = LentMesh(discriminant.at(sigma), abs(sigma))
        own.asked.append((sigma, True))
        kept.append(own)
        return own.made

    def of(self, discriminant: AdaptiveDiscriminant) -> list[LentMesh]:
        """The latest meshes of this discriminant, of so many steps in all that a neighbour may be lent them."""
        kept = self._kept.get(discriminant, [])[::-1]
        steps = itertools.accumulate(known.made.steps for known in kept)
        return [known for known, sum_of_steps in zip(kept, steps, strict=True) if sum_of_steps <= MOST_LENT]

    def _likely(self, meshes: Sequence[LentMesh], sigma: complex) -> list[LentMesh]:
        """Those that may serve σ, and did not refuse what was nearest to it, the nearest first."""
        size = abs(sigma)
        near = [m for m in meshes if m.made.steps <= self._short or size <= self._within * m.size <= self._within**2 * size]
        ranked = sorted((*m.nearest(sigma), i) for i, m in enumerate(near))
        return [near[i] for _, refused, i in ranked if not refused]


class NeighbouringD:
    """D(σ) of a problem, on a mesh of its neighbour's that serves σ here too, and on one of its own otherwise."""

    def __init__(self, problem: Problem, method: Method, before: NeighbouringD | None) -> None:
        self._problem, self._method = problem, method
        self._lent = [] if before is None else before.meshes_used
        self._begin: Meshes | None = None if before is None else before.begun
        self._own: AdaptiveDiscriminant | None = None
        self._used: list[MeshedDiscriminant] = []
        self._borrowed: list[MeshedDiscriminant] = []

    def at(self, sigma: complex) -> MeshedDiscriminant:
        """D on a mesh that serves σ. Raises ConvergenceError where none is found."""
        for made in reversed(self._used):
            if _serves(made, sigma):
                return made
        while self._lent:
            with suppress(Coupled):  # the neighbour falls into subsystems, and this problem does not
                made = self._lent.pop().on_same_mesh(self._problem)
                self._borrowed.append(made)
                if _serves(made, sigma):
                    self._used.append(made)
                    return made
        if self._own is None:
            self._own = self._method.on(self._problem, begin=self._begin)
        self._used.append(self._own.at(sigma))
        return self._used[-1]

    def __call__(self, sigma: complex) -> Scaled:
        return self.at(sigma)(sigma)

    def with_derivative(self, sigma: complex) -> Value:
        return self.at(sigma).with_derivative(sigma)

    @property
    def evaluations(self) -> int:
        """How often D was computed."""
        return sum(made.evaluations for made in self._borrowed) + (0 if self._own is None else self._own.evaluations)

    @property
    def meshes_used(self) -> list[MeshedDiscriminant]:
        """D on the meshes that served here, those that served last at the end; before the first value those of the neighbour."""
        return list(self._used or self._lent)

    @property
    def begun(self) -> Meshes | None:
        """The nodes (N + 1,) of cells with which a neighbour may begin."""
        return self._begin if self._own is None else self._own.meshes


def _serves(made: MeshedDiscriminant, sigma: complex) -> bool:
    """Whether a mesh serves σ; one whose far end knows no frame for σ does not."""
    try:
        return made.serves(sigma)
    except ConvergenceError:
        return False
