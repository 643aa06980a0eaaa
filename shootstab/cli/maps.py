"""Growth rates over one parameter as curves, or over two as a map, with the points at which dominance was proved."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from shootstab.analyses.sweep.outcomes import NO_FLOW
from shootstab.cli import figures
from shootstab.cli.figures import PLAIN, Look
from shootstab.core.errors import InputError
from shootstab.core.records import UNRESOLVED
from shootstab.models.chute.registry import BY_NAME
from shootstab.problems.capabilities import BASE_FLOW

if TYPE_CHECKING:
    from shootstab.analyses.sweep import Swept
    from shootstab.analyses.sweep.grid import ParameterAxis
    from shootstab.io.scenes import Scene

MAP_LEVELS = 14  # chosen: contours of a map, at most
BLUE, ORANGE, GREY = "#0072B2", "#D55E00", "0.55"
MARKS_ON_A_MAP = 400  # chosen: proved points that are marked on a map; more would hide it
CURVES_SIZE, MAP_SIZE = (7.2, 6.4), (7.4, 5.6)  # chosen: inches of the pictures
NOTHING_GROWS = 1e-9  # chosen: the first contour, in the last one, below which nothing is drawn


def require(path: Path, axes: Mapping[str, Sequence[float]], look: Look = PLAIN) -> None:
    """Raise InputError if no picture can be drawn here, or none of so many parameters."""
    figures.require(path, look)
    varied = [name for name, values in axes.items() if len(values) > 1]
    if not 1 <= len(varied) <= 2:
        raise InputError(f"--plot: {len(varied)} parameters vary: allowed are 1 or 2")


def save(found: Swept, scene: Scene, path: Path, look: Look = PLAIN) -> None:
    """Draw the sweep into a png, pdf or svg file, told by its suffix."""
    figures.save(lambda: draw(found, scene), path, look)


def draw(found: Swept, scene: Scene) -> Any:
    """The picture, as a matplotlib Figure."""
    from matplotlib.figure import Figure

    varied = [axis for axis in found.axes if len(axis.values) > 1]
    one = len(varied) == 1
    figure = Figure(figsize=CURVES_SIZE if one else MAP_SIZE, layout="constrained")
    (_curves if one else _map)(figure, found, varied, scene)
    fixed = ", ".join(f"{a.name} = {a.values[0]:g}" for a in found.axes if len(a.values) == 1)
    figure.suptitle(f"{scene.name}{': ' + fixed if fixed else ''}\n{_sentence(found)}", fontsize="medium")
    return figure


def _sentence(found: Swept) -> str:
    if found.fastest is None:
        return "nothing grows"
    point, outcome = found.fastest
    where = ", ".join(f"{n} = {v:.5g}" for n, v in zip(found.grid.names, point, strict=True))
    assert outcome.sigma is not None
    sign = "-" if outcome.sigma.imag < 0 else "+"
    frequency = f" {sign} {abs(outcome.sigma.imag):.6g}i" if outcome.sigma.imag else ""
    return f"fastest growth: σ = {outcome.sigma.real:.6g}{frequency} at {where}"


def _label(axis: ParameterAxis, scene: Scene) -> str:
    """What the axis is called: a parameter of the chute by its symbol and unit, one of equations by the name that it has there."""
    return axis.name if BASE_FLOW.of(scene.problem) is None else BY_NAME[axis.name].label


def _unit(unit: str) -> str:
    return f" / {unit}" if unit else ""


def _curves(figure: Any, found: Swept, varied: Sequence[ParameterAxis], scene: Scene) -> None:
    """Re σ above, Im σ below; where nothing grows there is a line at zero, where nothing is known there is a gap."""
    (axis,) = varied
    x = np.array(axis.values)
    growth = found.growth.ravel()
    frequency = found.array(lambda o: None if o.sigma is None else o.sigma.imag).ravel()
    proved = found.array(lambda o: o.proved, dtype=np.bool_).ravel()
    unknown = found.array(lambda o: o.status.startswith((UNRESOLVED, NO_FLOW)), dtype=np.bool_).ravel()
    still = np.where(np.isnan(growth) & ~unknown, 0.0, np.nan)
    above, below = figure.subplots(2, 1, sharex=True, height_ratios=(2, 1))
    above.plot(x, growth, "-", color=BLUE, linewidth=1.6, label="dominant mode, followed")
    beyond = found.below.real.ravel()
    if np.isfinite(beyond).any():
        crossing = np.where(np.isnan(growth), beyond, growth)
        above.plot(x, crossing, "--", color=BLUE, linewidth=1.0, zorder=1, label="the same, one step below zero")
    above.plot(x[proved], growth[proved], "o", color=BLUE, markersize=5, label="dominance proved by a count")
    if np.isfinite(still).any():
        above.plot(x, still, "-", color=GREY, linewidth=1.6, label="no growing mode")
        above.plot(x[proved], still[proved], "s", color=GREY, markersize=4.5, label="the same, proved by a count")
    if unknown.any():
        above.plot(x[unknown], np.zeros(unknown.sum()), "x", color=ORANGE, markersize=6, label="no flow, or unresolved")
    below.plot(x, frequency, "-", color=BLUE, linewidth=1.6)
    above.set_ylabel(f"growth rate Re σ{_unit(scene.unit)}")
    below.set_ylabel(f"Im σ{_unit(scene.unit)}")
    below.set_xlabel(_label(axis, scene))
    for panel in (above, below):
        panel.grid(True, linewidth=0.4, alpha=0.4)
        panel.ticklabel_format(axis="y", style="sci", scilimits=(-2, 3), useMathText=True)
    above.legend(frameon=False, fontsize="small")


def continued(growth: NDArray[np.float64], below: NDArray[np.float64], unknown: NDArray[np.bool_]) -> NDArray[np.float64]:
    """Growth rates (m, n), and next to them what is below zero, so that the contour of 0, the neutral curve, lies between both.

    below (m, n) are growth rates of modes that were followed across the neutral curve. Where none arrived, it is what two growing
    neighbours in line lead to, 0 at most; the points of unknown (m, n) count as 0.
    """
    wide = np.pad(growth, 2, constant_values=np.nan)
    m, n = growth.shape
    beside = [[wide[2 + i * k : 2 + i * k + m, 2 + j * k : 2 + j * k + n] for k in (1, 2)] for i, j in ((1, 0), (-1, 0), (0, 1), (0, -1))]
    leads = np.array([2.0 * near - far for near, far in beside])
    known = np.isfinite(leads)
    mean = np.where(known, np.minimum(leads, 0.0), 0.0).sum(axis=0) / np.maximum(known.sum(axis=0), 1)
    filled = np.where(np.isfinite(growth), growth, np.where(unknown, 0.0, np.where(np.isfinite(below), below, mean)))
    return np.asarray(filled, dtype=np.float64)


def _map(figure: Any, found: Swept, varied: Sequence[ParameterAxis], scene: Scene) -> None:
    """Contours of Re σ; white where nothing grows, hatched where nothing is known. The last axis that varies is drawn upwards."""
    from matplotlib.ticker import MaxNLocator

    across, up = varied
    single = tuple(i for i, a in enumerate(found.axes) if len(a.values) == 1)
    unsettled = found.array(lambda o: o.status.startswith((UNRESOLVED, NO_FLOW)), dtype=np.bool_)
    growth, below, unknown = (np.squeeze(values, axis=single).T for values in (found.growth, found.below.real, unsettled))
    x, y = np.array(across.values), np.array(up.values)
    panel = figure.subplots()
    if np.isfinite(growth).any():
        filled = continued(growth, below, unknown)
        ticks = MaxNLocator(MAP_LEVELS).tick_values(0.0, float(np.nanmax(growth)))
        levels = np.concatenate(([NOTHING_GROWS * ticks[-1]], ticks[1:]))  # nothing is drawn where nothing grows
        drawn = panel.contourf(x, y, filled, levels=levels, cmap="viridis")
        panel.contour(x, y, filled, levels=levels[1:], colors="white", linewidths=0.5)
        figure.colorbar(drawn, ax=panel, label=f"growth rate Re σ{_unit(scene.unit)}", ticks=ticks[::2])
    if unknown.any():
        ys, xs = np.nonzero(unknown)
        panel.plot(x[xs], y[ys], "x", color=ORANGE, markersize=4, label="no flow, or unresolved")
    proved = np.array([p for p, o in found.rows() if o.proved])
    if 0 < len(proved) <= MARKS_ON_A_MAP:
        names = found.grid.names
        i, j = names.index(across.name), names.index(up.name)
        panel.plot(proved[:, i], proved[:, j], ".", color="black", markersize=2.5, label="modes counted", zorder=3)
    if found.fastest is not None:
        place = dict(zip(found.grid.names, found.fastest[0], strict=True))
        panel.plot(place[across.name], place[up.name], "*", color="white", markeredgecolor="black", markersize=12, clip_on=False, zorder=4)
    panel.set_xlabel(_label(across, scene))
    panel.set_ylabel(_label(up, scene))
    panel.ticklabel_format(style="sci", scilimits=(-2, 3), useMathText=True)
    if panel.get_legend_handles_labels()[0]:
        panel.legend(loc="upper right", frameon=True, framealpha=0.85, fontsize="small")
