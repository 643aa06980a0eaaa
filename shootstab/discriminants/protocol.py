"""The discriminant, and the method that makes one of a problem."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol, Self

from shootstab.discriminants.paths import Bend
from shootstab.problems.protocol import Problem
from shootstab.vocabulary.scaled import Scaled


@dataclass(frozen=True)
class Value:
    """D(σ) and dD/dσ at one σ; dD is a mantissa at the scale of D."""

    sigma: complex
    D: Scaled
    dD: complex

    @property
    def slope(self) -> complex:
        """d ln D/dσ; infinite at a zero."""
        return self.dD / self.D.mantissa if self.D.mantissa != 0.0 else complex("inf")

    @property
    def newton_step(self) -> complex:
        """−D/D′."""
        if self.dD == 0.0:
            return 0j if self.D.mantissa == 0.0 else complex("inf")
        return -self.D.mantissa / self.dD


class Discriminant(Protocol):
    """D(σ), analytic, zero at the modes and nowhere else."""

    @property
    def evaluations(self) -> int:
        """How often D was computed."""
        ...

    def __call__(self, sigma: complex) -> Scaled:
        """D(σ)."""
        ...

    def with_slope(self, sigma: complex) -> Value:
        """D(σ) and its exact logarithmic derivative."""
        ...


class Examinable(Discriminant, Protocol):
    """A discriminant on a mesh that can be asked for its errors: its methods give variants whose zeros lie elsewhere by one of them."""

    def adopt(self, other: Self) -> None:
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

    def refined(self, seed: int | None = None) -> Examinable:
        """On a mesh with every step halved; with a seed, cut a little off the middle, so that only rounding differs."""
        ...

    def turned(self, seed: int) -> Examinable:
        """On the same mesh, from the far frame in another basis of determinant 1: the same D but for rounding."""
        ...

    def jiggled(self, seed: int, size: float) -> Examinable:
        """On the same mesh, from a far frame with every component changed by a random relative amount of this size."""
        ...

    def of(self, problem: Problem) -> Examinable:
        """Of another problem, on the same mesh."""
        ...

    def moved_to(self, problem: Problem) -> Examinable:
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

    def on(self, problem: Problem, bend: Bend | None = None) -> Examinable:
        """The discriminant of a problem, integrated along the real axis or along a bend."""
        ...
