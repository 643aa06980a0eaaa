"""Figure 3 and section 3.2: growth rates of the three flows at Q0 = 3 over k_x and k_y, and their most unstable wavenumbers.

At every point of the grid all modes that grow at least half as fast as the dominant one are counted, so that dominance, or that nothing
grows, is proved there. The most unstable wavenumbers are found by maximization of Re σ to eight digits, and checked by the adjoint:
Re ∂σ/∂k vanishes there.
"""

from __future__ import annotations

from functools import cache, partial
from typing import Any

import numpy as np
from claims import Case
from scenes import GUESS, problem

import shootstab as st
from paper.pictures import panels, save
from paper.rows import Item, Reproduction, Row, write_csv
from shootstab.analyses.sweep import Swept
from shootstab.models.chute import ChuteProblem

EXTENT = {
    "high": (0.0104, 0.028),
    "mid": (0.0064, 0.028),
    "low": (0.056, 0.056),
}  # chosen: k_x, k_y up to which; nothing grows at the edges
POINTS = 8  # chosen: intervals along each axis
DIGITS = 4  # chosen: digits of σ at each point; a contour shows two
LEVELS = 12  # chosen: contours
# published: section 3.2; the unit is of the last digit printed
FASTEST = {"high": ("ky", 0.0100, 1e-4), "mid": ("ky", 0.0125, 1e-4), "low": ("kx", 0.011, 1e-3)}
PUBLISHED = {"high": (0.00397, 1e-5), "mid": (0.00102, 1e-5), "low": (0.00727, 1e-5)}
NOTES = {
    "mid": "by maximization and by the adjoint; at the published 0.0125 the growth rate is less only in its fifth digit",
    "low": "the growth rate is one unit off in its third digit, 0.00728 if rounded",
}
RANGE = (0.7, 1.4)  # chosen: multiples of the published wavenumber between which the maximum is looked for
STATIONARY = 1e-6  # chosen: part of Re σ/k ∂ Re σ/∂k may be at the maximum


def at(name: str, k: float) -> ChuteProblem:
    """The flow with this wavenumber along its own axis."""
    flow = problem(name).flow
    return st.chute.problem(flow, k, 0.0) if FASTEST[name][0] == "kx" else st.chute.problem(flow, 0.0, k)


@cache
def maximum(name: str) -> tuple[float, complex]:
    """The wavenumber of the largest Re σ along its axis, and σ there."""
    from scipy.optimize import minimize_scalar

    guess = {FASTEST[name][1]: GUESS[name]}

    def decay(k: float) -> float:
        near = min(guess, key=lambda other: abs(other - k))
        mode = st.refine(at(name, k), guess=guess[near], rtol=1e-10)
        if not mode.converged:
            raise RuntimeError(f"{name}, k = {k:g}: {mode.status}")
        guess[k] = complex(mode.sigma)
        return -guess[k].real

    middle = FASTEST[name][1]
    found = minimize_scalar(decay, bracket=(RANGE[0] * middle, middle, RANGE[1] * middle), options={"xtol": 1e-6})
    return float(found.x), guess[float(found.x)]


def fastest(name: str, quick: bool) -> Row:
    """The most unstable wavenumber of one flow and the growth rate there."""
    axis, paper, unit = FASTEST[name]
    k, sigma = maximum(name)
    p = at(name, k)
    slope = st.sensitivities(st.eigenfunction(p, sigma, rtol=1e-9), [axis])[0].derivative.real * k / sigma.real
    rate, digit = PUBLISHED[name]
    own = st.refine(problem(name), guess=GUESS[name], rtol=1e-10).sigma
    stationary = "yes" if abs(slope) < STATIONARY else f"{slope:.1e}"
    cases = (
        Case(f"{name}: {axis} of the maximum", paper, k, 0.5 * unit / paper),
        Case(f"{name}: Re σ there", rate, sigma.real, digit / rate, f"σ = {sigma:.10g}"),
        Case(f"{name}: ∂ Re σ/∂{axis} k/Re σ by the adjoint below {STATIONARY:g}", "yes", stationary, 0.0, f"{slope:.1e}"),
        Case(f"{name}: σ at the published wavenumber", rate, complex(own).real, None, f"σ = {complex(own):.10g}"),
    )
    said = f"{axis} = {k:.7g}, σ = {sigma.real:.8f}" + (f" − {abs(sigma.imag):.8f}i" if sigma.imag else "")
    note = NOTES.get(name, "")
    says = f"{axis} = {paper:g}, Re σ = {rate:g}"
    return Row(f"{name}: the most unstable wavenumber", "3.2", says, said, cases, note=note)


@cache
def swept(name: str, intervals: int) -> Swept:
    """The dominant growth rate over the grid, counted at every point; k_x = k_y = 0 is left out."""
    kx, ky = (np.linspace(0.0, top, intervals + 1) for top in EXTENT[name])
    return st.sweep(problem(name), {"kx": kx, "ky": ky[1:]}, digits=DIGITS, every=1, floor=1e-7)


@cache
def along_kx(name: str, intervals: int) -> Swept:
    """The row k_y = 0 of the grid."""
    return st.sweep(
        problem(name), {"kx": np.linspace(0.0, EXTENT[name][0], intervals + 1)[1:], "ky": 0.0}, digits=DIGITS, every=1, floor=1e-7
    )


def growth(name: str, intervals: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """k_x (n,), k_y (m,) and max Re σ (n, m), 0 where nothing grows."""
    whole, axis = swept(name, intervals), along_kx(name, intervals)
    inner = np.nan_to_num(whole.growth)
    border = np.concatenate(([0.0], np.nan_to_num(axis.growth).ravel()))
    kx, ky = (np.linspace(0.0, top, intervals + 1) for top in EXTENT[name])
    return kx, ky, np.column_stack((border, inner))


def contours(name: str, quick: bool) -> Row:
    """Figure 3 of one flow: which axis its fastest growth lies on, and whether the grid holds the whole unstable region."""
    intervals = 2 if quick else POINTS
    kx, ky, rates = growth(name, intervals)
    parts = (swept(name, intervals), along_kx(name, intervals))
    counted, total = sum(p.summary["counted"] for p in parts), sum(len(p.grid) for p in parts)
    i, j = np.unravel_index(int(rates.argmax()), rates.shape)
    best = "k_x = 0" if i == 0 else "k_y = 0" if j == 0 else "k_x, k_y > 0"
    enclosed = not (rates[-1].any() or rates[:, -1].any())
    paper_axis = "k_x = 0" if FASTEST[name][0] == "ky" else "k_y = 0"
    cases = (
        Case("the fastest growth lies at", paper_axis, best, 0.0),
        Case("grows for some k_x > 0 with k_y = 0", "yes", "yes" if rates[:, 0].any() else "no", 0.0),
        Case("grows for some k_y > 0 with k_x = 0", "yes", "yes" if rates[0].any() else "no", 0.0),
        Case("nothing grows at the outer edges of the grid", "yes", "yes" if enclosed else "no", 0.0),
        Case("points at which the modes are counted", f"{total} of {total}", f"{counted} of {total}", 0.0),
    )
    files = (drawn(name, kx, ky, rates), stored(name, kx, ky, rates)) if not quick else ()
    said = f"largest of the grid {rates.max():.5f} at ({kx[i]:.3g}, {ky[j]:.3g}); along k_x growing up to {_last(kx, rates[:, 0])}"
    said += f", along k_y up to {_last(ky, rates[0])}"
    return Row(
        f"figure 3, {name}: the growth rate over k_x and k_y",
        "3.2, figure 3",
        f"fastest at {paper_axis}, both axes unstable",
        said,
        cases,
        figures=files,
    )


def _last(k: np.ndarray, rates: np.ndarray) -> str:
    """The last wavenumber at which something grows and the next one."""
    i = int(np.flatnonzero(rates)[-1]) if rates.any() else 0
    return f"{k[i]:.3g} … {k[min(i + 1, len(k) - 1)]:.3g}"


def stored(name: str, kx: np.ndarray, ky: np.ndarray, rates: np.ndarray) -> str:
    """The data of one panel."""
    X, Y = np.meshgrid(kx, ky, indexing="ij")
    return write_csv(f"figure3-{name}.csv", {"kx": X.ravel(), "ky": Y.ravel(), "growth": rates.ravel()})


def drawn(name: str, kx: np.ndarray, ky: np.ndarray, rates: np.ndarray) -> str:
    """One panel, with the maximum along its axis; lines are interpolated between the points, which are marked."""
    figure, axes = panels(1, 1, (5.6, 4.4))
    fill_contours(figure, axes[0, 0], kx, ky, rates)
    axis, _, _ = FASTEST[name]
    k, sigma = maximum(name)
    place = (k, 0.0) if axis == "kx" else (0.0, k)
    axes[0, 0].plot(*place, "*", color="white", markeredgecolor="black", markersize=12, clip_on=False, zorder=4)
    figure.suptitle(f"Figure 3, {name}: largest Re σ {sigma.real:.5f} at {axis} = {k:.5g}", fontsize="medium")
    return save(figure, f"figure3-{name}.png")


def fill_contours(figure: Any, panel: Any, kx: np.ndarray, ky: np.ndarray, rates: np.ndarray) -> None:
    """Contours of Re σ (n, m) where it is above 0, the points, and a bar."""
    levels = np.linspace(0.0, rates.max(), LEVELS + 1)
    levels[0] = 1e-3 * rates.max()
    held = panel.contourf(kx, ky, rates.T, levels=levels, cmap="viridis")
    panel.plot(*(a.ravel() for a in np.meshgrid(kx, ky)), ".", color="black", markersize=1.5)
    panel.set_xlabel("$k_x$ d")
    panel.set_ylabel("$k_y$ d")
    panel.ticklabel_format(style="sci", scilimits=(-2, 3))
    figure.colorbar(held, ax=panel, label="Re σ")


REPRODUCTION = Reproduction(
    "figure3",
    "Growth rates of the three flows at Q0 = 3",
    (
        *(Item(f"fastest {name}", partial(fastest, name)) for name in FASTEST),
        *(Item(f"figure 3 {name}", partial(contours, name), in_quick=name == "high") for name in FASTEST),
    ),
)
