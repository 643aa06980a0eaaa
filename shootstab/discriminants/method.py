"""A discriminant on a mesh, which can be asked for its errors, and the method that makes one of a problem."""

from __future__ import annotations

from typing import Protocol, Self

from shootstab.core.discriminant import Discriminant
from shootstab.discriminants.deformed_path import DeformedPath
from shootstab.problems.protocol import Problem


class MeshedDiscriminant(Discriminant, Protocol):
    """A discriminant on a mesh that can be asked for its errors: its methods give variants whose zeros lie elsewhere by one of them."""

    def reuse_mesh_of(self, other: Self) -> None:
        """Begin with the mesh that another path of the same problem has."""
        ...

    @property
    def far_error(self) -> float:
        """The relative error of the far-field frame at the last σ."""
        ...

    @property
    def steps(self) -> int:
        """How many steps the mesh has."""
        ...

    def system_at(self, sigma: complex) -> str:
        """What is integrated at this σ, in words: the orders of the parts, in real or complex numbers."""
        ...

    def refined(self, seed: int | None = None) -> MeshedDiscriminant:
        """On a mesh with every step halved; with a seed, cut a little off the middle, so that only rounding differs."""
        ...

    def with_rotated_basis(self, seed: int) -> MeshedDiscriminant:
        """On the same mesh, from the far frame in another basis of determinant 1: the same D but for rounding."""
        ...

    def with_perturbed_start(self, seed: int, size: float) -> MeshedDiscriminant:
        """On the same mesh, from a far frame with every component changed by a random relative amount of this size."""
        ...

    def on_same_mesh(self, problem: Problem) -> MeshedDiscriminant:
        """Of another problem, on the same mesh."""
        ...

    def warm_started(self, problem: Problem) -> MeshedDiscriminant:
        """Of another problem, from the same mesh on, which grows where it must: for a problem next to this one."""
        ...


class Method(Protocol):
    """A way to compute D(σ): a small object with a tolerance."""

    @property
    def name(self) -> str: ...

    @property
    def rtol(self) -> float:
        """What local errors are held to."""
        ...

    def on(self, problem: Problem, path: DeformedPath | None = None) -> MeshedDiscriminant:
        """The discriminant of a problem, integrated along the real axis or along a path."""
        ...
