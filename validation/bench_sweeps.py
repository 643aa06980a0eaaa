"""Sweeps: the map of figure 3a, how time goes with the number of points and of workers."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Iterator
from time import perf_counter, process_time

import numpy as np
from bench import BenchLine, at_least, at_most, duration, show
from scenes import problem

import shootstab as st
from shootstab.analyses.sweep import Swept

LINES_TIMED = 3  # chosen: rounds, of which the fastest counts


def swept(workers: int, kx: object, ky: object) -> tuple[Swept, float]:
    """A sweep of the high flow to 8 digits, and how long it took, with the start of the workers."""
    high = problem("high")
    began = perf_counter()
    found = st.sweep(high, {"kx": kx, "ky": ky}, digits=8, workers=workers)
    return found, perf_counter() - began


def lines(quick: bool, map_alone: bool = False) -> Iterator[BenchLine]:
    """Map, scaling, workers."""
    swept(1, 5e-4, [0.01, 0.011])  # compile
    n = 13 if quick else 61
    grid = np.linspace(0.0, 1.5e-3, n), np.linspace(0.0, 0.03, n)
    found, both = swept(2, *grid)
    said = ", ".join(f"{count} {status}" for status, count in found.summary.items() if count)
    yield at_most(f"map of figure 3a, {n} x {n} points, 8 digits, two workers", both, 10.0, f"{1e3 * both / n**2:.3g} ms a point; {said}")
    fastest = found.fastest
    assert fastest is not None
    place = ", ".join(f"{x:.4g}" for x in fastest[0])
    growth = fastest[1].growth or 0.0
    yield BenchLine(
        "fastest growth on it", f"{growth:.6g} at (kx, ky) = ({place})", "0.00397 at (0, 0.0100)", abs(growth - 0.0039705) < 1e-6
    )
    if map_alone:
        return
    _, one = swept(1, *grid)
    yield at_least("one worker against two, the same map", one / both, 1.8)
    times = {m: swept(1, 5e-4, np.linspace(0.001, 0.021, m))[1] / m for m in ((100, 400) if quick else (100, 1000, 10000))}
    said = ", ".join(f"{duration(t)} ({m})" for m, t in times.items())
    bound = "constant: the largest within 1.3 of the smallest or below the first"
    yield BenchLine("time a point along k_y, by number of points", said, bound, max(times.values()) <= 1.3 * times[min(times)])


def line() -> Iterator[BenchLine]:
    """Two lines of the map by this process alone, in processor time, which hardly depends on what else runs."""
    swept(1, 5e-4, [0.01, 0.011])  # compile
    took = []
    for _ in range(LINES_TIMED):
        began = process_time()
        found, _ = swept(1, [5e-4, 7.5e-4], np.linspace(0.0, 0.03, 61))
        took.append(process_time() - began)
    said = f"{sum(o.evaluations for _, o in found.rows())} values of D"
    yield BenchLine("two lines of 61 points, one worker, processor time a point", f"{1e3 * min(took) / len(found.grid):.3g} ms; {said}")


def main() -> int:
    """All of it, or with --quick a form that takes a minute."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--quick", action="store_true", help="smaller grids")
    parser.add_argument("--map", action="store_true", help="the map of figure 3a by two workers, and nothing else")
    parser.add_argument("--line", action="store_true", help="two lines of it by one worker, in processor time, and nothing else")
    options = parser.parse_args()
    if options.line:
        return 0 if show("A line of a sweep", "python validation/bench_sweeps.py --line", line()) else 1
    return 0 if show("Sweeps", "python validation/bench_sweeps.py", lines(options.quick, options.map)) else 1


if __name__ == "__main__":
    sys.exit(main())
