"""D(σ) by orthonormalized shooting: the frame of the decaying space, carried to the wall."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from shootstab.discriminants.mesh import halved, redistribute
from shootstab.discriminants.protocol import Value
from shootstab.discriminants.table import Table, tabulate
from shootstab.kernels.transport import transport
from shootstab.problems.protocol import Problem
from shootstab.vocabulary.errors import ConvergenceError
from shootstab.vocabulary.scaled import Scaled

MOST_STEPS = 40_000


@dataclass(frozen=True)
class Frame:
    """Orthonormalized shooting with local errors below rtol, relative to each component of the frame."""

    rtol: float = 1e-11
    name: str = "frame"

    def on(self, problem: Problem) -> Shooting:
        """D(σ) of the problem; the mesh is made at the first σ asked for and grows where another σ needs it."""
        return Shooting(problem, self)


class Shooting:
    """D(σ) = det[(W0 + σW1) Y(0; σ)], Y the decaying space normalized in the far field.

    The mesh stays the same from one σ to the next as long as its local errors hold, and on a given mesh D is analytic to rounding.
    """

    def __init__(self, problem: Problem, method: Frame) -> None:
        self.problem, self.method = problem, method
        self.evaluations = 0
        self._table: Table | None = None
        self._rows = problem.wall_rows()

    def __call__(self, sigma: complex) -> Scaled:
        return self._evaluate(complex(sigma), False).D

    def with_slope(self, sigma: complex) -> Value:
        return self._evaluate(complex(sigma), True)

    def prepared(self, sigma: complex) -> Shooting:
        """Itself, with a mesh that holds at sigma."""
        self._evaluate(complex(sigma), False)
        return self

    def refined(self) -> Shooting:
        """The same on a mesh with every step halved, which it keeps: the difference is the error of this one."""
        finer = Shooting(self.problem, replace(self.method, rtol=np.inf))
        assert self._table is not None
        finer._table = tabulate(self.problem, halved(self._table.nodes))
        return finer

    def restarted(self, factor: float, sigma: complex) -> Shooting:
        """The same with the far-field start at a tolerance smaller by this factor, on an own mesh."""
        other = Shooting(self.problem, self.method)
        other._build(complex(sigma), self._far_tolerance * factor)
        return other

    @property
    def steps(self) -> int:
        """How many steps the mesh has."""
        return 0 if self._table is None else len(self._table.nodes) - 1

    @property
    def start(self) -> complex:
        """Where the far-field frame is taken."""
        assert self._table is not None
        return complex(self._table.nodes[0])

    @property
    def _far_tolerance(self) -> float:
        return min(1e-3 * self.method.rtol, 1e-14)

    def _build(self, sigma: complex, far_tolerance: float) -> None:
        """A mesh for σ: from the problem's own first mesh, redistributed until the local errors hold."""
        start = self.problem.start(sigma, far_tolerance)
        self._table = tabulate(self.problem, self.problem.mesh(start).astype(np.complex128))
        for turn in range(20):
            value, errors = self._shoot(sigma, False)
            if turn > 0 and (errors <= self.method.rtol).all():
                return
            self._regrid(errors, coarsen=turn < 2)
        raise ConvergenceError(f"no mesh found that holds local errors of {self.method.rtol:.1e} at sigma = {sigma:.6g}")

    def _regrid(self, errors: np.ndarray, coarsen: bool) -> None:
        assert self._table is not None
        nodes = redistribute(self._table.nodes, errors, self.method.rtol, coarsen)
        if len(nodes) > MOST_STEPS:
            raise ConvergenceError(f"the mesh would need more than {MOST_STEPS} steps: sigma lies on a singularity of the system")
        self._table = tabulate(self.problem, nodes)

    def _evaluate(self, sigma: complex, tangent: bool) -> Value:
        if self._table is None:
            self._build(sigma, self._far_tolerance)
        value, errors = self._shoot(sigma, tangent)
        for _ in range(20):
            if (errors <= self.method.rtol).all():
                return value
            self._regrid(errors, coarsen=False)
            value, errors = self._shoot(sigma, tangent)
        raise ConvergenceError(f"local errors of {self.method.rtol:.1e} cannot be held at sigma = {sigma:.6g}")

    def _shoot(self, sigma: complex, tangent: bool) -> tuple[Value, np.ndarray]:
        assert self._table is not None
        table = self._table
        far = self.problem.far_frame(table.nodes[0].real, sigma)
        if far.error > 10 * self._far_tolerance:
            self._build(sigma, self._far_tolerance)
            return self._shoot(sigma, tangent)
        self.evaluations += 1
        Y, dY = far.frame.copy(), far.tangent.copy()
        errors = np.empty(len(table.nodes) - 1)
        log_det, trace = transport(table.steps, table.X, table.V, table.G, table.T, sigma, Y, dY, tangent, errors)
        W = self._rows[0] + sigma * self._rows[1]
        at_wall = W @ Y
        D = Scaled(complex(np.linalg.det(at_wall)), log_det + far.log_scale)
        slope = complex(trace + np.trace(np.linalg.solve(at_wall, self._rows[1] @ Y + W @ dY))) if tangent else 0j
        return Value(sigma, D, slope), errors

