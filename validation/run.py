"""Run every claim and reproduce the paper: `python validation/run.py`, or with --quick a form of each that takes seconds.

NAMES pick some: of claims, of the scripts in validation/paper/, or `paper` for all of these. Results of their full form are stored, and
not computed again while the release of the package and their script are what they were, unless with --again; --write puts their table
into README.md. Scripts of which nothing is stored yet run with --quick by their names alone.
What shows that the program survives are scripts in processes of their own: --quick runs the short forms that take seconds too, and
`survival` or their names run all of them, whole or in their short forms. Exit status 1 if a claim fails, or a row of the paper no longer
comes out as it is stored.
"""

from __future__ import annotations

import argparse
import importlib
import subprocess
import sys
import time
from pathlib import Path

from paper import SCRIPTS
from paper.rows import load, processor_time

# random_chutes.py and fuzz_pencils.py are searches for faults, not yet claims: they run by themselves, and what they find is open
CLAIMS = (
    "paper_modes",
    "against_pseudospectral",
    "near_continuum",
    "balloon",
    "methods",
    "planted_faults",
    "gallery",
    "proofs",
    "equations",
    "digits",
    "calibration",
    "strangers",
)


SECONDS = ("fuzz_files", "mutants", "load")  # measured: those of SURVIVAL whose short forms take less than a minute
# scripts in processes of their own, with the arguments of their short forms
SURVIVAL = {
    "kills": ("--quick",),
    "lost_cluster": ("--quick",),
    "fuzz_files": ("--number", "40"),
    "random_commands": ("--quick",),
    "mutants": ("--quick",),
    "machines": ("--quick",),
    "load": ("--quick",),
}


def checked(name: str, quick: bool, again: bool) -> bool:
    """Whether one claim holds, one script of the paper gives what is stored, or one of survival ends with status 0."""
    if name in SCRIPTS:
        return bool(importlib.import_module(f"paper.{name}").REPRODUCTION.check(quick, again))
    if name in SURVIVAL:
        script = Path(__file__).parent / f"{name}.py"
        return subprocess.run([sys.executable, script, *(SURVIVAL[name] if quick else ())], check=False).returncode == 0
    return bool(importlib.import_module(name).CLAIM.check(quick))


def to_compare() -> tuple[str, ...]:
    """The scripts of the paper of which something is stored: the short form of a row is held against that."""
    return tuple(name for name in SCRIPTS if load(name))


def main() -> int:
    """Check in order."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    known = (*CLAIMS, *SCRIPTS, *SURVIVAL, "paper", "survival")
    parser.add_argument("names", nargs="*", metavar="NAMES", help=f"of {', '.join(known)}")
    parser.add_argument("--quick", action="store_true", help="seconds instead of minutes")
    parser.add_argument("--again", action="store_true", help="compute what is stored too")
    parser.add_argument(
        "--write", action="store_true", help="put the table of the paper's rows into README.md; without NAMES nothing else is done"
    )
    options = parser.parse_args()
    unknown = set(options.names) - set(known)
    if unknown:
        parser.error(f"{', '.join(sorted(unknown))}: no such claim")
    groups = {"paper": to_compare() if options.quick else SCRIPTS, "survival": tuple(SURVIVAL)}
    names = [name for given in options.names for name in groups.get(given, (given,))]
    if not options.names and not options.write:
        names = [*CLAIMS, *groups["paper"], *(SECONDS if options.quick else ())]
    failed = []
    for name in names:
        began, spent = time.perf_counter(), processor_time()
        if not checked(name, options.quick, options.again):
            failed.append(name)
        print(f"{name}: {time.perf_counter() - began:.1f} s, {processor_time() - spent:.1f} s of processor", flush=True)
    if options.write:
        importlib.import_module("paper.table").write()
    told = f"{len(names) - len(failed)} of {len(names)} hold" + (f"; not: {', '.join(failed)}" if failed else "")
    print(f"\n{told}; {processor_time():.0f} s of processor in all")
    return bool(failed)


if __name__ == "__main__":
    sys.exit(main())
