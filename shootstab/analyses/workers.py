"""Who does the work: this process, processes of this machine (processes.py), or a Dask cluster. Each yields jobs with their results.

No result depends on who did it: a job is a question of its own.
"""

from __future__ import annotations

import logging
import os
import pickle
from collections.abc import Callable, Generator, Iterator, Sequence
from concurrent.futures import CancelledError
from contextlib import contextmanager
from importlib import import_module
from statistics import median
from time import perf_counter
from typing import Any

from shootstab.analyses.processes import Job, Result, in_processes
from shootstab.core.allowed import MOST_WORKERS
from shootstab.core.errors import InputError, ShootstabError, shortened
from shootstab.core.given import require_whole

CONNECT = 15  # chosen: seconds to wait for a cluster
WORTH_OTHERS = 6.0  # chosen: seconds of work left for which others are started, each of which takes about a third of that to be ready
DONE_FIRST = 3  # chosen: jobs done alone before that is estimated; the first may have compiled kernels


def spread(
    here: Callable[[Job], Result],
    elsewhere: Callable[[], Callable[[Job], Result]],
    jobs: Sequence[Job],
    workers: int | None,
    cluster: str | None,
) -> Generator[tuple[Job, Result], None, None]:
    """Do the jobs in this process for one worker, in so many others, on the Dask cluster at an address; with None in as many as there are
    cores, where the first jobs show that what is left is worth their start, and the problem can be sent there.

    elsewhere makes what does in other processes what here does in this one. Raises InputError for a number of workers that is none, beside
    a cluster, and where the problem cannot be sent.
    """
    if cluster is not None and workers not in (None, 1):
        raise InputError(f"workers = {workers}: allowed is no number of processes beside a cluster, which has its own")
    if workers is not None:
        require_whole("workers", workers, 1, MOST_WORKERS)
    if cluster is not None:
        return on_cluster(elsewhere(), jobs, cluster)
    if workers is None:
        return _when_worth_it(here, elsewhere, jobs, os.cpu_count() or 1)
    return serially(here, jobs) if workers == 1 else in_processes(elsewhere(), jobs, workers)


def _when_worth_it(
    here: Callable[[Job], Result], elsewhere: Callable[[], Callable[[Job], Result]], jobs: Sequence[Job], cores: int
) -> Generator[tuple[Job, Result], None, None]:
    took: list[float] = []
    for i, job in enumerate(jobs):
        if cores > 1 and len(took) >= DONE_FIRST and median(took) * (len(jobs) - i) > WORTH_OTHERS:
            try:
                sent = elsewhere()
            except InputError:  # what cannot be sent is done here
                cores = 1
            else:
                yield from in_processes(sent, jobs[i:], cores)
                return
        began = perf_counter()
        result = here(job)
        took.append(perf_counter() - began)
        yield job, result


def parcel(*parts: Any) -> bytes:
    """What other processes need to know, as bytes. Raises InputError where a part of it cannot be sent, as a function inside a function."""
    try:
        return pickle.dumps(parts)
    except Exception as error:  # what somebody else's object raises here may be anything
        allowed = "allowed is a built-in scene, one in equations, or functions of a module that can be imported"
        raise InputError(f"this problem cannot be sent to other processes ({shortened(error)}): {allowed}") from error


def serially(work: Callable[[Job], Result], jobs: Sequence[Job]) -> Generator[tuple[Job, Result], None, None]:
    """Do the jobs one after the other in this process."""
    for job in jobs:
        yield job, work(job)


def on_cluster(
    work: Callable[[Job], Result], jobs: Sequence[Job], address: str, kept: str = ""
) -> Generator[tuple[Job, Result], None, None]:
    """Do the jobs on a Dask cluster, given by the address of its scheduler, which gives the jobs of a dead worker to the others.

    Raises InputError where dask is not installed or nothing answers at the address, ShootstabError where the scheduler is lost, which says
    what is kept, or where one job has cost more workers than the cluster allows.
    """
    try:
        distributed: Any = import_module("distributed")
    except ImportError:
        raise InputError(f"{address}: a cluster needs dask: install it with `pip install 'shootstab[cluster]'`") from None
    try:
        client = distributed.Client(address, timeout=CONNECT)
    except (OSError, ValueError) as error:
        raise InputError(f"{address}: no Dask scheduler answers: allowed is an address such as tcp://127.0.0.1:8786 ({error})") from error
    with _unlogged("distributed"), client:
        try:
            futures = {client.submit(work, job, pure=False): job for job in jobs}
            for future in distributed.as_completed(list(futures)):
                yield futures[future], future.result()
        except (CancelledError, OSError) as error:  # distributed's own errors of a connection are OSErrors
            raise ShootstabError(f"{address}: the Dask scheduler is lost{kept}") from error
        except distributed.KilledWorker as error:
            raise ShootstabError(f"{address}: the workers of the cluster died again and again at the same points: {error}") from error


@contextmanager
def _unlogged(name: str) -> Iterator[None]:
    """A library logs nothing here, such as the traceback of a lost connection: the exception that is raised says it in a line."""
    loggers = [logging.getLogger(name), *(logging.getLogger(n) for n in logging.root.manager.loggerDict if n.startswith(f"{name}."))]
    levels = [logger.level for logger in loggers]
    for logger in loggers:
        logger.setLevel(logging.CRITICAL + 1)
    try:
        yield
    finally:
        for logger, level in zip(loggers, levels, strict=True):
            logger.setLevel(level)
