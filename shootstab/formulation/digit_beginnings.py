"""What the subdomains of a problem in equations begin with, to any number of digits.

They begin with the decaying space at infinity, with the regular solutions at a singular end, with the solutions that conditions leave at a
wall, and with all solutions beside their starting values between interfaces.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction
from typing import Any, Protocol

from shootstab.formulation.asymptotic_digits import AsymptoticSpaceInDigits
from shootstab.formulation.asymptotic_end import AsymptoticEnd
from shootstab.formulation.base_digits import FlowSeries
from shootstab.formulation.decaying_digits import DecayingSpaceInDigits, LogarithmsError
from shootstab.formulation.exponentials import ExponentialEnd
from shootstab.formulation.expression import Expression
from shootstab.formulation.null_space import null_space
from shootstab.formulation.regular_digits import RegularStart
from shootstab.formulation.series_digits import on_numbers
from shootstab.formulation.state_pencil import StatePencil
from shootstab.multiprecision.arithmetic import Arithmetic, Matrix
from shootstab.multiprecision.settings import Settings
from shootstab.multiprecision.small_matrices import product


class Beginning(Protocol):
    """How a subdomain begins, in one arithmetic."""

    @property
    def place(self) -> Fraction:
        """The z at which the subdomain begins."""
        ...

    def begin(self, sigma: Any) -> None:
        """Choose the place, so that the frame holds there at σ."""
        ...

    def frame(self, sigma: Any) -> tuple[Matrix, Any]:
        """The solutions (n, k) with which it begins, or (2n, n) beside their starting values, and the factor of their determinant."""
        ...

    @property
    def farthest(self) -> float:
        """How far beyond the place these solutions are known."""
        ...

    def beyond(self, sigma: Any, c: Matrix, place: Any, distance: Any) -> Matrix:
        """ψ (n, 1) of their combination c (k, 1), at a place so far beyond."""
        ...


class Begin(Protocol):
    """What a subdomain begins with, in any arithmetic."""

    def beginning(
        self, arithmetic: Arithmetic, settings: Settings, system: StatePencil, target: Fraction, flow: FlowSeries | None
    ) -> Beginning:
        """The beginning in one arithmetic, on a base flow."""
        ...


@dataclass(frozen=True, eq=False)
class AtInfinity:
    """An end at infinity at which so many solutions decay: by series in an exponential, or in inverse powers of the coordinate."""

    end: ExponentialEnd | None
    powers: AsymptoticEnd | None
    columns: int

    def beginning(
        self, arithmetic: Arithmetic, settings: Settings, system: StatePencil, target: Fraction, flow: FlowSeries | None
    ) -> Beginning:
        ways: list[Beginning] = []
        if self.end is not None:
            ways.append(DecayingSpaceInDigits(arithmetic, settings, self.end, system.size, self.columns, target, flow))
        if self.powers is not None:
            ways.append(AsymptoticSpaceInDigits(arithmetic, settings, self.powers, system, self.columns, target))
        return ways[0] if len(ways) == 1 else _FirstThatHolds(ways[0], ways[1])


class _FirstThatHolds:
    """See Beginning: the first of two, or the second where solutions of the first have logarithms."""

    def __init__(self, first: Beginning, second: Beginning) -> None:
        self._chosen, self._second = first, second

    @property
    def place(self) -> Fraction:
        return self._chosen.place

    def begin(self, sigma: Any) -> None:
        try:
            self._chosen.begin(sigma)
        except LogarithmsError:
            self._chosen = self._second
            self._chosen.begin(sigma)

    def frame(self, sigma: Any) -> tuple[Matrix, Any]:
        return self._chosen.frame(sigma)

    @property
    def farthest(self) -> float:
        return self._chosen.farthest

    def beyond(self, sigma: Any, c: Matrix, place: Any, distance: Any) -> Matrix:
        return self._chosen.beyond(sigma, c, place, distance)


@dataclass(frozen=True, eq=False)
class AtSingularEnd:
    """A regular singular end; the domain goes from it in this direction."""

    at: Fraction
    direction: int
    start: RegularStart

    def beginning(
        self, arithmetic: Arithmetic, settings: Settings, system: StatePencil, target: Fraction, flow: FlowSeries | None
    ) -> Beginning:
        return _NextToSingularEnd(arithmetic, settings, self)


@dataclass(frozen=True, eq=False)
class AtWall:
    """A place with so many conditions that do not hold the eigenvalue."""

    at: Fraction
    rows: Mapping[tuple[int, int], Expression]
    count: int

    def beginning(
        self, arithmetic: Arithmetic, settings: Settings, system: StatePencil, target: Fraction, flow: FlowSeries | None
    ) -> Beginning:
        place, nothing, n = arithmetic.number(self.at), arithmetic.number(0), system.size
        at = on_numbers(arithmetic, place, None if flow is None else flow.at(place))
        found = null_space(
            arithmetic, [[at(self.rows[i, j]) if (i, j) in self.rows else nothing for j in range(n)] for i in range(self.count)], n
        )
        return _FixedBeginning(self.at, lambda sigma: found, arithmetic.number(1))


@dataclass(frozen=True, eq=False)
class AugmentedBeginning:
    """A place at which all solutions begin, beside their starting values."""

    at: Fraction

    def beginning(
        self, arithmetic: Arithmetic, settings: Settings, system: StatePencil, target: Fraction, flow: FlowSeries | None
    ) -> Beginning:
        identity = [[arithmetic.number(int(i == j)) for j in range(system.size)] for i in range(system.size)]
        return _FixedBeginning(self.at, lambda sigma: [*identity, *[list(row) for row in identity]], arithmetic.number(1))


class _FixedBeginning:
    """See Beginning: one whose place does not depend on σ."""

    def __init__(self, place: Fraction, made: Any, factor: Any) -> None:
        self.place, self._made, self._factor = place, made, factor

    def begin(self, sigma: Any) -> None:
        """Nothing: this place does not depend on σ."""

    def frame(self, sigma: Any) -> tuple[Matrix, Any]:
        return self._made(sigma), self._factor

    farthest = 0.0

    def beyond(self, sigma: Any, c: Matrix, place: Any, distance: Any) -> Matrix:
        """Nothing is asked for: the place is an end of the domain, or an interface."""
        return []


class _NextToSingularEnd:
    """See Beginning: the regular solutions, known up to the end."""

    def __init__(self, arithmetic: Arithmetic, settings: Settings, end: AtSingularEnd) -> None:
        self._arithmetic, self._settings, self._start, self._end = arithmetic, settings, end.start, end
        self.place = end.at + end.direction * end.start.reach(settings)
        self.farthest = float(end.start.reach(settings))

    def begin(self, sigma: Any) -> None:
        """Nothing: this place does not depend on σ."""

    def frame(self, sigma: Any) -> tuple[Matrix, Any]:
        return self._start.frame(self._arithmetic, self._settings, sigma), self._arithmetic.number(1)

    def beyond(self, sigma: Any, c: Matrix, place: Any, distance: Any) -> Matrix:
        away = (place - self._arithmetic.number(self._end.at)) * self._end.direction
        frame, _ = self._start.nearer(self._arithmetic, self._settings, sigma, away)
        return product(self._arithmetic, frame, c)
