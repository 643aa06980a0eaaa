"""The layers that interfaces divide a domain into, as they are stated: each with its own coefficients."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from shootstab.core.errors import InputError
from shootstab.formulation.domain import Domain
from shootstab.formulation.names import Names
from shootstab.formulation.system import System


@dataclass(frozen=True, eq=False)
class Layer:
    """The equations as they hold in one layer, or in all of the domain."""

    names: Names
    system: System
    domain: Domain


def own_definitions(given: Mapping[str, Any], layer: int, count: int, kind: str) -> dict[str, Any]:
    """What names mean in one of so many layers: lists hold one meaning for each. Raises InputError for a list of another length."""
    out = {}
    for name, value in given.items():
        if isinstance(value, list | tuple):
            if len(value) != count or count == 1:
                told = f"{kind} {name} is a list of {len(value)}"
                raise InputError(f"{told}: allowed is one for each of the {count} layers that interfaces make, or one alone for all")
            out[name] = value[layer]
        else:
            out[name] = value
    return out
