"""What a validation script states: a claim, its source, and for each case what was expected and what was obtained."""

from __future__ import annotations

import argparse
import math
import sys
from collections.abc import Callable, Iterable
from dataclasses import dataclass, field

from rich.console import Console
from rich.table import Table


@dataclass(frozen=True)
class Case:
    """One line: expected and obtained, as numbers or as words, and the relative difference that the claim allows (None: shown, not judged).

    Words must be the same.
    """

    name: str
    expected: complex | str
    obtained: complex | str
    allowed: float | None
    note: str = ""

    @property
    def difference(self) -> float:
        """|obtained − expected|/|expected|."""
        if isinstance(self.expected, str) or isinstance(self.obtained, str):
            return 0.0 if self.obtained == self.expected else 1.0
        return abs(self.obtained - self.expected) / abs(self.expected)

    @property
    def holds(self) -> bool:
        """Whether the difference is within what is allowed."""
        return self.allowed is None or self.difference <= self.allowed


@dataclass(frozen=True)
class Claim:
    """A sentence that can be false, where it comes from, and a function from quick (bool) to cases."""

    sentence: str
    source: str
    cases: Callable[[bool], Iterable[Case]] = field(repr=False)

    def check(self, quick: bool) -> bool:
        """Run every case, print the table, and say whether all hold."""
        console = Console(width=max(200, Console().width))
        console.print(f"\n[bold]Claim[/]   {self.sentence}\n[bold]Source[/]  {self.source}")
        table = Table(box=None, pad_edge=False, padding=(0, 2, 0, 0))
        for column, justify in (
            ("case", "left"),
            ("expected", "left"),
            ("obtained", "left"),
            ("digits", "right"),
            ("asked", "right"),
            ("", "left"),
        ):
            table.add_column(column, justify=justify)  # type: ignore[arg-type]
        held = True
        for case in self.cases(quick):
            held &= case.holds
            words = isinstance(case.expected, str)
            asked = "" if case.allowed is None or words else f"{-math.log10(case.allowed):.1f}"
            digits = "" if words else f"{min(-math.log10(case.difference), 16.0) if case.difference > 0 else 16.0:.1f}"
            mark = "" if case.allowed is None else "holds" if case.holds else "[red]FAILS[/]"
            table.add_row(case.name, number(case.expected), number(case.obtained), digits, asked, f"{mark} {case.note}".strip())
        console.print(table)
        return held


def number(x: complex | str) -> str:
    """12 significant digits of each part; words as they are."""
    if isinstance(x, str):
        return x
    x = complex(x)
    return f"{x.real:.12g}" if x.imag == 0.0 else f"{x.real:.12g} {'-' if x.imag < 0 else '+'} {abs(x.imag):.12g}i"


def main(claim: Claim) -> None:
    """The command line of one script: --quick, and exit status 1 if a case fails."""
    parser = argparse.ArgumentParser(description=claim.sentence)
    parser.add_argument("--quick", action="store_true", help="a form that takes seconds")
    sys.exit(not claim.check(parser.parse_args().quick))
