"""The place of compiled kernels: beside the sources, or where numba keeps what is a user's; and where neither may be written to, in a
folder of this process's own, for numba refuses to compile what it is to keep and cannot.
"""

from __future__ import annotations

import os
import tempfile
from typing import Any

import numba

from shootstab.core.errors import ShootstabError

_own: list[tempfile.TemporaryDirectory[str]] = []  # removed as the process ends


def _kept() -> None:
    """A function for numba to find a place for; it is never compiled."""


def require_place() -> None:
    """See that numba finds a place, and make one where it does not: it serves this process and its workers, and every start compiles anew.

    Raises ShootstabError where no folder at all may be written to.
    """
    try:
        numba.njit(cache=True)(_kept)
    except RuntimeError:
        try:
            _own.append(tempfile.TemporaryDirectory(prefix="shootstab-kernels-"))
        except OSError as error:
            place = "set NUMBA_CACHE_DIR to a folder that may be written to"
            raise ShootstabError(f"compiled kernels can be kept nowhere: {place} ({error.strerror or error})") from error
        config: Any = numba.config
        os.environ["NUMBA_CACHE_DIR"] = config.CACHE_DIR = _own[-1].name
