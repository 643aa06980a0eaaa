"""`shootstab mode --digits N`: the eigenfunction to many digits, at the heights that are asked for."""

from __future__ import annotations

import csv
from argparse import Namespace
from typing import TYPE_CHECKING, Any

from shootstab.cli import commands, figures
from shootstab.core.errors import InputError
from shootstab.io import scenes as scene_files
from shootstab.io.files import write_whole

if TYPE_CHECKING:
    from pathlib import Path

    from rich.console import RenderableType

    from shootstab.analyses.eigenfunction_digits import EigenfunctionInDigits

HEIGHTS_IN_DIGITS = 5  # chosen: heights in the table; each field has as many lines of so many digits
DigitsRow = tuple[str, dict[str, Any]]  # z as a decimal, and the unknowns there


def answer(options: Namespace) -> int:
    """The eigenfunction of one mode, in digits that are text wherever they go."""
    if options.sensitivity or not commands.convention(options).plain:
        raise InputError("--digits: allowed without --sensitivity, for eigenvalues in the problem's own terms")
    if options.export is not None and options.export.suffix.lower() != ".csv":
        raise InputError(f"{options.export}: allowed with --digits is a file name that ends in .csv")
    look = commands.look(options)
    scene = commands.loaded(options.scene)
    from shootstab.cli.terminal import progress
    from shootstab.io import documents
    from shootstab.io.notation import as_strings

    with progress(f"solving {scene.name}") as told:
        from shootstab.analyses.eigenfunction import eigenfunction

        found = eigenfunction(scene.problem, options.guess, progress=told, digits=options.digits)
        low, high = options.z or found.extent
        count = options.points or HEIGHTS_IN_DIGITS
        heights = [f"{low + (high - low) * i / (count - 1):.12g}" for i in range(count)]
        rows = [(z, found(z)) for z in sorted({*heights, *([] if options.points else [found.peak[1]])}, key=float)]
    errors = {name: found.error * float(max(abs(values[name]) for _, values in rows)) for name in found.names}
    if options.export is not None:
        write_whole(options.export, lambda path: _write(path, rows, errors))
    if options.plot is not None:
        from shootstab.cli import mode_plot

        figures.save(lambda: mode_plot.draw(found.rough, scene, low, high, look.size), options.plot, look)
    document = {
        "mode": documents.mode(found.mode),
        "normalization": found.normalization,
        "error": found.error,
        "budget": found.budget.as_dict(),
        "digits": found.digits,
        "z": [z for z, _ in rows],
        "fields": {name: [as_strings(values[name], errors[name]) for _, values in rows] for name in found.names},
    }
    commands.answer(options, document, lambda: _tables(found, scene, rows, errors, options.digits), scene)
    return commands.DONE


def _tables(
    found: EigenfunctionInDigits, scene: scene_files.Scene, rows: list[DigitsRow], errors: dict[str, float], asked: int
) -> list[RenderableType]:
    """The tables of the mode, with at most two digits more than were asked for."""
    from shootstab.cli import tables
    from shootstab.io.notation import held_complex

    parts = [f"{name.replace('_', ' ')} {float(value):.0e}" for name, value in found.budget.as_dict().items()]
    least = 10.0 ** -(asked + tables.MORE_DIGITS)  # the least part of each unknown's largest value that is shown
    wider = max(1.0, least / found.error) if found.error > 0.0 else 1.0
    about = {
        tables.in_symbol("σ", scene): held_complex(found.mode.sigma, max(found.mode.error, float(abs(found.mode.sigma)) * least)),
        "normalization": found.normalization,
        "error": f"{found.error:.1e} of each unknown's largest value ({', '.join(parts)})",
    }
    shown: list[RenderableType] = [tables.heading(scene), tables.pairs(about.items())]
    for name in found.names:
        values = [(f"{name}({z})", held_complex(at[name], errors[name] * wider)) for z, at in rows]
        shown += [tables.paragraph(""), tables.pairs(values)]
    return shown


def _write(path: Path, rows: list[DigitsRow], errors: dict[str, float]) -> None:
    """Columns z, NAME_re and NAME_im, with the digits that hold."""
    from shootstab.io.notation import as_strings

    with path.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        writer.writerow(["z", *(f"{name}_{part}" for name in errors for part in ("re", "im"))])
        for z, at in rows:
            cells = [as_strings(at[name], error) for name, error in errors.items()]
            writer.writerow([z, *(cell[part] for cell in cells for part in ("re", "im"))])
