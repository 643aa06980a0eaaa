"""Standard output and standard error as they may be: closed, or of a terminal without Greek letters."""

from __future__ import annotations

import os
import sys


def prepare() -> None:
    """What cannot be encoded is replaced, for a σ must not stop a terminal that has none.

    A standard output that was closed before the program began refuses whatever is written, as a full one does; a standard error that was
    closed is written to in vain.
    """
    if sys.stdout is None:
        sys.stdout = os.fdopen(os.open(os.devnull, os.O_RDONLY), "w")
    if sys.stderr is None:
        sys.stderr = os.fdopen(os.open(os.devnull, os.O_WRONLY), "w")
    for stream in (sys.stdout, sys.stderr):
        if hasattr(stream, "reconfigure"):
            stream.reconfigure(errors="replace")
