"""`shootstab verify`: verdicts on a spectrum, as a table, a picture, a page, a table for a paper."""

from __future__ import annotations

import shlex
import sys
from argparse import ArgumentParser, Namespace
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from shootstab.cli import commands, figures, values
from shootstab.cli.selection import SORTS
from shootstab.core.allowance import Allowance
from shootstab.core.allowed import DOUBLE_DIGITS, VERDICT_DIGITS
from shootstab.core.errors import ConvergenceError, InputError
from shootstab.core.records import CONFIRMED, VERDICTS, Report
from shootstab.io import scenes as scene_files
from shootstab.io.conventions import Convention
from shootstab.io.files import write_text

if TYPE_CHECKING:
    from rich.console import RenderableType

    from shootstab.analyses.eigenfunction_double import Eigenfunction
    from shootstab.analyses.proved_verdicts import ProvedVerdict
    from shootstab.cli.page import Page
    from shootstab.core.progress import Progress

SEARCH_SECONDS = 10.0  # chosen: processor time for what claims that are no modes may mean; it is a proposal, and nobody asked for it
UNITS_SHARE = 0.4  # chosen: the part of it that units may take, before parameters are tried
SHAPES = 3  # chosen: eigenfunctions on a page, those that grow most; each takes about as long as its verdict


def options(command: ArgumentParser) -> None:
    """What `verify` may be told."""
    formats = "csv, text, json, npy, npz, MATLAB, HDF5 or Legolas"
    command.add_argument("eigenvalues", nargs="?", metavar="EIGENVALUES", help=f"{formats} (default: the bundled reference)")
    command.add_argument("--dataset", metavar="NAME", help="the array that is meant, in a file that holds several")
    command.add_argument("--row", type=values.integer(1), metavar="N", help="the spectrum that is meant, in an array of several")
    values.counted(command, "--digits", 1, DOUBLE_DIGITS, VERDICT_DIGITS, "digits that an eigenvalue must have")
    command.add_argument("--prove", action="store_true", help="prove what is confirmed, and that nothing lies near what is spurious")
    command.add_argument("--strict", action="store_true", help="`continuum` is bad news too")
    shown = f"show these only: bad, {', '.join(VERDICTS)}"
    command.add_argument("--only", choices=("bad", *VERDICTS), metavar="VERDICT", help=f"{shown}; bad: all but confirmed and continuum")
    command.add_argument("--sort", choices=SORTS, help="the order of the table (default: that of the file)")
    figures.options(command, "draw the complex plane")
    command.add_argument("-M", dest="truncation", type=values.integer(0), metavar="N", help="truncation of the bundled reference")
    command.add_argument("--region", type=values.numbers(4), metavar="RE0,IM0,RE1,IM1", help="look for missing modes in this rectangle")
    wishes = "none, within the claims (the default for a list), or in the --region"
    command.add_argument("--missing", choices=("none", "within", "region"), help=f"where missing modes are looked for: {wishes}")
    command.add_argument("--unstable", action="store_true", help="count all growing modes too, wherever they are")
    command.add_argument(
        "--example", action="store_true", help="the spectrum that comes with shootstab for this scene (low): one of each verdict"
    )
    values.shared_out(command, "one a core where that saves time")
    command.add_argument("--html", type=Path, metavar="FILE", help="a page with all of it, in one file that needs no network")
    command.add_argument("--markdown", type=Path, metavar="FILE", help="the table in Markdown")
    command.add_argument("--tex", type=Path, metavar="FILE", help="the table as a LaTeX tabular")


def verify(options: Namespace) -> int:
    """A verdict on each eigenvalue in the file, or on those of the bundled reference."""
    from shootstab.cli.terminal import progress
    from shootstab.io import documents, examples, readers

    if options.eigenvalues is not None and options.truncation is not None:
        raise InputError("-M is the truncation of the bundled reference: allowed only without EIGENVALUES")
    look = commands.look(options)
    for name in ("dataset", "row"):
        if getattr(options, name) is not None and options.eigenvalues is None:
            raise InputError(f"--{name}: allowed only with EIGENVALUES")
    convention = commands.convention(options)
    if options.unstable and convention.unit.imag != 0.0:
        raise InputError(f"--unstable: allowed with growth rates only, not with --as {convention.kind}")
    if options.prove and not convention.plain:
        raise InputError("--prove: allowed with eigenvalues in the problem's own terms")
    if options.html is not None:
        from shootstab.cli import page

        page.require(options.html)
    region = None if options.region is None else commands.rectangle(options.region)
    source = options.eigenvalues
    if options.example:
        source = examples.path_for(options.scene, source)
    spectrum = None if source is None else readers.read(source, options.dataset, options.row)
    given = None if spectrum is None else convention.read(spectrum)
    own = commands.loaded(options.scene)
    scene = own.seen(convention)
    if options.prove:
        from shootstab.analyses.enclosables import factors

        factors(own.problem)  # what has no enclosure is refused before anything is computed
    with progress(f"verifying {scene.name}") as told:
        from shootstab.analyses.missing import unstable_box
        from shootstab.analyses.reference import claims
        from shootstab.analyses.verify import verify as question

        if given is None:
            claimed = claims(own.problem, options.digits, options.truncation)
            # the reference claims that these are modes, not that there are no others
            if options.missing is None:
                region = region or (unstable_box(own.problem, claimed.tolist(), options.digits) if convention.plain else None)
            given = (claimed / convention.unit).tolist()
        wishes: Any = {
            "digits": options.digits,
            "region": region,
            "unstable": options.unstable,
            "missing": options.missing,
            "atol": options.atol,
            "workers": options.workers,
            "cluster": options.dask,
        }
        report = question(scene.problem, given, progress=told, **wishes)
        theorems: tuple[ProvedVerdict, ...] = ()
        if options.prove:
            from shootstab.analyses.proved_verdicts import proved_verdicts

            theorems = proved_verdicts(scene.problem, report, told)
    meant = _meant(options, report, own, scene, convention)
    report = convention.shown(replace(report, dropped=0 if spectrum is None else spectrum.dropped))
    if options.plot is not None:
        from shootstab.cli import plots

        plots.save(report, scene, options.plot, look)

    _write_tables(options, report, scene)
    if options.html is not None:
        with progress(f"solving for the modes of {scene.name}") as told:
            made = _page(report, scene, told)
        with progress(f"writing {options.html.name}"):
            page.save(made, options.html)

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
    commands.answer(options, document, tables, scene)
    bad = report.strictly_bad_news if options.strict else report.bad_news
    return commands.BAD_NEWS if bad or any(theorem.contradicts for theorem in theorems) else commands.DONE


def _meant(options: Namespace, report: Report, own: scene_files.Scene, scene: scene_files.Scene, convention: Convention) -> list[str]:
    """What claims none of which is a mode may have meant, in sentences: other numbers, or those of another run."""
    if any(v.verdict == CONFIRMED for v in report.verdicts):
        return []
    from shootstab.analyses.hypotheses import hypotheses
    from shootstab.analyses.other_parameters import other_values
    from shootstab.cli import variations
    from shootstab.cli.proposals import factors_tried, sentence
    from shootstab.cli.terminal import progress

    alpha = own.wavenumber and own.wavenumber[1]
    allowance = Allowance(SEARCH_SECONDS)
    with progress(f"no claim confirmed for {scene.name}: looking for what the claims mean"):
        with allowance.share(UNITS_SHARE) as part:
            found = hypotheses(scene.problem, report, options.digits, factors_tried(convention, alpha), part)
        if found:
            return [sentence(one, convention, alpha) for one in found]
        given = own, convention, options.alpha is None
        varied, both = variations.variations(*given), variations.together(*given)
        searched = other_values(varied, report, options.digits, allowance, both)
        if not searched.found:
            return variations.without_success(searched, report, SEARCH_SECONDS if allowance.stopped else None)
        return [variations.sentence(one) for one in searched.found]


def _write_tables(options: Namespace, report: Report, scene: scene_files.Scene) -> None:
    """--markdown and --tex."""
    from shootstab.cli import exports

    for path, made in ((options.markdown, exports.markdown), (options.tex, exports.latex)):
        if path is not None:
            write_text(path, made(report, scene))


def _page(report: Report, scene: scene_files.Scene, progress: Progress | None) -> Page:
    """The page, with the modes refined and the eigenfunctions of the fastest growing ones."""
    from shootstab.analyses.eigenspace import eigenspace
    from shootstab.analyses.refine import refine
    from shootstab.cli import page, plane

    sigmas = [complex(v.sigma) for v in report.verdicts if v.sigma is not None] + [complex(m.sigma) for m in report.missing]
    sigmas = sorted(dict.fromkeys(sigmas), key=lambda s: -(plane.unit(scene) * s).real)
    told = progress or (lambda done, total: None)
    refined = []
    for sigma in sigmas:
        refined.append(refine(scene.problem, sigma))
        told(len(refined), len(sigmas) + SHAPES)
    modes = [mode for mode in refined if mode.converged]
    shapes: list[Eigenfunction] = []
    left_out = [f"No error budget of the mode at {complex(mode.sigma):.6g}: {mode.status}." for mode in refined if not mode.converged]
    for i, mode in enumerate(modes[:SHAPES]):
        told(len(sigmas) + i, len(sigmas) + SHAPES)
        try:
            shapes += eigenspace(scene.problem, mode).basis
        except (InputError, ConvergenceError) as error:
            left_out.append(f"No eigenfunction of the mode at {complex(mode.sigma):.6g}: {error}.")
    if len(modes) > SHAPES:
        left_out.append(f"Eigenfunctions are shown of the {SHAPES} fastest growing of {len(modes)} modes: `shootstab mode` shows any.")
    return page.Page(report, scene, modes, shapes, left_out, shlex.join(["shootstab", *sys.argv[1:]]))
