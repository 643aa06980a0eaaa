"""A sweep: the grid's lines to the workers, their results to the store."""

from __future__ import annotations

import os
from collections.abc import Callable, Generator, Iterator, Mapping
from contextlib import closing
from dataclasses import asdict, dataclass
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from shootstab.analyses.processes import Crew, Job, Result, crew_kept, in_processes
from shootstab.analyses.sweep.grid import ParameterAxis, Point, SweepGrid
from shootstab.analyses.sweep.neutral import neutral_steps, stepped, with_below
from shootstab.analyses.sweep.outcomes import OUTCOMES, Outcome
from shootstab.analyses.sweep.store import Store
from shootstab.analyses.sweep.walk import WalkSettings, walk
from shootstab.analyses.workers import on_cluster, serially
from shootstab.core.allowed import COUNT_EVERY, GROWTH_FLOOR, MOST_WORKERS, SWEEP_DIGITS
from shootstab.core.given import require_whole
from shootstab.core.progress import Progress
from shootstab.core.records import UNRESOLVED
from shootstab.problems.capabilities import FAMILY, Family
from shootstab.problems.protocol import Problem

FORMAT = 3  # defined by the store: the version of the file of results; one of another version is refused
STEPS_SHARE = 0.1  # chosen: the part of the work that steps across the neutral curve are; only the progress shown rests on it


@dataclass(frozen=True, repr=False)
class Swept:
    """The outcome at every point of a grid; axes in the order in which they were given, the last one running fastest."""

    axes: tuple[ParameterAxis, ...]
    outcomes: Mapping[Point, Outcome]
    settings: WalkSettings
    family: Family

    def __repr__(self) -> str:
        axes = " x ".join(f"{axis.name}: {len(axis.values)}" for axis in self.axes)
        said = ", ".join(f"{n} {what}" for what, n in self.summary.items() if n and what != "counted")
        return f"Swept({axes}; {said})"

    @property
    def grid(self) -> SweepGrid:
        """The points."""
        return SweepGrid(self.axes, self.family.sharing)

    def rows(self) -> Iterator[tuple[Point, Outcome]]:
        """Points and outcomes in the order of the grid; points that are not done yet are left out."""
        return ((p, self.outcomes[p]) for p in self.grid.points if p in self.outcomes)

    def array(self, of: Callable[[Outcome], Any], dtype: Any = np.float64, absent: Any = np.nan) -> NDArray[Any]:
        """A quantity on the grid, (a, b, …) with the numbers of values of the axes; `absent` where it is None."""
        values = [of(self.outcomes[p]) for p in self.grid.points]
        flat = np.array([absent if v is None else v for v in values], dtype=dtype)
        return flat.reshape([len(axis.values) for axis in self.axes])

    @property
    def columns(self) -> tuple[str, ...]:
        """What the outcomes say beside the modes."""
        return next((tuple(o.beside) for o in self.outcomes.values() if o.beside), ())

    @property
    def growth(self) -> NDArray[np.float64]:
        """Re σ of the dominant mode, (a, b, …) as `array` has it; NaN where none grows or none is known."""
        return self.array(lambda o: o.growth)

    @property
    def below(self) -> NDArray[np.complex128]:
        """σ of the mode followed across the neutral curve, (a, b, …) as `array` has it; NaN where there is none."""
        return self.array(lambda o: o.below, np.complex128)

    @property
    def fastest(self) -> tuple[Point, Outcome] | None:
        """The point of the largest growth rate, None where nothing grows anywhere."""
        growing = [(p, o) for p, o in self.rows() if o.sigma is not None]
        return max(growing, key=lambda row: row[1].growth or 0.0, default=None)

    @property
    def summary(self) -> dict[str, int]:
        """How many points have each status, and at how many dominance, or that nothing grows, is proved by a count there."""
        said = [o.status.partition(":")[0] for o in self.outcomes.values()]
        return {**{kind: said.count(kind) for kind in OUTCOMES}, "counted": sum(o.proved for o in self.outcomes.values())}

    @property
    def bad_news(self) -> bool:
        """Whether a point is unresolved."""
        return self.summary[UNRESOLVED] > 0


def sweep(
    problem: Problem,
    axes: Mapping[str, Any],
    digits: int = SWEEP_DIGITS,
    every: int = COUNT_EVERY,
    floor: float = GROWTH_FLOOR,
    workers: int | None = 1,
    cluster: str | None = None,
    out: str | Path | None = None,
    progress: Progress | None = None,
) -> Swept:
    """The dominant growing mode over a grid of parameters; the rest is the problem's.

    Of the chute these are k_x, k_y, far_temperature, mass_flux, tan_theta, e, e_w and r, of a problem in equations its parameters.

    axes: name → number or numbers that rise or fall. Modes are followed along lines of neighbouring points, and counted at their ends, at
    every `every`-th point and where one is lost (see walk.py): there dominance is proved, between it is continued. Modes with
    Re σ ≤ floor do not count as growing; next to the neutral curve they are followed one step beyond it (see neutral.py).

    σ has so many digits at every point, or the point is unresolved. Its error is measured, the integration's part at every point, the
    other parts at two points of each line of up to 64 and taken ten times at the others.

    workers: processes of this machine, None: one a core; cluster: the address of a Dask scheduler, in place of them. With `out`, results
    go to an SQLite file as they come (see store.py), and what is there already is not done again. progress(done, total).
    The lines do not depend on what is there, so an interrupted sweep ends with the values of one that was not. A worker that dies is
    replaced (see processes.py). Raises InputError for what cannot be swept and for a file of something else, OutputError where results
    cannot be written.
    """
    family_of = FAMILY.required(problem)
    if workers is not None:
        require_whole("workers", workers, 1, MOST_WORKERS)
    settings = WalkSettings(digits, every, floor)
    family = family_of(tuple(axes))
    grid = SweepGrid.of(axes, family)
    with Store(None if out is None else Path(out), grid.names, _definition(grid, family, settings)) as store, crew_kept() as crew:
        lines = grid.lines(store.done(grid))
        if lines:
            store.require_writable()
        steps = round(STEPS_SHARE * len(grid))
        told = progress or (lambda done, total: None)
        done = len(grid) - sum(len(line.points) for line in lines)
        told(done, len(grid) + steps)
        kept = "" if out is None else f"; {out} keeps what was done"
        with closing(_results(partial(walk, family, settings), lines, workers, cluster, kept, crew)) as results:
            for line, outcomes in results:
                store.add(line.points, outcomes)
                done += len(line.points)
                told(done, len(grid) + steps)
        outcomes_of, known = store.results(), store.below()
        left = [step for step in neutral_steps(grid, outcomes_of) if step.point not in known]
        if left:
            store.require_writable()
        with closing(_results(partial(stepped, family, settings), left, workers, cluster, kept, crew)) as landed:
            for i, (step, sigma) in enumerate(landed, 1):
                store.add_below(step.point, sigma)
                told(len(grid) + round(steps * i / len(left)), len(grid) + steps)
        told(len(grid) + steps, len(grid) + steps)
        return Swept(grid.axes, with_below(outcomes_of, store.below(), settings), settings, family)


def _results(
    work: Callable[[Job], Result], jobs: list[Job], workers: int | None, cluster: str | None, kept: str, crew: Crew
) -> Generator[tuple[Job, Result], None, None]:
    if cluster is not None:
        return on_cluster(work, jobs, cluster, kept)
    count = os.cpu_count() or 1 if workers is None else workers
    return serially(work, jobs) if count == 1 or len(jobs) < 2 else in_processes(work, jobs, count, crew)


def _definition(grid: SweepGrid, family: Family, settings: WalkSettings) -> dict[str, Any]:
    """What makes two sweeps the same, for JSON."""
    axes = {axis.name: list(axis.values) for axis in grid.axes}
    swept = {name: value for name, value in family.as_dict().items() if name not in axes}
    return {"format": FORMAT, "axes": axes, "problem": swept, **asdict(settings)}
