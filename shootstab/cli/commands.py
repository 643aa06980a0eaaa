"""The commands: each asks its question and hands the answer to the JSON or to the table."""

from __future__ import annotations

import sys
from argparse import Namespace
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from shootstab import __version__
from shootstab.cli import figures
from shootstab.cli.clock import Clock
from shootstab.cli.lines import filled
from shootstab.core.errors import InputError
from shootstab.core.regions import Disc, Polygon, Rectangle, Region
from shootstab.io import scenes as scene_files
from shootstab.io.conventions import Convention
from shootstab.io.files import require_writable, write_text

if TYPE_CHECKING:
    from rich.console import RenderableType


DONE, BAD_NEWS = 0, 1  # defined by the contract: exit statuses of a command that did its work


def refine(options: Namespace) -> int:
    """One mode, with its error bar."""
    from shootstab.io import documents

    convention = _convention(options)
    if convention.conjugate:
        raise InputError("--conjugate: allowed with verify; here give the conjugate guess")
    scene = loaded(options.scene).seen(convention)
    from shootstab.analyses.refine import refine as question
    from shootstab.cli.terminal import progress

    with progress(f"refining {scene.name}") as told:
        hear = None if told is None else lambda done, total, left: told(done, total)
        found = question(scene.problem, options.guess, options.rtol, options.digits, options.method, hear, options.atol)

    def tables() -> list[RenderableType]:
        from shootstab.cli import tables

        return tables.mode(found, scene, options.digits)

    document = documents.mode(found)
    if not convention.plain:
        document["convention"] = convention.formula
    _answer(options, document, tables, scene)
    return DONE if found.converged else BAD_NEWS


def loaded(name: str) -> scene_files.Scene:
    """The scene, with its base flow, which may take seconds on a busy machine. Raises InputError where there is none."""
    from shootstab.cli.terminal import progress

    with progress(f"reading the scene {name}"):
        return scene_files.load(name)


def _look(options: Namespace) -> figures.Look:
    """The look of the picture. Raises InputError where one is asked for that cannot be drawn."""
    look = figures.Look.of(options)
    if options.plot is not None:
        figures.require(options.plot, look)
    return look


def _convention(options: Namespace) -> Convention:
    """What the user says that his numbers are."""
    given = {name: getattr(options, name)[0] for name in ("alpha", "length", "velocity") if getattr(options, name) is not None}
    if options.kind is None and (given or options.sign is not None):
        raise InputError("--alpha, --sign, --length and --velocity: allowed with --as growth, frequency or phase-speed")
    if options.kind == "phase-speed" and "alpha" not in given:
        own = loaded(options.scene).wavenumber
        if own is not None:
            given["alpha"] = own[1] * given.get("length", 1.0)  # α in the user's units
    return Convention(options.kind or "growth", options.sign, conjugate=options.conjugate, **given)


def count(options: Namespace) -> int:
    """How many modes a region holds."""
    from shootstab.cli.terminal import progress
    from shootstab.io import documents

    if options.floor is not None and options.region != "half-plane":
        raise InputError("--floor: allowed only with --region half-plane")
    region, lemma = _region(options), ""
    scene = loaded(options.scene)
    with progress(f"counting modes of {scene.name}"):
        if region is None:
            from shootstab.analyses.unstable import count_unstable

            growing = count_unstable(scene.problem, *(options.floor or ()))
            region, found, lemma = growing.region, growing.counted, growing.lemma
        else:
            from shootstab.analyses.count import counted

            found = counted(scene.problem, region)
    shape = region

    def tables() -> list[RenderableType]:
        from shootstab.cli import tables

        return tables.count(shape, found, scene, lemma)

    _answer(options, documents.count(region, found, lemma), tables, scene)
    return DONE


def find(options: Namespace) -> int:
    """All modes in a region; with --resonances also the zeros beyond the continuous spectrum."""
    from shootstab.io import documents

    look, region = _look(options), _region(options)
    assert region is not None
    scene = loaded(options.scene)
    from shootstab.analyses.find import find as question
    from shootstab.cli.terminal import progress

    with progress(f"finding modes of {scene.name}"):
        wishes: Any = {"resonances": options.resonances, "atol": options.atol, "workers": options.workers, "cluster": options.dask}
        found = question(scene.problem, region, **wishes)
    if options.plot is not None:
        from shootstab.cli import plots

        figures.save(lambda: plots.draw_found(found, region, scene, look.size), options.plot, look)

    def tables() -> list[RenderableType]:
        from shootstab.cli import tables

        return tables.found(found, region, scene)

    _answer(options, documents.found(found, region), tables, scene)
    return DONE


def _region(options: Namespace) -> Region | None:
    """The region that is asked about; None is a half-plane."""
    wanted = {"rectangle": ("corners",), "polygon": ("corners",), "disc": ("centre", "radius"), "half-plane": ()}[options.region]
    for name in ("corners", "centre", "radius"):
        if (getattr(options, name) is not None) != (name in wanted):
            needed = " and ".join(f"--{w}" for w in wanted) or "nothing but --floor"
            raise InputError(f"--region {options.region}: needed is {needed}, and no other")
    if options.region == "half-plane":
        return None
    if options.region == "disc":
        return Disc(complex(*options.centre), options.radius[0])
    if len(options.corners) % 2 or (options.region == "rectangle" and len(options.corners) != 4):
        raise InputError("--corners: allowed are RE,IM pairs, two for a rectangle and three or more for a polygon")
    if options.region == "rectangle":
        return _rectangle(options.corners)
    return Polygon(tuple(complex(*options.corners[i : i + 2]) for i in range(0, len(options.corners), 2)))


def _rectangle(corners: tuple[float, float, float, float]) -> Rectangle:
    return Rectangle(complex(*corners[:2]), complex(*corners[2:]))


def spectrum(options: Namespace) -> int:
    """The pseudospectral spectrum."""
    from shootstab.io import documents

    look, convention = _look(options), _convention(options)
    own = loaded(options.scene)
    scene = own.seen(convention)
    from shootstab.cli.terminal import progress

    with progress(f"computing the spectrum of {scene.name}"):
        from shootstab.analyses.reference import spectrum as question

        found = question(own.problem, M=options.truncation)
    if not convention.plain:
        values = {name: convention.written(getattr(found, name)) for name in ("raw", "eigenvalues")}
        found = replace(found, **values, drift=found.drift / abs(convention.unit))
    if options.plot is not None:
        from shootstab.cli import plots

        figures.save(lambda: plots.draw_spectrum(found, scene, options.raw, look.size), options.plot, look)

    def tables() -> list[RenderableType]:
        from shootstab.cli import tables

        return tables.spectrum(found, options.raw, scene)

    document = documents.spectrum(found, options.raw)
    if not convention.plain:
        document["convention"] = convention.formula
    _answer(options, document, tables, scene)
    return DONE


def scenes(options: Namespace) -> int:
    """What is built in."""
    listed = scene_files.built_in()
    if options.json is not None:
        says = [{"name": name, "description": one.scene.description, **vars(one.details)} for name, one in listed.items()]
        _write_json(options, {"scenes": says, "version": __version__, **clock_of(options).stop()})
    if options.json != "-" and not options.quiet:
        width = max(map(len, listed)) + 2
        column = " " * width
        for name, one in listed.items():
            for first, said in ((name, one.scene.description), ("", one.details)):
                print(f"{first:<{width}}{filled(f'{column}{said}', column)[width:]}")
    return DONE


def clock_of(options: Namespace) -> Clock:
    """The clock of the command, which began with it."""
    if not hasattr(options, "clock"):
        options.clock = Clock()
    clock: Clock = options.clock
    return clock


def prepare(options: Namespace) -> None:
    """Refuse a file that could not be written before any work is done, and start the clock of an answer that says how long it took."""
    written = ("plot", "export", "html", "markdown", "tex")
    for path in (options.json, *(getattr(options, name, None) for name in written)):
        if path is not None and path != "-":
            require_writable(Path(path))
    if options.json is not None:
        clock_of(options)


def _answer(
    options: Namespace, document: dict[str, Any], tables: Callable[[], list[RenderableType]], scene: scene_files.Scene | None
) -> None:
    """JSON where it was asked for, with the scene in it if there is one, and tables on standard output unless JSON takes it."""
    if options.json is not None:
        about = {"version": __version__, **clock_of(options).stop()}
        _write_json(options, {**document, **about, **({} if scene is None else {"scene": scene.as_dict()})})
    if options.json != "-" and not options.quiet:
        from shootstab.cli.terminal import show

        show(tables())


def _write_json(options: Namespace, document: dict[str, Any]) -> None:
    from shootstab.io import documents

    text = documents.text(document)
    if options.json == "-":
        sys.stdout.write(text)
    else:
        write_text(Path(options.json), text)


answer, convention, look, rectangle = _answer, _convention, _look, _rectangle  # public for the commands that live in modules of their own
