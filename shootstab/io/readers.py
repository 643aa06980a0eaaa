"""Eigenvalue files. A reader is told by what the file begins with, never by its name."""

from __future__ import annotations

import json
import re
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from shootstab.core.errors import InputError
from shootstab.io import arrays, hdf5, legolas, matlab
from shootstab.io.notation import complex_from, shortened

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

LARGEST = 64 * 2**20
ALLOWED = "allowed is one eigenvalue a line, as re,im or as 1+2j"
ALLOWED_JSON = 'allowed is a list of numbers, of [re, im] or of {"re": …, "im": …}, or such a list named "eigenvalues"'

# what a reader yields: where in the file, and the number there
Placed = Iterator[tuple[str, complex]]


@dataclass(frozen=True)
class Reader:
    """One kind of file: whether these bytes are of it, and the eigenvalues in them (ValueError if they are malformed).

    A file that may hold several arrays has them chosen by name.
    """

    name: str
    recognises: Callable[[bytes], bool]
    values: Callable[[bytes, str | None], Placed]
    several: bool = False


def read(path: str | Path, dataset: str | None = None) -> NDArray[np.complex128]:
    """The eigenvalues in a file, in their order: csv or text, json, npy, npz, MATLAB, HDF5, Legolas.

    dataset is the name of the array that is meant, in a file that may hold several.

    Raises InputError, whose one line names the file, for a file that is missing, empty, larger than 64 MB or malformed, and for
    one that holds a NaN or an infinity.
    """
    data = _bytes(Path(path))
    reader = next((r for r in READERS if r.recognises(data)), None)
    if reader is None:
        known = ", ".join(r.name for r in READERS)
        raise InputError(f"{path}: not an eigenvalue file: allowed is {known}")
    if dataset is not None and not reader.several:
        raise InputError(
            f"{path}: --dataset {dataset}: allowed for {', '.join(r.name for r in READERS if r.several)}; this is {reader.name}"
        )
    try:
        values = [_finite(place, value) for place, value in reader.values(data, dataset)]
    except ValueError as error:
        raise InputError(f"{path}: {error}") from error
    if not values:
        raise InputError(f"{path}: holds no eigenvalue: allowed is a file with at least one")
    import numpy as np

    return np.array(values, dtype=np.complex128)


def _bytes(path: Path) -> bytes:
    try:
        with path.open("rb") as file:
            data = file.read(LARGEST + 1)
    except OSError as error:
        raise InputError(f"{path}: cannot be read: {error.strerror or error}: allowed is a file of eigenvalues") from error
    except ValueError as error:  # a NUL in the name
        raise InputError(f"{shortened(str(path))}: not the name of a file") from error
    if len(data) > LARGEST:
        raise InputError(f"{path}: larger than 64 MB: allowed is a smaller file")
    if not data.strip():
        raise InputError(f"{path}: the file is empty: allowed is a file with at least one eigenvalue")
    return data


def _finite(place: str, value: complex) -> complex:
    # x − x is 0 for every finite x, and NaN for the others
    if value - value != 0:
        raise ValueError(f"{place}: {value} is not finite: allowed are finite numbers")
    return value


# text

_SPLIT = re.compile(r"\s*[,;\t]\s*")
_RE = re.compile(r"(?<![a-z])re(al)?(?![a-z])", re.IGNORECASE)
_IM = re.compile(r"(?<![a-z])im(ag|aginary)?(?![a-z])", re.IGNORECASE)


def _text(data: bytes) -> Placed:
    columns: tuple[int, ...] | None = None
    width = 0
    for number, line in enumerate(_lines(data), 1):
        cells = _cells(line)
        if not cells:
            continue
        place = f"line {number}"
        if columns is None:
            width = len(cells)
            columns = _columns(cells, place)
            if not any(_is_number(c) for c in cells):
                continue
        if len(cells) != width:
            raise ValueError(f"{place}: {len(cells)} columns where the first line has {width}: {ALLOWED}")
        yield place, _joined([cells[c] for c in columns], place)


def _lines(data: bytes) -> list[str]:
    return re.split(r"\r\n|\r|\n", data.decode("utf-8-sig"))


def _cells(line: str) -> list[str]:
    """What the line holds: one cell if it is one number, blanks and all; none if it is a comment."""
    line = re.split(r"[#%]", line, maxsplit=1)[0].strip()
    if not line:
        return []
    if _is_number(line):
        return [line]
    if line.startswith("(") and line.endswith(")"):
        line = line[1:-1]
    cells = _SPLIT.split(line.strip().rstrip(",;")) if re.search(r"[,;\t]", line) else line.split()
    return [c.strip().strip("\"'") for c in cells]


def _columns(cells: list[str], place: str) -> tuple[int, ...]:
    """Which columns hold the number: those that the header names re and im, otherwise all of one or two."""
    re_at = [i for i, c in enumerate(cells) if _RE.search(c.replace("_", " "))]
    im_at = [i for i, c in enumerate(cells) if _IM.search(c.replace("_", " "))]
    if len(re_at) == len(im_at) == 1:
        return re_at[0], im_at[0]
    if len(cells) > 2:
        raise ValueError(f"{place}: {len(cells)} columns and no header that names re and im: {ALLOWED}")
    return tuple(range(len(cells)))


def _is_number(text: str) -> bool:
    try:
        complex_from(text)
    except ValueError:
        return False
    return True


def _joined(cells: list[Any], place: str) -> complex:
    """One complex number, or a real and an imaginary part."""
    try:
        parts = [_number(c) for c in cells]
    except ValueError as error:
        raise ValueError(f"{place}: {error}") from None
    if len(parts) == 1:
        return parts[0]
    if any(p.imag != 0.0 for p in parts):
        raise ValueError(f"{place}: {shortened(cells)} are not a real and an imaginary part")
    return complex(parts[0].real, parts[1].real)


def _number(cell: Any) -> complex:
    if isinstance(cell, str):
        return complex_from(cell)
    if isinstance(cell, int | float) and not isinstance(cell, bool):
        try:
            return complex(cell)
        except OverflowError:
            raise ValueError(f"{shortened(cell)} is larger than a double can be") from None
    raise ValueError(f"{shortened(cell)} is not a number")


def _is_text(data: bytes) -> bool:
    try:
        return "\0" not in data.decode("utf-8-sig")
    except UnicodeDecodeError:
        return False


# json


def _json(data: bytes) -> Placed:
    try:
        document = json.loads(data.decode("utf-8-sig"))
    except json.JSONDecodeError as error:
        raise ValueError(f"line {error.lineno}: broken JSON: {error.msg}: {ALLOWED_JSON}") from None
    except RecursionError:
        raise ValueError(f"nested too deep: {ALLOWED_JSON}") from None
    if isinstance(document, dict):
        document = document.get("eigenvalues")
    if not isinstance(document, list):
        raise ValueError(f"no list of eigenvalues in it: {ALLOWED_JSON}")
    for number, entry in enumerate(document, 1):
        place = f"entry {number}"
        if isinstance(entry, dict) and {"re", "im"} <= entry.keys():
            yield place, _joined([entry["re"], entry["im"]], place)
        elif isinstance(entry, list) and len(entry) == 2:
            yield place, _joined(entry, place)
        elif isinstance(entry, list | dict):
            raise ValueError(f"{place}: {shortened(entry)}: {ALLOWED_JSON}")
        else:
            yield place, _joined([entry], place)


def _is_json(data: bytes) -> bool:
    return data.removeprefix(b"\xef\xbb\xbf").lstrip()[:1] in (b"[", b"{") and _is_text(data)


# the table: the first that recognises a file reads it


def _placed(values: Callable[[bytes, str | None], NDArray[np.complex128]]) -> Callable[[bytes, str | None], Placed]:
    def placed(data: bytes, dataset: str | None) -> Placed:
        for number, value in enumerate(values(data, dataset), 1):
            yield f"entry {number}", complex(value)

    return placed


READERS = (
    Reader("npy", lambda data: data.startswith(arrays.MAGIC), _placed(lambda data, _: arrays.from_npy(data))),
    Reader("npz", lambda data: data.startswith(arrays.MAGIC_ZIP), _placed(lambda data, name: arrays.from_npz(data, name, LARGEST)), True),
    Reader("HDF5", hdf5.is_hdf5, _placed(lambda data, name: hdf5.from_hdf5(data, name, LARGEST)), True),
    Reader("MATLAB", lambda data: data.startswith(matlab.MAGIC), _placed(lambda data, name: matlab.from_mat(data, name, LARGEST)), True),
    Reader("Legolas", lambda data: data.startswith(legolas.MAGIC), _placed(lambda data, _: legolas.from_legolas(data))),
    Reader("json", _is_json, lambda data, _: _json(data)),
    Reader("csv or text in UTF-8", _is_text, lambda data, _: _text(data)),
)
