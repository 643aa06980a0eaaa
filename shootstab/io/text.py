"""Spectra as text: one eigenvalue a line, in one column or in two that a header names, with points or with commas for decimals."""

from __future__ import annotations

import codecs
import re
from collections.abc import Iterator
from typing import Any

from shootstab.core.errors import shortened
from shootstab.core.reading import MEGABYTE, text_of
from shootstab.io.arrays import pairs
from shootstab.io.notation import complex_from

ALLOWED_TEXT = "allowed is one eigenvalue a line, as re,im or as 1+2j"
# what a reader yields: where in the file, and the number there
Placed = Iterator[tuple[str, complex]]

MOST_EIGENVALUES = 100_000  # chosen: eigenvalues in a file; each takes milliseconds to be judged
LARGEST_TEXT = 16 * 2**20  # chosen: bytes of text; more than so many eigenvalues of any precision take
MOST_ROWS, LONGEST_ROW = 2 * MOST_EIGENVALUES, 10_000  # chosen

_SPLIT = re.compile(r"\s*[,;\t]\s*")
_DECIMAL_COMMA = re.compile(r"([+−-]?\d+),(\d+(?:[ed][+-]?\d+)?)", re.IGNORECASE | re.ASCII)
_RE = re.compile(r"(?<![a-z])re(al)?(?![a-z])", re.IGNORECASE)
_IM = re.compile(r"(?<![a-z])im(ag|aginary)?(?![a-z])", re.IGNORECASE)
LOOKED_AT = 65_536  # chosen: bytes at the beginning that tell text from a binary file


def from_text(data: bytes) -> Placed:
    """Line by line. Raises ValueError that names the line."""
    columns: tuple[int, ...] | None = None
    width = 0
    remark = ""  # the last comment before the numbers may be their header
    for number, line in enumerate(_lines(data), 1):
        cells = _cells(line)
        if not cells:
            remark = line if columns is None and line.strip() else remark
            continue
        place = f"line {number}"
        if columns is None:
            width = len(cells)
            columns = _columns(cells, _header(remark), place)
            if not any(is_number(c) for c in cells):
                continue
        if len(cells) != width:
            raise ValueError(f"{place}: {len(cells)} columns where the first line has {width}: {ALLOWED_TEXT}")
        yield place, joined([cells[c] for c in columns], place)


def is_text(data: bytes) -> bool:
    """Whether it begins as UTF-8 and holds no NUL."""
    try:
        codecs.getincrementaldecoder("utf-8-sig")().decode(data[:LOOKED_AT])
    except UnicodeDecodeError:
        return False
    return b"\0" not in data


def decoded(data: bytes) -> str:
    """The text. Raises ValueError where it is too long, or is no UTF-8 further on."""
    if len(data) > LARGEST_TEXT:
        raise ValueError(f"more than {LARGEST_TEXT / MEGABYTE:.3g} MB of text: allowed is less text, or a binary file")
    return text_of(data)


def _lines(data: bytes) -> list[str]:
    if max(data.count(b"\n"), data.count(b"\r")) > MOST_ROWS:
        raise ValueError(f"more than {MOST_ROWS} lines: allowed are {MOST_EIGENVALUES} eigenvalues")
    lines = re.split(r"\r\n|\r|\n", decoded(data))
    for number, line in enumerate(lines, 1):
        if len(line) > LONGEST_ROW:
            raise ValueError(f"line {number}: longer than {LONGEST_ROW} characters: {ALLOWED_TEXT}")
    return lines


def _cells(line: str) -> list[str]:
    """What the line holds: one cell if it is one number, blanks and all; none if it is a comment."""
    line = re.split(r"[#%]", line, maxsplit=1)[0].strip()
    if not line:
        return []
    if is_number(line):
        return [line]
    if line.startswith("(") and line.endswith(")"):
        line = line[1:-1]
    line = line.strip().rstrip(",;")
    words = _with_points(re.split(r"\s*[;\t]\s*|\s+", line))
    if words is not None:
        return words
    cells = _SPLIT.split(line) if re.search(r"[,;\t]", line) else line.split()
    return [c.strip().strip("\"'") for c in cells]


def _with_points(words: list[str]) -> list[str] | None:
    """0,004 and -0,5 as 0.004 and -0.5, where something else than a comma separates them and every comma stands between digits."""
    if len(words) < 2 or not any("," in p for p in words):
        return None
    if not all(_DECIMAL_COMMA.fullmatch(p) or ("," not in p and is_number(p)) for p in words):
        return None
    return [p.replace(",", ".") for p in words]


def _header(remark: str) -> list[str]:
    """The words of a comment."""
    return [w for w in re.split(r"[\s,;]+", remark.strip().lstrip("#%").strip()) if w]


def _columns(cells: list[str], header: list[str], place: str) -> tuple[int, ...]:
    """The columns that hold the number: those that a header of as many words names re and im, otherwise all of one or two."""
    for names in (cells, header if len(header) == len(cells) else []):
        re_at = [i for i, c in enumerate(names) if _RE.search(c.replace("_", " "))]
        im_at = [i for i, c in enumerate(names) if _IM.search(c.replace("_", " "))]
        if len(re_at) == len(im_at) == 1:
            return re_at[0], im_at[0]
        by_stem = pairs(names) if len(set(names)) == len(names) else []
        if len(by_stem) == 1:
            return names.index(by_stem[0][1]), names.index(by_stem[0][2])
    if len(cells) > 2:
        raise ValueError(f"{place}: {len(cells)} columns and no header that names re and im: {ALLOWED_TEXT}")
    return tuple(range(len(cells)))


def is_number(text: str) -> bool:
    """Whether complex_from reads it."""
    try:
        complex_from(text)
    except ValueError:
        return False
    return True


def joined(cells: list[Any], place: str) -> complex:
    """One complex number, or a real and an imaginary part. Raises ValueError."""
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
