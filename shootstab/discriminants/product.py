"""D(σ) of a problem from those of its decoupling, each carried on its own mesh."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

from shootstab.core.discriminant import Value
from shootstab.core.scaled import Scaled
from shootstab.discriminants.deformed_path import DeformedPath
from shootstab.discriminants.shooting import Propagator, Shooting
from shootstab.discriminants.subsystems import Coupled, Decoupling, decouple
from shootstab.problems.protocol import Problem


def shoot(problem: Problem, method: Callable[[], Propagator], path: DeformedPath | None = None) -> Shooting | Product:
    """D(σ) of the problem by a method, along the real axis or along a path; in decoupling where it falls into decoupling.

    method makes a carrier, one for each part: a carrier may remember how it went.
    """
    decoupling = decouple(problem)
    if decoupling is None:
        return Shooting(problem, method(), path)
    return Product(decoupling, tuple(Shooting(part, method(), path) for part in decoupling.members), method)


class Product:
    """D = factor Π D_i; a discriminant as `Shooting` is one."""

    def __init__(self, decoupling: Decoupling, members: tuple[Shooting, ...], method: Callable[[], Propagator]) -> None:
        self._decoupling, self.members, self._method = decoupling, members, method

    def __call__(self, sigma: complex) -> Scaled:
        D = Scaled(self._decoupling.factor, 0.0)
        for member in self.members:
            D = _times(D, member(sigma))
        return D

    def with_derivative(self, sigma: complex) -> Value:
        sigma = complex(sigma)
        total = Value(sigma, Scaled(self._decoupling.factor, 0.0), 0j)
        for member in self.members:
            value = member.with_derivative(sigma)
            dD = total.dD * value.D.mantissa + total.D.mantissa * value.dD
            total = Value(sigma, _times(total.D, value.D), dD)
        return total

    @property
    def evaluations(self) -> int:
        """How often D was computed."""
        return max(member.evaluations for member in self.members)

    @property
    def steps(self) -> int:
        """How many steps the longest mesh has."""
        return max(member.steps for member in self.members)

    @property
    def far_error(self) -> float:
        return max(member.far_error for member in self.members)

    def system_at(self, sigma: complex) -> str:
        """What is integrated at this σ, in words."""
        if len(self.members) == 1:
            return self.members[0].system_at(sigma)
        orders = " + ".join(str(member.problem.size) for member in self.members)
        return f"orders {orders} in {'real' if all(m.real_at(sigma) for m in self.members) else 'complex'} numbers"

    def refined(self, seed: int | None = None) -> Product:
        return self._each(lambda member: member.refined(seed))

    def with_rotated_basis(self, seed: int) -> Product:
        return self._each(lambda member: member.with_rotated_basis(seed))

    def with_perturbed_start(self, seed: int, size: float) -> Product:
        return self._each(lambda member: member.with_perturbed_start(seed, size))

    def on_same_mesh(self, problem: Problem) -> Product:
        others = self._decoupling.applied_to(problem)
        members = tuple(member.on_same_mesh(other) for member, other in zip(self.members, others, strict=True))
        return Product(replace(self._decoupling, members=others), members, self._method)

    def reuse_mesh_of(self, other: Shooting | Product) -> None:
        """Begin with the meshes that another path of the same problem has."""
        if isinstance(other, Product):
            for member, known in zip(self.members, other.members, strict=True):
                member.reuse_mesh_of(known)

    def warm_started(self, problem: Problem) -> Shooting | Product:
        """Of another problem, from the same mesh on; in the same decoupling if they are apart there too."""
        others = self._decoupling.members if problem is self._decoupling.members[0].whole else self._decoupling.applied_to(problem)
        try:
            members = tuple(member.warm_started(other, self._method()) for member, other in zip(self.members, others, strict=True))
        except Coupled:
            return shoot(problem, self._method, self.members[0].path)
        return Product(replace(self._decoupling, members=others), members, self._method)

    def _each(self, change: Callable[[Shooting], Shooting]) -> Product:
        return Product(self._decoupling, tuple(map(change, self.members)), self._method)


def _times(a: Scaled, b: Scaled) -> Scaled:
    return Scaled(a.mantissa * b.mantissa, a.log_scale + b.log_scale)
