"""Identical digits before and after a change of the program: modes by every method, recorded by one state and compared by another.

    python validation/kept_digits.py record FILE    # by the shootstab that Python finds: PYTHONPATH names another state of it
    python validation/kept_digits.py compare FILE   # exit status 1 unless each mode lies within both bounds of the one recorded

Asked are the paper's four scenes and plane Poiseuille flow by three methods at three accuracies, and the paper's scenes in 30 digits.
`compare` prints the largest difference, in the sum of both bounds and in digits, and how many modes are the same in 12 digits. Only names
of the contract are used, so that any version since 0.2.1 can record.
"""

from __future__ import annotations

import json
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import mpmath

import shootstab as st

GRAINS = {"e": 0.8, "e_w": 0.8, "r": 0.6, "tan_theta": 0.3}
SCENES = {
    "high": ("high", 0.0, 0.01, 0.004),
    "mid": ("mid", 0.0, 0.0125, 0.001),
    "low": ("low", 0.011, 0.0, 0.0073 - 0.0119j),
    "fig2": ("high", 5e-4, 0.0, 0.0017 - 0.0016j),
}
RTOLS = (1e-6, 1e-9, 1e-11)  # chosen: accuracies asked for
METHODS = ("frame", "compound", "riccati")
DIGITS = 30  # chosen: far beyond doubles, in seconds
SAME_DIGITS = 12  # chosen: what a table prints


def questions() -> Iterator[tuple[str, Any, complex, dict[str, Any]]]:
    """Each with its name, the problem, the guess, and how it is asked."""
    problems = {"poiseuille": (st.gallery.plane_poiseuille(10_000.0, 1.0), 0.0037 - 0.2375j)}
    for name, (branch, kx, ky, guess) in SCENES.items():
        problem = st.chute.problem(st.chute.steady(mass_flux=3.0, branch=branch, **GRAINS), kx, ky)
        problems[name] = problem, guess
        yield f"{name}, {DIGITS} digits", problem, guess, {"digits": DIGITS}
    for name, (problem, guess) in problems.items():
        for method in METHODS:
            for rtol in RTOLS:
                yield (
                    f"{name}, {method}, {rtol:.0e}",
                    problem,
                    guess,
                    {"rtol": rtol, "method": getattr(st, method.title())(rtol=0.1 * rtol)},
                )


def found() -> dict[str, list[str]]:
    """The modes by name: real part, imaginary part and bound, in decimals that lose nothing."""
    modes = {}
    for name, problem, guess, how in questions():
        mode = st.refine(problem, guess, **how)
        sigma = mpmath.mpmathify(mode.sigma)
        modes[name] = [mpmath.nstr(x, DIGITS + 10) for x in (sigma.real, sigma.imag, mpmath.mpf(mode.error))]
    return modes


def compare(before: dict[str, list[str]], after: dict[str, list[str]]) -> bool:
    """Print what differs, and say whether all modes lie within both bounds."""
    worst, least, same, apart = 0.0, float("inf"), 0, []
    for name in sorted(before.keys() & after.keys()):
        (re, im, error), (re_now, im_now, error_now) = ([mpmath.mpf(x) for x in mode] for mode in (before[name], after[name]))
        off, size = abs(mpmath.mpc(re - re_now, im - im_now)), abs(mpmath.mpc(re, im))
        worst = max(worst, float(off / (error + error_now)))
        digits = float(-mpmath.log10(off / size)) if off else float("inf")
        least, same = min(least, digits), same + (digits >= SAME_DIGITS)
        if off > error + error_now:
            apart.append(name)
            print(f"{name}: differs by {float(off):.1e}, the bounds are {float(error):.1e} and {float(error_now):.1e}")
    alone = before.keys() ^ after.keys()
    if alone:
        print(f"asked of one only: {', '.join(sorted(alone))}")
    print(
        f"{len(before)} modes, {len(apart)} beyond both bounds; {same} the same in {SAME_DIGITS} digits, the others in {least:.1f} at least"
    )
    print(f"largest difference: {worst:.2f} of the sum of both bounds")
    return not apart and not alone


def main() -> int:
    """Record or compare."""
    if len(sys.argv) != 3 or sys.argv[1] not in ("record", "compare"):
        print(__doc__, file=sys.stderr)
        return 2
    file = Path(sys.argv[2])
    with mpmath.workdps(2 * DIGITS):
        if sys.argv[1] == "record":
            file.write_text(json.dumps({"version": st.__version__, "modes": found()}, indent=1) + "\n")
            return 0
        return 0 if compare(json.loads(file.read_text())["modes"], found()) else 1


if __name__ == "__main__":
    sys.exit(main())
