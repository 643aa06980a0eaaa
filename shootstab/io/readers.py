"""Eigenvalue files. A reader is told by what the file begins with, never by its name."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from itertools import islice
from pathlib import Path
from typing import TYPE_CHECKING, Any

from shootstab.core.errors import InputError
from shootstab.core.reading import bytes_of
from shootstab.io import hdf5, hdf5_process, json_text, legolas, matlab, numpy_files, text
from shootstab.io.arrays import Wanted
from shootstab.io.text import MOST_EIGENVALUES, Placed

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

LARGEST_FILE = 64 * 2**20  # chosen: bytes of a file; binary ones may hold eigenvectors too
UNPACKED = 32 * 2**20  # chosen: bytes of an array; with its file and what is made of it, it stays within 256 MiB
# chosen: QZ gives infinities of a singular pencil as 1e16 and more times its norm, and Legolas writes 1e20 for them
INFINITE = 1e15


@dataclass(frozen=True, eq=False, repr=False)
class ClaimedSpectrum:
    """Eigenvalues as they were read: values (m,), and how many entries were left out as infinite, not a number, or 1e15 and more."""

    values: NDArray[np.complex128]
    dropped: int = 0
    source: str = ""

    def __repr__(self) -> str:
        left_out = f", {self.dropped} left out" if self.dropped else ""
        return f"ClaimedSpectrum({len(self)} eigenvalues{left_out})"

    def __len__(self) -> int:
        return len(self.values)

    def __iter__(self) -> Iterator[complex]:
        return iter(self.values.tolist())

    def __getitem__(self, place: Any) -> Any:
        return self.values[place]

    def __array__(self, dtype: Any = None, copy: bool | None = None) -> Any:
        import numpy as np

        return np.array(self.values, dtype=dtype) if copy else np.asarray(self.values, dtype=dtype)

    @property
    def sentence(self) -> str:
        """What was left out, in words; empty if nothing was."""
        if not self.dropped:
            return ""
        entries = "1 entry that is" if self.dropped == 1 else f"{self.dropped} entries that are"
        return f"Left out of {self.source}: {entries} infinite, not a number, or 1e15 and more."


@dataclass(frozen=True)
class Reader:
    """One kind of file: whether these bytes are of it, and the eigenvalues in them (ValueError if they are malformed).

    A file that may hold several arrays has them chosen by name.
    """

    name: str
    recognises: Callable[[bytes], bool]
    values: Callable[[bytes, Wanted], Placed]
    several: bool = False


def read(path: str | Path, dataset: str | None = None, row: int | None = None) -> ClaimedSpectrum:
    """The eigenvalues in a file, in their order: csv or text, json, npy, npz, MATLAB, HDF5, Legolas.

    dataset is the name of the array that is meant, in a file that may hold several; row, counted from 1, the spectrum in an array of
    several. Entries that are infinite, NaN, or 1e15 and more are what codes write for the infinite eigenvalues of a singular pencil:
    they are left out and counted.

    Raises InputError, whose one line names the file, for a file that is missing, empty, larger than 64 MB (text: 16 MB) or malformed,
    and for one that holds no finite eigenvalue or more than 100,000 of them.
    """
    data = bytes_of(Path(path), LARGEST_FILE, "a file of eigenvalues")
    if not data.strip():
        raise InputError(f"{path}: the file is empty: allowed is a file with at least one eigenvalue")
    reader = next((r for r in READERS if r.recognises(data)), None)
    if reader is None:
        known = ", ".join(r.name for r in READERS)
        raise InputError(f"{path}: not an eigenvalue file: allowed is {known}")
    _require_several(reader, path, dataset, row)
    try:
        values = [value for _, value in islice(reader.values(data, Wanted(dataset, row)), MOST_EIGENVALUES + 1)]
        if len(values) > MOST_EIGENVALUES:
            raise ValueError(f"more than {MOST_EIGENVALUES} eigenvalues: allowed is the part that is asked about")
    except ValueError as error:
        raise InputError(f"{path}: {error}") from error
    kept = [value for value in values if abs(value.real) < INFINITE and abs(value.imag) < INFINITE]
    if not values:
        raise InputError(f"{path}: holds no eigenvalue: allowed is a file with at least one")
    if not kept:
        raise InputError(f"{path}: holds no eigenvalue: all {len(values)} entries are infinite, not a number, or 1e15 and more")
    import numpy as np

    return ClaimedSpectrum(np.array(kept, dtype=np.complex128), len(values) - len(kept), Path(path).name)


def _require_several(reader: Reader, path: str | Path, dataset: str | None, row: int | None) -> None:
    """Raise InputError for a choice among arrays in a file that holds one."""
    arrays = ", ".join(r.name for r in READERS if r.several)
    if dataset is not None and not reader.several:
        raise InputError(f"{path}: --dataset {dataset}: allowed for {arrays}; this is {reader.name}")
    if row is not None and not (reader.several or reader.name == "npy"):
        raise InputError(f"{path}: --row {row}: allowed for npy, {arrays}; this is {reader.name}")


# the table: the first that recognises a file reads it


def _placed(values: Callable[[bytes, Wanted], NDArray[np.complex128]]) -> Callable[[bytes, Wanted], Placed]:
    def placed(data: bytes, wanted: Wanted) -> Placed:
        for number, value in enumerate(values(data, wanted)[: MOST_EIGENVALUES + 1].tolist(), 1):
            yield f"entry {number}", value

    return placed


READERS = (
    Reader("npy", lambda data: data.startswith(numpy_files.NUMPY_MAGIC), _placed(numpy_files.from_npy)),
    Reader("npz", lambda data: data.startswith(numpy_files.MAGIC_ZIP), _placed(lambda d, w: numpy_files.from_npz(d, w, UNPACKED)), True),
    Reader("HDF5", hdf5.is_hdf5, _placed(lambda data, wanted: hdf5_process.from_hdf5(data, wanted, UNPACKED)), True),
    Reader("MATLAB", lambda data: data.startswith(matlab.MATLAB_MAGIC), _placed(lambda d, w: matlab.from_mat(d, w, UNPACKED)), True),
    Reader("Legolas", legolas.is_legolas, _placed(legolas.from_legolas)),
    Reader("json", json_text.is_json, json_text.from_json, True),
    Reader("csv or text in UTF-8", text.is_text, lambda data, _: text.from_text(data)),
)
