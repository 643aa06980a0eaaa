"""The complex plane of the eigenvalue, in one panel or two.

A spectrum reaches over decades while the modes that matter sit beside the end of the continuous spectrum. So there are two panels: one
holds everything, on axes that are linear where the other one looks and logarithmic beyond; the other one magnifies.
"""

from __future__ import annotations

import math
import textwrap
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from shootstab.cli.figures import Size, columns, entries
from shootstab.problems.capabilities import INTERIOR, UNSCALED, Continuum

if TYPE_CHECKING:
    from shootstab.io.scenes import Scene

CONTINUUM_POINTS = 2000  # chosen: points of a line of the continuous spectrum, finer than a pixel
SECOND_PANEL = 5.0  # chosen: what reaches this many times further than the magnified part is worth a second panel
LEAST_MAGNIFIED = 2  # chosen: the number of modes nearest to the tip that the magnified panel always shows
LINEAR_UP_TO = 2.0  # chosen: times the linear part, what reaches no further needs no decades
ROOM = 0.08  # chosen: the part of an axis that is left free at its ends
ONE_PANEL, TWO_PANELS = (6.4, 5.4), (11.0, 5.2)  # chosen: inches of the pictures
HALF_EXTENT = 0.6  # chosen: half the width and height of a box, in those of the points in it: a tenth is free on every side
LEAST_EXTENT = 0.4  # chosen: the same at least, in the radius that holds the points
LONE_RADIUS = 0.1  # chosen: that radius in |σ|, where there is one point only
HAIR_OF_RADIUS = 1e-9  # chosen: relative, so that rounding leaves none of them out
LINEAR_ROOM, DECADE_ROOM = 0.2, 1.6  # chosen: what is free beyond a limit: in the linear part, or as a factor
NARROWEST_PLANE = 3.4  # chosen: inches of one of two panels side by side
LETTERS_PER_INCH = 12  # chosen: letters of a title in a font of medium size
FEWEST_TICKS = 3  # chosen: numbers along an axis from which its scale is read
BALLOON = 10.0  # chosen: claims that the continuous spectrum blurs are shown up to this many times the distance of the nearest mode

Points = NDArray[np.complex128]
Box = tuple[complex, float, float]  # centre, half of the width, half of the height


@dataclass(frozen=True, eq=False)
class Group:
    """Points (m,) with one mark: a label for the legend, a format string of matplotlib's, and further settings of it."""

    label: str
    points: Points
    marker: str
    settings: Mapping[str, Any] = field(default_factory=dict)


def picture(scene: Scene, groups: Sequence[Group], near: Box, title: str, outline: Points | None = None, inches: Size | None = None) -> Any:
    """A matplotlib Figure with the continuous spectrum, the groups and, if there is one, the outline (m,) of a region.

    Two panels stand side by side, or one below the other where they would be too narrow.
    """
    from matplotlib.figure import Figure

    line = continuum(scene)
    everything = np.concatenate([np.empty(0, dtype=np.complex128), *(group.points for group in groups)])
    if outline is not None:
        everything = np.concatenate([everything, outline])
    two, near = in_view(everything, near)
    if not two:
        centre, width, height = near
        if line is not None and not ((np.abs(line.real - centre.real) < width) & (np.abs(line.imag - centre.imag) < height)).any():
            line = None  # out of sight, and nothing for a legend
    size = inches or (TWO_PANELS if two else ONE_PANEL)
    across = columns(1 + two, size[0], NARROWEST_PLANE)
    figure = Figure(figsize=size, layout="constrained")
    panels = figure.subplots((1 + two) // across, across, squeeze=False).ravel()
    for panel in panels:
        fill(panel, scene, groups, line, outline)
    look_at(panels[-1], near)
    if two:
        panels[0].set_title("all", fontsize="medium")
        panels[1].set_title("magnified", fontsize="medium")
        _decades(panels[0], everything, near, size[0] / across)
    lines = [textwrap.fill(part, round(LETTERS_PER_INCH * size[0])) for part in title.splitlines()]
    figure.suptitle("\n".join(lines), fontsize="medium")
    handles, labels = panels[0].get_legend_handles_labels()
    if labels:
        figure.legend(handles, labels, loc="outside lower center", ncols=entries(size[0], 6 if two else 4), frameon=False, fontsize="small")
    return figure


def in_view(points: Points, near: Box) -> tuple[bool, Box]:
    """Whether the points (m,) reach far beyond the box, which is then magnified beside all of them; else the box grows to hold them."""
    if _spreads(points, near):
        return True, near
    centre, width, height = near
    corners = [centre + complex(a * width, b * height) / (2 * HALF_EXTENT) for a, b in ((-1, -1), (1, 1))]
    return False, around(np.concatenate([points, corners]), 0.0)


def fill(panel: Any, scene: Scene, groups: Sequence[Group], line: Points | None, outline: Points | None = None) -> None:
    """Draw groups, a line (m,), an outline (k,) and that of no growth on matplotlib Axes, named by the scene's symbol and unit."""
    if line is not None:
        panel.plot(line.real, line.imag, "-", color="0.25", linewidth=1.6, zorder=1, label="continuous spectrum")
    if outline is not None:
        panel.plot(outline.real, outline.imag, ":", color="0.35", linewidth=1.2, zorder=1, label="region searched")
    for group in groups:
        if group.points.size:
            panel.plot(group.points.real, group.points.imag, group.marker, label=group.label, **group.settings)
    panel.set_xlabel(label("Re", scene))
    panel.set_ylabel(label("Im", scene))
    panel.grid(True, linewidth=0.4, alpha=0.4)
    neutral = {"color": "0.6", "linewidth": 0.8, "zorder": 0}
    if unit(scene).imag == 0.0:
        panel.axvline(0.0, **neutral)
    else:
        panel.axhline(0.0, **neutral)


def continuum(scene: Scene) -> Points | None:
    """The continuous spectrum inside as a line (m,), in the scene's eigenvalue; None if there is none."""
    curve: Continuum | None = INTERIOR.of(scene.problem)
    return None if curve is None else curve(curve.heights(CONTINUUM_POINTS).astype(np.complex128))


def unit(scene: Scene) -> complex:
    """σ over the scene's eigenvalue: σ = unit·v; it is real, or imaginary for frequencies and phase speeds."""
    unscaled = UNSCALED.of(scene.problem)
    return 1.0 + 0.0j if unscaled is None else complex(unscaled[1])


def growth(scene: Scene, points: Points) -> NDArray[np.float64]:
    """Re σ (m,) of points (m,), eigenvalues in the scene's convention."""
    return np.asarray((unit(scene) * points).real)


def magnified(scene: Scene, modes: Points, claims: Points, blurred: Points) -> Box:
    """The box around the end of the continuous spectrum that grows most and the modes nearest to it, or else around all modes.

    Growing modes belong into it, and the balloon of claims that the continuous spectrum blurs, unless it is so large that modes would
    vanish in it. modes, claims and those that are blurred are points (m,), (k,) and (l,).
    """
    line = continuum(scene)
    shown = modes if modes.size else claims
    if line is not None:
        tip = complex(line[np.argmax(growth(scene, line))])
    elif shown.size:
        tip = complex(shown[np.argmax(growth(scene, shown))])
    else:
        return 0j, 1.0, 1.0
    distances = np.sort(np.abs(shown - tip))
    distances = distances[distances > 0.0]
    balloon = np.abs(blurred - tip)
    radius = max(distances[:LEAST_MAGNIFIED], default=0.0)
    if distances.size and balloon.size:
        radius = max(radius, min(balloon.max(), BALLOON * distances[0]))
    growing = modes[growth(scene, modes) > 0.0]
    radius = max(radius, float(np.abs(growing - tip).max(initial=0.0)))
    radius = float(radius) or LONE_RADIUS * abs(tip) or 1.0
    near = np.concatenate([[tip], shown, claims])
    return around(near[np.abs(near - tip) <= radius * (1 + HAIR_OF_RADIUS)], LEAST_EXTENT * radius)


def around(points: Points, least: float) -> Box:
    """A box that holds the points (m,) with room to spare, and is not flat."""
    low, high = complex(points.real.min(), points.imag.min()), complex(points.real.max(), points.imag.max())
    width, height = (max(HALF_EXTENT * extent, least) for extent in ((high - low).real, (high - low).imag))
    return (low + high) / 2, width, height


def look_at(panel: Any, near: Box) -> None:
    """Show the box."""
    centre, width, height = near
    panel.set_xlim(centre.real - width, centre.real + width)
    panel.set_ylim(centre.imag - height, centre.imag + height)
    panel.ticklabel_format(style="sci", scilimits=(-2, 3), useOffset=False, useMathText=True)


def _spreads(points: Points, near: Box) -> bool:
    """Whether the points reach so far beyond the box that it would be small among them."""
    if not points.size:
        return False
    centre, width, height = near
    off = np.abs(points.real - centre.real) / width, np.abs(points.imag - centre.imag) / height
    return bool((np.maximum(*off) > SECOND_PANEL).any())


def _decades(panel: Any, points: Points, near: Box, width_of_panel: float) -> None:
    """Axes that are linear in the magnified square, which is framed, and logarithmic beyond."""
    from matplotlib.patches import Rectangle
    from matplotlib.ticker import FixedLocator, MaxNLocator

    centre, width, height = near
    for axis, scale, limits, values, middle, half in (
        (panel.xaxis, panel.set_xscale, panel.set_xlim, points.real, centre.real, width),
        (panel.yaxis, panel.set_yscale, panel.set_ylim, points.imag, centre.imag, height),
    ):
        linear = 10.0 ** math.ceil(math.log10(abs(middle) + half))
        low, high = min(values.min(), middle - half), max(values.max(), middle + half)
        if max(-low, high) > LINEAR_UP_TO * linear:
            scale("symlog", linthresh=linear, linscale=1.0)
            low, high = _beyond(low, linear), _beyond(high, linear, upwards=True)
            axis.set_major_locator(FixedLocator(_powers(low, high, linear, min(4, max(1, int(width_of_panel - 1.0))))))
        else:
            low, high = low - ROOM * (high - low), high + ROOM * (high - low)
            axis.set_major_locator(MaxNLocator(min(5, max(2, int(width_of_panel)))))
        limits(low, high)
    corner = (centre.real - width, centre.imag - height)
    panel.add_patch(Rectangle(corner, 2 * width, 2 * height, fill=False, edgecolor="0.4", linestyle="--", linewidth=0.9, zorder=2))


def _powers(low: float, high: float, linear: float, most: int) -> list[float]:
    """0 and the powers of ten beyond the linear part, at most so many on each side; halves of the linear part where these are too few."""
    first = round(math.log10(linear))
    ticks = [0.0]
    for sign, limit in ((-1.0, -low), (1.0, high)):
        last = math.floor(math.log10(limit)) if limit > linear else first - 1
        step = max(1, math.ceil((last - first + 1) / most))
        ticks += [sign * 10.0**k for k in range(first, last + 1, step)]
    if len(ticks) < FEWEST_TICKS:
        ticks += [tick for tick in (-0.5 * linear, 0.5 * linear) if low < tick < high]
    return sorted(ticks)


def _beyond(limit: float, linear: float, upwards: bool = False) -> float:
    """A little further out than the limit, on a symlog axis."""
    outwards = (limit > 0) == upwards
    if abs(limit) < linear:
        return limit + (LINEAR_ROOM if upwards else -LINEAR_ROOM) * linear
    return limit * (DECADE_ROOM if outwards else 1 / DECADE_ROOM)


def label(part: str, scene: Scene) -> str:
    """What an axis says: a part of the eigenvalue, in the scene's symbol and unit."""
    named = f"{part} {scene.symbol}"
    return f"{named} / {scene.unit}" if scene.unit else named
