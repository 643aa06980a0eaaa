"""Reasons that differ in their sizes alone are told once, with the rows that they belong to and from where to where the sizes reach."""

from __future__ import annotations

import re
from collections.abc import Sequence

from rich.text import Text

from shootstab.cli.lines import GAP, PAGE, filled, numbered, with_i
from shootstab.cli.selection import VerdictRow
from shootstab.cli.verdict_looks import VERDICT_LOOKS
from shootstab.core.records import CONFIRMED, Report

REASON_INDENT = 8  # chosen: columns for the numbers of rows, with a gap behind them
MEASURED = re.compile(r"(?<![\w.+-])\d\.\de[-+]\d\d\b(?![-+]\d)")  # a distance or a radius, which are told to two figures


def told(found: Report, shown: Sequence[VerdictRow]) -> list[Text]:
    """Why a claim is not confirmed; rows with one reason together."""
    reasons = []
    for numbers, verdict, why in grouped([row for row in shown if row[1].verdict != CONFIRMED]):
        reasons.append(_reason(numbers, verdict, why, VERDICT_LOOKS[verdict].style))
    reasons += [_reason("", "not searched", what, "magenta") for what in found.undecided]
    return [*reasons, Text("")] if reasons else []


def _reason(numbers: str, said: str, why: str, colour: str) -> Text:
    """One reason behind the numbers of its rows, which stand above it where they are many."""
    indent = " " * REASON_INDENT
    before = f"{numbers:>{REASON_INDENT - GAP}}{' ' * GAP}" if len(numbers) <= REASON_INDENT - GAP else f"{filled(numbers)}\n{indent}"
    body = filled(f"{said}: {with_i(why)}", width=PAGE - REASON_INDENT).replace("\n", f"\n{indent}")
    text = Text(before + body)
    text.stylize(colour, len(before), len(before) + len(said))
    return text


def grouped(rows: Sequence[VerdictRow]) -> list[tuple[str, str, str]]:
    """(rows, verdict, reason), in the order in which a reason comes first."""
    groups: dict[tuple[str, str], list[VerdictRow]] = {}
    for row in rows:
        groups.setdefault((row[1].verdict, MEASURED.sub("?", row[1].why)), []).append(row)
    return [
        (numbered(sorted(number for number, _ in members)), verdict, _ranged([v.why for _, v in members]))
        for (verdict, _), members in groups.items()
    ]


def _ranged(reasons: Sequence[str]) -> str:
    """One reason for all, each size as the range of theirs."""
    sizes = iter(zip(*(MEASURED.findall(why) for why in reasons), strict=True))

    def reach(_: re.Match[str]) -> str:
        found = sorted(next(sizes), key=float)
        return found[0] if float(found[0]) == float(found[-1]) else f"{found[0]} to {found[-1]}"

    return MEASURED.sub(reach, reasons[0])
