"""The commands: each asks its question and hands the answer to the JSON or to the table."""

from __future__ import annotations

import sys
import textwrap
from argparse import Namespace
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from shootstab.core.errors import InputError
from shootstab.core.regions import Disc, Polygon, Rectangle, Region
from shootstab.io import scenes as scene_files
from shootstab.io.conventions import Convention, wavenumber
from shootstab.io.files import require_writable, write_whole

if TYPE_CHECKING:
    from rich.console import RenderableType

    from shootstab.analyses.proved_verdicts import ProvedVerdict

DONE, BAD_NEWS = 0, 1  # defined by the contract: exit statuses of a command that did its work

METHOD_NAMES = ("frame", "compound", "riccati")  # the names of discriminants.named, which would load the kernels


def verify(options: Namespace) -> int:
    """A verdict on each eigenvalue in the file, or on those of the bundled reference."""
    from shootstab.cli.terminal import progress
    from shootstab.io import documents, readers

    if options.eigenvalues is not None and options.truncation is not None:
        raise InputError("-M is the truncation of the bundled reference: allowed only without EIGENVALUES")
    if options.plot is not None:
        from shootstab.cli import plots

        plots.require(options.plot)
    for name in ("dataset", "row"):
        if getattr(options, name) is not None and options.eigenvalues is None:
            raise InputError(f"--{name}: allowed only with EIGENVALUES")
    convention = _convention(options)
    if options.unstable and convention.unit.imag != 0.0:
        raise InputError(f"--unstable: allowed with growth rates only, not with --as {convention.kind}")
    if options.prove and not convention.plain:
        raise InputError("--prove: allowed with eigenvalues in the problem's own terms")
    region = None if options.region is None else _rectangle(options.region)
    spectrum = None if options.eigenvalues is None else readers.read(options.eigenvalues, options.dataset, options.row)
    given = None if spectrum is None else convention.read(spectrum)
    own = scene_files.load(options.scene)
    scene = own.seen(convention)
    if options.prove:
        from shootstab.analyses.prove import factors

        factors(own.problem)  # what has no enclosure is refused before anything is computed
    from shootstab.analyses.missing import unstable_box
    from shootstab.analyses.reference import claims
    from shootstab.analyses.verify import verify as question

    with progress(f"verifying {scene.name}") as told:
        if given is None:
            claimed = claims(own.problem, options.digits, options.truncation)
            # the reference claims that these are modes, not that there are no others
            if options.missing is None:
                region = region or (unstable_box(own.problem, claimed) if convention.plain else None)
            given = (claimed / convention.unit).tolist()
        wishes: Any = {
            "digits": options.digits,
            "region": region,
            "unstable": options.unstable,
            "missing": options.missing,
            "atol": options.atol,
        }
        report = question(scene.problem, given, progress=told, **wishes)
        theorems: tuple[ProvedVerdict, ...] = ()
        if options.prove:
            from shootstab.analyses.proved_verdicts import proved_verdicts

            theorems = proved_verdicts(scene.problem, report)
    from shootstab.analyses.hypotheses import hypotheses
    from shootstab.cli.proposals import sentence

    meant = [sentence(found, convention.plain) for found in hypotheses(scene.problem, report, options.digits)]
    report = convention.shown(replace(report, dropped=0 if spectrum is None else spectrum.dropped))
    if options.plot is not None:
        from shootstab.cli import plots

        plots.save(report, scene, options.plot)

    def tables() -> list[RenderableType]:
        from shootstab.cli import tables

        return [
            *tables.report(report, scene, options.only, options.sort),
            *tables.theorems(report, theorems),
            *map(tables.paragraph, meant),
        ]

    document = documents.report(report)
    document["meant"] = meant
    for stated, theorem in zip(document["verdicts"], theorems, strict=False):
        stated |= vars(theorem)
    if not convention.plain:
        document["convention"] = convention.formula
    _answer(options, document, tables, scene)
    return BAD_NEWS if report.bad_news(options.strict) or any(theorem.contradicts for theorem in theorems) else DONE


def refine(options: Namespace) -> int:
    """One mode, with its error bar."""
    from shootstab.io import documents

    convention = _convention(options)
    if convention.conjugate:
        raise InputError("--conjugate: allowed with verify; here give the conjugate guess")
    scene = scene_files.load(options.scene).seen(convention)
    from shootstab.analyses.refine import refine as question
    from shootstab.cli.terminal import progress

    with progress(f"refining {scene.name}") as told:
        hear = None if told is None else lambda done, total, left: told(done, total)
        found = question(scene.problem, options.guess, options.rtol, options.digits, options.method, hear, options.atol)

    def tables() -> list[RenderableType]:
        from shootstab.cli import tables

        return tables.mode(found, scene)

    document = documents.mode(found)
    if not convention.plain:
        document["convention"] = convention.formula
    _answer(options, document, tables, scene)
    return DONE if found.converged else BAD_NEWS


def _convention(options: Namespace) -> Convention:
    """What the user says that his numbers are."""
    given = {name: getattr(options, name)[0] for name in ("alpha", "length", "velocity") if getattr(options, name) is not None}
    if options.kind is None and (given or options.sign is not None):
        raise InputError("--alpha, --sign, --length and --velocity: allowed with --as growth, frequency or phase-speed")
    if options.kind == "phase-speed" and "alpha" not in given:
        own = wavenumber(scene_files.load(options.scene).problem)
        if own is not None:
            given["alpha"] = own * given.get("length", 1.0)  # in the user's units
    return Convention(options.kind or "growth", options.sign, conjugate=options.conjugate, **given)


def count(options: Namespace) -> int:
    """How many modes a region holds."""
    from shootstab.io import documents

    if options.floor is not None and options.region != "half-plane":
        raise InputError("--floor: allowed only with --region half-plane")
    region = _region(options)
    scene = scene_files.load(options.scene)
    if region is None:
        from shootstab.analyses.unstable import HalfDisc, count_unstable

        growing = count_unstable(scene.problem, *(options.floor or ()))
        region, found = HalfDisc(growing.radius, growing.floor), growing.counted
    else:
        from shootstab.analyses.count import counted

        found = counted(scene.problem, region)
    shape = region

    def tables() -> list[RenderableType]:
        from shootstab.cli import tables

        return tables.count(shape, found, scene)

    _answer(options, documents.count(region, found), tables, scene)
    return DONE


def find(options: Namespace) -> int:
    """All modes in a region; with --resonances also the zeros beyond the continuous spectrum."""
    from shootstab.io import documents

    region = _region(options)
    assert region is not None
    scene = scene_files.load(options.scene)
    from shootstab.analyses.find import find as question

    found = question(scene.problem, region, resonances=options.resonances, atol=options.atol)

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


def steady(options: Namespace) -> int:
    """The steady flow of the scene."""
    from shootstab.io import documents

    scene = scene_files.load(options.scene)
    flow = scene.flow
    if flow is None:
        raise InputError(f"{options.scene}: has no steady flow of grains: allowed is a scene with a [flow]")
    document = documents.steady(flow)

    def tables() -> list[RenderableType]:
        from shootstab.cli import tables

        return tables.steady(flow, document["profiles"], scene)

    _answer(options, document, tables, scene)
    return DONE


def spectrum(options: Namespace) -> int:
    """The pseudospectral spectrum."""
    from shootstab.io import documents

    scene = scene_files.load(options.scene)
    from shootstab.analyses.reference import spectrum as question

    found = question(scene.problem, M=options.truncation)

    def tables() -> list[RenderableType]:
        from shootstab.cli import tables

        return tables.spectrum(found, options.raw, scene)

    _answer(options, documents.spectrum(found, options.raw), tables, scene)
    return DONE


def scenes(options: Namespace) -> int:
    """What is built in."""
    listed = scene_files.built_in()
    if options.json is not None:
        says = [{"name": name, "description": one.scene.description, **vars(one.details)} for name, one in listed.items()]
        _write_json(options, {"scenes": says})
    if options.json != "-" and not options.quiet:
        for name, one in listed.items():
            print(textwrap.fill(f"{name:<16}{one.scene.description}", 80, subsequent_indent=" " * 16))
            print(textwrap.fill(str(one.details), 80, initial_indent=" " * 16, subsequent_indent=" " * 16))
    return DONE


def prepare(options: Namespace) -> None:
    """Refuse a file that could not be written before any work is done."""
    for path in (options.json, getattr(options, "plot", None)):
        if path is not None and path != "-":
            require_writable(Path(path))


def _answer(
    options: Namespace, document: dict[str, Any], tables: Callable[[], list[RenderableType]], scene: scene_files.Scene | None
) -> None:
    """JSON where it was asked for, with the scene in it if there is one, and tables on standard output unless JSON takes it."""
    if options.json is not None:
        _write_json(options, document if scene is None else {**document, "scene": scene.as_dict()})
    if options.json != "-" and not options.quiet:
        from shootstab.cli.terminal import show

        show(tables())


def _write_json(options: Namespace, document: dict[str, Any]) -> None:
    from shootstab.io import documents

    text = documents.text(document)
    if options.json == "-":
        sys.stdout.write(text)
    else:
        write_whole(Path(options.json), lambda path: path.write_text(text, encoding="utf-8"))


answer = _answer  # commands that live in modules of their own answer in the same way
