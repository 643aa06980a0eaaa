"""Figure 8 of the paper: where flows lose their stability, over all wavenumbers.

Long waves. At k = 0 one mode is neutral: mass is conserved, everything else is damped or driven by the base. For k → 0 it is

    σ = −i c k_x + d_x k_x² + d_y k_y² + O(k³),    c = dQ0/dM0 along the family of flows,

a kinematic wave. A flow with d_x > 0 or d_y > 0 is unstable, and no set of wavenumbers that begins at some k > 0 is sure to see it. So the
edges of stability are zeros of d_x(T_∞) and d_y(T_∞). What is not long is counted: see `nothing_grows`.

`validation/figure8.py` asks about thirty waves of each flow, and draws the figure.
"""

from __future__ import annotations

import csv
import math
from collections.abc import Callable, Iterator
from dataclasses import asdict, dataclass, fields
from functools import cache
from typing import Any

import numpy as np
from claims import Case

import shootstab as st
from paper.rows import FIGURES, Item, Reproduction, Row, digits
from shootstab.analyses.cut_region import count_in_region
from shootstab.analyses.sweep.dominance import SWEEP_COUNTING, lowest_floor, suggested
from shootstab.analyses.unstable import LAW, OUTWARDS, HalfDisc, bound, departure_from_law
from shootstab.discriminants.continuation import Continuation
from shootstab.models.chute.chute_problem import ChuteProblem
from shootstab.models.chute.steady_flow import Flow

GRAINS = {"e": 0.8, "e_w": 0.8, "r": 0.6}  # published: figure 8
SLOPES = tuple(round(0.25 + 0.01 * i, 2) for i in range(11))  # chosen
GENTLE, WINDOW, STEEP = SLOPES[:4], SLOPES[4:8], SLOPES[8:]  # published: unstable, partly stable, unstable
TEMPERATURES = (0.05, 30.0, 49)  # chosen: T_∞ from, to, how many: those of figure8.py
LONG = (4e-5, 2e-5, 1e-5)  # chosen: k h0 of the waves that d is extrapolated from; halved, so that two orders of k go
LONG_RTOL = 1e-11  # chosen: the tolerance relative to |σ|, of which d k² is 1e-5 at least
SETTLED = 0.1  # chosen: the part of |d| that its extrapolation may leave for its sign to count
ASIDE = 1e-4  # chosen: relative step of T_∞ for dQ0/dM0
EDGE = 1e-8  # chosen: the error of ln T_∞ at an edge
OBLIQUE = math.pi / 4  # chosen
DIRECTIONS = (0.0, math.pi / 8, math.pi / 4, 3 * math.pi / 8, math.atan(10.0), math.pi / 2)  # chosen: arctan k_y/k_x; 10 is the paper's
HEIGHTS = (1e-3, 10.0)  # chosen: k h0 of the waves that are counted
PER_DECADE, PER_DECADE_QUICK = 3, 1  # chosen
FLOOR = 1e-8  # chosen: the growth rate above which modes are counted, or what the continuous spectrum asks for
GROWING_RTOL = 1e-6  # chosen: the accuracy of a mode that proves an instability
COLUMNS = "edges.csv"


@cache
def steady(tan_theta: float, far_temperature: float) -> Flow:
    """The flow of figure 8 with this slope and T_∞."""
    return st.chute.steady(far_temperature=far_temperature, tan_theta=tan_theta, **GRAINS)


def wave(k: float, direction: float) -> tuple[float, float]:
    """(k_x, k_y), exactly on an axis at its ends."""
    return (0.0 if direction == math.pi / 2 else k * math.cos(direction)), k * math.sin(direction)


def kinematic_speed(flow: Flow) -> float:
    """dQ0/dM0 along the flows of one slope."""
    tan, T = flow.chute.tan_theta, flow.far_temperature
    ahead, behind = (steady(tan, T * (1 + d)) for d in (ASIDE, -ASIDE))
    return (ahead.mass_flux - behind.mass_flux) / (ahead.hold_up - behind.hold_up)


@dataclass(frozen=True)
class LongWave:
    """σ = −i speed k + d k² + …, of waves of one direction; error is what the extrapolation of d leaves. NaN where a mode is lost."""

    speed: float
    d: float
    error: float

    @property
    def settled(self) -> bool:
        """Whether the sign of d is known."""
        return self.error <= SETTLED * abs(self.d)


def long_wave(flow: Flow, direction: float) -> LongWave:
    """Re σ/k² for k → 0, of modes at k h0 of LONG, extrapolated twice; the direction is not π/2, where σ is real and decays unseen."""
    c = kinematic_speed(flow)
    values, errors, speeds = [], [], []
    for kh in LONG:
        k = kh / flow.centre_of_mass
        kx, ky = wave(k, direction)
        mode = st.refine(ChuteProblem(flow, kx, ky), guess=-1j * c * kx, rtol=LONG_RTOL)
        if not mode.converged:
            return LongWave(math.nan, math.nan, math.inf)
        values.append(complex(mode.sigma).real / k**2)
        errors.append(float(mode.error) / k**2)
        speeds.append(-complex(mode.sigma).imag / kx)
    once = [2 * values[i + 1] - values[i] for i in range(2)]
    d = (4 * once[1] - once[0]) / 3
    return LongWave(2 * speeds[2] - speeds[1], d, abs(d - once[1]) + 4 * max(errors))


@dataclass(frozen=True)
class FlowSample:
    """A flow: slope, T_∞, Q0, M0, h0, c = dQ0/dM0, and d_x, d_y with what their extrapolations leave."""

    tan_theta: float
    far_temperature: float
    mass_flux: float
    hold_up: float
    height: float
    speed: float
    d_x: float
    error_x: float
    d_y: float
    error_y: float

    @property
    def grows(self) -> bool | None:
        """Whether long waves grow; None where the signs are not known."""
        signs = [math.copysign(1.0, d) for d, e in ((self.d_x, self.error_x), (self.d_y, self.error_y)) if e <= SETTLED * abs(d)]
        return True if 1.0 in signs else False if len(signs) == 2 else None

    @property
    def largest(self) -> float:
        """max(d_x, d_y)."""
        return max(self.d_x, self.d_y)


@cache
def sample(tan_theta: float, far_temperature: float) -> FlowSample:
    """All of it; d_y from the direction between, for d is a quadratic form without a mixed term: k_y and −k_y are the same."""
    flow = steady(tan_theta, far_temperature)
    along, between = long_wave(flow, 0.0), long_wave(flow, OBLIQUE)
    return FlowSample(
        tan_theta,
        far_temperature,
        flow.mass_flux,
        flow.hold_up,
        flow.centre_of_mass,
        kinematic_speed(flow),
        along.d,
        along.error,
        2 * between.d - along.d,
        2 * between.error + along.error,
    )


def curve(tan_theta: float) -> list[FlowSample]:
    """The flows of a slope, from figures/edges.csv where they stand there."""
    known = {(s.tan_theta, s.far_temperature): s for s in _read()}
    wanted = [(tan_theta, float(f"{T:.6g}")) for T in np.geomspace(*TEMPERATURES)]
    missing = [job for job in wanted if job not in known]
    for job in missing:
        known[job] = sample(*job)
    if missing:
        with (FIGURES / COLUMNS).open("w", newline="", encoding="utf-8") as file:
            writer = csv.writer(file)
            writer.writerow([f.name for f in fields(FlowSample)])
            writer.writerows([f"{v:.10g}" for v in asdict(known[job]).values()] for job in sorted(known))
    return [known[job] for job in wanted]


def _read() -> list[FlowSample]:
    path = FIGURES / COLUMNS
    if not path.exists():
        return []
    with path.open(newline="", encoding="utf-8") as file:
        return [FlowSample(**{name: float(text) for name, text in line.items()}) for line in csv.DictReader(file)]


def zero(tan_theta: float, which: str, between: tuple[float, float]) -> float:
    """The T_∞ between these at which d_x or d_y is zero."""
    from scipy.optimize import brentq

    root = brentq(lambda x: getattr(sample(tan_theta, math.exp(x)), which), *sorted(map(math.log, between)), xtol=EDGE, rtol=1e-14)
    return math.exp(root)


@dataclass(frozen=True)
class Window:
    """T_∞ between which long waves decay: its edges, and which of d_x, d_y vanishes there ('' at the end of what was sampled)."""

    low: float
    high: float
    at_low: str
    at_high: str


def windows(samples: list[FlowSample]) -> list[Window]:
    """Where d_x < 0 and d_y < 0, from signs at the samples, with the edges located."""
    out: list[Window] = []
    begun: tuple[float, str] | None = None
    for i, here in enumerate(samples):
        if here.grows is False and begun is None:
            begun = (here.far_temperature, "") if i == 0 else _edge(samples[i - 1], here)
        if begun is not None and (here.grows is not False or i == len(samples) - 1):
            low, at_low = begun
            high, at_high = (here.far_temperature, "") if here.grows is False else _edge(here, samples[i - 1])
            out.append(Window(low, high, at_low, at_high))
            begun = None
    return out


def _edge(outside: FlowSample, inside: FlowSample) -> tuple[float, str]:
    """Where the window ends between a sample outside and its neighbour inside: the zero nearest to the one inside."""
    zeros = [
        (zero(inside.tan_theta, which, (outside.far_temperature, inside.far_temperature)), which)
        for which in ("d_x", "d_y")
        if getattr(outside, which) * getattr(inside, which) < 0
    ]
    return min(zeros, key=lambda found: abs(math.log(found[0] / inside.far_temperature)))


def growing(flow: Flow, waves: list[tuple[float, float]]) -> tuple[tuple[float, float], Any] | None:
    """A wave with a mode that grows by more than its error, and the mode."""
    for kx, ky in waves:
        problem = ChuteProblem(flow, kx, ky)
        for guess in suggested(problem)[:1]:
            mode = st.refine(problem, guess=guess, rtol=GROWING_RTOL)
            if mode.converged and complex(mode.sigma).real > float(mode.error):
                return (kx, ky), mode
    return None


def nothing_grows(flow: Flow, per_decade: int) -> tuple[int, int, float]:
    """(waves counted, modes that grow at them, the highest floor) over DIRECTIONS and k h0 in HEIGHTS.

    Between the waves: the count can change only where a mode crosses Re σ = floor, and so at two neighbours it would have to come and go.
    Below HEIGHTS d k² + O(k³) holds, and above it viscosity damps as K² what varies along the slope.
    """
    counted, found, highest = 0, 0, 0.0
    steps = round(math.log10(HEIGHTS[1] / HEIGHTS[0]) * per_decade) + 1
    for direction in DIRECTIONS:
        radius = 0.0
        for kh in np.geomspace(*HEIGHTS, steps):
            problem = ChuteProblem(flow, *wave(float(kh) / flow.centre_of_mass, direction))
            continuation = Continuation(problem, SWEEP_COUNTING)
            D = continuation.on_the_axis
            if radius == 0.0 or any(not departure_from_law(D, radius * r) < LAW for r in OUTWARDS):
                radius = bound(D)[0]
            floor = lowest_floor(continuation, FLOOR)
            found += count_in_region(continuation, HalfDisc(radius, floor)).count
            counted, highest = counted + 1, max(highest, floor)
    return counted, found, highest


# rows


def asymptotics(quick: bool) -> Row:
    """c against dQ0/dM0, and d in a third direction against the quadratic form."""
    cases = []
    for tan, T in ((0.30, 1.0),) if quick else ((0.30, 1.0), (0.30, 2.0), (0.28, 0.5), (0.33, 0.8)):
        flow, here, direction = steady(tan, T), sample(tan, T), math.pi / 3
        found = long_wave(flow, direction)
        form = here.d_x * math.cos(direction) ** 2 + here.d_y * math.sin(direction) ** 2
        cases += [
            Case(f"tan θ = {tan}, T = {T}: speed", here.speed, found.speed, 1e-4, "expected is dQ0/dM0, of steady flows alone"),
            Case(f"tan θ = {tan}, T = {T}: d at 60°", form, found.d, 1e-4, f"d_x = {here.d_x:.6g}, d_y = {here.d_y:.6g}"),
        ]
    return Row(
        "long waves obey σ = −i c k_x + d_x k_x² + d_y k_y², with c = dQ0/dM0",
        "3.3, figure 8",
        "nothing; its waves are a set of k > 0",
        f"the kinematic wave of mass, in {min(map(digits, cases)):.1f} digits and more",
        tuple(cases),
    )


def window(tan: float) -> Callable[[bool], Row]:
    """The stable flows of a slope, and where they end."""

    def row(quick: bool) -> Row:
        samples = curve(tan)
        found = windows(samples)
        flows = [(w, steady(tan, math.sqrt(w.low * w.high))) for w in found]
        cases, told = [], []
        for w, middle in flows:
            ends = [sample(tan, T) for T in (w.low, w.high)]
            slope = [(steady(tan, T * (1 + ASIDE)).mass_flux - steady(tan, T * (1 - ASIDE)).mass_flux) for T in (w.low, w.high)]
            branch = "mid" if max(slope) < 0 else "not mid alone"
            grows = growing(middle, [wave(kh / middle.centre_of_mass, t) for kh in (0.3, 1.0) for t in DIRECTIONS[-2:]])
            where = (
                f"T_∞ {w.low:.6g} ({w.at_low} = 0) to {w.high:.6g} ({w.at_high} = 0), Q0 {ends[0].mass_flux:.5g} to {ends[1].mass_flux:.5g}"
            )
            if grows is not None:
                told.append(f"long waves decay for {where}, yet {complex(grows[1].sigma):.4g} grows at k = {grows[0]}")
                continue
            waves, count, floor = nothing_grows(middle, PER_DECADE_QUICK if quick else PER_DECADE)
            told.append(f"stable for {where}")
            cases += [
                Case(f"T_∞ {w.low:.4g} to {w.high:.4g}: branch", "mid", branch, 0.0, "mid is where Q0 falls with T_∞"),
                Case(f"T_∞ = {middle.far_temperature:.4g}: modes that grow", "0", str(count), 0.0, f"at {waves} waves, Re σ > {floor:.0e}"),
            ]
        cases.append(Case("stable intervals", "1", str(len(cases) // 2), 0.0))
        return Row(
            f"some flows are stable at tan θ = {tan:.2f}, on the mid branch",
            "3.3, figure 8",
            "stable, mid branch",
            "; ".join(told),
            tuple(cases),
            figures=() if quick else (COLUMNS,),
        )

    return row


def steep(quick: bool) -> Row:
    """Where long waves decay at 0.33 and beyond, something else grows."""
    cases, told = [], []
    for tan in (0.33,) if quick else STEEP:
        inside = [sample(0.33, 0.8)] if quick else [s for s in curve(tan) if s.grows is False]
        proved = []
        for s in inside:
            flow = steady(tan, s.far_temperature)
            hit = growing(flow, [wave(kh / s.height, t) for kh in (1.0, 0.3, 0.1, 3.0, 0.03, 0.01) for t in DIRECTIONS[:-4:-1]])
            if hit is not None:
                proved.append(hit)
        cases.append(Case(f"tan θ = {tan}: flows whose long waves decay and something else grows", f"{len(inside)}", f"{len(proved)}", 0.0))
        if proved:
            slowest = min(proved, key=lambda hit: complex(hit[1].sigma).real)
            told.append(f"tan θ = {tan}: {len(inside)}, the slowest growth {complex(slowest[1].sigma):.3g}")
    if not quick:
        draw()
    return Row(
        "all steady flows are unstable again for tan θ ≥ 0.33, abruptly",
        "3.3, figure 8",
        "unstable",
        f"unstable, and not to long waves alone: flows whose long waves decay have a growing wave across or nearly across the slope: "
        f"{'; '.join(told)}",
        tuple(cases),
        figures=() if quick else ("edges.png", COLUMNS),
    )


def draw() -> None:
    """The map over slope and T_∞: where long waves grow along the slope, across it, or not."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(7.2, 4.8), layout="constrained")
    panel = figure.subplots()
    kinds = {
        "long waves grow along the slope only": ("#D55E00", "s"),
        "across it only": ("#CC79A7", "D"),
        "both": ("#E69F00", "o"),
        "neither": ("#0072B2", "o"),
        "not known": ("0.7", "x"),
    }
    for (label, (colour, marker)), points in zip(kinds.items(), _sorted_by_kind(), strict=True):
        panel.plot(*np.array(points).reshape(-1, 2).T, marker, color=colour, markersize=4, label=label)
    for tan in WINDOW:
        for w in windows(curve(tan)):
            panel.plot([tan, tan], [w.low, w.high], "-", color="#0072B2", linewidth=7, alpha=0.3)
    panel.set_yscale("log")
    panel.set_xlabel(r"slope tanθ")
    panel.set_ylabel(r"far temperature $T_\infty$ / (d g cosθ)")
    panel.set_title("Long waves on the flows of figure 8, e = $e_w$ = 0.8, r = 0.6", fontsize="medium")
    figure.legend(loc="outside lower center", ncols=3, fontsize="small", frameon=False)
    figure.savefig(FIGURES / "edges.png", dpi=160)


def _sorted_by_kind() -> Iterator[list[tuple[float, float]]]:
    samples = [s for tan in SLOPES for s in curve(tan)]

    def where(holds: Callable[[FlowSample], bool]) -> list[tuple[float, float]]:
        return [(s.tan_theta, s.far_temperature) for s in samples if holds(s)]

    yield where(lambda s: s.grows is True and s.d_y < 0)
    yield where(lambda s: s.grows is True and s.d_x < 0)
    yield where(lambda s: s.grows is True and s.d_x > 0 and s.d_y > 0)
    yield where(lambda s: s.grows is False)
    yield where(lambda s: s.grows is None)


REPRODUCTION = Reproduction(
    "edges",
    "Figure 8: the edges of stability, over all wavenumbers",
    (
        Item("long waves", asymptotics),
        *(Item(f"tan θ = {tan:.2f}", window(tan), in_quick=tan == 0.30) for tan in WINDOW),
        Item("steep slopes", steep),
    ),
)
