"""Who does the work: this process, processes of this machine, or a Dask cluster. Each yields jobs with their results as they are done."""

from __future__ import annotations

import os
import signal
from collections.abc import Callable, Generator, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from concurrent.futures.process import BrokenProcessPool
from importlib import import_module
from multiprocessing import active_children, get_context, parent_process
from threading import Thread
from typing import Any, TypeVar

from shootstab.core.errors import InputError, ShootstabError

Job = TypeVar("Job")
Result = TypeVar("Result")
CONNECT = 15  # chosen: seconds to wait for a cluster
THREADS = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")


def serially(work: Callable[[Job], Result], jobs: Sequence[Job]) -> Generator[tuple[Job, Result], None, None]:
    """One after the other, here."""
    for job in jobs:
        yield job, work(job)


def in_processes(work: Callable[[Job], Result], jobs: Sequence[Job], workers: int) -> Generator[tuple[Job, Result], None, None]:
    """In so many new processes, each with one thread: the matrices are small, and threads only cost.

    They are started afresh, so a program that asks for them must guard its own start by `if __name__ == "__main__"`.
    """
    before = {name: os.environ.get(name) for name in THREADS}
    os.environ.update(dict.fromkeys(THREADS, "1"))
    others = set(active_children())
    pool = ProcessPoolExecutor(min(workers, len(jobs) or 1), mp_context=get_context("spawn"), initializer=_depend_on_the_parent)
    finished = False
    try:
        futures = {pool.submit(work, job): job for job in jobs}
        for future in as_completed(futures):
            yield futures[future], future.result()
        finished = True
    except BrokenProcessPool as error:
        raise ShootstabError("a worker process died: its memory may have run out, or the program lacks a guard of its start") from error
    finally:
        if not finished:  # interrupted: do not wait for what is under way
            for process in set(active_children()) - others:
                process.terminate()
        pool.shutdown(wait=True, cancel_futures=True)
        for name, value in before.items():
            if value is None:
                os.environ.pop(name, None)
            else:
                os.environ[name] = value


def _depend_on_the_parent() -> None:
    """In a worker: interrupts are the parent's business, and where it dies, by whatever hand, the worker ends."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    parent = parent_process()

    def watch() -> None:
        assert parent is not None
        parent.join()
        os._exit(1)

    if parent is not None:
        Thread(target=watch, daemon=True).start()


def on_cluster(work: Callable[[Job], Result], jobs: Sequence[Job], address: str) -> Generator[tuple[Job, Result], None, None]:
    """On the workers of a Dask cluster, given by the address of its scheduler.

    Raises InputError where dask is not installed or nothing answers at the address.
    """
    try:
        distributed: Any = import_module("distributed")
    except ImportError:
        raise InputError(f"{address}: a cluster needs dask: install it with `pip install 'shootstab[cluster]'`") from None
    try:
        client = distributed.Client(address, timeout=CONNECT)
    except (OSError, ValueError) as error:
        raise InputError(f"{address}: no Dask scheduler answers: allowed is an address such as tcp://127.0.0.1:8786 ({error})") from error
    with client:
        futures = {client.submit(work, job, pure=False): job for job in jobs}
        for future in distributed.as_completed(list(futures)):
            yield futures[future], future.result()
