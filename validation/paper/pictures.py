"""What the pictures of the paper's figures have in common: colours, a figure of panels, and the file that is written whole."""

from __future__ import annotations

from typing import Any

from paper.rows import FIGURES

BLUE, ORANGE, GREEN, GREY = "#0072B2", "#D55E00", "#009E73", "0.55"
DOTS = 150  # chosen: dots per inch


def panels(rows: int, columns: int, size: tuple[float, float], **options: Any) -> tuple[Any, Any]:
    """A figure of this size in inches and its panels, an array (rows, columns)."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=size, layout="constrained")
    return figure, figure.subplots(rows, columns, squeeze=False, **options)


def save(figure: Any, name: str) -> str:
    """Write figures/NAME, and return the name."""
    FIGURES.mkdir(exist_ok=True)
    figure.savefig(FIGURES / name, dpi=DOTS)
    return name
