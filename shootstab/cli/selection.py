"""The rows of a table of verdicts that are shown, and their order: each keeps its number in the file."""

from __future__ import annotations

from collections.abc import Callable, Mapping

from shootstab.core.records import CONFIRMED, CONTINUUM, VERDICTS, Report, Verdict

VerdictRow = tuple[int, Verdict]

# the keys that rows are sorted by, by name
ORDERS: Mapping[str, Callable[[VerdictRow], float]] = {
    "growth": lambda row: -row[1].claimed.real,
    "size": lambda row: abs(row[1].claimed),
    "verdict": lambda row: VERDICTS.index(row[1].verdict),
    "digits": lambda row: row[1].digits_agreed or 0.0,
}
SORTS = tuple(ORDERS)


def rows(found: Report, only: str | None, sort: str | None) -> list[VerdictRow]:
    """(number in the file, verdict): all, or those asked for."""
    numbered = list(enumerate(found.verdicts, 1))
    if only == "bad":
        numbered = [row for row in numbered if row[1].verdict not in (CONFIRMED, CONTINUUM)]
    elif only is not None:
        numbered = [row for row in numbered if row[1].verdict == only]
    return sorted(numbered, key=ORDERS[sort]) if sort is not None else numbered
