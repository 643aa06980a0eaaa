"""Error bounds against values of 25 digits: in no case may the true error exceed the bound, and the bound may not be idle."""

from __future__ import annotations

import cmath
import itertools
import math
from collections import defaultdict
from collections.abc import Iterator

import mpmath
import numpy as np
from claims import Case, Claim, main
from planted_faults import TRUNCATION
from random_chutes import draw
from scenes import GUESS, problem

import shootstab as st
from shootstab.analyses.reference import claims
from shootstab.models.gallery.poiseuille import PlanePoiseuille
from shootstab.problems.protocol import Problem

TOLERANCES = tuple(10.0**-k for k in range(4, 13))  # chosen
METHODS = (st.Frame, st.Compound, st.Riccati)
PESSIMISM = 30.0  # chosen: median of bound/true error that is allowed
ENOUGH = 20  # chosen: values of which a median tells something
FLOOR = 1e-16  # chosen: part of |σ|: a true error below it is counted as this


def scenes(quick: bool) -> Iterator[tuple[str, Problem, complex]]:
    """Problems each with the guess of a mode: built-in scenes, plane Poiseuille flow, ill-conditioned modes, scenes drawn at random."""
    for name in ("high", "low") if quick else ("high", "mid", "low", "fig2"):
        yield name, problem(name), GUESS[name]
    yield "poiseuille", PlanePoiseuille(), 0.0037 - 0.2375j
    yield from ill_conditioned(quick)
    yield from random_chutes(0 if quick else 20)


def ill_conditioned(quick: bool) -> Iterator[tuple[str, Problem, complex]]:
    """Modes next to which rounding counts thousands of times and more, and such next to which it looks as if it did."""
    for n in (9,) if quick else (0, 3, 6, 9, 12):  # Davies 1999: −σ = e^{iπ/4}(2n + 1), of a condition of e^{1.3 n}
        yield f"Davies {n}", second_order("i*x**2", -8, 8), -cmath.exp(0.25j * math.pi) * (2 * n + 1)
    for K, guess in ((100, -44.06 - 23.71j),) if quick else ((100, -44.06 - 23.71j), (1000, -397.2 - 312j)):
        yield f"complex Airy {K}", second_order(f"{K}*i*x", -1, 1), guess
    for P in (100,) if quick else (10, 40, 100):
        yield f"advection {P}", second_order(f"{P}", 0, 1, of="d(y)"), -(P**2) / 4 - math.pi**2


def second_order(coefficient: str, left: int, right: int, of: str = "y") -> Problem:
    """y″ = σ y + coefficient · y, or · y′; y = 0 at both ends."""
    walls = st.Conditions(left, ["y"]), st.Conditions(right, ["y"])
    return st.equations(["y"], [f"d(y, 2) - sigma*y - ({coefficient})*{of}"], *walls, variable="x")


def random_chutes(count: int) -> Iterator[tuple[str, Problem, complex]]:
    """Scenes drawn as widely as validation/random_chutes.py does, each with the mode of the reference that grows most."""
    rng = np.random.default_rng(2010)
    made = 0
    while made < count:
        chute, temperature, kx, ky = draw(rng)
        try:
            p = st.chute.problem(st.chute.steady(far_temperature=temperature, **chute), kx=kx, ky=ky)
        except st.NoFlowError:
            continue
        modes = claims(p, 9, TRUNCATION)
        if len(modes):  # else the reference has no mode to begin with
            made += 1
            yield f"random {made}", p, complex(max(modes, key=lambda s: s.real))


def cases(quick: bool) -> Iterator[Case]:
    """One line a method and tolerance: how many bounds hold, and how pessimistic they are in the median and at worst."""
    ratios: dict[tuple[str, float], list[float]] = defaultdict(list)
    broken: dict[tuple[str, float], list[str]] = defaultdict(list)
    without: list[str] = []
    for name, p, guess in scenes(quick):
        truth = st.refine(p, guess=guess, digits=25)
        if not truth.converged and name.startswith("random"):  # what the reference took for a mode lies on the continuous spectrum
            without.append(f"{name}: {truth.status}")
            continue
        if not truth.converged:
            raise st.ConvergenceError(f"{name}: no value of 25 digits, {truth.status}")
        for make, rtol in itertools.product(METHODS, TOLERANCES[::4] if quick else TOLERANCES):
            # the tolerance of the integration is what is varied; rtol is loose, so that nothing is tightened
            method = make(rtol=max(0.1 * rtol, 1e-13))
            mode = st.refine(p, guess=complex(truth.sigma), rtol=max(rtol, 1e-10), method=method)
            if not math.isfinite(mode.error):  # a search that says why it gives no bound; how often is told
                without.append(f"{name} by {method.name}, rtol {rtol:.0e}")
                continue
            with mpmath.workdps(40):
                error = float(abs(mpmath.mpc(mode.sigma) - truth.sigma))
            key = (method.name, rtol)
            ratios[key].append(mode.error / max(error, FLOOR * abs(mode.sigma)))
            if not error <= mode.error:
                broken[key].append(f"{name}: error {error:.1e}, bound {mode.error:.1e}")
    for (method_name, rtol), values in sorted(ratios.items()):
        yield _line(f"{method_name}, rtol {rtol:.0e}", values, broken[method_name, rtol])
    yield _line("all together", [r for values in ratios.values() for r in values], [b for faults in broken.values() for b in faults])
    yield Case("searches that give no bound", f"{len(without)}", f"{len(without)}", None, "; ".join(without))


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
