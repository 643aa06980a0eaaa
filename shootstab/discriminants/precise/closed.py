"""Problems in closed form to any number of digits: the formulas of problems.closed.ClosedForm, evaluated on power series."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from shootstab.discriminants.precise.arithmetic import Arithmetic, Matrix, exact, simplified
from shootstab.discriminants.precise.protocol import Base, Entries, Expansion, Tick
from shootstab.discriminants.precise.settings import Settings
from shootstab.discriminants.precise.taylor import Taylor, real_series
from shootstab.problems.closed import ClosedForm


class ClosedFormulation:
    """See protocol.Formulation."""

    real = False

    def __init__(self, problem: ClosedForm) -> None:
        self._problem = problem
        self.size = problem.size

    def base(self, ring: Arithmetic, settings: Settings, tick: Tick) -> Base:
        return ()

    def course(self, ring: Arithmetic, settings: Settings, base: Base) -> ClosedCourse:
        return ClosedCourse(ring, self._problem, settings)


class ClosedCourse:
    """See protocol.Course."""

    def __init__(self, ring: Arithmetic, problem: ClosedForm, settings: Settings) -> None:
        self._ring, self._problem, self._settings = ring, problem, settings
        self._z, self._wall = (self._real(end) for end in problem.exact_ends(self._exact))
        self._step = (self._wall - self._z) / settings.order  # a first trial; steps double from there

    def _exact(self, x: float) -> Any:
        return self._ring.complex(exact(x))

    def _real(self, x: Any) -> Any:
        return simplified(self._ring, x)

    def launch(self, sigma: Any) -> None:
        """The far end is where the problem says."""

    def far_frame(self, sigma: Any) -> tuple[Matrix, Any]:
        return self._matrix(self._problem.exact_far(sigma, self._exact)), self._ring.number(1)

    def expand(self, longest: float) -> Expansion:
        ring = self._ring
        left = self._wall - self._z
        first = ring.log2(self._step)
        at_wall = ring.log2(left) <= min(first, _log2(longest))
        inside = self._step if first <= _log2(longest) else ring.number(longest) * (1 if left > 0 else -1)
        h = left if at_wall else inside
        self._h = h
        z = real_series(ring, [self._z, h] + [ring.number(0)] * (self._settings.order - 2))
        C0, C1, D0, D1 = (self._entries(part, z) for part in self._problem.exact_pencil(z, self._exact))
        return Expansion(h, C0, C1, D0, D1, at_wall)

    def advance(self) -> None:
        self._z = self._ring.rounded(self._z + self._h)
        self._step = 2 * self._h

    def wall_rows(self) -> tuple[Matrix, Matrix]:
        W0, W1 = self._problem.exact_wall(self._exact)
        return self._matrix(W0), self._matrix(W1)

    def asked(self) -> Base:
        return ()

    def _entries(self, part: Mapping[tuple[int, int], Any], z: Taylor) -> Entries:
        return {at: e if isinstance(e, Taylor) else 0 * z + e for at, e in part.items()}

    def _matrix(self, rows: Sequence[Sequence[Any]]) -> Matrix:
        return [[simplified(self._ring, x) for x in row] for row in rows]


def _log2(x: float) -> float:
    from math import inf, log2

    return log2(x) if x < inf else inf
