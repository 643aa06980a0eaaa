"""`shootstab steady`: the steady flow, as numbers, a picture and a file."""

from __future__ import annotations

from argparse import ArgumentParser, Namespace
from typing import TYPE_CHECKING, Any

from shootstab.cli import commands, figures, values
from shootstab.core.errors import InputError
from shootstab.io import scenes as scene_files

if TYPE_CHECKING:
    from rich.console import RenderableType

PROFILE_HEIGHTS = 101  # chosen: heights of the profiles in a file
# chosen: what is drawn, the field and the label of its axis
FLOW_PANELS = (
    ("nu", r"volume fraction $\nu_0$"),
    ("u", r"velocity $u_0$ / $\sqrt{d\,g\cosθ}$"),
    ("T", r"temperature $T_0$ / $(d\,g\cosθ)$"),
    ("q", r"energy flux $q_0$"),
)


def options(command: ArgumentParser) -> None:
    """What `steady` may be told."""
    command.add_argument("--export", type=values.table_path, metavar="FILE", help="write the profiles into a csv or npz file")
    command.add_argument(
        "--points",
        type=values.integer(2, 100_000),
        default=PROFILE_HEIGHTS,
        metavar="N",
        help=f"heights in a file (default {PROFILE_HEIGHTS})",
    )
    figures.options(command, "draw the profiles")


def steady(options: Namespace) -> int:
    """The steady flow of the scene."""
    from shootstab.io import documents, fields

    look = figures.Look.of(options)
    if options.plot is not None:
        figures.require(options.plot, look)
    scene = scene_files.load(options.scene)
    flow = scene.flow
    if flow is None:
        raise InputError(f"{options.scene}: has no steady flow of grains: allowed is a scene with a [flow]")
    document = documents.steady(flow)
    if options.export is not None:
        z, profiles = documents.profiles(flow, options.points)
        fields.save(z, profiles, options.export, {"scene": scene.name})
    if options.plot is not None:
        figures.save(lambda: draw(flow, scene), options.plot, look)

    def tables() -> list[RenderableType]:
        from shootstab.cli import tables

        return tables.steady(flow, document["profiles"], scene)

    commands.answer(options, document, tables, scene)
    return commands.DONE


def draw(flow: Any, scene: scene_files.Scene) -> Any:
    """The fields over z, which goes upwards, as a matplotlib Figure."""
    from matplotlib.figure import Figure
    from matplotlib.ticker import MaxNLocator

    from shootstab.io import documents

    z, fields = documents.profiles(flow, 4 * PROFILE_HEIGHTS)
    figure = Figure(figsize=(9.6, 4.2), layout="constrained")
    for panel, (name, label) in zip(figure.subplots(1, len(FLOW_PANELS), sharey=True), FLOW_PANELS, strict=True):
        panel.plot(fields[name], z, color="#0072B2", linewidth=1.6)
        panel.axhline(flow.centre_of_mass, color="0.6", linewidth=0.8, linestyle=":", zorder=0)
        panel.set_xlabel(label)
        panel.xaxis.set_major_locator(MaxNLocator(3))
        panel.margins(y=0.0)
        if name == "nu":
            panel.set_ylabel("$z$ / $d$ (dotted: centre of mass)")
    numbers = rf"$T_\infty$ = {flow.far_temperature:.5g}, $Q_0$ = {flow.mass_flux:.5g}, $M_0$ = {flow.hold_up:.5g}"
    figure.suptitle(f"{scene.name}: {numbers}, $h_0$ = {flow.centre_of_mass:.5g}", fontsize="medium")
    return figure
