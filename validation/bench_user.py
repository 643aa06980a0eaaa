"""What somebody waits for: one mode, its verdict, a flow, many digits, the command line. With --write the table goes into README.md.

Times are of one thread where nothing else is said, in seconds of a processor; ratios are of times measured in one run. Beside each mode
stands how many times one D(σ) with its derivative it costs, on the mesh of its tolerance: that hardly depends on what else runs.
"""

from __future__ import annotations

import sys
from collections.abc import Iterator
from functools import partial
from itertools import count
from typing import Any

import bench_startup
import numpy as np
import readme_tables
from bench import BenchLine, at_least, at_most, best, duration, once, show
from bench_one_mode import TRUNCATIONS, coarsest, matrices
from scenes import GUESS, problem
from scipy.linalg import eigvals

import shootstab as st
from shootstab.analyses import reference
from shootstab.models.chute import ChuteProblem
from shootstab.models.chute import chute_collocation as pseudospectral
from shootstab.models.gallery.poiseuille import PlanePoiseuille
from shootstab.problems.capabilities import PSEUDOSPECTRAL
from shootstab.spectral import inverse

REFINED = {"high": 3e-3, "low": 8e-3}  # seconds asked for, as the other numbers below
AGAINST_QZ, AGAINST_INVERSE = {"high": 20.0, "low": 1000.0}, {"high": 1.0, "low": 10.0}
DIGITS = {("high", 50): 2.6, ("low", 50): 6.0, ("high", 100): 9.7, ("low", 100): 22.0}
BATCH, RAW = 64, 200  # chosen
STEEP = -0.014 - 0.0666j  # chosen: guess: the wall mode of plane Poiseuille flow at R = 1e6, alpha = 1
TRUNCATIONS_OF_STEEP = range(160, 400, 20)  # chosen
CLAIMS = 40  # chosen: eigenvalues taken from one QZ of a problem in equations


def anew(p: ChuteProblem) -> ChuteProblem:
    """The same problem as an object that nobody has used; the flow is the same."""
    return st.chute.problem(p.flow, kx=p.kx, ky=p.ky)


def one_mode(name: str) -> Iterator[BenchLine]:
    """refine with its bound and proof, on a flow in memory, against what it checks."""
    p, guess = problem(name), GUESS[name]
    turn, fresh = count(1), []
    used = best(lambda: st.refine(p, guess=guess * (1 + 1e-9 * next(turn)), rtol=1e-9))
    yield at_most(f"{name}: st.refine, rtol 1e-9, the problem used before", used, REFINED[name])
    new = best(lambda: st.refine(fresh.pop(), guess=guess, rtol=1e-9), lambda: fresh.append(anew(p)))
    yield at_most(f"{name}: st.refine, rtol 1e-9, a new problem on a flow in memory", new, REFINED[name])
    D = st.Frame(rtol=1e-10).on(p).at(guess)
    one = best(lambda: [D.with_derivative(guess * (1 + 1e-9 * next(turn))) for _ in range(BATCH)]) / BATCH
    yield BenchLine(f"{name}: both in units of one D(sigma) with dD/dsigma", f"{used / one:.3g} and {new / one:.3g}; {duration(one)}")
    truth = complex(st.refine(p, guess, digits=20).sigma)
    made_for = partial(matrices, p, pseudospectral.window(p.flow, p.kx, p.ky, focus=0.0))
    M = coarsest(list(map(float, TRUNCATIONS)), lambda M: inverse.refine(*made_for(M), guess).sigma, truth)
    qz, few = once(lambda: eigvals(*made_for(M), check_finite=False)), best(lambda: inverse.refine(*made_for(M), guess))
    yield at_least(f"{name}: QZ on the paper's grid, M = {M:.0f}, over st.refine", qz / new, AGAINST_QZ[name], duration(qz))
    yield at_least(f"{name}: inverse iteration there over st.refine", few / new, AGAINST_INVERSE[name], duration(few))


def verdicts() -> Iterator[BenchLine]:
    """Lists of claims, in memory."""
    high, fig2 = problem("high"), problem("fig2")
    claims = reference.claims(high, 6).tolist()
    took = once(lambda: st.verify(anew(high), claims, missing="none"))
    yield at_most(f"high: a verdict, of {len(claims)}", took / len(claims), 5e-3)
    whole = once(lambda: st.verify(anew(high), claims))
    yield BenchLine(f"high: the {len(claims)} verified, with the modes missing among them", duration(whole))
    raw = reference.spectrum(fig2, filtered=False).eigenvalues
    near = raw[np.argsort(np.abs(raw))[:RAW]].tolist()
    yield at_most(f"fig2: the {RAW} values of QZ nearest to 0 verified", once(lambda: st.verify(anew(fig2), near, missing="none")), 1.0)


def beside_the_chute() -> Iterator[BenchLine]:
    """A thin critical layer, and the list of a problem in equations."""
    steep = PlanePoiseuille(reynolds=1e6)
    mode = st.refine(steep, STEEP, rtol=1e-9)
    took = best(lambda: st.refine(PlanePoiseuille(reynolds=1e6), STEEP, rtol=1e-9))
    yield BenchLine("plane Poiseuille, R = 1e6: st.refine, rtol 1e-9", f"{duration(took)}; {mode.sigma:.9g}")
    spectral = PSEUDOSPECTRAL.required(steep)
    nearest = partial(nearest_of, spectral, complex(mode.sigma))
    M = coarsest(list(map(float, TRUNCATIONS_OF_STEEP)), nearest, complex(mode.sigma))
    qz = once(lambda: nearest(M))
    yield BenchLine(f"plane Poiseuille, R = 1e6: QZ as good to 1e-8, M = {M:.0f}, over st.refine", f"{qz / took:.3g} times; {duration(qz)}")
    walls = st.Conditions(-1, ["v", "d(v)"]), st.Conditions(1, ["v", "d(v)"])
    shear = "(sigma + i*(1 - y**2))*(d(v, 2) - v) + 2*i*v - (d(v, 4) - 2*d(v, 2) + v)/2000"
    equations = st.equations(["v"], [shear], *walls, variable="y")
    spectrum = PSEUDOSPECTRAL.required(equations)
    found = []
    qz = once(lambda: found.extend(spectrum.spectrum(120, filtered=False).eigenvalues))
    claims = sorted(found, key=abs)[:CLAIMS]
    report: list[st.Report] = []
    took = once(lambda: report.append(st.verify(equations, claims, missing="none")))
    said = ", ".join(f"{n} {verdict}" for verdict, n in report[0].summary.items() if n)
    yield BenchLine(
        f"equations, plane Poiseuille, R = 2000: a verdict, of {CLAIMS}", f"{duration(took / CLAIMS)}; {said}; QZ {duration(qz)}"
    )


def nearest_of(spectral: Any, sigma: complex, M: float) -> complex:
    """The eigenvalue of one raw QZ at truncation M that is nearest to a number."""
    values = spectral.spectrum(int(M), filtered=False).eigenvalues
    return complex(values[np.abs(values - sigma).argmin()])


def the_rest(digits: bool) -> Iterator[BenchLine]:
    """A flow by its mass flux, one D of many, and many digits."""
    turn = count(1)

    def flow() -> object:
        """A flow of parameters that no cache has."""
        return st.chute.steady(mass_flux=3.0, branch="high", e=0.8 - 1e-9 * next(turn), e_w=0.8, r=0.6, tan_theta=0.3)

    yield at_most("a flow by mass flux and branch, nothing known of its family", best(flow), 0.1)
    sigma = 0.0072755835 - 0.0118650474j
    D = st.Frame(rtol=1e-10).on(problem("low")).at(sigma)
    many = best(lambda: [D(sigma * (1 + 1e-9 * next(turn))) for _ in range(BATCH)])
    yield at_most(f"low: one of {BATCH} D(sigma), local errors of 1e-10", many / BATCH, 0.03e-3)
    for (name, wanted), most in DIGITS.items() if digits else ():
        p, guess = problem(name), GUESS[name]
        yield at_most(f"{name}: {wanted} digits", once(lambda p=p, guess=guess, d=wanted: st.refine(p, guess, digits=d)), most)


def written(lines: list[BenchLine]) -> None:
    """The table in README.md, in place of the one that stands there."""
    table = ["| what | measured | asked |", "|---|---|---|", *(f"| {line.what} | {line.obtained} | {line.asked} |" for line in lines)]
    readme_tables.write("bench_user", "\n".join(table))


def main() -> int:
    """Everything; --quick leaves out many digits and what compiles."""
    quick = "--quick" in sys.argv[1:]
    lines = []
    for part in (
        one_mode("high"),
        one_mode("low"),
        verdicts(),
        beside_the_chute(),
        the_rest(not quick),
        () if quick else bench_startup.lines(),
    ):
        for line in part:
            print(f"{line.what}: {line.obtained}", file=sys.stderr, flush=True)
            lines.append(line)
    held = show("What somebody waits for", "python validation/bench_user.py", lines)
    if "--write" in sys.argv[1:]:
        written(lines)
    return 0 if held else 1


if __name__ == "__main__":
    sys.exit(main())
