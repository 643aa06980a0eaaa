"""Eigenfunctions as figure 4 of the paper has them: z upwards, a panel for every unknown, real parts solid and imaginary ones dashed."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from shootstab.analyses.eigenfunction_double import Eigenfunction
    from shootstab.io.scenes import Scene

REAL_PART, IMAGINARY_PART = "#0072B2", "#D55E00"  # Okabe and Ito's, told apart by the colour-blind
BELOW_ROUNDING = 1e-12  # chosen: an unknown below this part of the largest value of all is shown as zero: that is rounding
PANEL_WIDTH, PANEL_HEIGHT, PANEL_MARGIN = 2.0, 4.2, 0.9  # chosen: inches of a panel, and of what is beside all of them
GREEK = {"nu": r"\nu", "theta": r"\theta", "phi": r"\phi", "psi": r"\psi", "eta": r"\eta", "omega": r"\omega"}
TICKS = 3  # chosen: numbers on the axis of a narrow panel


def draw(found: Eigenfunction, scene: Scene, low: float | None = None, high: float | None = None) -> Any:
    """The picture, as a matplotlib Figure, over the extent of the eigenfunction or between low and high."""
    from matplotlib.figure import Figure
    from matplotlib.ticker import MaxNLocator

    from shootstab.analyses.eigenfunction_double import MODE_HEIGHTS

    extent = found.extent
    z = np.linspace(extent[0] if low is None else low, extent[1] if high is None else high, MODE_HEIGHTS)
    values: Mapping[str, Any] = found(z)
    largest = max(float(np.abs(f).max()) for f in values.values())
    figure = Figure(figsize=(PANEL_MARGIN + PANEL_WIDTH * max(len(values), 2), PANEL_HEIGHT), layout="constrained")
    panels = figure.subplots(1, len(values), sharey=True, squeeze=False)[0]
    for panel, (name, f) in zip(panels, values.items(), strict=True):
        shown = f if np.abs(f).max() > BELOW_ROUNDING * largest else 0.0 * f
        panel.axvline(0.0, color="0.7", linewidth=0.8, zorder=0)
        panel.plot(shown.real, z, "-", color=REAL_PART, linewidth=1.6, label="real part")
        panel.plot(shown.imag, z, "--", color=IMAGINARY_PART, linewidth=1.4, label="imaginary part")
        panel.set_xlabel(label(name))
        panel.xaxis.set_major_locator(MaxNLocator(TICKS))
        panel.ticklabel_format(axis="x", style="sci", scilimits=(-2, 3), useMathText=True)
        panel.margins(y=0.0)
    panels[0].set_ylabel("$z$")
    sigma = complex(found.mode.sigma)
    imaginary = f" {'-' if sigma.imag < 0 else '+'} {abs(sigma.imag):.6g}i" if sigma.imag else ""
    where = f"{scene.symbol} = {sigma.real:.6g}{imaginary}"
    figure.suptitle(f"{scene.name}: {where}{f', {found.kind}' if found.kind else ''}", fontsize="medium")
    figure.legend(*panels[0].get_legend_handles_labels(), loc="outside lower center", ncols=2, frameon=False, fontsize="small")
    return figure


def label(name: str) -> str:
    """An unknown as mathematics, with a hat: it is a perturbation."""
    stem = name.rstrip("0123456789")
    index = name[len(stem) :]
    letter = GREEK.get(stem, stem if len(stem) == 1 else rf"\mathrm{{{stem}}}".replace("_", r"\_"))
    return rf"$\hat{{{letter}}}{f'_{{{index}}}' if index else ''}$"
