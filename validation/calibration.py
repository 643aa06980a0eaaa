"""Error bounds against values of 25 digits: in no case may the true error exceed the bound, and the bound may not be idle."""

from __future__ import annotations

import itertools
from collections import defaultdict
from collections.abc import Iterator

import mpmath
import numpy as np
from claims import Case, Claim, main
from planted_faults import TRUNCATION, random_scenes
from scenes import GUESS, problem

import shootstab as st
from shootstab.analyses.reference import claims
from shootstab.models.gallery.poiseuille import PlanePoiseuille
from shootstab.problems.protocol import Problem

TOLERANCES = tuple(10.0**-k for k in range(4, 13))
METHODS = (st.Frame, st.Compound, st.Riccati)
PESSIMISM = 30.0  # median of bound/true error that is allowed
ENOUGH = 20  # values of which a median tells something
FLOOR = 1e-16  # of |σ|: a true error below it is counted as this


def scenes(quick: bool) -> Iterator[tuple[str, Problem, complex]]:
    """The built-in scenes, plane Poiseuille flow, and scenes drawn at random, each with the guess of a mode."""
    for name in ("high", "low") if quick else ("high", "mid", "low", "fig2"):
        yield name, problem(name), GUESS[name]
    yield "poiseuille", PlanePoiseuille(), 0.0037 - 0.2375j
    for name, p in random_scenes(0 if quick else 20):
        yield name, p, complex(claims(p, 9, TRUNCATION)[0])


def cases(quick: bool) -> Iterator[Case]:
    """One line a method and tolerance: how many bounds hold, and how pessimistic they are in the median and at worst."""
    ratios: dict[tuple[str, float], list[float]] = defaultdict(list)
    broken: dict[tuple[str, float], list[str]] = defaultdict(list)
    for name, p, guess in scenes(quick):
        truth = st.refine(p, guess=guess, digits=25)
        if not truth.converged:
            raise st.ConvergenceError(f"{name}: no value of 25 digits, {truth.status}")
        for make, rtol in itertools.product(METHODS, TOLERANCES[::4] if quick else TOLERANCES):
            # the tolerance of the integration is what is varied; rtol is loose, so that nothing is tightened
            method = make(rtol=max(0.1 * rtol, 1e-13))
            mode = st.refine(p, guess=complex(truth.sigma), rtol=max(rtol, 1e-10), method=method)
            with mpmath.workdps(40):
                error = float(abs(mpmath.mpc(mode.sigma) - truth.sigma))
            key = (method.name, rtol)
            ratios[key].append(mode.error / max(error, FLOOR * abs(mode.sigma)))
            if not error <= mode.error:
                broken[key].append(f"{name}: error {error:.1e}, bound {mode.error:.1e}")
    for (method_name, rtol), values in sorted(ratios.items()):
        yield _line(f"{method_name}, rtol {rtol:.0e}", values, broken[method_name, rtol])
    yield _line("all together", [r for values in ratios.values() for r in values], [b for faults in broken.values() for b in faults])


def _line(name: str, values: list[float], faults: list[str]) -> Case:
    """All bounds must hold, and the median be small where it is one of ENOUGH values."""
    median = float(np.median(values))
    expected, held = f"{len(values)} of {len(values)} hold", f"{len(values) - len(faults)} of {len(values)} hold"
    if len(values) >= ENOUGH:
        expected += f", median below {PESSIMISM:.0f}"
        held += f", median {'below' if median < PESSIMISM else 'above'} {PESSIMISM:.0f}"
    note = f"bound/error: median {median:.1f}, least {min(values):.1f}, largest {max(values):.0f}; {' '.join(faults)}"
    return Case(name, expected, held, 0.0, note)


CLAIM = Claim(
    "The error bound of a mode exceeds its true error, and by no more than about 30 times in the median, for every method and tolerance.",
    "values of 25 digits by Taylor series in this repository",
    cases,
)

if __name__ == "__main__":
    main(CLAIM)
