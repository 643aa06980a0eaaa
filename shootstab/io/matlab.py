"""MATLAB's files: v5 (to v7.2) through SciPy; v7.3 is HDF5 (hdf5.py). Objects are never built; cells and structures are looked into."""

from __future__ import annotations

import io
import struct
import zlib
from typing import TYPE_CHECKING, Any

from shootstab.io.arrays import StoredArray, Wanted, spectrum_in, with_pairs

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

MATLAB_MAGIC = b"MATLAB 5.0 MAT-file"
HEADER = 128  # defined by the format: bytes of text and version before the first element
COMPRESSED = 15  # defined by the format: miCOMPRESSED
NUMERIC = ("double", "single", "int8", "uint8", "int16", "uint16", "int32", "uint32", "int64", "uint64")
NESTED = ("cell", "struct")
DEEPEST_CELL = 4  # chosen: levels of cells and structures that are looked into
MOST_VARIABLES = 1000  # chosen: variables, and arrays in cells and structures


def from_mat(data: bytes, wanted: Wanted, largest: int) -> NDArray[np.complex128]:
    """The eigenvalues (m,) in the bytes of a v5 file: a variable s, a field s.lambda, an entry c{2} of a cell. Raises ValueError."""
    import scipy.io

    _require_small(data, largest)
    try:
        listed = scipy.io.whosmat(io.BytesIO(data))
        names = [name for name, _, kind in listed if kind in NUMERIC + NESTED]
        loaded = scipy.io.loadmat(io.BytesIO(data), variable_names=names)
    except Exception as error:  # a parser of somebody else's on bytes of anybody's
        raise ValueError("broken MATLAB file: allowed is a file as MATLAB saves it, whole") from error
    arrays: dict[str, StoredArray] = {}
    for name in names:
        if name not in loaded:
            raise ValueError(f"broken MATLAB file: {name} cannot be read")
        _collect(name, loaded[name], arrays, DEEPEST_CELL)
    inside = [name for name in arrays if name not in names]
    try:
        return spectrum_in(with_pairs(arrays, "re, im"), wanted, [*(name for name, _, _ in listed), *inside])
    except ValueError as error:
        raise ValueError(f"MATLAB file: {error}") from None


def _collect(name: str, value: Any, into: dict[str, StoredArray], depth: int) -> None:
    """Every array of numbers in the value, by its name in MATLAB; a cell whose entries are numbers is one array."""
    import numpy as np

    if depth < 0 or len(into) > MOST_VARIABLES or not isinstance(value, np.ndarray):
        return
    if value.dtype.kind in "iufc":
        into[name] = StoredArray(value.dtype.kind, value.shape, lambda: value)
    elif value.dtype.names is not None:
        for number, entry in enumerate(value.ravel()[:MOST_VARIABLES], 1):
            for field in value.dtype.names:
                place = name if value.size == 1 else f"{name}({number})"
                _collect(f"{place}.{field}", entry[field], into, depth - 1)
    elif value.dtype.kind == "O":
        entries = list(value.ravel())
        if entries and all(isinstance(e, np.ndarray) and e.dtype.kind in "iufc" and e.size == 1 for e in entries):
            whole = np.array([e.ravel()[0] for e in entries])
            into[name] = StoredArray(whole.dtype.kind, whole.shape, lambda: whole)
            return
        for number, entry in enumerate(entries[:MOST_VARIABLES], 1):
            if (isinstance(entry, np.ndarray) and entry.size > 1) or getattr(getattr(entry, "dtype", None), "names", None):
                _collect(f"{name}{{{number}}}", entry, into, depth - 1)


def _require_small(data: bytes, largest: int) -> None:
    """Raise ValueError if what is compressed unpacks to more than this, all of it together."""
    order = ">" if data[HEADER - 2 : HEADER] == b"MI" else "<"
    at, unpacked, elements = HEADER, 0, 0
    while at + 8 <= len(data):
        elements += 1
        if elements > MOST_VARIABLES:
            raise ValueError(f"more than {MOST_VARIABLES} variables in it: allowed are {MOST_VARIABLES}")
        kind, size = struct.unpack(f"{order}2I", data[at : at + 8])
        at += 8
        if kind == COMPRESSED:
            try:
                unpacked += len(zlib.decompressobj().decompress(data[at : at + size], largest + 1 - unpacked))
            except zlib.error:
                raise ValueError("broken MATLAB file: what is compressed in it is damaged") from None
            if unpacked > largest:
                raise ValueError("larger than 32 MB when unpacked: allowed is a smaller file")
        at += size
