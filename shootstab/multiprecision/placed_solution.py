"""A solution to many digits whose subdomains are integrated at once: over the user's z, each in its own part of the line."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Protocol

from shootstab.core.errors import InputError
from shootstab.multiprecision.arithmetic import Arithmetic, Matrix
from shootstab.multiprecision.taylor_solution import OUTSIDE_DIGITS, TaylorSolution


class LinePart(Protocol):
    """One subdomain, z = begin + way·t for 0 ≤ t ≤ 1, and what is known of its solutions beyond its beginning."""

    @property
    def begin(self) -> Any:
        """The z at which it begins."""
        ...

    @property
    def way(self) -> Any:
        """The way from there to where it arrives."""
        ...

    @property
    def farthest(self) -> float:
        """How far beyond its beginning its solutions are known."""
        ...

    def farther(self, sigma: Any, c: Matrix, place: Any, distance: Any) -> Mapping[str, Any]:
        """The unknowns by name at a place so far beyond the beginning, of the combination c (k, 1) of all solutions that are begun with."""
        ...


@dataclass(frozen=True, eq=False)
class PlacedSolution:
    """The solution along t, with unknowns of part j by names behind `j `, and the combination c (k, 1) of solutions at its beginning."""

    along: TaylorSolution
    parts: Sequence[LinePart]
    c: Matrix

    @property
    def arithmetic(self) -> Arithmetic:
        """The arithmetic."""
        return self.along.arithmetic

    @property
    def names(self) -> tuple[str, ...]:
        """The unknowns."""
        return tuple(name.partition(" ")[2] for name in self.along.names if name.startswith("0 "))

    @property
    def nodes(self) -> list[Any]:
        """The places of the steps, part after part."""
        return [part.begin + part.way * t for part in self.parts for t in self.along.z]

    @property
    def outer(self) -> list[Any]:
        """Places beyond the beginnings, where something is known there."""
        known = [(part, min(part.farthest, abs(self._number(part.way)))) for part in self.parts if part.farthest > 0.0]
        return [part.begin - self._outwards(part) * self.arithmetic.number(reach / 2) for part, reach in known]

    @property
    def ends(self) -> tuple[float, float]:
        """The lowest and the highest z of the integration."""
        places = [self._number(z) for part in self.parts for z in (part.begin, part.begin + part.way)]
        return min(places), max(places)

    @property
    def extent(self) -> tuple[float, float]:
        """The lowest and the highest z at which something is known."""
        outer = [self._number(part.begin) - self._outwards(part) * part.farthest for part in self.parts]
        low, high = self.ends
        return min(low, *outer), max(high, *outer)

    def __call__(self, z: Any) -> dict[str, Any]:
        """The unknowns by name at one place, a number of the arithmetic. Raises InputError for one outside the domain."""
        slack = OUTSIDE_DIGITS * (self.ends[1] - self.ends[0])
        place = self._number(z)
        for j, part in enumerate(self.parts):
            low, high = sorted((self._number(part.begin), self._number(part.begin + part.way)))
            if low - slack <= place <= high + slack:
                found = self.along.at((z - part.begin) / part.way, f"{j} ")
                return {name.partition(" ")[2]: value for name, value in found.items()}
        for part in self.parts:
            distance = (part.begin - z) * self._outwards(part)
            if 0.0 < self._number(distance) <= part.farthest + slack:
                return dict(part.farther(self.along.sigma, self.c, z, distance))
        low, high = self.extent
        raise InputError(f"z = {place:g}: allowed is z from {low:.6g} to {high:.6g}")

    def _outwards(self, part: LinePart) -> int:
        """1 where z rises from the beginning of the part."""
        return 1 if self._number(part.way) > 0.0 else -1

    def _number(self, z: Any) -> float:
        return float(self.arithmetic.to_mpmath(z))
