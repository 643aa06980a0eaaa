"""D(σ) of a problem from those of its subsystems, each on its own mesh."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from shootstab.core.discriminant import Value
from shootstab.core.scaled import Scaled
from shootstab.discriminants.shooting import Shooting
from shootstab.discriminants.subsystems import Decoupling
from shootstab.discriminants.zero_gradient import Ingredients, ZeroGradient
from shootstab.problems.protocol import Problem


class Product:
    """D = factor Π D_i; a discriminant as `Shooting` is one."""

    def __init__(self, decoupling: Decoupling, members: tuple[Shooting, ...]) -> None:
        self._decoupling, self.members = decoupling, members
        self._alone: dict[int, Product] = {}

    def vanishing_at(self, sigma: complex) -> Product:
        """D of the one subsystem whose zero is nearest to σ, as Newton's step tells: the others do not move it."""
        if len(self.members) == 1:
            return self
        steps = [abs(member.with_derivative(sigma).newton_step) for member in self.members]
        place = steps.index(min(steps))
        if place not in self._alone:
            alone = replace(self._decoupling, members=self._decoupling.members[place : place + 1])
            self._alone[place] = Product(alone, (self.members[place],))
        return self._alone[place]

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

    def serves(self, sigma: complex, tangent: bool = True) -> bool:
        return all(member.serves(sigma, tangent) for member in self.members)

    def local_errors(self, sigma: complex) -> NDArray[np.float64]:
        """The local errors of all steps of all subsystems at σ, (m,)."""
        return np.concatenate([member.local_errors(sigma) for member in self.members])

    def far_error(self, sigma: complex) -> float:
        """The relative error of the far-field frame at σ, the largest of the subsystems'."""
        return max(member.far_error(sigma) for member in self.members)

    def ingredients(self, sigma: complex) -> Ingredients:
        (member,) = self.members
        return member.ingredients(sigma)

    def gradient(self, sigma: complex) -> ZeroGradient | None:
        return self.members[0].gradient(sigma) if len(self.members) == 1 else None

    def system_at(self, sigma: complex) -> str:
        """What is integrated at this σ, in words."""
        if len(self.members) == 1:
            return self.members[0].system_at(sigma)
        orders = " + ".join(str(member.problem.size) for member in self.members)
        return f"orders {orders} in {'real' if self.real_at(sigma) else 'complex'} numbers"

    def real_at(self, sigma: complex) -> bool:
        return all(member.real_at(sigma) for member in self.members)

    def refined(self, seed: int | None = None, problem: Problem | None = None) -> Product:
        if problem is None:
            return self._each(lambda member: member.refined(seed))
        return self._of_another(problem, lambda member, other: member.refined(seed, other))

    def partly_refined(self, digit: int, sigma: complex) -> Product:
        return self._each(lambda member: member.partly_refined(digit, sigma))

    def at_other_points(self, seed: int) -> Product:
        return self._each(lambda member: member.at_other_points(seed))

    def with_rotated_basis(self, seed: int) -> Product:
        return self._each(lambda member: member.with_rotated_basis(seed))

    def with_perturbed_start(self, seed: int, size: float, real: bool = False) -> Product:
        return self._each(lambda member: member.with_perturbed_start(seed, size, real))

    def with_perturbed_system(self, seed: int, size: float) -> Product:
        return self._each(lambda member: member.with_perturbed_system(seed, size))

    def on_same_mesh(self, problem: Problem) -> Product:
        return self._of_another(problem, lambda member, other: member.on_same_mesh(other))

    def _of_another(self, problem: Problem, change: Callable[[Shooting, Problem], Shooting]) -> Product:
        others = self._decoupling.applied_to(problem)
        return Product(replace(self._decoupling, members=others), tuple(map(change, self.members, others)))

    def _each(self, change: Callable[[Shooting], Shooting]) -> Product:
        return Product(self._decoupling, tuple(map(change, self.members)))


def _times(a: Scaled, b: Scaled) -> Scaled:
    return Scaled(a.mantissa * b.mantissa, a.log_scale + b.log_scale)
