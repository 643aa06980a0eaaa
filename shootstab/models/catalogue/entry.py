"""What the catalogue says of a problem of the gallery beside its equations."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from functools import partial
from importlib import import_module
from typing import TYPE_CHECKING, Any, cast

from shootstab.core.scene_keys import Description, Keys

if TYPE_CHECKING:
    from shootstab.problems.protocol import Problem

WAVE_FORM = "σ of exp(σt + iαx)"


@dataclass(frozen=True)
class Maker:
    """What makes a problem: a function of a module of the gallery, imported when it is called, with values that are given beforehand.

    A problem that does not know how it was made is told, so that other processes can make it again.
    """

    module: str
    function: str
    values: Mapping[str, Any] = field(default_factory=dict)

    def __call__(self, **values: Any) -> Problem:
        made: Any = getattr(import_module(f"shootstab.models.gallery.{self.module}"), self.function)(**{**self.values, **values})
        if getattr(made, "made_by", self) is None:
            made = replace(made, made_by=partial(self, **values))
        return cast("Problem", made)


@dataclass(frozen=True)
class Published:
    """value is an eigenvalue as its source has it, unit what makes it the problem's own: σ = unit·value. digits of it hold."""

    name: str
    problem: Callable[[], Problem]
    value: complex
    digits: int
    source: str
    unit: complex = 1.0
    slow: bool = False

    @property
    def sigma(self) -> complex:
        """The problem's own eigenvalue."""
        return self.unit * self.value

    @property
    def tolerance(self) -> float:
        """How far from it the true one may lie."""
        size = max(abs(self.value.real), abs(self.value.imag))
        return float(abs(self.unit) * 10.0 ** (math.floor(math.log10(size)) + 1 - self.digits))


@dataclass(frozen=True)
class Entry:
    """One problem: its name in [problem], what makes it from the values there, the keys, what it is, scenes that are built in, and what
    others have published of it.

    describe gives the Description for values by key. scenes: name → (one line, values by key).
    """

    name: str
    make: Callable[..., Problem]
    keys: Keys
    describe: Callable[[Mapping[str, Any]], Description]
    scenes: Mapping[str, tuple[str, Mapping[str, Any]]] = field(default_factory=dict)
    published: tuple[Published, ...] = ()


def keys(*numbers: str, required: tuple[str, ...] = (), **others: type) -> Keys:
    """The table [problem] with `name`, these numbers, and keys of other types."""
    return Keys("problem", {"name": str, **dict.fromkeys(numbers, float), **others}, required=("name", *required))
