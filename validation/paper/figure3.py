"""Figure 3 and section 3.2: growth rates of the three flows at Q0 = 3 over k_x and k_y, and their most unstable wavenumbers.

At every point of the grid all modes that grow at least half as fast as the dominant one are counted by the argument principle, so that
none grows faster there, or none above the floor where nothing grows; between the points nothing is counted. The most unstable wavenumbers
are found by maximization of Re σ to eight digits, and checked by the adjoint: Re ∂σ/∂k vanishes there.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cache, partial
from typing import Any

import numpy as np
from claims import Case
from scenes import GUESS, problem

import shootstab as st
from paper.pictures import panels, save
from paper.rows import Item, Reproduction, Row, write_csv
from shootstab.models.chute import ChuteProblem

EXTENT = {
    "high": (0.0104, 0.028),
    "mid": (0.0064, 0.028),
    "low": (0.056, 0.056),
}  # chosen: k_x, k_y up to which; nothing grows at the edges
POINTS = 8  # chosen: intervals along each axis
DIGITS = 4  # chosen: digits of σ at each point; a contour shows two
FLOOR = 1e-7  # chosen: the growth rate above which modes are counted, 1e-4 of the largest
STEPS = 4  # chosen: steps in which a mode is followed to the next point
LEVELS = 12  # chosen: contours
# published: section 3.2; the unit is of the last digit printed, and a number agrees that is ours rounded
FASTEST = {"high": ("ky", 0.0100, 1e-4), "mid": ("ky", 0.0125, 1e-4), "low": ("kx", 0.011, 1e-3)}
PUBLISHED = {"high": (0.00397, 1e-5), "mid": (0.00102, 1e-5), "low": (0.00727, 1e-5)}
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
        Case(f"{name}: Re σ there", rate, sigma.real, 0.5 * digit / rate, f"σ = {sigma:.10g}"),
        Case(f"{name}: ∂ Re σ/∂{axis} k/Re σ by the adjoint below {STATIONARY:g}", "yes", stationary, 0.0, f"{slope:.1e}"),
        Case(f"{name}: σ at the published wavenumber", rate, complex(own).real, None, f"σ = {complex(own):.10g}"),
    )
    said = f"{axis} = {k:.7g}, σ = {sigma.real:.8f}" + (f" − {abs(sigma.imag):.8f}i" if sigma.imag else "")
    cut = all(
        math.floor(ours / last + 1e-9) == round(theirs / last) for theirs, ours, last in ((paper, k, unit), (rate, sigma.real, digit))
    )
    loss = 1 - complex(own).real / sigma.real
    note = f"at the published wavenumber the growth rate is less by {loss:.1e} of itself"
    if any(not case.holds for case in cases):
        note += "; a number is not ours rounded" + (", but both are ours cut after the last digit printed" if cut else "")
    says = f"{axis} = {paper:g}, Re σ = {rate:g}"
    return Row(f"{name}: the most unstable wavenumber", "3.2", says, said, cases, note=note)


@dataclass(frozen=True)
class GrownGrid:
    """max Re σ (n, m) over k_x (n,) and k_y (m,), and in how many of its points the modes were counted.

    Beyond a neutral curve it is Re σ < 0 of the mode that grows at the next point, and 0 where none was followed so far.
    sigma (n, m): the dominant modes, NaN where nothing grows above the floor, of which this is the highest.
    """

    kx: np.ndarray
    ky: np.ndarray
    rates: np.ndarray
    sigma: np.ndarray
    floor: float
    followed: int
    counted: int
    total: int

    @property
    def best(self) -> tuple[int, int]:
        """Where the largest rate is."""
        i, j = np.unravel_index(int(self.rates.argmax()), self.rates.shape)
        return int(i), int(j)

    @property
    def side(self) -> str:
        """The axis on which that lies."""
        i, j = self.best
        return "k_x = 0" if i == 0 else "k_y = 0" if j == 0 else "k_x, k_y > 0"

    @property
    def enclosed(self) -> bool:
        """Whether nothing grows at the outer edges."""
        return not ((self.rates[-1] > 0).any() or (self.rates[:, -1] > 0).any())

    @property
    def cases(self) -> tuple[Case, ...]:
        """What is asked of each grid."""
        return (
            Case("nothing grows at the outer edges of the grid", "yes", "yes" if self.enclosed else "no", 0.0),
            Case("points at which the modes are counted", f"{self.total} of {self.total}", f"{self.counted} of {self.total}", 0.0),
        )

    @property
    def said(self) -> str:
        """The largest rate and where growth ends, for the row."""
        i, j = self.best
        largest = f"{self.rates.max():.5f} at ({self.kx[i]:.3g}, {self.ky[j]:.3g})"
        along = [f"along {name} growing up to {_last(k, r)}" for name, k, r in self.along]
        grow = int((~np.isnan(self.sigma)).sum())
        said = f"on a grid of {len(self.kx)} by {len(self.ky)} points, largest {largest}; {', '.join(along)}; at {self.counted} of "
        said += f"{self.total} points counts say that no mode grows faster: something grows at {grow}, at the others nothing above "
        said += f"{self.floor:.0e}; "
        return said + f"next to those that grow {self.followed} modes are followed to Re σ < 0"

    @property
    def along(self) -> tuple[tuple[str, np.ndarray, np.ndarray], ...]:
        """Name, wavenumbers and rates of the two axes."""
        return ("k_x", self.kx, self.rates[:, 0]), ("k_y", self.ky, self.rates[0])

    @property
    def columns(self) -> dict[str, np.ndarray]:
        """The data of the panel."""
        X, Y = np.meshgrid(self.kx, self.ky, indexing="ij")
        return {"kx": X.ravel(), "ky": Y.ravel(), "growth": self.rates.ravel()}


def grown_grid(flow: Any, extent: tuple[float, float], intervals: int) -> GrownGrid:
    """The dominant growth rate of a flow over the grid, counted at every point but k_x = k_y = 0."""
    kx, ky = (np.linspace(0.0, top, intervals + 1) for top in extent)
    problem = st.chute.problem(flow, 0.0, float(ky[1]))
    parts = [st.sweep(problem, axes, digits=DIGITS, every=1, floor=FLOOR) for axes in ({"kx": kx, "ky": ky[1:]}, {"kx": kx[1:], "ky": 0.0})]
    inner, border = (part.array(lambda o: o.sigma, dtype=np.complex128) for part in parts)
    sigma = np.column_stack((np.concatenate(([np.nan], border.ravel())), inner))
    beyond = followed_below(flow, kx, ky, sigma)
    rates = np.nan_to_num(sigma.real)
    for place, rate in beyond.items():
        rates[place] = rate
    counted, total = (sum(f(part) for part in parts) for f in (lambda p: p.summary["counted"], lambda p: len(p.grid)))
    floor = max((o.floor for part in parts for _, o in part.rows() if o.sigma is None and o.floor is not None), default=FLOOR)
    return GrownGrid(kx, ky, rates, sigma, floor, len(beyond), counted, total)


def followed_below(flow: Any, kx: np.ndarray, ky: np.ndarray, sigma: np.ndarray) -> dict[tuple[int, int], float]:
    """Re σ < 0 where nothing grows (σ NaN) next to a point where something does: of the mode of that point, followed in STEPS steps.

    With it the line Re σ = 0 runs between points and not through them. A mode that is lost, as in the continuous spectrum, is left out.
    """
    found: dict[tuple[int, int], float] = {}
    for i, j in np.argwhere(np.isnan(sigma)):
        near = [(i + a, j + b) for a, b in ((-1, 0), (0, -1), (-1, -1)) if min(i + a, j + b) >= 0 and not np.isnan(sigma[i + a, j + b])]
        if not near:
            continue
        m, n = near[0]
        guess, before = complex(sigma[m, n]), complex(sigma[m, n])
        for s in np.linspace(0.0, 1.0, STEPS + 1)[1:]:
            mode = st.refine(st.chute.problem(flow, kx[m] + s * (kx[i] - kx[m]), ky[n] + s * (ky[j] - ky[n])), guess=guess, rtol=1e-5)
            if not mode.converged:
                break
            guess, before = 2 * complex(mode.sigma) - before, complex(mode.sigma)
        else:
            if before.real < 0.0:
                found[int(i), int(j)] = before.real
    return found


@cache
def swept(name: str, intervals: int) -> GrownGrid:
    """The grid of one flow."""
    return grown_grid(problem(name).flow, EXTENT[name], intervals)


def contours(name: str, quick: bool) -> Row:
    """Figure 3 of one flow: which axis its fastest growth lies on, and whether the grid holds the whole unstable region."""
    grid = swept(name, 2 if quick else POINTS)
    paper_axis = "k_x = 0" if FASTEST[name][0] == "ky" else "k_y = 0"
    cases = (
        Case("the fastest growth lies at", paper_axis, grid.side, 0.0),
        *(Case(f"grows somewhere along {axis}", "yes", "yes" if (r > 0).any() else "no", 0.0) for axis, _, r in grid.along),
        *grid.cases,
    )
    files = () if quick else (drawn(name, grid), write_csv(f"figure3-{name}.csv", grid.columns))
    return Row(
        f"figure 3, {name}: the growth rate over k_x and k_y",
        "3.2, figure 3",
        f"fastest at {paper_axis}, both axes unstable",
        grid.said,
        cases,
        figures=files,
    )


def _last(k: np.ndarray, rates: np.ndarray) -> str:
    """The last wavenumber at which something grows and the next one."""
    growing = np.flatnonzero(rates > 0)
    i = int(growing[-1]) if len(growing) else 0
    return f"{k[i]:.3g} … {k[min(i + 1, len(k) - 1)]:.3g}"


def drawn(name: str, grid: GrownGrid) -> str:
    """One panel, with the maximum along its axis."""
    figure, axes = panels(1, 1, (5.6, 4.6))
    fill_contours(figure, axes[0, 0], grid)
    axis, _, _ = FASTEST[name]
    k, sigma = maximum(name)
    place = (k, 0.0) if axis == "kx" else (0.0, k)
    axes[0, 0].plot(*place, "*", color="white", markeredgecolor="black", markersize=12, clip_on=False, zorder=4)
    figure.suptitle(f"Figure 3, {name}: largest Re σ {sigma.real:.5f} at $k_{axis[1]}$ = {k:.5g}", fontsize="medium")
    return save(figure, f"figure3-{name}.png")


def fill_contours(figure: Any, panel: Any, grid: GrownGrid) -> None:
    """Contours of Re σ where it is above 0, linear between the points, the points, and a bar."""
    levels = np.linspace(0.0, grid.rates.max(), LEVELS + 1)
    levels[0] = 1e-6 * grid.rates.max()  # chosen: the 0 of points where nothing grows and no mode was followed is left out
    held = panel.contourf(grid.kx, grid.ky, grid.rates.T, levels=levels, cmap="viridis")
    panel.contour(grid.kx, grid.ky, grid.rates.T, levels=levels[:1], colors="black", linewidths=0.8)
    panel.plot(*(a.ravel() for a in np.meshgrid(grid.kx, grid.ky)), ".", color="black", markersize=2.0, clip_on=False)
    panel.set_xlabel("$k_x$ d")
    panel.set_ylabel("$k_y$ d")
    panel.set_title(f"{len(grid.kx)} by {len(grid.ky)} points, contours linear between them", fontsize="small")
    figure.colorbar(held, ax=panel, label="Re σ", format="%.4f")


REPRODUCTION = Reproduction(
    "figure3",
    "Growth rates of the three flows at Q0 = 3",
    (
        *(Item(f"fastest {name}", partial(fastest, name)) for name in FASTEST),
        *(Item(f"figure 3 {name}", partial(contours, name), in_quick=name == "high") for name in FASTEST),
    ),
)
