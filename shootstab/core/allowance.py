"""Processor time that a search may take, so that what is only proposed does not keep anybody waiting."""

from __future__ import annotations

import math
from collections.abc import Iterator
from contextlib import contextmanager
from time import process_time


class Allowance:
    """Seconds of processor time from now on; infinite by default."""

    def __init__(self, seconds: float = math.inf) -> None:
        self.seconds = seconds
        self._until = process_time() + seconds
        self.stopped = False  # whether somebody asked and was told to stop

    @property
    def spent(self) -> bool:
        """Whether it is used up; whoever asks stops if it is."""
        over = process_time() >= self._until
        self.stopped = self.stopped or over
        return over

    @contextmanager
    def share(self, part: float) -> Iterator[Allowance]:
        """A part of what is left, for one of several searches; if that one is stopped, so is the whole."""
        own = Allowance(part * (self._until - process_time()))
        yield own
        self.stopped = self.stopped or own.stopped
