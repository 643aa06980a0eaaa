"""Regions of the σ-plane, each with a closed boundary run through counter-clockwise for t from 0 to 1."""

from __future__ import annotations

import cmath
import math
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any, Protocol, runtime_checkable

from shootstab.core.errors import InputError, shortened
from shootstab.core.given import is_complex, is_real

SIDES = 12  # chosen: sides of the polygon that stands for the hull of a disc


@runtime_checkable
class Region(Protocol):
    """A bounded part of the σ-plane."""

    @property
    def corners(self) -> tuple[float, ...]:
        """The values of t, from 0 to 1, at which the boundary is not smooth."""
        ...

    @property
    def hull(self) -> tuple[complex, ...]:
        """The corners of a convex polygon that holds the region, counter-clockwise."""
        ...

    def boundary(self, t: float) -> complex:
        """The boundary point at t in [0, 1]."""
        ...

    def parameter(self, sigma: complex) -> float:
        """The t of the boundary point nearest to sigma."""
        ...

    def contains(self, sigma: complex) -> bool:
        """Whether sigma lies inside."""
        ...

    def as_dict(self) -> dict[str, Any]:
        """The region by its kind and its points, for JSON."""
        ...


@dataclass(frozen=True)
class Disc:
    """|σ − centre| < radius."""

    centre: complex
    radius: float

    def __post_init__(self) -> None:
        if not (is_complex(self.centre) and is_real(self.radius) and self.radius > 0.0):
            told = f"disc with centre {shortened(self.centre)} and radius {shortened(self.radius)}"
            raise InputError(f"{told}: allowed are finite numbers, the radius above 0")

    @property
    def corners(self) -> tuple[float, ...]:
        return (0.0, 1.0)

    @property
    def hull(self) -> tuple[complex, ...]:
        reach = self.radius / math.cos(math.pi / SIDES)
        return tuple(self.centre + cmath.rect(reach, 2 * math.pi * k / SIDES) for k in range(SIDES))

    def boundary(self, t: float) -> complex:
        return self.centre + self.radius * cmath.exp(2j * math.pi * t)

    def parameter(self, sigma: complex) -> float:
        return (cmath.phase(sigma - self.centre) / (2 * math.pi)) % 1.0

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
        a, b = self.lower_left, self.upper_right
        if not (is_complex(a) and is_complex(b) and a.real < b.real and a.imag < b.imag):
            told = f"rectangle from {shortened(a)} to {shortened(b)}"
            raise InputError(f"{told}: allowed are finite corners, lower left first, upper right second")

    @property
    def vertices(self) -> tuple[complex, ...]:
        """The four corners, counter-clockwise from the lower left."""
        a, b = complex(self.lower_left), complex(self.upper_right)
        return a, complex(b.real, a.imag), b, complex(a.real, b.imag)

    @property
    def corners(self) -> tuple[float, ...]:
        return (0.0, 0.25, 0.5, 0.75, 1.0)

    @property
    def hull(self) -> tuple[complex, ...]:
        return self.vertices

    def boundary(self, t: float) -> complex:
        return _along(self.vertices, t)

    def parameter(self, sigma: complex) -> float:
        return _nearest(self.vertices, sigma)

    def contains(self, sigma: complex) -> bool:
        a, b = complex(self.lower_left), complex(self.upper_right)
        return a.real < sigma.real < b.real and a.imag < sigma.imag < b.imag

    def as_dict(self) -> dict[str, Any]:
        corners = [{"re": str(c.real), "im": str(c.imag)} for c in (complex(self.lower_left), complex(self.upper_right))]
        return {"shape": "rectangle", "corners": corners}


@dataclass(frozen=True)
class Polygon:
    """The inside of a closed polygon that does not cross itself, its vertices in counter-clockwise or clockwise order."""

    points: tuple[complex, ...]

    def __post_init__(self) -> None:
        if not isinstance(self.points, Iterable) or not all(map(is_complex, self.points)):
            raise InputError(f"polygon {shortened(self.points)}: allowed are finite numbers as corners")
        points = tuple(complex(p) for p in self.points)
        if len(points) < 3 or _area(points) == 0.0:
            raise InputError(f"polygon {points}: allowed are three or more finite corners that are not on one line")
        object.__setattr__(self, "points", points if _area(points) > 0.0 else points[::-1])

    @property
    def vertices(self) -> tuple[complex, ...]:
        """The corners, counter-clockwise."""
        return self.points

    @property
    def corners(self) -> tuple[float, ...]:
        return tuple(i / len(self.points) for i in range(len(self.points) + 1))

    @property
    def hull(self) -> tuple[complex, ...]:
        return convex_hull(self.points)

    def boundary(self, t: float) -> complex:
        return _along(self.points, t)

    def parameter(self, sigma: complex) -> float:
        return _nearest(self.points, sigma)

    def contains(self, sigma: complex) -> bool:
        inside = False
        for p, q in zip(self.points, self.points[1:] + self.points[:1], strict=True):
            crosses = (p.imag > sigma.imag) != (q.imag > sigma.imag)
            if crosses and sigma.real < p.real + (q.real - p.real) * (sigma.imag - p.imag) / (q.imag - p.imag):
                inside = not inside
        return inside

    def as_dict(self) -> dict[str, Any]:
        return {"shape": "polygon", "corners": [{"re": str(c.real), "im": str(c.imag)} for c in self.points]}


def _along(vertices: tuple[complex, ...], t: float) -> complex:
    """The point at t on a closed polygon, every side taking the same share of t."""
    sides = len(vertices)
    side = min(int(sides * t), sides - 1)
    start, end = vertices[side], vertices[(side + 1) % sides]
    return start + (sides * t - side) * (end - start)


def _nearest(vertices: tuple[complex, ...], sigma: complex) -> float:
    """The t of the point of a closed polygon nearest to sigma."""
    best, where = math.inf, 0.0
    for side, start in enumerate(vertices):
        edge = vertices[(side + 1) % len(vertices)] - start
        s = min(1.0, max(0.0, ((sigma - start) * edge.conjugate()).real / abs(edge) ** 2))
        off = abs(sigma - start - s * edge)
        if off < best:
            best, where = off, (side + s) / len(vertices)
    return where


def _area(points: tuple[complex, ...]) -> float:
    """Twice the signed area, from the first corner: far from the origin a small one must not vanish."""
    sides = [p - points[0] for p in points]
    return sum((p.conjugate() * q).imag for p, q in zip(sides, sides[1:] + sides[:1], strict=True))


def require_region(region: Any) -> None:
    """Raise InputError unless this is a region."""
    if not isinstance(region, Region) or isinstance(region, type):
        raise InputError(f"region = {shortened(region)}: allowed is a Disc, a Rectangle or a Polygon")


def size(region: Region) -> float:
    """The diameter of the hull."""
    vertices = region.hull
    return max(abs(p - q) for p in vertices for q in vertices)


def convex_hull(points: tuple[complex, ...]) -> tuple[complex, ...]:
    """The convex hull, counter-clockwise, by Andrew's monotone chain."""

    def chain(ordered: list[complex]) -> list[complex]:
        out: list[complex] = []
        for p in ordered:
            while len(out) > 1 and ((out[-1] - out[-2]).conjugate() * (p - out[-2])).imag <= 0.0:
                out.pop()
            out.append(p)
        return out[:-1]

    ordered = sorted(set(points), key=lambda p: (p.real, p.imag))
    if len(ordered) == 1:
        return tuple(ordered)
    return tuple(chain(ordered) + chain(ordered[::-1]))
