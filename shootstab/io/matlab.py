"""MATLAB's files: v5 (to v7.2) through SciPy; v7.3 is HDF5 (hdf5.py). Cells, structures and objects are never built."""

from __future__ import annotations

import io
import struct
import zlib
from typing import TYPE_CHECKING

from shootstab.io.arrays import as_complex, choose

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

MAGIC = b"MATLAB 5.0 MAT-file"
HEADER = 128
COMPRESSED = 15  # miCOMPRESSED
NUMERIC = ("double", "single", "int8", "uint8", "int16", "uint16", "int32", "uint32", "int64", "uint64")


def from_mat(data: bytes, dataset: str | None, largest: int) -> NDArray[np.complex128]:
    """The eigenvalues in the bytes of a v5 file: its only numeric variable, or that of the name given. Raises ValueError."""
    import scipy.io

    _require_small(data, largest)
    try:
        listed = scipy.io.whosmat(io.BytesIO(data))
        numeric = [name for name, _, kind in listed if kind in NUMERIC]
        name = choose(numeric, dataset, [name for name, _, _ in listed])
        loaded = scipy.io.loadmat(io.BytesIO(data), variable_names=[name])
    except ValueError as error:
        raise ValueError(f"MATLAB file: {error}") from None
    except Exception as error:  # a parser of somebody else's on bytes of anybody's
        raise ValueError(f"broken MATLAB file: {type(error).__name__}: {error}") from error
    if name not in loaded:
        raise ValueError(f"broken MATLAB file: {name} cannot be read")
    return as_complex(loaded[name])


def _require_small(data: bytes, largest: int) -> None:
    """Raise ValueError if what is compressed unpacks to more than this, all of it together."""
    order = ">" if data[126:128] == b"MI" else "<"
    at, unpacked = HEADER, 0
    while at + 8 <= len(data):
        kind, size = struct.unpack(f"{order}2I", data[at : at + 8])
        at += 8
        if kind == COMPRESSED:
            try:
                unpacked += len(zlib.decompressobj().decompress(data[at : at + size], largest + 1 - unpacked))
            except zlib.error as error:
                raise ValueError(f"broken MATLAB file: {error}") from None
            if unpacked > largest:
                raise ValueError("larger than 64 MB when unpacked: allowed is a smaller file")
        at += size
