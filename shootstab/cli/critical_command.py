"""`shootstab critical`: where, over all values of one parameter, a mode begins to grow as another rises.

JSON: {"critical": {NAME: "...", NAME: "...", "errors": {NAME: …, NAME: …}, "sigma": {"re", "im"}}}, with the names of both parameters.
"""

from __future__ import annotations

import argparse
import re
from argparse import Namespace
from collections.abc import Callable
from typing import TYPE_CHECKING

from shootstab.cli.commands import DONE, answer, loaded
from shootstab.core.errors import InputError

if TYPE_CHECKING:
    from rich.console import RenderableType

    from shootstab.problems.protocol import Problem


def options(parser: argparse.ArgumentParser, guess: Callable[[str], complex]) -> None:
    """Add what `critical` takes."""
    rising = "a parameter with which modes come to grow, and a value near the critical one"
    parser.add_argument("--parameter", type=_named, required=True, metavar="NAME=X", help=rising)
    parser.add_argument("--over", type=_named, required=True, metavar="NAME=X", help="the parameter over which growth is largest, likewise")
    parser.add_argument("--guess", type=guess, required=True, metavar="RE[,IM]", help="the mode there")


def critical(options: Namespace) -> int:
    """The critical point of a scene in equations."""
    scene = loaded(options.scene)
    from shootstab.analyses.critical import critical as question
    from shootstab.cli.terminal import progress
    from shootstab.io.notation import as_strings, held
    from shootstab.problems.capabilities import WITH_PARAMETERS

    with_parameters = WITH_PARAMETERS.required(scene.problem)
    (rising, near), (other, beside) = options.parameter, options.over
    if rising == other:
        raise InputError(f"--parameter and --over name {rising}: allowed are two parameters")

    def family(value: float, along: complex) -> Problem:
        made: Problem = with_parameters({rising: value, other: along})
        return made

    with progress(f"following the mode of {scene.name}"):
        found = question(family, near, beside, options.guess)
    values = {rising: (found.reynolds, found.reynolds_error), other: (found.alpha, found.alpha_error)}
    document = {
        "critical": {
            **{name: repr(value) for name, (value, _) in values.items()},
            "errors": {name: error for name, (_, error) in values.items()},
            "sigma": as_strings(found.sigma, 0.0),
        }
    }

    def tables() -> list[RenderableType]:
        from rich.table import Table

        from shootstab.cli.tables import heading

        grid = Table.grid(padding=(0, 2))
        for name, (value, error) in values.items():
            grid.add_row(name, held(value, error), f"± {error:.1e}")
        grid.add_row(scene.symbol, f"{found.sigma.imag:.10g}i", "there: the growth rate is 0, and largest")
        return [heading(scene), grid]

    answer(options, document, tables, scene)
    return DONE


def _named(text: str) -> tuple[str, float]:
    from shootstab.io.notation import floats_from

    name, equals, value = text.partition("=")
    try:
        if not equals or not re.fullmatch(r"[^\W\d]\w*", name):
            raise ValueError
        return name, floats_from(value, 1)[0]
    except ValueError:
        raise argparse.ArgumentTypeError(f"{text!r}: allowed is NAME=X with a number X") from None
