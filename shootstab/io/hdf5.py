"""HDF5 files, MATLAB's v7.3 among them, through h5py: a dataset by its path. Links that lead out of the file are not followed."""

from __future__ import annotations

import io
from typing import TYPE_CHECKING, Any

from shootstab.io.arrays import COMPLEX_PARTS, StoredArray, Wanted, spectrum_in, with_pairs

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

HDF5_MAGIC = b"\x89HDF\r\n\x1a\n"
MATLAB = b"MATLAB 7.3 MAT-file"
# defined by the format: where the signature may stand; its longer user blocks are not looked into
USERBLOCKS = (0, 512, 1024, 2048)
MATLABS_OWN = ("#refs#", "#subsystem#")
MOST_OBJECTS = 10_000  # chosen: groups and datasets in a file that are looked at


def is_hdf5(data: bytes) -> bool:
    """Whether the signature stands at one of the places where it may."""
    return any(data[at : at + len(HDF5_MAGIC)] == HDF5_MAGIC for at in USERBLOCKS)


def from_hdf5(data: bytes, wanted: Wanted, largest: int) -> NDArray[np.complex128]:
    """The eigenvalues (m,) in a dataset (complex, of fields re and im, or of two columns), or in two, as re and im or omega_r and omega_i.

    Without a path the one that io/arrays.py chooses is meant. Raises ValueError.
    """
    try:
        import h5py
    except ImportError:
        raise ValueError("an HDF5 file: reading one needs h5py: pip install 'shootstab[hdf5]'") from None
    try:
        with h5py.File(io.BytesIO(data), "r") as file:
            found = _found(file, largest)
            path = None if wanted.dataset is None else wanted.dataset.strip("/") or "/"
            return spectrum_in(found, Wanted(path, wanted.row), list(found))
    except UnicodeDecodeError:
        raise ValueError("HDF5 file: a name in it is not UTF-8: allowed are names in UTF-8") from None
    except ValueError as error:
        raise ValueError(f"HDF5 file: {error}") from None
    except Exception as error:  # a parser of somebody else's on bytes of anybody's
        raise ValueError("broken HDF5 file: allowed is a file that h5dump can read") from error


def _values(dataset: Any, largest: int) -> Any:
    """The numbers of a dataset that lies in this file and is not too large."""
    if dataset.is_virtual or dataset.external:
        raise ValueError(f"{dataset.name} keeps its numbers in another file: allowed are numbers in this one")
    if dataset.size * dataset.dtype.itemsize > largest:
        raise ValueError(f"{dataset.name} is larger than 32 MB when unpacked: allowed is a smaller one")
    return _complex(dataset[()])


def _complex(array: Any) -> Any:
    """Complex numbers from fields that are called so."""
    import numpy as np

    names = array.dtype.names
    if names is None:
        return array
    for re, im in COMPLEX_PARTS:
        if set(names) == {re, im} and all(array.dtype[part].kind in "iuf" for part in names):
            out = np.empty(array.shape, dtype=np.complex128)
            out.real, out.imag = array[re], array[im]
            return out
    raise ValueError(f"fields {', '.join(names)}: allowed are re and im, numbers both")


def _found(file: Any, largest: int) -> dict[str, StoredArray]:
    """Every dataset of numbers by its path, those that are a real and an imaginary part as one; what other files hold is not visited."""
    import h5py

    groups: dict[str, dict[str, StoredArray]] = {}
    count = 0

    def note(name: str, item: Any) -> bool | None:
        nonlocal count
        count += 1
        numbers = isinstance(item, h5py.Dataset) and item.shape is not None and item.dtype.kind in "iufcV"
        if numbers and name.split("/")[0] not in MATLABS_OWN:
            group, _, last = name.rpartition("/")
            kind = "c" if item.dtype.kind == "V" else item.dtype.kind
            groups.setdefault(group, {})[last] = StoredArray(kind, item.shape, lambda: _values(item, largest))
        return True if count > MOST_OBJECTS else None

    file.visititems(note)
    found: dict[str, StoredArray] = {}
    for group, members in groups.items():
        for last, array in with_pairs(members, "").items():
            found["/".join(part for part in (group, last) if part) or "/"] = array
    return found
