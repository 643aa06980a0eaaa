"""How long an answer took, with what numba compiled on the way apart: that is paid once, on the machine's first answer."""

from __future__ import annotations

import time
from importlib import import_module
from typing import Any


class Clock:
    """Runs from when it is made."""

    def __init__(self) -> None:
        self._event: Any = import_module("numba.core.event")
        self._began = time.perf_counter()
        self._listener = self._event.TimingListener()
        self._event.register("numba:compile", self._listener)

    def stop(self) -> dict[str, float]:
        """{"seconds": without compilation, "compilation_seconds": of it}."""
        self._event.unregister("numba:compile", self._listener)
        compiled = float(self._listener.duration) if self._listener.done else 0.0
        return {"seconds": max(0.0, time.perf_counter() - self._began - compiled), "compilation_seconds": compiled}
