"""What a model says of its scenes: the keys that a table of a scene file has, what the problem is, and the scenes that are built in.

A model offers a `SceneModel`; io.scenes reads TOML and hands it the tables.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, Protocol

from shootstab.core.errors import InputError, shortened

LARGEST_NUMBER = 1e300  # chosen: whatever is not below it, NaN too, is no number of physics

Tables = Mapping[str, Any]  # the tables of a scene file, by name


@dataclass(frozen=True)
class Description:
    """What a problem is, for whoever brings eigenvalues of it: the order of the system, its unknowns, the symmetry, the scales, and what
    the eigenvalue is, with the sign of time. Words that are empty are not known.
    """

    order: int
    unknowns: str = ""
    symmetry: str = ""
    scales: str = ""
    eigenvalue: str = ""

    def __str__(self) -> str:
        unknowns = f" in {self.unknowns}" if self.unknowns else ""
        return "; ".join(part for part in (self.symmetry, f"order {self.order}{unknowns}", self.scales, self.eigenvalue) if part)


class NamedScene(Protocol):
    """A scene with a name of its own: one line on it, and what a scene file would say."""

    @property
    def description(self) -> str:
        """The line that describes the scene."""
        ...

    @property
    def tables(self) -> Tables:
        """The tables of a scene file that the model reads, by name."""
        ...


@dataclass(frozen=True)
class BuiltIn:
    """See NamedScene: one that is held in memory."""

    description: str
    tables: Tables


@dataclass(frozen=True)
class Made:
    """What came of the tables: a problem, its description, the unit of σ in words, and the base flow under it if the model has one."""

    problem: Any
    details: Description
    unit: str = ""
    flow: Any = None


class SceneModel(Protocol):
    """One model as scene files see it."""

    @property
    def tables(self) -> tuple[str, ...]:
        """The names of its tables, all of which a scene file must have."""
        ...

    @property
    def built_in(self) -> Mapping[str, NamedScene]:
        """The model's own scenes by name."""
        ...

    def details(self, tables: Tables) -> Description:
        """What the problem of these tables is. Raises InputError as `made` does for their keys."""
        ...

    def made(self, tables: Tables) -> Made:
        """The problem. Raises InputError, whose line names the table, the key and what is allowed."""
        ...


def require_keys(name: str, table: Mapping[Any, Any], needed: Sequence[str], allowed: Sequence[str], beside: str = "") -> None:
    """Raise InputError for a table, so called in words, with a key that is not allowed, or without one that is needed.

    beside says what else is needed.
    """
    for key in table:
        if key not in allowed:
            raise InputError(f"{name} has the unknown key {shortened(key)}: allowed are {', '.join(allowed)}")
    for key in needed:
        if key not in table:
            raise InputError(f"{name} lacks the key {key}: needed are {', '.join(needed)}{beside}")


@dataclass(frozen=True)
class Keys:
    """The keys that a table of a scene file may have, with their types; needed are those in `required`, and one of `either`."""

    name: str
    keys: Mapping[str, type]
    required: tuple[str, ...] = ()
    either: tuple[str, ...] = field(default=())

    def checked(self, tables: Tables) -> dict[str, Any]:
        """The values by key, numbers as floats. Raises InputError."""
        table = tables.get(self.name)
        if not isinstance(table, dict):
            raise InputError(f"{self.name} = {shortened(table)}: allowed is a table [{self.name}]")
        beside = f" and one of {', '.join(self.either)}" if self.either else ""
        require_keys(f"[{self.name}]", table, self.required, tuple(self.keys), beside)
        given = [key for key in self.either if key in table]
        if self.either and len(given) != 1:
            raise InputError(f"[{self.name}] has {' and '.join(given) or 'no flow'}: allowed is exactly one of {', '.join(self.either)}")
        return {key: self._typed(key, value) for key, value in table.items()}

    def _typed(self, key: str, value: Any) -> Any:
        wanted = self.keys[key]
        if wanted is float and isinstance(value, int | float) and not isinstance(value, bool):
            if abs(value) < LARGEST_NUMBER:
                return float(value)
        elif wanted is not float and isinstance(value, wanted) and (wanted is bool or not isinstance(value, bool)):
            return value
        words = {float: "a finite number", int: "an integer", str: "a string", bool: "true or false", list: "a list"}
        raise InputError(f"[{self.name}] {key} = {shortened(value)}: allowed is {words[wanted]}")
