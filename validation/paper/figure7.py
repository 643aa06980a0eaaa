"""Figure 7: stability along the Q-h curve at tanθ = 0.3, the density inversion, and what the growing modes are.

Each flow is looked at over three decades of wavenumbers (models/chute/stability.py): a growing mode, proved, makes it unstable, and it is
called stable where counts find none at any of thirty waves; waves longer than those are the subject of figure 8.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache, partial

import numpy as np
from claims import Case
from figure8 import SlopeRow as Sample
from figure8 import branch
from scenes import problem

import shootstab as st
from paper.figure3 import GrownGrid, fill_contours, grown_grid
from paper.figures456 import shape
from paper.pictures import BLUE, ORANGE, panels, save
from paper.rows import Item, Reproduction, Row, write_csv
from shootstab.models.chute.mode_shape import CLUSTERING, VORTEX_FORMING
from shootstab.models.chute.stability import STABLE, UNSTABLE, stability
from shootstab.models.chute.steady_flow import Flow

TAN = 0.3  # published: figure 7
GRAINS = {"e": 0.8, "e_w": 0.8, "r": 0.6}
TEMPERATURES = np.geomspace(0.08, 20.0, 22)  # chosen: T_∞ of the flows; high, mid and low lie between
QUICK = TEMPERATURES[::7]  # chosen
# chosen: T_∞ of panel (b) and k_x, k_y up to which; nothing grows at the edges
PANELS = {15.0: (0.0075, 0.02), 4.0: (0.014, 0.042), 0.5: (0.025, 0.04)}
INTERVALS = 5  # chosen: along each axis of panel (b)


@dataclass(frozen=True)
class Along:
    """A flow of the curve: what figure 8 says of it too, and the kind of the growing mode that was proved."""

    sample: Sample
    kind: str
    counted: int


@cache
def looked_at(far_temperature: float) -> Along:
    """One flow."""
    flow = st.chute.steady(far_temperature=far_temperature, tan_theta=TAN, **GRAINS)
    found = stability(flow)
    log_nu = flow.states[:, 0].real
    inverted = bool(log_nu.max() > log_nu[-1] + 1e-9)
    growth, kind = None, ""
    if found.mode is not None and found.wave is not None:
        growth = complex(found.mode.sigma).real
        kind = st.eigenfunction(st.chute.problem(flow, *found.wave), found.mode, rtol=1e-6).kind
    sample = Sample(TAN, far_temperature, flow.mass_flux, flow.centre_of_mass, inverted, found.verdict, found.wave, growth)
    return Along(sample, kind, found.counted)


def flows(quick: bool) -> list[Along]:
    """Those of the curve, by rising T_∞."""
    return [looked_at(float(T)) for T in (QUICK if quick else TEMPERATURES)]


def curve(quick: bool) -> Row:
    """Figure 7a."""
    found = flows(quick)
    samples = [f.sample for f in found]
    stable = [i for i, s in enumerate(samples) if s.verdict == STABLE]
    where = sorted({branch(samples, i) for i in stable}) if not quick else []
    doubt = [s for s in samples if s.verdict not in (STABLE, UNSTABLE)]
    cases = (
        Case("undecided flows", "none", "none" if not doubt else doubt[0].verdict, 0.0),
        Case("the hottest flow", UNSTABLE, samples[-1].verdict, 0.0),
        Case("the coldest flow", UNSTABLE, samples[0].verdict, 0.0),
        *((Case("stable flows are on", "mid", " and ".join(where) or "no branch", 0.0),) if not quick else ()),
        *((Case("they are fewer than a third", "yes", "yes" if 3 * len(stable) < len(samples) else "no", 0.0),) if not quick else ()),
    )
    files: tuple[str, ...] = ()
    if not quick:
        files = (_drawn(found), _written(found))
    span = f", T∞ from {samples[stable[0]].far_temperature:.3g} to {samples[stable[-1]].far_temperature:.3g}" if stable else ""
    return Row(
        "figure 7a: stable flows on the mid branch only, a small portion of the curve; dilute and dense ones are unstable",
        "3.3, figure 7",
        "a region of linearly stable flows on the mid-temperature branch",
        f"{len(stable)} of {len(samples)} flows stable at all waves looked at{span}",
        cases,
        figures=files,
    )


def _drawn(found: list[Along]) -> str:
    from matplotlib.ticker import ScalarFormatter

    figure, axes = panels(1, 1, (6.6, 4.8))
    panel = axes[0, 0]
    Q, h = (np.array([getattr(f.sample, part) for f in found]) for part in ("mass_flux", "centre_of_mass"))
    inverted = np.array([f.sample.inverted for f in found])
    stable = np.array([f.sample.verdict == STABLE for f in found])
    panel.plot(np.where(inverted, Q, np.nan), h, "-", color="0.85", linewidth=8, solid_capstyle="butt", label="density inversion")
    panel.plot(Q, h, "-", color="0.4", linewidth=0.8, label="the flows of this slope")
    waves = min(f.counted for f in found if f.sample.verdict == STABLE)
    panel.plot(Q[stable], h[stable], "o", color=BLUE, markersize=6, label=f"no growing mode at any of {waves} waves")
    for kind, mark in ((CLUSTERING, "s"), (VORTEX_FORMING, "^")):
        chosen = np.array([f.kind == kind for f in found])
        panel.plot(Q[chosen], h[chosen], mark, color=ORANGE, markersize=4, label=f"a growing mode, {kind}")
    panel.set_xscale("log")
    panel.set_yscale("log")
    for axis in (panel.xaxis, panel.yaxis):
        axis.set_major_formatter(ScalarFormatter())
        axis.set_minor_formatter(ScalarFormatter())
    panel.set_xlabel("mass flux $Q_0$")
    panel.set_ylabel("height of the centre of mass $h_0$ / d")
    panel.set_title("Figure 7a: tanθ = 0.3, e = $e_w$ = 0.8, r = 0.6", fontsize="medium")
    panel.legend(frameon=False, fontsize="x-small")
    return save(figure, "figure7a.png")


def _written(found: list[Along]) -> str:
    names = ("far_temperature", "mass_flux", "centre_of_mass", "inverted", "verdict", "wave", "growth")
    columns = {name: [getattr(f.sample, name) for f in found] for name in names}
    return write_csv("figure7a.csv", {**columns, "kind": [f.kind for f in found]})


def inversion(quick: bool) -> Row:
    """A stable flow with an inversion, an unstable one without, each as it was proved."""
    found = flows(quick)
    kept = [f for f in found if f.sample.verdict == STABLE and f.sample.inverted]
    broken = [f for f in found if f.sample.verdict == UNSTABLE and not f.sample.inverted]
    cases = (
        Case("an unstable flow without inversion: not necessary", "yes", "yes" if broken else "none found", 0.0),
        *((Case("a stable flow with inversion: not sufficient", "yes", "yes" if kept else "none found", 0.0),) if not quick else ()),
    )
    said = []
    if kept:
        f = kept[len(kept) // 2]
        said.append(f"T∞ = {f.sample.far_temperature:.4g}, Q0 = {f.sample.mass_flux:.4g} is inverted, and none grows at {f.counted} waves")
    if broken:
        f = broken[-1]
        assert f.sample.wave is not None
        at = f"({f.sample.wave[0]:.3g}, {f.sample.wave[1]:.3g})"
        said.append(
            f"T∞ = {f.sample.far_temperature:.4g}, Q0 = {f.sample.mass_flux:.4g} is monotonic, with Re σ = {f.sample.growth:.4g} at {at}"
        )
    return Row(
        "a density inversion is neither necessary nor sufficient for instability",
        "3.3, 4.2, figure 7",
        "there are inverted flows that are stable, and unstable ones with no inversion",
        "; ".join(said),
        cases,
    )


def kinds(quick: bool) -> Row:
    """The three examples of the conclusion, by the rule of figure 6."""
    found = flows(quick)
    monotonic = [f for f in found if not f.sample.inverted and f.kind == VORTEX_FORMING]
    low = problem("low")
    log_nu = low.flow.states[:, 0].real
    low_inverted = bool(log_nu.max() > log_nu[-1] + 1e-9)
    cases = (
        *((Case("a monotonic flow with a vortex-forming mode", "yes", "yes" if monotonic else "none found", 0.0),) if not quick else ()),
        Case("low (Q0 = 3) is density-inverted", "yes", "yes" if low_inverted else "no", 0.0),
        Case("its most unstable mode", CLUSTERING, shape("low").kind, 0.0),
    )
    counted = {kind: sum(f.kind == kind for f in found) for kind in (VORTEX_FORMING, CLUSTERING)}
    said = (
        f"of the {sum(counted.values())} growing modes that make flows of the curve unstable {counted[VORTEX_FORMING]} are vortex-forming"
    )
    if monotonic:
        said += f"; monotonic and vortex-forming: T∞ = {', '.join(f'{f.sample.far_temperature:.3g}' for f in monotonic)}"
    return Row(
        "monotonic flows with vortices, inverted flows whose most unstable mode does not overturn",
        "5",
        "there are both",
        said,
        cases,
    )


def panel_b(far_temperature: float, quick: bool) -> Row:
    """Contours of one flow of panel (b)."""
    flow = st.chute.steady(far_temperature=far_temperature, tan_theta=TAN, **GRAINS)
    grid = grown_grid(flow, PANELS[far_temperature], INTERVALS)
    expected = "k_x = 0" if far_temperature > 1.0 else "k_y = 0"
    cases = (Case("the fastest growth lies at", expected, grid.side, 0.0), *grid.cases)
    figure, axes = panels(1, 1, (5.6, 4.6))
    fill_contours(figure, axes[0, 0], grid)
    figure.suptitle(f"Figure 7b: T∞ = {far_temperature:g}, $Q_0$ = {flow.mass_flux:.3g}", fontsize="medium")
    found = {place: kind_of(flow, grid, place) for place in map(tuple, np.argwhere(~np.isnan(grid.sigma)).tolist())}
    turning = sum(kind == VORTEX_FORMING for kind in found.values())
    kinds = [found.get(place, "") for place in np.ndindex(grid.rates.shape)]
    stem = f"figure7b-{far_temperature:g}"
    files = (save(figure, f"{stem}.png"), write_csv(f"{stem}.csv", {**grid.columns, "kind": kinds}))
    return Row(
        f"figure 7b, T∞ = {far_temperature:g}, Q0 = {flow.mass_flux:.4g}",
        "3.3, figure 7b",
        "the cross-slope instability at high temperature and downslope instability at low temperature",
        grid.said,
        cases,
        note=f"of the {len(found)} modes that grow {turning} are vortex-forming, {len(found) - turning} clustering; the fastest of them is "
        f"{found[grid.best]}",
        figures=files,
    )


def kind_of(flow: Flow, grid: GrownGrid, place: tuple[int, int]) -> str:
    """The kind of the dominant mode at one point of a grid, by the rule of figure 6."""
    p = st.chute.problem(flow, float(grid.kx[place[0]]), float(grid.ky[place[1]]))
    return str(st.eigenfunction(p, complex(grid.sigma[place]), rtol=1e-6).kind)


REPRODUCTION = Reproduction(
    "figure7",
    "Stability along the Q-h curve at tanθ = 0.3",
    (
        Item("figure 7a", curve),
        Item("inversion", inversion),
        Item("kinds", kinds),
        *(Item(f"figure 7b {T:g}", partial(panel_b, T), in_quick=False) for T in PANELS),
    ),
)
