"""HDF5 files, MATLAB's v7.3 among them, through h5py: a dataset by its path. Links that lead out of the file are not followed."""

from __future__ import annotations

import io
from typing import TYPE_CHECKING, Any

from shootstab.io.arrays import as_complex, choose

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

MAGIC = b"\x89HDF\r\n\x1a\n"
MATLAB = b"MATLAB 7.3 MAT-file"
USERBLOCKS = (0, 512, 1024, 2048)
PARTS = (("re", "im"), ("real", "imag"), ("r", "i"))
MATLABS_OWN = ("#refs#", "#subsystem#")
MOST = 10_000  # datasets in a file


def is_hdf5(data: bytes) -> bool:
    """Whether the signature stands at one of the places where it may."""
    return any(data[at : at + len(MAGIC)] == MAGIC for at in USERBLOCKS)


def from_hdf5(data: bytes, dataset: str | None, largest: int) -> NDArray[np.complex128]:
    """The eigenvalues in a dataset: complex, of fields re and im, of two columns; or in a group of two datasets, re and im.

    Without a path the only one of numbers is meant, or the one called eigenvalues or sigma. Raises ValueError.
    """
    try:
        import h5py
    except ImportError:
        raise ValueError("an HDF5 file: reading one needs h5py: pip install 'shootstab[hdf5]'") from None
    try:
        with h5py.File(io.BytesIO(data), "r") as file:
            found = _found(file)
            name = choose(list(found), None if dataset is None else dataset.strip("/") or "/", list(found))
            return found[name].values(largest)
    except ValueError as error:
        raise ValueError(f"HDF5 file: {error}") from None
    except Exception as error:  # a parser of somebody else's on bytes of anybody's
        raise ValueError(f"broken HDF5 file: {type(error).__name__}: {error}") from error


class _Dataset:
    """One dataset, or two that are re and im."""

    def __init__(self, *parts: Any) -> None:
        self.parts = parts

    def values(self, largest: int) -> NDArray[np.complex128]:
        arrays = []
        for part in self.parts:
            if part.is_virtual or part.external:
                raise ValueError(f"{part.name} keeps its numbers in another file: allowed are numbers in this one")
            if part.dtype.kind not in "iufcV":
                raise ValueError(f"{part.name} is of type {part.dtype}: allowed are numbers")
            if part.size * part.dtype.itemsize > largest:
                raise ValueError(f"{part.name} is larger than 64 MB when unpacked: allowed is a smaller one")
            arrays.append(_joined(part[()]))
        if len(arrays) == 1:
            return as_complex(arrays[0])
        re, im = (as_complex(a) for a in arrays)
        if re.shape != im.shape or re.imag.any() or im.imag.any():
            raise ValueError(f"{self.parts[0].name} and {self.parts[1].name} are not a real and an imaginary part")
        return re + 1j * im


def _joined(array: Any) -> Any:
    """Complex numbers from fields that are called so."""
    names = array.dtype.names
    if names is None:
        return array
    for re, im in PARTS:
        if set(names) == {re, im}:
            return array[re] + 1j * array[im]
    raise ValueError(f"fields {', '.join(names)}: allowed are re and im")


def _found(file: Any) -> dict[str, _Dataset]:
    """Every dataset of numbers, and every group that is a pair of them, by path; what other files hold is not visited."""
    import h5py

    datasets: dict[str, Any] = {}

    def note(name: str, item: Any) -> bool | None:
        if isinstance(item, h5py.Dataset) and name.split("/")[0] not in MATLABS_OWN and item.dtype.kind in "iufcV":
            datasets[name] = item
        return True if len(datasets) > MOST else None

    file.visititems(note)
    found = {name: _Dataset(item) for name, item in datasets.items()}
    groups: dict[str, dict[str, Any]] = {}
    for name, item in datasets.items():
        group, _, last = name.rpartition("/")
        groups.setdefault(group, {})[last] = item
    for group, members in groups.items():
        for re, im in PARTS:
            if set(members) == {re, im}:
                for part in (re, im):
                    del found[f"{group}/{part}" if group else part]
                found[group or "/"] = _Dataset(members[re], members[im])
    return found
