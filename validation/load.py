"""Load: ten thousand claims, files of a million entries, a sweep of many points; memory is flat and the time for each is constant.

`python validation/load.py` prints the figures: each question in a process of its own, seconds of processor time for each and the peak of
memory over what the program takes by itself. `--part 10` a tenth of each, `--quick` a hundredth, too few to tell of growth. Exit status 1
if memory grows with the number of claims or of points by more than what the answers themselves take, or the time for each by more than
half, or a file is not refused in words.
"""

from __future__ import annotations

import argparse
import json
import multiprocessing
import resource
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import layer
import numpy as np

A = 60.0  # chosen: two modes grow
HIGHEST = 100  # chosen: the last mode that is claimed: 3 steps of a mesh to each of its half waves stay below what verify asks at most
OWN = 12_000  # chosen: bytes that a verdict or a point of the answer may take with its texts


def claims(number: int) -> list[complex]:
    """What a raw spectrum holds, all different: of every hundred one mode, in turn right and with a wrong digit, and numbers that are none.

    The modes go from the first to number HIGHEST and begin again with another last digit; the rest is scattered over the modes' own range.
    """
    scattered = np.random.default_rng(1)
    low = layer.exact(A, 0.0, HIGHEST)
    found = []
    for i in range(number):
        turn, m = divmod(i // 100, HIGHEST)
        if i % 100 == 0:
            found.append(complex(layer.exact(A, 0.0, 1 + m) * (1 + 1e-4 * (m % 2) + 1e-9 * turn)))
        else:
            found.append(complex(scattered.uniform(low, A), scattered.uniform(-0.1 * abs(low), 0.1 * abs(low))))
    return found


def verdicts(number: int) -> dict[str, int]:
    """Verdicts on so many claims."""
    import shootstab as st

    return dict(st.verify(layer.layer(A), claims(number), missing="none").summary)


def sweep(number: int) -> dict[str, int]:
    """A sweep of so many points, to a file."""
    import shootstab as st

    with tempfile.TemporaryDirectory() as folder:
        axes = {"kx": np.linspace(0.0, 5.0, 50), "far_temperature": np.linspace(50.0, 60.0, number // 50)}
        found = st.sweep(layer.layer(A), axes, every=25, out=Path(folder) / "a.sqlite")
        again = st.sweep(layer.layer(A), axes, every=25, out=Path(folder) / "a.sqlite")
        assert found.outcomes == again.outcomes
    return found.summary


def read(kind: str, number: int) -> str:
    """What is said of a file of so many entries."""
    from shootstab.core.errors import InputError
    from shootstab.io import readers

    values = np.linspace(1.0, 2.0, number) * (1 + 1j)
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "modes"
        if kind == "npy":
            np.save(path.with_suffix(".npy"), values)
            path = path.with_suffix(".npy")
        elif kind == "json":
            path.write_text(json.dumps(np.column_stack((values.real, values.imag)).tolist()))
        else:
            path.write_text("re,im\n" + "".join(f"{z.real!r},{z.imag!r}\n" for z in values.tolist()))
        del values
        try:
            return f"{len(readers.read(path))} read"
        except InputError as error:
            return str(error).replace(str(path), "file")


def _peak() -> int:
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024


def _asked(question: Callable[..., Any], given: tuple[Any, ...], out: Any) -> None:
    verdicts(3)  # what the program takes by itself
    before, began = _peak(), time.process_time()
    answer = question(*given)
    out.send((answer, time.process_time() - began, _peak() - before))


def measured(question: Callable[..., Any], *given: Any) -> tuple[Any, float, int]:
    """The answer, processor seconds, and bytes of memory, in a process of its own."""
    context = multiprocessing.get_context("spawn")
    ours, theirs = context.Pipe()
    process = context.Process(target=_asked, args=(question, given, theirs))
    process.start()
    theirs.close()
    found: tuple[Any, float, int] = ours.recv()
    process.join()
    return found


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--part", type=int, default=1, metavar="N", help="an N-th of the claims and of the points")
    parser.add_argument("--quick", action="store_true", help="a hundredth of each")
    options = parser.parse_args()
    part = 100 if options.quick else options.part
    failed = False
    for name, question, numbers in (
        ("claims", verdicts, (1000 // part, 10_000 // part)),
        ("points of a sweep", sweep, (1000 // part, 10_000 // part)),
    ):
        few, many = (measured(question, max(n, 50)) for n in numbers)
        for number, (answer, seconds, grown) in zip(numbers, (few, many), strict=True):
            print(f"{number:7d} {name}: {1e3 * seconds / number:.2f} ms and {grown / number / 1024:.1f} KiB each; {answer}", flush=True)
        if not options.quick:
            flat = many[2] - few[2] <= OWN * (numbers[1] - numbers[0])
            constant = many[1] / numbers[1] <= 1.5 * few[1] / numbers[0]
            print(f"        memory {'is flat' if flat else 'GROWS'}, the time for each {'is constant' if constant else 'GROWS'}")
            failed |= not (flat and constant)
    for kind in ("npy", "json", "text"):
        answer, seconds, grown = measured(read, kind, 1_000_000)
        refused = answer.startswith("file: ")
        failed |= not refused
        print(f"1000000 entries as {kind}: {'refused' if refused else 'NOT REFUSED'}, {answer}; {seconds:.1f} s, {grown >> 20} MiB")
        answer, seconds, grown = measured(read, kind, 100_000)
        failed |= answer != "100000 read"
        print(f" 100000 entries as {kind}: {answer}, {seconds:.1f} s, {grown >> 20} MiB")
    return failed


if __name__ == "__main__":
    sys.exit(main())
