"""Chute scenes drawn at random, far wider than the paper's: three methods at four tolerances against many digits.

    nice python validation/random_chutes.py --number 500 --out chutes.jsonl

goes on where it was stopped; `--summary` reads what is there, `--scene K` shows one scene in full. For every scene: the steady flow,
the mode of the pseudospectral reference with the largest growth rate, its value to 25 digits, and `refine` from that mode by each method at
each tolerance. Every question has TIME seconds of processor and MEMORY bytes. What goes wrong is listed by kind: a bar that does not hold,
a search that ends at another mode than its guess was meant for, a mode that is lost, a refusal, too much time, too much memory, anything
else that is raised. Exit status 1 if a bar does not hold, an answer is refused, a limit passed, or something raised.
"""

from __future__ import annotations

import argparse
import contextlib
import itertools
import json
import math
import multiprocessing
import resource
import signal
import sys
import time
from collections import Counter, defaultdict
from collections.abc import Callable, Iterator, Sequence
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

import mpmath
import numpy as np
from claims import Case, Claim

import shootstab as st
from shootstab.analyses.reference import claims
from shootstab.models.chute.registry import RADIAL, WALL_FORMS

TOLERANCES = (1e-4, 1e-6, 1e-8, 1e-10)  # chosen
METHODS = (st.Frame, st.Compound, st.Riccati)
DIGITS, TRUNCATION = 25, 60  # chosen
# chosen: (T_∞, k_x, k_y, guess) that compile every kernel: complex numbers, real ones (k_x = 0 and a real σ), a deformed path in z
WARMING = ((7.0, 0.001, 0.01, 0.0037), (7.0, 0.0, 0.01, 0.0037), (0.5, 0.0, 0.02, -5.663))
WARMING_TRUNCATION = 16  # chosen: M of a spectrum of which nothing is used
TIME = 10.0  # chosen: seconds of processor for one question in doubles
TIME_DIGITS = 60.0  # chosen: the same for many digits, whose path stays on the real axis and slows down next to the continuous spectrum
MEMORY = 2 << 30  # chosen: bytes of address space that a scene may add to what the imports took
PATIENCE = 2.0 * (13.0 * TIME + TIME_DIGITS)  # chosen: seconds of processor for a scene, twice what its questions may take
ASLEEP = 10.0 * PATIENCE  # chosen: seconds of the clock, for a process that waits for nothing; a loaded machine stays below
NUMBER, QUICK = 40, 4  # chosen
BARS, OTHER, LOST, REFUSED, SLOW, BIG = "bar does not hold", "another mode", "not converged", "refused", "over time", "over memory"
RAISED = "raised or died"
KINDS = (BARS, OTHER, LOST, REFUSED, SLOW, BIG, RAISED)
TOLD = (OTHER, LOST)  # what breaks no promise: a true mode with a bar that holds, and a search that says that it did not converge, and why
HARMLESS = ("no flow", "no mode of the reference")  # what a draw may come to without a fault


class OverTimeError(Exception):
    """A question took more than TIME."""


@dataclass
class Tally:
    """What one scene came to.

    Faults are (kind, words); ratios (method, rtol, bound over error) of every value that a truth of many digits judged; unjudged counts the
    values for which there was none; skipped says why nothing was asked.
    """

    name: str
    index: int
    skipped: str = ""
    faults: list[tuple[str, str]] = field(default_factory=list)
    ratios: list[tuple[str, float, float]] = field(default_factory=list)
    unjudged: int = 0
    questions: int = 0
    seconds: float = 0.0
    megabytes: int = 0


Drawn = tuple[dict[str, Any], float, float, float]  # parameters of the chute, T_∞, k_x, k_y


def draw(rng: np.random.Generator) -> Drawn:
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
    far_temperature, kx, ky = (
        float(f"{x:.5g}") for x in (10 ** rng.uniform(math.log10(0.02), 2.0), kx, ky or (0.01 if kx == 0.0 else 0.0))
    )
    return {k: float(f"{v:.5g}") if isinstance(v, float) else v for k, v in chute.items()}, far_temperature, kx, ky


@contextlib.contextmanager
def limited(tally: Tally, what: str, seconds: float = TIME) -> Iterator[None]:
    """One question: say of which kind the fault is, if there is one. Time runs while the process computes."""
    tally.questions += 1

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
    except SystemError as error:  # what a compiled kernel makes of an exception that is raised in it from outside
        ended = isinstance(error.__cause__, OverTimeError) or isinstance(error.__context__, OverTimeError)
        tally.faults.append((SLOW, what) if ended else (RAISED, f"{what}: {error}"))
    except Exception as error:  # whatever it is, it is reported and the next question asked
        tally.faults.append((RAISED, f"{what}: {type(error).__name__}: {error}"))
    finally:
        signal.setitimer(signal.ITIMER_VIRTUAL, 0.0)


def many_digits(problem: Any, guess: Any) -> Any:
    """The mode near the guess to DIGITS digits, as refine gives it."""
    return st.refine(problem, guess=guess, digits=DIGITS)


def ask(tally: Tally, drawn: Drawn) -> Tally:
    """All questions of one scene."""
    chute, far_temperature, kx, ky = drawn
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
        found = many_digits(problem, guess)
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
                    continue
                if truth is None:
                    tally.unjudged += 1
                    continue
                error = distance(mode.sigma, truth)
                if not error <= mode.error:
                    words = f"{what}: error {error:.1e}, bound {mode.error:.1e}, sigma {complex(mode.sigma):.6g}"
                    at_it = None
                    with limited(tally, f"{DIGITS} digits at the value of {what}", TIME_DIGITS):
                        at_it = many_digits(problem, mode.sigma)
                    if at_it is not None and at_it.converged and distance(mode.sigma, at_it.sigma) <= mode.error:
                        tally.faults.append((OTHER, words))
                        continue
                    tally.faults.append((BARS, words))
                tally.ratios.append((make().name, rtol, mode.error / max(error, 1e-16 * abs(mode.sigma))))
    return tally


def distance(sigma: Any, truth: Any) -> float:
    """|σ − truth|, rounded once."""
    with mpmath.workdps(DIGITS + 15):
        return float(abs(mpmath.mpc(sigma) - truth))


def alone(work: Callable[[], Tally], tally: Tally) -> Tally:
    """The work in a process of its own, with bounded memory, given up after PATIENCE of processor or ASLEEP of the clock."""
    context = multiprocessing.get_context("fork")
    receiver, sender = context.Pipe(duplex=False)

    def run() -> None:
        taken = int(Path("/proc/self/statm").read_text().split()[0]) * resource.getpagesize()
        resource.setrlimit(resource.RLIMIT_AS, (taken + MEMORY, taken + MEMORY))
        resource.setrlimit(resource.RLIMIT_CPU, (int(PATIENCE), int(PATIENCE) + 5))
        began = time.process_time()
        found = work()
        found.seconds = round(time.process_time() - began, 2)
        found.megabytes = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss >> 10
        sender.send(found)

    process = context.Process(target=run)
    process.start()
    sender.close()
    try:
        if receiver.poll(ASLEEP):
            return receiver.recv()  # type: ignore[no-any-return]
        tally.faults = [(SLOW, f"no answer within {ASLEEP:.0f} s of the clock")]
        return tally
    except EOFError:
        process.join()
        over = process.exitcode == -signal.SIGXCPU
        tally.faults = [(SLOW, f"over {PATIENCE:.0f} s of processor") if over else (RAISED, f"the process ended with {process.exitcode}")]
        return tally
    finally:
        process.kill()
        process.join()


def warm() -> None:
    """Kernels are compiled here, once for all scenes.

    A compilation in the midst of a question would count in its time, and the timer that ends it would be told as a fault of the question.
    """
    grains = {"e": 0.8, "e_w": 0.8, "r": 0.6, "tan_theta": 0.3}
    for far_temperature, kx, ky, guess in WARMING:
        problem = st.chute.problem(st.chute.steady(far_temperature=far_temperature, **grains), kx=kx, ky=ky)
        for make in METHODS:
            st.refine(problem, guess=guess, rtol=1e-4, method=make(rtol=1e-5))
    claims(problem, 3, WARMING_TRUNCATION)
    many_digits(problem, guess)


def scenes(seed: int) -> Iterator[tuple[int, Drawn]]:
    """(number, draw) of one seed, without end: number K is the K-th draw, whatever was asked before."""
    rng = np.random.default_rng(seed)
    for index in itertools.count():
        yield index, draw(rng)


def one(index: int, drawn: Drawn) -> Tally:
    """Everything about one scene, in a process of its own."""
    chute, far_temperature, kx, ky = drawn
    name = ", ".join(f"{k} = {v}" for k, v in {**chute, "far_temperature": far_temperature, "kx": kx, "ky": ky}.items())
    tally = Tally(name, index)
    return alone(lambda: ask(tally, drawn), tally)


def tallies(number: int, seed: int, known: Sequence[Tally] = ()) -> Iterator[Tally]:
    """Scenes until `number` of them, those known included, had a flow and a mode; what was skipped comes along, what is known does not."""
    done = {tally.index for tally in known}
    asked = sum(not tally.skipped for tally in known)
    for index, drawn in scenes(seed):
        if asked >= number:
            return
        if index not in done:
            tally = one(index, drawn)
            asked += not tally.skipped
            yield tally


def told(out: Path, seed: int) -> list[Tally]:
    """What is in the file of this seed; a last line that a kill has cut short is not."""
    if not out.exists():
        return []
    lines = [json.loads(line) for line in out.read_text().splitlines(keepends=True) if line.endswith("\n")]
    return [
        Tally(**{**record, "faults": [tuple(f) for f in record["faults"]], "ratios": [tuple(r) for r in record["ratios"]]})
        for record in (line["tally"] for line in lines if line["seed"] == seed)
    ]


def search(number: int, seed: int, out: Path) -> None:
    """Ask until the file holds as many scenes as are wanted, one line a scene."""
    known = told(out, seed)
    if out.exists():
        whole = out.read_bytes()
        out.write_bytes(whole[: whole.rfind(b"\n") + 1])
    with out.open("a") as file:
        for tally in tallies(number, seed, known):
            file.write(json.dumps({"seed": seed, "tally": asdict(tally)}) + "\n")
            file.flush()


def judged(found: Sequence[Tally]) -> Iterator[Case]:
    """One line a kind of fault, with the scenes, and one a method and tolerance with bound over error."""
    asked = [tally for tally in found if not tally.skipped]
    skipped = Counter(tally.skipped for tally in found if tally.skipped)
    words = ", ".join(f"{n} {why}" for why, n in skipped.items())
    yield Case("scenes asked about", f"{len(asked)}", f"{len(asked)}", None, f"of {len(found)} drawn; skipped: {words or 'none'}")
    values, unjudged = sum(len(t.ratios) for t in asked), sum(t.unjudged for t in asked)
    yield Case(
        "values held against many digits",
        f"{values + unjudged}",
        f"{values}",
        None,
        f"of {sum(t.questions for t in asked)} questions; longest scene {max((t.seconds for t in asked), default=0.0):.0f} s of processor, "
        f"most memory {max((t.megabytes for t in asked), default=0)} MB",
    )
    for kind in KINDS:
        count = sum(fault == kind for t in asked for fault, _ in t.faults)
        yield Case(
            kind,
            "0",
            str(count),
            None if kind in TOLD else 0.0,
            f"in {sum(any(fault == kind for fault, _ in t.faults) for t in asked)} scenes",
        )
    ratios: dict[tuple[str, float], list[float]] = defaultdict(list)
    for name, rtol, ratio in (r for t in asked for r in t.ratios):
        ratios[name, rtol].append(ratio)
    for (name, rtol), held in sorted(ratios.items()):
        least = min(held)
        note = f"{len(held)} values; bound/error: median {np.median(held):.1f}, least {least:.2f}"
        yield Case(f"{name}, rtol {rtol:.0e}", "≥ 1", "≥ 1" if least >= 1.0 else "< 1", 0.0, note)


def cases(quick: bool) -> Iterator[Case]:
    """NUMBER scenes or QUICK, and what they came to; every fault goes to standard error with its scene."""
    warm()
    found = []
    for tally in tallies(QUICK if quick else NUMBER, seed=1):
        found.append(tally)
        for kind, words in tally.faults:
            print(f"  {kind}: {words}\n      {tally.name}", file=sys.stderr, flush=True)
    yield from judged(found)


CLAIM = Claim(
    "On chute scenes drawn far wider than the paper's no error bar is broken, no question hangs, and none is refused that has an answer.",
    "values of 25 digits by Taylor series in this repository",
    cases,
)


def main() -> int:
    """The command line."""
    parser = argparse.ArgumentParser(description=CLAIM.sentence)
    parser.add_argument("--quick", action="store_true", help=f"{QUICK} scenes, kept nowhere")
    parser.add_argument("--number", type=int, default=NUMBER, metavar="N", help=f"scenes that have a flow and a mode (default {NUMBER})")
    parser.add_argument("--seed", type=int, default=1, metavar="S", help="of the draws (default 1)")
    parser.add_argument("--out", type=Path, default=Path("chutes.jsonl"), metavar="FILE", help="one line a scene (default chutes.jsonl)")
    parser.add_argument("--summary", action="store_true", help="what FILE holds, asking nothing")
    parser.add_argument("--scene", type=int, metavar="K", help="draw number K alone, in full")
    options = parser.parse_args()
    if options.quick:
        return not CLAIM.check(quick=True)
    if options.scene is not None:
        warm()
        index, drawn = next(itertools.islice(scenes(options.seed), options.scene, None))
        print(json.dumps(asdict(one(index, drawn)), indent=1))
        return 0
    if not options.summary:
        warm()
        search(options.number, options.seed, options.out)
    found = told(options.out, options.seed)
    for tally in found:
        for kind, words in tally.faults:
            print(f"  {kind}: {words}\n      --seed {options.seed} --scene {tally.index}: {tally.name}")
    return not Claim(CLAIM.sentence, CLAIM.source, lambda quick: judged(found)).check(quick=False)


if __name__ == "__main__":
    sys.exit(main())
