"""Start-up: the import, the first-ever compilation, and a command line that is warm.

Bytecode is written, whatever the environment says: without it Python compiles a hundred modules at every start.
"""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
from collections.abc import Iterator

from bench import BenchLine, at_most, best, once, show

PYTHON = [sys.executable, "-m", "shootstab"]
MAIN_JOB = [*PYTHON, "verify", "high", "--json", os.devnull]
ONE_MODE = [*PYTHON, "refine", "high", "--guess", "0.004", "--json", os.devnull]


def run(words: list[str], **environment: str) -> None:
    """A process of its own that must succeed."""
    kept = {name: value for name, value in os.environ.items() if name != "PYTHONDONTWRITEBYTECODE"}
    subprocess.run(words, check=True, capture_output=True, env={**kept, **environment})


def first_and_again(words: list[str]) -> tuple[float, float]:
    """Seconds of a command with no compiled kernel, and with those that it has left; bytecode is there both times."""
    run([*PYTHON, "--version"])
    with tempfile.TemporaryDirectory() as cache:
        first = once(lambda: run(words, NUMBA_CACHE_DIR=cache))
        return first, once(lambda: run(words, NUMBA_CACHE_DIR=cache))


def lines() -> Iterator[BenchLine]:
    """Import, first compilation, warm command line."""
    bare = best(lambda: run([sys.executable, "-c", "pass"]))
    yield at_most("import shootstab, less the interpreter", best(lambda: run([sys.executable, "-c", "import shootstab"])) - bare, 0.05)
    for name, words, wanted in (("refine high", ONE_MODE, 0.5), ("verify high with its QZ", MAIN_JOB, 1.2)):
        first, again = first_and_again(words)
        most = 10.0
        yield at_most(f"first-ever: shootstab {name}, compilation included", first, most, f"compilation {first - again:.3g} s")
        yield at_most(f"warm: shootstab {name}", best(lambda words=words: run(words)), wanted)


if __name__ == "__main__":
    sys.exit(0 if show("Start-up", "python validation/bench_startup.py", lines()) else 1)
