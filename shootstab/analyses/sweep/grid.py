"""The points of a sweep: axes, the grid that they span, and its lines, along which a mode can be followed."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise, product
from typing import Any

from shootstab.core.errors import InputError
from shootstab.problems.capabilities import Family

LONGEST_LINE = 64  # chosen: points of a line: what one worker takes at a time, and what an interruption may cost each
MOST_GRID_POINTS = 10_000_000  # chosen: points of a sweep, some days of work; more are a slip of the pen

Point = tuple[float, ...]  # the values of the axes, in their order


@dataclass(frozen=True)
class ParameterAxis:
    """One parameter and the values that it takes, rising or falling."""

    name: str
    values: tuple[float, ...]

    @classmethod
    def of(cls, name: str, values: Any) -> ParameterAxis:
        """The axis of one number or of a sequence of numbers. Raises InputError unless they are finite, different, and in order."""
        try:
            numbers = tuple(float(v) + 0.0 for v in (values if hasattr(values, "__iter__") else (values,)))
        except (TypeError, ValueError):
            raise InputError(f"{name} = {values!r}: allowed is a number or a sequence of numbers") from None
        if not numbers or not all(math.isfinite(v) for v in numbers):
            raise InputError(f"{name} = {values!r}: allowed are finite numbers, one at least")
        steps = [b - a for a, b in pairwise(numbers)]
        if not (all(s > 0 for s in steps) or all(s < 0 for s in steps)):
            raise InputError(f"{name}: allowed are values that only rise or only fall")
        return cls(name, numbers)


@dataclass(frozen=True)
class GridLine:
    """Points that differ in one parameter alone, and rise or fall in it."""

    along: str
    names: tuple[str, ...]
    points: tuple[Point, ...]

    def values(self, place: float) -> dict[str, float]:
        """The parameters at a place on the line: i at its i-th point, linear between them."""
        i = min(int(place), len(self.points) - 1)
        here = dict(zip(self.names, self.points[i], strict=True))
        if place > i:
            ahead = self.points[i + 1][self.names.index(self.along)]
            here[self.along] += (place - i) * (ahead - here[self.along])
        return here


@dataclass(frozen=True)
class SweepGrid:
    """The product of the axes; sharing names those along which the base flow is the same."""

    axes: tuple[ParameterAxis, ...]
    sharing: tuple[str, ...] = ()

    @classmethod
    def of(cls, axes: Mapping[str, Any], family: Family) -> SweepGrid:
        """The grid of values by name. Raises InputError for values that no member can have, and for more than MOST_GRID_POINTS points."""
        grid = cls(tuple(ParameterAxis.of(name, values) for name, values in axes.items()), family.sharing)
        if not grid.axes:
            raise InputError("nothing to sweep over: needed is one parameter at least")
        if len(grid) > MOST_GRID_POINTS:
            raise InputError(f"{len(grid)} points: allowed are up to {MOST_GRID_POINTS}")
        for axis in grid.axes:
            for value in axis.values:
                family.checked({axis.name: value})
        return grid

    def __len__(self) -> int:
        return math.prod(len(axis.values) for axis in self.axes)

    @property
    def names(self) -> tuple[str, ...]:
        """The parameters, in the order of the axes."""
        return tuple(axis.name for axis in self.axes)

    @property
    def points(self) -> list[Point]:
        """All points, the last axis running fastest."""
        return list(product(*(axis.values for axis in self.axes)))

    def lines(self, done: Sequence[Point] = ()) -> list[GridLine]:
        """Lines of at most LONGEST_LINE points, those that are done wholly left out.

        They run along a wavenumber where one varies, so that all points of a line share their steady flow: along the longest such axis.
        The cuts do not depend on what is done: a line is walked from its first point on, and another first point would be another walk.
        """
        along = self._along
        k = self.names.index(along)
        known, lines = set(done), []
        for others in product(*(axis.values if axis.name != along else (math.nan,) for axis in self.axes)):
            run = [(*others[:k], v, *others[k + 1 :]) for v in self.axes[k].values]
            cuts = -(-len(run) // LONGEST_LINE)
            for i in range(cuts):
                points = tuple(run[i * len(run) // cuts : (i + 1) * len(run) // cuts])
                if not known.issuperset(points):
                    lines.append(GridLine(along, self.names, points))
        return lines

    @property
    def _along(self) -> str:
        waves = [axis for axis in self.axes if axis.name in self.sharing and len(axis.values) > 1]
        return max(waves or self.axes, key=lambda axis: len(axis.values)).name
