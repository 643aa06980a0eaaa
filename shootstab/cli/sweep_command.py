"""`shootstab sweep`: its options, its JSON, its table, and the files that its results go to.

JSON: {"axes": {name: [values]}, "digits", "every", "floor", "summary": {status: points, "counted": points}, "fastest": a point or null,
"points": [{each parameter by its name, "sigma": {"re", "im"} or null, "error", "status", "proved", "floor", "evaluations", "below":
{"re", "im"} or null, the mode of a growing neighbour followed to where nothing grows, without a bound, and "far_temperature" where the
mass flux chose the flow}]}.
"""

from __future__ import annotations

import argparse
import csv
import re
from argparse import Namespace
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

from shootstab.cli import figures
from shootstab.cli.commands import BAD_NEWS, DONE, answer, loaded
from shootstab.cli.lines import numbered
from shootstab.cli.values import counted, shared_out
from shootstab.core.allowed import COUNT_EVERY, GROWTH_FLOOR, LARGEST_FLOOR, MOST_EVERY, MOST_SWEEP_DIGITS, SWEEP_DIGITS
from shootstab.core.errors import InputError
from shootstab.core.numerus import number_of
from shootstab.io.files import require_writable, write_whole
from shootstab.models.chute.registry import SWEPT

if TYPE_CHECKING:
    from rich.console import RenderableType

    from shootstab.analyses.sweep import Swept
    from shootstab.analyses.sweep.outcomes import Outcome
    from shootstab.io.scenes import Scene

CSV_COLUMNS = (
    "re",
    "im",
    "error",
    "status",
    "proved",
    "floor",
    "evaluations",
    "below_re",
    "below_im",
)  # chosen: the columns of the file behind the parameters
MOST_LISTED = 70  # chosen: points that the table lists; more are summed up
MOST_VALUES = 1_000_000  # chosen: values along one axis of a sweep; more are a slip of the pen


def options(parser: argparse.ArgumentParser) -> None:
    """Add what `sweep` takes."""
    for p in SWEPT:
        parser.add_argument(p.option, dest=p.name, type=_values, metavar="A:B:N", help=f"{p.meaning}: N values from A to B, or one value")
    named = "a parameter of a scene in equations, likewise; may be given for several"
    parser.add_argument("--over", type=_named_values, action="append", default=[], metavar="NAME=A:B:N", help=named)
    counted(parser, "--digits", 1, MOST_SWEEP_DIGITS, SWEEP_DIGITS, "digits of σ at every point")
    counted(parser, "--every", 1, MOST_EVERY, COUNT_EVERY, "count modes at every N-th point")
    parser.add_argument(
        "--floor", type=_floor, default=GROWTH_FLOOR, metavar="X", help=f"a mode grows if Re σ > X (default {GROWTH_FLOOR:g})"
    )
    shared_out(parser, "one a core")
    parser.add_argument("--out", type=Path, metavar="FILE", help="SQLite file for the results; one that exists is completed")
    parser.add_argument("--export", type=_export_path, metavar="FILE", help="write the results as csv or npz")
    figures.options(parser, "draw growth rates over one or two parameters")


def sweep(options: Namespace) -> int:
    """The dominant mode over wavenumbers and flows."""
    axes = {p.name: getattr(options, p.name) for p in SWEPT if getattr(options, p.name) is not None}
    for name, values in options.over:
        if name in axes:
            raise InputError(f"{name}: given twice: allowed is once")
        axes[name] = values
    for path in (options.out, options.export):
        if path is not None:
            require_writable(path)
    if options.plot is not None:
        from shootstab.cli import maps

        maps.require(options.plot, axes, figures.Look.of(options))
    scene = loaded(options.scene)
    from shootstab.analyses.sweep import sweep as question
    from shootstab.cli.terminal import progress

    with progress(f"sweeping {scene.name}") as told:
        found = question(
            scene.problem,
            axes,
            digits=options.digits,
            every=options.every,
            floor=options.floor,
            workers=options.workers,
            cluster=options.dask,
            out=options.out,
            progress=told,
        )
    if options.export is not None:
        write_whole(options.export, lambda path: _EXPORTS[options.export.suffix.lower()](found, path))
    if options.plot is not None:
        from shootstab.cli import maps

        maps.save(found, scene, options.plot, figures.Look.of(options))
    answer(options, document(found), lambda: tables(found, scene), scene)
    return BAD_NEWS if found.bad_news else DONE


def document(found: Swept) -> dict[str, Any]:
    """The answer of `sweep` for JSON."""
    names = found.grid.names
    fastest = found.fastest
    return {
        "axes": {axis.name: list(axis.values) for axis in found.axes},
        "digits": found.settings.digits,
        "every": found.settings.every,
        "floor": found.settings.floor,
        "summary": found.summary,
        "fastest": None if fastest is None else {**dict(zip(names, fastest[0], strict=True)), **_said(fastest[1])},
        "points": [{**dict(zip(names, point, strict=True)), **_said(outcome)} for point, outcome in found.rows()],
    }


def _said(outcome: Outcome) -> dict[str, Any]:
    from shootstab.io.notation import as_strings

    return {
        "sigma": None if outcome.sigma is None else as_strings(outcome.sigma, outcome.error),
        "error": outcome.error,
        "status": outcome.status,
        "proved": outcome.proved,
        "floor": outcome.floor,
        "evaluations": outcome.evaluations,
        "below": None if outcome.below is None else as_strings(outcome.below),
        **outcome.beside,
    }


def tables(found: Swept, scene: Scene) -> list[RenderableType]:
    """The points if they are few, a sentence on them, and the fastest mode. What is the same at all points stands above the table."""
    from rich.text import Text

    from shootstab.cli.tables import heading, paragraph, ruled
    from shootstab.io.notation import held_complex

    parts: list[RenderableType] = [heading(scene)]
    if len(found.outcomes) <= MOST_LISTED:
        varying = [i for i, axis in enumerate(found.axes) if len(axis.values) > 1] or [0]
        fixed = [f"{axis.name} = {axis.values[0]:.8g}" for i, axis in enumerate(found.axes) if i not in varying]
        sigma = f"dominant σ / {scene.unit}" if scene.unit else "dominant σ"
        table = ruled("", *(found.grid.names[i] for i in varying), *found.columns, sigma, "error", "status", numbered=False)
        reasons: dict[str, list[int]] = {}
        for number, (point, outcome) in enumerate(found.rows(), 1):
            known = outcome.sigma is not None
            status, _, why = outcome.status.partition(": ")
            if why:
                reasons.setdefault(f"{status}: {why}", []).append(number)
            table.add_row(
                *(f"{point[i]:.8g}" for i in varying),
                *(f"{outcome.beside[c]:.8g}" if c in outcome.beside else "–" for c in found.columns),
                held_complex(outcome.sigma, outcome.error) if known else "–",
                f"{outcome.error:.1e}" if known else "",
                Text(status),
            )
        parts += [*([paragraph(f"At {', '.join(fixed)}:")] if fixed else []), table]
        parts += [paragraph(f"Row{'s' * (len(rows) > 1)} {numbered(rows)}: {why}") for why, rows in reasons.items()]
    counts = found.summary
    counted = counts.pop("counted")
    said = ", ".join(f"{n} {status}" for status, n in counts.items() if n)
    parts.append(paragraph(f"{number_of(len(found.outcomes), 'point')}: {said}; modes were counted at {counted}."))
    if found.fastest is not None:
        point, outcome = found.fastest
        where = ", ".join(f"{n} = {v:.8g}" for n, v in zip(found.grid.names, point, strict=True))
        parts.append(paragraph(f"Fastest growth: σ = {held_complex(outcome.sigma, outcome.error)} at {where}."))
    return parts


# files


def write_csv(found: Swept, path: Path) -> None:
    with path.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        writer.writerow((*found.grid.names, *CSV_COLUMNS, *found.columns))
        for point, o in found.rows():
            rest = (o.error, o.status, int(o.proved), o.floor, o.evaluations)
            beside = (o.beside.get(c) for c in found.columns)
            row = (*_cells(o.sigma), *rest, *_cells(o.below), *beside)
            writer.writerow((*map(repr, point), *("" if x is None else x for x in row)))


def _cells(number: complex | None) -> tuple[str, str]:
    """Both parts with every digit; empty where there is no number."""
    return ("", "") if number is None else (repr(number.real), repr(number.imag))


def write_npz(found: Swept, path: Path) -> None:
    """One array for each axis by its name, and on the grid: re, im, error, below_re, below_im (NaN where absent), status, proved."""
    import numpy as np

    def beside(name: str) -> Any:
        return found.array(lambda o: o.beside.get(name))

    arrays: dict[str, Any] = {axis.name: np.array(axis.values) for axis in found.axes}
    arrays |= {name: beside(name) for name in found.columns}
    with path.open("wb") as file:
        np.savez(
            file,
            **arrays,
            re=found.growth,
            im=found.array(lambda o: None if o.sigma is None else o.sigma.imag),
            error=found.array(lambda o: o.error),
            below_re=found.below.real,
            below_im=found.below.imag,
            status=found.array(lambda o: o.status, dtype=np.str_),
            proved=found.array(lambda o: o.proved, dtype=np.bool_),
        )


_EXPORTS: dict[str, Callable[[Swept, Path], None]] = {".csv": write_csv, ".npz": write_npz}


# the values of options, refused in words


def _values(text: str) -> tuple[float, ...]:
    from shootstab.io.notation import floats_from

    parts = text.split(":")
    try:
        if len(parts) not in (1, 3):
            raise ValueError
        ends = floats_from(",".join(parts[:2]), len(parts[:2]))
        if len(parts) == 1:
            return ends
        if not re.fullmatch(r"\d{1,7}", parts[2], re.ASCII) or not 2 <= int(parts[2]) <= MOST_VALUES or ends[0] == ends[1]:
            raise ValueError
    except ValueError:
        allowed = f"a number, or A:B:N with A other than B and N from 2 to {MOST_VALUES}"
        raise argparse.ArgumentTypeError(f"{text!r}: allowed is {allowed}") from None
    (a, b), n = ends, int(parts[2])
    # 15 digits: 0.015 and not 0.015000000000000003
    return tuple(float(f"{a + (b - a) * i / (n - 1):.15g}") for i in range(n))


def _named_values(text: str) -> tuple[str, tuple[float, ...]]:
    name, equals, values = text.partition("=")
    if not equals or not re.fullmatch(r"[^\W\d]\w*", name):
        raise argparse.ArgumentTypeError(f"{text!r}: allowed is NAME=A:B:N, or NAME=X")
    return name, _values(values)


def _floor(text: str) -> float:
    from shootstab.io.notation import floats_from

    try:
        (value,) = floats_from(text, 1)
    except ValueError:
        value = 0.0
    if not 0.0 < value < LARGEST_FLOOR:
        raise argparse.ArgumentTypeError(f"{text!r}: allowed is a number above 0 and below {LARGEST_FLOOR:g}")
    return value


def _export_path(text: str) -> Path:
    path = Path(text)
    if path.suffix.lower() not in _EXPORTS:
        raise argparse.ArgumentTypeError(f"{text!r}: allowed is a file name that ends in {' or '.join(_EXPORTS)}")
    return path
