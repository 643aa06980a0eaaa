"""Files that are written whole or not at all."""

from __future__ import annotations

import os
import stat
from collections.abc import Callable
from pathlib import Path

from shootstab.core.errors import InputError, OutputError


def require_writable(path: Path) -> None:
    """Raise InputError, before any work is done, if the file could not be written."""
    folder = path.parent
    if path.is_dir():
        raise InputError(f"{path}: is a folder: allowed is the name of a file")
    if not folder.is_dir():
        raise InputError(f"{path}: there is no folder {folder}: allowed is a file in a folder that exists")
    if not os.access(path if _is_device(path) else folder, os.W_OK):
        raise InputError(f"{path}: cannot be written: allowed is a file in a folder that may be written to")


def write_whole(path: Path, write: Callable[[Path], object]) -> None:
    """Let `write` fill a file beside `path`, then put it in its place: nobody ever sees half of it.

    The other file keeps the suffix, by which writers choose a format. Pipes and devices are written to as they are.
    Raises OutputError.
    """
    if _is_device(path):
        try:
            write(path)
        except OSError as error:
            raise OutputError(f"{path}: cannot be written: {error.strerror or error}") from error
        return
    target = path.resolve()  # a link stays a link
    beside = target.with_name(f".{target.stem}.{os.getpid()}{target.suffix}")
    try:
        write(beside)
        beside.replace(target)
    except OSError as error:
        raise OutputError(f"{path}: cannot be written: {error.strerror or error}") from error
    finally:
        beside.unlink(missing_ok=True)


def write_text(path: Path, text: str) -> None:
    """The same for a text. Raises OutputError."""
    write_whole(path, lambda file: file.write_text(text, encoding="utf-8"))


def _is_device(path: Path) -> bool:
    """Whether something else than a regular file is there."""
    try:
        return not stat.S_ISREG(path.stat().st_mode)
    except OSError:
        return False
