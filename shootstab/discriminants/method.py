"""What a discriminant on a mesh is, how a method makes those of a problem, and what a method of propagation owes."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from shootstab.core.discriminant import Discriminant, Value
from shootstab.core.errors import InputError, shortened
from shootstab.core.given import is_real
from shootstab.discriminants.cells import Cell
from shootstab.discriminants.deformed_path import DeformedPath
from shootstab.discriminants.sampled_system import SampledSystem
from shootstab.discriminants.zero_gradient import CarriedFrames, Ingredients, ZeroGradient
from shootstab.problems.protocol import ComplexArray, FarFrame, Problem

LEAST_RTOL = 4 * float(np.finfo(float).eps)  # derived: a step rounds by ε, and a smaller error of it cannot be seen
DEFAULT_RTOL = 1e-11  # chosen: a mode then has some ten digits, and rounding counts for nothing yet
LARGEST_RTOL = 0.1  # chosen: the largest local error with which a step says anything

Meshes = Mapping[Cell | None, tuple[ComplexArray, ...]]  # nodes by cell, of every subsystem; None is the cell around a path's centre


@dataclass(frozen=True)
class Propagation:
    """D(σ) with dD/dσ, the local errors (N,) of the steps, and whether the method held: False where it was carried too far to trust.

    way is what a gradient of the zero is made of; None where the method has none, or without σ-derivative.
    """

    value: Value
    errors: NDArray[np.float64]
    sound: bool = True
    way: CarriedFrames | None = None


class Propagator(Protocol):
    """Carries the decaying space along a sampled system to the wall.

    On one sampled system, fixed at a σ, it makes D a function that is analytic in σ to rounding, whatever the mesh resolves.
    """

    @property
    def rtol(self) -> float:
        """What local errors are held to."""
        ...

    def propagate(
        self, sampled: SampledSystem, rows: tuple[ComplexArray, ...], far: FarFrame, sigma: complex, tangent: bool
    ) -> Propagation:
        """D = det[(W0 + σ W1 + …) Y] with rows W0, W1, … (k, n) and far.frame (n, k) where the mesh begins; dD/dσ is right if tangent."""
        ...

    def fixed_at(self, sampled: SampledSystem, far: FarFrame, sigma: complex) -> Propagator:
        """The propagator with all that it may choose chosen for this σ, so that it stays for all others."""
        ...


class MeshedDiscriminant(Discriminant, Protocol):
    """D(σ) on one mesh, which never changes: analytic in σ to rounding, near the true D where its local errors hold.

    Its methods give variants whose zeros lie elsewhere by one of its errors.
    """

    @property
    def steps(self) -> int:
        """How many steps the mesh has, the longest one if every subsystem has its own."""
        ...

    def serves(self, sigma: complex, tangent: bool = True) -> bool:
        """Whether the local errors hold at σ, and the far frame does: D is then what the method's tolerance promises."""
        ...

    def far_error(self, sigma: complex) -> float:
        """The relative error of the far-field frame at σ."""
        ...

    def local_errors(self, sigma: complex) -> NDArray[np.float64]:
        """The local errors of all steps at σ, (m,), from the values of D with derivative."""
        ...

    def vanishing_at(self, sigma: complex) -> MeshedDiscriminant:
        """D of the one independent subsystem whose zero is nearest to σ; itself where there are no subsystems."""
        ...

    def ingredients(self, sigma: complex) -> Ingredients:
        """What D is made of at σ, of one subsystem. Raises ValueError where there are several."""
        ...

    def gradient(self, sigma: complex) -> ZeroGradient | None:
        """What the zero next to σ depends on; None where the method cannot tell, or several subsystems have zeros."""
        ...

    def system_at(self, sigma: complex) -> str:
        """What is integrated at σ, in words: the orders of the subsystems, in real or complex numbers."""
        ...

    def real_at(self, sigma: complex) -> bool:
        """Whether everything is real at σ."""
        ...

    def refined(self, seed: int | None = None, problem: Problem | None = None) -> MeshedDiscriminant:
        """D, of another problem if one is given, on a mesh with every step halved; with a seed, cut a little off the middle."""
        ...

    def partly_refined(self, digit: int, sigma: complex) -> MeshedDiscriminant:
        """D on a mesh with half of the steps halved: those whose rank by local error at σ has a 0 as this binary digit."""
        ...

    def at_other_points(self, seed: int) -> MeshedDiscriminant:
        """D on nodes moved by so little that only mesh and samples round otherwise."""
        ...

    def with_rotated_basis(self, seed: int) -> MeshedDiscriminant:
        """D on the same mesh, from the far frame in another basis of determinant 1: the same D but for rounding."""
        ...

    def with_perturbed_start(self, seed: int, size: float, real: bool = False) -> MeshedDiscriminant:
        """D on the same mesh, from a far frame with every component changed by a relative amount of this size and random phase or sign."""
        ...

    def with_perturbed_system(self, seed: int, size: float) -> MeshedDiscriminant:
        """D on the same mesh, with every entry of the system changed by random relative amounts of this size."""
        ...

    def on_same_mesh(self, problem: Problem) -> MeshedDiscriminant:
        """D(σ) of another problem, on the same mesh."""
        ...


class AdaptiveDiscriminant(Discriminant, Protocol):
    """D(σ), every σ on the mesh of its cell: a function of σ that the method's tolerance promises, whatever was asked before.

    From cell to cell it jumps by the error of integration. Whoever needs an analytic function asks for one mesh, by `at` or `around`.
    """

    def at(self, sigma: complex, tangent: bool = True, most: int | None = None) -> MeshedDiscriminant:
        """D on the mesh that serves σ. Raises ConvergenceError where none is found, or none of so many steps at most."""
        ...

    def around(self, centre: complex, radius: float) -> MeshedDiscriminant:
        """D on one mesh that serves a circle. Raises ConvergenceError where none is found."""
        ...

    @property
    def problem(self) -> Problem:
        """The problem that D is of."""
        ...

    @property
    def bytes_kept(self) -> int:
        """The memory of the systems on the meshes that are kept by now."""
        ...

    @property
    def meshes(self) -> Meshes:
        """The nodes (N + 1,) of the cells that are known by now, for a neighbouring problem to begin with."""
        ...


class Method(Protocol):
    """A way to compute D(σ): a small object with a tolerance."""

    @property
    def name(self) -> str: ...

    @property
    def rtol(self) -> float:
        """What local errors are held to."""
        ...

    def on(
        self, problem: Problem, path: DeformedPath | None = None, centre: complex | None = None, begin: Meshes | None = None
    ) -> AdaptiveDiscriminant:
        """D(σ) of a problem, integrated along the real axis or along a path.

        centre is a σ that the path is meant for; begin are meshes (N + 1,) of another problem, with which those of the same cells begin.
        """
        ...


def require_tolerance(method: Propagator) -> None:
    """Raise InputError unless local errors can be held to the method's rtol: what a method does before anything else."""
    rtol = method.rtol
    if not (is_real(rtol) and LEAST_RTOL <= rtol <= LARGEST_RTOL):
        raise InputError(f"rtol = {shortened(rtol)} of the method: allowed is a number from {LEAST_RTOL:.1e} to {LARGEST_RTOL:g}")
