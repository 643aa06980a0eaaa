"""The results of a sweep in an SQLite file, as they come: a sweep that was interrupted goes on where it stopped.

Table `sweep` holds one row, the definition as JSON; table `points` one row a point, with the swept parameters as its key, then re, im,
error, status, proved, floor, evaluations; table `below` likewise re and im of the modes that were followed across the neutral curve, empty
where none arrived. A line of points is written in one transaction, so a line is there whole or not at all,
whatever ends the process. A point that another run on the same file has written meanwhile is left as it is: its values are the same.
What is read is held against what a sweep can have written: the tables to the letter, the points to the grid, each value to its kind.
"""

from __future__ import annotations

import json
import sqlite3
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from types import TracebackType
from typing import Any, NoReturn

from shootstab.analyses.sweep.grid import Point, SweepGrid
from shootstab.analyses.sweep.outcomes import OUTCOMES, Outcome
from shootstab.core.errors import InputError, OutputError, shortened

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
ALLOWED_STORE = "allowed is a new file or one of `shootstab sweep`"
BELOW_COLUMNS = {"re": "REAL", "im": "REAL"}
SWEEP = "CREATE TABLE sweep (definition TEXT NOT NULL)"


class Store:
    """An open file of results; in memory if there is no path."""

    def __init__(self, path: Path | None, names: Sequence[str], definition: dict[str, Any]) -> None:
        """Open or make the file. Raises InputError where it holds something else, or another sweep."""
        self._path, self._names = path, tuple(names)
        if path is not None and path.exists() and not path.is_file():
            raise InputError(f"{path}: is no regular file: {ALLOWED_STORE}")
        with self._refusing():
            self._base = sqlite3.connect(":memory:" if path is None else path.absolute(), isolation_level=None)
        try:
            self._begin(definition)
        except BaseException:
            self.close()
            raise

    def _begin(self, definition: dict[str, Any]) -> None:
        text = json.dumps(definition, sort_keys=True)
        tables = {"points": self._table("points", STORED_COLUMNS), "below": self._table("below", BELOW_COLUMNS)}
        with self._refusing(), self._base:
            self._base.execute("BEGIN IMMEDIATE")
            there = dict(self._base.execute("SELECT name, sql FROM sqlite_master WHERE sql IS NOT NULL"))
            if not there:
                self._base.execute(SWEEP)
                self._base.execute("INSERT INTO sweep VALUES (?)", (text,))
                for made in tables.values():
                    self._base.execute(made)
            elif not {"sweep", "points"} <= set(there) or there["sweep"] != SWEEP:
                raise InputError(f"{self._path}: holds other tables: {ALLOWED_STORE}")
            else:
                self._require_same(definition, text)
                if set(there) != {"sweep", *tables}:
                    raise InputError(f"{self._path}: holds other tables: {ALLOWED_STORE}")
                for name, made in tables.items():
                    if there[name] != made:
                        self._broken(f"its table {name!r} has other columns")

    def _table(self, name: str, stored: Mapping[str, str]) -> str:
        """A table of points in SQL."""
        columns = [f'"{n}" REAL NOT NULL' for n in self._names] + [f"{n} {kind}" for n, kind in stored.items()]
        return f"CREATE TABLE {name} ({', '.join(columns)}, PRIMARY KEY ({self._keys})) WITHOUT ROWID"

    @property
    def _keys(self) -> str:
        return ", ".join(f'"{n}"' for n in self._names)

    def _require_same(self, definition: dict[str, Any], text: str) -> None:
        rows = self._base.execute("SELECT definition FROM sweep LIMIT 2").fetchall()
        if rows == [(text,)]:
            return
        try:
            ((words,),) = rows
            found = json.loads(words)
        except (ValueError, TypeError, RecursionError):
            found = None
        if not isinstance(found, dict):
            self._broken("it does not say which sweep it holds")
        raise InputError(f"{self._path}: holds another sweep, of other {_differences(found, definition)}: allowed is a new file")

    def _broken(self, why: str) -> NoReturn:
        raise InputError(f"{self._path}: is not as a sweep leaves it: {why}: {ALLOWED_STORE}")

    @contextmanager
    def _refusing(self) -> Iterator[None]:
        """What SQLite says of a file that it cannot use, as InputError."""
        try:
            yield
        except sqlite3.Error as error:
            raise InputError(f"{self._path}: cannot be used for results: {error}: {ALLOWED_STORE}") from error
        except UnicodeDecodeError:
            self._broken("a text in it is not UTF-8")

    def done(self, grid: SweepGrid) -> list[Point]:
        """The points that have a result. Raises InputError for one that is not of the grid."""
        values = [frozenset(axis.values) for axis in grid.axes]
        with self._refusing():
            points: list[Point] = list(self._base.execute(f"SELECT {self._keys} FROM points"))
        for point in points:
            if not all(place in axis for place, axis in zip(point, values, strict=True)):
                self._broken(f"{shortened(point)} is no point of its grid")
        return points

    def require_writable(self) -> None:
        """Raise InputError, before any work, where its results could not be written."""
        with self._refusing(), self._base:
            self._base.execute("BEGIN IMMEDIATE")
            self._base.execute("UPDATE sweep SET definition = definition")
            self._base.execute("ROLLBACK")

    def add(self, points: Sequence[Point], outcomes: Sequence[Outcome]) -> None:
        """Results of one line of points, all or none. Raises OutputError where they cannot be written."""
        self._insert("points", [(*p, *_row(o)) for p, o in zip(points, outcomes, strict=True)])

    def add_below(self, point: Point, sigma: complex | None) -> None:
        """The mode followed to a point at which nothing grows, None where none arrived. Raises OutputError."""
        self._insert("below", [(*point, *_parts(sigma))])

    def _insert(self, table: str, rows: Sequence[tuple[Any, ...]]) -> None:
        insert = f"INSERT OR IGNORE INTO {table} VALUES ({', '.join('?' * len(rows[0]))})"
        try:
            self._base.execute("BEGIN IMMEDIATE")
            self._base.executemany(insert, rows)
            self._base.execute("COMMIT")
        except sqlite3.Error as error:
            if self._base.in_transaction:
                self._base.execute("ROLLBACK")
            raise OutputError(f"{self._path}: results cannot be written: {error}: what is there already is kept") from error

    def results(self) -> dict[Point, Outcome]:
        """Everything that is there. Raises InputError for a row that no sweep has written."""
        n = len(self._names)
        found: dict[Point, Outcome] = {}
        with self._refusing():
            for row in self._base.execute("SELECT * FROM points"):
                try:
                    found[row[:n]] = _outcome(row[n:])
                except (ValueError, TypeError, AttributeError, RecursionError):
                    self._broken(f"{shortened(row)} is no result")
        return found

    def below(self) -> dict[Point, complex | None]:
        """What was followed across the neutral curve, by the point to which. Raises InputError for a row that no sweep has written."""
        n = len(self._names)
        found: dict[Point, complex | None] = {}
        with self._refusing():
            for row in self._base.execute("SELECT * FROM below"):
                try:
                    found[row[:n]] = _number(*row[n:])
                except (ValueError, TypeError):
                    self._broken(f"{shortened(row)} is no result")
        return found

    def close(self) -> None:
        """Close the file."""
        self._base.close()

    def __enter__(self) -> Store:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None) -> None:
        self.close()


def _row(outcome: Outcome) -> tuple[Any, ...]:
    beside = json.dumps(dict(outcome.beside))
    return *_parts(outcome.sigma), outcome.error, outcome.status, int(outcome.proved), outcome.floor, outcome.evaluations, beside


def _parts(sigma: complex | None) -> tuple[float | None, float | None]:
    return (None, None) if sigma is None else (sigma.real, sigma.imag)


def _number(re: Any, im: Any) -> complex | None:
    """The number of two parts. Raises TypeError or ValueError where they are none."""
    if not isinstance(re, float | None) or not isinstance(im, float | None):
        raise TypeError
    if (re is None) != (im is None):
        raise ValueError
    return None if re is None or im is None else complex(re, im)


def _outcome(row: Sequence[Any]) -> Outcome:
    """The outcome of a row. Raises ValueError, TypeError or AttributeError where it is none."""
    re, im, error, status, proved, floor, evaluations, beside = row
    if status.partition(":")[0] not in OUTCOMES or proved not in (0, 1) or not isinstance(evaluations, int):
        raise ValueError
    for number in (error, floor):
        if not isinstance(number, float | None):
            raise TypeError
    said = json.loads(beside)
    if not all(isinstance(value, float) for value in said.values()):
        raise ValueError
    return Outcome(status, bool(proved), _number(re, im), error, floor, evaluations, said)


def _differences(found: dict[str, Any], wanted: dict[str, Any]) -> str:
    """The names of what differs."""
    different = [key for key in sorted(found.keys() | wanted.keys()) if found.get(key) != wanted.get(key)]
    return " and ".join(different)
