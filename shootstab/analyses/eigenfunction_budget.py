"""The error bound of an eigenfunction, its parts measured as those of the mode are: what changes when one thing is done otherwise?

Every variant has an eigenfunction of its own, at its own zero, scaled to have the same value at one place. The change of an unknown is
measured against its own largest value; one below `step_control.FLOOR` of the largest of all counts as so large, as local errors do.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from shootstab.analyses.error_budget import FAR_PROBE, FLOW_NOISE, FLOWS, HALVING, NEGLIGIBLE_SHARE, NOISE, SAFETY
from shootstab.analyses.on_the_line import OnTheLine, in_unknowns
from shootstab.core.records import Budget, Mode
from shootstab.core.scaled import EPSILON
from shootstab.discriminants.back_substitution import Solution, solution
from shootstab.discriminants.shooting import Shooting
from shootstab.discriminants.subsystems import Subsystem
from shootstab.kernels.step_control import FLOOR
from shootstab.problems.capabilities import FARTHER_WALLS
from shootstab.problems.protocol import ComplexArray, Problem
from shootstab.problems.unknowns import Unknowns


@dataclass(frozen=True, eq=False)
class Variants:
    """The eigenfunction of `mode` on a mesh, on the halved one, and under everything that may be done otherwise."""

    problem: Problem
    coarse: Shooting
    fine: Shooting
    named: Unknowns
    mode: Mode

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
        step = abs(self.fine.with_derivative(self._fine.sigma).newton_step)
        root = SAFETY * step / self.mode.scale if self.mode.scale > 0.0 else 0.0
        return Budget(integration, far, flow, root, self._rounding(integration))

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
            other = solution(self.coarse.refined(seed=1), self._sigma)
            seen.append(self._change(self._fine, other, every=2, each=2))
        return NOISE * math.sqrt(sum(x * x for x in seen) / len(seen)) + 8 * EPSILON

    def _moved(self, variant: Shooting) -> float:
        """How far the eigenfunction of a variant on the coarse mesh is from that of the coarse mesh."""
        return self._change(self._coarse, solution(variant, self._sigma))

    def _change(self, one: Solution, two: Solution, every: int = 1, each: int = 1) -> float:
        """The largest change of an unknown at the nodes that both meshes have, every so many of one and each so many of two."""
        values = [self._values(solved, step) for solved, step in ((one, every), (two, each))]
        place = np.unravel_index(int(np.abs(values[0]).argmax()), values[0].shape)
        u, v = (value / value[place] for value in values)
        sizes = np.maximum(np.abs(u).max(axis=0), FLOOR)
        return float((np.abs(u - v).max(axis=0) / sizes).max())

    def _values(self, solved: Solution, every: int) -> ComplexArray:
        z, states = OnTheLine(self.problem, solved).at_nodes(every)
        return in_unknowns(self.named, solved.sigma, z, states)

    def _own(self, whole: Problem) -> Problem:
        """What the mode belongs to in another problem of the same structure."""
        own = self.coarse.problem
        return replace(own, whole=whole) if isinstance(own, Subsystem) else whole

    @property
    def _sigma(self) -> complex:
        return complex(self.mode.sigma)

    @cached_property
    def _coarse(self) -> Solution:
        return solution(self.coarse, self._sigma)

    @cached_property
    def _fine(self) -> Solution:
        return solution(self.fine, self._sigma)
