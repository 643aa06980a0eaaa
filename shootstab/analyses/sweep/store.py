"""The results of a sweep in an SQLite file, as they come: a sweep that was interrupted goes on where it stopped.

Table `sweep` holds one row, the definition as JSON; table `points` one row a point, with the swept parameters as its key, then re, im,
error, status, proved, floor, evaluations. A line of points is written in one transaction, so a line is there whole or not at all.
"""

from __future__ import annotations

import json
import sqlite3
from collections.abc import Sequence
from pathlib import Path
from types import TracebackType
from typing import Any

from shootstab.analyses.sweep.grid import Point
from shootstab.analyses.sweep.outcomes import Outcome
from shootstab.core.errors import InputError

STORED_COLUMNS = {
    "re": "REAL",
    "im": "REAL",
    "error": "REAL",
    "status": "TEXT",
    "proved": "INTEGER",
    "floor": "REAL",
    "evaluations": "INTEGER",
    "beside": "TEXT",
}


class Store:
    """An open file of results; in memory if there is no path. Only one process writes."""

    def __init__(self, path: Path | None, names: Sequence[str], definition: dict[str, Any]) -> None:
        """Open or make the file. Raises InputError where it holds something else, or another sweep."""
        self._path, self._names = path, tuple(names)
        try:
            self._base = sqlite3.connect(":memory:" if path is None else path, isolation_level=None)
            self._begin(definition)
        except sqlite3.Error as error:
            raise InputError(f"{path}: cannot be used for results: {error}: allowed is a new file or one of `shootstab sweep`") from error

    def _begin(self, definition: dict[str, Any]) -> None:
        text = json.dumps(definition, sort_keys=True)
        with self._base:
            self._base.execute("BEGIN IMMEDIATE")
            tables = {row[0] for row in self._base.execute("SELECT name FROM sqlite_master WHERE type = 'table'")}
            if not tables:
                self._base.execute("CREATE TABLE sweep (definition TEXT NOT NULL)")
                self._base.execute("INSERT INTO sweep VALUES (?)", (text,))
                keys = ", ".join(f'"{n}"' for n in self._names)
                columns = [f'"{n}" REAL NOT NULL' for n in self._names] + [f"{n} {kind}" for n, kind in STORED_COLUMNS.items()]
                self._base.execute(f"CREATE TABLE points ({', '.join(columns)}, PRIMARY KEY ({keys})) WITHOUT ROWID")
                self._base.execute("COMMIT")
                return
            if not {"sweep", "points"} <= tables:
                raise InputError(f"{self._path}: holds other tables: allowed is a new file or one of `shootstab sweep`")
            (found,) = self._base.execute("SELECT definition FROM sweep").fetchone()
            self._base.execute("COMMIT")
        if found != text:
            other = _differences(json.loads(found), definition)
            raise InputError(f"{self._path}: holds another sweep, of other {other}: allowed is a new file")

    def done(self) -> list[Point]:
        """The points that have a result."""
        keys = ", ".join(f'"{n}"' for n in self._names)
        return list(self._base.execute(f"SELECT {keys} FROM points"))

    def add(self, points: Sequence[Point], outcomes: Sequence[Outcome]) -> None:
        """Results of one line of points, all or none. Raises InputError where they cannot be written."""
        marks = ", ".join("?" * (len(self._names) + len(STORED_COLUMNS)))
        try:
            self._base.execute("BEGIN IMMEDIATE")
            self._base.executemany(f"INSERT INTO points VALUES ({marks})", [(*p, *_row(o)) for p, o in zip(points, outcomes, strict=True)])
            self._base.execute("COMMIT")
        except sqlite3.Error as error:
            if self._base.in_transaction:
                self._base.execute("ROLLBACK")
            raise InputError(f"{self._path}: results cannot be written: {error}") from error

    def results(self) -> dict[Point, Outcome]:
        """Everything that is there."""
        n = len(self._names)
        return {row[:n]: _outcome(row[n:]) for row in self._base.execute("SELECT * FROM points")}

    def close(self) -> None:
        """Close the file."""
        self._base.close()

    def __enter__(self) -> Store:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None) -> None:
        self.close()


def _row(outcome: Outcome) -> tuple[Any, ...]:
    sigma = outcome.sigma
    re, im = (None, None) if sigma is None else (sigma.real, sigma.imag)
    return re, im, outcome.error, outcome.status, int(outcome.proved), outcome.floor, outcome.evaluations, json.dumps(dict(outcome.beside))


def _outcome(row: Sequence[Any]) -> Outcome:
    re, im, error, status, proved, floor, evaluations, beside = row
    return Outcome(status, bool(proved), None if re is None else complex(re, im), error, floor, evaluations, json.loads(beside))


def _differences(found: dict[str, Any], wanted: dict[str, Any]) -> str:
    """The names of what differs."""
    different = [key for key in sorted(found.keys() | wanted.keys()) if found.get(key) != wanted.get(key)]
    return " and ".join(different)
