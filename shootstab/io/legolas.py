"""Legolas' own binary files (.dat): the header is walked through to the eigenvalues, nothing is guessed and nothing else is read.

Written by Fortran as a stream: 4-byte integers and logicals, 8-byte reals, texts with their length before them, in the byte order of the
machine. The layout is that of Legolas 1.0.2 to 1.3 and of 2.x, and that of the files before, which name
no version of Legolas and hold as many eigenvalues as the matrix has rows (N. Claes, J. De Jonghe & R. Keppens, ApJS 251 (2020) 25;
src/dataIO/mod_output of its repository). The eigenvalues are frequencies, exp(−iωt).
"""

from __future__ import annotations

import re
import struct
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

LEGOLAS_MAGIC = b"legolas_version"
LONGEST_TEXT = 4096  # chosen: characters of a name or text; no header has longer ones
MOST_HEADER_ENTRIES = 10_000  # chosen: names, units, nodes: no header has as many
MAGIC_OLD = b"datfile_version"
GEOMETRIES = (b"Cartesian", b"cylindrical")
UNITS_OLD = 11  # defined by the format: normalizations in a file that does not name them
ALLOWED_LEGOLAS = "allowed is a file of Legolas, version 1 or 2"
BEFORE_PARAMETERS = 14  # defined by the format: integers between the cooling curve and the parameters


class _Stream:
    """A position in the bytes of a file. Raises ValueError behind their end, and for sizes that no header has."""

    def __init__(self, data: bytes, at: int, order: str) -> None:
        self.data, self.at, self.order = data, at, order

    def take(self, size: int) -> bytes:
        if size < 0 or self.at + size > len(self.data):
            raise ValueError("broken Legolas file: it ends early")
        self.at += size
        return self.data[self.at - size : self.at]

    def integers(self, count: int = 1) -> tuple[int, ...]:
        return struct.unpack(f"{self.order}{count}i", self.take(4 * count))

    def size(self, most: int = MOST_HEADER_ENTRIES) -> int:
        (value,) = self.integers()
        if not 0 <= value <= most:
            raise ValueError(f"broken Legolas file: a size of {value} in its header")
        return value

    def text(self) -> None:
        """A text with its length before it."""
        self.take(self.size(LONGEST_TEXT))

    def reals(self, count: int = 1) -> None:
        self.take(8 * count)

    def table(self, bytes_each: int = 0) -> None:
        """Names, all of one length, each followed by so many bytes."""
        count, length = self.size(), self.size(LONGEST_TEXT)
        self.take(count * (length + bytes_each))


def is_legolas(data: bytes) -> bool:
    """Whether a version is named, or lengths of texts and a geometry stand at the beginning."""
    return data.startswith((LEGOLAS_MAGIC, MAGIC_OLD)) or data[8:].startswith(GEOMETRIES)


def from_legolas(data: bytes, _: object = None) -> NDArray[np.complex128]:
    """The eigenvalues (m,) in the bytes of a Legolas file, as frequencies. Raises ValueError."""
    import numpy as np

    stream, count = _named(data) if data.startswith(LEGOLAS_MAGIC) else _unnamed(data)
    values = np.frombuffer(stream.take(np.dtype(np.complex128).itemsize * count), dtype=f"{stream.order}c16")
    return np.asarray(values, dtype=np.complex128)


def _order(data: bytes, begin: int) -> str:
    """The byte order in which the length of texts at this place is one."""
    order = next((o for o in "<>" if 0 < struct.unpack(f"{o}i", data[begin : begin + 4].ljust(4, b"\xff"))[0] <= LONGEST_TEXT), None)
    if order is None:
        raise ValueError("broken Legolas file: no length of texts at its beginning")
    return order


def _unnamed(data: bytes) -> tuple[_Stream, int]:
    """A file before 1.0.2, read up to its eigenvalues, and how many there are."""
    begin = len(MAGIC_OLD) + 4 if data.startswith(MAGIC_OLD) else 0
    stream = _Stream(data, begin, _order(data, begin))
    length, in_tables = stream.size(LONGEST_TEXT), stream.size(LONGEST_TEXT)
    stream.take(length)  # geometry
    stream.reals(2)
    _, _, count, _ = stream.integers(4)  # points of the grid, of Gauss, rows of the matrix, points of eigenfunctions
    stream.reals()
    stream.take(length)  # equilibrium
    stream.integers(2)
    parameters = stream.size()
    stream.take(parameters * in_tables)
    stream.reals(parameters)
    stream.take(stream.size() * in_tables)  # names of equilibrium arrays
    stream.integers()
    stream.reals(UNITS_OLD)
    if count < 0:
        raise ValueError(f"broken Legolas file: a size of {count} in its header")
    return stream, count


def _named(data: bytes) -> tuple[_Stream, int]:
    """A file from 1.0.2 on, likewise."""
    words = data[len(LEGOLAS_MAGIC) : len(LEGOLAS_MAGIC) + 10].decode("ascii", errors="replace").strip()
    numbers = re.findall(r"\d+", words)
    version = tuple(int(n[:6]) for n in numbers[:3])
    if not (1, 0, 2) <= version < (3,):
        raise ValueError(f"Legolas version {words!r}: {ALLOWED_LEGOLAS}")
    begin = len(LEGOLAS_MAGIC) + 10
    stream = _Stream(data, begin, _order(data, begin))
    (_header_2 if version >= (2,) else _header_1)(stream, version)
    (count,) = stream.integers()
    return stream, count


def _header_1(stream: _Stream, version: tuple[int, ...]) -> None:
    """The header of versions 1.0.2 to 1.3, read up to the number of eigenvalues."""
    length, _ = stream.size(LONGEST_TEXT), stream.size(LONGEST_TEXT)
    stream.take(length)  # geometry
    stream.reals(2)
    stream.integers(4)
    stream.reals()
    stream.take(length)  # equilibrium
    flags = 2 + (version >= (1, 1, 3)) + 2 * (version >= (1, 3))
    stream.integers(flags)
    if version >= (1, 1, 4):
        stream.integers()
        stream.reals(3)
    count, length = stream.size(), stream.size(LONGEST_TEXT)
    stream.take(count * length)
    stream.reals(count)
    stream.table()  # equilibrium arrays
    stream.integers()
    count, length = stream.size(), stream.size(LONGEST_TEXT)
    stream.take(count * length)
    stream.reals(count)


def _header_2(stream: _Stream, version: tuple[int, ...]) -> None:
    """The header of versions 2.x, read up to the number of eigenvalues."""
    stream.integers(2)
    stream.integers()  # equations
    stream.text()
    length, count = stream.size(LONGEST_TEXT), stream.size()
    stream.take(length * count)
    stream.integers(4)
    stream.text()  # geometry
    stream.integers(3)
    stream.reals(2 * stream.size())
    stream.reals(2)
    stream.integers(6)
    stream.reals(3)
    stream.text()  # solver
    stream.text()
    stream.integers()
    stream.text()
    stream.integers(2)
    stream.reals(3)
    stream.text()  # equilibrium
    stream.text()
    count = stream.size()
    stream.integers()
    for _ in range(count):  # units
        stream.text()
        stream.reals()
    stream.reals()
    stream.integers(3)
    stream.text()  # cooling curve
    stream.integers(BEFORE_PARAMETERS)
    stream.table(8)  # parameters
    stream.table()  # equilibrium arrays
