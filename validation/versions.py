"""The tests on the oldest and the newest versions of every dependency: the bounds in pyproject.toml are those that pass.

    python validation/versions.py                           # both sets, every interpreter python3.11 … on the path
    python validation/versions.py --quick                   # tests that use every dependency, three minutes of processor time a set
    python validation/versions.py oldest -- -m slow         # one set; what follows -- goes to pytest, here the longest tests

Each set is installed into a virtual environment of its own in a temporary folder, from wheels alone. `oldest` pins every
dependency, those of the extras too, to its lower bound, on the first of the interpreters: newer ones have no wheels of these. `newest`
takes what the index has, on each. At the end stands what passed, what failed, and what was not tried because there is no such interpreter
here. Exit status 1 if any set fails.
"""

from __future__ import annotations

import argparse
import os
import re
import shutil
import subprocess
import sys
import tempfile
import tomllib
from pathlib import Path

ROOT = Path(__file__).parent.parent
PYTHONS = [f"python3.{minor}" for minor in range(11, 20)]
QUICK = (
    "tests/core",  # numpy, mpmath, hypothesis, sympy
    "tests/kernels",  # numba, scipy
    "tests/roots",
    "tests/multiprecision/test_tailed_series.py",  # python-flint
    "tests/formulation/test_grammar.py",
    "tests/spectral",
    "tests/io/test_formats.py",  # h5py
    "tests/cli/test_plots.py",  # matplotlib, rich
    "tests/cli/test_page.py",  # plotly
    "tests/analyses/test_sweep.py::test_a_dask_cluster_gives_the_same",
    "tests/test_habits.py",
    "tests/test_floors.py",
)
AUTHOR = ("-c", "user.name=versions", "-c", "user.email=versions@localhost")  # chosen: git asks for one
LINTERS = ("ruff", "mypy")  # run beside the tests, on one version only


def requirements() -> list[str]:
    """Every dependency of pyproject.toml with its lower bound: numpy>=1.26, ..."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
    extras = [r for name, extra in project["optional-dependencies"].items() if name != "all" for r in extra]
    wanted = [r for r in [*project["dependencies"], *extras] if not r.startswith(LINTERS)]
    unbounded = [r for r in wanted if ">=" not in r]
    if unbounded:
        raise SystemExit(f"no lower bound in pyproject.toml: {', '.join(unbounded)}")
    return wanted


def oldest(requirement: str) -> str:
    """numpy>=1.26 as the constraint numpy==1.26; an extra, dask[distributed], is no part of a constraint."""
    name, _, bound = re.sub(r"\[.*?\]", "", requirement).partition(">=")
    return f"{name.strip()}=={bound.split(',')[0].strip()}"


def passes(python: str, which: str, arguments: list[str]) -> bool:
    """Whether the tests pass on this interpreter with this set of versions."""
    with tempfile.TemporaryDirectory(prefix="shootstab-versions-") as folder:
        here = Path(folder)
        subprocess.run([python, "-m", "venv", here / "venv"], check=True)
        own = here / "venv" / "bin" / "python"
        wanted = requirements()
        constraints = here / "constraints.txt"
        constraints.write_text("".join(f"{oldest(r)}\n" for r in wanted) if which == "oldest" else "")
        install = [own, "-m", "pip", "install", "--quiet", "--no-compile", "--only-binary=:all:", "--constraint", constraints, *wanted]
        if subprocess.run(install, check=False).returncode != 0:
            print(f"{python}, {which}: no wheels for these versions")
            return False
        listed = subprocess.run([own, "-m", "pip", "freeze"], check=True, capture_output=True, text=True).stdout
        print(f"{python}, {which}: {' '.join(listed.split())}", flush=True)
        # a copy: kernels that another numba compiled lie beside the sources here
        for name in ("shootstab", "tests", "validation", "README.md", "pyproject.toml", "CHANGELOG.md", "CITATION.cff", "LICENSE", ".ci"):
            whole = ROOT / name
            if whole.is_dir():
                shutil.copytree(whole, here / name, ignore=shutil.ignore_patterns("__pycache__", "*.nb[ic]"))
            else:
                shutil.copy(whole, here / name)
        # what is stored of the paper says from which commit it comes: the copy is one
        subprocess.run(["git", "init", "--quiet", here], check=True)
        subprocess.run(["git", "-C", here, *AUTHOR, "commit", "--quiet", "--allow-empty", "--message", "a copy"], check=True)
        subprocess.run([own, "-m", "pip", "install", "--quiet", "--no-compile", "--no-deps", "--editable", here], check=True)
        environment = {**os.environ, "OMP_NUM_THREADS": "1", "PYTHONPATH": ""}
        done = subprocess.run([own, "-m", "pytest", "-p", "no:cacheprovider", *arguments], cwd=here, env=environment, check=False)
        print(f"{python}, {which}: {'passed' if done.returncode == 0 else 'FAILED'}", flush=True)
        return done.returncode == 0


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("which", nargs="*", metavar="SET", help="oldest, newest (default: both)")
    parser.add_argument(
        "--python", action="append", metavar="EXE", help="an interpreter, the oldest first (default: every python3.11 … on the path)"
    )
    given = sys.argv[1:]
    cut = given.index("--") if "--" in given else len(given)
    parser.add_argument("--quick", action="store_true", help=f"{' '.join(QUICK)}, without what is slow")
    options = parser.parse_args(given[:cut])
    arguments = [*given[cut + 1 :], *(QUICK if options.quick else ())]
    wrong = [w for w in options.which if w not in ("oldest", "newest")]
    if wrong:
        parser.error(f"{', '.join(wrong)}: allowed is oldest, newest")
    pythons = options.python or [p for p in PYTHONS if shutil.which(p)]
    if not pythons:
        raise SystemExit(f"none of {', '.join(PYTHONS)} is on the path: nothing was tried")
    sets = [
        (python, which) for which in options.which or ("oldest", "newest") for python in (pythons[:1] if which == "oldest" else pythons)
    ]
    results = {(python, which): passes(python, which, arguments) for python, which in sets}
    for (python, which), passed in results.items():
        print(f"{python}, {which}: {'passed' if passed else 'FAILED'}")
    untried = [p for p in PYTHONS if options.python is None and p not in pythons]
    if untried:
        print(f"not tried, for there is no such interpreter here: {', '.join(untried)}")
    return 0 if all(results.values()) else 1


if __name__ == "__main__":
    raise SystemExit(main())
