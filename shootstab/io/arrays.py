"""The array of a file that holds the spectrum, in any format that holds arrays; and the numbers in it."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from shootstab.core.errors import LISTED, shortened

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

EIGENVALUE_NAMES = ("eigenvalues", "sigma")
ALLOWED_ARRAYS = "allowed is a list of complex or real numbers, or two real columns, re and im"
COMPLEX_PARTS = (("re", "im"), ("real", "imag"), ("r", "i"))  # how a real and an imaginary part are called, alone or behind a common stem


@dataclass(frozen=True)
class StoredArray:
    """An array of numbers in a file: its kind (NumPy's letter: c for complex), its shape, and a function that loads it."""

    kind: str
    shape: tuple[int, ...]
    load: Callable[[], Any]

    @property
    def vector(self) -> bool:
        """Whether it is a list of two or more numbers, in whatever shape."""
        return max(self.shape, default=0) > 1 and sum(n > 1 for n in self.shape) == 1


@dataclass(frozen=True)
class Wanted:
    """What the user says of a file that holds several: the name of the array, and the row of it, counted from 1."""

    dataset: str | None = None
    row: int | None = None


def stem_of(name: str) -> tuple[str, int, int] | None:
    """omega_r as ('omega', 2, 0): the stem, which of COMPLEX_PARTS, 0 for the real part or 1 for the imaginary; None for other names."""
    for which, ends in enumerate(COMPLEX_PARTS):
        for part, end in enumerate(ends):
            if found := re.fullmatch(rf"(?:(.*)[ _.-])?{end}", name, re.IGNORECASE):
                return found[1] or "", which, part
    return None


def pairs(names: Sequence[str]) -> list[tuple[str, str, str]]:
    """(stem, re, im) of the names that are a real and an imaginary part: omega_r with omega_i, re with im."""
    halves: dict[tuple[str, int], dict[int, str]] = {}
    for name in names:
        if (stem := stem_of(name)) is not None:
            halves.setdefault(stem[:2], {})[stem[2]] = name
    return [(stem, both[0], both[1]) for (stem, _), both in halves.items() if len(both) == 2]


def with_pairs(arrays: Mapping[str, StoredArray], lone_stem: str) -> dict[str, StoredArray]:
    """The arrays, of any shape (a, b, …), where a real and an imaginary part have become one of the name of their stem."""
    out = dict(arrays)
    for stem, re_name, im_name in pairs(list(arrays)):
        first, second = arrays[re_name], arrays[im_name]
        if first.kind == "c" or second.kind == "c":
            continue
        del out[re_name], out[im_name]
        out[stem or lone_stem] = StoredArray("c", first.shape, lambda a=first, b=second, n=(re_name, im_name): _joined(a, b, n))  # type: ignore[misc]
    return out


def _joined(first: StoredArray, second: StoredArray, names: tuple[str, str]) -> Any:
    if first.shape != second.shape:
        raise ValueError(f"{names[0]} and {names[1]} are not a real and an imaginary part: their shapes are {first.shape}, {second.shape}")
    return first.load() + 1j * second.load()


def spectrum_in(arrays: Mapping[str, StoredArray], wanted: Wanted, there: Sequence[str]) -> NDArray[np.complex128]:
    """The eigenvalues (m,) in the array that is meant. Raises ValueError that lists what is there."""
    return as_complex(arrays[choose(arrays, wanted.dataset, there)].load(), wanted.row)


def _diagonal(array: StoredArray) -> bool:
    """Whether it is a square matrix, of two rows at least, with zeros beside its diagonal."""
    import numpy as np

    if len(array.shape) != 2 or array.shape[0] != array.shape[1] or array.shape[0] < 2:
        return False
    matrix = np.asarray(array.load())
    return bool(np.all(matrix == np.diag(matrix.diagonal())) and np.any(matrix))


def choose(arrays: Mapping[str, StoredArray], dataset: str | None, there: Sequence[str]) -> str:
    """The name of the array (a, b, …) that is meant.

    It is the one asked for; else eigenvalues or sigma; else the only one; else the only complex vector; else the only diagonal matrix.

    Raises ValueError that lists what is there.
    """
    listed = shortened(", ".join(there) or "none", LISTED).strip("'\"")
    if dataset is not None:
        if dataset in arrays:
            return dataset
        raise ValueError(f"no array of numbers called {shortened(dataset)} in it: there are {listed}")
    named = [name for name in EIGENVALUE_NAMES if name in arrays]
    if named or len(arrays) == 1:
        return named[0] if named else next(iter(arrays))
    vectors = [name for name, array in arrays.items() if array.kind == "c" and array.vector]
    if len(vectors) == 1:
        return vectors[0]
    diagonals = [name for name, array in arrays.items() if _diagonal(array)]
    if len(diagonals) == 1:  # MATLAB's D of [V, D] = eig(A)
        return diagonals[0]
    called = " or ".join(EIGENVALUE_NAMES)
    raise ValueError(f"arrays in it: {listed}: allowed is one array, or one of them called {called}, or --dataset NAME")


def as_complex(array: Any, row: int | None = None) -> NDArray[np.complex128]:
    """Eigenvalues (m,) of a list of numbers in whatever shape, of two real columns, or of a diagonal matrix (m, m); or of one row.

    Raises ValueError.
    """
    import numpy as np

    if not isinstance(array, np.ndarray) or array.dtype.kind not in "iufc":
        raise ValueError(f"an array of type {getattr(array, 'dtype', type(array).__name__)}: {ALLOWED_ARRAYS}")
    array = np.atleast_1d(array)
    if row is not None:
        if array.ndim < 2 or not 1 <= row <= len(array):
            rows = f"1 to {len(array)}" if array.ndim > 1 else "none"
            raise ValueError(f"--row {row} of an array of shape {array.shape}: allowed is {rows}")
        array = array[row - 1]
    if array.ndim == 2 and array.shape[1] == 2 and array.dtype.kind != "c":
        return np.asarray(array[:, 0] + 1j * array[:, 1], dtype=np.complex128)
    if array.ndim == 2 and array.shape[0] == array.shape[1] > 1 and not np.any(array[~np.eye(len(array), dtype=bool)]):
        return np.asarray(np.diagonal(array), dtype=np.complex128)
    if array.size != max(array.shape):
        choice = f", or --row N for one of its {len(array)} rows" if array.ndim > 1 and row is None else ""
        raise ValueError(f"an array of shape {array.shape}: {ALLOWED_ARRAYS}{choice}")
    return np.asarray(array.ravel(), dtype=np.complex128)
