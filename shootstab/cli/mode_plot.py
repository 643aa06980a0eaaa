"""Eigenfunctions as figure 4 of the paper has them: z upwards, a panel for every unknown, real parts solid and imaginary ones dashed."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from shootstab.cli.figures import Size, columns
from shootstab.core.allowed import MODE_HEIGHTS

if TYPE_CHECKING:
    from shootstab.analyses.eigenfunction_double import Eigenfunction
    from shootstab.analyses.eigenspace import Eigenspace
    from shootstab.core.records import Mode
    from shootstab.io.scenes import Scene

REAL_PART, IMAGINARY_PART = "#0072B2", "#D55E00"  # Okabe and Ito's, told apart by the colour-blind
BELOW_ROUNDING = 1e-12  # chosen: an unknown below this part of the largest value of all is shown as zero: that is rounding
PANEL_WIDTH, PANEL_HEIGHT, PANEL_MARGIN = 2.0, 4.2, 0.9  # chosen: inches of a panel, and of what is beside all of them
ROW_HEIGHT = 0.6  # chosen: what a second row of panels adds, in the height of a single one
GREEK = {"nu": r"\nu", "theta": r"\theta", "phi": r"\phi", "psi": r"\psi", "eta": r"\eta", "omega": r"\omega"}
VARIATION_LEFT = 0.05  # chosen: the part of an unknown's variation that may lie on either side of a layer
SMALL_PART = 0.05  # chosen: a layer thinner than this part of the heights is not seen among them
TICKS = 3  # chosen: numbers on the axis of a narrow panel


def draw(found: Eigenfunction, scene: Scene, low: float | None = None, high: float | None = None, inches: Size | None = None) -> Any:
    """The picture, as a matplotlib Figure, over the extent of the eigenfunction or between low and high.

    Where an unknown does what it does in a small part of that, a second row magnifies the part. A narrow picture breaks the rows.
    """
    from matplotlib.figure import Figure

    extent = found.extent
    z = np.linspace(extent[0] if low is None else low, extent[1] if high is None else high, MODE_HEIGHTS)
    values: Mapping[str, Any] = found(z)
    small = layer(z, values)
    heights = [z] if small is None else [z, np.linspace(*small, MODE_HEIGHTS)]
    size = inches or (PANEL_MARGIN + PANEL_WIDTH * max(len(values), 2), PANEL_HEIGHT * (1.0 - ROW_HEIGHT + ROW_HEIGHT * len(heights)))
    across = columns(len(values), size[0])
    lines = math.ceil(len(values) / across)
    figure = Figure(figsize=size, layout="constrained")
    rows = figure.subplots(lines * len(heights), across, sharey="row", squeeze=False).reshape(len(heights), -1)
    for panels, at in zip(rows, heights, strict=True):
        _fill(panels[: len(values)], at, found(at))
        for panel in panels[: len(values) : across]:
            panel.set_ylabel(f"${found.variable}$")
        for panel in panels[len(values) :]:
            panel.set_axis_off()
    panels = rows[0]
    where = f"{scene.symbol} = {_number(found.mode)}"
    figure.suptitle(f"{scene.name}: {where}{f', {found.kind}' if found.kind else ''}", fontsize="medium")
    figure.legend(*panels[0].get_legend_handles_labels(), loc="outside lower center", ncols=2, frameon=False, fontsize="small")
    return figure


def draw_several(found: Eigenspace, scene: Scene, z: NDArray[np.float64], inches: Size | None = None) -> Any:
    """All functions that belong to a multiple mode, a row for each, at heights z (m,)."""
    from matplotlib.figure import Figure

    rows = {f"{i}": f(z) for i, f in enumerate(found.basis, 1)} | {f"chain {j}": f(z) for j, f in enumerate(found.chain, 1)}
    across = len(found.basis[0].names)
    size = inches or (PANEL_MARGIN + PANEL_WIDTH * max(across, 2), PANEL_HEIGHT * ROW_HEIGHT * len(rows))
    figure = Figure(figsize=size, layout="constrained")
    panels = figure.subplots(len(rows), across, sharey="row", squeeze=False)
    errors = [*(f.error for f in found.basis), *(f.error for f in found.chain)]
    for line, (name, values), error in zip(panels, rows.items(), errors, strict=True):
        _fill(line, z, values, max(error, BELOW_ROUNDING))
        line[0].set_ylabel(f"{name}\n${found.basis[0].variable}$")
    figure.suptitle(f"{scene.name}: {scene.symbol} = {_number(found.mode)}\n{found.structure}", fontsize="medium")
    figure.legend(*panels[0][0].get_legend_handles_labels(), loc="outside lower center", ncols=2, frameon=False, fontsize="small")
    return figure


def _number(mode: Mode) -> str:
    """σ to six figures, without an imaginary part below its error."""
    sigma = complex(mode.sigma)
    imaginary = f" {'-' if sigma.imag < 0 else '+'} {abs(sigma.imag):.6g}i" if abs(sigma.imag) > mode.error else ""
    return f"{sigma.real:.6g}{imaginary}"


def layer(z: NDArray[np.float64], values: Mapping[str, Any]) -> tuple[float, float] | None:
    """Where some unknown does nearly all of its variation, if that is a small part of z (m,); with some of z around."""
    parts = []
    for f in values.values():
        varied = np.cumsum(np.abs(np.diff(f)))
        if varied[-1] > 0.0:
            low, high = np.searchsorted(varied / varied[-1], (VARIATION_LEFT, 1.0 - VARIATION_LEFT))
            parts.append((float(z[low]), float(z[high + 1])))
    if not parts:
        return None
    low, high = min(parts, key=lambda part: part[1] - part[0])
    if high - low > SMALL_PART * (z[-1] - z[0]):
        return None
    return max(float(z[0]), low - 0.5 * (high - low)), min(float(z[-1]), high + 0.5 * (high - low))


def _fill(panels: Any, z: NDArray[np.float64], values: Mapping[str, Any], nothing_below: float = BELOW_ROUNDING) -> None:
    """One panel for each unknown at heights z (m,); zero is shown below this part of the largest value of all."""
    from matplotlib.ticker import MaxNLocator

    largest = max(float(np.abs(f).max()) for f in values.values())
    for panel, (name, f) in zip(panels, values.items(), strict=True):
        nothing = np.abs(f).max() <= nothing_below * largest
        shown = 0.0 * f if nothing else f
        panel.axvline(0.0, color="0.7", linewidth=0.8, zorder=0)
        panel.plot(shown.real, z, "-", color=REAL_PART, linewidth=1.6, label="real part")
        panel.plot(shown.imag, z, "--", color=IMAGINARY_PART, linewidth=1.4, label="imaginary part")
        panel.set_xlabel(label(name))
        if nothing:
            panel.set_xlim(-1.0, 1.0)
            panel.set_xticks([0.0])
        else:
            panel.xaxis.set_major_locator(MaxNLocator(TICKS))
            panel.ticklabel_format(axis="x", style="sci", scilimits=(-2, 3), useMathText=True)
        panel.margins(y=0.0)


def label(name: str) -> str:
    """An unknown as mathematics, with a hat: it is a perturbation."""
    stem = name.rstrip("0123456789")
    index = name[len(stem) :]
    letter = GREEK.get(stem, stem if len(stem) == 1 else rf"\mathrm{{{stem}}}".replace("_", r"\_"))
    return rf"$\hat{{{letter}}}{f'_{{{index}}}' if index else ''}$"
