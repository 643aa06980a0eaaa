"""Section 4.1: flows on steep slopes at low temperature whose most unstable wave is oblique, k_y an order of magnitude above k_x.

The maximum of Re σ over (k_x, k_y) is found by Newton's iteration on its gradient, with derivatives of σ by differences of modes good to
1e-11, from the best of a grid of waves. That no other mode grows faster is counted, at the maximum and at every wave of the grid: none has
Re σ above the maximum. Between the waves of the grid nothing is counted.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cache

import numpy as np
from claims import Case
from numpy.typing import NDArray

import shootstab as st
from paper.edges import steady
from paper.rows import FIGURES, Item, Reproduction, Row, if_all_hold, write_csv
from shootstab.analyses.cut_region import count_in_region
from shootstab.analyses.sweep.dominance import SWEEP_COUNTING, suggested
from shootstab.analyses.unstable import LAW, OUTWARDS, HalfDisc, bound, departure_from_law
from shootstab.discriminants.continuation import Continuation
from shootstab.models.chute.chute_problem import ChuteProblem

FLOWS = {"0.33": (0.33, 0.8), "0.34": (0.34, 0.4)}  # chosen: (tan θ, T_∞), low temperatures on slopes as steep as the paper's
CROSS = (0.33, 0.8)  # chosen
RATIOS = (0.0, 0.03, 0.06, 0.1, 0.2, 0.5, 2.0)  # chosen: k_x/k_y of the grid
ALONG = math.inf  # exact: k_x/k_y of waves along the slope
HEIGHTS, HEIGHTS_QUICK = np.geomspace(0.1, 3.2, 6), np.array([1.6])  # chosen: k h0 of the grid
RTOL = 1e-11  # chosen: the accuracy of modes whose differences are taken
STEP = 1e-3  # chosen: relative step of those differences
ORDER = 10.0  # published: an order of magnitude
SAME = 1e-6  # chosen: the part of the maximum, the margin by which a mode must grow faster to count
STEPS, LONGEST, STILL = 20, 0.25, 1e-6  # chosen: Newton's steps at most, and the longest and the last one in units of k_x and k_y


@dataclass(frozen=True)
class Fastest:
    """A maximum of Re σ over wave = (k_x, k_y): its mode, and gradient and Hessian's eigenvalues, k in units of itself."""

    wave: tuple[float, float]
    sigma: complex
    error: float
    gradient: NDArray[np.float64]
    curvatures: NDArray[np.float64]


def wave(k: float, ratio: float) -> tuple[float, float]:
    """(k_x, k_y) with this length and k_x/k_y."""
    if ratio == ALONG:
        return k, 0.0
    ky = k / math.hypot(1.0, ratio)
    return ratio * ky, ky


@cache
def grown(flow: tuple[float, float], heights: tuple[float, ...]) -> dict[tuple[float, float], complex]:
    """The fastest-growing mode that a coarse reference suggests at each wave of the grid, 0 where it suggests none."""
    base = steady(*flow)
    found = {}
    for ratio in (*RATIOS, ALONG):
        for kh in heights:
            kx, ky = wave(float(kh) / base.centre_of_mass, ratio)
            modes = suggested(ChuteProblem(base, kx, ky))
            found[kx, ky] = max(modes, key=lambda s: s.real) if modes else 0j
    return found


def fastest(flow: tuple[float, float], start: tuple[float, float], guess: complex) -> Fastest:
    """The maximum next to the start, by Newton's iteration, in which the mode is foreseen by its gradient."""
    base = steady(*flow)
    at, sigma = np.array(start), guess
    for _ in range(STEPS):
        values = np.empty((3, 3), dtype=np.complex128)
        here = st.refine(ChuteProblem(base, *at.tolist()), guess=sigma, rtol=RTOL)
        for i in range(3):
            for j in range(3):
                place = at * (1 + STEP * np.array([i - 1, j - 1]))
                values[i, j] = complex(st.refine(ChuteProblem(base, *place.tolist()), guess=complex(here.sigma), rtol=RTOL).sigma)
        slope = np.array([values[2, 1] - values[0, 1], values[1, 2] - values[1, 0]]) / (2 * STEP)
        pure = [values[2, 1] - 2 * values[1, 1] + values[0, 1], values[1, 2] - 2 * values[1, 1] + values[1, 0]]
        mixed = (values[2, 2] - values[2, 0] - values[0, 2] + values[0, 0]) / 4
        hessian = np.array([[pure[0], mixed], [mixed, pure[1]]]).real / STEP**2
        curvatures = np.linalg.eigvalsh(hessian)
        uphill = slope.real / np.linalg.norm(slope.real)
        move = -np.linalg.solve(hessian, slope.real) if curvatures.max() < 0 else LONGEST * uphill
        move *= min(1.0, LONGEST / float(np.abs(move).max()))
        if np.abs(move).max() < STILL:
            kx, ky = at.tolist()
            return Fastest((kx, ky), complex(here.sigma), float(here.error), slope.real, curvatures)
        at, sigma = at * (1 + move), complex(here.sigma) + complex(slope @ move)
    raise st.ConvergenceError(f"no maximum of the growth rate found from k = {start}: the last step was {np.abs(move).max():.1e}")


def counted(flow: tuple[float, float], waves: Sequence[tuple[float, float]], level: float) -> int:
    """How many modes with Re σ above the level these waves have in all, none beyond the radius where D follows its law of growth."""
    total, radius = 0, 0.0
    for kx, ky in waves:
        continuation = Continuation(ChuteProblem(steady(*flow), kx, ky), SWEEP_COUNTING)
        D = continuation.on_the_axis
        if radius == 0.0 or any(not departure_from_law(D, radius * r) < LAW for r in OUTWARDS):
            radius = bound(D)[0]
        total += count_in_region(continuation, HalfDisc(max(radius, 4 * level), level)).count
    return total


def oblique(name: str) -> Callable[[bool], Row]:
    """One flow whose fastest wave is oblique."""

    def row(quick: bool) -> Row:
        flow = FLOWS[name]
        base = steady(*flow)
        grid = grown(flow, tuple((HEIGHTS_QUICK if quick else HEIGHTS).tolist()))
        start = max((w for w in grid if min(w) > 0), key=lambda w: grid[w].real)
        best = fastest(flow, start, grid[start])
        level = best.sigma.real * (1 + SAME)
        h = base.centre_of_mass
        around = [best.wave] if quick else [best.wave, *(w for w in grid if math.hypot(*w) * h <= HEIGHTS[-1])]
        faster = counted(flow, around, level)
        itself = counted(flow, [best.wave], best.sigma.real * (1 - SAME))
        axes = [max((s.real for w, s in grid.items() if w[i] == 0), default=0.0) for i in (0, 1)]
        kx, ky = best.wave
        where = f"k_x = {kx:.6g}, k_y = {ky:.6g}"
        cases = (
            Case("the largest growth rate lies at k_x > 0, k_y > 0", "yes", "yes" if min(best.wave) > 0 else "no", 0.0, where),
            Case("the Hessian there is negative", "yes", "yes" if best.curvatures.max() < 0 else "no", 0.0, f"{best.curvatures}"),
            Case(
                "k_y is an order of magnitude above k_x, or more",
                "yes",
                "yes" if ky / kx >= ORDER else "no",
                0.0,
                f"k_y/k_x = {ky / kx:.4g}",
            ),
            Case("modes that grow faster, counted", "0", str(faster), 0.0, f"at {len(around)} waves, Re σ > {level:.6g}"),
            Case("modes that grow as fast, counted at the maximum", "1", str(itself), 0.0),
            Case(
                "waves across the slope grow more slowly, those along it too",
                "yes",
                "yes" if max(axes) < best.sigma.real else "no",
                0.0,
                f"at most {axes[0]:.4g} and {axes[1]:.4g} on the grid",
            ),
        )
        if not quick:
            draw(name, grid, best, h)
        return Row(
            f"an oblique wave is the most unstable one, on a steep slope at low temperature: tan θ = {flow[0]}, T_∞ = {flow[1]}",
            "4.1",
            "k_x > 0 and k_y > 0, k_y an order of magnitude larger; no values",
            f"σ = {best.sigma:.8g} ± {best.error:.0e} at {where}, k_y/k_x = {ky / kx:.3g}; "
            + if_all_hold(cases, f"a maximum, and counts find no mode that grows faster there or at {len(around) - 1} waves about it"),
            cases,
            figures=() if quick else _files(name),
        )

    return row


def pairs(quick: bool) -> Row:
    """Waves across the slope on the steep slope: a pair σ, σ̄."""
    base = steady(*CROSS)
    heights = (1.0,) if quick else (0.8, 0.9, 1.0, 1.2, 1.5)
    cases, told = [], []
    for kh in heights:
        problem = ChuteProblem(base, 0.0, kh / base.centre_of_mass)
        guess = max(suggested(problem), key=lambda s: (s.real, s.imag))
        up = st.refine(problem, guess=complex(guess.real, abs(guess.imag)), rtol=RTOL)
        down = st.refine(problem, guess=complex(guess.real, -abs(guess.imag)), rtol=RTOL)
        level = 0.5 * complex(up.sigma).real
        count = count_in_region(Continuation(problem, SWEEP_COUNTING), HalfDisc(bound(st.Frame(rtol=1e-6).on(problem))[0], level)).count
        cases += [
            Case(f"k_y h0 = {kh}: conjugate pair", complex(up.sigma), complex(down.sigma).conjugate(), 1e-9),
            Case(f"k_y h0 = {kh}: modes growing half as fast or more", "2", str(count), 0.0),
        ]
        told.append(f"{complex(up.sigma).real:.6g} ± {abs(complex(up.sigma).imag):.6g}i at k_y h0 = {kh}")
    said = if_all_hold(cases, "a pair at every one of these wavenumbers, and counts find no third mode that grows half as fast")
    return Row(
        f"waves across the slope oscillate at tan θ = {CROSS[0]}, T_∞ = {CROSS[1]}: waves that travel to either side, or one that stands",
        "4.1",
        "nothing: its instabilities across the slope do not oscillate",
        f"{'; '.join(told)}; {said}",
        tuple(cases),
    )


def _files(name: str) -> tuple[str, str]:
    return f"oblique-{name}.png", f"oblique-{name}.csv"


def draw(name: str, grid: dict[tuple[float, float], complex], best: Fastest, height: float) -> None:
    """Growth over k h0 for every direction of the grid, and the maximum."""
    from matplotlib.figure import Figure

    picture, table = _files(name)
    write_csv(
        table,
        {
            "kx": [w[0] for w in grid],
            "ky": [w[1] for w in grid],
            "sigma_re": [s.real for s in grid.values()],
            "sigma_im": [s.imag for s in grid.values()],
        },
    )
    figure = Figure(figsize=(6.4, 4.2), layout="constrained")
    panel = figure.subplots()
    colours = ["#000000", "#0072B2", "#D55E00", "#009E73", "#CC79A7", "#56B4E9", "#E69F00", "0.6"]
    for ratio, colour in zip((*RATIOS, ALONG), colours, strict=True):
        line = [(math.hypot(*w) * height, s.real) for w, s in grid.items() if _ratio(w) == ratio or abs(_ratio(w) - ratio) < 1e-9]
        label = "along the slope" if ratio == ALONG else "across it" if ratio == 0.0 else f"$k_x/k_y$ = {ratio:g}"
        panel.plot(*np.array(line).T, "o-", color=colour, markersize=3, linewidth=1.2, label=label)
    panel.plot([math.hypot(*best.wave) * height], [best.sigma.real], "*", color="k", markersize=12, label="the maximum")
    panel.set_xscale("log")
    panel.set_xlabel(r"$k h_0$")
    panel.set_ylabel("largest Re σ; 0 where none grows")
    tan, temperature = FLOWS[name]
    where = f"$k_x$ = {best.wave[0]:.4g}, $k_y$ = {best.wave[1]:.4g}"
    panel.set_title(rf"tanθ = {tan}, $T_\infty$ = {temperature}: fastest at {where}", fontsize="medium")
    panel.grid(linewidth=0.4, alpha=0.5)
    panel.legend(fontsize="small", frameon=False)
    figure.savefig(FIGURES / picture, dpi=160)


def _ratio(w: tuple[float, float]) -> float:
    return ALONG if w[1] == 0.0 else w[0] / w[1]


REPRODUCTION = Reproduction(
    "oblique",
    "Oblique waves and oscillating ones on steep slopes",
    (*(Item(f"tan θ = {name}", oblique(name), in_quick=name == "0.33") for name in FLOWS), Item("pairs across the slope", pairs)),
)
