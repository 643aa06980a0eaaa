"""The parameters of a chute, checked once, where they enter."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, fields
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from shootstab.models.chute import constitutive as law
from shootstab.models.chute.registry import BY_NAME, CHUTE, names


@dataclass(frozen=True)
class Chute:
    """Grains and base.

    e, e_w: restitution between grains, and of a grain with the base; r: roughness of the base; tan_theta: slope;
    nu_max: ν_m of g0; radial: the radial distribution, 'lun-savage' or 'carnahan-starling'; wall: 'printed' leaves
    −½A r² ∂v/∂y out of S_z, as (A 14) does, 'isotropic' keeps it. Ranges and defaults stand in the registry. Raises InputError.
    """

    e: float
    e_w: float
    r: float
    tan_theta: float
    nu_max: float = BY_NAME["nu_max"].default
    radial: str = BY_NAME["radial"].default
    wall: str = BY_NAME["wall"].default

    def __post_init__(self) -> None:
        for name in names(CHUTE):
            BY_NAME[name].check(getattr(self, name))

    @property
    def ep(self) -> float:
        """η_p = (1 + e)/2."""
        return (1 + self.e) / 2

    @property
    def radial_law(self) -> tuple[Any, ...]:
        """g0 as one object, which only `constitutive.radial` and `constitutive.densest` look into."""
        return (law.RADIAL_DISTRIBUTIONS[self.radial], *(getattr(self, name) for name in law.RADIAL_PARAMETERS))

    def wall_dissipation(self, pi: Any) -> Any:
        """Δ of (A 18), with π in whatever arithmetic the parameters are."""
        return law.wall_dissipation(self.r, self.e_w, pi)

    @cached_property
    def numbers(self) -> NDArray[np.float64]:
        """Numbers (m,) as kernels take them: η_p, tanθ, r, Δ, and those of radial_law."""
        return np.array([self.ep, self.tan_theta, self.r, self.wall_dissipation(math.pi), *self.radial_law])

    def with_numbers(self, change: Callable[[Any], Any]) -> Chute:
        """The chute with every number among its parameters changed, in the order of the registry.

        They were checked as numbers of Python; what they are changed to need not be one, a ball for instance, and is not checked again.
        """
        told = {field.name: getattr(self, field.name) for field in fields(self)}
        made = object.__new__(type(self))
        made.__dict__.update(told | {name: change(told[name]) for name in names(CHUTE, numbers=True)})
        return made
