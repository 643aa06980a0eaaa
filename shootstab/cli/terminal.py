"""What goes to the terminal: tables and sentences on standard output, progress on standard error."""

from __future__ import annotations

import io
import sys
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from rich.console import RenderableType

Progress = Callable[[int, int], None]

WIDE = 10_000


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
    plain = io.StringIO()
    console = Console(file=plain, width=WIDE, highlight=False, soft_wrap=True, force_terminal=False, color_system=None)
    for part in parts:
        console.print(part)
    for line in plain.getvalue().splitlines():
        sys.stdout.write(line.rstrip() + "\n")


@contextmanager
def progress(task: str) -> Iterator[Progress | None]:
    """A bar on standard error, to be told (done, total); None unless standard error is a terminal."""
    if not sys.stderr.isatty():
        yield None
        return
    from rich.console import Console
    from rich.progress import Progress as Bar

    with Bar(console=Console(stderr=True), transient=True) as bar:
        bar_task = bar.add_task(task, total=None)

        def told(done: int, total: int) -> None:
            bar.update(bar_task, completed=done, total=total)

        yield told
