"""Problems in equations with an end at infinity, or two, to any number of digits: from each such end inwards, see decaying_digits.py.

With one the integration goes to the conditions at the other end. With two both sides go to a place between, each in its own z = z_start + t
(place − z_start), 0 ≤ t ≤ 1, as one system in blocks, where the solutions must be the same: D = det [Y_left, Y_right] but for its sign.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

from shootstab.core.errors import InputError
from shootstab.formulation.decaying_digits import DecayingSpace
from shootstab.formulation.exponentials import ExponentialEnd
from shootstab.formulation.expression import Expression
from shootstab.formulation.series_digits import on_numbers, on_series
from shootstab.formulation.state_pencil import Powers, StatePencil
from shootstab.multiprecision.arithmetic import Arithmetic, Matrix
from shootstab.multiprecision.integration import Base, Expansion, Progress, UnknownRows
from shootstab.multiprecision.settings import Settings
from shootstab.multiprecision.taylor import Taylor, real_series


@dataclass(frozen=True, eq=False)
class InfiniteSide:
    """An end at infinity with so many solutions that decay there."""

    end: ExponentialEnd
    columns: int


class LineDigits:
    """See multiprecision.integration.MultiprecisionProblem. target is where all sides arrive; rows the conditions there, with one side."""

    real = False

    def __init__(self, system: StatePencil, sides: Sequence[InfiniteSide], target: Fraction, rows: tuple[Powers, int]) -> None:
        self._system, self._sides, self._target, self._rows = system, sides, target, rows
        self.size = system.size * len(sides)

    def base(self, arithmetic: Arithmetic, settings: Settings, progress: Progress) -> Base:
        return ()

    def integration(self, arithmetic: Arithmetic, settings: Settings, base: Base) -> LineIntegration:
        return LineIntegration(arithmetic, settings, self._system, self._sides, self._target, self._rows)


class LineIntegration:
    """See multiprecision.integration.Integration."""

    def __init__(
        self,
        arithmetic: Arithmetic,
        settings: Settings,
        system: StatePencil,
        sides: Sequence[InfiniteSide],
        target: Fraction,
        rows: tuple[Powers, int],
    ) -> None:
        self._arithmetic, self._settings, self._system, self._target, self._rows = arithmetic, settings, system, target, rows
        self._spaces = [DecayingSpace(arithmetic, settings, side.end, system.size, side.columns, target) for side in sides]
        self._t = arithmetic.number(0)
        self._step = arithmetic.number(1) / settings.order  # a first trial; steps double from there

    def begin(self, sigma: Any) -> None:
        for space in self._spaces:
            space.begin(sigma)

    def far_frame(self, sigma: Any) -> tuple[Matrix, Any]:
        whole: Matrix = []
        factor: Any = self._arithmetic.number(1)
        found = [space.frame(sigma) for space in self._spaces]
        width, before = sum(len(frame[0]) for frame, _ in found), 0
        for frame, own in found:
            for row in frame:
                after = width - before - len(row)
                whole.append([*[self._arithmetic.number(0)] * before, *row, *[self._arithmetic.number(0)] * after])
            before += len(frame[0])
            factor = factor * own
        return whole, self._arithmetic.rounded(factor)

    def expand(self, longest: float) -> Expansion:
        arithmetic = self._arithmetic
        left = 1 - self._t
        limit = arithmetic.number(longest) if longest < 1.0 else left
        h = min((self._step, limit, left), key=arithmetic.log2)
        self._h = h
        C: list[dict[tuple[int, int], Taylor]] = [{} for _ in self._system.C]
        D: list[dict[tuple[int, int], Taylor]] = [{} for _ in self._system.D]
        for number, space in enumerate(self._spaces):
            way = arithmetic.number(self._target - space.place)
            begin = arithmetic.number(space.place) + way * self._t
            z = real_series(arithmetic, [begin, way * h] + [arithmetic.number(0)] * (self._settings.order - 2))
            at, shift = on_series(arithmetic, z), number * self._system.size
            for out, parts, factor in ((C, self._system.C, 1), (D, self._system.D, way)):
                for whole, part in zip(out, parts, strict=True):
                    whole.update({(i + shift, j + shift): factor * e for (i, j), e in self._evaluated(part, at, z).items()})
        return Expansion(h, C, D, arithmetic.log2(left - h) == float("-inf"))

    def advance(self) -> None:
        self._t = self._arithmetic.rounded(self._t + self._h)
        self._step = 2 * self._h

    def unknowns(self, sigma: Any) -> UnknownRows:
        raise InputError("an eigenfunction in many digits is not offered with an end at infinity: allowed are finite ends, or doubles")

    def farther(self, sigma: Any, c: Matrix, distance: Any) -> None:
        """No solution is kept."""

    @property
    def wall(self) -> Any:
        """Where all sides arrive, in t."""
        return self._arithmetic.number(1)

    def wall_rows(self) -> list[Matrix]:
        arithmetic, n = self._arithmetic, self._system.size
        if len(self._spaces) == 2:
            return [
                [[arithmetic.number(int(i == j)) for j in range(n)] + [arithmetic.number(-int(i == j)) for j in range(n)] for i in range(n)]
            ]
        at = on_numbers(arithmetic, arithmetic.number(self._target))
        parts, count = self._rows
        nothing = arithmetic.number(0)
        return [[[at(part[i, j]) if (i, j) in part else nothing for j in range(n)] for i in range(count)] for part in parts]

    def corrected_base(self) -> Base:
        return ()

    def _evaluated(self, part: Mapping[tuple[int, int], Expression], at: Any, z: Taylor) -> dict[tuple[int, int], Taylor]:
        values = {place: at(entry) for place, entry in part.items()}
        return {place: value if isinstance(value, Taylor) else 0 * z + value for place, value in values.items()}
