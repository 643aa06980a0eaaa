"""The parameters of a chute, checked once, where they enter."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from shootstab.core.errors import InputError
from shootstab.models.chute import constitutive as law

RADIAL = tuple(law.RADIAL_DISTRIBUTIONS)
WALLS = ("printed", "isotropic")


@dataclass(frozen=True)
class Chute:
    """Grains and base.

    e, e_w: restitution between grains, and of a grain with the base; r: roughness of the base; tan_theta: slope;
    nu_max: ν_m of g0; radial: the radial distribution, 'lun-savage' or 'carnahan-starling'; wall: 'printed' leaves
    −½A r² ∂v/∂y out of S_z, as (A 14) does, 'isotropic' keeps it.
    """

    e: float
    e_w: float
    r: float
    tan_theta: float
    nu_max: float = 0.62
    radial: str = "lun-savage"
    wall: str = "printed"

    def __post_init__(self) -> None:
        _require("e", self.e, 0.0 < self.e <= 1.0, "a number with 0 < e <= 1")
        _require("e_w", self.e_w, 0.0 < self.e_w <= 1.0, "a number with 0 < e_w <= 1")
        _require("r", self.r, 0.0 <= self.r < 1.0, "a number with 0 <= r < 1")
        _require("tan_theta", self.tan_theta, 0.0 < self.tan_theta < math.inf, "a finite number above 0")
        _require("nu_max", self.nu_max, 0.0 < self.nu_max < 1.0, "a number with 0 < nu_max < 1")
        if self.radial not in RADIAL:
            raise InputError(f"radial = {self.radial!r}: allowed is one of {', '.join(RADIAL)}")
        if self.wall not in WALLS:
            raise InputError(f"wall = {self.wall!r}: allowed is one of {', '.join(WALLS)}")

    @property
    def ep(self) -> float:
        """η_p = (1 + e)/2."""
        return (1 + self.e) / 2

    @property
    def model(self) -> int:
        """The radial distribution as the number that kernels know it by."""
        return law.RADIAL_DISTRIBUTIONS[self.radial]

    @cached_property
    def numbers(self) -> NDArray[np.float64]:
        """(η_p, tanθ, ν_m, model, r, Δ), as kernels take them."""
        delta = law.wall_dissipation(self.r, self.e_w, math.pi)
        return np.array([self.ep, self.tan_theta, self.nu_max, self.model, self.r, delta])

    @staticmethod
    def require_temperature(far_temperature: float) -> None:
        """Raise InputError unless T_∞ is a positive, finite number."""
        _require("far_temperature", far_temperature, 0.0 < far_temperature < math.inf, "a finite number above 0")


def _require(name: str, value: float, holds: bool, allowed: str) -> None:
    if not holds:
        raise InputError(f"{name} = {value!r}: allowed is {allowed}")
