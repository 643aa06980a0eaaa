"""A discrete mode brought to the continuous spectrum, rung by rung, by moving k_x: what QZ, shooting and many digits say of it.

On the mid flow one mode crosses σ_c(z) between k_x = 0.011 and 0.1. With σ_c(z) = σ at a complex z, Im z is its signed offset; it is
zero at k_x*, to which the ladder goes down. It begins at 1e-2: beyond k_x = 0.16 this mode meets the curve again, and is never farther from
it than by about that part of |σ|. Distances of the size of |σ| are those of the modes of figure 3.
"""

from __future__ import annotations

import csv
import math
from collections.abc import Sequence
from dataclasses import dataclass, fields
from functools import cache
from typing import Any

import mpmath
import numpy as np
from claims import Case
from random_chutes import Tally, limited
from scenes import problem

import shootstab as st
from paper.pictures import BLUE, ORANGE, panels, save
from paper.rows import FIGURES, Item, Reproduction, Row, digits, write_csv
from shootstab.models.chute import chute_collocation as chute
from shootstab.models.chute.chute_problem import ChuteProblem

SCENE, BEGIN, GUESS = "mid", 0.05, -1.22 - 0.277j  # chosen: k_x from which the mode is followed, and a mode there to two digits
RUNGS = (1e-2, 1e-4, 1e-6, 1e-7, 1e-8, 1e-10)  # chosen: distances to the curve over |σ|
RUNGS_QUICK = (1e-2, 1e-6)  # chosen
TRUNCATIONS, TRUNCATIONS_QUICK = (100, 200, 400), (100, 200)  # chosen: halves and doubles of a typical M
NEAR = 1e-2  # chosen: the part of |σ| within which other eigenvalues of the matrices are counted
LOST = 2.0  # chosen: digits below which an eigenvalue is not told from those of the balloon beside it
RTOL = 1e-11  # chosen: the accuracy asked of shooting
DIGITS, TIME = 18, 60.0  # chosen: the digits of the truth, four more than shooting has, and seconds of processor for it
BY_DIGITS = 5e-5  # chosen: the distance from which on that truth is asked for; its path is the real axis, and nearer it takes minutes
POINTS = 4001  # chosen: heights among which the nearest point of the curve is first looked for
TABLE = "ladder.csv"
TRIES = 6  # chosen: secants to a rung at most
TURNS, ASIDE = 8, 1e-4  # chosen: steps of Newton to it, and of z for the slope of the curve


@dataclass(frozen=True)
class Rung:
    """k_x, the mode by shooting with its bound, its distance to the curve over |σ|, and Im z."""

    kx: float
    sigma: complex
    bound: float
    distance: float
    offset: float


def near(kx: float, guess: complex) -> Rung:
    """The mode next to the guess. Raises ConvergenceError where shooting does not settle."""
    at = ChuteProblem(problem(SCENE).flow, kx, 0.0)
    mode = st.refine(at, guess=guess, rtol=RTOL)
    if not mode.converged:
        raise st.ConvergenceError(f"kx = {kx!r}: {mode.status}")
    sigma = complex(mode.sigma)

    def curve(z: Any) -> Any:
        return at.continuum(np.atleast_1d(np.asarray(z, dtype=np.complex128)))

    heights = at.continuum.heights(POINTS)
    z = complex(heights[np.abs(curve(heights) - sigma).argmin()])
    for _ in range(TURNS):
        slope = complex(curve(z + ASIDE)[0] - curve(z - ASIDE)[0]) / (2 * ASIDE)
        z -= complex(curve(z)[0] - sigma) / slope
    return Rung(kx, sigma, float(mode.error), abs(slope * z.imag) / abs(sigma), z.imag)


@cache
def crossing() -> tuple[float, Rung]:
    """k_x* by the secant rule on the offset, and the last rung on the way there, no nearer than 1e-5."""
    a = near(BEGIN, GUESS)
    b = near(BEGIN * 1.01, a.sigma * 1.01)
    for _ in range(20):
        if b.distance < 1e-4:
            break
        kx = b.kx - 0.9 * b.offset * (b.kx - a.kx) / (b.offset - a.offset)  # the step stops short: on the curve nothing is told apart
        a, b = b, near(kx, b.sigma + (b.sigma - a.sigma) * (kx - b.kx) / (b.kx - a.kx))
    c = near(b.kx + 0.5 * (b.kx - a.kx) * b.distance / max(a.distance, 1e-3), b.sigma)
    rate = (c.offset - b.offset) / (c.kx - b.kx)
    return b.kx - b.offset / rate, b


def ladder(rungs: Sequence[float]) -> list[Rung]:
    """One rung a distance, on the side from which the mode comes, each within a factor of two of the distance wanted.

    k_x by the secant rule on the distance, k_x* by that on the offset from each two rungs anew. Raises ConvergenceError.
    """
    star, known = crossing()
    out = []
    for wanted in rungs:
        for _ in range(TRIES):
            kx = star + (known.kx - star) * wanted / known.distance
            found = near(kx, known.sigma)
            if found.offset != known.offset and found.distance < known.distance:
                star = found.kx - found.offset * (found.kx - known.kx) / (found.offset - known.offset)
                known = found
            if 0.5 * wanted < found.distance < 2.0 * wanted:
                break
        else:
            raise st.ConvergenceError(f"no rung at {wanted:g}: the last one stands at {found.distance:.2e}")
        out.append(found)
    return out


def matrices(kx: float, M: int) -> tuple[Any, Any]:
    """The pencil of QZ without v̂, which separates."""
    A, B = chute.assemble(problem(SCENE).flow, kx, 0.0, M)
    keep = np.concatenate([np.arange(M + 1) + f * (M + 1) for f in (0, 1, 3, 4)])
    return A[np.ix_(keep, keep)], B[np.ix_(keep, keep)]


def eigenvalues(kx: float, M: int, sigma: complex) -> np.ndarray:
    """The eigenvalues of the pencil by QZ, the nearest to σ first."""
    from scipy.linalg import eigvals

    values = eigvals(*matrices(kx, M), check_finite=False)
    values = values[np.isfinite(values)]
    return np.asarray(values[np.argsort(np.abs(values - sigma))])


def truth(rung: Rung) -> tuple[Any, str]:
    """The mode to DIGITS digits, or None and why not."""
    if rung.distance < BY_DIGITS:
        return None, "many digits take minutes here"
    tally, found = Tally("", 0), None
    with limited(tally, f"{DIGITS} digits", TIME):
        found = st.refine(ChuteProblem(problem(SCENE).flow, rung.kx, 0.0), guess=rung.sigma, digits=DIGITS)
    if found is None:
        return None, "; ".join(f"{kind}" for kind, _ in tally.faults)
    return (found.sigma, "") if found.converged else (None, found.status)


@dataclass(frozen=True)
class AskedRung:
    """What was found at a rung: its mode, how far shooting is from the truth and by what that is judged, and QZ.

    wanted: the distance that the rung is for. error, allowed: |σ − truth|, and the bounds of shooting and of what stands for the truth.
    qz: the nearest eigenvalue at each M as 'M re im others', where others lie within NEAR |σ| of the mode beside it.
    """

    wanted: float
    kx: float
    distance: float
    sigma_re: float
    sigma_im: float
    bound: float
    error: float
    allowed: float
    against: str
    why: str
    qz: str

    @property
    def sigma(self) -> complex:
        """The mode by shooting."""
        return complex(self.sigma_re, self.sigma_im)

    @property
    def digits_of_shooting(self) -> float:
        """−log10 of the relative error, at most 16."""
        return min(16.0, -math.log10(max(self.error, 1e-17) / abs(self.sigma)))

    @property
    def by_qz(self) -> dict[int, tuple[complex, int]]:
        """The nearest eigenvalue and the number of others near, by M."""
        found = (entry.split() for entry in self.qz.split(";"))
        return {int(M): (complex(float(re), float(im)), int(others)) for M, re, im, others in found}


def looked_at(wanted: float, rung: Rung, quick: bool) -> AskedRung:
    """Everything at one rung."""
    at = ChuteProblem(problem(SCENE).flow, rung.kx, 0.0)
    exact, why = (None, "left out of the quick form") if quick else truth(rung)
    if exact is None:  # two other methods stand in for it
        others = [st.refine(at, guess=rung.sigma, rtol=RTOL, method=make(rtol=0.1 * RTOL)) for make in (st.Compound, st.Riccati)]
        error = max(abs(complex(o.sigma) - rung.sigma) if o.converged else math.inf for o in others)
        allowed = rung.bound + max(float(o.error) if o.converged else 0.0 for o in others)
        against = "compound and Riccati"
    else:
        with mpmath.workdps(DIGITS + 15):
            error = float(abs(mpmath.mpmathify(rung.sigma) - exact))
        allowed, against = rung.bound, f"{DIGITS} digits"
    said = []
    for M in TRUNCATIONS_QUICK if quick else TRUNCATIONS:
        values = eigenvalues(rung.kx, M, rung.sigma)
        near_it = int((np.abs(values[1:] - rung.sigma) < NEAR * abs(rung.sigma)).sum())
        said.append(f"{M} {float(values[0].real)!r} {float(values[0].imag)!r} {near_it}")
    mode = (rung.kx, rung.distance, rung.sigma.real, rung.sigma.imag, rung.bound)
    return AskedRung(wanted, *mode, error, allowed, against, why, ";".join(said))


def climbed() -> list[AskedRung]:
    """All rungs, from figures/ladder.csv where they stand there, else asked anew and added to it."""
    path = FIGURES / TABLE
    known: list[AskedRung] = []
    if path.exists():
        types = {f.name: str(f.type) for f in fields(AskedRung)}
        with path.open(newline="", encoding="utf-8") as file:
            lines = list(csv.DictReader(file))
        known = [AskedRung(**{n: float(t) if types[n] == "float" else t for n, t in line.items()}) for line in lines]  # type: ignore[arg-type]
    missing = [wanted for wanted in RUNGS if not any(r.wanted == wanted for r in known)]
    for wanted, rung in zip(RUNGS, ladder(RUNGS) if missing else (), strict=bool(missing)):
        if wanted in missing:
            known.append(looked_at(wanted, rung, quick=False))
            write_csv(TABLE, {f.name: [getattr(r, f.name) for r in known] for f in fields(AskedRung)})
    return sorted(known, key=lambda r: -r.wanted)


def row(quick: bool) -> Row:
    """All rungs."""
    found = [looked_at(w, r, quick) for w, r in zip(RUNGS_QUICK, ladder(RUNGS_QUICK), strict=True)] if quick else climbed()
    truncations = TRUNCATIONS_QUICK if quick else TRUNCATIONS
    cases: list[Case] = []
    agreed: dict[int, list[float]] = {M: [] for M in truncations}
    for rung in found:
        name = f"distance {rung.distance:.1e} |σ|, kx = {rung.kx:.12g}"
        note = f"σ = {rung.sigma:.12g}, bound {rung.bound:.0e}, against {rung.against}" + (f" ({rung.why[:80]})" if rung.why else "")
        cases.append(Case(f"{name}: within the bound", "yes", "yes" if rung.error <= rung.allowed else "no", 0.0, note))
        for M, (value, others) in rung.by_qz.items():
            case = Case(f"{name}: QZ, M = {M}", rung.sigma, value, None, f"{others} others within {NEAR:.0%} of |σ|")
            agreed[M].append(digits(case))
            cases.append(case)
    least, most = (agreed[M][-1] for M in (min(truncations), max(truncations)))
    cases += [
        Case(f"nearest rung: QZ of M = {min(truncations)} below {LOST:g} digits: lost", "yes", "yes" if least < LOST else "no", 0.0),
        Case(f"nearest rung: QZ of M = {max(truncations)} has more digits", "yes", "yes" if most > least else "no", 0.0),
    ]
    if not quick:
        draw(found, agreed)
    said = "; ".join(f"QZ, M = {M}: {', '.join(f'{d:.1f}' for d in agreed[M])}" for M in truncations)
    told = f"shooting: {', '.join(f'{r.digits_of_shooting:.1f}' for r in found)}; {said}"
    judged = ", ".join(f"{sum(r.against == by for r in found)} by {by}" for by in dict.fromkeys(r.against for r in found))
    return Row(
        "a mode next to the continuous spectrum can be lost within the balloon unless M is large",
        "3.1, 4.1, figure 2",
        "high truncation is needed",
        f"digits at distances {', '.join(f'{r.distance:.0e}' for r in found)} of |σ|: {told}; shooting is judged {judged}",
        tuple(cases),
        figures=() if quick else ("ladder.png", TABLE),
    )


def draw(found: Sequence[AskedRung], agreed: dict[int, list[float]]) -> None:
    """Digits over distance, for shooting and QZ of each M."""
    figure, axes = panels(1, 1, (6.4, 4.2))
    panel = axes[0, 0]
    distances = [r.distance for r in found]
    panel.plot(distances, [r.digits_of_shooting for r in found], "o-", color=BLUE, label="shooting")
    for (M, values), colour in zip(agreed.items(), (ORANGE, "#E69F00", "#CC79A7"), strict=False):
        panel.plot(distances, values, "s--", color=colour, markersize=4, label=f"the nearest eigenvalue of QZ, M = {M}")
    panel.set_xscale("log")
    panel.invert_xaxis()
    panel.set_ylim(0, 16.5)
    panel.set_xlabel("distance of the mode to the continuous spectrum, over |σ|")
    panel.set_ylabel("digits right")
    panel.set_title(f"{SCENE} flow, one mode moved onto σ$_c$ by $k_x$ → {found[-1].kx:.6g}", fontsize="medium")
    panel.grid(linewidth=0.4, alpha=0.5)
    panel.legend(fontsize="small", frameon=False)
    save(figure, "ladder.png")


REPRODUCTION = Reproduction("ladder", "A discrete mode next to the continuous spectrum", (Item("ladder", row),))
