"""The table of validation/README.md on the paper, from the stored results: `python validation/run.py --write` puts it there."""

from __future__ import annotations

import importlib
from collections import Counter
from collections.abc import Mapping, Sequence
from pathlib import Path

import readme_tables

from paper import SCRIPTS
from paper.rows import RESULTS, Item, Reproduction, Stored, fingerprint, load

MARK = "paper"


def reproductions() -> list[Reproduction]:
    """Those of all scripts, in the order of the table."""
    return [importlib.import_module(f"paper.{name}").REPRODUCTION for name in SCRIPTS]


def table(of: Sequence[Reproduction] | None = None, results: Path = RESULTS) -> str:
    """A line of Markdown a row, under the title of each script what it shows and where its numbers come from."""
    lines = []
    for reproduction in reproductions() if of is None else of:
        stored = load(reproduction.name, results)
        lines += [f"*{reproduction.title}* (`validation/run.py {reproduction.name}`; {_origin(reproduction, list(stored.values()))})", ""]
        lines += ["| claim | place | the paper says | obtained | agreement | s |", "|---|---|---|---|---|---|"]
        lines += [_line(stored[item.key]) if item.key in stored else _not_yet(reproduction, item) for item in reproduction.items]
        figures = dict.fromkeys(name for entry in stored.values() for name in entry.row.figures if name.endswith(".png"))
        lines += ["", *(f"![{name.removesuffix('.png')}](paper/figures/{name})" for name in figures), ""]
    return "\n".join([*lines, _sum([load(r.name, results) for r in (reproductions() if of is None else of)])])


def _sum(stored: Sequence[Mapping[str, Stored]]) -> str:
    """How many rows there are, with what verdicts, and their seconds in all."""
    rows = [entry.row for entries in stored for entry in entries.values()]
    verdicts = ", ".join(f"{n} {verdict}" for verdict, n in sorted(Counter(row.verdict for row in rows).items()))
    return f"Rows: {len(rows)} ({verdicts or 'none stored'}). Seconds in all: {sum(row.seconds for row in rows):.0f}."


def _origin(reproduction: Reproduction, stored: Sequence[Stored]) -> str:
    """Dates and states of the package; and how many rows were computed by a form of the script that is no longer there."""
    made = sorted({(entry.provenance["date"], entry.provenance["commit"], entry.provenance["version"]) for entry in stored})
    said = [f"{date}, version {version} at {commit}" for date, commit, version in made] or ["nothing stored"]
    old = sum(entry.provenance["script"] != fingerprint(reproduction.name) for entry in stored)
    return "; ".join([*said, *([f"{old} of {len(stored)} rows by an earlier form of the script"] if old else [])])


def _not_yet(reproduction: Reproduction, item: Item) -> str:
    """The line of a row of which the full form was never run to its end."""
    short = "its short form runs with --quick" if item.in_quick else "it has no short form"
    return f"| {item.key} | | | | not yet run: nothing of its full form is stored; {short} | |"


def _line(stored: Stored) -> str:
    row = stored.row
    data = [f"[{name}](paper/figures/{name})" for name in row.figures if name.endswith(".csv")]
    obtained = "; ".join([*(part for part in (row.obtained, row.note) if part), *data])
    agreement = f"{row.agreement}; {row.left}" if row.left else row.agreement
    cells = (row.claim, row.place, row.says, obtained, agreement, f"{row.seconds:.3g}")
    return "| " + " | ".join(cell.replace("|", "\\|") for cell in cells) + " |"


def write(readme: Path = readme_tables.README) -> None:
    """Put the table between its marks."""
    readme_tables.write(MARK, table(), readme)
