"""D(σ) as searches see it: a value with its exact derivative. This module does nothing but name the discriminant."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

from shootstab.core.scaled import Scaled


@dataclass(frozen=True)
class Value:
    """D(σ) and dD/dσ at one σ; dD is a mantissa at the scale of D."""

    sigma: complex
    D: Scaled
    dD: complex

    @property
    def logarithmic_derivative(self) -> complex:
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

    def with_derivative(self, sigma: complex) -> Value:
        """D(σ) and its exact logarithmic derivative."""
        ...
