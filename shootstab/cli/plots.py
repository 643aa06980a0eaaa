"""The complex σ-plane: claimed eigenvalues by verdict, modes, and the continuous spectrum.

A claimed spectrum reaches over decades while the modes that matter sit beside the end of the continuous spectrum. So there are two
panels: one holds everything, on axes that are linear where the other one looks and logarithmic beyond; the other one magnifies
the end of the continuous spectrum and the nearest modes.
"""

from __future__ import annotations

import importlib.util
import math
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from shootstab.core.errors import InputError
from shootstab.core.records import CONFIRMED, CONTINUUM, INACCURATE, SPURIOUS, UNRESOLVED, Report
from shootstab.io.files import write_whole
from shootstab.problems.capabilities import INTERIOR

if TYPE_CHECKING:
    from shootstab.io.scenes import Scene

# marker, colour (Okabe and Ito's, told apart by the colour-blind), size
MARKS = {
    CONFIRMED: ("o", "#009E73", 7),
    INACCURATE: ("^", "#E69F00", 7),
    SPURIOUS: ("x", "#D55E00", 6),
    CONTINUUM: ("+", "#0072B2", 7),
    UNRESOLVED: ("D", "#CC79A7", 5),
}
CONTINUUM_POINTS = 2000  # chosen: points of a line of the continuous spectrum, finer than a pixel
LEAST_MAGNIFIED = 2  # chosen: so many modes at least are to be seen in the magnified panel
BALLOON = 10.0  # chosen: the balloon is shown up to this many times the distance of the nearest mode
SECOND_PANEL = 5.0  # chosen: claims that reach this many times further than the magnified part are worth a second panel

Points = NDArray[np.complex128]
Box = tuple[complex, float, float]  # centre, half of the width, half of the height


def require(path: Path) -> None:
    """Raise InputError if no picture can be drawn here."""
    if importlib.util.find_spec("matplotlib") is None:
        raise InputError(f"{path}: a plot needs matplotlib: install it with `pip install 'shootstab[plot]'`")


def save(report: Report, scene: Scene, path: Path) -> None:
    """Draw the report into a png, pdf or svg file, told by its suffix."""
    figure = draw(report, scene)
    write_whole(path, lambda file: figure.savefig(file, dpi=160))


def draw(report: Report, scene: Scene) -> Any:
    """The picture, as a matplotlib Figure."""
    from matplotlib.figure import Figure

    curve = INTERIOR.of(scene.problem)
    line = None if curve is None else curve(curve.heights(CONTINUUM_POINTS).astype(np.complex128))
    modes = np.array([complex(v.sigma) for v in report.verdicts if v.sigma is not None], dtype=np.complex128)
    missing = np.array([complex(m.sigma) for m in report.missing], dtype=np.complex128)
    near = _magnified(line, np.concatenate([modes, missing]), report)
    everything = np.concatenate([_claims(report), modes, missing])
    two = _spreads(everything, near)
    if not two:
        centre, width, height = near
        corners = [centre + complex(a * width, b * height) / 1.2 for a, b in ((-1, -1), (1, 1))]
        near = _around(np.concatenate([everything, corners]), 0.0)

    figure = Figure(figsize=(11, 5.2) if two else (6.4, 5.4), layout="constrained")
    panels = figure.subplots(1, 2 if two else 1, squeeze=False)[0]
    for panel in panels:
        _fill(panel, report, line, modes, missing)
        panel.set_xlabel(_label("Re", scene.unit))
        panel.set_ylabel(_label("Im", scene.unit))
        panel.grid(True, linewidth=0.4, alpha=0.4)
        panel.axvline(0.0, color="0.6", linewidth=0.8, zorder=0)
    _look_at(panels[-1], near)
    if two:
        panels[0].set_title("all", fontsize="medium")
        panels[1].set_title("magnified", fontsize="medium")
        _decades(panels[0], everything, near)
    figure.suptitle(f"{scene.name}: {_counts(report)}\n{scene.description}", fontsize="medium")
    figure.legend(
        *panels[0].get_legend_handles_labels(), loc="outside lower center", ncols=6 if two else 4, frameon=False, fontsize="small"
    )
    return figure


def _fill(panel: Any, report: Report, line: Points | None, modes: Points, missing: Points) -> None:
    if line is not None:
        panel.plot(line.real, line.imag, "-", color="0.25", linewidth=1.6, zorder=1, label="continuous spectrum")
    for verdict, (marker, colour, size) in MARKS.items():
        chosen = _claims(report, verdict)
        if chosen.size:
            style = {"color": colour, "markersize": size, "markeredgewidth": 1.4, "zorder": 3}
            panel.plot(chosen.real, chosen.imag, marker, label=f"{verdict} ({chosen.size})", **style)
    if modes.size:
        ring = {"markerfacecolor": "none", "markeredgecolor": "black", "markersize": 11, "zorder": 4}
        panel.plot(modes.real, modes.imag, "o", label="mode", **ring)
    if missing.size:
        star = {"color": "#F0E442", "markeredgecolor": "black", "markersize": 13, "zorder": 5}
        panel.plot(missing.real, missing.imag, "*", label=f"missing mode ({missing.size})", **star)


def _magnified(line: Points | None, modes: Points, report: Report) -> Box:
    """The box around the rightmost end of the continuous spectrum and the modes nearest to it, or else around all modes.

    The balloon of claims that the continuous spectrum blurs belongs into it, unless it is so large that the mode would vanish in it.
    """
    claims = _claims(report)
    shown = modes if modes.size else claims
    if line is not None:
        tip = complex(line[np.argmax(line.real)])
    elif shown.size:
        tip = complex(shown[np.argmax(shown.real)])
    else:
        return 0j, 1.0, 1.0
    distances = np.sort(np.abs(shown - tip))
    distances = distances[distances > 0.0]
    balloon = np.abs(_claims(report, CONTINUUM) - tip)
    radius = max(distances[:LEAST_MAGNIFIED], default=0.0)
    if distances.size and balloon.size:
        radius = max(radius, min(balloon.max(), BALLOON * distances[0]))
    radius = float(radius) or 0.1 * abs(tip) or 1.0
    near = np.concatenate([[tip], shown, claims])
    return _around(near[np.abs(near - tip) <= radius * (1 + 1e-9)], 0.4 * radius)


def _around(points: Points, least: float) -> Box:
    """A box that holds the points with room to spare, and is not flat."""
    low, high = complex(points.real.min(), points.imag.min()), complex(points.real.max(), points.imag.max())
    width, height = (max(0.6 * extent, least) for extent in ((high - low).real, (high - low).imag))
    return (low + high) / 2, width, height


def _claims(report: Report, *verdicts: str) -> Points:
    """The claimed eigenvalues with these verdicts; without any, all."""
    return np.array([v.claimed for v in report.verdicts if v.verdict in (verdicts or MARKS)], dtype=np.complex128)


def _spreads(points: Points, near: Box) -> bool:
    """Whether the points reach so far beyond the box that it would be small among them."""
    if not points.size:
        return False
    centre, width, height = near
    off = np.abs(points.real - centre.real) / width, np.abs(points.imag - centre.imag) / height
    return bool((np.maximum(*off) > SECOND_PANEL).any())


def _look_at(panel: Any, near: Box) -> None:
    centre, width, height = near
    panel.set_xlim(centre.real - width, centre.real + width)
    panel.set_ylim(centre.imag - height, centre.imag + height)
    panel.ticklabel_format(style="sci", scilimits=(-2, 3), useOffset=False)


def _decades(panel: Any, points: Points, near: Box) -> None:
    """Axes that are linear in the magnified square, which is framed, and logarithmic beyond."""
    from matplotlib.patches import Rectangle
    from matplotlib.ticker import FixedLocator, MaxNLocator

    centre, width, height = near
    for axis, scale, limits, values, middle, half in (
        (panel.xaxis, panel.set_xscale, panel.set_xlim, points.real, centre.real, width),
        (panel.yaxis, panel.set_yscale, panel.set_ylim, points.imag, centre.imag, height),
    ):
        linear = 10.0 ** math.ceil(math.log10(abs(middle) + half))
        scale("symlog", linthresh=linear, linscale=1.0)
        low, high = min(values.min(), middle - half), max(values.max(), middle + half)
        low, high = _beyond(low, linear), _beyond(high, linear, upwards=True)
        limits(low, high)
        if max(-low, high) > 2 * linear:
            axis.set_major_locator(FixedLocator(_powers(low, high, linear)))
        else:
            axis.set_major_locator(MaxNLocator(5))
    corner = (centre.real - width, centre.imag - height)
    panel.add_patch(Rectangle(corner, 2 * width, 2 * height, fill=False, edgecolor="0.4", linestyle="--", linewidth=0.9, zorder=2))


def _powers(low: float, high: float, linear: float) -> list[float]:
    """0 and the powers of ten beyond the linear part, at most four on each side."""
    first = round(math.log10(linear))
    ticks = [0.0]
    for sign, limit in ((-1.0, -low), (1.0, high)):
        last = math.floor(math.log10(limit)) if limit > linear else first - 1
        step = max(1, math.ceil((last - first + 1) / 4))
        ticks += [sign * 10.0**k for k in range(first, last + 1, step)]
    return sorted(ticks)


def _beyond(limit: float, linear: float, upwards: bool = False) -> float:
    """A little further out than the limit, on a symlog axis."""
    outwards = (limit > 0) == upwards
    if abs(limit) < linear:
        return limit + (0.2 if upwards else -0.2) * linear
    return limit * (1.6 if outwards else 1 / 1.6)


def _label(part: str, unit: str) -> str:
    return f"{part} σ / {unit}" if unit else f"{part} σ"


def _counts(report: Report) -> str:
    named = ", ".join(f"{n} {what}" for what, n in report.summary.items() if n)
    return named or "no eigenvalues"
