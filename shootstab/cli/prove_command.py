"""`shootstab prove` and `shootstab check`: a theorem on an eigenvalue, its certificate, and the checker of certificates."""

from __future__ import annotations

import argparse
from argparse import Namespace
from collections.abc import Callable, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Any

from shootstab.cli.commands import BAD_NEWS, DONE, answer, loaded
from shootstab.cli.values import counted, integer
from shootstab.core.allowed import MOST_PROOF_DIGITS, MOST_WORKERS, PROOF_DIGITS
from shootstab.core.errors import InputError
from shootstab.core.half_annulus import HalfAnnulus
from shootstab.core.regions import Rectangle
from shootstab.io import documents
from shootstab.io.files import require_writable, write_whole

if TYPE_CHECKING:
    from rich.console import RenderableType


def options(parser: argparse.ArgumentParser, guess: Callable[[str], complex], numbers: Any) -> None:
    """Add what `prove` takes."""
    what_for = "--guess | a region | --growing"
    parser.usage = f"{parser.prog} [options] SCENE ({what_for})"  # its own would not fit on a page
    what = parser.add_mutually_exclusive_group(required=True)
    what.add_argument("--guess", type=guess, metavar="RE[,IM]", help="exactly one eigenvalue in a small disc about the mode next to it")
    what.add_argument("--disc", type=numbers(3), metavar="RE,IM,R", help="how many eigenvalues lie in this disc")
    what.add_argument("--region", type=numbers(4), metavar="RE0,IM0,RE1,IM1", help="how many lie in this rectangle")
    what.add_argument(
        "--half-annulus", type=numbers(4), metavar="RE,IM,R0,R1", help="how many have a distance from R0 to R1 to this point, to its right"
    )
    what.add_argument("--growing", type=numbers(1), metavar="X", help="how many have Re σ ≥ X, where a theorem bounds all of them")
    parser.add_argument("--over", metavar="NAME=LOW,HIGH", help="for every value of this parameter; beside --region and --growing")
    counted(parser, "--digits", 1, MOST_PROOF_DIGITS, PROOF_DIGITS, "of the disc about the mode")
    parser.add_argument("--workers", type=integer(1, MOST_WORKERS), metavar="N", help="processes that share a region (default: the cores)")
    parser.add_argument("--certificate", type=Path, metavar="FILE", help="write the certificate, for `shootstab check`")


def prove(options: Namespace) -> int:
    """A theorem on one eigenvalue or on all in a region."""
    if options.certificate is not None:
        if options.half_annulus is not None or options.over is not None:
            raise InputError("--certificate: allowed with --guess, --disc, --region and --growing, for one value of the parameters")
        require_writable(options.certificate)
    parameter = None if options.over is None else _interval(options)
    scene = loaded(options.scene)
    if options.certificate is not None:
        from shootstab.analyses.certificate import certify, require_checker

        require_checker(scene.problem, options.region is not None)
    from shootstab.analyses import prove as proofs
    from shootstab.cli.terminal import progress

    with progress(f"proving {scene.name}") as told:
        if parameter is not None:
            rectangle = None if options.region is None else _rectangle(options.region)
            floor = None if options.growing is None else options.growing[0]
            found = proofs.prove_interval(scene.problem, *parameter, rectangle, floor, told)
        elif options.guess is not None:
            found = proofs.prove(scene.problem, options.guess, options.digits)
        elif options.disc is not None:
            re, im, radius = options.disc
            found = proofs.prove_disc(scene.problem, complex(re, im), radius, progress=told, workers=options.workers)
        elif options.region is not None:
            found = proofs.prove_region(scene.problem, _rectangle(options.region), told, workers=options.workers)
        elif options.half_annulus is not None:
            re, im, inner, outer = options.half_annulus
            region = HalfAnnulus(complex(re, im), inner, outer)
            found = proofs.prove_region(scene.problem, region, told, workers=options.workers)
        else:
            found = proofs.prove_growing(scene.problem, options.growing[0], told)
    if options.certificate is not None:
        with progress(f"writing {options.certificate.name}"):
            text = documents.text(certify(scene.problem, found))
        write_whole(options.certificate, lambda path: path.write_text(text, encoding="utf-8"))

    def tables() -> list[RenderableType]:
        from shootstab.analyses.proof import at_most
        from shootstab.cli.tables import heading, paragraph

        said = [f"Proved: {found.statement}."]
        if found.alone is not None:
            said.append(f"{'It is' if found.count == 1 else 'They are'} alone within {at_most(found.alone, 2)} of there.")
        said.append(
            f"The inequality holds by a factor of {at_most(found.margin, 3)}; {found.evaluations} enclosures of D at {found.bits} bits, "
            f"{found.seconds:.2g} s; lemmas {', '.join(found.lemmas)} of `shootstab guide proofs`."
        )
        return [heading(scene), *map(paragraph, said)]

    answer(options, {"statement": found.statement, "count": found.count, **asdict(found)}, tables, scene)
    return DONE


def _rectangle(numbers: Sequence[float]) -> Rectangle:
    low_re, low_im, high_re, high_im = numbers
    return Rectangle(complex(low_re, low_im), complex(high_re, high_im))


def _interval(options: Namespace) -> tuple[str, float, float]:
    """The parameter and its two values. Raises InputError for what is none."""
    if options.region is None and options.growing is None:
        raise InputError("--over: allowed with --region and --growing")
    name, _, values = options.over.partition("=")
    try:
        low, high = (float(x) for x in values.split(","))
    except ValueError:
        raise InputError(f"--over {options.over}: allowed is NAME=LOW,HIGH") from None
    return name, low, high


def check(options: Namespace) -> int:
    """Whether a certificate proves what it says, found by its checker alone."""
    from shootstab.analyses import certificate
    from shootstab.cli.terminal import progress

    read = certificate.read(options.file)
    with progress(f"checking {options.file.name}"):
        reason = certificate.check(read)

    def tables() -> list[RenderableType]:
        from shootstab.cli.tables import paragraph

        return [paragraph("proved" if reason is None else f"refused: {reason}")]

    answer(options, {"proved": reason is None, "reason": reason}, tables, None)
    return DONE if reason is None else BAD_NEWS
