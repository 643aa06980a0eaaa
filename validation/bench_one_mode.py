"""One mode with a true relative error of 1e-8, from a guess of three digits: shooting against QZ, inverse iteration and SciPy's integrator.

The problem is in memory: its steady flow, its far field, and the grid that suits the pseudospectral matrices. Each method has the coarsest
resolution that gives the 1e-8, found beforehand. The clock runs over meshes and tables, or over matrices, and the iteration.
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from functools import partial

import mpmath
import numpy as np
from bench import Line, at_least, at_most, best, duration, once, show
from scenes import GUESS, problem
from shooting_by_scipy import Shooting

import shootstab as st
from shootstab.problems.chute import ChuteProblem
from shootstab.questions.refine import find_near
from shootstab.spectral import chute as pseudospectral

GOAL = 1e-8
TRUNCATIONS = range(16, 400, 4)
TOLERANCES = [10.0 ** (-k / 2) for k in range(8, 24)]
WANTED = {"high": (50.0, 2.0), "low": (1000.0, 20.0)}  # against QZ, against inverse iteration
GRIDS = {"the paper's grid": 0.0, "the bundled reference's grid": None}


def coarsest(resolutions: list[float], value: Callable[[float], complex], truth: complex) -> float:
    """The first resolution from which on two in a row are good to the goal."""
    good = 0
    for i, resolution in enumerate(resolutions):
        good = good + 1 if abs(value(resolution) - truth) <= GOAL * abs(truth) else 0
        if good == 2:
            return resolutions[i - 1]
    raise SystemExit("no resolution gives the accuracy")


def shoot(p: ChuteProblem, guess: complex, rtol: float) -> complex:
    """Mesh, table and Newton."""
    return find_near(st.Frame(rtol=rtol).on(p), guess, 0.1 * GOAL).sigma


def lines(name: str) -> Iterator[Line]:
    """Everything about one scene."""
    p, guess = problem(name), GUESS[name]
    truth = complex(st.refine(p, guess, digits=20).sigma)
    rtol = coarsest(TOLERANCES, partial(shoot, p, guess), truth)
    ours = best(lambda: shoot(p, guess, rtol))
    yield Line(f"{name}: frame, rtol {rtol:.1e}", duration(ours))
    mesh = st.Frame(rtol=rtol).on(p)
    mesh(truth * (1 + 1e-3))
    yield Line(f"{name}: frame on a mesh that is in memory", duration(best(lambda: find_near(mesh, guess, 0.1 * GOAL))))
    for grid, focus in GRIDS.items():
        window = pseudospectral.window(p.flow, p.kx, p.ky, focus=focus)

        def qz(M: float, window: tuple[float, float, float] = window) -> complex:
            raw = pseudospectral.spectrum(p.flow, p.kx, p.ky, int(M), False, *window, cross_stream=False).raw
            return complex(raw[abs(raw - guess).argmin()])

        def inverse(M: float, window: tuple[float, float, float] = window) -> complex:
            return pseudospectral.refine(p.flow, p.kx, p.ky, guess, int(M), *window).sigma

        # inverse iteration has the eigenvalues of the same matrices, and is quicker to try
        M = coarsest(list(map(float, TRUNCATIONS)), inverse, truth)
        against_qz, against_inverse = WANTED[name]
        yield at_least(f"{name}: QZ on {grid}, M = {M:.0f}", best(lambda q=qz, m=M: q(m)) / ours, against_qz)
        yield at_least(f"{name}: inverse iteration on {grid}, M = {M:.0f}", best(lambda i=inverse, m=M: i(m)) / ours, against_inverse)
    scipy_shooting = Shooting(p)
    tolerance = coarsest(TOLERANCES[4::4], lambda t: scipy_shooting.root(guess, t, 0.1 * GOAL), truth)
    took = once(lambda: scipy_shooting.root(guess, tolerance, 0.1 * GOAL))
    yield at_least(f"{name}: solve_ivp (DOP853) and QR, rtol {tolerance:.0e}", took / ours, 100.0, duration(took))


def single() -> Iterator[Line]:
    """One determinant, and one count."""
    low, sigma = problem("low"), 0.0072755835 - 0.0118650474j
    D = st.Frame(rtol=1e-10).on(low)
    D(sigma)
    yield at_most("low: one D(sigma) with local errors of 1e-10", best(lambda: D(sigma)), 0.4e-3, f"{D.steps} steps")
    high = problem("high")
    region = st.Rectangle(1e-5 - 0.5j, 1 + 0.5j)
    if st.count(high, region) != 1:
        raise SystemExit("high has one growing mode")
    yield at_most("high: count of the rectangle 1e-5 - 0.5i to 1 + 0.5i", best(lambda: st.count(high, region)), 50e-3)


def main() -> int:
    """Both scenes, and single evaluations."""
    mpmath.mp.dps = 30
    np.seterr(all="ignore")
    held = show("One mode to 1e-8", "python validation/bench_one_mode.py", [*lines("high"), *lines("low"), *single()])
    return 0 if held else 1


if __name__ == "__main__":
    sys.exit(main())
