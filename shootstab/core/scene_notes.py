"""What a scene file in equations says of its problem beside the equations: the tables [about] and [published], both optional.

[about]
description = "waves on water of depth 1"    # one line
order = 2                                    # of the first-order system; another one that is found is refused
scales = "lengths h, velocities √(gh)"
eigenvalue = "σ of exp(σt + ikx)"
[published]
value = ["0.0", "0.8726936208978296"]        # real and imaginary part, as decimals
digits = 15                                  # of it that hold
source = "exact"
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from shootstab.core.errors import InputError, shortened
from shootstab.core.scene_keys import Description, Keys, Tables

NOTES = ("about", "published")  # tables of a scene file that say something of it and change nothing
ABOUT = Keys("about", {"description": str, "order": int, "scales": str, "eigenvalue": str})
PUBLISHED_KEYS = Keys("published", {"value": list, "digits": int, "source": str}, required=("value", "digits", "source"))
PUBLISHED_DECIMAL = re.compile(r"[+-]?\d+(\.\d*)?([eE][+-]?\d{1,3})?")


@dataclass(frozen=True)
class Known:
    """A published eigenvalue: decimals of its real and imaginary part, how many digits of the larger one hold, and where it stands."""

    value: tuple[str, str]
    digits: int
    source: str

    @property
    def double(self) -> complex:
        """The value as a double."""
        return complex(*map(float, self.value))


def about(tables: Tables) -> dict[str, Any]:
    """The values in [about] by key; none without the table. Raises InputError."""
    return ABOUT.checked(tables) if "about" in tables else {}


def known(tables: Tables) -> Known | None:
    """What [published] says; None without the table. Raises InputError."""
    if "published" not in tables:
        return None
    values = PUBLISHED_KEYS.checked(tables)
    pair = values["value"]
    if len(pair) != 2 or not all(isinstance(x, str) and PUBLISHED_DECIMAL.fullmatch(x) for x in pair):
        raise InputError(f'[published] value = {shortened(pair)}: allowed is ["re", "im"], decimals as strings')
    if values["digits"] < 1:
        raise InputError(f"[published] digits = {values['digits']}: allowed is a positive integer")
    return Known((pair[0], pair[1]), values["digits"], values["source"])


def described(problem: Mapping[str, Any], notes: Mapping[str, Any], order: int) -> Description:
    """What the problem in a checked table [problem] with these notes is."""
    variable, symbol = problem.get("variable", "z"), problem.get("eigenvalue", "sigma").replace("sigma", "σ")
    places = [_place(problem[side], infinite) for side, infinite in (("left", "-infinity"), ("right", "infinity"))]
    return Description(
        order,
        ", ".join(problem["unknowns"]),
        f"{places[0]} < {variable} < {places[1]}, all modes",
        notes.get("scales", ""),
        notes.get("eigenvalue", f"{symbol} of the equations"),
    )


def _place(end: Any, infinite: str) -> str:
    if not isinstance(end, dict) or "infinity" in end:
        return infinite
    return next(f"{end[key]:g}" for key in ("at", "axis", "periodic") if key in end)
