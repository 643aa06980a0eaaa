"""Spectra that come with shootstab, for whoever wants to see what a verdict looks like before there is a spectrum of one's own."""

from __future__ import annotations

from importlib import resources
from pathlib import Path

from shootstab.core.errors import InputError


def names() -> list[str]:
    """The scenes that have one."""
    return sorted(path.name.removesuffix(".csv") for path in _folder().iterdir() if path.name.endswith(".csv"))


def path_for(scene: str, given: str | None) -> Path:
    """The spectrum of a scene. Raises InputError where it has none, or where another file was given."""
    if given is not None:
        raise InputError("--example: allowed without EIGENVALUES only, it is a file of its own")
    if scene not in names():
        raise InputError(f"--example: {scene} has none: allowed is {', '.join(names())}")
    return _folder() / f"{scene}.csv"


def _folder() -> Path:
    return Path(str(resources.files("shootstab"))) / "examples"
