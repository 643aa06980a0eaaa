"""Numbers of things in sentences: one mode is counted, two modes are."""

from __future__ import annotations

PERCENT = 100  # exact


def number_of(count: int, one: str, many: str | None = None) -> str:
    """The count and what is counted: `one` where it is 1, else `many`, which is `one` with an s where it is not given."""
    return f"{count} {one}" if count == 1 else f"{count} {many or f'{one}s'}"
