"""Start-up: the import, the first-ever compilation, and a command line that is warm."""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path

from bench import Line, at_most, best, once, show

EXE = Path(sys.executable).with_name("shootstab")
MAIN_JOB = [str(EXE), "verify", "high", "--json", os.devnull]
ONE_MODE = [str(EXE), "refine", "high", "--guess", "0.004", "--json", os.devnull]


def run(words: list[str], **environment: str) -> None:
    """A process of its own that must succeed."""
    subprocess.run(words, check=True, capture_output=True, env={**os.environ, **environment})


def lines() -> Iterator[Line]:
    """Import, first compilation, warm command line."""
    yield at_most("import shootstab, interpreter included", best(lambda: run([sys.executable, "-c", "import shootstab"])), 0.5)
    with tempfile.TemporaryDirectory() as cache:
        first = once(lambda: run(ONE_MODE, NUMBA_CACHE_DIR=cache))
        again = once(lambda: run(ONE_MODE, NUMBA_CACHE_DIR=cache))
    yield at_most("compilation for the first mode ever", first - again, 25.0)
    with tempfile.TemporaryDirectory() as cache:
        first = once(lambda: run(MAIN_JOB, NUMBA_CACHE_DIR=cache))
        again = once(lambda: run(MAIN_JOB, NUMBA_CACHE_DIR=cache))
    yield at_most("compilation in all, for the main job (verify high)", first - again, 25.0)
    yield at_most("warm: shootstab refine high --guess 0.004", best(lambda: run(ONE_MODE)), 2.0)
    yield at_most("warm: shootstab verify high", best(lambda: run(MAIN_JOB)), 2.0)


if __name__ == "__main__":
    sys.exit(0 if show("Start-up", "python validation/bench_startup.py", lines()) else 1)
