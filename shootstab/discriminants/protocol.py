"""The discriminant, and the method that makes one of a problem."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

from shootstab.problems.protocol import Problem
from shootstab.vocabulary.scaled import Scaled


@dataclass(frozen=True)
class Value:
    """D(σ) and d ln D/dσ at one σ."""

    sigma: complex
    D: Scaled
    slope: complex


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


class Method(Protocol):
    """A way to compute D(σ): a small object with a tolerance."""

    @property
    def name(self) -> str: ...

    def on(self, problem: Problem) -> Discriminant:
        """The discriminant of a problem."""
        ...
