"""`shootstab mode`: the eigenfunction of one mode, as a table, a picture and a file."""

from __future__ import annotations

from argparse import ArgumentParser, Namespace
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from shootstab.cli import commands, field_table, figures, mode_in_digits, mode_of_several, values
from shootstab.core.allowed import MODE_HEIGHTS, MOST_HEIGHTS, MOST_MODE_DIGITS, RTOL
from shootstab.core.errors import InputError
from shootstab.io import scenes as scene_files

if TYPE_CHECKING:
    from rich.console import RenderableType

    from shootstab.analyses.eigenfunction_double import Eigenfunction
    from shootstab.analyses.sensitivity import Sensitivity

SHOWN_OF_DERIVATIVE = 1e-9  # chosen: a derivative is shown to this part of itself at most


def options(command: ArgumentParser) -> None:
    """What `mode` may be told."""
    command.add_argument("--guess", type=values.guess, required=True, metavar="RE[,IM]", help="where the mode is")
    accuracy = command.add_mutually_exclusive_group()
    accuracy.add_argument("--rtol", type=values.tolerance, default=RTOL, metavar="X", help=values.RTOL_HELP)
    many = "values with an error of at most 10^-N of the largest, from Taylor series"
    accuracy.add_argument("--digits", type=values.integer(1, MOST_MODE_DIGITS), metavar="N", help=many)
    command.add_argument(
        "--z", type=values.numbers(2), metavar="LOW,HIGH", help="the heights that are shown (default: until it has decayed)"
    )
    heights = f"heights in a file (default {MODE_HEIGHTS}, with --digits {mode_in_digits.HEIGHTS_IN_DIGITS})"
    command.add_argument("--points", type=values.integer(2, MOST_HEIGHTS), metavar="N", help=heights)
    said = "derivatives of the mode by parameters of the scene: kx, ky, e, nu_max, …"
    command.add_argument("--sensitivity", metavar="NAME,…", help=said)
    command.add_argument("--export", type=values.table_path, metavar="FILE", help="write the fields into a csv or npz file")
    figures.options(command, "draw the eigenfunction")


def mode(options: Namespace) -> int:
    """The eigenfunction of one mode."""
    import numpy as np

    from shootstab.cli.terminal import progress
    from shootstab.io import eigenfunctions, fields

    if options.digits is not None:
        return mode_in_digits.answer(options)
    look = figures.Look.of(options)
    if options.plot is not None:
        figures.require(options.plot, look)
    convention = commands.convention(options)
    if convention.conjugate:
        raise InputError("--conjugate: allowed with verify; here give the conjugate guess")
    scene = commands.loaded(options.scene).seen(convention)
    from shootstab.io.notation import as_strings

    with progress(f"solving {scene.name}") as told:
        from shootstab.analyses.eigenspace import eigenspace
        from shootstab.analyses.refine import refine
        from shootstab.analyses.sensitivity import sensitivities

        refined = refine(scene.problem, options.guess, options.rtol)
        solved = eigenspace(scene.problem, refined, options.rtol, told) if refined.converged else None
    if solved is None:
        from shootstab.cli import tables
        from shootstab.io import documents

        commands.answer(options, {"mode": documents.mode(refined)}, lambda: tables.mode(refined, scene), scene)
        return commands.BAD_NEWS
    if solved.algebraic_multiplicity > 1:
        return mode_of_several.answer(options, solved, scene, look)
    (found,) = solved.basis
    with progress(f"evaluating {scene.name}"):
        low, high = options.z or found.extent
        z = np.linspace(low, high, options.points or MODE_HEIGHTS)
        document = eigenfunctions.document(found, z)
        if options.export is not None:
            about = {key: value for key, value in document.items() if key not in ("z", "fields")}
            fields.save(z, eigenfunctions.columns(found, z), options.export, {**about, "scene": scene.name})
        slopes = sensitivities(found, options.sensitivity.split(",")) if options.sensitivity else []
    if options.plot is not None:
        from shootstab.cli import mode_plot

        figures.save(lambda: mode_plot.draw(found, scene, low, high, look.size), options.plot, look)
    if slopes:
        document["sensitivity"] = [
            {"parameter": s.parameter, "value": s.value, "derivative": as_strings(s.derivative), "error": s.error} for s in slopes
        ]
    if not convention.plain:
        document["convention"] = convention.formula
    commands.answer(options, document, lambda: [*_tables(found, scene, z), *_slopes(slopes, scene)], scene)
    return commands.DONE


def _tables(found: Eigenfunction, scene: scene_files.Scene, z: Any) -> list[RenderableType]:
    """What the mode is, then each field: its largest value on these heights, where that is, and its values at both of their ends."""
    from shootstab.cli import tables
    from shootstab.io.eigenfunctions import columns
    from shootstab.io.notation import held_complex

    parts = [f"{name.replace('_', ' ')} {value:.0e}" for name, value in found.budget.as_dict().items()]
    condition, nonnormality = f"{found.conditioning.relative:.2g}", f"{found.conditioning.nonnormality:.3g}"
    rows = {
        tables.in_symbol("σ", scene): held_complex(found.mode.sigma, found.mode.error),
        "normalization": found.normalization,
        "error": f"{found.error:.1e} of each unknown's largest value",
        "": f"({', '.join(parts[:3])},\n {', '.join(parts[3:])})",
        "condition": f"{condition}: relative changes ε of the entries make {condition} ε of {scene.symbol} at most",
        "nonnormality": f"{nonnormality} (1: no product of φ and its adjoint cancels another)",
    }
    if found.kind:
        rows["kind"] = found.kind
    fields = columns(found, z)
    table = field_table.table_of(fields, z, found.variable, {name: found.error * float(abs(f).max()) for name, f in fields.items()})
    return [tables.heading(scene), tables.pairs(rows.items()), table, tables.paragraph(f"Values at {len(z)} heights.")]


def _slopes(slopes: Sequence[Sensitivity], scene: scene_files.Scene) -> list[RenderableType]:
    """The sensitivities as a table; nothing where none were asked for."""
    from shootstab.cli import tables
    from shootstab.io.notation import held_complex

    if not slopes:
        return []
    table = tables.ruled("", "parameter", "value", f"∂{scene.symbol}/∂p", numbered=False)
    for s in slopes:
        table.add_row(s.parameter, f"{s.value:g}", held_complex(s.derivative, max(s.error, SHOWN_OF_DERIVATIVE * abs(s.derivative))))
    return [table]
