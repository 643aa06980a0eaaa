"""Processes of this machine that do jobs: where one dies another takes its place, and its job is done again.

Every worker has a pipe of its own and shares nothing, no queue and no semaphore: whoever is killed, at whatever moment, leaves nothing
locked and nothing behind. A worker holds one job at a time, so its death costs that job and no other. The end of a pipe says that its
other end is gone: the parent sees a dead worker by it, and an idle worker a dead parent.
"""

from __future__ import annotations

import os
import pickle
import signal
import traceback
from collections import Counter, deque
from collections.abc import Callable, Generator, Iterator, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from multiprocessing import get_context, parent_process, resource_tracker
from multiprocessing.connection import Connection, wait
from multiprocessing.process import BaseProcess
from threading import Thread
from typing import Any, TypeVar

from shootstab.core.errors import ShootstabError
from shootstab.core.threads import one_thread

Job = TypeVar("Job")
Result = TypeVar("Result")
DEATHS = 8  # chosen: the number of workers dead at one job that is no chance: the job kills them
_ENDING = {getattr(signal, name) for name in ("SIGTERM", "SIGHUP") if hasattr(signal, name)}
STILLBORN = 30  # chosen: the number of workers killed in a row before they took a job that is no chance


@dataclass
class _Worker:
    """A process, our end of its pipe, the place of its job, and whether it has begun to serve."""

    process: BaseProcess
    connection: Connection
    job: int | None = None
    serves: bool = False

    def end(self) -> None:
        """Do not wait for what is under way; an idle worker ends by itself as its pipe does."""
        if self.job is not None or not self.serves:
            self.process.kill()
        self.connection.close()
        self.process.join()


@dataclass(frozen=True)
class _Raised:
    """What a job raised."""

    error: Exception


Crew = dict[Connection, _Worker]


@contextmanager
def crew_kept() -> Iterator[Crew]:
    """Processes that stay for another list of jobs, with the kernels that they have loaded by then; they end with the context."""
    crew: Crew = {}
    try:
        yield crew
    finally:
        for worker in crew.values():
            worker.end()


def in_processes(
    work: Callable[[Job], Result], jobs: Sequence[Job], workers: int, kept: Crew | None = None
) -> Generator[tuple[Job, Result], None, None]:
    """Each job with its result, as they are done by so many processes, each with one thread: the matrices are small.

    They are started afresh, so a program that asks for them must guard its own start by `if __name__ == "__main__"`; those of a kept crew
    are taken first, and left to it. Raises what a job raises; ShootstabError where no worker can be started, and at the end for jobs at
    which DEATHS workers died.
    """
    todo, deaths, stillborn = deque(range(len(jobs))), Counter[int](), 0
    crew: Crew = {} if kept is None else kept
    try:
        while todo or any(worker.job is not None for worker in crew.values()):
            busy = sum(worker.job is not None for worker in crew.values())
            while len(crew) < min(workers, len(todo) + busy):
                worker = _started()
                crew[worker.connection] = worker
            for worker in crew.values():
                if todo and worker.serves and worker.job is None:
                    worker.job = todo.popleft()
                    with suppress(OSError):  # it is dead: the end of its pipe is read next
                        worker.connection.send((work, jobs[worker.job]))
            for connection in wait(list(crew)):
                worker = crew[connection]  # type: ignore[index]
                place = worker.job
                try:
                    answer = worker.connection.recv()
                except (EOFError, OSError):
                    del crew[worker.connection]
                    worker.end()
                    if place is not None:
                        deaths[place] += 1
                        if deaths[place] < DEATHS:
                            todo.appendleft(place)
                    elif not worker.serves:
                        stillborn += 1
                        require_start(worker.process.exitcode or 0, stillborn)
                    continue
                worker.job, worker.serves, stillborn = None, True, 0
                if isinstance(answer, _Raised):
                    raise answer.error
                if place is not None:
                    yield jobs[place], answer
    finally:
        for connection, worker in list(crew.items()):
            if kept is None or worker.job is not None or not worker.serves:
                del crew[connection]
                worker.end()
    lost = sum(n >= DEATHS for n in deaths.values())
    if lost:
        raise ShootstabError(f"{lost} of {len(jobs)} jobs are not done: {DEATHS} worker processes died at each, as where memory runs out")


def require_start(status: int, stillborn: int) -> None:
    """Raise ShootstabError where a worker died before it served by itself, or where too many were killed in a row."""
    if status > 0:
        guard = 'a program must guard its start by `if __name__ == "__main__"`'
        raise ShootstabError(f"a worker process ended as it started, with exit status {status}: {guard}")
    if stillborn >= STILLBORN:
        raise ShootstabError(f"{stillborn} worker processes in a row were killed as they started: memory may have run out")


def _started() -> _Worker:
    """A new process. It knows only its pipe: what is larger could fill the pipe by which Python starts it, and wait for ever for a reader
    that was killed.
    """
    context = get_context("spawn")
    ours, theirs = context.Pipe()
    process = context.Process(target=_serve, args=(theirs,), daemon=True)
    try:
        with one_thread(), _no_signals():
            process.start()
    except OSError as error:
        ours.close()
        raise ShootstabError(f"a worker process cannot be started: {error.strerror or error}") from error
    finally:
        theirs.close()
    return _Worker(process, ours)


@contextmanager
def _no_signals() -> Iterator[None]:
    """A signal that the parent makes an exception of waits until its worker has what it needs to start: half of that is a traceback there.

    What is started here has the signals blocked. Ctrl-C, which goes to all processes of a terminal, is the parent's business and remains
    so; the others the worker takes again as it begins to serve.
    """
    if not hasattr(signal, "pthread_sigmask"):
        yield
        return
    resource_tracker.ensure_running()  # it would unblock them as it starts
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT, *_ENDING})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


# what follows runs in the worker


def _serve(connection: Connection) -> None:
    """Say that a job can be taken, do it, and send its result, until the parent is gone."""
    if hasattr(signal, "pthread_sigmask"):
        signal.pthread_sigmask(signal.SIG_UNBLOCK, _ENDING)
    _depend_on_the_parent()
    answer: Any = None
    with suppress(EOFError, OSError):
        while True:
            connection.send(answer)
            answer = _answered(connection.recv_bytes())


def _answered(message: bytes) -> Any:
    """The result of a job, or what it raised, with its traceback as a note: a traceback itself does not pass through a pipe."""
    try:
        work, job = pickle.loads(message)
        return work(job)
    except Exception as error:
        error.add_note("in a worker process:\n" + "".join(traceback.format_exception(error)))
        try:
            pickle.loads(pickle.dumps(error))
        except Exception:  # an exception of somebody else's may be anything
            return _Raised(ShootstabError(f"{type(error).__name__} in a worker process: {error}"))
        return _Raised(error)


def _depend_on_the_parent() -> None:
    """Where the parent dies, by whatever hand, the worker ends, also in the midst of a job."""
    parent = parent_process()

    def watch() -> None:
        assert parent is not None
        parent.join()
        os._exit(1)

    if parent is not None:
        Thread(target=watch, daemon=True).start()
