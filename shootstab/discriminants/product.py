"""D(σ) of a problem from those of its parts, each carried on its own mesh."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

from shootstab.discriminants.parts import Coupled, Parts, parts_of
from shootstab.discriminants.paths import Bend
from shootstab.discriminants.protocol import Value
from shootstab.discriminants.shooting import Carrier, Shooting
from shootstab.problems.protocol import Problem
from shootstab.vocabulary.scaled import Scaled


def shoot(problem: Problem, method: Callable[[], Carrier], bend: Bend | None = None) -> Shooting | Product:
    """D(σ) of the problem by a method, along the real axis or along a bend; in parts where it falls into parts.

    method makes a carrier, one for each part: a carrier may remember how it went.
    """
    parts = parts_of(problem)
    if parts is None:
        return Shooting(problem, method(), bend)
    return Product(parts, tuple(Shooting(part, method(), bend) for part in parts.members), method)


class Product:
    """D = factor Π D_i; a discriminant as `Shooting` is one."""

    def __init__(self, parts: Parts, members: tuple[Shooting, ...], method: Callable[[], Carrier]) -> None:
        self._parts, self.members, self._method = parts, members, method

    def __call__(self, sigma: complex) -> Scaled:
        D = Scaled(self._parts.factor, 0.0)
        for member in self.members:
            D = _times(D, member(sigma))
        return D

    def with_slope(self, sigma: complex) -> Value:
        sigma = complex(sigma)
        total = Value(sigma, Scaled(self._parts.factor, 0.0), 0j)
        for member in self.members:
            value = member.with_slope(sigma)
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

    def turned(self, seed: int) -> Product:
        return self._each(lambda member: member.turned(seed))

    def jiggled(self, seed: int, size: float) -> Product:
        return self._each(lambda member: member.jiggled(seed, size))

    def of(self, problem: Problem) -> Product:
        others = self._parts.of(problem)
        members = tuple(member.of(other) for member, other in zip(self.members, others, strict=True))
        return Product(replace(self._parts, members=others), members, self._method)

    def adopt(self, other: Shooting | Product) -> None:
        """Begin with the meshes that another path of the same problem has."""
        if isinstance(other, Product):
            for member, known in zip(self.members, other.members, strict=True):
                member.adopt(known)

    def moved_to(self, problem: Problem) -> Shooting | Product:
        """Of another problem, from the same mesh on; in the same parts if they are apart there too."""
        others = self._parts.members if problem is self._parts.members[0].whole else self._parts.of(problem)
        try:
            members = tuple(member.moved_to(other, self._method()) for member, other in zip(self.members, others, strict=True))
        except Coupled:
            return shoot(problem, self._method, self.members[0].bend)
        return Product(replace(self._parts, members=others), members, self._method)

    def _each(self, change: Callable[[Shooting], Shooting]) -> Product:
        return Product(self._parts, tuple(map(change, self.members)), self._method)


def _times(a: Scaled, b: Scaled) -> Scaled:
    return Scaled(a.mantissa * b.mantissa, a.log_scale + b.log_scale)
