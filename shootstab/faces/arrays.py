"""NumPy's own files, npy and npz. Nothing is ever unpickled."""

from __future__ import annotations

import io
import tokenize
import zipfile
import zlib
from typing import TYPE_CHECKING, Any

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
    return _as_complex(array)


def from_npz(data: bytes, largest: int) -> NDArray[np.complex128]:
    """The eigenvalues in the bytes of an npz file: its only array, or the one called eigenvalues or sigma. Raises ValueError."""
    try:
        with zipfile.ZipFile(io.BytesIO(data)) as archive:
            members = {name.removesuffix(".npy"): name for name in archive.namelist()}
            chosen = next((members[n] for n in NAMES if n in members), None)
            if chosen is None and len(members) == 1:
                (chosen,) = members.values()
            if chosen is None:
                found = ", ".join(members) or "none"
                raise ValueError(f"arrays in it: {found}: allowed is one array, or one of them called {' or '.join(NAMES)}")
            info = archive.getinfo(chosen)
            if info.file_size > largest:
                raise ValueError("larger than 64 MB when unpacked: allowed is a smaller file")
            if info.compress_type not in (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED):
                raise ValueError("broken npz: packed as NumPy never does")
            member = archive.read(chosen)
    except _BROKEN_ZIP as error:
        raise ValueError(f"broken npz: {error}") from error
    return from_npy(member)


def _as_complex(array: Any) -> NDArray[np.complex128]:
    import numpy as np

    if not isinstance(array, np.ndarray) or array.dtype.kind not in "iufc":
        raise ValueError(f"an array of type {getattr(array, 'dtype', type(array).__name__)}: {ALLOWED}")
    array = np.atleast_1d(array)
    if array.ndim == 2 and array.shape[1] == 2 and array.dtype.kind != "c":
        return np.asarray(array[:, 0] + 1j * array[:, 1], dtype=np.complex128)
    if array.size != max(array.shape):
        raise ValueError(f"an array of shape {array.shape}: {ALLOWED}")
    return np.asarray(array.ravel(), dtype=np.complex128)
