"""Chute scenes drawn at random, far wider than the paper's: three methods at four tolerances against many digits.

    python validation/random_chutes.py --number 500 [--seed 1] [--quick]

For every scene: the steady flow, the mode of the pseudospectral reference with the largest growth rate, its value to 25 digits, and
`refine` from that mode by each method at each tolerance. Every question has TIME seconds of processor and MEMORY bytes. What goes wrong is
listed by kind: a bar that does not hold, a mode that is lost, a refusal, too much time, too much memory.
"""

from __future__ import annotations

import argparse
import contextlib
import math
import multiprocessing
import resource
import signal
import sys
import time
from collections import Counter, defaultdict
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import mpmath
import numpy as np
from claims import Case, Claim

import shootstab as st
from shootstab.analyses.reference import claims
from shootstab.models.chute.registry import RADIAL, WALL_FORMS

TOLERANCES = (1e-4, 1e-6, 1e-8, 1e-10)
METHODS = (st.Frame, st.Compound, st.Riccati)
DIGITS, TRUNCATION = 25, 60
TIME = 10.0  # seconds of processor for one question in doubles
TIME_DIGITS = 60.0  # and for the value of many digits, whose path stays on the real axis and slows down next to the continuous spectrum
MEMORY = 2 << 30  # bytes of address space that a scene may add to what the imports took
PATIENCE = 30.0 * TIME  # seconds of any clock for a scene, whatever it does
NUMBER, QUICK = 40, 4
BARS, LOST, REFUSED, SLOW, BIG = "bar does not hold", "not converged", "refused", "over time", "over memory"
HARMLESS = ("no flow", "no mode of the reference")  # what a draw may come to without a fault


class OverTimeError(Exception):
    """A question took more than TIME."""


@dataclass
class Tally:
    """What one scene came to: faults by kind, in words, and bound over error of every value; skipped says why nothing was asked."""

    name: str
    skipped: str = ""
    faults: list[tuple[str, str]] = field(default_factory=list)
    ratios: dict[tuple[str, float], float] = field(default_factory=dict)
    seconds: float = 0.0


def draw(rng: np.random.Generator) -> tuple[dict[str, Any], float, float, float]:
    """(parameters of the chute, T_∞, k_x, k_y), uniform but for the last three, whose logarithms are; one in six k_x and k_y is 0."""
    e = rng.uniform(0.5, 0.999)
    near = rng.random() < 0.7
    # near: slopes of about the friction at which flows of such grains exist; far: any
    slope = rng.uniform(0.6, 1.4) * (0.1 + 0.9 * (1 - e)) if near else 10 ** rng.uniform(-2.0, 0.0)
    chute = {
        "e": e,
        "e_w": rng.uniform(0.5, 0.999),
        "r": rng.uniform(0.2, 0.95),
        "tan_theta": slope,
        "nu_max": rng.uniform(0.55, 0.65),
        "radial": str(rng.choice(RADIAL)),
        "wall": str(rng.choice(WALL_FORMS)),
    }
    kx, ky = (0.0 if rng.random() < 1 / 6 else 10 ** rng.uniform(-8.0, 0.0) for _ in range(2))
    return {k: float(f"{v:.5g}") if isinstance(v, float) else v for k, v in chute.items()}, *(
        float(f"{x:.5g}") for x in (10 ** rng.uniform(math.log10(0.02), 2.0), kx, ky or (0.01 if kx == 0.0 else 0.0))
    )


@contextlib.contextmanager
def limited(tally: Tally, what: str, seconds: float = TIME) -> Iterator[None]:
    """Say of which kind the fault is, if there is one. Time runs while the process computes."""

    def stop(*_: object) -> None:
        raise OverTimeError

    signal.signal(signal.SIGVTALRM, stop)
    signal.setitimer(signal.ITIMER_VIRTUAL, seconds)
    try:
        yield
    except OverTimeError:
        tally.faults.append((SLOW, what))
    except MemoryError:
        tally.faults.append((BIG, what))
    except st.ShootstabError as error:
        tally.faults.append((REFUSED, f"{what}: {error}"))
    finally:
        signal.setitimer(signal.ITIMER_VIRTUAL, 0.0)


def ask(name: str, chute: dict[str, Any], far_temperature: float, kx: float, ky: float) -> Tally:
    """All questions of one scene."""
    tally = Tally(name)
    with limited(tally, "steady flow and reference"):
        try:
            problem = st.chute.problem(st.chute.steady(far_temperature=far_temperature, **chute), kx=kx, ky=ky)
        except st.NoFlowError:
            tally.skipped = HARMLESS[0]
            return tally
        modes = claims(problem, 6, TRUNCATION)
        if not len(modes):
            tally.skipped = HARMLESS[1]
            return tally
        guess = complex(max(modes, key=lambda s: s.real))
    if tally.faults:
        return tally
    truth = None
    with limited(tally, f"{DIGITS} digits", TIME_DIGITS):
        found = st.refine(problem, guess=guess, digits=DIGITS)
        if found.converged:
            truth = found.sigma
        else:
            tally.faults.append((LOST, f"{DIGITS} digits: {found.status}"))
    for make in METHODS:
        for rtol in TOLERANCES:
            what = f"{make().name} at {rtol:.0e}"
            with limited(tally, what):
                mode = st.refine(problem, guess=guess, rtol=rtol, method=make(rtol=0.1 * rtol))
                if not mode.converged:
                    tally.faults.append((LOST, f"{what}: {mode.status}"))
                elif truth is not None:
                    with mpmath.workdps(40):
                        error = float(abs(mpmath.mpc(mode.sigma) - truth))
                    tally.ratios[make().name, rtol] = mode.error / max(error, 1e-16 * abs(mode.sigma))
                    if not error <= mode.error:
                        tally.faults.append((BARS, f"{what}: error {error:.1e}, bound {mode.error:.1e}, sigma {complex(mode.sigma):.6g}"))
    return tally


def alone(work: Callable[[], Tally], name: str) -> Tally:
    """The work in a process of its own, with bounded memory, given up after PATIENCE."""
    context = multiprocessing.get_context("fork")
    receiver, sender = context.Pipe(duplex=False)

    def run() -> None:
        taken = int(Path("/proc/self/statm").read_text().split()[0]) * resource.getpagesize()
        resource.setrlimit(resource.RLIMIT_AS, (taken + MEMORY, taken + MEMORY))
        began = time.process_time()
        tally = work()
        tally.seconds = time.process_time() - began
        sender.send(tally)

    process = context.Process(target=run)
    process.start()
    sender.close()
    try:
        if receiver.poll(PATIENCE):
            return receiver.recv()  # type: ignore[no-any-return]
        return Tally(name, faults=[(SLOW, f"no answer within {PATIENCE:.0f} s")])
    except EOFError:
        return Tally(name, faults=[(BIG, f"the process ended with status {process.exitcode}")])
    finally:
        process.kill()
        process.join()


def tallies(number: int, seed: int) -> Iterator[Tally]:
    """As many scenes as are wanted that have a flow and a mode; what was skipped comes along."""
    rng, asked = np.random.default_rng(seed), 0
    while asked < number:
        chute, far_temperature, kx, ky = draw(rng)
        parameters = ", ".join(f"{k} = {v}" for k, v in {**chute, "far_temperature": far_temperature, "kx": kx, "ky": ky}.items())
        tally = alone(lambda: ask(parameters, chute, far_temperature, kx, ky), parameters)  # noqa: B023 - it runs at once
        asked += not tally.skipped
        yield tally


def cases(quick: bool, number: int = NUMBER, seed: int = 1) -> Iterator[Case]:
    """One line a kind of fault, with the scenes, and one a method and tolerance with bound over error."""
    warm = st.chute.problem(st.chute.steady(far_temperature=7.0, e=0.8, e_w=0.8, r=0.6, tan_theta=0.3), kx=0.001, ky=0.01)
    for make in METHODS:  # kernels are compiled here, once for all scenes
        st.refine(warm, guess=0.0037, rtol=1e-4, method=make(rtol=1e-5))
    kinds: dict[str, list[str]] = {kind: [] for kind in (BARS, LOST, REFUSED, SLOW, BIG)}
    skipped: Counter[str] = Counter()
    ratios: dict[tuple[str, float], list[float]] = defaultdict(list)
    asked = 0
    for tally in tallies(QUICK if quick else number, seed):
        if tally.skipped:
            skipped[tally.skipped] += 1
            continue
        asked += 1
        for kind, words in tally.faults:
            kinds[kind].append(tally.name)
            print(f"  {kind}: {words}\n      {tally.name}", file=sys.stderr, flush=True)
        for key, ratio in tally.ratios.items():
            ratios[key].append(ratio)
    for kind, names in kinds.items():
        judged = kind != LOST  # a search that says that it did not converge, and why, keeps its promise
        note = f"of {asked} scenes, in {len(set(names))}; skipped: {dict(skipped)}"
        yield Case(kind, "0", str(len(names)), 0.0 if judged else None, note)
    for (name, rtol), values in sorted(ratios.items()):
        median, least = float(np.median(values)), min(values)
        yield Case(
            f"{name}, rtol {rtol:.0e}", "≥ 1", "≥ 1" if least >= 1.0 else "< 1", 0.0, f"bound/error: median {median:.1f}, least {least:.2f}"
        )


CLAIM = Claim(
    "On chute scenes drawn far wider than the paper's no error bar is broken, no question hangs, and none is refused that has an answer.",
    "values of 25 digits by Taylor series in this repository",
    cases,
)


def main() -> int:
    """The command line."""
    parser = argparse.ArgumentParser(description=CLAIM.sentence)
    parser.add_argument("--quick", action="store_true", help=f"{QUICK} scenes")
    parser.add_argument("--number", type=int, default=NUMBER, metavar="N", help=f"scenes (default {NUMBER})")
    parser.add_argument("--seed", type=int, default=1, metavar="S", help="of the draws (default 1)")
    options = parser.parse_args()
    return not Claim(CLAIM.sentence, CLAIM.source, lambda quick: cases(quick, options.number, options.seed)).check(options.quick)


if __name__ == "__main__":
    sys.exit(main())
