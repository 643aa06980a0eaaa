"""The command line: what may be asked, and what the exit status says.

0: done, no bad news. 1: bad news. 2: bad input. 3: an error of the program, whose traceback lies in a file. 4: an answer that could not be
written. Each but 0 says one line on standard error. Nothing heavy is imported here, so that help and refusals come at once.
"""

from __future__ import annotations

import argparse
import errno
import os
import re
import sys
from collections.abc import Callable, Sequence
from contextlib import suppress
from pathlib import Path
from typing import Any, NoReturn

from shootstab import __version__
from shootstab.cli import commands, explain_command, guide_command, prove_command, signals, streams
from shootstab.cli import sweep_command as sweeping
from shootstab.cli import trade_command as trading
from shootstab.cli.help import DOORS, STATUSES, epilog, with_nearest
from shootstab.cli.selection import SORTS
from shootstab.core.errors import InputError, OutputError, ShootstabError
from shootstab.core.records import VERDICTS
from shootstab.core.threads import one_thread_from_here
from shootstab.io.notation import complex_from, floats_from

# defined by the contract: exit statuses of a command that did not; the last two are 128 plus the signal
BAD_INPUT, INTERNAL, NOT_WRITTEN, INTERRUPTED, BROKEN_PIPE = 2, 3, 4, 130, 141
FULL = (errno.ENOSPC, errno.EDQUOT, errno.EFBIG, errno.EIO, errno.EBADF)  # what a stream says that takes no more
SCENE_HELP = "a built-in name (see `shootstab scenes`), a TOML file, or module:object"


def main(argv: Sequence[str] | None = None) -> int:
    """Run one command; the exit status."""
    streams.prepare()
    one_thread_from_here()
    words = _with_values(sys.argv[1:] if argv is None else argv)
    try:
        if not words:
            print(DOORS)
            return commands.DONE
        options = parser().parse_args(words)
        commands.prepare(options)
        with signals.raised():
            status: int = options.run(options)
            sys.stdout.flush()
        return status
    except InputError as error:
        return _say(error, BAD_INPUT)
    except OutputError as error:
        return _say(error, NOT_WRITTEN)
    except ShootstabError as error:
        return _say(error, commands.BAD_NEWS)
    except signals.Ended as ended:
        return _say(ended, ended.status)
    except KeyboardInterrupt:
        return _say("interrupted", INTERRUPTED)
    except BrokenPipeError:
        # whoever read has gone; keep Python from flushing into the broken pipe at exit
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return BROKEN_PIPE
    except OSError as error:
        if error.errno not in FULL:
            return _internal(error)
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return _say(f"the answer could not be written: {error.strerror}", NOT_WRITTEN)
    except Exception as error:
        return _internal(error)


def _internal(error: Exception) -> int:
    """One line, and the traceback in a file: what went wrong is not the user's doing."""
    import tempfile
    import traceback

    with tempfile.NamedTemporaryFile("w", prefix="shootstab-", suffix=".traceback", delete=False, encoding="utf-8") as file:
        file.write(f"shootstab {__version__}: {' '.join(sys.argv[1:])}\n")
        traceback.print_exception(error, file=file)
    return _say(f"internal error: {type(error).__name__}: {error} (the traceback is in {file.name})", INTERNAL)


def _say(error: object, status: int) -> int:
    with suppress(OSError):  # nobody listens: the status says it
        print("shootstab:", " ".join(str(error).split()), file=sys.stderr, flush=True)
    return status


class _Parser(argparse.ArgumentParser):
    """An ArgumentParser that refuses in one line, by the same way as everything else."""

    def __init__(self, **settings: Any) -> None:
        super().__init__(**{"allow_abbrev": False, "formatter_class": argparse.RawDescriptionHelpFormatter, **settings})

    def error(self, message: str) -> NoReturn:
        raise InputError(f"{with_nearest(message, self._all_options())} (see {self.prog} --help)")

    def exit(self, status: int = 0, message: str | None = None) -> NoReturn:
        sys.stdout.flush()  # help and version too are answers that may not be written
        super().exit(status, message)

    def _all_options(self) -> list[str]:
        """The options of this command and of those below it."""
        found = list(self._option_string_actions)
        for action in self._actions:
            if isinstance(action, argparse._SubParsersAction):
                found += [option for below in action.choices.values() for option in below._option_string_actions]
        return sorted(set(found))


class _Version(argparse.Action):
    def __init__(self, option_strings: Sequence[str], dest: str, help: str | None = None) -> None:
        super().__init__(option_strings, dest, nargs=0, help=help)

    def __call__(self, parser: argparse.ArgumentParser, *_: object) -> NoReturn:
        print("shootstab", __version__)
        parser.exit()


def parser() -> argparse.ArgumentParser:
    """All commands and their options."""
    top = _Parser(prog="shootstab", description=DOORS, epilog=STATUSES)
    top.add_argument("--version", action=_Version, help="show the version and stop")
    subparsers = top.add_subparsers(dest="command", required=True, metavar="COMMAND")

    verify = _command(subparsers, commands.verify, "a verdict on each eigenvalue, and the modes that are missing")
    formats = "csv, text, json, npy, npz, MATLAB, HDF5 or Legolas"
    verify.add_argument("eigenvalues", nargs="?", metavar="EIGENVALUES", help=f"{formats} (default: the bundled reference)")
    verify.add_argument("--dataset", metavar="NAME", help="the array that is meant, in a file that holds several")
    verify.add_argument("--row", type=_integer(1, 999_999_999), metavar="N", help="the spectrum that is meant, in an array of several")
    _convention(verify)
    verify.add_argument("--digits", type=_integer(1, 12), default=6, metavar="N", help="digits that an eigenvalue must have (default 6)")
    verify.add_argument("--prove", action="store_true", help="prove what is confirmed, and that nothing lies near what is spurious")
    verify.add_argument("--strict", action="store_true", help="`continuum` is bad news too")
    verify.add_argument("--only", choices=("bad", *VERDICTS), help="show these verdicts only; bad: all but confirmed and continuum")
    verify.add_argument("--sort", choices=SORTS, help="the order of the table (default: that of the file)")
    verify.add_argument("--plot", type=_plot_path, metavar="FILE", help="draw the complex plane into a png, pdf or svg file")
    verify.add_argument("-M", dest="truncation", type=_integer(0, 999_999), metavar="N", help="truncation of the bundled reference")
    verify.add_argument("--region", type=_numbers(4), metavar="RE0,IM0,RE1,IM1", help="look for missing modes in this rectangle")
    wishes = "none, within the claims (the default for a list), or in the --region"
    verify.add_argument("--missing", choices=("none", "within", "region"), help=f"where missing modes are looked for: {wishes}")
    verify.add_argument("--unstable", action="store_true", help="count all growing modes too, wherever they are")

    refine = _command(subparsers, commands.refine, "one mode, with its error bar")
    _convention(refine)
    refine.add_argument("--guess", type=_guess, required=True, metavar="RE[,IM]", help="where to start")
    accuracy = refine.add_mutually_exclusive_group()
    accuracy.add_argument("--rtol", type=_tolerance, default=1e-10, metavar="X", help="relative accuracy asked for (default 1e-10)")
    accuracy.add_argument("--digits", type=_integer(1, 100_000), metavar="N", help="the same in digits")
    refine.add_argument("--method", choices=commands.METHOD_NAMES, help="how the determinant is formed (default: as the program chooses)")

    count = _command(subparsers, commands.count, "how many modes a region of the complex plane holds")
    _add_region(count, "rectangle", "disc", "polygon", "half-plane")
    count.add_argument("--floor", type=_numbers(1), metavar="X", help="of the half-plane: Re σ > X (default 1e-8)")

    find = _command(subparsers, commands.find, "all modes in a region, without a guess")
    _add_region(find, "rectangle", "disc", "polygon", default="rectangle")
    for command in (verify, refine, find):
        says = "absolute accuracy that suffices, for modes next to 0 (default 1e-12 of the scale of D there)"
        command.add_argument("--atol", type=_absolute, metavar="X", help=says)
    find.add_argument("--resonances", action="store_true", help="list zeros beyond the continuous spectrum too")

    _command(subparsers, explain_command.explain, "what the reduction of the scene's equations found")

    _command(subparsers, commands.steady, "the steady flow of the scene")

    spectrum = _command(subparsers, commands.spectrum, "the pseudospectral spectrum")
    spectrum.add_argument("-M", dest="truncation", type=_integer(0, 999_999), metavar="N", help="truncation")
    spectrum.add_argument("--raw", action="store_true", help="all eigenvalues of the pencil, unfiltered")

    sweep = _command(subparsers, sweeping.sweep, "growth rates over wavenumbers or flows, in parallel, resumable")
    sweeping.options(sweep, _integer, _plot_path)

    trade = _command(subparsers, trading.trade, "work against accuracy of every method")
    trading.options(trade, _guess, _plot_path)

    prove = _command(subparsers, prove_command.prove, "a theorem: exactly so many eigenvalues in a disc, a rectangle, or growing")
    prove_command.options(prove, _guess, _numbers, _integer)
    check = _command(subparsers, prove_command.check, "whether a certificate proves what it says", scene=False)
    check.add_argument("file", type=Path, metavar="FILE", help="a certificate of `shootstab prove --certificate`")

    _command(subparsers, commands.scenes, "what is built in", scene=False)

    guide = subparsers.add_parser("guide", help="the manual", description="A page of the manual, or a list of all.", epilog=epilog("guide"))
    guide.set_defaults(run=guide_command.guide, json=None, quiet=False)
    guide.add_argument("topic", nargs="?", metavar="TOPIC", help="the page")
    return top


def _command(subparsers: Any, run: Callable[[argparse.Namespace], int], says: str, scene: bool = True) -> argparse.ArgumentParser:
    """A command, named after the function that runs it."""
    title = says[0].upper() + says[1:] + "."
    made: argparse.ArgumentParser = subparsers.add_parser(run.__name__, help=says, description=title, epilog=epilog(run.__name__))
    made.set_defaults(run=run)
    if scene:
        made.add_argument("scene", metavar="SCENE", help=SCENE_HELP)
    made.add_argument("--json", metavar="FILE", help="write the answer as JSON; - is standard output, which then holds nothing else")
    made.add_argument("--quiet", action="store_true", help="no table: the exit status and the files asked for are the answer")
    return made


def _add_region(command: argparse.ArgumentParser, *shapes: str, default: str | None = None) -> None:
    """The options that name a region of the σ-plane."""
    says = "the shape" if default is None else f"the shape (default {default})"
    command.add_argument("--region", choices=shapes, required=default is None, default=default, help=says)
    corners = "RE,IM of a polygon's corners, three or more, or of a rectangle's lower left and upper right"
    command.add_argument("--corners", type=_numbers(), metavar="RE0,IM0,RE1,IM1,…", help=corners)
    command.add_argument("--centre", type=_numbers(2), metavar="RE,IM", help="of the disc")
    command.add_argument("--radius", type=_numbers(1), metavar="R", help="of the disc")


def _convention(command: argparse.ArgumentParser) -> None:
    """What the numbers mean that are given and shown (see conventions.py)."""
    group = command.add_argument_group("what an eigenvalue is", "by default the problem's own, σ of exp(σt)")
    group.add_argument("--as", dest="kind", choices=("growth", "frequency", "phase-speed"), help="σ, ω or c")
    group.add_argument("--alpha", type=_numbers(1), metavar="X", help="the wavenumber, for a phase speed")
    group.add_argument("--sign", choices=("+", "-"), help="of time in the exponent: + for a growth rate, - for ω and c by default")
    group.add_argument("--conjugate", action="store_true", help="waves are exp(-iαx)")
    group.add_argument("--length", type=_numbers(1), metavar="X", help="the unit of length of these numbers, in that of the problem")
    group.add_argument("--velocity", type=_numbers(1), metavar="X", help="the unit of velocity, likewise")


def _with_values(argv: Sequence[str]) -> list[str]:
    """Join an option to a value that begins with a minus sign, which argparse would take for an option: --guess -0.1,0.2."""
    joined: list[str] = []
    for word in argv:
        if joined and re.fullmatch(r"--[a-z]+", joined[-1]) and re.match(r"-([\d.]|$)", word):
            joined[-1] += f"={word}"
        else:
            joined.append(word)
    return joined


# the values of options, refused in words


def _refused(text: str, allowed: str) -> argparse.ArgumentTypeError:
    return argparse.ArgumentTypeError(f"{text!r}: allowed is {allowed}")


def _integer(least: int, most: int) -> Callable[[str], int]:
    def parse(text: str) -> int:
        if not re.fullmatch(r"\d{1,9}", text, re.ASCII) or not least <= int(text) <= most:
            raise _refused(text, f"an integer from {least} to {most}")
        return int(text)

    return parse


def _numbers(count: int | None = None) -> Callable[[str], tuple[float, ...]]:
    def parse(text: str) -> tuple[float, ...]:
        try:
            return floats_from(text, count)
        except ValueError:
            wanted = "finite numbers" if count is None else f"{count} finite numbers"
            raise _refused(text, "a finite number" if count == 1 else f"{wanted} with commas between them") from None

    return parse


def _guess(text: str) -> complex:
    try:
        if "," in text:
            return complex(*floats_from(text, 2))
        guess = complex_from(text)
    except ValueError:
        guess = complex("nan")
    if guess - guess != 0:
        raise _refused(text, "RE, RE,IM or RE+IMi, finite")
    return guess


def _tolerance(text: str) -> float:
    value = _numbers(1)(text)[0]
    if not 1e-14 <= value <= 0.1:
        raise _refused(text, "a number from 1e-14 to 0.1")
    return value


def _absolute(text: str) -> float:
    value = _numbers(1)(text)[0]
    if not value >= 0.0:
        raise _refused(text, "a finite number from 0 on")
    return value


def _plot_path(text: str) -> Path:
    path = Path(text)
    if path.suffix.lower() not in (".png", ".pdf", ".svg"):
        raise _refused(text, "a file name that ends in .png, .pdf or .svg")
    return path


if __name__ == "__main__":
    sys.exit(main())
