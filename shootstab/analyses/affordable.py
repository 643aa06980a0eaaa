"""D(σ) for a search from a guess: where an iteration wanders off to meshes far longer than that at the guess, it is ended."""

from __future__ import annotations

from dataclasses import dataclass

from shootstab.core.discriminant import Value
from shootstab.core.errors import ConvergenceError
from shootstab.core.scaled import Scaled
from shootstab.discriminants.meshing import TooLong
from shootstab.discriminants.method import AdaptiveDiscriminant, MeshedDiscriminant

COSTLIER = 3  # chosen: the longest mesh of a search, in steps of that at the guess: where that is long, a guess is refused within seconds
ANYWAY = 4000  # chosen: steps that a mesh of a search may have anyway; a value of D on it takes some 20 ms


class WanderedOff(ConvergenceError):  # noqa: N818
    """A search has come to where D costs too much for a place that a guess means."""


@dataclass(frozen=True)
class Affordable:
    """D(σ) on meshes of so many steps at most. Raises WanderedOff where it takes more, ConvergenceError where no mesh is found at all."""

    discriminant: AdaptiveDiscriminant
    guess: complex

    def at(self, sigma: complex, tangent: bool) -> MeshedDiscriminant:
        """D on the mesh that serves σ; the mesh at the guess is found at once where it is kept."""
        steps = self.discriminant.at(self.guess).steps
        try:
            return self.discriminant.at(sigma, tangent, max(ANYWAY, COSTLIER * steps))
        except TooLong as error:
            raise WanderedOff(f"the search from {self.guess:.6g}, where {steps} steps do, wandered off: {error}") from None

    def __call__(self, sigma: complex) -> Scaled:
        return self.at(sigma, False)(sigma)

    def with_derivative(self, sigma: complex) -> Value:
        return self.at(sigma, True).with_derivative(sigma)

    @property
    def evaluations(self) -> int:
        """How often D was computed."""
        return self.discriminant.evaluations
