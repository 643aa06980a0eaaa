"""Other machines: a wheel and an sdist in empty environments, and everything that a machine may lack.

`python validation/machines.py` builds the wheel and the sdist, installs each without extras into a new environment, and asks there for the
scenes, a mode, and refusals: installed where nothing may be written, without HOME, without a terminal, with standard streams closed, in 80
columns, in an ASCII locale, with NO_COLOR, with numba's cache in a folder that is not there, that may not be written to, and that is a
file. Each answer must be that of the plain run, byte for byte on standard output, with its exit status, and without a traceback or a
warning. `--quick` takes the sources and the interpreter that runs it. Exit status 1 if a combination fails.
"""

from __future__ import annotations

import argparse
import os
import shutil
import subprocess
import sys
import tarfile
import tempfile
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path

from kills import obey_modes, told

ROOT = Path(__file__).parent.parent
QUESTIONS: dict[str, tuple[list[str], int]] = {
    "version": (["--version"], 0),
    "scenes": (["scenes"], 0),
    "a count": (["count", "benard", "--region", "disc", "--centre=5,0", "--radius=20"], 0),
    "a refusal": (["refine", "no-such-scene", "--guess", "1"], 2),
    "a missing extra": (["verify", "high", "modes.h5"], 2),
    "a missing proof": (["prove", "poiseuille", "--guess", "0.0037,-0.2375"], 2),
}
QUICK = ("version", "scenes", "a count", "a refusal")
EXTRAS = ("h5py", "matplotlib", "flint", "distributed", "sympy", "pytest")


@dataclass(frozen=True)
class Circumstance:
    """What a machine is like: variables set or (None) absent, standard streams that are closed, something done before, and whether the
    answer on standard output must be that of the plain run."""

    name: str
    variables: Mapping[str, str | None] = field(default_factory=dict)
    closed: tuple[int, ...] = ()
    prepare: Callable[[Path], Mapping[str, str]] | None = None
    same: bool = True


def _no_folder(folder: Path) -> Mapping[str, str]:
    return {"NUMBA_CACHE_DIR": str(folder / "not" / "there")}


def _a_file(folder: Path) -> Mapping[str, str]:
    (folder / "file").write_text("x")
    return {"NUMBA_CACHE_DIR": str(folder / "file")}


def _locked(folder: Path) -> Mapping[str, str]:
    locked = folder / "locked"
    locked.mkdir(exist_ok=True)
    locked.chmod(0o555)
    return {"NUMBA_CACHE_DIR": str(locked)}


def _home_locked(folder: Path) -> Mapping[str, str]:
    locked = folder / "home"
    locked.mkdir(exist_ok=True)
    locked.chmod(0o555)
    return {"HOME": str(locked), "XDG_CACHE_HOME": str(locked / "cache")}


CIRCUMSTANCES = (
    Circumstance("no HOME", {"HOME": None, "XDG_CACHE_HOME": None, "XDG_CONFIG_HOME": None}),
    Circumstance("a HOME that is not there", {"HOME": "/nonexistent", "XDG_CACHE_HOME": None}),
    Circumstance("a HOME that may not be written to", prepare=_home_locked),
    Circumstance("80 columns", {"COLUMNS": "80", "LINES": "24"}),
    Circumstance("10 columns", {"COLUMNS": "10"}),
    Circumstance("TERM=dumb, NO_COLOR", {"TERM": "dumb", "NO_COLOR": "1"}),
    Circumstance("no TERM", {"TERM": None}),
    Circumstance("FORCE_COLOR", {"FORCE_COLOR": "1"}),
    Circumstance("ASCII", {"LC_ALL": "C", "LANG": "C", "PYTHONIOENCODING": "ascii", "PYTHONUTF8": "0"}, same=False),
    Circumstance("POSIX locale", {"LC_ALL": "POSIX", "LANG": None}),
    Circumstance("Latin-1", {"PYTHONIOENCODING": "latin-1"}, same=False),
    Circumstance("warnings are errors", {"PYTHONWARNINGS": "error"}),
    Circumstance("no bytecode", {"PYTHONDONTWRITEBYTECODE": "1"}),
    Circumstance("numba's cache in no folder", prepare=_no_folder),
    Circumstance("numba's cache in a file", prepare=_a_file),
    Circumstance("numba's cache in a locked folder", prepare=_locked),
    Circumstance("no temporary folder", {"TMPDIR": "/nonexistent"}),
    Circumstance("standard input closed", closed=(0,)),
    Circumstance("standard error closed", closed=(2,)),
    Circumstance("standard output closed", closed=(1,), same=False),
)
QUICK_CIRCUMSTANCES = ("no HOME", "80 columns", "ASCII", "numba's cache in a file", "standard error closed", "standard output closed")


@dataclass(frozen=True)
class MachineAnswer:
    """What came of a question."""

    status: int
    out: bytes
    err: str


@dataclass
class Machine:
    """An interpreter with shootstab in it, and a folder to ask from."""

    name: str
    command: list[str]
    folder: Path
    base: dict[str, str]

    def asked(self, words: list[str], there: Circumstance) -> MachineAnswer:
        environment = {**self.base, **{k: v for k, v in there.variables.items() if v is not None}}
        for name in (k for k, v in there.variables.items() if v is None):
            environment.pop(name, None)
        if there.prepare is not None:
            environment |= there.prepare(self.folder)

        def become() -> None:
            for number in there.closed:
                os.close(number)
            obey_modes()

        done = subprocess.run(
            [*self.command, *words],
            cwd=self.folder,
            env=environment,
            stdin=subprocess.DEVNULL,
            capture_output=True,
            preexec_fn=become,
            check=False,
        )
        return MachineAnswer(done.returncode, done.stdout, done.stderr.decode(errors="replace"))


def wrong(question: str, status: int, got: MachineAnswer, plain: MachineAnswer, there: Circumstance) -> str | None:
    """What is not as it should be."""
    lines = told(got.err)
    if "Traceback" in got.err or "Warning" in got.err:
        return got.err.strip().splitlines()[-1]
    if got.status != status and not (1 in there.closed and got.status == 4):
        return f"exit status {got.status} in place of {status}: {lines[-1:]}"
    if 2 not in there.closed and len(lines) != (got.status != 0):
        return f"{len(lines)} lines on standard error"
    if there.same and got.out != plain.out:
        return "another answer on standard output"
    return None


def checked(machine: Machine, quick: bool, asked: list[str] | None) -> tuple[int, list[str]]:
    """How many combinations, and what was wrong with which; the questions may be chosen by name."""
    failed, count = [], 0
    questions = {name: QUESTIONS[name] for name in asked or (QUICK if quick else QUESTIONS)}
    (machine.folder / "modes.h5").write_bytes(b"\x89HDF\r\n\x1a\n" + bytes(100))
    plain = {name: machine.asked(words, Circumstance("plain")) for name, (words, _) in questions.items()}
    for there in (Circumstance("plain"), *CIRCUMSTANCES):
        if quick and there.name not in ("plain", *QUICK_CIRCUMSTANCES):
            continue
        for name, (words, status) in questions.items():
            if there.name == "warnings are errors" and name == "a count" and quick:
                continue
            count += 1
            said = wrong(name, status, machine.asked(words, there), plain[name], there)
            if said is not None:
                failed.append(f"{machine.name}, {there.name}, {name}: {said}")
                print(f"  FAILS {failed[-1]}", flush=True)
    print(f"{machine.name}: {count} combinations, {len(failed)} failed", flush=True)
    return count, failed


def built(folder: Path) -> list[Path]:
    """The wheel and the sdist, from a copy: building leaves things beside the sources."""
    copy = folder / "sources"
    tracked = subprocess.run(["git", "ls-files"], cwd=ROOT, check=True, capture_output=True, text=True).stdout.splitlines()
    copy.mkdir()
    for name in {name.partition("/")[0] for name in tracked}:
        whole = ROOT / name
        if whole.is_dir():
            shutil.copytree(whole, copy / name, ignore=shutil.ignore_patterns("__pycache__", "*.nb[ic]", "*.pyc"))
        else:
            shutil.copy(whole, copy / name)
    pip = [sys.executable, "-m", "pip"]
    out = folder / "built"
    subprocess.run([*pip, "wheel", "--quiet", "--no-deps", "--wheel-dir", out, copy], check=True)
    sdist = "import setuptools.build_meta as b, sys; print(b.build_sdist(sys.argv[1]))"
    env = folder / "builder"
    subprocess.run([sys.executable, "-m", "venv", env], check=True)
    subprocess.run([env / "bin" / "python", "-m", "pip", "install", "--quiet", "setuptools>=69"], check=True)
    subprocess.run([env / "bin" / "python", "-c", sdist, out], cwd=copy, check=True, stdout=subprocess.DEVNULL)
    (packed,) = out.glob("*.tar.gz")
    with tarfile.open(packed) as archive:
        held = {name.partition("/")[2] for name in archive.getnames()}
    lacking = sorted(set(tracked) - held)
    if lacking:
        raise SystemExit(f"the sdist lacks {len(lacking)} files of the repository, {lacking[0]} among them")
    return sorted(out.iterdir())


def installed(package: Path, folder: Path) -> Machine:
    """The package alone in a new environment that may not be written to."""
    env = folder / f"env-{package.suffix[1:]}"
    subprocess.run([sys.executable, "-m", "venv", env], check=True)
    python = env / "bin" / "python"
    subprocess.run([python, "-m", "pip", "install", "--quiet", package], check=True)
    listed = subprocess.run([python, "-m", "pip", "freeze"], check=True, capture_output=True, text=True).stdout.lower()
    there = [extra for extra in EXTRAS if extra in listed]
    if there:
        raise SystemExit(f"{package.name} brings {', '.join(there)} without being asked")
    for path in (env, *env.rglob("*")):
        if not path.is_symlink():
            path.chmod(0o555 if path.is_dir() or os.access(path, os.X_OK) else 0o444)
    here = folder / f"asks-{package.suffix[1:]}"
    here.mkdir()
    base = {"PATH": "/usr/bin:/bin", "HOME": str(here), "OMP_NUM_THREADS": "1"}
    return Machine(package.name, [str(env / "bin" / "shootstab")], here, base)


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--quick", action="store_true", help="the sources and the interpreter that run this, a few circumstances")
    parser.add_argument("--question", action="append", choices=QUESTIONS, help="this question (default: all)")
    options = parser.parse_args()
    began, count, failed = time.monotonic(), 0, []
    with tempfile.TemporaryDirectory(prefix="shootstab-machines-") as name:
        folder = Path(name)
        if options.quick:
            here = folder / "asks"
            here.mkdir()
            base = {**os.environ, "PYTHONPATH": str(ROOT), "OMP_NUM_THREADS": "1"}
            machines = [Machine("sources", [sys.executable, "-m", "shootstab"], here, base)]
        else:
            machines = [installed(package, folder) for package in built(folder)]
        for machine in machines:
            made, bad = checked(machine, options.quick, options.question)
            count, failed = count + made, failed + bad
        for path in folder.rglob("*"):
            if path.is_dir() and not path.is_symlink():
                path.chmod(0o755)
    print(f"{count} combinations, {len(failed)} failed, {time.monotonic() - began:.0f} s")
    return bool(failed)


if __name__ == "__main__":
    sys.exit(main())
