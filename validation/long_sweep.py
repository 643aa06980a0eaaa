"""A sweep of 10^5 points over a night, in one process and to one file: memory is flat, the store sound, the time a point constant.

`python validation/long_sweep.py FILE` sweeps the layers over k_x and a (`layer.py`), whose modes are known exactly, and notes after every
EVERY points what they took, in FILE.jsonl. Ended by a signal, a lost machine or a full disk, it goes on by the same command where it
stopped. `--check` computes nothing and says what stands in the two files by now. At the end the store is held against the exact modes,
point by point. `--points N` takes fewer. Exit status 1 if a point is lost, double or wrong, or if memory or the time a point grows.
"""

from __future__ import annotations

import argparse
import json
import math
import os
import sqlite3
import sys
import time
from collections import Counter
from contextlib import closing
from pathlib import Path
from typing import Any

import layer
import numpy as np

import shootstab as st

WAVES, LARGEST_WAVE = 50, 8.0  # chosen: points of a line, and a k_x beyond which nothing grows for any a that is swept
LEAST_A, LARGEST_A = 50.0, 60.0  # chosen: one or two modes grow at k_x = 0
EVERY = 2_000  # chosen: points between two lines of the record
COUNTED_EVERY = 25  # chosen: points of a line between two counts
WARM = 0.1  # chosen: part of the points before which memory is not judged, for caches fill
OF_A_POINT = 2_000  # chosen: bytes that the outcome of a point and its key may take in the answer
SLOWER = 1.25  # chosen: ratio of the processor time a point in the last and in the first half of the record


def axes(points: int) -> dict[str, Any]:
    """The axes of so many points."""
    return {"kx": np.linspace(0.0, LARGEST_WAVE, WAVES), layer.SOURCE: np.linspace(LEAST_A, LARGEST_A, max(2, points // WAVES))}


def resident() -> int:
    """Bytes of memory that this process has now."""
    return int(Path("/proc/self/statm").read_text().split()[1]) * os.sysconf("SC_PAGE_SIZE")


def record_of(file: Path) -> Path:
    """The record beside the store."""
    return file.with_name(f"{file.name}.jsonl")


def swept(points: int, file: Path) -> None:
    """Sweep on, with a line in the record after every EVERY points."""
    noted: list[int] = []
    before = 0.0

    def note(done: int, total: int) -> None:
        nonlocal before
        if not noted or done - noted[-1] >= EVERY or (done == total and done > noted[-1]):
            now = time.process_time()
            if noted:
                line = {"points": done, "made": done - noted[-1], "seconds": now - before, "resident": resident(), "process": os.getpid()}
                with record_of(file).open("a") as record:
                    record.write(f"{json.dumps(line)}\n")
            noted.append(done)
            before = now

    st.sweep(layer.layer(layer.A), axes(points), every=COUNTED_EVERY, out=file, progress=note)


def store_is_wrong(points: int, file: Path) -> list[str]:
    """What is wrong with the points that are stored by now."""
    with closing(sqlite3.connect(f"{file.absolute().as_uri()}?mode=ro", uri=True)) as base:
        wrong = [f"integrity: {said}" for (said,) in base.execute("PRAGMA integrity_check") if said != "ok"]
        rows = base.execute("SELECT kx, far_temperature, re, im, error, status FROM points").fetchall()
    wanted = axes(points)
    grid = {(float(k), float(a)) for k in wanted["kx"] for a in wanted[layer.SOURCE]}
    stored = Counter((k, a) for k, a, *_ in rows)
    wrong += [f"{point} stands {n} times" for point, n in stored.items() if n > 1]
    wrong += [f"{point} is not of the grid" for point in stored if point not in grid]
    statuses: Counter[str] = Counter()
    for k, a, re, im, error, status in rows:
        statuses[status.partition(":")[0]] += 1
        truth = layer.exact(a, k)
        if truth <= 0.0:
            holds = status == "no growing mode" and re is None
        else:
            holds = status in ("proved", "followed") and math.hypot(re - truth, im) <= error
        if not holds:
            wrong.append(f"k_x = {k!r}, a = {a!r}: {status} {re!r} +- {error!r}, true is {truth!r}")
    told = ", ".join(f"{n} {status}" for status, n in sorted(statuses.items()))
    print(f"{len(rows)} of {len(grid)} points: {told}; {len(wrong)} wrong")
    return wrong


def record_is_wrong(file: Path) -> list[str]:
    """What grows in the record: the memory of each process after it is warm, by more than its answers; the time a point."""
    lines = [json.loads(line) for line in record_of(file).read_text().splitlines()]
    wrong = []
    for process in dict.fromkeys(line["process"] for line in lines):
        own = [line for line in lines if line["process"] == process]
        warm = own[math.ceil(WARM * len(own)) :]
        made = sum(line["made"] for line in own)
        told = f"{made} points by one process: {sum(line['seconds'] for line in own) / made * 1e3:.2f} ms of processor time each"
        if len(warm) > 1:
            slope = np.polyfit([line["points"] for line in warm], [line["resident"] for line in warm], 1)[0]
            told += f", {min(line['resident'] for line in own) >> 20} to {max(line['resident'] for line in own) >> 20} MiB"
            told += f", {slope:.0f} bytes a point"
            if slope > OF_A_POINT:
                wrong.append(f"memory grows by {slope:.0f} bytes a point")
        print(told)
    half = len(lines) // 2
    if half:
        first, last = (sum(x["seconds"] for x in part) / sum(x["made"] for x in part) for part in (lines[:half], lines[half:]))
        print(f"time a point in the last half over that in the first: {last / first:.2f}")
        if last > SLOWER * first:
            wrong.append(f"the time a point grows from {1e3 * first:.2f} to {1e3 * last:.2f} ms")
    return wrong


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("file", type=Path, metavar="FILE", help="of results; its record stands beside it")
    parser.add_argument("--points", type=int, default=100_000, metavar="N")
    parser.add_argument("--check", action="store_true", help="compute nothing")
    options = parser.parse_args()
    if not options.check:
        swept(options.points, options.file)
    wrong = [*store_is_wrong(options.points, options.file), *record_is_wrong(options.file)]
    for said in wrong[:20]:
        print(f"  WRONG: {said}")
    return bool(wrong)


if __name__ == "__main__":
    sys.exit(main())
