"""Figures 4 to 6 and what section 3.2 says of them: eigenfunctions, fields over two wavelengths, mass flux, vortices and slip.

The phase of the wave is θ = k_x x + k_y y, and a field is Re(f̂ e^{iθ}); the largest value of all unknowns is 1. A mode is vortex-forming or
clustering by the rule of models/chute/mode_shape.py: whether its mass flux turns around a point where all but 1e-3 of the mass lies.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from functools import cache

import numpy as np
from claims import Case, number
from scenes import GUESS, problem

import shootstab as st
from paper.figure3 import maximum
from paper.pictures import BLUE, ORANGE, panels, save
from paper.rows import Item, Reproduction, Row, if_all_hold, write_csv
from shootstab.analyses.eigenfunction_double import Eigenfunction
from shootstab.models.chute import chute_collocation
from shootstab.models.chute.mode_shape import CLUSTERING, VORTEX_FORMING
from shootstab.spectral import chebyshev

NAMES = ("high", "mid", "low")
KIND = {"high": CLUSTERING, "mid": VORTEX_FORMING, "low": CLUSTERING}  # published: section 3.2
FIELDS = {"nu": "ν̂", "u": "û", "v": "v̂", "w": "ŵ", "T": "T̂"}
DRAWN = {"high": 60.0, "mid": 40.0, "low": 15.0}  # chosen: heights up to which modes are drawn: the wave is still seen there, ν̂ is not
PLAIN = {"nu": "ν", "u": "u", "v": "v", "w": "w", "T": "T"}
HEIGHTS, PHASES = 241, 97  # chosen: points of a picture
ARROWS = (14, 20)  # chosen: arrows upwards and along, of figure 6
NOTHING = 1e-9  # chosen: part of the largest value that is rounding
ROOM = {"decay": 0.4, "wave": 0.1}  # chosen: parts of 1/T_∞ and of K within which the decay rates lie at the height where they are taken
# derived: the paper calls three wavelengths 'around 500 diameters', and the longest, 2π/0.0100, 'of the order of 600'
AROUND_500 = 2 * math.pi / 0.0100 / 500.0 - 1.0
TRUNCATION = 100  # chosen: M of the second look
SMALL_SLIP = 0.1  # chosen: a slip, as part of the largest |v̂|, that is not seen
# chosen: waves at which something grows, along k_y for high, in every direction for low
HIGH_WAVES = tuple((0.0, ky) for ky in (0.001, 0.002, 0.004, 0.007, 0.014, 0.018, 0.021))
LOW_WAVES = ((0.003, 0.0), (0.02, 0.0), (0.03, 0.0), (0.0, 0.005), (0.0, 0.02), (0.01, 0.01))  # chosen


@cache
def shape(name: str) -> Eigenfunction:
    """The most unstable mode of a flow."""
    p = problem(name)
    return st.eigenfunction(p, st.refine(p, guess=GUESS[name], rtol=1e-10), rtol=1e-8)


def heights(name: str) -> np.ndarray:
    """Heights of the pictures of a flow, (HEIGHTS,)."""
    return np.linspace(0.0, DRAWN[name], HEIGHTS)


def figure_4(quick: bool) -> Row:
    """The eigenfunctions: where ν̂ lies, how all decay, and the phases."""
    cases: list[Case] = []
    for name in NAMES:
        z, found, flow = heights(name), shape(name), problem(name).flow
        k, rate = math.hypot(problem(name).kx, problem(name).ky), 1 / flow.far_temperature
        at = found(z)
        peak = z[np.abs(at["nu"]).argmax()]
        cases.append(Case(f"{name}: ν̂ largest at the base, below 5 d", "yes", "yes" if peak < 5.0 else f"at {peak:.3g}", 0.0))
        far = found(np.array([10 + 8 / rate, 11 + 8 / rate]))
        decay = {field: -math.log(abs(far[field][1] / far[field][0])) for field in ("nu", "T")}
        cases.append(Case(f"{name}: decay rate of ν̂ against 1/T∞", rate, decay["nu"], ROOM["decay"]))
        cases.append(Case(f"{name}: decay rate of T̂ against K", k, decay["T"], ROOM["wave"]))
    largest = np.abs(shape("low")(heights("low"))["v"]).max()
    cases.append(Case("low: no cross-slope velocity", "yes", "yes" if largest < NOTHING else f"{largest:.1e}", 0.0))
    for name in ("high", "mid"):
        at = shape(name)(heights(name))
        out = max(np.abs(at["v"].real).max(), *(np.abs(at[f].imag).max() for f in ("nu", "u", "w", "T")))
        cases.append(Case(f"{name}: v̂ out of phase by π/2 with all others", "yes", "yes" if out < NOTHING else f"{out:.1e}", 0.0))
    files = () if quick else (*(drawn_4(name) for name in NAMES), *(data(name) for name in NAMES))
    return Row(
        "figure 4: ν̂ lies at the base and decays as the flow does, the others as the wave; v̂ is out of phase, and zero for low",
        "3.2, figure 4",
        "localized at the base boundary, exponential decay; the remaining fields decay more slowly; no v̂ for low",
        if_all_hold(cases, "the same, for all three"),
        tuple(cases),
        figures=files,
    )


def drawn_4(name: str) -> str:
    """One row of figure 4: z upwards, real parts solid, imaginary parts dashed."""
    z, at = heights(name), shape(name)(heights(name))
    figure, axes = panels(1, 5, (10.0, 3.6), sharey=True)
    for panel, (field, label) in zip(axes[0], FIELDS.items(), strict=True):
        panel.plot(at[field].real, z, color=BLUE, label="real part")
        panel.plot(at[field].imag, z, "--", color=ORANGE, label="imaginary part")
        panel.set_xlabel(label)
        panel.locator_params(axis="x", nbins=2)
    axes[0, 0].set_ylabel("z / d")
    axes[0, 4].legend(frameon=False, fontsize="x-small")
    figure.suptitle(f"Figure 4, {name}: σ = {number(complex(shape(name).mode.sigma))}", fontsize="medium")
    return save(figure, f"figure4-{name}.png")


def data(name: str) -> str:
    """Eigenfunctions and mass flux of one flow, by height."""
    z = heights(name)
    columns: dict[str, Sequence[float]] = {"z": z}
    for field, values in {**shape(name)(z), **shape(name).fields(z)}.items():
        columns |= {f"re_{field}": values.real, f"im_{field}": values.imag}
    return write_csv(f"figure456-{name}.csv", columns)


def along(name: str) -> tuple[np.ndarray, str, float]:
    """The phase over two wavelengths, the axis, and the wavelength."""
    p = problem(name)
    axis, k = ("x", p.kx) if p.kx else ("y", p.ky)
    return np.linspace(0.0, 4 * math.pi, PHASES), axis, 2 * math.pi / k


def figure_5(quick: bool) -> Row:
    """The fields over two wavelengths: what is largest where it is dilute, what stands and what moves, and the wavelengths."""
    cases: list[Case] = []
    lengths = {name: 2 * math.pi / maximum(name)[0] for name in NAMES}
    for name in ("high", "mid"):
        at = shape(name)(heights(name))
        dilute = -np.sign(at["nu"].real[np.abs(at["nu"]).argmax()])
        for field in ("T", "u", "w"):
            sign = np.sign(at[field].real[np.abs(at[field]).argmax()])
            cases.append(Case(f"{name}: {FIELDS[field]} largest where it is dilute", "yes", "yes" if sign == dilute else "no", 0.0))
        cases.append(Case(f"{name}: Im σ", "0", f"{complex(shape(name).mode.sigma).imag:g}", 0.0))
    drift = complex(shape("low").mode.sigma).imag
    cases.append(Case("low: propagates", "yes", "yes" if drift else "no", 0.0, f"phase speed {-drift / problem('low').kx:.4g}"))
    cases += [Case(f"{name}: wavelength", 500.0, length, AROUND_500) for name, length in lengths.items()]
    files = () if quick else tuple(drawn_5(name) for name in NAMES)
    said = "wavelengths " + ", ".join(f"{length:.0f}" for length in lengths.values()) + " of the fastest-growing waves"
    return Row(
        "figure 5: high and mid stand, with temperature, û and ŵ largest where it is dilute; low moves; wavelengths",
        "3.2, figure 5",
        "stationary; largest in locally dilute regions; around 500 particle diameters",
        said,
        tuple(cases),
        figures=files,
    )


def against_the_flow(quick: bool) -> Row:
    """The phase speed of the low mode between 0 and the slowest grains, which are those at the base."""
    speed = -complex(shape("low").mode.sigma).imag / problem("low").kx
    flow = problem("low").flow
    base, slowest = flow.base["u"], float(flow.states[:, 2].real.min())
    cases = (
        Case(
            "slower than every grain: it moves up through them", "yes", "yes" if speed < slowest else "no", 0.0, f"slowest u0 {slowest:.4g}"
        ),
        Case("moves down the slope all the same", "", "yes" if speed > 0 else "no", None),
    )
    said = f"phase speed {speed:.4g} down the slope, grains {base:.4g} at the base to {flow.far_velocity:.4g} far up"
    return Row("the downslope clustering mode of low propagates against the steady flow", "5", "against the steady flow", said, cases)


def drawn_5(name: str) -> str:
    """One flow: the five fields, white the most positive value."""
    theta, axis, length = along(name)
    z, at = heights(name), shape(name)(heights(name))
    figure, axes = panels(5, 1, (7.0, 8.4), sharex=True)
    for panel, (field, label) in zip(axes[:, 0], PLAIN.items(), strict=True):
        values = (at[field][:, None] * np.exp(1j * theta)).real
        if np.abs(values).max() < NOTHING:
            panel.text(0.5, 0.5, f"{label}₁ = 0", transform=panel.transAxes, ha="center", va="center")
            panel.set(ylim=(z[0], z[-1]), ylabel="z / d")
            continue
        held = panel.contourf(theta * length / (2 * math.pi), z, values, levels=16, cmap="gray")
        figure.colorbar(held, ax=panel, label=f"{label}₁", format="%.2g")
        panel.set_ylabel("z / d")
    axes[-1, 0].set_xlabel(f"{axis} / d")
    figure.suptitle(f"Figure 5, {name}: fields over two wavelengths", fontsize="medium")
    return save(figure, f"figure5-{name}.png")


def figure_6(quick: bool) -> Row:
    """Vortex-forming or clustering, by the rule."""
    kinds = {name: shape(name).kind for name in NAMES}
    return Row(
        "figure 6: the kinds of the three modes",
        "3.2, figure 6",
        ", ".join(f"{name} {kind}" for name, kind in KIND.items()),
        ", ".join(f"{name} {kind}" for name, kind in kinds.items()),
        tuple(Case(f"{name}: kind by the rule", KIND[name], kinds[name], 0.0) for name in NAMES),
        figures=() if quick else tuple(drawn_6(name) for name in NAMES),
    )


def drawn_6(name: str) -> str:
    """One flow: ν1 shaded, dark where dense, and arrows of the mass flux in the plane of the wave."""
    theta, axis, length = along(name)
    found, top = shape(name), float(problem(name).mode_shape.heights[-1])
    z = np.linspace(0.0, top, HEIGHTS)
    figure, axes = panels(1, 1, (7.6, 4.0))
    panel = axes[0, 0]
    dense = (found(z)["nu"][:, None] * np.exp(1j * theta)).real
    held = panel.contourf(theta * length / (2 * math.pi), z, dense, levels=16, cmap="gray_r", alpha=0.75)
    figure.colorbar(held, ax=panel, label="ν₁, dark where dense", format="%.2g")
    up, across = ARROWS
    at, turn = np.linspace(0.02 * top, 0.98 * top, up), np.linspace(0.1, 4 * math.pi - 0.1, across)
    flux = found.fields(at)
    q, w = ((flux[f][:, None] * np.exp(1j * turn)).real for f in (f"Q{axis}", "Qz"))
    panel.quiver(turn * length / (2 * math.pi), at, q, w, color=BLUE, angles="uv", width=0.0025)
    panel.set_xlabel(f"{axis} / d")
    panel.set_ylabel("z / d")
    panel.set_title(f"Figure 6, {name}: mass flux ($Q_{axis}$, $Q_z$), {found.kind}", fontsize="medium")
    return save(figure, f"figure6-{name}.png")


def slip(quick: bool) -> Row:
    """v̂ at the base against the largest |v̂|, with the sign that it has there."""
    found = {}
    for name in ("high", "mid"):
        v = shape(name)(heights(name))["v"]
        found[name] = float((v[0] / v[np.abs(v).argmax()]).real)
    cases = (
        Case("mid: v̂ at the base opposite to the largest v̂", "yes", "yes" if found["mid"] < 0 else "no", 0.0),
        Case("high: none such", "yes", "yes" if found["high"] > -SMALL_SLIP * abs(found["mid"]) else "no", 0.0),
        Case(f"high: |v̂| at the base below {SMALL_SLIP:g} of the largest", "yes", "yes" if abs(found["high"]) < SMALL_SLIP else "no", 0.0),
    )
    return Row(
        "a small cross-slope slip at the base of mid, which high has not, and of which the paper says that the vortices form",
        "3.2",
        "small slip for mid, not present for high",
        f"v̂ at the base over the largest v̂: mid {found['mid']:.3f}, high {found['high']:.3f}",
        cases,
        note=if_all_hold(cases, "what tells the two apart is the sign"),
    )


def kinds_along(name: str, waves: Sequence[tuple[float, float]]) -> dict[tuple[float, float], tuple[complex, str]]:
    """The dominant mode of a flow at each wave where something grows, and its kind."""
    out = {}
    for kx, ky in waves:
        swept = st.sweep(problem(name), {"kx": kx, "ky": ky}, digits=6, every=1)
        ((_, outcome),) = swept.rows()
        if outcome.sigma is not None:
            p = st.chute.problem(problem(name).flow, kx, ky)
            out[kx, ky] = (outcome.sigma, st.eigenfunction(p, outcome.sigma, rtol=1e-7).kind)
    return out


def by_collocation(name: str, kx: float, ky: float, sigma: complex) -> tuple[str, tuple[float, ...]]:
    """The kind of a mode and the heights of its vortices from the vector of the pseudospectral reference: no eigenfunction is shot."""
    from scipy.interpolate import CubicSpline

    flow, p = problem(name).flow, st.chute.problem(problem(name).flow, kx, ky)
    z = chebyshev.malik(TRUNCATION, *chute_collocation.window(flow, kx, ky)).z
    n, u, v, w, T = chute_collocation.refine(flow, kx, ky, sigma, TRUNCATION).vector.reshape(5, -1)
    nodal = {"nu": n * np.exp(flow.states_at(z)[:, 0].real), "u": u, "v": chute_collocation.PHASE * v, "w": w, "T": T}
    at = p.mode_shape.heights
    unknowns = {field: CubicSpline(z, values)(at) for field, values in nodal.items()}
    return p.mode_shape.kind(at, unknowns), p.mode_shape.vortices(at, unknowns)


def other_waves(quick: bool) -> Row:
    """The rule at other wavenumbers: vortices for high, none for low."""
    high, low = kinds_along("high", HIGH_WAVES), kinds_along("low", LOW_WAVES)
    turning = [wave for wave, (_, kind) in high.items() if kind == VORTEX_FORMING]
    turning_low = [wave for wave, (_, kind) in low.items() if kind == VORTEX_FORMING]
    cases = (
        Case("high: vortex-forming at some other wavenumber", "yes", "yes" if turning else "no", 0.0),
        Case("low: vortex-forming at none", "none", ", ".join(map(str, turning_low)) or "none", 0.0),
        *(Case(f"high ({kx:g}, {ky:g})", "", f"σ = {sigma:.4g}: {kind}", None) for (kx, ky), (sigma, kind) in high.items()),
        *(Case(f"low ({kx:g}, {ky:g})", "", f"σ = {sigma:.4g}: {kind}", None) for (kx, ky), (sigma, kind) in low.items()),
    )
    again = [by_collocation("low", *wave, low[wave][0]) for wave in turning_low]
    cases += tuple(
        Case(f"low {wave}, by collocation", "", f"{kind}, at z = {', '.join(f'{z:.3g}' for z in places)}", None)
        for wave, (kind, places) in zip(turning_low, again, strict=True)
    )
    said = f"high: {len(turning)} of {len(high)} growing modes, at {', '.join(f'({a:g}, {b:g})' for a, b in turning) or 'none'}"
    said += f"; low: {len(turning_low)} of {len(low)}, at {', '.join(f'({a:g}, {b:g})' for a, b in turning_low) or 'none'}"
    return Row(
        "vortex-forming modes at other wavenumbers: of high there are, of low none have been found",
        "3.2",
        "it is possible to obtain vortex-forming modes for the high flow; none found for the low flow",
        said,
        cases,
        note="; ".join(f"{kind} by collocation too, at z = {', '.join(f'{z:.3g}' for z in places)}" for kind, places in again),
    )


REPRODUCTION = Reproduction(
    "figures456",
    "Eigenfunctions, fields and mass flux of the most unstable modes",
    (
        Item("figure 4", figure_4),
        Item("figure 5", figure_5),
        Item("against the flow", against_the_flow),
        Item("figure 6", figure_6),
        Item("slip", slip),
        Item("other wavenumbers", other_waves, in_quick=False),
    ),
)
