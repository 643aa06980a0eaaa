"""NumPy's own files, npy and npz: nothing is ever unpickled. And which array of several is meant, in any format."""

from __future__ import annotations

import io
import tokenize
import zipfile
import zlib
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from shootstab.io.notation import shortened

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

MAGIC = b"\x93NUMPY"
MAGIC_ZIP = (b"PK\x03\x04", b"PK\x05\x06")
NAMES = ("eigenvalues", "sigma")
ALLOWED = "allowed is a list of complex or real numbers, or two real columns, re and im"

# what NumPy and zipfile raise on files that are not what they say
_BROKEN = (ValueError, EOFError, OSError, MemoryError, OverflowError, TypeError, SyntaxError, tokenize.TokenError)
_BROKEN_ZIP = (zipfile.BadZipFile, zlib.error, NotImplementedError, RuntimeError, KeyError, EOFError, OSError)


def from_npy(data: bytes) -> NDArray[np.complex128]:
    """The eigenvalues in the bytes of an npy file. Raises ValueError."""
    import numpy as np

    if not data.startswith(MAGIC):
        raise ValueError(f"an array that is not npy: {ALLOWED}")
    try:
        array = np.load(io.BytesIO(data), allow_pickle=False)
    except _BROKEN as error:
        raise ValueError(f"broken npy: {error}: {ALLOWED}") from error
    return as_complex(array)


def from_npz(data: bytes, dataset: str | None, largest: int) -> NDArray[np.complex128]:
    """The eigenvalues in the bytes of an npz file: its only array, or the one of this name. Raises ValueError."""
    try:
        with zipfile.ZipFile(io.BytesIO(data)) as archive:
            members = {name.removesuffix(".npy"): name for name in archive.namelist()}
            chosen = members[choose(list(members), dataset, list(members))]
            info = archive.getinfo(chosen)
            if info.file_size > largest:
                raise ValueError("larger than 64 MB when unpacked: allowed is a smaller file")
            if info.compress_type not in (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED):
                raise ValueError("broken npz: packed as NumPy never does")
            member = archive.read(chosen)
    except _BROKEN_ZIP as error:
        raise ValueError(f"broken npz: {error}") from error
    return from_npy(member)


def choose(numeric: Sequence[str], dataset: str | None, there: Sequence[str]) -> str:
    """Which array is meant: the one asked for, else the one called eigenvalues or sigma, else the only one of numbers.

    Raises ValueError that lists what is there.
    """
    listed = shortened(", ".join(there) or "none", 200).strip("'\"")
    if dataset is not None:
        if dataset in numeric:
            return dataset
        raise ValueError(f"no array of numbers called {shortened(dataset)} in it: there are {listed}")
    named = [name for name in NAMES if name in numeric]
    if named or len(numeric) == 1:
        return named[0] if named else numeric[0]
    raise ValueError(f"arrays in it: {listed}: allowed is one array, or one of them called {' or '.join(NAMES)}, or --dataset NAME")


def as_complex(array: Any) -> NDArray[np.complex128]:
    """Eigenvalues (m,) from a list of numbers in whatever shape, or from two real columns. Raises ValueError."""
    import numpy as np

    if not isinstance(array, np.ndarray) or array.dtype.kind not in "iufc":
        raise ValueError(f"an array of type {getattr(array, 'dtype', type(array).__name__)}: {ALLOWED}")
    array = np.atleast_1d(array)
    if array.ndim == 2 and array.shape[1] == 2 and array.dtype.kind != "c":
        return np.asarray(array[:, 0] + 1j * array[:, 1], dtype=np.complex128)
    if array.size != max(array.shape):
        raise ValueError(f"an array of shape {array.shape}: {ALLOWED}")
    return np.asarray(array.ravel(), dtype=np.complex128)
