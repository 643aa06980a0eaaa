"""Figure 8 of the paper: linear stability along the Q–h curves, eleven slopes, sixty flows each.

Every flow is looked at over three decades of wavenumbers along k_y, along k_x and obliquely (models/chute/stability.py): one growing mode,
proved by a count in a small circle, makes it unstable; it is called stable where counts find none at any of the thirty waves.
"""

from __future__ import annotations

import argparse
import os
import sys
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from time import perf_counter
from typing import Any

os.environ.setdefault("OMP_NUM_THREADS", "1")

import numpy as np
from bench import BenchLine, at_most, show

import shootstab as st
from shootstab.analyses.processes import in_processes
from shootstab.analyses.workers import serially
from shootstab.models.chute.stability import STABLE, UNSTABLE, stability

SLOPES = tuple(round(0.25 + 0.01 * i, 2) for i in range(11))  # chosen
TEMPERATURES = (0.05, 30.0)  # chosen: T_∞ from, to
RUN = 12  # chosen: neighbouring flows that one process judges one after the other
SOMETIMES = (0.29, 0.30, 0.31, 0.32)  # published: slopes at which the paper has stable flows
GRAINS = {"e": 0.8, "e_w": 0.8, "r": 0.6}
FIGURE = Path(__file__).parent / "figures" / "figure8.png"
BLUE, ORANGE = "#0072B2", "#D55E00"


@dataclass(frozen=True)
class SlopeRow:
    """One flow: slope, T_∞, Q0, h0, whether its density has a maximum above the base, and what is said of it."""

    tan_theta: float
    far_temperature: float
    mass_flux: float
    centre_of_mass: float
    inverted: bool
    verdict: str
    wave: tuple[float, float] | None
    growth: float | None


def judged(job: tuple[float, tuple[float, ...]]) -> list[SlopeRow]:
    """The stability of neighbouring flows on one slope: what is said of one tells where to begin with the next."""
    tan_theta, temperatures = job
    rows, found = [], None
    for far_temperature in temperatures:
        flow = st.chute.steady(far_temperature=far_temperature, tan_theta=tan_theta, **GRAINS)
        found = stability(flow, near=found)
        log_nu = flow.states[:, 0].real
        inverted = bool(log_nu.max() > log_nu[-1] + 1e-9)
        growth = None if found.mode is None else complex(found.mode.sigma).real
        rows.append(SlopeRow(tan_theta, far_temperature, flow.mass_flux, flow.centre_of_mass, inverted, found.verdict, found.wave, growth))
    return rows


def branch(curve: list[SlopeRow], i: int) -> str:
    """mid where Q0 falls with T_∞; high above it, low below it."""
    Q = np.array([row.mass_flux for row in curve])
    rises = np.gradient(Q, np.log([row.far_temperature for row in curve])) > 0
    if not rises[i]:
        return "mid"
    return "high" if not rises[:i].all() else "low"


def lines(rows: dict[float, list[SlopeRow]], seconds: float, workers: int) -> Iterator[BenchLine]:
    """What the paper states, slope by slope."""
    total = sum(map(len, rows.values()))
    yield at_most(f"{total} flows, {workers} workers", seconds, 120.0, f"{seconds / total:.2g} s a flow")
    for slope, curve in rows.items():
        stable = [i for i, row in enumerate(curve) if row.verdict == STABLE]
        doubt = [row for row in curve if row.verdict not in (STABLE, UNSTABLE)]
        where = sorted({branch(curve, i) for i in stable})
        said = f"{len(stable)} of {len(curve)} stable"
        if stable:
            said += f", T_inf {curve[stable[0]].far_temperature:.3g} to {curve[stable[-1]].far_temperature:.3g}, {' and '.join(where)}"
        if doubt:
            said += f"; {len(doubt)} unresolved ({doubt[0].verdict[:90]})"
        expected = "some, on the mid branch" if slope in SOMETIMES else "none"
        holds = (bool(stable) and where == ["mid"]) if slope in SOMETIMES else not stable
        yield BenchLine(f"tan theta = {slope:.2f}", said, expected, holds and not doubt)


def draw(rows: dict[float, list[SlopeRow]]) -> Any:
    """Q–h curves: solid where stable, dashed where unstable; a thick pale line under flows with a density inversion."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(8.4, 6.2), layout="constrained")
    panel = figure.subplots()
    for slope, curve in rows.items():
        Q, h = np.array([r.mass_flux for r in curve]), np.array([r.centre_of_mass for r in curve])
        inverted = np.array([r.inverted for r in curve])
        stable = np.array([r.verdict == STABLE for r in curve])
        panel.plot(np.where(inverted, Q, np.nan), h, "-", color="0.85", linewidth=7, solid_capstyle="butt", zorder=1)
        panel.plot(Q, h, "--", color=ORANGE, linewidth=1.0, zorder=2)
        for run in _runs(stable):
            panel.plot(Q[run], h[run], "-", color=BLUE, linewidth=2.6, zorder=3, marker="o", markersize=3)
        panel.annotate(f"{slope:.2f}", (Q[-1], h[-1]), textcoords="offset points", xytext=(3, 2), fontsize="x-small")
    panel.plot([], [], "-o", color=BLUE, linewidth=2.6, markersize=3, label="no growing mode at any of 30 waves")
    panel.plot([], [], "--", color=ORANGE, linewidth=1.0, label="unstable: a growing mode is proved")
    panel.plot([], [], "-", color="0.85", linewidth=7, label="density inversion")
    panel.set_xscale("log")
    panel.set_yscale("log")
    panel.set_xlabel(r"mass flux $Q_0$ / $\sqrt{d^3 g\,\cosθ}$ (grain density 1)")
    panel.set_ylabel("height of the centre of mass $h_0$ / d")
    panel.set_title(r"Linear stability of steady flows, e = $e_w$ = 0.8, r = 0.6; tanθ at the end of each curve", fontsize="medium")
    panel.grid(True, which="major", linewidth=0.4, alpha=0.5)
    panel.legend(loc="lower right", frameon=True, fontsize="small")
    return figure


def _runs(held: np.ndarray) -> list[np.ndarray]:
    """Indices of each run of neighbours for which it holds."""
    indices = np.flatnonzero(held)
    return [run for run in np.split(indices, np.flatnonzero(np.diff(indices) > 1) + 1) if run.size]


def main() -> int:
    """All flows, or with --quick three slopes of ten."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--quick", action="store_true", help="three slopes, ten flows each, no picture")
    parser.add_argument("--flows", type=int, default=60, help="of each slope (default 60)")
    parser.add_argument("--workers", type=int, default=2, help="processes (default 2)")
    options = parser.parse_args()
    slopes = (0.28, 0.30, 0.33) if options.quick else SLOPES
    temperatures = np.geomspace(*TEMPERATURES, 10 if options.quick else options.flows)
    runs = [tuple(temperatures[i : i + RUN].tolist()) for i in range(0, len(temperatures), RUN)]
    jobs = [(slope, run) for slope in slopes for run in runs]
    began = perf_counter()
    work = serially(judged, jobs) if options.workers == 1 else in_processes(judged, jobs, options.workers)
    found = {}
    for job, judgements in work:
        found[job] = judgements
        left = (perf_counter() - began) / len(found) * (len(jobs) - len(found))
        print(f"{len(found)} of {len(jobs)} runs, {left:.0f} s left  ", end="\r", file=sys.stderr)
    seconds = perf_counter() - began
    rows = {slope: [row for run in runs for row in found[slope, run]] for slope in slopes}
    held = show("Figure 8: stability along the Q-h curves", "python validation/figure8.py", lines(rows, seconds, options.workers))
    if not options.quick:
        draw(rows).savefig(FIGURE, dpi=160)
    return 0 if held else 1


if __name__ == "__main__":
    sys.exit(main())
