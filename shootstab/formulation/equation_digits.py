"""Problems in equations to any number of digits: the same expressions, evaluated on power series in the arithmetic at work.

See multiprecision.integration. From a regular singular end the integration starts with the regular
solutions; between two ends with conditions with the solutions that the conditions at one of them leave,
or, where σ occurs at both, with all of them beside their starting values (problems.subdomains: the augmented state).
"""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction
from typing import Any

import mpmath

from shootstab.core.progress import StepDone
from shootstab.formulation.base_digits import FlowDigits, FlowSeries
from shootstab.formulation.evaluation import Evaluator
from shootstab.formulation.expression import Expression
from shootstab.formulation.null_space import null_space
from shootstab.formulation.regular_digits import RegularStart
from shootstab.formulation.series_digits import BaseFields, on_numbers, on_series
from shootstab.formulation.shown_in_digits import Shown, rows_of, shown_at
from shootstab.formulation.state_pencil import Powers, StatePencil
from shootstab.multiprecision.arithmetic import Arithmetic, Matrix
from shootstab.multiprecision.integration import BaseFlowNumbers, Expansion, UnknownRows
from shootstab.multiprecision.linear_step import TaylorEntries
from shootstab.multiprecision.settings import Settings
from shootstab.multiprecision.small_matrices import product
from shootstab.multiprecision.taylor import Taylor, real_series
from shootstab.multiprecision.taylor_solution import OUTSIDE_DIGITS


class EquationDigits:
    """See multiprecision.integration.MultiprecisionProblem: a system between two finite ends, without given functions."""

    real = False

    def __init__(
        self,
        system: StatePencil,
        ends: tuple[Fraction, Fraction],
        shown: Shown,
        start: RegularStart | None = None,
        backwards: bool = False,
        flow: FlowDigits | None = None,
    ) -> None:
        """start: the regular solutions with which the integration begins at the left end, or backwards at the right one."""
        left, right = ends
        self._system, self._shown, self._start, self._flow = system, shown, start, flow
        self._augmented = start is None and any(system.left[1:]) and any(system.right[1:])
        self._backwards = backwards if start is not None else any(system.left[1:]) and not self._augmented
        self._ends = (right, left) if self._backwards else (left, right)
        self.size = system.size * (1 + self._augmented)

    def base(self, arithmetic: Arithmetic, settings: Settings, progress: StepDone) -> BaseFlowNumbers:
        return () if self._flow is None else self._flow.base(arithmetic, settings, progress)

    def integration(self, arithmetic: Arithmetic, settings: Settings, base: BaseFlowNumbers) -> EquationIntegration:
        flow = None if self._flow is None else self._flow.series(arithmetic, settings, base)
        return EquationIntegration(
            arithmetic, settings, self._system, self._shown, self._ends, self._backwards, self._augmented, self._start, flow
        )


class EquationIntegration:
    """See multiprecision.integration.Integration."""

    def __init__(
        self,
        arithmetic: Arithmetic,
        settings: Settings,
        system: StatePencil,
        shown: Shown,
        ends: tuple[Fraction, Fraction],
        backwards: bool,
        augmented: bool,
        start: RegularStart | None,
        flow: FlowSeries | None,
    ) -> None:
        self._flow = flow
        self._arithmetic, self._settings, self._system, self._augmented = arithmetic, settings, system, augmented
        self._shown = shown
        self._regular = start
        self._singular, self._direction = ends[0], 1 if ends[1] > ends[0] else -1
        if start is not None:
            ends = (ends[0] + self._direction * start.reach(settings), ends[1])
        self._z, self.wall = (arithmetic.number(end) for end in ends)
        self._step = (self.wall - self._z) / settings.order  # a first trial; steps double from there
        sides = [(system.left, system.left_rows), (system.right, system.right_rows)]
        self._start_rows, self._wall_rows = [
            self._rows(*side, z) for side, z in zip(sides[::-1] if backwards else sides, ends, strict=True)
        ]

    def begin(self, sigma: Any) -> None:
        """The start is an end of the problem."""

    def far_frame(self, sigma: Any) -> tuple[Matrix, Any]:
        one, n = self._arithmetic.number(1), self._system.size
        if self._regular is not None:
            return self._regular.frame(self._arithmetic, self._settings, sigma), one
        if self._augmented:
            identity = [[self._arithmetic.number(int(i == j)) for j in range(n)] for i in range(n)]
            return [*identity, *[list(row) for row in identity]], one
        return null_space(self._arithmetic, self._start_rows[0], n), one

    def expand(self, longest: float) -> Expansion:
        arithmetic = self._arithmetic
        left = self.wall - self._z
        first, limit = arithmetic.log2(self._step), float(mpmath.log(longest, 2)) if longest < float("inf") else float("inf")
        at_wall = arithmetic.log2(left) <= min(first, limit)
        inside = self._step if first <= limit else arithmetic.number(longest) * (1 if left > 0 else -1)
        h = left if at_wall else inside
        self._h = h
        z = self._along()
        at = on_series(arithmetic, z, fields=self._fields(z))
        C, D = ([self._entries(part, z, at) for part in powers] for powers in (self._system.C, self._system.D))
        if self._augmented:
            one = 0 * z + 1
            C[0] = {**C[0], **{(i, i): one for i in range(self._system.size)}}
        return Expansion(h, C, D, at_wall)

    def advance(self, part: float) -> None:
        step = self._h * self._arithmetic.number(part)
        self._z = self._arithmetic.rounded(self._z + step)
        self._step = 2 * step

    def unknowns(self, sigma: Any) -> UnknownRows:
        """Each unknown as Σ r_j ψ_j / p."""
        shift = self._system.size if self._augmented else 0
        z = self._along()
        return rows_of(self._shown, on_series(self._arithmetic, z, sigma, self._fields(z)), shift)

    def _along(self) -> Taylor:
        """z along the last step."""
        arithmetic = self._arithmetic
        return real_series(arithmetic, [self._z, self._h] + [arithmetic.number(0)] * (self._settings.order - 2))

    @property
    def farthest(self) -> float:
        """The start is an end of the domain, or lies so far from a singular one."""
        return 0.0 if self._regular is None else float(self._regular.reach(self._settings))

    def farther(self, sigma: Any, c: Matrix, place: Any, distance: Any) -> Mapping[str, Any] | None:
        if self._regular is None or self._arithmetic.to_mpmath(distance) > self.farthest * (1.0 + OUTSIDE_DIGITS):
            return None
        away = (place - self._arithmetic.number(self._singular)) * self._direction
        frame, x = self._regular.nearer(self._arithmetic, self._settings, sigma, away)
        place = self._arithmetic.number(self._singular) + self._direction * x
        return shown_at(self._arithmetic, self._shown, place, sigma, product(self._arithmetic, frame, c))

    def wall_rows(self) -> list[Matrix]:
        if not self._augmented:
            return self._wall_rows
        nothing = [self._arithmetic.number(0)] * self._system.size
        starts, walls = self._start_rows, self._wall_rows
        return [
            [[*row, *nothing] for row in (starts[k] if k < len(starts) else [nothing] * len(starts[0]))]
            + [[*nothing, *row] for row in (walls[k] if k < len(walls) else [nothing] * len(walls[0]))]
            for k in range(max(len(starts), len(walls)))
        ]

    def corrected_base(self) -> BaseFlowNumbers:
        return () if self._flow is None else self._flow.corrected()

    def _fields(self, z: Taylor) -> BaseFields | None:
        return None if self._flow is None else self._flow.along(z)

    def _entries(self, part: Mapping[tuple[int, int], Expression], z: Taylor, at: Evaluator) -> TaylorEntries:
        shift = self._system.size if self._augmented else 0
        out: dict[tuple[int, int], Taylor] = {}
        for (i, j), entry in part.items():
            value = at(entry)
            out[i + shift, j + shift] = value if isinstance(value, Taylor) else 0 * z + value
        return out

    def _rows(self, parts: Powers, count: int, z: Fraction) -> list[Matrix]:
        place = self._arithmetic.number(z)
        at = on_numbers(self._arithmetic, place, None if self._flow is None else self._flow.at(place))
        nothing = self._arithmetic.number(0)
        return [[[at(part[i, j]) if (i, j) in part else nothing for j in range(self._system.size)] for i in range(count)] for part in parts]
