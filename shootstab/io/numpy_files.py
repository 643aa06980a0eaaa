"""NumPy's own files, npy and npz: nothing is ever unpickled."""

from __future__ import annotations

import io
import math
import tokenize
import zipfile
import zlib
from typing import TYPE_CHECKING, Any

from shootstab.io.arrays import ALLOWED_ARRAYS, StoredArray, Wanted, as_complex, spectrum_in, with_pairs

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

NUMPY_MAGIC = b"\x93NUMPY"
MAGIC_ZIP = (b"PK\x03\x04", b"PK\x05\x06")
MAGIC_ENTRY = b"PK\x01\x02"  # before every entry of the directory of a zip file
MOST_ARRAYS = 1000  # chosen: arrays in an npz file
_START = 2**16  # chosen: bytes in which a header ends, if the file is one of numbers
# what NumPy and zipfile raise on files that are not what they say
_BROKEN = (ValueError, EOFError, OSError, MemoryError, OverflowError, TypeError, SyntaxError, tokenize.TokenError)
_BROKEN_ZIP = (zipfile.BadZipFile, zlib.error, NotImplementedError, RuntimeError, KeyError, EOFError, OSError)


def from_npy(data: bytes, wanted: Wanted) -> NDArray[np.complex128]:
    """The eigenvalues (m,) in the bytes of an npy file. Raises ValueError."""
    return as_complex(_loaded(data), wanted.row)


def _loaded(data: bytes) -> Any:
    import numpy as np

    if not data.startswith(NUMPY_MAGIC):
        raise ValueError(f"an array that is not npy: {ALLOWED_ARRAYS}")
    header = _shape(data[:_START])
    if header is not None and math.prod(header[1]) * header[2] > len(data):
        raise ValueError(f"broken npy: its header says more numbers than it holds: {ALLOWED_ARRAYS}")
    try:
        return np.load(io.BytesIO(data), allow_pickle=False)
    except _BROKEN as error:
        raise ValueError(f"broken npy: {_words(error)}: {ALLOWED_ARRAYS}") from error


def _words(error: Exception) -> str:
    """What was wrong, in words of the file and not of the library."""
    if "Object arrays" in str(error):
        return "it holds Python objects, which are never unpickled"
    return "its header does not say what it holds"


def from_npz(data: bytes, wanted: Wanted, largest: int) -> NDArray[np.complex128]:
    """The eigenvalues (m,) in the bytes of an npz file, in the array that is meant. Raises ValueError."""
    if data.count(MAGIC_ENTRY) > MOST_ARRAYS:
        raise ValueError(f"more than {MOST_ARRAYS} arrays in it: allowed are {MOST_ARRAYS}")
    try:
        with zipfile.ZipFile(io.BytesIO(data)) as archive:
            members = {info.filename.removesuffix(".npy"): info for info in archive.infolist()}
            if len(members) == 1 or wanted.dataset in members:
                return as_complex(_member(archive, members[wanted.dataset or next(iter(members))], largest), wanted.row)
            arrays = {}
            for name, info in members.items():
                header = _header(archive, info)
                if header is not None:
                    kind, shape = header
                    arrays[name] = StoredArray(kind, shape, lambda info=info: _member(archive, info, largest))  # type: ignore[misc]
            return spectrum_in(with_pairs(arrays, "re, im"), wanted, list(members))
    except _BROKEN_ZIP as error:
        raise ValueError(f"broken npz: {error}") from error


def _header(archive: zipfile.ZipFile, info: zipfile.ZipInfo) -> tuple[str, tuple[int, ...]] | None:
    """Kind and shape of an array of numbers, from its first bytes; None for anything else."""
    if info.compress_type not in (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED):
        return None
    with archive.open(info) as file:
        found = _shape(file.read(_START))
    return None if found is None or found[0] not in "iufc" else found[:2]


def _shape(data: bytes) -> tuple[str, tuple[int, ...], int] | None:
    """Kind, shape and bytes of an item that the header of an npy file names; None where it names none."""
    from numpy.lib import format as npy

    start = io.BytesIO(data)
    try:
        version = npy.read_magic(start)
        read = npy.read_array_header_1_0 if version == (1, 0) else npy.read_array_header_2_0
        shape, _, dtype = read(start)
    except _BROKEN:
        return None
    return dtype.kind, shape, dtype.itemsize


def _member(archive: zipfile.ZipFile, info: zipfile.ZipInfo, largest: int) -> Any:
    if info.file_size > largest:
        raise ValueError("larger than 32 MB when unpacked: allowed is a smaller file")
    if info.compress_type not in (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED):
        raise ValueError("broken npz: packed as NumPy never does")
    return _loaded(archive.read(info))
