"""Fields over a coordinate as files: csv with one row a point, npz with arrays."""

from __future__ import annotations

import csv
import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from shootstab.core.errors import InputError
from shootstab.io.files import write_whole

TABLE_SUFFIXES = (".csv", ".npz")


def save(z: NDArray[np.float64], fields: Mapping[str, NDArray[Any]], path: Path, about: Mapping[str, Any]) -> None:
    """The fields (m,) at z (m,) as a csv or npz file, told by its suffix.

    Raises InputError for another suffix, OutputError where the file cannot be written.

    csv has the columns z and NAME, or NAME_re and NAME_im of a complex field; npz has the arrays z and NAME, and `about`, JSON in a string.
    """
    if path.suffix.lower() == ".csv":
        write_whole(path, lambda file: _write_csv(file, z, fields))
    elif path.suffix.lower() == ".npz":
        arrays: dict[str, Any] = {"z": z, **fields, "about": np.str_(json.dumps(about, default=str))}
        write_whole(path, lambda file: np.savez(file, **arrays))
    else:
        raise InputError(f"{path}: allowed is a file name that ends in {' or '.join(TABLE_SUFFIXES)}")


def _write_csv(path: Path, z: NDArray[np.float64], fields: Mapping[str, NDArray[Any]]) -> None:
    columns: dict[str, NDArray[Any]] = {"z": z}
    for name, field in fields.items():
        columns |= {name: field} if np.isrealobj(field) else {f"{name}_re": field.real, f"{name}_im": field.imag}
    with path.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        writer.writerow(columns)
        writer.writerows(zip(*([repr(float(x)) for x in column] for column in columns.values()), strict=True))
