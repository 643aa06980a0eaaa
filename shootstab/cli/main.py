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
from shootstab.cli import (
    baseline_command,
    commands,
    critical_command,
    explain_command,
    figures,
    guide_command,
    mode_command,
    prove_command,
    signals,
    steady_command,
    streams,
    values,
    verify_command,
)
from shootstab.cli import sweep_command as sweeping
from shootstab.cli import trade_command as trading
from shootstab.cli.help import DOORS, STATUSES, epilog, with_nearest
from shootstab.cli.terminal import Announcement
from shootstab.core import compilation
from shootstab.core.allowed import MOST_DIGITS, RTOL
from shootstab.core.errors import InputError, OutputError, ShootstabError
from shootstab.core.threads import one_thread_from_here
from shootstab.discriminants.named import METHODS

# defined by the contract: exit statuses of a command that did not; the last two are 128 plus the signal
BAD_INPUT, INTERNAL, NOT_WRITTEN, INTERRUPTED, BROKEN_PIPE = 2, 3, 4, 130, 141
FULL = (errno.ENOSPC, errno.EDQUOT, errno.EFBIG, errno.EIO, errno.EBADF)  # what a stream says that takes no more
SCENE_HELP = "a built-in name (see `shootstab scenes`), a TOML file, or module:object"


def _compile_ahead(kernel: str) -> None:
    """Have others compiled beside the first kernel that is; where the cache holds all that is needed, this is never called."""
    from shootstab.kernels.ahead import begin

    begin()


def main(argv: Sequence[str] | None = None) -> int:
    """Run one command; the exit status."""
    streams.prepare()
    one_thread_from_here()
    words = _with_values(sys.argv[1:] if argv is None else argv)
    ended_by: list[signals.Ended] = []
    try:
        if not words:
            print(DOORS)
            return commands.DONE
        options = parser().parse_args(words)
        commands.prepare(options)
        compilation.tell(Announcement())
        compilation.tell(_compile_ahead)
        with signals.raised(ended_by):
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
        return _say(ended_by[0], ended_by[0].status) if ended_by else _internal(error)


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

    verify = _command(subparsers, verify_command.verify, "a verdict on each eigenvalue, and the modes that are missing")
    verify_command.options(verify)
    _convention(verify)

    refine = _command(subparsers, commands.refine, "one mode, with its error bar")
    _convention(refine)
    refine.add_argument("--guess", type=values.guess, required=True, metavar="RE[,IM]", help="where to start")
    accuracy = refine.add_mutually_exclusive_group()
    accuracy.add_argument("--rtol", type=values.tolerance, default=RTOL, metavar="X", help=values.RTOL_HELP)
    accuracy.add_argument("--digits", type=values.integer(1, MOST_DIGITS), metavar="N", help="the same in digits")
    refine.add_argument("--method", choices=METHODS, help="how the determinant is formed (default: as the program chooses)")

    mode = _command(subparsers, mode_command.mode, "the eigenfunction of one mode")
    _convention(mode)
    mode_command.options(mode)

    count = _command(subparsers, commands.count, "how many modes a region of the complex plane holds")
    _add_region(count, "rectangle", "disc", "polygon", "half-plane")
    count.add_argument("--floor", type=values.numbers(1), metavar="X", help="of the half-plane: Re σ > X (default 1e-8)")

    find = _command(subparsers, commands.find, "all modes in a region, without a guess")
    _add_region(find, "rectangle", "disc", "polygon", default="rectangle")
    for command in (verify, refine, find):
        says = "absolute accuracy that suffices, for modes next to 0 (default 1e-12 of the scale of D there)"
        command.add_argument("--atol", type=values.absolute, metavar="X", help=says)
    figures.options(find, "draw the modes and the region")
    values.shared_out(find, "one a core where that saves time")
    find.add_argument("--resonances", action="store_true", help="list zeros beyond the continuous spectrum too")

    critical = _command(subparsers, critical_command.critical, "where a mode begins to grow, over all values of a parameter")
    critical_command.options(critical, values.guess)

    _command(subparsers, explain_command.explain, "what the reduction of the scene's equations found")

    steady_command.options(_command(subparsers, steady_command.steady, "the steady flow of the scene"))

    spectrum = _command(subparsers, commands.spectrum, "the pseudospectral spectrum")
    _convention(spectrum)
    spectrum.add_argument("-M", dest="truncation", type=values.integer(0), metavar="N", help="truncation")
    figures.options(spectrum, "draw the spectrum")
    spectrum.add_argument("--raw", action="store_true", help="all eigenvalues of the pencil, unfiltered")

    sweep = _command(subparsers, sweeping.sweep, "growth rates over wavenumbers or flows, in parallel, resumable")
    sweeping.options(sweep)

    trade = _command(subparsers, trading.trade, "work against accuracy of every method")
    trading.options(trade, values.guess)

    prove = _command(subparsers, prove_command.prove, "a theorem: exactly so many eigenvalues in a disc, a rectangle, or growing")
    prove_command.options(prove, values.guess, values.numbers)
    check = _command(subparsers, prove_command.check, "whether a certificate proves what it says", scene=False)
    check.add_argument("file", type=Path, metavar="FILE", help="a certificate of `shootstab prove --certificate`")

    baseline = subparsers.add_parser(
        "baseline", help="modes that are proved once, and compared with from then on", epilog=epilog("baseline")
    )
    both = baseline.add_subparsers(dest="action", required=True, metavar="record|check")
    baseline_command.record_options(
        _command(both, baseline_command.record, "prove modes and write them into a baseline", example="baseline")
    )
    checked = _command(both, baseline_command.check, "compare a spectrum with a baseline", scene=False, example="baseline")
    baseline_command.check_options(checked)

    _command(subparsers, commands.scenes, "what is built in", scene=False)

    guide = subparsers.add_parser("guide", help="the manual", description="A page of the manual, or a list of all.", epilog=epilog("guide"))
    guide.set_defaults(run=guide_command.guide, json=None, quiet=False)
    guide.add_argument("topic", nargs="?", metavar="TOPIC", help="the page")
    guide.add_argument("--site", type=Path, metavar="FOLDER", help="make a site of all pages")
    return top


def _command(
    subparsers: Any, run: Callable[[argparse.Namespace], int], says: str, scene: bool = True, example: str | None = None
) -> argparse.ArgumentParser:
    """A command, named after the function that runs it, with the example of that name or of another one."""
    title, shown = says[0].upper() + says[1:] + ".", epilog(example or run.__name__)
    made: argparse.ArgumentParser = subparsers.add_parser(run.__name__, help=says, description=title, epilog=shown)
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
    command.add_argument("--corners", type=values.numbers(), metavar="RE0,IM0,RE1,IM1,…", help=corners)
    command.add_argument("--centre", type=values.numbers(2), metavar="RE,IM", help="of the disc")
    command.add_argument("--radius", type=values.numbers(1), metavar="R", help="of the disc")


def _convention(command: argparse.ArgumentParser) -> None:
    """What the numbers mean that are given and shown (see conventions.py)."""
    group = command.add_argument_group("what an eigenvalue is", "by default the problem's own, σ of exp(σt)")
    group.add_argument("--as", dest="kind", choices=("growth", "frequency", "phase-speed"), help="σ, ω or c")
    group.add_argument("--alpha", type=values.numbers(1), metavar="X", help="the wavenumber, for a phase speed")
    group.add_argument("--sign", choices=("+", "-"), help="of time in the exponent: + for a growth rate, - for ω and c by default")
    group.add_argument("--conjugate", action="store_true", help="waves are exp(-iαx)")
    group.add_argument("--length", type=values.numbers(1), metavar="X", help="the unit of length of these numbers, in that of the problem")
    group.add_argument("--velocity", type=values.numbers(1), metavar="X", help="the unit of velocity, likewise")


def _with_values(argv: Sequence[str]) -> list[str]:
    """Join an option to a value that begins with a minus sign, which argparse would take for an option: --guess -0.1,0.2."""
    joined: list[str] = []
    for word in argv:
        if joined and re.fullmatch(r"--[a-z]+", joined[-1]) and re.match(r"-([\d.]|$)", word):
            joined[-1] += f"={word}"
        else:
            joined.append(word)
    return joined


if __name__ == "__main__":
    sys.exit(main())
