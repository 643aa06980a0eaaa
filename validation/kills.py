"""Sweeps, `find`, `verify` and `prove` that are killed: parent and workers, by SIGKILL, SIGTERM, SIGINT, SIGHUP, SIGSEGV, at random times.

`python validation/kills.py --kills 300` goes on until so many processes have been killed, `--quick` kills a dozen. After every death of a
parent no process of its session may be left, and nothing but one line on standard error; the file of results may only have grown, by
whole lines and by the values of an undisturbed run; a sweep that is asked for again until it ends has exactly those. Then the faults: a
full disk, a file cut or overwritten at random, one that is read-only, two runs on one file, another scene on it, and a clock that is
turned by ten years at every look. Exit status 1 if anything was lost, counted twice, left behind or said in more than a line.
"""

from __future__ import annotations

import argparse
import ctypes
import json
import math
import os
import random
import re
import resource
import shutil
import signal
import sqlite3
import subprocess
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Callable, Mapping
from contextlib import closing, suppress
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from layer import A

HERE = Path(__file__).parent
BY_ITSELF = (signal.SIGKILL, signal.SIGTERM, signal.SIGINT, signal.SIGHUP)  # signals to the parent
AT_WORKERS = (signal.SIGKILL, signal.SIGTERM, signal.SIGSEGV)  # signals to a worker
LINES = 10  # chosen: lines of two points each
SWEEP = ["sweep", "layer:scene", "--kx", "0:3:2", "--far-temperature", f"50:60:{LINES}", "--workers", "2"]
FIND = ["find", "layer:scene", "--corners=1,-5,60,5"]
VERIFY = ["verify", "layer:scene", "claims.csv"]
PROVE = ["prove", "benard", "--disc=2.1463,0,0.01"]
PROGRESS = re.compile(r"shootstab: [a-z]+ing .+, \d+ s")  # a line that says how far it is, every ten seconds of a log
PR_CAPBSET_DROP, CAP_DAC_OVERRIDE, CAP_DAC_READ_SEARCH = 24, 1, 2  # defined by the kernel: constants of Linux, prctl(2), capabilities(7)
# every look at the clock of the wall finds it ten years back, right, or ten years ahead, in turn; what measures durations is left
TURNED_CLOCK = r"""
#define _GNU_SOURCE
#include <dlfcn.h>
#include <sys/time.h>
#include <time.h>

static long turned(void) {
    static unsigned looks;
    return ((long)(__sync_add_and_fetch(&looks, 1) % 3) - 1) * 315360000L;
}

int clock_gettime(clockid_t clock, struct timespec *t) {
    int (*real)(clockid_t, struct timespec *) = dlsym(RTLD_NEXT, "clock_gettime");
    int status = real(clock, t);
    if (status == 0 && (clock == CLOCK_REALTIME || clock == CLOCK_REALTIME_COARSE)) t->tv_sec += turned();
    return status;
}

int gettimeofday(struct timeval *t, void *zone) {
    int (*real)(struct timeval *, void *) = dlsym(RTLD_NEXT, "gettimeofday");
    int status = real(t, zone);
    if (status == 0) t->tv_sec += turned();
    return status;
}

time_t time(time_t *at) {
    struct timeval now;
    gettimeofday(&now, 0);
    if (at) *at = now.tv_sec;
    return now.tv_sec;
}
"""
GONE = 10.0  # chosen: seconds within which a session must be empty after its parent
ROUNDS = 60  # chosen: the most runs of one sweep until it ends

Rows = dict[tuple[Any, ...], tuple[Any, ...]]


@dataclass
class Findings:
    """What was done, and what was wrong."""

    counts: Counter[str] = field(default_factory=Counter)
    wrong: list[str] = field(default_factory=list)

    def require(self, holds: bool, otherwise: str) -> None:
        """Note what is wrong unless it holds."""
        if not holds:
            self.wrong.append(otherwise)
            print(f"  WRONG: {otherwise}", flush=True)


def environment() -> dict[str, str]:
    """The environment of a process that finds this package and the layers, one thread each."""
    paths = [str(HERE), str(HERE.parent), os.environ.get("PYTHONPATH", "")]
    return {**os.environ, "PYTHONPATH": os.pathsep.join(p for p in paths if p), "OMP_NUM_THREADS": "1"}


def told(standard_error: str) -> list[str]:
    """Lines on standard error, without those that say how far it is: whether there are any is a matter of how busy the machine is."""
    return [line for line in standard_error.splitlines() if line.strip() and not PROGRESS.fullmatch(line)]


@dataclass
class KilledRun:
    """A command in a session of its own."""

    process: subprocess.Popen[str]
    log: Path

    @classmethod
    def of(
        cls, words: list[str], folder: Path, before: Callable[[], None] | None = None, variables: Mapping[str, str] | None = None
    ) -> KilledRun:
        """One that has begun, with what it does before anything else, and what it finds in its environment besides."""
        log = folder / "stderr"
        with log.open("w") as file:
            command = [sys.executable, "-m", "shootstab", *words]
            process = subprocess.Popen(
                command,
                env={**environment(), **(variables or {})},
                cwd=folder,
                stdout=subprocess.DEVNULL,
                stderr=file,
                text=True,
                start_new_session=True,
                preexec_fn=before,
            )
        return cls(process, log)

    def workers(self) -> list[int]:
        """Processes that it started to work."""
        listed = subprocess.run(["ps", "-A", "-o", "pid=,ppid=,args="], capture_output=True, text=True, check=True).stdout
        rows = [line.split(None, 2) for line in listed.splitlines()]
        return [int(pid) for pid, parent, command in rows if int(parent) == self.process.pid and "spawn_main" in command]

    def left(self) -> list[str]:
        """Living processes of its session, after GONE seconds at most."""
        until = time.monotonic() + GONE
        while True:
            listed = subprocess.run(["ps", "-A", "-o", "sid=,stat=,args="], capture_output=True, text=True, check=True).stdout
            rows = [line.split(None, 2) for line in listed.splitlines()]
            alive = [row[2] for row in rows if int(row[0]) == self.process.pid and not row[1].startswith("Z")]
            if not alive or time.monotonic() > until:
                return alive
            time.sleep(0.05)

    def said(self) -> list[str]:
        """Lines on standard error, without those that say how far it is."""
        return told(self.log.read_text(errors="replace"))


def ended(run: KilledRun, by: signal.Signals | None, found: Findings) -> int:
    """Wait for the end of a run that was sent this signal, and hold it against the rules; its exit status."""
    status = run.process.wait()
    left = run.left()
    found.require(not left, f"{left} left behind by a parent that ended with {status}")
    said = run.said()
    if by is not None and status == -by:
        if by != signal.SIGKILL:
            found.counts["signals before the command had begun"] += 1
            if by == signal.SIGINT:
                return status  # Python's own words for an interrupt while it starts
        found.require(not said, f"{by.name}: {said}")
    else:
        found.require(len(said) == (status != 0), f"exit status {status}: {said}")
        allowed = (0,) if by is None else (0, 128 + by)
        found.require(status in allowed, f"exit status {status} after {by.name if by else 'nothing'}: {said}")
    return status


def stored(file: Path) -> Rows:
    """What the file of results holds, by (k_x, a)."""
    if not file.exists():
        return {}
    with closing(sqlite3.connect(file)) as base:
        try:
            rows = base.execute("SELECT * FROM points").fetchall()
        except sqlite3.OperationalError:  # the table is not made yet
            return {}
    return {row[:2]: row[2:] for row in rows}


def undisturbed(folder: Path, found: Findings) -> tuple[Rows, Any]:
    """Rows and points of a sweep that nobody disturbs."""
    run = KilledRun.of([*SWEEP, "--out", "calm.sqlite", "--json", "calm.json"], folder)
    ended(run, None, found)
    return stored(folder / "calm.sqlite"), answered(folder / "calm.json")


def answered(file: Path) -> Any:
    """The JSON document but for the seconds that it took."""
    document = json.loads(file.read_text())
    del document["seconds"]
    return document


def killed_sweep(rng: random.Random, folder: Path, calm: tuple[Rows, Any], seconds: float, kills: int, found: Findings) -> None:
    """One sweep, its workers and its parent killed so often, asked for again until it ends."""
    rows, document = calm
    file, answer = folder / "a.sqlite", folder / "a.json"
    for old in (file, answer):
        old.unlink(missing_ok=True)
    before: Rows = {}
    made = 0
    for _ in range(ROUNDS):
        run = KilledRun.of([*SWEEP, "--out", file.name, "--json", answer.name], folder)
        by = None
        while run.process.poll() is None and made < kills:
            time.sleep(rng.uniform(0.0, seconds / 4))
            workers = run.workers()
            if rng.random() < 0.7 and workers:
                with suppress(ProcessLookupError):
                    sent = rng.choice(AT_WORKERS)
                    os.kill(rng.choice(workers), sent)
                    made += 1
                    found.counts[f"workers killed by {sent.name}"] += 1
            elif run.process.poll() is None:
                by = rng.choice(BY_ITSELF)
                run.process.send_signal(by)
                made += 1
                found.counts[f"parents killed by {by.name}"] += 1
                break
        status = ended(run, by, found)
        now = stored(file)
        found.require(all(now.get(key) == value for key, value in before.items()), "a stored result was lost or changed")
        found.require(all(rows.get(key) == value for key, value in now.items()), "a stored result is not that of an undisturbed run")
        found.require(len(now) % 2 == 0, f"{len(now)} points are stored: a line in part")
        before = now
        if status == 0:
            break
    found.counts["sweeps"] += 1
    found.require(status == 0, f"a sweep did not end in {ROUNDS} rounds")
    found.require(before == rows, "the results are not those of an undisturbed run")
    if status == 0:
        found.require(answered(answer) == document, "the answer is not that of an undisturbed run")


def killed_command(rng: random.Random, words: list[str], folder: Path, seconds: float, found: Findings) -> None:
    """A command without workers, killed once: its file is there whole or not at all."""
    answer = folder / "b.json"
    answer.unlink(missing_ok=True)
    run = KilledRun.of([*words, "--json", answer.name], folder)
    time.sleep(rng.uniform(0.0, seconds))
    by = rng.choice(BY_ITSELF)
    if run.process.poll() is None:
        run.process.send_signal(by)
        found.counts[f"{words[0]} killed by {by.name}"] += 1
    ended(run, by, found)
    beside = [p.name for p in folder.glob(".b.*")]
    if by == signal.SIGKILL:
        for name in beside:
            (folder / name).unlink()
    found.require(not beside or by == signal.SIGKILL, f"{beside} left beside the answer")
    if answer.exists():
        json.loads(answer.read_text())


# faults


def full_disk(rng: random.Random, folder: Path, calm: tuple[Rows, Any], found: Findings) -> None:
    """A file that may not grow: status 4 or 2, one line; what was stored is right, and the next run ends with everything."""
    file = folder / "full.sqlite"
    file.unlink(missing_ok=True)
    most = rng.choice((512, 4096, 8192, 12288, 14000, 16384))  # bytes that a file may have: a full disk as a process sees it
    run = KilledRun.of([*SWEEP, "--out", file.name], folder, lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (most, most)))
    status = run.process.wait()
    found.require(status in (0, 2, 4) and len(run.said()) == (status != 0), f"full disk: status {status}, {run.said()}")
    found.require(not run.left(), "full disk: a process is left")
    found.require(stored(file).items() <= calm[0].items(), "full disk: a stored result is wrong")
    run = KilledRun.of([*SWEEP, "--out", file.name], folder)
    found.require(ended(run, None, found) == 0 and stored(file) == calm[0], "after a full disk: not the results of an undisturbed run")


def damaged(rng: random.Random, folder: Path, calm: tuple[Rows, Any], found: Findings) -> None:
    """A file cut off or overwritten at random: refused in one line, or read; what a cut leaves is completed to the undisturbed results."""
    file = folder / "torn.sqlite"
    data = bytearray((folder / "calm.sqlite").read_bytes())
    at = rng.randrange(len(data))
    cut = rng.random() < 0.5
    if cut:
        del data[at:]
    else:
        size = rng.choice((1, 16, 512))
        data[at : at + size] = rng.randbytes(size)
    file.write_bytes(data)
    run = KilledRun.of([*SWEEP, "--out", file.name, "--json", "torn.json"], folder)
    status = run.process.wait()
    said = run.said()
    found.require(status in (0, 1, 2) and len(said) == (status == 2), f"damaged file: status {status}, {said}")
    found.require(not run.left(), "damaged file: a process is left")
    found.counts[f"damaged files {'refused' if status == 2 else 'read'}"] += 1
    if cut and status == 0:
        found.require(stored(file) == calm[0], "a file that was cut gives other results")


def obey_modes() -> None:
    """Root may write everywhere, whatever the modes of files say: what this process starts may not."""
    if os.geteuid() != 0:
        return
    for capability in (CAP_DAC_OVERRIDE, CAP_DAC_READ_SEARCH):
        if ctypes.CDLL(None, use_errno=True).prctl(PR_CAPBSET_DROP, capability, 0, 0, 0) != 0:
            raise OSError(ctypes.get_errno(), "root cannot be made to obey the modes of files: run this as another user")


def read_only(_: random.Random, folder: Path, calm: tuple[Rows, Any], found: Findings) -> None:
    """A file with half of the points that may not be written to, one in a folder that may not, and one with the journal of a run that
    was killed in the midst of writing: refused in a line and left as it is; where it may be written to, the sweep goes on from it. One
    with all points is read."""
    whole = folder / "whole.sqlite"
    whole.unlink(missing_ok=True)
    whole.write_bytes((folder / "calm.sqlite").read_bytes())
    whole.chmod(0o444)
    run = KilledRun.of([*SWEEP, "--out", whole.name, "--json", "whole.json"], folder, obey_modes)
    found.require(ended(run, None, found) == 0 and answered(folder / "whole.json") == calm[1], "a whole read-only file: not what it holds")
    for title, locked, journal in (("file", "file", False), ("folder", "folder", False), ("file with a journal", "folder", True)):
        inside = folder / "kept"
        inside.mkdir()
        file = inside / "kept.sqlite"
        file.write_bytes((folder / "calm.sqlite").read_bytes())
        with closing(sqlite3.connect(file)) as base, base:
            base.execute("DELETE FROM points WHERE far_temperature > 55")
        if journal:
            halfway = f"b = sqlite3.connect({str(file)!r}, isolation_level=None); b.execute('PRAGMA cache_size = 1'); b.execute('BEGIN')"
            halfway += "; b.execute('UPDATE points SET re = 7.0, beside = hex(zeroblob(9999))'); os._exit(0)"
            subprocess.run([sys.executable, "-c", f"import os, sqlite3; {halfway}"], check=True)
            found.require(len(list(inside.iterdir())) == 2, "no journal was left to be tried")
        before = {path.name: path.read_bytes() for path in inside.iterdir()}
        target = file if locked == "file" else inside
        target.chmod(0o444 if locked == "file" else 0o555)
        run = KilledRun.of([*SWEEP, "--out", str(file)], folder, obey_modes)
        status = run.process.wait()
        target.chmod(0o755)
        found.require(status == 2 and len(run.said()) == 1, f"read-only {title}: status {status}, {run.said()}")
        found.require({path.name: path.read_bytes() for path in inside.iterdir()} == before, f"read-only {title}: it was written to")
        run = KilledRun.of([*SWEEP, "--out", str(file)], folder, obey_modes)
        found.require(
            ended(run, None, found) == 0 and stored(file) == calm[0], f"{title}, after it was read-only: not the undisturbed results"
        )
        shutil.rmtree(inside)


def turned_clock(rng: random.Random, folder: Path, calm: tuple[Rows, Any], found: Findings) -> None:
    """A clock of the wall that is turned at every look, in the parent and its workers, one of which is killed: the undisturbed results."""
    compiler = shutil.which("cc")
    if compiler is None:
        found.counts["turned clocks not tried: no C compiler"] += 1
        return
    shim, file, answer = folder / "clock.so", folder / "turned.sqlite", folder / "turned.json"
    if not shim.exists():
        subprocess.run([compiler, "-shared", "-fPIC", "-O1", "-x", "c", "-o", shim, "-", "-ldl"], input=TURNED_CLOCK, text=True, check=True)
    variables = {"LD_PRELOAD": str(shim)}
    looked = "import time; a, b, c = time.time(), time.time(), time.time(); print(max(a, b, c) - min(a, b, c) > 1e8)"
    seen = subprocess.run([sys.executable, "-c", looked], env={**os.environ, **variables}, capture_output=True, text=True, check=True)
    found.require(seen.stdout == "True\n", "the clock was not turned")
    file.unlink(missing_ok=True)
    run = KilledRun.of([*SWEEP, "--out", file.name, "--json", answer.name], folder, variables=variables)
    until = time.monotonic() + GONE
    while not (workers := run.workers()) and run.process.poll() is None and time.monotonic() < until:
        time.sleep(0.05)
    if workers:
        with suppress(ProcessLookupError):
            os.kill(rng.choice(workers), signal.SIGKILL)
            found.counts["workers killed by SIGKILL"] += 1
    found.require(ended(run, None, found) == 0 and stored(file) == calm[0], "turned clock: not the results of an undisturbed run")
    found.require(answered(answer) == calm[1], "turned clock: not the answer of an undisturbed run")
    found.require(json.loads(answer.read_text())["seconds"] < 1e8, "turned clock: the seconds are those of the wall")


def two_at_once(rng: random.Random, folder: Path, calm: tuple[Rows, Any], found: Findings) -> None:
    """Two runs on one file: each ends well, and every point is there once."""
    file = folder / "two.sqlite"
    file.unlink(missing_ok=True)
    second = folder / "second"
    second.mkdir(exist_ok=True)
    first = KilledRun.of([*SWEEP, "--out", str(file), "--json", "1.json"], folder)
    time.sleep(rng.uniform(0.0, 1.0))
    other = KilledRun.of([*SWEEP, "--out", str(file), "--json", "2.json"], second)
    found.require([ended(first, None, found), ended(other, None, found)] == [0, 0], "two runs on one file: one did not end well")
    found.require(stored(file) == calm[0], "two runs on one file: not the results of an undisturbed run")
    for name in (folder / "1.json", second / "2.json"):
        found.require(answered(name) == calm[1], "two runs on one file: not the answer of an undisturbed run")


def another_scene(_: random.Random, folder: Path, calm: tuple[Rows, Any], found: Findings) -> None:
    """The file of one scene for another: refused, and left as it is."""
    words = ["sweep", "layer:other", *SWEEP[2:], "--out", "calm.sqlite"]
    run = KilledRun.of(words, folder)
    found.require(run.process.wait() == 2 and len(run.said()) == 1, f"another scene: {run.said()}")
    found.require(stored(folder / "calm.sqlite") == calm[0], "another scene changed the results")


FAULTS: dict[str, tuple[Callable[..., None], int]] = {
    "full disk": (full_disk, 6),
    "damaged file": (damaged, 24),
    "read-only file": (read_only, 1),
    "two runs at once": (two_at_once, 3),
    "another scene": (another_scene, 1),
    "turned clock": (turned_clock, 3),
}


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--kills", type=int, default=300, metavar="N", help="of sweeps; a third as many of other commands")
    parser.add_argument("--seed", type=int, default=1, metavar="N")
    parser.add_argument("--fault", action="append", choices=FAULTS, help="this fault, and no kills")
    parser.add_argument("--quick", action="store_true", help="a dozen kills, one fault of each kind")
    options = parser.parse_args()
    kills = 0 if options.fault else 12 if options.quick else options.kills
    for number in (signal.SIGINT, signal.SIGHUP):  # heeded by what is started here, whatever started this
        signal.signal(number, signal.default_int_handler)
    rng, found = random.Random(options.seed), Findings()
    began = time.monotonic()
    with tempfile.TemporaryDirectory(prefix="shootstab-kills-") as name:
        folder = Path(name)
        calm = undisturbed(folder, found)
        seconds = time.monotonic() - began
        found.require(len(calm[0]) == 2 * LINES, "the undisturbed run is not whole")
        made = 0
        while made < kills:
            each = min(rng.randint(2, 8), kills - made)
            killed_sweep(rng, folder, calm, seconds, each, found)
            made += each
            print(f"{made} kills of sweeps, {len(found.wrong)} wrong, {time.monotonic() - began:.0f} s", flush=True)
        (folder / "claims.csv").write_text(f"{A - math.pi**2!r},0\n")
        for i in range(kills // 3):
            killed_command(rng, (VERIFY, FIND, PROVE)[i % 3], folder, seconds / 2, found)
        for title, (fault, times) in FAULTS.items():
            if options.fault is not None and title not in options.fault:
                continue
            for _ in range(1 if options.quick else times):
                fault(rng, folder, calm, found)
                found.counts[f"faults: {title}"] += 1
    for title, count in sorted(found.counts.items()):
        print(f"{count:6d}  {title}")
    total = sum(n for title, n in found.counts.items() if " killed by " in title)
    print(f"{total} kills; {len(found.wrong)} wrong; {time.monotonic() - began:.0f} s")
    return bool(found.wrong)


if __name__ == "__main__":
    sys.exit(main())
