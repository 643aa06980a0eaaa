"""Problems in closed form to any number of digits: the formulas of problems.closed.ClosedForm, evaluated on power series."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from fractions import Fraction
from typing import Any

import mpmath

from shootstab.core.errors import InputError
from shootstab.core.progress import StepDone
from shootstab.multiprecision.arithmetic import Arithmetic, Matrix, exact, simplified
from shootstab.multiprecision.integration import BaseFlowNumbers, Expansion, UnknownRows
from shootstab.multiprecision.linear_step import TaylorEntries
from shootstab.multiprecision.settings import Settings
from shootstab.multiprecision.taylor import Taylor, real_series
from shootstab.problems.capabilities import EXACT_UNKNOWNS
from shootstab.problems.closed_form import ClosedForm


class ClosedFormDigits:
    """See protocol.MultiprecisionProblem."""

    real = False

    def __init__(self, problem: ClosedForm) -> None:
        self._problem = problem
        self.size = problem.size

    def base(self, arithmetic: Arithmetic, settings: Settings, progress: StepDone) -> BaseFlowNumbers:
        return ()

    def integration(self, arithmetic: Arithmetic, settings: Settings, base: BaseFlowNumbers) -> ClosedFormIntegration:
        return ClosedFormIntegration(arithmetic, self._problem, settings)


class ClosedFormIntegration:
    """One way through a problem in closed form: see multiprecision.integration.Integration."""

    def __init__(self, arithmetic: Arithmetic, problem: ClosedForm, settings: Settings) -> None:
        self._arithmetic, self._problem, self._settings = arithmetic, problem, settings
        self._z, self.wall = (self._end(end) for end in problem.exact_ends(self._exact))
        self._step = (self.wall - self._z) / settings.order  # a first trial; steps double from there

    def _exact(self, x: float) -> Any:
        return self._arithmetic.complex(exact(x))

    def _end(self, z: Any) -> Any:
        """z as a real number: from the arithmetic itself, or as int, Fraction, mpf, or the decimal that a float stands for."""
        if isinstance(z, float):
            z = exact(z)
        return self._arithmetic.number(z) if isinstance(z, int | Fraction | mpmath.mpf) else simplified(self._arithmetic, z)

    def begin(self, sigma: Any) -> None:
        """The far end is where the problem says."""

    def far_frame(self, sigma: Any) -> tuple[Matrix, Any]:
        return self._matrix(self._problem.exact_far(sigma, self._exact)), self._arithmetic.number(1)

    def expand(self, longest: float) -> Expansion:
        arithmetic = self._arithmetic
        left = self.wall - self._z
        first = arithmetic.log2(self._step)
        at_wall = arithmetic.log2(left) <= min(first, _log2(longest))
        inside = self._step if first <= _log2(longest) else arithmetic.number(longest) * (1 if left > 0 else -1)
        h = left if at_wall else inside
        self._h = h
        z = real_series(arithmetic, [self._z, h] + [arithmetic.number(0)] * (self._settings.order - 2))
        try:
            parts = self._problem.exact_pencil(z, self._exact)
        except (TypeError, AttributeError) as error:
            advice = "allowed are formulas with +, −, ·, / and ** for numbers of any kind, which cosh of numpy or math is not"
            raise InputError(f"exact_pencil cannot be computed for a power series in z ({error}): {advice}") from error
        found = [self._entries(part, z) for part in parts]
        half = len(found) // 2
        return Expansion(h, found[:half], found[half:], at_wall)

    def advance(self, part: float) -> None:
        step = self._h * self._arithmetic.number(part)
        self._z = self._arithmetic.rounded(self._z + step)
        self._step = 2 * step

    def unknowns(self, sigma: Any) -> UnknownRows:
        """The unknowns that the form names, or all components."""
        named = EXACT_UNKNOWNS.of(self._problem)
        return {f"psi{i + 1}": {i: 1} for i in range(self._problem.size)} if named is None else named(self._exact)

    farthest = 0.0

    def farther(self, sigma: Any, c: Matrix, place: Any, distance: Any) -> None:
        """The start is an end of the domain."""

    def wall_rows(self) -> list[Matrix]:
        return [self._matrix(W) for W in self._problem.exact_wall(self._exact)]

    def corrected_base(self) -> BaseFlowNumbers:
        return ()

    def _entries(self, part: Mapping[tuple[int, int], Any], z: Taylor) -> TaylorEntries:
        return {at: e if isinstance(e, Taylor) else 0 * z + e for at, e in part.items()}

    def _matrix(self, rows: Sequence[Sequence[Any]]) -> Matrix:
        return [[simplified(self._arithmetic, x) for x in row] for row in rows]


def _log2(x: float) -> float:
    from math import inf, log2

    return log2(x) if x < inf else inf
