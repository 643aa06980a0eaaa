"""What there is in the gallery, by name: keys of scene files, descriptions, built-in scenes, published digits. Light: no equations here.

A module of this folder that has `ENTRIES`, a tuple of `Entry`, is found. So a new problem is one file: its entry, with the equations in the
function that makes it, or with a `Maker` that finds them in a module of the gallery.
"""

from __future__ import annotations

from functools import cache
from importlib import import_module
from pkgutil import iter_modules

from shootstab.models.catalogue.entry import Entry


@cache
def entries() -> dict[str, Entry]:
    """The entries by their name in [problem], in the order of the files. Raises ValueError where two have one name."""
    found: dict[str, Entry] = {}
    for module in iter_modules(__path__):
        for entry in getattr(import_module(f"{__name__}.{module.name}"), "ENTRIES", ()):
            if entry.name in found:
                raise ValueError(f"two problems of the gallery are called {entry.name}")
            found[entry.name] = entry
    return found
