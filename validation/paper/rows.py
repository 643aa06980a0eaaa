"""A claim of the paper, what comes out instead, and how the two are held against each other; results are stored with their provenance.

A script offers REPRODUCTION: a name, a title and items, each of which computes one row in a quick or in the full form. Results of the full
form stand in results/NAME.json; a row that stands there, and was computed by its script as it is now and by this release of the package,
is not computed again. The quick form stores nothing: it must agree with the paper, or contradict it, wherever the stored result does. Rows
that a script has not stored yet, beside others that it has, are left out of it.
"""

from __future__ import annotations

import ast
import csv
import hashlib
import json
import math
import os
import subprocess
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

from claims import Case, number
from rich.console import Console
from rich.table import Table

import shootstab

VALIDATION = Path(__file__).parents[1]
RESULTS, FIGURES = Path(__file__).with_name("results"), Path(__file__).with_name("figures")
DERIVATIONS = VALIDATION.parent / "tests"  # symbolic derivations and the paper's tables, which some scripts take from there
FRAME = frozenset({"claims", "readme_tables", "paper", "paper.rows", "paper.table"})  # modules of which results do not depend
AGREES, CONTRADICTS, NOT_REPRODUCED = "agrees", "contradicts", "not reproduced"


@dataclass(frozen=True)
class Row:
    """A claim, its place in the paper, what the paper says there, what we obtain, and the cases by which that is judged.

    reason: why the claim cannot be reproduced, else empty. left: what the full form has still to compute, else empty; it goes on where it
    is asked again. figures: files in figures/ that show it. seconds: of the processor, in the run that made the row.
    """

    claim: str
    place: str
    says: str
    obtained: str
    cases: tuple[Case, ...] = ()
    reason: str = ""
    left: str = ""
    note: str = ""
    figures: tuple[str, ...] = ()
    seconds: float = 0.0

    @property
    def judged(self) -> tuple[Case, ...]:
        """The cases with an allowance; the others are shown only."""
        return tuple(case for case in self.cases if case.allowed is not None)

    @property
    def verdict(self) -> str:
        """'agrees' where all cases hold, 'contradicts' where one does not, 'not reproduced' where there is a reason.

        Raises ValueError where there is neither a reason nor a case to judge by.
        """
        if self.reason:
            return NOT_REPRODUCED
        if not self.judged:
            raise ValueError(f"{self.claim!r} has no case to be judged by, and no reason")
        return AGREES if all(case.holds for case in self.judged) else CONTRADICTS

    @property
    def agreement(self) -> str:
        """The verdict in words, with the least number of digits in which the numbers of the judged cases agree."""
        if self.reason:
            return f"{NOT_REPRODUCED}: {self.reason}"
        numbers = [case for case in self.judged if not isinstance(case.expected, str)]
        if not numbers:
            return self.verdict
        return f"{self.verdict}, {min(digits(case) for case in numbers):.1f} digits"


def if_all_hold(cases: Sequence[Case], said: str) -> str:
    """A sentence that is true where all judged cases hold; where one does not, the cases that fail, with what was obtained."""
    failing = [f"{case.name}: {number(case.obtained)}" for case in cases if not case.holds]
    return f"not so: {'; '.join(failing)}" if failing else said


def digits(case: Case) -> float:
    """−log10 of the relative difference, from 0 to 16."""
    return min(max(-math.log10(case.difference), 0.0), 16.0) if case.difference > 0.0 else 16.0


def compared(
    claim: str, place: str, says: complex, obtained: complex, allowed: float, note: str = "", figures: tuple[str, ...] = ()
) -> Row:
    """A row on one number of the paper; allowed is the relative difference."""
    return Row(claim, place, number(says), number(obtained), (Case(claim, says, obtained, allowed),), note=note, figures=figures)


@dataclass(frozen=True)
class Item:
    """One row by its key: compute(quick) gives it; in_quick says whether it has a quick form."""

    key: str
    compute: Callable[[bool], Row] = field(repr=False)
    in_quick: bool = True


@dataclass(frozen=True)
class Reproduction:
    """What one script reproduces."""

    name: str
    title: str
    items: tuple[Item, ...]

    def check(self, quick: bool, again: bool = False, results: Path = RESULTS) -> bool:
        """Run the items, print the rows, and say whether each verdict is the stored one; in the full form a first result is one.

        again: those too whose stored results are of this version.
        """
        stored, made = load(self.name, results), self._provenance()
        rows, changed = [], []
        for item in self.items:
            before = stored.get(item.key)
            if quick and not (item.in_quick and (before is not None or not stored)):
                continue
            if not quick and not again and before is not None and self._stands(before, made):
                rows.append(before.row)
                continue
            row = self._computed(item, quick)
            rows.append(row)
            if (before is None and quick) or (before is not None and before.row.verdict != row.verdict):
                changed.append(f"{item.key}: {row.agreement}, stored is {before.row.verdict if before else 'nothing'}")
            if not quick:
                stored[item.key] = Stored(row, made)
                known = [other.key for other in self.items]
                save(self.name, {key: stored[key] for key in known if key in stored}, results)
        show(f"{self.title}   (validation/run.py {self.name})", rows)
        for line in changed:
            print(f"not as stored: {line}")
        return not changed

    def _computed(self, item: Item, quick: bool) -> Row:
        began = processor_time()
        row = item.compute(quick)
        row.verdict  # noqa: B018 - raises where there is nothing to judge by
        return Row(**{**_fields(row), "seconds": round(processor_time() - began, 2)})

    def _stands(self, stored: Stored, made: Mapping[str, str]) -> bool:
        present = all((FIGURES / name).exists() for name in stored.row.figures)
        return present and not stored.row.left and all(stored.provenance[part] == made[part] for part in ("version", "script"))

    def _provenance(self) -> dict[str, str]:
        """What the rows of one run come from, as it is when the run begins."""
        commit = subprocess.run(["git", "rev-parse", "--short", "HEAD"], cwd=VALIDATION, capture_output=True, text=True, check=True)
        return {
            "version": shootstab.__version__,
            "commit": commit.stdout.strip(),
            "date": time.strftime("%Y-%m-%d"),
            "command": f"python validation/run.py {self.name}",
            "script": fingerprint(self.name),
        }


@dataclass(frozen=True)
class Stored:
    """A row of the full form and where it comes from: version, commit, date, command, and the fingerprint of its script."""

    row: Row
    provenance: Mapping[str, str]


def fingerprint(name: str) -> str:
    """The hash of a script and the modules of validation/ and tests/ that it imports, without comments, docstrings and layout."""
    seen: dict[str, str] = {}

    def visit(module: str) -> None:
        paths = [folder / (module.replace(".", "/") + ".py") for folder in (VALIDATION, DERIVATIONS)]
        path = next((path for path in paths if path.exists()), None)
        if module in seen or module in FRAME or path is None:
            return
        tree = without_docstrings(ast.parse(path.read_text(encoding="utf-8")))
        seen[module] = ast.dump(tree)
        for node in ast.walk(tree):
            if isinstance(node, ast.ImportFrom) and node.module:
                visit(node.module)
                for alias in node.names:
                    visit(f"{node.module}.{alias.name}")
            if isinstance(node, ast.Import):
                for alias in node.names:
                    visit(alias.name)

    visit(f"paper.{name}")
    return hashlib.sha256("\n".join(seen[module] for module in sorted(seen)).encode()).hexdigest()[:16]


def without_docstrings(tree: ast.Module) -> ast.Module:
    """The tree, changed in place: words about a script change no result of it."""
    for node in ast.walk(tree):
        if isinstance(node, ast.Module | ast.ClassDef | ast.FunctionDef) and ast.get_docstring(node, clean=False) is not None:
            node.body = node.body[1:] or [ast.Pass()]
    return tree


def processor_time() -> float:
    """The processor time of this process and of those that it started and that have ended, in seconds."""
    return sum(os.times()[:4])


def _fields(row: Row) -> dict[str, Any]:
    return {name: getattr(row, name) for name in Row.__dataclass_fields__}


def _plain(value: complex | str) -> Any:
    if isinstance(value, str):
        return value
    return {"re": float(complex(value).real), "im": float(complex(value).imag)}


def _number(value: Any) -> complex | str:
    if isinstance(value, str):
        return value
    return complex(value["re"], value["im"]) if value["im"] else float(value["re"])


def save(name: str, stored: Mapping[str, Stored], results: Path = RESULTS) -> None:
    """Write results/NAME.json, in place of what stood there only when it is whole."""
    document = {}
    for key, entry in stored.items():
        row = _fields(entry.row)
        row["cases"] = [{**asdict(c), "expected": _plain(c.expected), "obtained": _plain(c.obtained)} for c in entry.row.cases]
        document[key] = {**row, "agreement": entry.row.agreement, "provenance": dict(entry.provenance)}
    results.mkdir(exist_ok=True)
    path, half = results / f"{name}.json", results / f"{name}.json.part"
    half.write_text(json.dumps(document, indent=1, ensure_ascii=False, allow_nan=False) + "\n", encoding="utf-8")
    half.replace(path)


def load(name: str, results: Path = RESULTS) -> dict[str, Stored]:
    """What is stored, by key; nothing where there is no file."""
    path = results / f"{name}.json"
    if not path.exists():
        return {}
    found = {}
    for key, entry in json.loads(path.read_text(encoding="utf-8")).items():
        cases = tuple(Case(c["name"], _number(c["expected"]), _number(c["obtained"]), c["allowed"], c["note"]) for c in entry["cases"])
        said = {name: entry[name] for name in Row.__dataclass_fields__ if name not in ("cases", "figures") and name in entry}
        found[key] = Stored(Row(cases=cases, figures=tuple(entry["figures"]), **said), entry["provenance"])
    return found


def write_csv(name: str, columns: Mapping[str, Sequence[Any]], figures: Path = FIGURES) -> str:
    """The data of a figure, columns of one length, to figures/NAME; returns the name."""
    figures.mkdir(exist_ok=True)
    with (figures / name).open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        writer.writerow(columns)
        writer.writerows(zip(*columns.values(), strict=True))
    return name


def show(title: str, rows: Sequence[Row]) -> None:
    """The rows as a table on the terminal, and beneath each the cases that it is judged by."""
    console = Console(width=max(200, Console().width))
    table = Table(box=None, pad_edge=False, padding=(0, 2, 0, 0))
    for column in ("claim", "place", "the paper says", "obtained", "agreement", "s"):
        table.add_column(column, overflow="fold")
    for row in rows:
        table.add_row(row.claim, row.place, row.says, row.obtained, row.agreement, f"{row.seconds:.1f}")
        for case in row.cases:
            mark = "" if case.allowed is None else "holds" if case.holds else "fails"
            table.add_row(f"  {case.name}", "", number(case.expected), number(case.obtained), f"{mark} {case.note}".strip(), "")
    console.print(f"\n[bold]{title}[/]")
    console.print(table)
