"""Who does the work: this process, processes of this machine (processes.py), or a Dask cluster. Each yields jobs with their results."""

from __future__ import annotations

import logging
from collections.abc import Callable, Generator, Iterator, Sequence
from concurrent.futures import CancelledError
from contextlib import contextmanager
from importlib import import_module
from typing import Any

from shootstab.analyses.processes import Job, Result
from shootstab.core.errors import InputError, ShootstabError

CONNECT = 15  # chosen: seconds to wait for a cluster


def serially(work: Callable[[Job], Result], jobs: Sequence[Job]) -> Generator[tuple[Job, Result], None, None]:
    """Do the jobs one after the other in this process."""
    for job in jobs:
        yield job, work(job)


def on_cluster(work: Callable[[Job], Result], jobs: Sequence[Job], address: str) -> Generator[tuple[Job, Result], None, None]:
    """Do the jobs on a Dask cluster, given by the address of its scheduler, which gives the jobs of a dead worker to the others.

    Raises InputError where dask is not installed or nothing answers at the address, ShootstabError where the scheduler is lost or one
    job has cost more workers than the cluster allows.
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
            raise ShootstabError(f"{address}: the Dask scheduler is lost; the file of results keeps what was done") from error
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
