"""One mode with a true relative error of 1e-8, from a guess of three digits: shooting against QZ, inverse iteration and SciPy's integrator.

Each method has the coarsest resolution that gives the 1e-8, found beforehand. What is judged is the problem in memory: a table on a mesh
for shooting, assembled matrices for the others, and the clock runs over the iteration, or over LAPACK's QZ. Shown besides is the same
with mesh and table, or matrices, made on the clock.
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from functools import partial
from itertools import count

import mpmath
import numpy as np
from bench import BenchLine, at_least, at_most, best, duration, once, show
from scenes import GUESS, problem
from scipy.linalg import eigvals
from shooting_by_scipy import ScipyShooting

import shootstab as st
from shootstab.analyses.count import COUNTING
from shootstab.analyses.cut_region import count_in_region
from shootstab.analyses.root_near import find_near
from shootstab.discriminants.continuation import Continuation
from shootstab.models.chute import ChuteProblem
from shootstab.models.chute import chute_collocation as pseudospectral
from shootstab.spectral import inverse

GOAL = 1e-8  # chosen
TRUNCATIONS = range(16, 400, 4)  # chosen
TOLERANCES = [10.0 ** (-k / 2) for k in range(8, 24)]  # chosen
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


def matrices(p: ChuteProblem, window: tuple[float, float, float], M: float) -> tuple[np.ndarray, np.ndarray]:
    """The matrices without the block of v, where that separates: QZ of what holds the mode."""
    A, B = pseudospectral.assemble(p.flow, p.kx, p.ky, int(M), *window)
    keep = np.concatenate([np.arange(M + 1) + f * (M + 1) for f in ((0, 1, 3, 4) if p.ky == 0.0 else range(5))]).astype(int)
    return A[np.ix_(keep, keep)], B[np.ix_(keep, keep)]


def lines(name: str) -> Iterator[BenchLine]:
    """Everything about one scene."""
    p, guess = problem(name), GUESS[name]
    truth = complex(st.refine(p, guess, digits=20).sigma)
    rtol = coarsest(TOLERANCES, partial(shoot, p, guess), truth)
    scratch = best(lambda: shoot(p, guess, rtol))
    mesh = st.Frame(rtol=rtol).on(p)
    mesh(truth * (1 + 1e-3))
    guesses = (guess * (1 + 1e-9 * i) for i in count())  # never one whose far frame is still known
    ours = best(lambda: find_near(mesh, next(guesses), 0.1 * GOAL))
    yield BenchLine(f"{name}: frame, rtol {rtol:.1e}, in memory", duration(ours))
    yield BenchLine(f"{name}: frame with its mesh made", duration(scratch))
    for grid, focus in GRIDS.items():
        window = pseudospectral.window(p.flow, p.kx, p.ky, focus=focus)

        made_for = partial(matrices, p, window)
        # inverse iteration has the eigenvalues of the same matrices, and is quicker to try
        M = coarsest(list(map(float, TRUNCATIONS)), lambda M, m=made_for: inverse.refine(*m(M), guess).sigma, truth)
        A, B = made_for(M)
        qz, few = best(lambda A=A, B=B: eigvals(A, B, check_finite=False)), best(lambda A=A, B=B: inverse.refine(A, B, guess))
        made = best(lambda m=made_for, M=M: m(M))
        against_qz, against_inverse = WANTED[name]
        with_mesh = f"with matrices and mesh made {(made + qz) / scratch:.2g}"
        yield at_least(f"{name}: QZ on {grid}, M = {M:.0f}", qz / ours, against_qz, f"{duration(qz)}; {with_mesh}")
        with_mesh = f"with matrices and mesh made {(made + few) / scratch:.2g}"
        yield at_least(f"{name}: inverse iteration on {grid}, M = {M:.0f}", few / ours, against_inverse, f"{duration(few)}; {with_mesh}")
    scipy_shooting = ScipyShooting(p)
    tolerance = coarsest(TOLERANCES[4::4], lambda t: scipy_shooting.root(guess, t, 0.1 * GOAL), truth)
    took = once(lambda: scipy_shooting.root(guess, tolerance, 0.1 * GOAL))
    yield at_least(f"{name}: solve_ivp (DOP853) and QR, rtol {tolerance:.0e}", took / ours, 100.0, duration(took))


def single() -> Iterator[BenchLine]:
    """One determinant, and one count."""
    low, sigma = problem("low"), 0.0072755835 - 0.0118650474j
    D, turn = st.Frame(rtol=1e-10).on(low).at(sigma), count()
    yield at_most(
        "low: one D(sigma) with local errors of 1e-10", best(lambda: D(sigma * (1 + 1e-9 * next(turn)))), 0.4e-3, f"{D.steps} steps"
    )
    high = problem("high")
    region = st.Rectangle(1e-5 - 0.5j, 1 + 0.5j)
    continuation = Continuation(high, COUNTING)
    if count_in_region(continuation, region).count != 1:
        raise SystemExit("high has one growing mode")
    scratch = best(lambda: st.count(high, region))
    again = best(lambda: count_in_region(continuation, region))
    yield at_most("high: count of the rectangle 1e-5 - 0.5i to 1 + 0.5i, in memory", again, 50e-3, f"with meshes made {duration(scratch)}")


def own_problem() -> Iterator[BenchLine]:
    """A problem of one's own of order 4 to 1e-10, error bar included, against the built-in one: as a plain function, and compiled."""
    import gallery

    _, built_in = gallery.timed(st.gallery.PlanePoiseuille(), gallery.GUESS, 1e-10)
    for compiled in (False, True):
        _, seconds = gallery.own(compiled)
        name = f"order 4 of one's own, {'numba' if compiled else 'plain Python'}: time of the built-in problem over its own"
        yield at_least(name, built_in / seconds, 0.75 if compiled else 0.2, f"{duration(seconds)}; built in {duration(built_in)}")


def main() -> int:
    """Both scenes, single evaluations, and a problem of one's own."""
    mpmath.mp.dps = 30
    np.seterr(all="ignore")
    held = show("One mode to 1e-8", "python validation/bench_one_mode.py", [*lines("high"), *lines("low"), *single(), *own_problem()])
    return 0 if held else 1


if __name__ == "__main__":
    sys.exit(main())
