"""A problem in another eigenvalue v, σ = unit·v with a complex unit, so that every answer and every circle is in v."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from shootstab.problems.capabilities import (
    ASYMPTOTICS,
    CROSSINGS,
    FARTHER_WALLS,
    GENERIC,
    INTERIOR,
    KNOTS,
    MODE_SHAPE,
    UNKNOWNS,
    Continuum,
    Shape,
)
from shootstab.problems.protocol import ComplexArray, FarFrame, Pencil, Problem
from shootstab.problems.splitting import AsymptoticPencil
from shootstab.problems.unknowns import Placement, Unknowns, placements


@dataclass(frozen=True, eq=False)
class RescaledContinuum:
    """σ_c(z)/unit."""

    curve: Continuum
    unit: complex

    def heights(self, points: int) -> NDArray[np.float64]:
        return self.curve.heights(points)

    def __call__(self, z: ComplexArray) -> ComplexArray:
        return np.asarray(self.curve(z) / self.unit)


@dataclass(frozen=True, eq=False)
class Rescaled:
    """The pencil C(unit v) ψ′ = D(unit v) ψ.

    Multiplication by a complex number is analytic and keeps orientation: D stays analytic, and a curve's left side stays its left side.
    """

    problem: Problem
    unit: complex
    _crude: dict[float, Rescaled] = field(default_factory=dict, repr=False)

    @property
    def size(self) -> int:
        return self.problem.size

    @property
    def decaying(self) -> int:
        return self.problem.decaying

    def pencil(self, z: ComplexArray) -> Pencil:
        return self.problem.pencil(z).rescaled(self.unit)

    def start(self, sigma: complex, tolerance: float) -> float:
        return self.problem.start(self.unit * sigma, tolerance)

    def far_frame(self, z: float, sigma: complex) -> FarFrame:
        far = self.problem.far_frame(z, self.unit * sigma)
        return FarFrame(far.frame, self.unit * far.tangent, far.log_scale, far.error)

    def mesh(self, start: float) -> NDArray[np.float64]:
        return self.problem.mesh(start)

    def wall_rows(self) -> tuple[ComplexArray, ...]:
        return tuple(self.unit**k * W if k else W for k, W in enumerate(self.problem.wall_rows()))

    def with_base_flow_error(self, factor: float) -> Rescaled:
        crude = self.problem.with_base_flow_error(factor)
        if crude is self.problem:
            return self
        if factor not in self._crude:
            self._crude[factor] = Rescaled(crude, self.unit)
        return self._crude[factor]

    @property
    def unscaled(self) -> tuple[Problem, complex]:
        """The problem in σ, and σ/v."""
        return self.problem, self.unit

    @property
    def generic_sigma(self) -> complex:
        return complex(GENERIC.of(self.problem)) / self.unit

    @property
    def asymptotics(self) -> tuple[tuple[AsymptoticPencil, int], ...]:
        return tuple((pencil.rescaled(self.unit), k) for pencil, k in ASYMPTOTICS.of(self.problem))

    @property
    def continuum(self) -> RescaledContinuum | None:
        curve = INTERIOR.of(self.problem)
        return None if curve is None else RescaledContinuum(curve, self.unit)

    @property
    def crossings(self) -> tuple[tuple[NDArray[np.float64], ComplexArray], ...]:
        """(z, σ_c(z)/unit), each (m,)."""
        return tuple((z, sigma / self.unit) for z, sigma in CROSSINGS.of(self.problem))

    @property
    def knots(self) -> NDArray[np.float64] | None:
        """The knots (k,) of the problem, which a unit of σ does not move."""
        known: NDArray[np.float64] | None = KNOTS.of(self.problem)
        return known

    @property
    def farther_walls(self) -> Rescaled | None:
        farther = FARTHER_WALLS.of(self.problem)
        return None if farther is None else Rescaled(farther, self.unit)

    @property
    def unknowns(self) -> Unknowns | None:
        own: Unknowns | None = UNKNOWNS.of(self.problem)
        return None if own is None else own.in_units_of(self.unit)

    @property
    def placements(self) -> tuple[Placement, ...]:
        return placements(self.problem)

    @property
    def mode_shape(self) -> Shape | None:
        found: Shape | None = MODE_SHAPE.of(self.problem)
        return found
