"""Floor 1: compiled loops over arrays and scalars. Nothing here knows what the numbers mean."""

from __future__ import annotations

from numba.core import event

from shootstab.core import compilation
from shootstab.kernels.cache import require_place


class _Compilation(event.Listener):
    """A listener that passes on which kernel numba compiles; it hears nothing where the cache holds the kernel."""

    def on_start(self, event: event.Event) -> None:
        compilation.begins(event.data["dispatcher"].py_func.__name__)

    def on_end(self, event: event.Event) -> None:
        """Tell nothing at the end of a compilation."""


event.register("numba:compile", _Compilation())  # type: ignore[no-untyped-call]
require_place()
