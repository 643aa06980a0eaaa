"""What can go wrong, said to the user."""

from __future__ import annotations

from typing import Any

QUOTED = 40  # chosen: characters of a value that a refusal quotes
LISTED = 200  # chosen: characters of a list of what there is, in a refusal


class ShootstabError(Exception):
    """Base of all errors that shootstab raises on purpose; its text is one line meant for the user."""


class InputError(ShootstabError, ValueError):
    """The input is wrong: the text says what, where, and what is allowed. The command line exits with status 2."""


class OutputError(ShootstabError):
    """An answer could not be written: the text says where and why. The command line exits with status 4."""


class NoFlowError(InputError):
    """No steady flow exists for these parameters."""


class ConvergenceError(ShootstabError):
    """A computation did not reach what was asked of it; the text says how far it came."""


class Undecidable(ConvergenceError):  # noqa: N818 - it is a finding, not a fault
    """D cannot be continued over a part of the σ-plane, for the reason given: a continuous spectrum is in the way."""


def anew(error: ConvergenceError) -> ConvergenceError:
    """The same error, raised nowhere yet.

    An error that was raised holds the frames that it came through, and so all that was computed in them. Where one of these frames holds
    the error in turn, both stay in memory until the garbage is collected.
    """
    fresh = type(error).__new__(type(error), *error.args)
    fresh.__dict__.update(error.__dict__)
    return fresh


def shortened(value: Any, longest: int = QUOTED) -> str:
    """A value as a refusal quotes it: its repr, not longer than a line can bear; of one that has none, what it is."""
    try:
        text = repr(value)
    except (ValueError, RecursionError):  # an integer of thousands of digits, a list a thousand deep
        text = f"a {type(value).__name__} too large to be shown"
    return text if len(text) <= longest else text[:longest] + "…"


class Inaccurate(ConvergenceError):  # noqa: N818 - it is a finding, not a fault
    """D on its mesh is not accurate enough for a count of so small a region."""


class OnSpectrum(Undecidable, Inaccurate):
    """A zero of D lies on a continuous spectrum to the error with which it is known; on a finer mesh it may lie beside it."""
