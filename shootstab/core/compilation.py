"""Who is told when a kernel is compiled: the first time ever that it is needed, before it is found in the cache."""

from __future__ import annotations

from collections.abc import Callable

_told: list[Callable[[str], None]] = []


def tell(listener: Callable[[str], None]) -> None:
    """Call listener from now on with the name of every kernel whose compilation begins."""
    _told.append(listener)


def begins(name: str) -> None:
    """Tell the listeners that the compilation of a kernel begins."""
    for listener in _told:
        listener(name)
