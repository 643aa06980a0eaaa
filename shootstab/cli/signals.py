"""Signals that ask the program to end, raised as exceptions: on the way out files that are half written go, workers end, and the terminal
gets its cursor back.
"""

from __future__ import annotations

import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType

ENDING_SIGNALS = ("SIGTERM", "SIGHUP")  # SIGINT is Python's own KeyboardInterrupt
SIGNAL_STATUS = 128  # defined by the shell: the exit status of a program that a signal ended, less its number


class Ended(KeyboardInterrupt):
    """A signal asked the program to end; the exit status that a shell shows for it is 128 and its number."""

    def __init__(self, number: int) -> None:
        super().__init__(f"ended by {signal.Signals(number).name}")
        self.status = SIGNAL_STATUS + number


@contextmanager
def raised(received: list[Ended]) -> Iterator[None]:
    """While a command runs. A signal that is ignored, as nohup ignores SIGHUP, or that the caller handles himself is left to him.

    What was raised is put into received too: a library that is interrupted may end in an exception of its own.
    """

    def _end(number: int, _: FrameType | None) -> None:
        """The second of its kind ends the program at once."""
        signal.signal(number, signal.SIG_DFL)
        received.append(Ended(number))
        raise received[-1]

    numbers = [getattr(signal, name) for name in ENDING_SIGNALS if hasattr(signal, name)]
    mine = [n for n in numbers if signal.getsignal(n) is signal.SIG_DFL] if threading.current_thread() is threading.main_thread() else []
    for number in mine:
        signal.signal(number, _end)
    try:
        yield
    finally:
        for number in mine:
            signal.signal(number, signal.SIG_DFL)
