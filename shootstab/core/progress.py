"""How far a long computation is, and how long it will still take."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from time import perf_counter

StepDone = Callable[[], None]  # told that a piece of the work is done
Progress = Callable[[int, int], None]  # done, total
TimedProgress = Callable[[int, int, float], None]  # done, total, seconds left
TOTAL = 1000  # chosen: what a finished command reports, in thousandths
USUAL = 40  # chosen: steps of a stage; after so many, 1 − 1/e of it counts as done
MILLISECONDS = 1e3  # exact


class StageClock:
    """Stages of known relative cost; inside a stage, steps approach its end without reaching it."""

    def __init__(self, progress: TimedProgress | None) -> None:
        self._progress = progress
        self._began = perf_counter()
        self._stages: list[float] = [1.0]
        self._stage = self._steps = 0

    def plan(self, stages: Sequence[float]) -> None:
        """What lies ahead, in any unit."""
        self._stages, self._stage, self._steps = list(stages), 0, 0

    def step_done(self) -> None:
        """One step of a stage is done."""
        self._steps += 1
        self._tell(1.0 - math.exp(-self._steps / USUAL))

    def done(self) -> None:
        """A stage is done."""
        self._stage, self._steps = self._stage + 1, 0
        self._tell(0.0)

    def _tell(self, part: float) -> None:
        if self._progress is None:
            return
        whole = sum(self._stages)
        share = (sum(self._stages[: self._stage]) + part * sum(self._stages[self._stage : self._stage + 1])) / whole
        elapsed = perf_counter() - self._began
        left = elapsed * (1.0 - share) / share if share > 0.0 else math.inf
        self._progress(round(TOTAL * share), TOTAL, left)
