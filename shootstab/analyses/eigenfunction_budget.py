"""The error bound of an eigenfunction, its parts measured as those of the mode are: what changes when one thing is done otherwise?

Every variant has an eigenfunction of its own, at its own zero, scaled to have the same value at one place. The change of an unknown is
measured against its own largest value; one below `step_control.FLOOR` of the largest of all counts as so large, as local errors do.

Where the mode is multiple the zeros of a variant lie apart by a root of its error, and their mean stays: the basis of the kernel of every
variant is taken at the mean, with the same values at as many places as it has functions, and again as far from it as the zeros may lie.
Its changes are measured against the largest value of all unknowns: there one that is zero is as uncertain as the others.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
import scipy.linalg
from numpy.typing import NDArray

from shootstab.analyses.error_budget import FAR_PROBE, FLOW_NOISE, FLOWS, HALVING, NEGLIGIBLE_SHARE, NOISE, SAFETY
from shootstab.analyses.on_the_line import OnTheLine, in_unknowns
from shootstab.core.records import Budget, Mode
from shootstab.core.scaled import EPSILON
from shootstab.discriminants.back_substitution import BoundaryMatrix, Solution, solution
from shootstab.discriminants.shooting import Shooting
from shootstab.discriminants.subsystems import Subsystem
from shootstab.kernels.step_control import FLOOR
from shootstab.problems.capabilities import FARTHER_WALLS
from shootstab.problems.protocol import ComplexArray, Problem
from shootstab.problems.unknowns import Unknowns

GROWS = 1e-6  # chosen: a determinant that grows by less than this part of itself is the largest: places are changed finitely often


@dataclass(frozen=True, eq=False)
class Variants:
    """The eigenfunction of `mode` on a mesh, on the halved one, and under everything that may be done otherwise.

    kernel: of a multiple mode, the dimension of the kernel on these meshes, for whose basis the parts are; 0 for a simple mode.
    """

    problem: Problem
    coarse: Shooting
    fine: Shooting
    named: Unknowns
    mode: Mode
    kernel: int = 0

    def budget(self, progress: Callable[[int, int], None] | None = None) -> Budget:
        """The parts, each a bound on the change of an unknown over its largest value."""
        told = progress or (lambda done, total: None)
        integration = self._change(self._fine, self._coarse, every=2) / HALVING
        told(1, 4)
        far = SAFETY * self._moved(self.coarse.with_perturbed_start(1, FAR_PROBE)) / FAR_PROBE * self.coarse.far_error(self._sigma)
        farther = FARTHER_WALLS.of(self.problem)
        if farther is not None:
            far += self._moved(self.coarse.on_same_mesh(self._own(farther)))
        told(2, 4)
        flow = self._flow(integration)
        told(3, 4)
        return Budget(integration, far, flow, self._root(), self._rounding(integration))

    def _root(self) -> float:
        """The share of the root: the last step, or how far the zeros of a multiple mode may lie from their mean."""
        if self.kernel:
            error = float(self.mode.error)
            return max(self._change(self._fine, self._solved(self.fine, self._sigma + turn * error)) for turn in (1.0, 1j))
        step = abs(self.fine.with_derivative(self._fine[0].sigma).newton_step)
        return SAFETY * step / self.mode.scale if self.mode.scale > 0.0 else 0.0

    def _flow(self, integration: float) -> float:
        """The share of the base flow, seen on base flows that err about as much."""
        own, seen = self.coarse.problem, 0.0
        for factor in FLOWS:
            other = own.with_base_flow_error(factor)
            if other is not own:
                seen = max(seen, self._moved(self.coarse.on_same_mesh(other)))
            if FLOW_NOISE * seen < NEGLIGIBLE_SHARE * integration:
                break
        return FLOW_NOISE * seen

    def _rounding(self, integration: float) -> float:
        """The share of rounding, seen on other bases of the far frame and, without a flow whose roundings count, on other points."""
        seen = [self._moved(self.coarse.with_rotated_basis(seed)) for seed in (1, 2)]
        if NOISE * max(seen) > NEGLIGIBLE_SHARE * integration and self.problem.with_base_flow_error(FLOWS[0]) is self.problem:
            other = self._solved(self.coarse.refined(seed=1))
            seen.append(self._change(self._fine, other, every=2, each=2))
        return NOISE * math.sqrt(sum(x * x for x in seen) / len(seen)) + 8 * EPSILON

    def _moved(self, variant: Shooting) -> float:
        """How far the eigenfunctions of a variant on the coarse mesh are from those of the coarse mesh."""
        return self._change(self._coarse, self._solved(variant))

    def _change(self, one: Sequence[Solution], two: Sequence[Solution], every: int = 1, each: int = 1) -> float:
        """The largest change of an unknown at the nodes that both meshes have, every so many of one and each so many of two."""
        values = [self._values(solved, step) for solved, step in ((one, every), (two, each))]
        places = cardinal_places(values[0])
        u, v = (in_cardinal_basis(value, places) for value in values)
        sizes = np.abs(u).max(axis=(1, 2))[:, None] if self.kernel else np.maximum(np.abs(u).max(axis=1), FLOOR)
        return float((np.abs(u - v).max(axis=1) / sizes).max())

    def _values(self, solved: Sequence[Solution], every: int) -> ComplexArray:
        """The unknowns (g, m, q) of g solutions at every so many nodes."""
        lines = [OnTheLine(self.problem, one).at_nodes(every) for one in solved]
        return np.array([in_unknowns(self.named, one.sigma, z, states) for one, (z, states) in zip(solved, lines, strict=True)])

    def _solved(self, shooting: Shooting, sigma: complex | None = None) -> tuple[Solution, ...]:
        if not self.kernel:
            return (solution(shooting, self._sigma),)
        return BoundaryMatrix.of(shooting, self._sigma if sigma is None else sigma).solutions(self.kernel)

    def _own(self, whole: Problem) -> Problem:
        """What the mode belongs to in another problem of the same structure."""
        own = self.coarse.problem
        return replace(own, whole=whole) if isinstance(own, Subsystem) else whole

    @property
    def _sigma(self) -> complex:
        return complex(self.mode.sigma)

    @cached_property
    def _coarse(self) -> tuple[Solution, ...]:
        return self._solved(self.coarse)

    @cached_property
    def _fine(self) -> tuple[Solution, ...]:
        return self._solved(self.fine)


def cardinal_places(values: ComplexArray) -> NDArray[np.intp]:
    """g places of the values (g, …), as indices into those of one function, at which a basis may be 1 or 0 and is nowhere larger.

    Such places have the largest determinant of all: it grows as long as a function of the basis that belongs to them is larger than 1
    elsewhere, and that place takes the place of its own. One function has its largest value there.
    """
    flat = values.reshape(len(values), -1)
    places = scipy.linalg.qr(flat, mode="r", pivoting=True)[1][: len(flat)].copy()
    while True:
        sizes = np.abs(in_cardinal_basis(flat, places))
        function, place = np.unravel_index(int(sizes.argmax()), sizes.shape)
        if sizes[function, place] <= 1.0 + GROWS:
            return np.asarray(places)
        places[function] = place


def in_cardinal_basis(values: ComplexArray, places: NDArray[np.intp]) -> ComplexArray:
    """The values (g, …) in the basis that is 1 at one of the places each and 0 at the others."""
    flat = values.reshape(len(values), -1)
    return np.asarray(np.linalg.solve(flat[:, places], flat).reshape(values.shape))
