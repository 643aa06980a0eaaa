"""The table of validation/README.md on the paper, from the stored results: `python validation/run.py --write` puts it there."""

from __future__ import annotations

import importlib
from collections.abc import Sequence
from pathlib import Path

import page

from paper import SCRIPTS
from paper.rows import RESULTS, Reproduction, Stored, load

MARK = "paper"


def reproductions() -> list[Reproduction]:
    """Those of all scripts, in the order of the table."""
    return [importlib.import_module(f"paper.{name}").REPRODUCTION for name in SCRIPTS]


def table(of: Sequence[Reproduction] | None = None, results: Path = RESULTS) -> str:
    """A line of Markdown a row, under the title of each script what it shows and where its numbers come from."""
    lines = []
    for reproduction in reproductions() if of is None else of:
        stored = load(reproduction.name, results)
        missing = [item.key for item in reproduction.items if item.key not in stored]
        lines += [f"*{reproduction.title}* (`validation/run.py {reproduction.name}`; {_origin(list(stored.values()))})", ""]
        lines += ["| claim | place | the paper says | obtained | agreement | s |", "|---|---|---|---|---|---|"]
        lines += [_line(stored[item.key]) for item in reproduction.items if item.key in stored]
        if missing:
            lines += ["", f"Not computed yet: {', '.join(missing)}."]
        figures = dict.fromkeys(name for entry in stored.values() for name in entry.row.figures if name.endswith(".png"))
        lines += ["", *(f"![{name.removesuffix('.png')}](paper/figures/{name})" for name in figures), ""]
    return "\n".join(lines)


def _origin(stored: Sequence[Stored]) -> str:
    made = sorted({(entry.provenance["date"], entry.provenance["commit"], entry.provenance["version"]) for entry in stored})
    return "; ".join(f"{date}, version {version} at {commit}" for date, commit, version in made) or "nothing stored"


def _line(stored: Stored) -> str:
    row = stored.row
    data = [f"[{name}](paper/figures/{name})" for name in row.figures if name.endswith(".csv")]
    obtained = "; ".join([row.obtained, *([row.note] if row.note else []), *data])
    cells = (row.claim, row.place, row.says, obtained, row.agreement, f"{row.seconds:.3g}")
    return "| " + " | ".join(cell.replace("|", "\\|") for cell in cells) + " |"


def write(readme: Path = page.README) -> None:
    """Put the table between its marks."""
    page.write(MARK, table(), readme)
