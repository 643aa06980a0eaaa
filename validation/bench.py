"""What a bench prints: what was measured, what was asked, whether it holds. Ratios are of times measured in one run, on one thread.

Times are seconds of a processor: what others do on the machine makes them longer too, but by less.
"""

from __future__ import annotations

import os

os.environ.setdefault("OMP_NUM_THREADS", "1")

import math
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from time import process_time

from rich.console import Console
from rich.table import Table

ENOUGH = 0.5  # chosen: seconds over which something quick is repeated


@dataclass(frozen=True)
class BenchLine:
    """One measurement; asked says in words what is wanted, holds whether it is (None: shown, not judged)."""

    what: str
    obtained: str
    asked: str = ""
    holds: bool | None = None


def at_least(what: str, ratio: float, wanted: float, note: str = "") -> BenchLine:
    """A ratio that should be at least so large."""
    return BenchLine(what, f"{ratio:.3g} times{'; ' + note if note else ''}", f"≥ {wanted:g} times", ratio >= wanted)


def at_most(what: str, seconds: float, wanted: float, note: str = "") -> BenchLine:
    """A time that should be at most so long."""
    return BenchLine(what, f"{duration(seconds)}{'; ' + note if note else ''}", f"≤ {duration(wanted)}", seconds <= wanted)


def processor() -> float:
    """The seconds of a processor that this process has had, and those that ended before it and that it waited for."""
    spent = os.times()
    return process_time() + spent.children_user + spent.children_system


def best(run: Callable[[], object], fresh: Callable[[], object] = lambda: None) -> float:
    """The shortest of several runs, in seconds, after one that does not count; `fresh` is called before each, off the clock."""
    fresh()
    run()
    least, spent = math.inf, 0.0
    while spent < ENOUGH:
        fresh()
        took = once(run)
        least, spent = min(least, took), spent + took
    return least


def once(run: Callable[[], object]) -> float:
    """One run, in seconds."""
    began = processor()
    run()
    return processor() - began


def duration(seconds: float) -> str:
    """A time with a unit that suits."""
    if seconds >= 60.0:
        return f"{seconds / 60:.3g} min"
    return f"{seconds:.3g} s" if seconds >= 1.0 else f"{1e3 * seconds:.3g} ms"


def show(title: str, command: str, lines: Iterable[BenchLine]) -> bool:
    """The table, and whether all hold."""
    console = Console(width=max(180, Console().width))
    table = Table(box=None, pad_edge=False, padding=(0, 2, 0, 0))
    for column in ("", "measured", "asked", ""):
        table.add_column(column)
    held = True
    for line in lines:
        held &= line.holds is not False
        table.add_row(line.what, line.obtained, line.asked, "" if line.holds is None else "holds" if line.holds else "[red]FAILS[/]")
    console.print(f"\n[bold]{title}[/]   ({command}, {os.cpu_count()} cores)")
    console.print(table)
    return held
