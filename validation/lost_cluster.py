"""A sweep on a Dask cluster that loses a worker, and one that loses its scheduler, by SIGKILL at random moments.

`python validation/lost_cluster.py --number 10` loses so many of each, `--quick` one of each. A scheduler and two workers are processes of
their own. Where a worker is lost its points are done by the other, or by the one that takes its place: the sweep ends with status 0 and
the results and the answer of an undisturbed run, value for value. Where the scheduler is lost the command ends within WITHIN seconds, with
status 1 and one line; what is stored is of the undisturbed run, and the next run, on a new cluster, ends with its results. Exit status 1 if
anything was lost, counted twice, left behind or said in more than a line.
"""

from __future__ import annotations

import argparse
import random
import signal
import socket
import subprocess
import sys
import tempfile
import time
from contextlib import ExitStack
from pathlib import Path

from kills import Findings, KilledRun, Rows, answered, ended, environment, stored

LINES = 60  # chosen: lines of two points each
SWEEP = ["sweep", "layer:scene", "--kx", "0:3:2", "--far-temperature", f"50:60:{LINES}"]
WITHIN = 60.0  # chosen: seconds in which a command notes that its scheduler is gone
WORKERS, SCHEDULERS = "Dask workers killed by SIGKILL", "Dask schedulers killed by SIGKILL"
PATIENCE = 60.0  # chosen: seconds in which a scheduler listens, and the first points are stored


class DaskCluster:
    """A scheduler and workers of one thread each, all processes of their own, ended with the block."""

    def __init__(self, folder: Path) -> None:
        with socket.socket() as free:
            free.bind(("127.0.0.1", 0))
            self.port = free.getsockname()[1]
        self.address = f"tcp://127.0.0.1:{self.port}"
        self.folder = folder
        self.scheduler = self._started("scheduler", "--host", "127.0.0.1", "--port", str(self.port), "--no-dashboard")
        until = time.monotonic() + PATIENCE
        while time.monotonic() < until:
            with socket.socket() as there:
                if there.connect_ex(("127.0.0.1", self.port)) == 0:
                    break
            time.sleep(0.1)
        self.workers = [self.worker(), self.worker()]

    def worker(self) -> subprocess.Popen[bytes]:
        """One more."""
        return self._started("worker", self.address, "--nthreads", "1", "--no-nanny", "--no-dashboard", "--death-timeout", "30")

    def _started(self, *words: str) -> subprocess.Popen[bytes]:
        return subprocess.Popen(
            [sys.executable, "-m", "dask", *words],
            env=environment(),
            cwd=self.folder,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
            start_new_session=True,
        )

    def __enter__(self) -> DaskCluster:
        return self

    def __exit__(self, *_: object) -> None:
        for process in (*self.workers, self.scheduler):
            process.kill()
        for process in (*self.workers, self.scheduler):
            process.wait()


def begun(file: Path, run: KilledRun) -> int:
    """How many points are stored as the first of them are, or as the run ends."""
    until = time.monotonic() + PATIENCE
    while run.process.poll() is None and time.monotonic() < until:
        count = len(stored(file))
        if count:
            return count
        time.sleep(0.05)
    return len(stored(file))


def lost_worker(rng: random.Random, folder: Path, calm: tuple[Rows, object], found: Findings) -> None:
    """One of two workers is killed while both work, and every other time another takes its place."""
    file = folder / "worker.sqlite"
    file.unlink(missing_ok=True)
    with DaskCluster(folder) as cluster:
        run = KilledRun.of([*SWEEP, "--dask", cluster.address, "--out", file.name, "--json", "worker.json"], folder)
        begun(file, run)
        time.sleep(rng.uniform(0.0, 1.0))
        if run.process.poll() is None:
            found.counts[WORKERS] += 1
        cluster.workers[rng.randrange(2)].kill()
        if rng.random() < 0.5:
            cluster.workers.append(cluster.worker())
        status = ended(run, None, found)
    found.require(status == 0, f"a worker lost: status {status}")
    found.require(stored(file) == calm[0], "a worker lost: not the results of an undisturbed run")
    found.require(answered(folder / "worker.json") == calm[1], "a worker lost: not the answer of an undisturbed run")


def lost_scheduler(rng: random.Random, folder: Path, calm: tuple[Rows, object], found: Findings) -> None:
    """The scheduler is killed; a new cluster goes on."""
    file = folder / "scheduler.sqlite"
    file.unlink(missing_ok=True)
    with DaskCluster(folder) as cluster:
        run = KilledRun.of([*SWEEP, "--dask", cluster.address, "--out", file.name], folder)
        begun(file, run)
        time.sleep(rng.uniform(0.0, 1.0))
        over = run.process.poll() is not None
        cluster.scheduler.send_signal(signal.SIGKILL)
        since = time.monotonic()
        status = run.process.wait()
        took = time.monotonic() - since
        said, left = run.said(), run.left()
    before = stored(file)
    if not over:
        found.counts[SCHEDULERS] += 1
    whole = len(before) == len(calm[0])
    found.require(status == (0 if whole else 1) and took <= WITHIN, f"the scheduler lost: status {status} after {took:.0f} s")
    found.require(len(said) == (status != 0), f"the scheduler lost: {said}")
    found.require(whole or any("scheduler is lost" in line for line in said), f"the scheduler lost: {said}")
    found.require(not left, f"the scheduler lost: {left} left behind")
    found.require(before.items() <= calm[0].items(), "the scheduler lost: a stored result is not that of an undisturbed run")
    with DaskCluster(folder) as cluster:
        run = KilledRun.of([*SWEEP, "--dask", cluster.address, "--out", file.name, "--json", "scheduler.json"], folder)
        found.require(ended(run, None, found) == 0, "after a lost scheduler: the next run did not end well")
    found.require(stored(file) == calm[0], "after a lost scheduler: not the results of an undisturbed run")
    found.require(answered(folder / "scheduler.json") == calm[1], "after a lost scheduler: not the answer of an undisturbed run")


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--number", type=int, default=10, metavar="N", help="of each")
    parser.add_argument("--seed", type=int, default=1, metavar="N")
    parser.add_argument("--quick", action="store_true", help="one of each")
    options = parser.parse_args()
    rng, found = random.Random(options.seed), Findings()
    began = time.monotonic()
    with ExitStack() as stack:
        folder = Path(stack.enter_context(tempfile.TemporaryDirectory(prefix="shootstab-cluster-")))
        ended(KilledRun.of([*SWEEP, "--out", "calm.sqlite", "--json", "calm.json"], folder), None, found)
        calm = stored(folder / "calm.sqlite"), answered(folder / "calm.json")
        found.require(len(calm[0]) == 2 * LINES, "the undisturbed run is not whole")
        for _ in range(1 if options.quick else options.number):
            lost_worker(rng, folder, calm, found)
            lost_scheduler(rng, folder, calm, found)
            print(f"{dict(found.counts)}, {len(found.wrong)} wrong, {time.monotonic() - began:.0f} s", flush=True)
    for lost in (WORKERS, SCHEDULERS):
        found.require(found.counts[lost] > 0, f"{lost}: none, every run was over before")
    print(f"{found.counts.total()} killed; {len(found.wrong)} wrong; {time.monotonic() - began:.0f} s")
    return bool(found.wrong)


if __name__ == "__main__":
    sys.exit(main())
