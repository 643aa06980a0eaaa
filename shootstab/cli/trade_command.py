"""`shootstab trade`: work against accuracy of every method, as table, JSON and picture.

JSON: {"truth": {"re", "im"}, "bound", "guess": {"re", "im"}, "measurements": [{"method", "parameter", "resolution", "sigma": {"re", "im"},
"error", "relative_error", "by_bound", "seconds", "memory", "work"}], "recommendation"}. memory is in bytes, null where it is not known.
"""

from __future__ import annotations

import argparse
from argparse import Namespace
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from shootstab.cli import figures
from shootstab.cli.commands import DONE, answer, loaded
from shootstab.core.progress import MILLISECONDS

if TYPE_CHECKING:
    from rich.console import RenderableType

    from shootstab.analyses.work_precision import Measurement, WorkPrecision
    from shootstab.io.scenes import Scene

# colour (Okabe and Ito's), marker, dashes
STYLES = {
    "qz": ("#D55E00", "s", "-"),
    "qz, paper's grid": ("#D55E00", "s", ":"),
    "inverse iteration": ("#E69F00", "D", "-"),
    "inverse iteration, paper's grid": ("#E69F00", "D", ":"),
    "frame": ("#0072B2", "o", "-"),
    "compound": ("#009E73", "^", "-"),
    "riccati": ("#56B4E9", "v", "-"),
    "taylor series": ("#CC79A7", "*", "-"),
}
TRADE_SIZE = (11, 5.4)  # chosen: inches
NARROWEST_DIAGRAM = 3.4  # chosen: inches of one of two diagrams side by side
OTHER_STYLE = ("#000000", "x", "--")  # the style of a method that is not named here
MILLION = 1e6  # exact: bytes in a MB as plots and disks count them


def options(parser: argparse.ArgumentParser, guess: Callable[[str], complex]) -> None:
    """Add what `trade` takes."""
    parser.add_argument("--guess", type=guess, metavar="RE[,IM]", help="the mode (default: the fastest-growing one of the reference)")
    figures.options(parser, "draw time and memory against error")


def trade(options: Namespace) -> int:
    """Work against accuracy, for every method."""
    look = figures.Look.of(options)
    if options.plot is not None:
        figures.require(options.plot, look)
    scene = loaded(options.scene)
    from shootstab.analyses.work_precision import trade as question
    from shootstab.cli.terminal import progress

    with progress(f"measuring {scene.name}") as told:
        found = question(scene.problem, options.guess, told)
    if options.plot is not None:
        figures.save(lambda: draw(found, scene, look.size), options.plot, look)
    answer(options, document(found), lambda: tables(found, scene), scene)
    return DONE


def document(found: WorkPrecision) -> dict[str, Any]:
    """The answer of `trade` for JSON."""
    from shootstab.io.notation import as_strings

    return {
        "truth": as_strings(found.truth, found.bound),
        "bound": found.bound,
        "guess": as_strings(found.guess),
        "measurements": [
            {
                "method": r.method,
                "parameter": r.parameter,
                "resolution": r.resolution,
                "sigma": as_strings(r.sigma, r.error),
                "error": r.error,
                "relative_error": r.relative,
                "by_bound": r.by_bound,
                "seconds": r.seconds,
                "memory": r.memory or None,
                "work": r.work,
            }
            for r in found.measurements
        ],
        "recommendation": found.recommendation,
    }


def tables(found: WorkPrecision, scene: Scene) -> list[RenderableType]:
    """Every measurement, and what follows."""
    from shootstab.cli.tables import heading, paragraph, ruled

    table = ruled("", "method", "resolution", "error", "time", "memory", "work", numbered=False)
    last = ""
    for r in found.measurements:
        if last and r.method != last:
            table.add_section()
        error = f"{'< ' if r.by_bound else ''}{r.relative:.1e}"
        memory = f"{r.memory / MILLION:.1f} MB" if r.memory else "–"
        table.add_row(r.method, resolution(r), error, duration(r.seconds), memory, str(r.work))
        last = r.method
    said = "Errors are relative. Work: evaluations of D, or factorizations of a matrix."
    return [heading(scene), table, paragraph(said), paragraph(found.recommendation)]


def duration(seconds: float) -> str:
    """Three figures, in ms below a second."""
    return f"{MILLISECONDS * seconds:.3g} ms" if seconds < 1.0 else f"{seconds:.3g} s"


def resolution(measurement: Measurement) -> str:
    """The resolution of a measurement in words: M = 48, rtol 1e-09, 15 digits."""
    if measurement.parameter == "M":
        return f"M = {measurement.resolution:.0f}"
    return f"{measurement.resolution:.0f} digits" if measurement.parameter == "digits" else f"rtol {measurement.resolution:.0e}"


def draw(found: WorkPrecision, scene: Scene, size: figures.Size | None = None) -> Any:
    """Time and memory against the relative error, as a matplotlib Figure; better is to the right and down."""
    from matplotlib.figure import Figure

    size = size or TRADE_SIZE
    across = figures.columns(2, size[0], NARROWEST_DIAGRAM)
    figure = Figure(figsize=size, layout="constrained")
    left, right = figure.subplots(2 // across, across, squeeze=False).ravel()
    for method in dict.fromkeys(r.method for r in found.measurements):
        measurements = [r for r in found.measurements if r.method == method]
        colour, marker, dashes = STYLES.get(method, OTHER_STYLE)
        style = {"color": colour, "marker": marker, "linestyle": dashes, "markersize": 5, "linewidth": 1.3, "label": method}
        errors = [r.relative for r in measurements]
        left.plot(errors, [r.seconds for r in measurements], **style)
        if all(r.memory for r in measurements):
            right.plot(errors, [r.memory / MILLION for r in measurements], **style)
    for panel, label in ((left, "time / s"), (right, "peak memory / MB")):
        panel.set_xscale("log")
        panel.set_yscale("log")
        panel.set_xlabel("true relative error of σ")
        panel.set_ylabel(label)
        panel.grid(True, which="major", linewidth=0.4, alpha=0.5)
        panel.invert_xaxis()
    handles, labels = left.get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside lower center", ncols=figures.entries(size[0], 4), frameon=False, fontsize="small")
    figure.suptitle(f"{scene.name}: one mode from a guess of three digits\n{scene.description}", fontsize="medium")
    return figure
