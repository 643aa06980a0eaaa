"""Fields over a coordinate as a table: the largest value of each, where that is, and the values at both ends."""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from rich.console import RenderableType

SMALLEST_PLAIN, LARGEST_PLAIN = 1e-3, 1e5  # chosen: the range in which a number of three figures is shorter without an exponent


def table_of(fields: Mapping[str, Any], z: Any, x: str, errors: Mapping[str, float]) -> RenderableType:
    """The largest value of each field at heights z, where that is, and the values at both ends; what is below its error is 0."""
    from shootstab.cli import tables

    table = tables.ruled("", "field", "largest value", f"at {x}", f"at {x} = {z[0]:.4g}", f"at {x} = {z[-1]:.4g}", numbered=False)
    for name, f in fields.items():
        place = int(abs(f).argmax())
        table.add_row(name, _short(f[place], errors[name]), f"{z[place]:.4g}", _short(f[0], errors[name]), _short(f[-1], errors[name]))
    return table


def _short(value: complex, error: float) -> str:
    """Three figures of each part; 0 for a part below the error, and nothing of a real part that is."""
    x, y = (0.0 if abs(part) <= error else float(part) for part in (value.real, value.imag))
    if y == 0.0:
        return _figures(x)
    return f"{_figures(y)}i" if x == 0.0 else f"{_figures(x)} {'-' if y < 0 else '+'} {_figures(abs(y))}i"


def _figures(x: float) -> str:
    """Three figures, in as few letters as a column of a table has for them."""
    text = f"{x:.3g}" if x == 0.0 or SMALLEST_PLAIN <= abs(x) < LARGEST_PLAIN else f"{x:.2e}"
    return re.sub(r"e([-+])0", r"e\1", text)
