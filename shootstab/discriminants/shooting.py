"""D(σ) on a mesh: what is common to every method that carries the decaying space from the far field to the wall."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Protocol

import numpy as np

from shootstab.core.discriminant import Value
from shootstab.core.errors import ConvergenceError
from shootstab.core.scaled import Scaled
from shootstab.discriminants.deformed_path import DeformedPath
from shootstab.discriminants.mesh import halved, redistribute, subdivide
from shootstab.discriminants.sampled_system import SampledSystem, resample, sample_system
from shootstab.problems.protocol import ComplexArray, FarFrame, Problem

MOST_STEPS = 40_000
TURNS = 30  # attempts at a mesh
FAR_MARGIN = 1e-4  # of the far frame's tolerance, for a mesh that is to serve larger σ too
REDISTRIBUTIONS = 3  # of them, those that move every node


class Propagator(Protocol):
    """A method that carries the decaying space along a sampled, with the tolerance that it sets on local errors."""

    @property
    def rtol(self) -> float: ...

    def propagate(
        self, sampled: SampledSystem, rows: tuple[ComplexArray, ComplexArray], far: FarFrame, sigma: complex, tangent: bool
    ) -> tuple[Value, np.ndarray]:
        """D(σ), with dD/dσ if tangent, and the local errors (N,) of the sampled's steps."""
        ...


@dataclass(frozen=True)
class FixedMesh:
    """A method on a mesh that is to stay: it carries as the method does and finds no local error too large."""

    method: Propagator
    rtol: float = math.inf

    def propagate(
        self, sampled: SampledSystem, rows: tuple[ComplexArray, ComplexArray], far: FarFrame, sigma: complex, tangent: bool
    ) -> tuple[Value, np.ndarray]:
        """As the method does."""
        return self.method.propagate(sampled, rows, far, sigma, tangent)


class Shooting:
    """D(σ) = det[(W0 + σW1) Y(0; σ)], Y the decaying space normalized in the far field.

    The mesh stays the same from one σ to the next as long as its local errors hold, and on a given mesh D is analytic to rounding.
    With a path the path of integration leaves the real axis.
    """

    def __init__(
        self,
        problem: Problem,
        method: Propagator,
        path: DeformedPath | None = None,
        start: Callable[[FarFrame], FarFrame] = lambda far: far,
    ) -> None:
        self.problem, self.method, self.path, self._start = problem, method, path, start
        self.evaluations = 0
        self._sampled_system: SampledSystem | None = None
        self._far_error = 0.0
        self._sampled_systems: dict[tuple[Problem, bool, int | None], tuple[SampledSystem | None, SampledSystem]] = {}
        self._rows = problem.wall_rows()

    def __call__(self, sigma: complex) -> Scaled:
        return self._evaluate(complex(sigma), False).D

    def with_derivative(self, sigma: complex) -> Value:
        return self._evaluate(complex(sigma), True)

    def refined(self, seed: int | None = None) -> Shooting:
        """The same on a mesh with every step halved: the difference is the error of this one.

        With a seed the steps are cut a little off their middle: what differs from the halved mesh is the rounding of mesh and sampled.
        """
        return self._variant(lambda far: far, halved(self._mesh, seed), self.problem, seed)

    def with_rotated_basis(self, seed: int) -> Shooting:
        """The same from the far frame with its columns in another order and with other phases, of product 1, at random.

        They are not mixed: columns of very different size would be spoilt by that, and not by the method.
        """
        k = self.problem.decaying
        order = np.random.default_rng(seed).permutation(k)
        basis = np.eye(k)[order] * _random(seed, k)
        basis[:, 0] /= np.linalg.det(basis)
        return self._variant(lambda far: replace(far, frame=far.frame @ basis, tangent=far.tangent @ basis), self._mesh, self.problem)

    def with_perturbed_start(self, seed: int, size: float) -> Shooting:
        """The same from a far frame with every component changed by a random relative amount of this size."""
        noise = 1 + size * _random(seed, self.problem.size, self.problem.decaying)
        return self._variant(lambda far: replace(far, frame=far.frame * noise), self._mesh, self.problem)

    def on_same_mesh(self, problem: Problem) -> Shooting:
        """Of another problem, on the same mesh."""
        return self._variant(lambda far: far, self._mesh, problem)

    def warm_started(self, problem: Problem, method: Propagator | None = None) -> Shooting:
        """Of another problem, from the same mesh on, which grows where it must; method carries it, if not the same object."""
        other = Shooting(problem, method or self.method, self.path)
        if self._sampled_system is not None:
            other._sampled_system = self._sampled_system if problem is self.problem else sample_system(problem, self._mesh)
        return other

    def reuse_mesh_of(self, other: Shooting) -> None:
        """Begin with the mesh and the sampled that another path of the same problem has off the detours."""
        if other._sampled_system is None or self.path is None:
            return
        nodes = other._mesh
        real = nodes[nodes.imag == 0.0].real
        if other.path is not None:
            inside = self.problem.mesh(real[0])
            inside = inside[np.abs(inside - other.path.centre) < other.path.half_width]
            real = np.union1d(real, inside)
            real = real if nodes[-1].real > nodes[0].real else real[::-1]
        self._sampled_system = resample(self.problem, self.path.deform(real), other._sampled_system)

    @property
    def far_error(self) -> float:
        return self._far_error

    @property
    def steps(self) -> int:
        """How many steps the mesh has."""
        return 0 if self._sampled_system is None else len(self._sampled_system.nodes) - 1

    def system_at(self, sigma: complex) -> str:
        """What is integrated at this σ, in words."""
        return f"order {self.problem.size} in {'real' if self.real_at(sigma) else 'complex'} numbers"

    def real_at(self, sigma: complex) -> bool:
        """Whether the system is real at this σ."""
        return complex(sigma).imag == 0.0 and self._sampled_system is not None and self._sampled_system.real is not None

    @property
    def _mesh(self) -> ComplexArray:
        if self._sampled_system is None:
            raise ValueError("no mesh yet: D has not been asked for")
        return self._sampled_system.nodes

    def _variant(self, start: Callable[[FarFrame], FarFrame], nodes: ComplexArray, problem: Problem, seed: int | None = None) -> Shooting:
        """The same on a given mesh, which it keeps, from a far frame changed on the way."""
        other = Shooting(problem, FixedMesh(self.method), self.path, start)
        other._sampled_system = self._shared_system(problem, nodes, seed)
        return other

    def _shared_system(self, problem: Problem, nodes: ComplexArray, seed: int | None) -> SampledSystem | None:
        """A sampled of its own mesh, of the halved one, or of another problem's on its own: each is made once for each mesh."""
        if problem is self.problem and nodes is self._mesh:
            return self._sampled_system
        key = (problem, nodes is self._mesh, seed)
        known = self._sampled_systems.get(key)
        if known is None or known[0] is not self._sampled_system:
            # the mesh may have grown since: most of its steps are the same
            sampled = sample_system(problem, nodes) if known is None else resample(problem, nodes, known[1])
            self._sampled_systems[key] = known = self._sampled_system, sampled
        return known[1]

    @property
    def _far_tolerance(self) -> float:
        return min(1e-3 * self.method.rtol, 1e-14)  # an infinite rtol marks a variant, which keeps its mesh

    def _build(self, sigma: complex, far_tolerance: float) -> None:
        """A mesh for σ: from the problem's own first mesh, redistributed until the local errors hold."""
        start = self.problem.start(sigma, far_tolerance)
        straight = self.problem.mesh(start)
        self._sampled_system = sample_system(
            self.problem, straight.astype(np.complex128) if self.path is None else self.path.deform(straight)
        )
        for turn in range(TURNS):
            _, errors = self._shoot(sigma, False)
            if turn > 0 and (errors <= self.method.rtol).all():
                return
            self._regrid(errors, everywhere=turn < REDISTRIBUTIONS)
        raise ConvergenceError(f"no mesh found that holds local errors of {self.method.rtol:.1e} at sigma = {sigma:.6g}")

    def _reach_out(self, sigma: complex) -> bool:
        """Begin farther out, where the far frame holds for σ and for somewhat larger ones; the rest of the mesh stays.

        False where the problem has no place farther out: then the error of its far frame is a part of the bound.
        """
        nodes, sampled = self._mesh, self._sampled_system
        assert sampled is not None
        outwards = nodes[0].real - nodes[-1].real
        straight = self.problem.mesh(self.problem.start(sigma, FAR_MARGIN * self._far_tolerance))
        beyond = straight[(straight - nodes[0].real) * outwards > 1e-9 * outwards**2]
        if len(beyond) == 0:
            return False
        self._sampled_system = resample(self.problem, np.concatenate((beyond, nodes)), sampled)
        return True

    def _regrid(self, errors: np.ndarray, everywhere: bool) -> None:
        """Spread the steps anew, or only split those that err too much."""
        nodes = (redistribute if everywhere else subdivide)(self._mesh, errors, self.method.rtol)
        if len(nodes) > MOST_STEPS:
            raise ConvergenceError(f"the mesh would need more than {MOST_STEPS} steps: sigma lies on a singularity of the system")
        assert self._sampled_system is not None
        self._sampled_system = resample(self.problem, nodes, self._sampled_system)

    def _evaluate(self, sigma: complex, tangent: bool) -> Value:
        if self._sampled_system is None:
            self._build(sigma, self._far_tolerance)
        value, errors = self._shoot(sigma, tangent)
        for _ in range(TURNS):
            if (errors <= self.method.rtol).all():
                return value
            self._regrid(errors, everywhere=False)
            value, errors = self._shoot(sigma, tangent)
        raise ConvergenceError(f"local errors of {self.method.rtol:.1e} cannot be held at sigma = {sigma:.6g}")

    def _shoot(self, sigma: complex, tangent: bool) -> tuple[Value, np.ndarray]:
        assert self._sampled_system is not None
        sampled = self._sampled_system
        far = self._start(self.problem.far_frame(sampled.nodes[0].real, sigma))
        self._far_error = far.error
        if far.error > 10 * self._far_tolerance and self._reach_out(sigma):
            return self._shoot(sigma, tangent)
        self.evaluations += 1
        return self.method.propagate(sampled, self._rows, far, sigma, tangent)


def _random(seed: int, *shape: int) -> ComplexArray:
    """Complex numbers of modulus 1."""
    return np.asarray(np.exp(2j * np.pi * np.random.default_rng(seed).random(shape)))
