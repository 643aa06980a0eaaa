"""A newcomer: three jobs in an empty environment, each step with its time and its longest silence.

`python validation/newcomer.py` builds a wheel, makes a new environment, installs the wheel with all extras there, and does what the README
and the guide say: a first verdict on a file of one's own, an eigenfunction of the paper's figure 4, a CI job that passes and one that
fails, a system of order six to 50 digits. Every command runs on a terminal of eighty columns; a silence is the longest time in which
nothing was written to it. Each answer is checked. The table is that of validation/README.md, into which `--write` puts it.
Exit status 1 if an answer is wrong. Nothing is judged by the clock.
"""

from __future__ import annotations

import argparse
import os
import pty
import re
import select
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import machines
import readme_tables

ROOT = Path(__file__).parent.parent
# the file of one's own: the first modes of plane Poiseuille flow as a MATLAB code prints them, one of them with a wrong digit
SPECTRUM = "omega_r, omega_i\n0.237526488820, 0.003739670623\n0.964630915450, -0.035167277631\n0.277204343809, -0.050908727257\n"
CI_JOB = """import shootstab as st


def test_spectrum():
    st.testing.assert_spectrum("poiseuille", [{claims}], digits=8)
"""
RIGHT, WRONG = "0.003739670622979 - 0.237526488820470j", "0.003739710622979 - 0.237526488820470j"
# Rayleigh-Benard convection between rigid plates, as a textbook prints it: order six
SYSTEM = """[problem]
parameters = { Ra = 2000, a = 3.117 }
unknowns = ["w", "T"]
equations = [
  "d(w,4) - 2*a**2*d(w,2) + a**4*w - Ra*a**2*T = sigma*(d(w,2) - a**2*w)",
  "d(T,2) - a**2*T + w = sigma*T",
]
left = { at = 0, conditions = ["w", "d(w)", "T"] }
right = { at = 1, conditions = ["w", "d(w)", "T"] }
"""


@dataclass(frozen=True)
class NewcomerStep:
    """What is done, the words that the answer must hold, and the exit status that is right."""

    says: str
    command: Sequence[str]
    holds: Sequence[str] = ()
    status: int = 0


@dataclass(frozen=True)
class Done:
    """A step, how long it took, the longest silence in it, and what was wrong; empty if nothing."""

    step: NewcomerStep
    seconds: float
    silence: float
    wrong: str


def steps(wheel: Path, environment: Path) -> Iterator[NewcomerStep]:
    """The three jobs, as a newcomer comes to them."""
    python, shootstab, pytest = (str(environment / "bin" / name) for name in ("python", "shootstab", "pytest"))
    yield NewcomerStep("an empty environment", [sys.executable, "-m", "venv", str(environment)])
    yield NewcomerStep(
        "`pip install shootstab[all]`, from the wheel", [python, "-m", "pip", "install", f"{wheel}[all]"], ["Successfully installed"]
    )
    yield NewcomerStep("`shootstab`: three doors", [shootstab], ["a spectrum to check"])
    verify = [shootstab, "verify", "poiseuille", "modes.csv", "--as", "frequency"]
    yield NewcomerStep("first verdict on a file of one's own", verify, ["2 of 3 eigenvalues confirmed", "inaccurate"], 1)
    yield NewcomerStep("the same again", verify, ["2 of 3 eigenvalues confirmed"], 1)
    mode = [shootstab, "mode", "mid", "--guess", "0.00102", "--z", "0,60", "--plot", "figure-4.png", "--export", "mode.csv"]
    yield NewcomerStep("an eigenfunction of figure 4", mode, ["vortex-forming", "0.001022920"])
    yield NewcomerStep("a CI job that passes", [pytest, "-q", "test_right.py"], ["1 passed"])
    yield NewcomerStep("a CI job that fails, with the table of verdicts", [pytest, "-q", "test_wrong.py"], ["1 failed", "inaccurate"], 1)
    yield NewcomerStep("a baseline", [shootstab, "baseline", "record", "poiseuille", "modes.toml", "--guess", "0.0037,-0.2375"], ["1 mode"])
    yield NewcomerStep("a check against it", [shootstab, "baseline", "check", "modes.toml"], ["1 of 1 mode"])
    yield NewcomerStep("one's own system of order six: what it is", [shootstab, "explain", "convection.toml"], ["order", "6"])
    yield NewcomerStep("its growing modes", [shootstab, "find", "convection.toml", "--corners=0.1,-1,20,1"], ["2.14631104802"])
    digits = ["2.14631104802441445589438660829409022015239725194044", "status  converged"]
    yield NewcomerStep("one of them to 50 digits", [shootstab, "refine", "convection.toml", "--guess", "2.1", "--digits", "50"], digits)
    yield NewcomerStep(
        "its eigenfunction", [shootstab, "mode", "convection.toml", "--guess", "2.1", "--plot", "w.pdf"], [" = 1 at z = 0.5"]
    )


def watched(command: Sequence[str], folder: Path) -> tuple[int, str, float, float, str]:
    """(exit status, all that was written to a terminal of eighty columns, seconds, longest silence, last words before it)."""
    ours, theirs = pty.openpty()
    clean = {k: v for k, v in os.environ.items() if k not in ("PYTHONPATH", "NUMBA_CACHE_DIR")}
    own = {"COLUMNS": "80", "TERM": "xterm", "MPLBACKEND": "Agg"}
    began = last = time.perf_counter()
    process = subprocess.Popen(command, cwd=folder, env={**clean, **own}, stdin=subprocess.DEVNULL, stdout=theirs, stderr=theirs)
    os.close(theirs)
    said, silence, before = b"", 0.0, b""
    while True:
        ready, _, _ = select.select([ours], [], [], 0.1)
        now = time.perf_counter()
        if now - last > silence:
            silence, before = now - last, said[-400:]
        if not ready:
            continue
        try:
            more = os.read(ours, 65536)
        except OSError:  # Linux: the other end is closed
            break
        if not more:
            break
        said, last = said + more, now
    os.close(ours)
    status = process.wait()
    return (
        status,
        plain(said),
        time.perf_counter() - began,
        silence,
        (plain(before).split() and plain(before).strip().split("\n")[-1].strip()) or "",
    )


def plain(written: bytes) -> str:
    """What was written to a terminal as text, without its commands; a line that is written over is its last form."""
    lines = re.sub(r"\x1b\[[0-9;?]*[A-Za-z]", "", written.decode(errors="replace")).replace("\r\n", "\n").split("\n")
    return "\n".join(line.rstrip("\r").rsplit("\r", 1)[-1] for line in lines)


def tried(step: NewcomerStep, folder: Path) -> Done:
    """One step."""
    status, said, seconds, silence, before = watched(step.command, folder)
    lacking = [words for words in step.holds if words not in said]
    wrong = "" if status == step.status else f"exit status {status}"
    if lacking:
        wrong = f"{wrong} lacks {lacking}".strip()
    if wrong:
        print(said[-4000:])
    print(
        f"{time.strftime('%H:%M')} {step.says:<50} {seconds:7.1f} s, silent for {silence:5.1f} s after {before[-60:]!r}  {wrong}",
        flush=True,
    )
    return Done(step, seconds, silence, wrong)


def table(done: Sequence[Done]) -> str:
    """The table for validation/README.md."""
    rows = [f"| {d.step.says} | {d.seconds:.1f} s | {d.silence:.1f} s |" for d in done]
    total = sum(d.seconds for d in done)
    return "\n".join(["| step | time | longest silence |", "|---|---|---|", *rows, f"| all of it | {total:.0f} s | |"])


def main() -> int:
    """Build, try, tell."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--write", action="store_true", help="put the table into validation/README.md")
    write_table = parser.parse_args().write
    with tempfile.TemporaryDirectory(prefix="newcomer-") as name:
        folder = Path(name)
        work = folder / "work"
        work.mkdir()
        (work / "modes.csv").write_text(SPECTRUM)
        (work / "convection.toml").write_text(SYSTEM)
        (work / "test_right.py").write_text(CI_JOB.format(claims=RIGHT))
        (work / "test_wrong.py").write_text(CI_JOB.format(claims=WRONG))
        wheel = next(path for path in machines.built(folder) if path.suffix == ".whl")
        done = [tried(step, work) for step in steps(wheel, folder / "environment")]
    print("\n" + table(done))
    if write_table:
        readme_tables.write("newcomer", table(done))
    return int(any(d.wrong for d in done))


if __name__ == "__main__":
    sys.exit(main())
