"""One thread for the numerical libraries: the matrices are small, threads only cost, and sums in another order have other last bits."""

from __future__ import annotations

import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager

THREADS = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")  # where the libraries look as they are loaded


@contextmanager
def one_thread() -> Iterator[None]:
    """Bind the processes that are started within to one thread each."""
    before = {name: os.environ.get(name) for name in THREADS}
    os.environ.update(dict.fromkeys(THREADS, "1"))
    try:
        yield
    finally:
        for name, value in before.items():
            if value is None:
                os.environ.pop(name, None)
            else:
                os.environ[name] = value


def one_thread_from_here() -> None:
    """Bind this process to one thread, if it has not loaded NumPy yet: a program that has keeps what it chose."""
    if "numpy" not in sys.modules:
        os.environ.update(dict.fromkeys(THREADS, "1"))
