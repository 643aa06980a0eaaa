"""cli/figures.py: pictures of any width, in which no name lies on another."""

from __future__ import annotations

import itertools
from typing import Any

import pytest

pytest.importorskip("matplotlib")

import shootstab as st
from shootstab.analyses.work_precision import Measurement, WorkPrecision
from shootstab.cli import figures, plots, steady_command, trade_command
from shootstab.core.records import SPURIOUS, Report, Verdict

WIDTHS = (3.4, 5.0, 8.0, 12.0)


def overlapping(figure: Any, size: figures.Size) -> list[tuple[str, str]]:
    """Pairs of texts below or beside the axes of a picture that lie on one another."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg

    figure.set_size_inches(*size)
    canvas = FigureCanvasAgg(figure)
    canvas.draw()
    texts = []
    for panel in figure.axes:
        for axis in (panel.xaxis, panel.yaxis):
            low, high = sorted(axis.get_view_interval())
            ticks = [t.label1 for t in axis.get_major_ticks() if low <= t.get_loc() <= high]
            texts += [t for t in [*ticks, axis.label] if t.get_visible() and t.get_text()]
    boxes = [(t.get_text(), t.get_window_extent(canvas.get_renderer())) for t in texts]
    return [(a, b) for (a, here), (b, there) in itertools.combinations(boxes, 2) if here.overlaps(there)]


@pytest.mark.parametrize("width", WIDTHS)
def test_a_flow_and_a_spectrum_of_any_width(width: float) -> None:
    size = (width, 5.0)
    scene = st.scene("mid")
    assert overlapping(steady_command.draw(scene.flow, scene, size), size) == []
    claims = [0.00102 + 0j, -0.3 + 0.1j, -40.0 - 3j, -0.02 - 0.01j]
    report = Report(tuple(Verdict(claim, SPURIOUS, "no zero near") for claim in claims), (), 6)
    assert overlapping(plots.draw(report, scene, size), size) == []


@pytest.mark.parametrize("width", WIDTHS)
def test_work_and_accuracy_of_any_width(width: float) -> None:
    size = (width, 5.0)
    made = tuple(
        Measurement(method, "rtol", 10.0**-k, 0.1 + 0j, 10.0**-k, 0.01 * k, k * 10**6, k)
        for method in ("frame", "compound", "qz")
        for k in range(1, 14)
    )
    figure = trade_command.draw(WorkPrecision(made, 0.1, 1e-30, 0.1), st.scene("poiseuille"), size)
    assert overlapping(figure, size) == []


def test_panels_stand_in_rows_that_are_as_equal_as_they_can_be() -> None:
    assert [figures.columns(5, width) for width in (1.0, 3.4, 5.0, 7.0, 20.0)] == [1, 2, 3, 3, 5]
    assert [figures.entries(width, 4) for width in (1.0, 4.0, 11.0)] == [1, 2, 4]
