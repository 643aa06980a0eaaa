"""A half-annulus of the σ-plane: what grows and is neither near to a point nor far from it, as where a continuous spectrum ends."""

from __future__ import annotations

import cmath
import math
from dataclasses import dataclass
from typing import Any

from shootstab.core.errors import InputError, shortened
from shootstab.core.given import is_complex, is_real
from shootstab.core.regions import SIDES

QUARTER = math.pi / 2  # exact


@dataclass(frozen=True)
class HalfAnnulus:
    """inner < |σ − centre| < outer, Re σ > Re centre."""

    centre: complex
    inner: float
    outer: float

    def __post_init__(self) -> None:
        if not (is_complex(self.centre) and is_real(self.inner) and is_real(self.outer) and 0.0 < self.inner < self.outer):
            told = f"half-annulus about {shortened(self.centre)} from {shortened(self.inner)} to {shortened(self.outer)}"
            raise InputError(f"{told}: allowed are finite numbers, the radii above 0 and the smaller one first")

    @property
    def corners(self) -> tuple[float, ...]:
        return (0.0, 0.25, 0.5, 0.75, 1.0)

    @property
    def hull(self) -> tuple[complex, ...]:
        reach = self.outer / math.cos(QUARTER / SIDES)
        return (
            self.centre - 1j * reach,
            *(self.centre + cmath.rect(reach, QUARTER * (2 * k / SIDES - 1)) for k in range(1, SIDES)),
            self.centre + 1j * reach,
        )

    def boundary(self, t: float) -> complex:
        """Along the outer arc, down the upper ray, back along the inner arc and down the lower ray, a quarter of t each."""
        side = min(int(4 * t), 3)
        x = 4 * t - side
        if side in (0, 2):
            angle = QUARTER * (2 * x - 1)
            return self.centre + (cmath.rect(self.outer, angle) if side == 0 else cmath.rect(self.inner, -angle))
        ratio = self.inner / self.outer
        return complex(self.centre + (1j * self.outer * ratio**x if side == 1 else -1j * self.inner / ratio**x))

    def parameter(self, sigma: complex) -> float:
        away = sigma - self.centre
        size, angle = min(max(abs(away), self.inner), self.outer), min(max(cmath.phase(away), -QUARTER), QUARTER)
        fallen = math.log(self.outer / size) / math.log(self.outer / self.inner)
        on = (
            (angle / QUARTER + 1) / 8,
            0.25 + fallen / 4,
            0.5 + (1 - angle / QUARTER) / 8,
            (0.75 + (1 - fallen) / 4) % 1.0,
        )
        return min(on, key=lambda t: abs(self.boundary(t) - sigma))

    def contains(self, sigma: complex) -> bool:
        away = sigma - self.centre
        return away.real > 0.0 and self.inner < abs(away) < self.outer

    def as_dict(self) -> dict[str, Any]:
        centre = {"re": str(complex(self.centre).real), "im": str(complex(self.centre).imag)}
        return {"shape": "half-annulus", "centre": centre, "inner": self.inner, "outer": self.outer}
