"""Many digits: two runs agree on every digit printed, doubles and mpmath agree with them, and what a digit costs in time and memory.

Every run is a process of its own, so that its time and memory are its own. The full form writes figures/digits.csv and figures/digits.png.
"""

from __future__ import annotations

import argparse
import csv
import json
import resource
import subprocess
import sys
import time
from collections.abc import Iterator
from dataclasses import asdict, dataclass
from pathlib import Path

import mpmath
import numpy as np
from claims import Case, Claim, main
from scenes import GUESS

import shootstab as st
from shootstab.analyses.refine_digits import refine_digits
from shootstab.io.notation import held_complex
from shootstab.io.scenes import load

GUESSES = {**GUESS, "poiseuille": 0.0037 - 0.2375j}
POISEUILLE = "0.23752648882047010745", "0.0037396706229794099322"  # c to twenty digits, Re = 10000, alpha = 1
DIGITS = (20, 30, 40, 50, 70, 100)  # chosen
SECONDS = {30: 10.0, 50: 30.0, 100: 300.0}  # seconds of processor time, with python-flint
ALONE = 300.0  # chosen: seconds with mpmath alone, 30 digits
MEBIBYTES = 1024.0  # exact
ELSEWHERE = 1.0 + 1e-4  # chosen: times the guess: another start
FIGURES = Path(__file__).parent / "figures"
PLAIN = 120  # chosen: decimal places that carry a number from one process to another


@dataclass(frozen=True)
class DigitsRun:
    """One mode in a process of its own: σ and its error bound as text, processor seconds, and the largest memory in MiB.

    Linux counts what the parent held when it started the process, about 250 MiB: a larger figure is the process's own.
    """

    scene: str
    digits: int
    arithmetic: str
    re: str
    im: str
    error: str
    status: str
    seconds: float
    mebibytes: float

    @property
    def sigma(self) -> mpmath.mpc:
        """σ as an mpmath number, in the precision of the context."""
        return mpmath.mpc(self.re, self.im)

    @property
    def bound(self) -> mpmath.mpf:
        """The error bound."""
        return mpmath.mpf(self.error)


def alone(scene: str, digits: int, arithmetic: str, factor: float) -> DigitsRun:
    """The run, in this process."""
    problem, guess = load(scene).problem, GUESSES[scene] * factor
    st.refine(problem, guess=guess, rtol=1e-11)  # compiled code is loaded before the clock starts
    began = time.process_time()
    mode = refine_digits(problem, guess, digits, arithmetic=arithmetic)
    seconds = time.process_time() - began
    with mpmath.workdps(PLAIN):
        re, im, error = (mpmath.nstr(mpmath.mpf(x), PLAIN) for x in (mode.sigma.real, mode.sigma.imag, mode.error))
    return DigitsRun(scene, digits, arithmetic, re, im, error, mode.status, seconds, peak_memory())


def peak_memory() -> float:
    """The largest resident memory of this process, in MiB: VmHWM on Linux, since ru_maxrss is inherited through fork and exec."""
    status = Path("/proc/self/status")
    if status.exists():
        return next(int(line.split()[1]) for line in status.read_text().splitlines() if line.startswith("VmHWM")) / 1024.0
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024.0


def run(scene: str, digits: int, arithmetic: str = "flint", factor: float = 1.0) -> DigitsRun:
    """The run, in a process of its own."""
    command = [sys.executable, __file__, "--alone", scene, str(digits), arithmetic, repr(factor)]
    answer = subprocess.run(command, capture_output=True, text=True, check=True)
    return DigitsRun(**json.loads(answer.stdout))


def cases(quick: bool) -> Iterator[Case]:
    """The cases by scene: agreement first, then the cost."""
    scenes, wanted = (("high", "poiseuille"), DIGITS[:1]) if quick else (tuple(GUESSES), DIGITS)
    runs = []
    with mpmath.workdps(PLAIN):
        for scene in scenes:
            mine = [run(scene, n, factor=ELSEWHERE ** (i % 2)) for i, n in enumerate(wanted)]
            yield from agreement(scene, mine)
            yield from cost(scene, mine)
            runs += mine
        yield published(runs)
        for scene in () if quick else tuple(GUESSES):
            other = run(scene, 30, "mpmath")
            yield from arithmetics(next(r for r in runs if (r.scene, r.digits) == (scene, 30)), other)
            runs.append(other)
    if not quick:
        record(runs)
        draw(runs)


def agreement(scene: str, runs: list[DigitsRun]) -> Iterator[Case]:
    """Each run against the next one, which has another precision, order, step and start; and the last one against doubles."""
    for fewer, more in zip(runs, (*runs[1:], run(scene, runs[-1].digits + 5, factor=ELSEWHERE)), strict=True):
        apart, bounds = abs(fewer.sigma - more.sigma), fewer.bound + more.bound
        printed = held_complex(fewer.sigma, fewer.bound)
        units = abs(number(printed) - more.sigma) / last_place(printed)
        ok = fewer.status == "converged" and apart <= bounds and units < 1
        note = f"{mpmath.nstr(units, 2)} units of the last digit printed, {mpmath.nstr(apart / bounds, 2)} of the bounds: {printed}"
        yield Case(f"{scene}, {fewer.digits} digits", "agrees", "agrees" if ok else "differs", 0.0, note)
    rough = st.refine(load(scene).problem, guess=GUESSES[scene], rtol=1e-11)
    yield Case(f"{scene}, doubles", complex(runs[-1].sigma), rough.sigma, rough.error / abs(rough.sigma), f"bound {rough.error:.1e}")


def number(printed: str) -> mpmath.mpc:
    """A number as `held_complex` prints it."""
    words = printed.removesuffix("i").split()
    return mpmath.mpc(words[0], words[1] + words[2]) if len(words) == 3 else mpmath.mpc(words[0])


def last_place(printed: str) -> mpmath.mpf:
    """One unit of the last digit printed."""
    mantissa, _, exponent = printed.split()[0].partition("e")
    return mpmath.mpf(10) ** (int(exponent or 0) - len(mantissa.partition(".")[2]))


def cost(scene: str, runs: list[DigitsRun]) -> Iterator[Case]:
    """Time and memory of each run."""
    for r in runs:
        allowed = SECONDS.get(r.digits)
        within = r.mebibytes < MEBIBYTES and (allowed is None or r.seconds <= allowed)
        limit = f"1 GiB{f', {allowed:.0f} s' if allowed else ''}"
        note = f"{r.seconds:.1f} s, {r.mebibytes:.0f} MiB"
        yield Case(f"{scene}, {r.digits} digits: cost", f"within {limit}", f"{'within' if within else 'beyond'} {limit}", 0.0, note)


def published(runs: list[DigitsRun]) -> Case:
    """Plane Poiseuille flow against the digits that are known: σ = −iαc."""
    best = [r for r in runs if r.scene == "poiseuille"][-1]
    off = abs(best.sigma - mpmath.mpc(POISEUILLE[1], "-" + POISEUILLE[0]))
    return Case("poiseuille, twenty published digits", "agrees", "agrees" if off <= 0.6e-20 else "differs", 0.0, f"off by {float(off):.1e}")


def arithmetics(flint: DigitsRun, plain: DigitsRun) -> Iterator[Case]:
    """python-flint and mpmath, the same code."""
    ok = abs(flint.sigma - plain.sigma) <= flint.bound + plain.bound and plain.seconds <= ALONE
    note = f"differ by {mpmath.nstr(abs(flint.sigma - plain.sigma), 2)}, {plain.seconds:.0f} s, {plain.mebibytes:.0f} MiB"
    yield Case(f"{plain.scene}, mpmath alone", f"agrees in {ALONE:.0f} s", f"agrees in {ALONE:.0f} s" if ok else "does not", 0.0, note)


def record(runs: list[DigitsRun]) -> None:
    """The table behind the figure."""
    names = ("scene", "digits", "arithmetic", "seconds", "mebibytes", "error")
    with (FIGURES / "digits.csv").open("w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, names, lineterminator="\n")
        writer.writeheader()
        for r in runs:
            row = {**asdict(r), "seconds": f"{r.seconds:.2f}", "mebibytes": f"{r.mebibytes:.0f}", "error": mpmath.nstr(r.bound, 2)}
            writer.writerow({name: row[name] for name in names})


def draw(runs: list[DigitsRun]) -> None:
    """Time against digits, with the power law through each scene's last points."""
    from matplotlib.figure import Figure
    from matplotlib.ticker import NullLocator, ScalarFormatter

    figure = Figure(figsize=(7.0, 5.0), layout="constrained")
    axes = figure.add_subplot()
    colours = dict(zip(GUESSES, ("#D55E00", "#E69F00", "#0072B2", "#009E73", "#CC79A7"), strict=True))
    for scene, colour in colours.items():
        mine = [r for r in runs if r.scene == scene and r.arithmetic == "flint"]
        x, y = [r.digits for r in mine], [r.seconds for r in mine]
        power = np.polyfit(np.log(x[-3:]), np.log(y[-3:]), 1)[0]
        axes.plot(x, y, "o-", color=colour, label=f"{scene}: grows as digits^{power:.1f} from {x[-3]} on")
        for r in runs:
            if r.scene == scene and r.arithmetic == "mpmath":
                axes.plot(r.digits, r.seconds, "s", mfc="none", color=colour)
    for digits, seconds in SECONDS.items():
        axes.plot(digits, seconds, "_", color="black", ms=22, mew=2)
    axes.plot([], [], "_", color="black", ms=14, mew=2, label="promised")
    axes.plot([], [], "s", color="grey", mfc="none", label="mpmath alone")
    axes.set(xscale="log", yscale="log", xlabel="digits asked for", ylabel="processor time [s]")
    axes.set_xticks(DIGITS)
    axes.xaxis.set_major_formatter(ScalarFormatter())
    axes.xaxis.set_minor_locator(NullLocator())
    axes.grid(True, which="major", alpha=0.3)
    axes.legend(frameon=False, fontsize=8)
    axes.set_title("One mode to many digits, error bound included")
    figure.savefig(FIGURES / "digits.png", dpi=160)


CLAIM = Claim(
    "Modes to 20 to 100 digits: runs of different precision, order, step and start agree on every digit printed, in seconds to minutes.",
    "plane Poiseuille flow to twenty digits as published; python-flint, mpmath and double precision in this repository",
    cases,
)

if __name__ == "__main__":
    parser = argparse.ArgumentParser(add_help=False)
    parser.add_argument("--alone", nargs=4)
    scene_digits = parser.parse_known_args()[0].alone
    if scene_digits:
        print(json.dumps(asdict(alone(scene_digits[0], int(scene_digits[1]), scene_digits[2], float(scene_digits[3])))))
    else:
        main(CLAIM)
