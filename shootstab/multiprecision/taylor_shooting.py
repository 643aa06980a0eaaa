"""D(σ) by Taylor steps: the decaying space carried to the wall, kept well conditioned without losing that D is analytic.

After every step the frame Y (n, k) is multiplied by the inverse of its best k rows, whose determinant is kept as a factor: D =
det[W(σ) Y] times all of them is what it would be without, whichever rows are chosen.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any

from shootstab.core.errors import ConvergenceError
from shootstab.core.progress import StepDone
from shootstab.multiprecision import small_matrices as matrices
from shootstab.multiprecision.arithmetic import Arithmetic, Matrix
from shootstab.multiprecision.integration import BaseFlowNumbers, Expansion, Integration, UnknownRows
from shootstab.multiprecision.linear_step import at_sigma, carried
from shootstab.multiprecision.settings import LIMIT_SLACK, Settings, step_limit

MOST_TAYLOR_STEPS = 5000  # chosen: a budget of some minutes for one D
TRIALS = 40  # chosen: lengths of one step that are tried, each half of the one before
STEP_GROWTH = 1.0  # chosen: log2 of one step over the one before, at most
SHORTEST_LOG_PART = -2.0  # derived: log2 of the least part of a step; its series falls up to t = 1, for STEP_SHRINK is 2.2 bits
TERM_SLACK = 4.0  # chosen: bits by which the last terms may exceed the tolerance


@dataclass(frozen=True)
class Factors:
    """The steps, the frames (n, k) at the beginning of each and at the wall, the factors (k, k) that each was multiplied with,
    the rows of the unknowns along each; the rows W(σ) (k, n) at the wall, and its place."""

    steps: Sequence[Expansion]
    frames: list[Matrix]
    factors: list[Matrix]
    rows: list[UnknownRows]
    wall: Matrix = ()  # type: ignore[assignment]
    at_wall: Any = None


class TaylorShooting:
    """D(σ) on one integration; the steps are chosen at the first σ and kept, with the pencil's series, for the others."""

    def __init__(self, arithmetic: Arithmetic, n: int, settings: Settings, integration: Integration, progress: StepDone) -> None:
        self.arithmetic, self.settings, self._n, self._progress = arithmetic, settings, n, progress
        self.integration = integration
        self._steps: list[Expansion] = []

    @property
    def steps(self) -> int:
        """The number of steps."""
        return len(self._steps)

    def corrected_base(self) -> BaseFlowNumbers:
        """The corrected numbers of the base flow: see multiprecision.integration.Integration."""
        return self.integration.corrected_base()

    def __call__(self, sigma: Any) -> Any:
        """D(σ)."""
        if not self._steps:
            self.integration.begin(sigma)
            return self._march(sigma)
        Y, det = self.integration.far_frame(sigma)
        for step in self._steps:
            self._progress()
            Y, det = self._normalized(self._carried(step, sigma, Y)[0](step.part), det)
        return self._at_wall(sigma, Y, det)

    def solving(self, sigma: Any) -> Factors:
        """One integration at σ of which everything is kept."""
        kept = Factors(self._steps, [], [], [])
        self.integration.begin(sigma)
        self._march(sigma, kept)
        return replace(kept, wall=matrices.polynomial(self._rows, sigma), at_wall=self.integration.wall)

    def _march(self, sigma: Any, kept: Factors | None = None) -> Any:
        Y, det = self.integration.far_frame(sigma)
        if kept is not None:
            kept.frames.append(Y)
        longest = float("inf")
        while not (self._steps and self._steps[-1].at_wall):
            step, Y = self._step(sigma, Y, longest)
            self._steps.append(step)
            if kept is not None:
                kept.rows.append(self.integration.unknowns(sigma))
                kept.factors.append(self._best(Y))
            Y, det = self._normalized(Y, det)
            if kept is not None:
                kept.frames.append(Y)
            self.integration.advance(step.part)
            longest = self._next
            if len(self._steps) > MOST_TAYLOR_STEPS:
                raise ConvergenceError(f"more than {MOST_TAYLOR_STEPS} Taylor steps: sigma lies next to the continuous spectrum")
        self._rows = self.integration.wall_rows()
        return self._at_wall(sigma, Y, det)

    def _step(self, sigma: Any, Y: Matrix, longest: float) -> tuple[Expansion, Matrix]:
        """A step as long as the flow's series and the frame's own hold, and the frame after it."""
        for _ in range(TRIALS):
            self._progress()
            step = self.integration.expand(longest)
            end, last = self._carried(step, sigma, Y)
            limit = self._limit(Y, last)
            here = self.arithmetic.log2(step.h)
            self._next = 2.0 ** (here + min(limit, 0.0) + STEP_GROWTH)
            if limit * self.settings.order >= -TERM_SLACK:
                return step, end(1.0)
            if limit >= SHORTEST_LOG_PART:
                part = 2.0 ** (limit - LIMIT_SLACK)
                return replace(step, part=part, at_wall=False), end(part)
            longest = 2.0 ** (here + limit - LIMIT_SLACK)
        raise ConvergenceError("no Taylor step is short enough: sigma lies on the continuous spectrum, or next to it")

    def _at_wall(self, sigma: Any, Y: Matrix, det: Any) -> Any:
        rows = matrices.polynomial(self._rows, sigma)
        return self.arithmetic.rounded(det * matrices.determinant(self.arithmetic, matrices.product(self.arithmetic, rows, Y)))

    def _carried(self, step: Expansion, sigma: Any, Y: Matrix) -> tuple[Callable[[float], Matrix], list[Matrix]]:
        """The frame as a function of t, and the last terms of its series."""
        C, D = at_sigma(step.C, sigma), at_sigma(step.D, sigma)
        return carried(self.arithmetic, self._n, C, {at: e * step.h for at, e in D.items()}, Y, self.settings.order)

    def _limit(self, Y: Matrix, last: list[Matrix]) -> float:
        """log2 of the fraction of the step at which the frame's own series holds."""
        first, *sizes = (max(self.arithmetic.log2(x) for row in term for x in row) for term in (Y, *last))
        return step_limit(sizes, self.settings.order, first, self.settings.tolerance)

    def _normalized(self, Y: Matrix, det: Any) -> tuple[Matrix, Any]:
        arithmetic, best = self.arithmetic, self._best(Y)
        transposed = [list(column) for column in zip(*matrices.solve(arithmetic, _transpose(best), _transpose(Y)), strict=True)]
        return transposed, arithmetic.rounded(det * matrices.determinant(arithmetic, best))

    def _best(self, Y: Matrix) -> Matrix:
        return [Y[i] for i in matrices.pivots(self.arithmetic, Y)]


def _transpose(A: Matrix) -> Matrix:
    return [list(column) for column in zip(*A, strict=True)]


DiscriminantInDigits = Callable[[Any], Any]
