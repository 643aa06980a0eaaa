"""Run every claim: `python validation/run.py`, or with --quick a form of each that takes seconds. Exit status 1 if one fails."""

from __future__ import annotations

import argparse
import importlib
import sys
import time

# random_chutes.py and fuzz_pencils.py are searches for faults, not yet claims: they run by themselves, and what they find is open;
# kills.py, fuzz_files.py, mutants.py, machines.py and load.py run by themselves because they take minutes or kill what they start
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


def main() -> int:
    """Check the claims in order."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--quick", action="store_true", help="seconds instead of minutes")
    quick = parser.parse_args().quick
    failed = []
    for name in CLAIMS:
        began = time.perf_counter()
        if not importlib.import_module(name).CLAIM.check(quick):
            failed.append(name)
        print(f"{name}: {time.perf_counter() - began:.1f} s")
    print(f"\n{len(CLAIMS) - len(failed)} of {len(CLAIMS)} claims hold" + (f"; not: {', '.join(failed)}" if failed else ""))
    return bool(failed)


if __name__ == "__main__":
    sys.exit(main())
