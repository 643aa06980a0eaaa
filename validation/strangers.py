"""Problems that others posed: bug reports, forum threads, textbooks, published tables, raw spectra; each with its truth.

`python validation/strangers.py [--quick] [--only WORD] [--readme FILE]`. Every problem is asked in a process of its own, with a limit on
CPU time and 1 GiB of memory beyond what the program takes for itself. Exit status 1 if an answer is wrong or lost, a refusal untrue, or a
limit passed.

What is asked of each problem: `refine` next to its modes (is the true value within the bound, and is there an answer), `verify` of the true
values to eight digits, of claims that are no modes and of claims on the essential spectrum, `verify` of an incomplete list (is what is
missing named), `count` and `find` in a region whose modes are all known, and counts in small discs.
"""

from __future__ import annotations

import argparse
import cmath
import json
import math
import os
import resource
import signal
import sys
import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from claims import Case, Claim
from stranger import Stranger

import shootstab as st
from shootstab.core.records import CONFIRMED, CONTINUUM, SPURIOUS, UNRESOLVED

RIGHT, WRONG, LOST, UNTRUE, HEAVY, SLOW = "right", "WRONG", "lost", "UNTRUE", "HEAVY", "SLOW"
MEMORY = 2**30  # chosen: bytes beyond the program's own: asked
PESSIMISM = 1e4  # chosen: a bound larger than that many times the error asked for, or the truth's own, is no answer


@dataclass
class Answer:
    """What one question gave: its kind, what came of it in words, digits that agree, bound over error."""

    question: str
    outcome: str
    words: str
    digits: float = math.nan
    ratio: float = math.nan
    seconds: float = 0.0


class OutOfTimeError(Exception):
    """A question took longer than allowed."""


# questions


def asked(s: Stranger, modes: Sequence[tuple[complex, float]]) -> Iterator[Answer]:
    """Every question, one after the other; an exception is an answer."""
    problem: Any = None

    def make() -> Iterator[Answer]:
        nonlocal problem
        problem = s.problem()
        return iter(())

    yield from timed(s, "problem", make, modes)
    if problem is None:
        return
    distinct = sorted({v for v, _ in modes}, key=lambda v: (-v.real, v.imag))
    simple = [v for v in distinct if sum(w == v for w, _ in modes) == 1]
    chosen = simple if len(simple) <= s.refined else [simple[round(i * (len(simple) - 1) / (s.refined - 1))] for i in range(s.refined)]
    for v in dict.fromkeys(chosen):
        yield from timed(s, f"refine {v:.6g}", lambda v=v: refine(s, problem, v, modes), modes)
    if modes or s.spurious or s.on:
        yield from timed(s, "verify", lambda: verify(s, problem, modes), modes)
    if s.region is not None:
        yield from timed(s, "count", lambda: count(s, problem, modes), modes)
        yield from timed(s, "find", lambda: find(s, problem, modes), modes)
        if len(distinct) > 1 and "missing" not in s.skip:
            yield from timed(s, "missing", lambda: missing(s, problem, modes), modes)
    if simple and "small" not in s.skip:
        yield from timed(s, "small disc", lambda: small(s, problem, simple[0], modes), modes)
    if s.unstable is not None:
        yield from timed(s, "unstable", lambda: unstable(s, problem), modes)
    if s.also is not None:
        yield from timed(s, "also", lambda: (Answer(*a) for a in s.also(problem, modes)), modes)  # type: ignore[misc]


def timed(s: Stranger, question: str, ask: Callable[[], Iterator[Answer]], modes: Sequence[tuple[complex, float]]) -> Iterator[Answer]:
    """The answers to one question, with a limit on its CPU time."""

    def ring(*_: Any) -> None:
        raise OutOfTimeError

    if question.split()[0] in s.skip:
        return
    signal.signal(signal.SIGPROF, ring)
    signal.setitimer(signal.ITIMER_PROF, s.seconds)
    began = time.process_time()
    try:
        for answer in ask():
            answer.seconds = time.process_time() - began
            began = time.process_time()
            yield answer
    except OutOfTimeError:
        yield Answer(question, SLOW, f"more than {s.seconds:g} s", seconds=time.process_time() - began)
    except MemoryError as error:
        yield Answer(question, HEAVY, f"MemoryError: {str(error)[:80]}", seconds=time.process_time() - began)
    except (st.ShootstabError, st.InputError, st.ConvergenceError) as error:
        kind = UNTRUE if untrue(str(error), s, modes) else LOST
        yield Answer(question, kind, f"{type(error).__name__}: {error}", seconds=time.process_time() - began)
    except Exception as error:
        yield Answer(question, UNTRUE, f"raw {type(error).__name__}: {error}", seconds=time.process_time() - began)
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0.0)


def untrue(sentence: str, s: Stranger, modes: Sequence[tuple[complex, float]]) -> str:
    """Whether a refusal says what is known to be false: a zero on a boundary that is far from all, a singularity where there is none."""
    low = sentence.lower()
    if "lies on the boundary" in low and s.region is not None:
        edge = [s.region.boundary(t / 400) for t in range(401)]
        size = max(abs(e - edge[0]) for e in edge)
        if min((abs(v - e) for v, _ in modes for e in edge), default=math.inf) > 0.01 * size and "zero" in low:
            return "no zero is near the boundary"
    if "singularity of the system" in low and not s.on:
        return "the system has no singularity"
    if "deficient rank" in low:
        return "C has full rank"
    return ""


def refine(s: Stranger, problem: Any, v: complex, modes: Sequence[tuple[complex, float]]) -> Iterator[Answer]:
    """One mode from beside it: the true value must lie within the bound."""
    size = max(abs(v), s.scale)
    others = [abs(w - v) for w, _ in modes if w != v]
    offset = min(s.guess * size, 0.2 * min(others, default=math.inf))
    mode = st.refine(problem, v + offset * cmath.exp(0.7j))
    if not mode.converged:
        kind = UNTRUE if untrue(mode.status, s, modes) else LOST
        yield Answer(f"refine {v:.6g}", kind, mode.status)
        return
    yield judged(f"refine {v:.6g}", complex(mode.sigma), float(mode.error), s, modes)


def judged(question: str, sigma: complex, error: float, s: Stranger, modes: Sequence[tuple[complex, float]]) -> Answer:
    """A value with its bound, against the nearest truth."""
    v, sure = min(modes, key=lambda m: abs(m[0] - sigma))
    off, size = abs(sigma - v), max(abs(v), s.scale)
    digits = min(16.0, -math.log10(max(off / size, 1e-16))) if size else 16.0
    ratio = error / max(off, 0.1 * error, 1e-300)
    ratio = error / off if off > 0 else math.inf
    if off > error + sure:
        return Answer(
            question,
            WRONG,
            f"{sigma:.15g} ± {error:.1e}, truth {v:.15g} ± {sure:.0e}: off by {off / max(error, 1e-300):.3g} bounds",
            digits,
            ratio,
        )
    if error > max(1e-7 * size, PESSIMISM * sure):
        return Answer(question, LOST, f"bound {error:.1e} says nothing, off {off:.1e}", digits, ratio)
    return Answer(question, RIGHT, f"± {error:.1e}", digits, ratio)


def rounded(v: complex, digits: int, scale: float = 0.0) -> complex:
    """v to so many digits of its size."""
    size = abs(v) if abs(v) > 1e-10 * scale else scale
    unit = 10.0 ** (math.floor(math.log10(size)) + 1 - digits) if size else 1.0
    return complex(round(v.real / unit) * unit, round(v.imag / unit) * unit)


def verify(s: Stranger, problem: Any, modes: Sequence[tuple[complex, float]]) -> Iterator[Answer]:
    """Claims on modes, beside modes, and on the essential spectrum, each with its verdict; and nothing is missing."""
    claims = [rounded(v, s.digits, s.scale) for v, _ in modes]
    expected: list[tuple[str, ...]] = [(CONFIRMED,)] * len(claims)
    claims += s.spurious
    expected += [(SPURIOUS,)] * len(s.spurious)
    claims += s.on
    expected += [(CONTINUUM, SPURIOUS)] * len(s.on)
    report = st.verify(problem, claims, digits=s.digits - 1, region=s.region)
    for claim, verdict, right in zip(claims, report.verdicts, expected, strict=True):
        outcome = RIGHT if verdict.verdict in right else LOST if verdict.verdict == UNRESOLVED else WRONG
        if outcome == LOST and untrue(verdict.why, s, modes):
            outcome = UNTRUE
        yield Answer(
            f"verify {claim:.8g}", outcome, f"{verdict.verdict}, not {' or '.join(right)}: {verdict.why}" if outcome != RIGHT else right[0]
        )
    for m in report.missing:
        if s.region is None and min((abs(complex(m.sigma) - v) / abs(v) for v, _ in modes if v), default=1.0) > 1e-6:
            continue  # a mode of which no truth is at hand
        yield Answer("verify", WRONG, f"{complex(m.sigma):.12g} (times {m.multiplicity}) is called missing")
    for u in report.undecided:
        kind = UNTRUE if untrue(u, s, modes) else LOST
        if s.region is not None and "of the end" not in u:  # what is documented as a limit: next to the ends of a continuous spectrum
            yield Answer("verify", kind, f"undecided: {u}")


def count(s: Stranger, problem: Any, modes: Sequence[tuple[complex, float]]) -> Iterator[Answer]:
    """How many modes the region holds."""
    n = st.count(problem, s.region)
    yield Answer("count", RIGHT if n == len(modes) else WRONG, f"{n}" if n == len(modes) else f"{n}, truth {len(modes)}")


def small(s: Stranger, problem: Any, v: complex, modes: Sequence[tuple[complex, float]]) -> Iterator[Answer]:
    """Discs around one simple mode, down to ten digits, and beside it."""
    size = max(abs(v), s.scale)
    room = min((abs(w - v) for w, _ in modes if w != v), default=math.inf)
    sure = max(e for w, e in modes if w == v)
    for r in (1e-4, 1e-7, 1e-10):
        radius = r * size
        if radius > 0.3 * room or radius < 4 * sure:
            continue
        for name, centre, truth in ((f"disc {r:.0e}", v + 0.3 * radius, 1), (f"disc {r:.0e} beside", v + 2.2j * radius, 0)):
            if truth == 0 and 3.2 * radius > 0.5 * room:
                continue
            try:
                n = st.count(problem, st.Disc(centre, radius))
            except st.ConvergenceError as error:
                yield Answer(name, UNTRUE if "lies on the boundary" in str(error) else LOST, str(error))
                continue
            yield Answer(name, RIGHT if n == truth else WRONG, f"{n}" if n == truth else f"{n}, truth {truth}")


def find(s: Stranger, problem: Any, modes: Sequence[tuple[complex, float]]) -> Iterator[Answer]:
    """All modes of the region, each within its bound, with multiplicities that add up."""
    found = st.find(problem, s.region).modes
    total = sum(m.multiplicity for m in found)
    yield Answer(
        "find", RIGHT if total == len(modes) else WRONG, f"{total}" if total == len(modes) else f"{total} found, truth {len(modes)}"
    )
    for m in found:
        if not modes:
            continue
        if not (m.converged or m.multiplicity > 1):
            yield Answer("find", LOST, f"{complex(m.sigma):.9g}: {m.status}")
        elif m.multiplicity == 1:
            yield judged(f"find {complex(m.sigma):.6g}", complex(m.sigma), float(m.error), s, modes)
        else:
            inside = sum(abs(v - complex(m.sigma)) <= m.error + e for v, e in modes)
            yield Answer(
                f"find {complex(m.sigma):.6g}",
                RIGHT if inside >= m.multiplicity else WRONG,
                f"× {m.multiplicity} ± {m.error:.1e}, {inside} within",
            )


def missing(s: Stranger, problem: Any, modes: Sequence[tuple[complex, float]]) -> Iterator[Answer]:
    """An incomplete list: one mode is left out, and must be named, alone."""
    distinct = sorted({v for v, _ in modes}, key=lambda v: (-v.real, v.imag))
    left_out = distinct[0]
    claims = [rounded(v, s.digits, s.scale) for v, _ in modes if v != left_out]
    report = st.verify(problem, claims, digits=s.digits - 1, region=s.region)
    size = max(abs(left_out), s.scale)
    named = [m for m in report.missing if abs(complex(m.sigma) - left_out) <= 1e-6 * size + m.error]
    if len(named) == 1 and len(report.missing) == 1:
        yield Answer("missing", RIGHT, f"{left_out:.6g}")
    elif not named:
        yield Answer("missing", LOST, f"{left_out:.9g} is not named; {report.searched}; {'; '.join(report.undecided)}")
    else:
        yield Answer("missing", WRONG, f"named {[complex(m.sigma) for m in report.missing]}, only {left_out:.9g} is missing")


def unstable(s: Stranger, problem: Any) -> Iterator[Answer]:
    """How many modes grow."""
    n = st.count_unstable(problem).count
    yield Answer("unstable", RIGHT if n == s.unstable else WRONG, f"{n}" if n == s.unstable else f"{n}, truth {s.unstable}")


# apart


def apart(
    work: Callable[[Callable[[dict[str, Any]], None]], None], memory: int | None, seconds: float
) -> tuple[list[dict[str, Any]], float, str]:
    """What work(tell) tells, in a process of its own: what was told, MB beyond the parent's, and how it ended if not well."""
    read, write = os.pipe()
    sys.stdout.flush()
    pid = os.fork()
    if pid == 0:
        os.close(read)
        code = 1
        try:
            resource.setrlimit(resource.RLIMIT_CPU, (math.ceil(seconds), math.ceil(seconds) + 5))
            if memory is not None:
                own = int(Path("/proc/self/statm").read_text().split()[0]) * os.sysconf("SC_PAGE_SIZE")
                resource.setrlimit(resource.RLIMIT_AS, (own + memory, own + memory))
            with os.fdopen(write, "w") as out:
                work(lambda told: (out.write(json.dumps(told) + "\n"), out.flush(), None)[2])
            code = 0
        finally:
            os._exit(code)
    os.close(write)
    with os.fdopen(read) as lines:
        told = [json.loads(line) for line in lines]
    _, status, usage = os.wait4(pid, 0)
    ended = (
        ""
        if status == 0
        else f"killed by signal {os.WTERMSIG(status)}"
        if os.WIFSIGNALED(status)
        else f"exit status {os.WEXITSTATUS(status)}"
    )
    own_rss = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    return told, max(0.0, (usage.ru_maxrss - own_rss) / 1024), ended


@dataclass
class StrangerResult:
    """All answers on one problem."""

    stranger: Stranger
    answers: list[Answer] = field(default_factory=list)
    megabytes: float = 0.0
    truth_seconds: float = 0.0

    @property
    def bad(self) -> list[Answer]:
        return [a for a in self.answers if a.outcome != RIGHT]

    @property
    def seconds(self) -> float:
        return sum(a.seconds for a in self.answers)


def result(s: Stranger) -> StrangerResult:
    """Truth and answers, each in a process of its own."""
    began = time.perf_counter()

    def truth(tell: Callable[[dict[str, Any]], None]) -> None:
        for v, e in s.modes():
            tell({"re": float(complex(v).real), "im": float(complex(v).imag), "sure": float(e)})

    told, _, ended = apart(truth, None, 300.0)
    if ended:
        raise RuntimeError(f"{s.name}: the truth could not be computed: {ended}")
    modes = [(complex(t["re"], t["im"]), t["sure"]) for t in told]
    out = StrangerResult(s, truth_seconds=time.perf_counter() - began)

    def ask(tell: Callable[[dict[str, Any]], None]) -> None:
        for answer in asked(s, modes):
            tell(answer.__dict__)

    told, out.megabytes, ended = apart(ask, MEMORY, 10 * s.seconds)
    out.answers = [Answer(**t) for t in told]
    if ended:
        out.answers.append(Answer("all", HEAVY if "9" in ended or "11" in ended else SLOW, ended))
    if not any(not math.isnan(a.digits) for a in out.answers) and not out.answers:
        out.answers.append(Answer("all", LOST, "no answer at all"))
    return out


def everything(kind: str = "") -> list[Stranger]:
    """All problems, or those of one kind."""
    import strangers_flows
    import strangers_lines
    import strangers_mhd
    import strangers_spectra
    import strangers_walls

    kinds = {
        "lines": strangers_lines.STRANGERS,
        "walls": strangers_walls.STRANGERS,
        "flows": strangers_flows.STRANGERS,
        "mhd": strangers_mhd.STRANGERS,
        "spectra": strangers_spectra.STRANGERS,
    }
    return [s for name, of in kinds.items() if kind in ("", name) for s in of]


def warm() -> None:
    """Kernels loaded and the common modules imported, so that they count for nobody."""
    import numpy as np
    import scipy.optimize  # noqa: F401

    D0, D1 = np.eye(2, k=1), np.eye(2, k=-1)
    p = st.problem(2, lambda z: (D0, D1), st.Wall(0, [[1, 0]]), st.Wall(1, [[1, 0]]))
    st.verify(p, [-9.8696044])
    q = st.problem(2, lambda x: (np.array([[0, 1], [-6 / np.cosh(x) ** 2, 0]]), D1), st.Infinity(), st.Infinity())
    st.refine(q, 3.9)


def cases(quick: bool, only: str = "", show: Callable[[StrangerResult], None] | None = None, kind: str = "") -> Iterator[Case]:
    """One line a problem."""
    warm()
    for s in everything(kind):
        if (quick and not s.quick) or only.lower() not in s.name.lower():
            continue
        r = result(s)
        if show is not None:
            show(r)
        digits = min((a.digits for a in r.answers if not math.isnan(a.digits)), default=math.nan)
        ratio = [a.ratio for a in r.answers if not math.isnan(a.ratio)]
        good = len(r.answers) - len(r.bad)
        note = f"{s.origin}; digits {digits:.1f}, bound/error {min(ratio, default=math.nan):.1f}, {r.seconds:.1f} s, {r.megabytes:.0f} MB"
        if r.bad:
            note += "; " + "; ".join(f"{a.question}: {a.outcome}: {a.words}" for a in r.bad[:2])
        if r.megabytes > MEMORY / 2**20:
            r.bad.append(Answer("memory", HEAVY, f"{r.megabytes:.0f} MB"))
        yield Case(s.name, f"{len(r.answers)} answers", f"{good} answers", 0.0, note)


CLAIM = Claim(
    "On problems that others posed no answer is wrong, none is lost, no refusal is untrue, and none takes more than 1 GiB.",
    "each problem's own; see strangers_*.py",
    cases,
)


def print_result(r: StrangerResult) -> None:
    """One problem with all that is wrong on it."""
    digits = min((a.digits for a in r.answers if not math.isnan(a.digits)), default=math.nan)
    ratio = min((a.ratio for a in r.answers if not math.isnan(a.ratio)), default=math.nan)
    print(
        f"{'BAD' if r.bad else 'ok '} {r.stranger.name:44s} {len(r.answers) - len(r.bad):3d}/{len(r.answers):3d} right, "
        f"digits {digits:4.1f}, "
        f"bound/error {ratio:7.2g}, {r.seconds:6.1f} s, {r.megabytes:5.0f} MB, truth {r.truth_seconds:.1f} s",
        flush=True,
    )
    for a in r.bad:
        print(f"      {a.outcome:6s} {a.question}: {a.words[:260]} [{a.seconds:.1f} s]", flush=True)


def readme(results: Sequence[StrangerResult]) -> str:
    """A section of Markdown: a table with one line a problem."""
    lines = [
        "## Problems that others posed (`strangers.py`)",
        "",
        "| problem | source | truth | answers | digits | bound/error | s | MB | not right |",
        "|---|---|---|---|---|---|---|---|---|",
    ]
    for r in results:
        digits = min((a.digits for a in r.answers if not math.isnan(a.digits)), default=math.nan)
        ratio = min((a.ratio for a in r.answers if not math.isnan(a.ratio)), default=math.nan)
        bad = "; ".join(f"{a.question}: {a.outcome}" for a in r.bad)
        lines.append(
            f"| {r.stranger.name} | {r.stranger.source} | {r.stranger.origin} | {len(r.answers) - len(r.bad)} of {len(r.answers)} | "
            f"{digits:.1f} | {ratio:.2g} | {r.seconds:.1f} | {r.megabytes:.0f} | {bad} |"
        )
    return "\n".join(lines) + "\n"


def summary(results: Sequence[StrangerResult]) -> dict[str, int]:
    """How many problems, and how many of them have each kind of fault."""
    kinds = {k: sum(any(a.outcome == k for a in r.answers) for r in results) for k in (WRONG, LOST, UNTRUE, HEAVY, SLOW)}
    return {"problems": len(results), "all right": sum(not r.bad for r in results), **kinds}


def main() -> int:
    """The command line."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else "")
    parser.add_argument("--quick", action="store_true", help="a form that takes seconds")
    parser.add_argument("--only", default="", help="problems whose name holds this")
    parser.add_argument("--kind", default="", choices=("", "lines", "walls", "flows", "mhd", "spectra"), help="problems of one kind")
    parser.add_argument("--readme", help="write a section in Markdown here")
    args = parser.parse_args()
    results: list[StrangerResult] = []

    def show(r: StrangerResult) -> None:
        results.append(r)
        print_result(r)

    for _ in cases(args.quick, args.only, show, args.kind):
        pass
    print(summary(results))
    if args.readme:
        Path(args.readme).write_text(readme(results))
    return any(r.bad for r in results)


if __name__ == "__main__":
    sys.exit(main())
