"""Commands at random, of scenes and numbers at random and at the ends of what is allowed: no warning, no traceback, one line where refused.

`python validation/random_commands.py --number 400` gives the counts by command and exit status; `--quick` takes 25, `--seed N` others.
Scenes are those built in, chutes of every dissipation, roughness and inclination, and equations whose parameters span 24 decades; guesses,
regions and tolerances span a dozen. Every warning is an error here, a RuntimeWarning of NumPy too: it would end a command with status 3.
The statuses 0, 1 and 2 are allowed: 0 with nothing on standard error, 1 with a line at most, 2 with one line. A command that takes
more than SECONDS of processor time is stopped and counted as long. Exit status 1 if a rule is broken.
"""

from __future__ import annotations

import argparse
import contextlib
import io
import os
import random
import signal
import sys
import tempfile
import time
import warnings
from collections import Counter
from collections.abc import Callable
from pathlib import Path

SECONDS = 8.0  # chosen: processor time of one command
NAMES = ("high", "mid", "low", "fig2", "benard", "blasius", "poiseuille", "poeschl-teller", "davies", "shear-layer", "water-waves", "eady")
NOISE = ("shootstab: compiling", "shootstab: ready", "shootstab: the first")  # how far it is, not what is wrong


class LongCommand(BaseException):
    """The processor time is used up."""


def decades(rng: random.Random, low: float, high: float) -> float:
    """10 to a power between these, of either sign, or 0."""
    return 0.0 if rng.random() < 0.1 else rng.choice((1.0, 1.0, 1.0, -1.0)) * 10 ** rng.uniform(low, high)


def chute(rng: random.Random) -> str:
    """A scene file of a chute."""
    flow = {"e": rng.choice((rng.uniform(0.05, 1.0), 1.0, 1e-6)), "e_w": rng.uniform(0.0, 1.0), "r": rng.choice((rng.random(), 1.0, 1e-8))}
    flow |= {"tan_theta": 10 ** rng.uniform(-3, 1), "far_temperature": 10 ** rng.uniform(-3, 4)}
    wave = {"kx": abs(decades(rng, -8, 2)), "ky": abs(decades(rng, -8, 2))}
    tables = (("flow", flow), ("wave", wave))
    return "".join(f"[{name}]\n" + "".join(f"{key} = {value!r}\n" for key, value in table.items()) for name, table in tables)


def written(rng: random.Random) -> str:
    """A scene file in equations."""
    equation = rng.choice(
        (
            "sigma*u = d(u,2) + p*u",
            "sigma*u = p*d(u,2) - i*q*z*u",
            "sigma*u = d(u,2) + p/cosh(q*z)**2*u",
            "sigma*(d(u,2) - p*u) = i*q*z*(d(u,2) - p*u)",
            "sigma**2*u = p*d(u,2) + q*d(u)",
        )
    )
    ends = rng.choice((("0", "1"), ("-1", "1"), ("-infinity", "infinity"), ("0", "infinity")))
    sides = (
        f'{name} = "infinity"\n' if "infinity" in at else f'{name} = {{ at = {at}, conditions = ["u"] }}\n'
        for name, at in zip(("left", "right"), ends, strict=True)
    )
    parameters = f"parameters = {{ p = {decades(rng, -12, 12)!r}, q = {decades(rng, -12, 12)!r} }}\n"
    return f'[problem]\nunknowns = ["u"]\n{parameters}equations = ["{equation}"]\n' + "".join(sides)


def pair(rng: random.Random) -> str:
    """A complex number as the command line takes it."""
    return f"{decades(rng, -9, 3)!r},{decades(rng, -9, 3)!r}"


def corners(rng: random.Random) -> str:
    """Two opposite corners of a rectangle, the lower left one first."""
    re, im = decades(rng, -4, 2), decades(rng, -4, 2)
    return ",".join(map(repr, (re, im, re + 10 ** rng.uniform(-6, 2), im + 10 ** rng.uniform(-6, 2))))


def command(rng: random.Random, folder: Path) -> list[str]:
    """One command."""
    scene = rng.choice(NAMES)
    kind = rng.random()
    if kind > 0.3:
        (folder / "a.toml").write_text(chute(rng) if kind < 0.65 else written(rng))
        scene = "a.toml"
    name = rng.choice(("refine", "refine", "count", "find", "verify", "mode", "steady", "explain", "spectrum", "sweep"))
    words = [name, scene]
    if name in ("refine", "mode"):
        words += [f"--guess={pair(rng)}"]
        if name == "refine" and rng.random() < 0.5:
            words += ["--method", rng.choice(("frame", "compound", "riccati"))]
        if name == "refine" and rng.random() < 0.3:
            words += ["--rtol", repr(10 ** rng.uniform(-13, -2))]
    elif name == "count":
        if rng.random() < 0.5:
            words += ["--region", "disc", f"--centre={pair(rng)}", f"--radius={10 ** rng.uniform(-9, 2)!r}"]
        else:
            words += ["--region", "rectangle", f"--corners={corners(rng)}"]
    elif name == "find":
        words += [f"--corners={corners(rng)}"]
    elif name == "verify":
        (folder / "claims.csv").write_text("".join(f"{pair(rng)}\n" for _ in range(rng.randint(1, 4))))
        words += ["claims.csv", "--missing", "none", "--digits", str(rng.randint(1, 12))]
    elif name == "spectrum":
        words += ["-M", str(rng.choice((4, 20, 60)))]
    elif name == "sweep":
        words += [f"--{rng.choice(('kx', 'ky', 'p', 'q'))}={10 ** rng.uniform(-6, 2)!r}", "--workers", "1"]
    return words if rng.random() < 0.5 else [*words, "--json", "answer.json"]


def broken_rule(run: Callable[[list[str]], int], words: list[str]) -> tuple[str, str | None]:
    """The exit status or 'long', and what is wrong."""
    out, err = io.StringIO(), io.StringIO()
    try:
        with warnings.catch_warnings(), contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
            warnings.simplefilter("error")
            signal.setitimer(signal.ITIMER_PROF, SECONDS)
            status = run(words)
    except LongCommand:
        return "long", None
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0.0)
    said = [line for line in err.getvalue().splitlines() if line.strip() and not line.startswith(NOISE)]
    if status not in (0, 1, 2):
        return str(status), f"status {status}: {said}"
    if not {0: 0, 1: 0, 2: 1}[status] <= len(said) <= {0: 0, 1: 1, 2: 1}[status]:
        return str(status), f"status {status}: {said}"
    return str(status), next((line for line in said if "Warning" in line or "Traceback" in line), None)


def stop(*_: object) -> None:
    """End the command under way."""
    raise LongCommand


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--number", type=int, default=400, metavar="N", help="of commands")
    parser.add_argument("--seed", type=int, default=1, metavar="N")
    parser.add_argument("--quick", action="store_true", help="25 commands")
    options = parser.parse_args()
    os.environ["COLUMNS"] = "80"
    from random_chutes import warm

    from shootstab.cli import main as cli

    warm()  # a command that is stopped while it compiles says so in a traceback of the compiler
    rng = random.Random(options.seed)
    counts: dict[str, Counter[str]] = {}
    broken: Counter[str] = Counter()
    for number in (signal.SIGTERM, signal.SIGHUP):  # they end this script: a command leaves signals that are handled to its caller
        signal.signal(number, lambda number, _: sys.exit(128 + number))
    signal.signal(signal.SIGPROF, stop)
    began = time.monotonic()
    with tempfile.TemporaryDirectory(prefix="shootstab-commands-") as name, contextlib.chdir(name):
        for _ in range(25 if options.quick else options.number):
            words = command(rng, Path())
            status, wrong = broken_rule(cli.main, words)
            counts.setdefault(words[0], Counter())[status] += 1
            if wrong is not None:
                scene = Path(words[1]).read_text() if words[1].endswith(".toml") else ""
                print(f"  WRONG {' '.join(words)}: {wrong}\n{scene}", flush=True)
                broken[wrong] += 1
    for name, count in sorted(counts.items()):
        print(f"{name:10} " + ", ".join(f"{n} with status {status}" for status, n in sorted(count.items())))
    total = sum(c.total() for c in counts.values())
    print(f"{total} commands, {broken.total()} break a rule, {time.monotonic() - began:.0f} s")
    return bool(broken)


if __name__ == "__main__":
    sys.exit(main())
