"""The problems in equations that differ in parameters: what a sweep walks over."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

from shootstab.core.errors import InputError
from shootstab.problems.protocol import Problem

MEMBERS_KEPT = 16  # chosen: problems kept, more than a walk along a line asks for at once

Make = Callable[[Mapping[str, Any], Mapping[str, complex]], Problem]


@dataclass(frozen=True, eq=False)
class EquationFamily:
    """See problems.capabilities.Family: what `equations` was given, and the function that makes a problem of it with other parameters."""

    posed: Mapping[str, Any]
    make: Make
    _kept: dict[tuple[tuple[str, float], ...], Problem] = field(default_factory=dict, repr=False)

    def __reduce__(self) -> tuple[Any, ...]:
        """The family without the problems that it keeps, for other processes."""
        return EquationFamily, (self.posed, self.make)

    @property
    def sharing(self) -> tuple[str, ...]:
        """None: every parameter may enter the base flow."""
        return ()

    @property
    def here(self) -> dict[str, float]:
        """The parameters that `equations` was given."""
        return {name: float(value) for name, value in self.posed["parameters"].items()}

    def checked(self, values: Mapping[str, float]) -> None:
        """Raise InputError where a value is no finite number."""
        for name, value in values.items():
            if not math.isfinite(value):
                raise InputError(f"{name} = {value!r}: allowed is a finite number")

    def absent(self, values: Mapping[str, float]) -> str | None:
        """Why the equations pose no problem at these values."""
        try:
            self.problem(values)
        except InputError as error:
            return f"no problem: {error}"
        return None

    def problem(self, values: Mapping[str, float]) -> Problem:
        """The member at these values. Raises InputError as `equations` does."""
        key = tuple(sorted(values.items()))
        if key not in self._kept:
            if len(self._kept) >= MEMBERS_KEPT:
                self._kept.pop(next(iter(self._kept)))
            self._kept[key] = self.make(self.posed, values)
        return self._kept[key]

    def beside(self, values: Mapping[str, float]) -> dict[str, float]:
        """Nothing: the parameters say all."""
        return {}

    def as_dict(self) -> dict[str, Any]:
        """The statement as it was written, formulas and functions as text, for JSON."""
        parameters = {name: repr(value) for name, value in self.posed["parameters"].items()}
        written = {name: repr(value) for name, value in self.posed.items() if name not in ("parameters", "given")}
        return {**written, "given": sorted(self.posed["given"]), **parameters}


def family_around(posed: Mapping[str, Any], swept: tuple[str, ...], *, make: Make) -> EquationFamily:
    """The family in which these parameters vary. Raises InputError for a name that is no parameter, or one given twice."""
    for name in swept:
        if name not in posed["parameters"]:
            raise InputError(f"{name}: cannot be swept: allowed is one of the parameters {', '.join(posed['parameters']) or '(none)'}")
        if swept.count(name) > 1:
            raise InputError(f"{name}: given {swept.count(name)} times: allowed is once")
    return EquationFamily(posed, make)
