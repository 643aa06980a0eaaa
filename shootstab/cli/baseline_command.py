"""`shootstab baseline record` and `check`: modes that are proved once, and compared with from then on."""

from __future__ import annotations

from argparse import ArgumentParser, Namespace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from shootstab.cli import commands, values
from shootstab.core.allowed import BASELINE_DIGITS, DOUBLE_DIGITS
from shootstab.core.errors import ConvergenceError, InputError
from shootstab.core.numerus import number_of
from shootstab.io import scenes as scene_files

if TYPE_CHECKING:
    from shootstab.io.baselines import Baseline


def record_options(command: ArgumentParser) -> None:
    """What `record` may be told."""
    command.add_argument("file", type=Path, metavar="FILE", help="the baseline to write")
    command.add_argument("--guess", type=values.guess, action="append", metavar="RE[,IM]", help="a mode; may be given several times")
    command.add_argument("--from", dest="source", metavar="EIGENVALUES", help="a file with a guess of each mode")
    values.counted(command, "--digits", 1, DOUBLE_DIGITS, BASELINE_DIGITS, "digits to be compared")


def check_options(command: ArgumentParser) -> None:
    """What `check` may be told."""
    command.add_argument("file", type=Path, metavar="FILE", help="a baseline")
    command.add_argument("eigenvalues", nargs="?", metavar="EIGENVALUES", help="your spectrum (default: the modes are computed again)")


def record(options: Namespace) -> int:
    """Prove modes and write them down."""
    from shootstab.io import baselines, readers
    from shootstab.io.files import require_writable

    require_writable(options.file)
    guesses = [*(options.guess or []), *([] if options.source is None else readers.read(options.source))]
    if not guesses:
        raise InputError("no modes: needed is --guess or --from")
    scene = commands.loaded(options.scene)
    modes = _modes(scene, guesses, options.digits)
    for mode in modes:
        if not mode.converged:
            raise ConvergenceError(f"no mode to {options.digits} digits at {complex(mode.sigma):.12g}: {mode.status}")
    pairs = [(complex(mode.sigma), float(mode.error)) for mode in modes]
    baseline = baselines.Baseline.of(options.scene, pairs, options.digits, scene.symbol)
    baselines.save(baseline, options.file)
    commands.answer(options, {"baseline": str(options.file), "modes": len(baseline.modes)}, lambda: [_said(baseline)], scene)
    return commands.DONE


def check(options: Namespace) -> int:
    """Compare a spectrum, or the modes computed again, with a baseline."""
    from shootstab.io import baselines, readers

    baseline = baselines.load(options.file)
    scene = None
    if options.eigenvalues is None:
        scene = commands.loaded(baseline.scene)
        modes = _modes(scene, [sigma for sigma, _ in baseline.modes], baseline.digits)
        found = [complex(mode.sigma) for mode in modes if mode.converged]
    else:
        found = list(readers.read(options.eigenvalues))
    differences = baseline.differences(found)
    bad = [difference for difference in differences if not difference.holds]
    document = {
        "baseline": str(options.file),
        "digits": baseline.digits,
        "modes": [{"recorded": str(d.recorded), "found": None if d.found is None else str(d.found), "holds": d.holds} for d in differences],
    }

    def lines() -> list[Any]:
        from shootstab.cli.tables import paragraph

        holding = len(differences) - len(bad)
        what = f"{holding} of {number_of(len(differences), 'mode')} of {options.file}"
        said = f"{what} hold{'s' * (holding == 1)} to {number_of(baseline.digits, 'digit')}."
        return [paragraph(line) for line in (*(f"drifted  {difference.line}" for difference in bad), said)]

    commands.answer(options, document, lines, scene)
    return commands.BAD_NEWS if bad else commands.DONE


def _modes(scene: scene_files.Scene, guesses: list[complex], digits: int) -> list[Any]:
    from shootstab.analyses.refine import refine
    from shootstab.cli.terminal import progress

    modes = []
    with progress(f"refining modes of {scene.name}") as told:
        for guess in guesses:
            modes.append(refine(scene.problem, guess, 10.0**-digits))
            if told is not None:
                told(len(modes), len(guesses))
    return modes


def _said(baseline: Baseline) -> str:
    return f"{number_of(len(baseline.modes), 'mode')} of {baseline.scene}, to {number_of(baseline.digits, 'digit')}."
