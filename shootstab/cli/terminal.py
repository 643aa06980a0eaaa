"""What goes to the terminal: tables and sentences on standard output, progress on standard error."""

from __future__ import annotations

import io
import itertools
import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import TYPE_CHECKING

from shootstab.core import compilation
from shootstab.core.numerus import PERCENT
from shootstab.core.progress import Progress

if TYPE_CHECKING:
    from rich.console import RenderableType


WIDE = 10_000  # chosen: columns of a console that breaks no line
HEARTBEAT = 10.0  # seconds: chosen, as a job of CI that is silent for minutes is taken for dead


def show(parts: Sequence[RenderableType]) -> None:
    """Print tables and texts: coloured on a terminal, plain and without trailing blanks into a file or a pipe.

    A line is never cut or folded to the width of the terminal: digits must stay together.
    """
    from rich.console import Console

    if sys.stdout.isatty():
        console = Console(width=WIDE, highlight=False, soft_wrap=True)
        for part in parts:
            console.print(part)
        return
    sys.stdout.write(plain(parts))


def plain(parts: Sequence[RenderableType]) -> str:
    """Tables and texts without colours and trailing blanks."""
    from rich.console import Console

    written = io.StringIO()
    console = Console(file=written, width=WIDE, highlight=False, soft_wrap=True, force_terminal=False, color_system=None)
    for part in parts:
        console.print(part)
    return "".join(line.rstrip() + "\n" for line in written.getvalue().splitlines())


class Announcement:
    """Says on a terminal, once, that kernels are compiled, and so why the first answer takes longer than those to come."""

    said = False

    def __call__(self, kernel: str) -> None:
        if not self.said and sys.stderr is not None and sys.stderr.isatty():
            print("shootstab: compiling kernels, once: later runs find them in a cache", file=sys.stderr, flush=True)
        self.said = True


@contextmanager
def progress(task: str) -> Iterator[Progress | None]:
    """A bar on standard error, to be told (done, total); into a log a line every ten seconds.

    None where standard error has been replaced by whoever runs the command inside a program.
    """
    if sys.stderr.isatty():
        with _bar(task) as told:
            yield told
    elif sys.stderr is sys.__stderr__:
        with _heartbeat(task) as told:
            yield told
    else:
        yield None


@contextmanager
def _bar(task: str) -> Iterator[Progress]:
    from rich.console import Console
    from rich.progress import BarColumn, TaskProgressColumn, TextColumn, TimeElapsedColumn
    from rich.progress import Progress as Bar

    columns = TextColumn("{task.description}"), BarColumn(), TaskProgressColumn(), TimeElapsedColumn()
    with Bar(*columns, console=Console(stderr=True), transient=True) as bar:
        bar_task = bar.add_task(task, total=None)

        def told(done: int, total: int) -> None:
            bar.update(bar_task, completed=done, total=total, description=task)

        compiled = itertools.count(1)
        compilation.tell(lambda kernel: bar.update(bar_task, description=f"{task} (compiling kernel {next(compiled)}, {kernel})"))
        yield told


@contextmanager
def _heartbeat(task: str) -> Iterator[Progress]:
    """A thread that says how far it is: also while one step takes long."""
    import threading
    import time

    done, began, over = "", time.monotonic(), threading.Event()

    def told(count: int, total: int) -> None:
        nonlocal done
        done = f", {PERCENT * count // total} %"

    def beat() -> None:
        while not over.wait(HEARTBEAT):
            print(f"shootstab: {task}{done}, {time.monotonic() - began:.0f} s", file=sys.stderr, flush=True)

    thread = threading.Thread(target=beat, daemon=True)
    thread.start()
    try:
        yield told
    finally:
        over.set()
        thread.join()
