"""Regions of the σ-plane, each with a closed boundary run through counter-clockwise for t from 0 to 1."""

from __future__ import annotations

import cmath
import math
from dataclasses import dataclass
from typing import Any, Protocol

from shootstab.vocabulary.errors import InputError


class Region(Protocol):
    """A bounded part of the σ-plane."""

    @property
    def corners(self) -> tuple[float, ...]:
        """The values of t, from 0 to 1, at which the boundary is not smooth."""
        ...

    def boundary(self, t: float) -> complex:
        """The boundary point at t in [0, 1]."""
        ...

    def contains(self, sigma: complex) -> bool:
        """Whether sigma lies inside."""
        ...

    def as_dict(self) -> dict[str, Any]:
        """For JSON."""
        ...


@dataclass(frozen=True)
class Disc:
    """|σ − centre| < radius."""

    centre: complex
    radius: float

    def __post_init__(self) -> None:
        if not (cmath.isfinite(self.centre) and 0.0 < self.radius < math.inf):
            raise InputError(f"disc with centre {self.centre} and radius {self.radius}: allowed are finite numbers, the radius above 0")

    @property
    def corners(self) -> tuple[float, ...]:
        return (0.0, 1.0)

    def boundary(self, t: float) -> complex:
        return self.centre + self.radius * cmath.exp(2j * math.pi * t)

    def contains(self, sigma: complex) -> bool:
        return abs(sigma - self.centre) < self.radius

    def as_dict(self) -> dict[str, Any]:
        return {"shape": "disc", "centre": {"re": str(self.centre.real), "im": str(self.centre.imag)}, "radius": self.radius}


@dataclass(frozen=True)
class Rectangle:
    """The rectangle with these opposite corners, lower left and upper right."""

    lower_left: complex
    upper_right: complex

    def __post_init__(self) -> None:
        a, b = complex(self.lower_left), complex(self.upper_right)
        if not (cmath.isfinite(a) and cmath.isfinite(b) and a.real < b.real and a.imag < b.imag):
            raise InputError(f"rectangle from {a} to {b}: allowed are finite corners, lower left first, upper right second")

    @property
    def vertices(self) -> tuple[complex, ...]:
        """The four corners, counter-clockwise from the lower left."""
        a, b = complex(self.lower_left), complex(self.upper_right)
        return a, complex(b.real, a.imag), b, complex(a.real, b.imag)

    @property
    def corners(self) -> tuple[float, ...]:
        return (0.0, 0.25, 0.5, 0.75, 1.0)

    def boundary(self, t: float) -> complex:
        side = min(int(4 * t), 3)
        start, end = self.vertices[side], self.vertices[(side + 1) % 4]
        return start + (4 * t - side) * (end - start)

    def contains(self, sigma: complex) -> bool:
        a, b = complex(self.lower_left), complex(self.upper_right)
        return a.real < sigma.real < b.real and a.imag < sigma.imag < b.imag

    def as_dict(self) -> dict[str, Any]:
        corners = [{"re": str(c.real), "im": str(c.imag)} for c in (complex(self.lower_left), complex(self.upper_right))]
        return {"shape": "rectangle", "corners": corners}
