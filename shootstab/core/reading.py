"""What a file says that anybody may have written: its bytes, its text, its JSON or TOML, or a refusal in words of the file."""

from __future__ import annotations

import json
import os
import re
import stat
import tomllib
from pathlib import Path
from typing import Any

from shootstab.core.errors import InputError, shortened

MOST_KEY_PARTS = 100  # chosen: dots between the parts of a key, in one line
_PARTS = re.compile(r"\.(?!\d)|\.\d+(?=\.)")  # dots that are not the point of a number
MEGABYTE = 2**20  # defined by the IEC: bytes in one


def bytes_of(path: Path, largest: int, what: str) -> bytes:
    """The whole content, at most `largest` bytes; of a pipe what its writers have to say, and nothing if it has none.

    Raises InputError, which says that allowed is `what`, for a file that cannot be read or is larger, and for a device, which could give
    bytes for ever and is not even opened.
    """
    try:
        mode = path.stat().st_mode
        if stat.S_ISCHR(mode) or stat.S_ISBLK(mode):
            raise InputError(f"{path}: is a device: allowed is {what}")
        with open(path, "rb", opener=_at_once) as file:
            os.set_blocking(file.fileno(), True)
            data = file.read(largest + 1)
    except OSError as error:
        raise InputError(f"{path}: cannot be read: {error.strerror or error}: allowed is {what}") from error
    except ValueError as error:
        if isinstance(error, InputError):
            raise
        raise InputError(f"{shortened(str(path))}: not the name of a file") from error  # a NUL in it
    if len(data) > largest:
        raise InputError(f"{path}: larger than {largest / MEGABYTE:.3g} MB: allowed is a smaller file")
    return data


def text_of(data: bytes) -> str:
    """UTF-8, with or without a byte order mark. Raises ValueError that names the line where it is none."""
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        place = data.count(b"\n", 0, error.start) + 1
    raise ValueError(f"line {place}: not UTF-8: allowed is text in UTF-8")


def json_of(text: str, allowed: str) -> Any:
    """The document. Raises ValueError that names the line, or says what no JSON of ours holds, and what is allowed."""
    try:
        return json.loads(text)
    except json.JSONDecodeError as error:
        raise ValueError(f"line {error.lineno}: broken JSON: {error.msg}: {allowed}") from None
    except RecursionError:
        raise ValueError(f"nested too deep: {allowed}") from None
    except ValueError:  # Python reads integers of up to 4300 digits
        raise ValueError(f"an integer of thousands of digits: {allowed}") from None


def toml_of(path: Path, largest: int, what: str) -> dict[str, Any]:
    """The tables of a TOML file of at most `largest` bytes. Raises InputError, which says that allowed is `what`."""
    data = bytes_of(path, largest, what)
    try:
        text = text_of(data)
        for number, line in enumerate(text.splitlines(), 1):
            if len(_PARTS.findall(line)) > MOST_KEY_PARTS:  # tomllib takes the square of them
                raise InputError(f"{path}: line {number}: a key of more than {MOST_KEY_PARTS} parts: allowed is {what}")
        return tomllib.loads(text)
    except RecursionError:
        raise InputError(f"{path}: broken TOML: nested too deep: allowed is {what}") from None
    except InputError:
        raise
    except ValueError as error:
        # Python reads integers of up to 4300 digits, and says so in words of its own
        digits = not isinstance(error, tomllib.TOMLDecodeError) and "digits" in str(error)
        raise InputError(f"{path}: broken TOML: {'an integer of thousands of digits' if digits else error}") from None


def _at_once(name: str, flags: int) -> int:
    """A descriptor without waiting: a pipe that nobody writes to would be waited for as it is opened."""
    return os.open(name, flags | getattr(os, "O_NONBLOCK", 0))
