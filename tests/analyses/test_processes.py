"""analyses/processes.py: whoever is killed, every job is done, nothing is left behind, and what cannot go on says why."""

from __future__ import annotations

import os
import random
import signal
import subprocess
import sys
import time
from multiprocessing import active_children
from pathlib import Path

import pytest

from shootstab.analyses.processes import DEATHS, STILLBORN, crew_kept, in_processes, require_start
from shootstab.core.errors import InputError, ShootstabError

JOBS = 60


def slowly(x: int) -> int:
    time.sleep(0.02)
    return x * x


def deadly(x: int) -> int:
    """A job that kills whoever does it."""
    if x == 3:
        os.kill(os.getpid(), signal.SIGKILL)
    return x


def refused(x: int) -> int:
    if x == 2:
        raise InputError(f"x = {x}: allowed is another")
    return x


class StubbornError(Exception):
    """An exception that no pipe can carry."""

    def __init__(self, a: int, b: int) -> None:
        super().__init__(f"{a} and {b}")


def stubborn(x: int) -> int:
    raise StubbornError(x, x)


def test_every_job_is_done_whoever_is_killed() -> None:
    """A dozen workers or so die in the midst of a job, between two, or as they start."""
    before, rng, kills, done = set(active_children()), random.Random(1), 0, []
    for answer in in_processes(slowly, list(range(JOBS)), 3):
        done.append(answer)
        workers = sorted(set(active_children()) - before, key=lambda process: process.name)
        if rng.random() < 0.2 and workers:
            rng.choice(workers).kill()
            kills += 1
    assert sorted(done) == [(x, x * x) for x in range(JOBS)]  # each once
    assert kills > 5
    assert set(active_children()) == before


def test_a_job_that_kills_its_workers_is_left_and_the_others_are_done() -> None:
    done = []
    with pytest.raises(ShootstabError, match=f"1 of 6 jobs are not done: {DEATHS} worker processes died at each"):
        for job, result in in_processes(deadly, list(range(6)), 2):
            done.append((job, result))
    assert sorted(done) == [(x, x) for x in range(6) if x != 3]
    assert not active_children()


def test_what_a_job_raises_comes_out_with_its_traceback() -> None:
    with pytest.raises(InputError, match="x = 2: allowed is another") as caught:
        list(in_processes(refused, [1, 2], 1))
    assert "test_processes.py" in caught.value.__notes__[0]
    with pytest.raises(ShootstabError, match="StubbornError in a worker process: 1 and 1"):
        list(in_processes(stubborn, [1], 1))
    assert not active_children()


def whoever(x: int) -> int:
    time.sleep(0.02)
    return os.getpid()


def test_a_kept_crew_does_another_list_of_jobs_and_ends_with_its_context() -> None:
    """One that is killed between two lists is replaced; what raises, or is left in the midst of a list, costs the crew its busy workers."""
    with crew_kept() as crew:
        first = {pid for _, pid in in_processes(whoever, list(range(12)), 2, crew)}
        second = {pid for _, pid in in_processes(whoever, list(range(12)), 2, crew)}
        assert len(first) == 2
        assert second == first == {process.pid for process in active_children()}
        os.kill(min(first), signal.SIGKILL)
        assert sorted(x for x, _ in in_processes(whoever, list(range(12)), 2, crew)) == list(range(12))
        with pytest.raises(InputError, match="x = 2: allowed is another"):
            list(in_processes(refused, [1, 2], 1, crew))
        for _ in in_processes(slowly, list(range(12)), 2, crew):
            break
        assert sorted(in_processes(slowly, list(range(12)), 2, crew)) == [(x, x * x) for x in range(12)]
    assert not active_children()


UNGUARDED = """
from shootstab.analyses.processes import in_processes
print(list(in_processes(abs, [-1, -2], 2)))
"""
KILLED = """
import os, signal, time
from shootstab.analyses.processes import in_processes
if __name__ == "__main__":
    signal.signal(signal.SIGHUP, signal.SIG_DFL)
    work = in_processes(time.sleep, [0.0, 600.0, 600.0], 2)
    next(work)
    os.kill(os.getpid(), signal.{by})
"""

STARTING = """
import os, signal
from multiprocessing.context import SpawnProcess
from shootstab.analyses.processes import in_processes
started = []
def start(self, original=SpawnProcess.start):
    os.kill(os.getpid(), signal.SIGTERM)
    original(self)
    started.append(self)
def end(*_):
    raise SystemExit(7 if started else 8)
if __name__ == "__main__":
    SpawnProcess.start = start
    signal.signal(signal.SIGTERM, end)
    list(in_processes(abs, [-1, -2], 1))
"""


def test_a_program_without_a_guard_is_told_so(tmp_path: Path) -> None:
    script = tmp_path / "unguarded.py"
    script.write_text(UNGUARDED)
    done = subprocess.run([sys.executable, script], capture_output=True, text=True, timeout=60)
    assert done.returncode == 1
    assert 'a program must guard its start by `if __name__ == "__main__"`' in done.stderr.splitlines()[-1]


def test_a_signal_waits_until_a_worker_has_what_it_needs_to_start(tmp_path: Path) -> None:
    """Else it would find half of it, and say so in a traceback."""
    script = tmp_path / "starting.py"
    script.write_text(STARTING)
    done = subprocess.run([sys.executable, script], capture_output=True, text=True, timeout=60, check=False)
    assert (done.returncode, done.stderr) == (7, "")


@pytest.mark.parametrize("by", ["SIGKILL", "SIGTERM", "SIGHUP"])
def test_workers_end_with_their_parent_and_leave_nothing(tmp_path: Path, by: str) -> None:
    """Also in the midst of a job, and with nothing to say: no semaphore leaks, for there is none."""
    script = tmp_path / "killed.py"
    script.write_text(KILLED.format(by=by))
    with subprocess.Popen([sys.executable, script], stderr=subprocess.PIPE, text=True, start_new_session=True) as program:
        assert program.stderr is not None
        assert program.stderr.read() == ""  # it ends when the last process that could write to it does
    assert program.returncode == -signal.Signals[by]


def test_workers_that_die_as_they_start_say_so() -> None:
    with pytest.raises(ShootstabError, match=f"{STILLBORN} worker processes in a row were killed as they started: memory may have run out"):
        require_start(-signal.SIGKILL, STILLBORN)
    with pytest.raises(ShootstabError, match="a worker process ended as it started, with exit status 1: a program must guard its start"):
        require_start(1, 1)
    require_start(-signal.SIGKILL, STILLBORN - 1)
