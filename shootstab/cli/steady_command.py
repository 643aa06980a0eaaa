"""`shootstab steady`: the steady flow, as numbers, a picture and a file."""

from __future__ import annotations

from argparse import ArgumentParser, Namespace
from typing import TYPE_CHECKING, Any

from shootstab.cli import commands, figures, values
from shootstab.core.allowed import MOST_HEIGHTS
from shootstab.core.errors import InputError
from shootstab.io import scenes as scene_files

if TYPE_CHECKING:
    from rich.console import RenderableType

PROFILE_HEIGHTS = 101  # chosen: heights of the profiles in a file
FLOW_SIZE = (9.6, 4.2)  # chosen: inches
NARROWEST_PROFILE = 2.2  # chosen: inches of a panel under which its name with its unit finds room
# chosen: the fields that are drawn, each with the label of its axis
FLOW_PANELS = (
    ("nu", r"volume fraction $\nu_0$"),
    ("u", r"velocity $u_0$ / $\sqrt{d\,g\cosθ}$"),
    ("T", r"temperature $T_0$ / $(d\,g\cosθ)$"),
    ("q", r"energy flux $q_0$ / $\rho_p (d\,g\cosθ)^{3/2}$"),
)


def options(command: ArgumentParser) -> None:
    """What `steady` may be told."""
    command.add_argument("--export", type=values.table_path, metavar="FILE", help="write the profiles into a csv or npz file")
    values.counted(command, "--points", 2, MOST_HEIGHTS, PROFILE_HEIGHTS, "heights in a file")
    figures.options(command, "draw the profiles")


def steady(options: Namespace) -> int:
    """The steady flow of the scene."""
    from shootstab.io import documents, fields

    look = figures.Look.of(options)
    if options.plot is not None:
        figures.require(options.plot, look)
    scene = commands.loaded(options.scene)
    flow = scene.flow
    if flow is None:
        raise InputError(f"{options.scene}: has no steady flow of grains: allowed is a scene with a [flow]")
    document = documents.steady(flow)
    if options.export is not None:
        z, profiles = documents.profiles(flow, options.points)
        fields.save(z, profiles, options.export, {"scene": scene.name})
    if options.plot is not None:
        figures.save(lambda: draw(flow, scene, look.size), options.plot, look)

    def tables() -> list[RenderableType]:
        from shootstab.cli import tables

        return tables.steady(flow, document["profiles"], scene)

    commands.answer(options, document, tables, scene)
    return commands.DONE


def draw(flow: Any, scene: scene_files.Scene, size: figures.Size | None = None) -> Any:
    """The fields over z, which goes upwards, as a matplotlib Figure; a narrow one has them in several rows."""
    from matplotlib.figure import Figure
    from matplotlib.ticker import MaxNLocator

    from shootstab.io import documents

    z, fields = documents.profiles(flow, 4 * PROFILE_HEIGHTS)
    size = size or FLOW_SIZE
    across = figures.columns(len(FLOW_PANELS), size[0], NARROWEST_PROFILE)
    figure = Figure(figsize=size, layout="constrained")
    panels = figure.subplots(len(FLOW_PANELS) // across, across, sharey=True, squeeze=False)
    for panel, (name, label) in zip(panels.flat, FLOW_PANELS, strict=True):
        panel.plot(fields[name], z, color="#0072B2", linewidth=1.6)
        panel.axhline(flow.centre_of_mass, color="0.6", linewidth=0.8, linestyle=":", zorder=0)
        panel.set_xlabel(label)
        panel.xaxis.set_major_locator(MaxNLocator(3))
        panel.margins(y=0.0)
    for panel in panels[:, 0]:
        panel.set_ylabel("$z$ / $d$")
    numbers = rf"$T_\infty$ = {flow.far_temperature:.5g}, $Q_0$ = {flow.mass_flux:.5g}, $M_0$ = {flow.hold_up:.5g}"
    gap = ", " if across == len(FLOW_PANELS) else "\n"
    figure.suptitle(f"{scene.name}: {numbers}{gap}$h_0$ = {flow.centre_of_mass:.5g} (dotted)", fontsize="medium")
    return figure
