"""The table of verdicts for a page: Markdown, LaTeX, HTML. One function makes the cells, so that all say the same."""

from __future__ import annotations

import html
import re
from collections.abc import Sequence
from typing import TYPE_CHECKING

from shootstab.cli.lines import with_i
from shootstab.cli.tables import ABSENT, sentence
from shootstab.core.records import CONFIRMED, Report
from shootstab.io.notation import claimed_digits, held_complex

if TYPE_CHECKING:
    from shootstab.io.scenes import Scene

POWER_OF_TEN = re.compile(r"(\d)e([+-]?)0*(\d+)")
SPECIAL = {"\\": r"\textbackslash{}", **{c: f"\\{c}" for c in "&%$#_{}"}, "~": r"\textasciitilde{}", "^": r"\textasciicircum{}"}
INK = {"confirmed": "#00704f", "inaccurate": "#8a5a00", "spurious": "#b34700", "continuum": "#005a8c", "missing": "#a0005a"}


def cells(report: Report, symbol: str = "σ") -> tuple[list[str], list[list[str]]]:
    """The headings, and a row for every claim and every missing mode."""
    headings = ["#", f"claimed {symbol}", "verdict", f"mode {symbol}", "error", "digits", "why"]
    rows = []
    for number, v in enumerate(report.verdicts, 1):
        mode = ABSENT if v.sigma is None else held_complex(v.sigma, v.error)
        error = ABSENT if v.error is None or v.sigma is None else f"{float(v.error):.1e}"
        digits = ABSENT if v.digits_agreed is None else f"{v.digits_agreed:.1f}"
        why = "" if v.verdict == CONFIRMED else with_i(v.why)
        rows.append([str(number), claimed_digits(v.claimed, report.digits), v.verdict, mode, error, digits, why])
    for m in report.missing:
        rows.append(["", ABSENT, "missing", held_complex(m.sigma, m.error), f"{float(m.error):.1e}", ABSENT, ""])
    return headings, rows


def markdown(report: Report, scene: Scene | None = None) -> str:
    """A table of GitHub's kind, under what the scene is."""
    headings, rows = cells(report, scene.symbol if scene else "σ")
    lines = [headings, ["---"] * len(headings), *rows]
    table = "\n".join(f"| {' | '.join(cell.replace('|', '&#124;') for cell in line)} |" for line in lines)
    return "\n\n".join([*([scene.heading] if scene else []), table, sentence(report)]) + "\n"


def latex(report: Report, scene: Scene | None = None) -> str:
    """A tabular with rules of the package booktabs, without the reasons, which would not fit; numbers are set as mathematics."""
    headings, rows = cells(report, r"$\sigma$" if scene is None or scene.symbol == "σ" else f"${scene.symbol}$".replace("ω", r"\omega"))
    lines = [r"\begin{tabular}{rllllr}", r"\toprule", f"{' & '.join(_tex(h) for h in headings[:-1])} \\\\", r"\midrule"]
    lines += [f"{' & '.join(_tex_number(cell) if i in (1, 3, 4) else _tex(cell) for i, cell in enumerate(row[:-1]))} \\\\" for row in rows]
    return "\n".join([*lines, r"\bottomrule", r"\end{tabular}", f"% {sentence(report)}"]) + "\n"


def html_table(report: Report, scene: Scene | None = None) -> str:
    """A table for a notebook."""
    headings, rows = cells(report, scene.symbol if scene else "σ")
    head = "".join(f"<th>{html.escape(h)}</th>" for h in headings)
    body = "".join(_html_row(row) for row in rows)
    caption = html.escape(f"{scene.heading}. {sentence(report)}" if scene else sentence(report))
    return f"<table><caption>{caption}</caption><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table>"


def _html_row(row: Sequence[str]) -> str:
    colour = INK.get(row[2], "#5a4a78")
    cells = [html.escape(cell) for cell in row]
    cells[2] = f'<b style="color:{colour}">{cells[2]}</b>'
    return f"<tr>{''.join(f'<td>{cell}</td>' for cell in cells)}</tr>"


def _tex(text: str) -> str:
    if text.startswith(("claimed $", "mode $")):
        return text
    return "--" if text == ABSENT else "".join(SPECIAL.get(c, c) for c in text)


def _tex_number(text: str) -> str:
    """A number as mathematics: 1.2e-05 is 1.2 times ten to the -5, and i is upright."""
    if text == ABSENT:
        return "--"
    powers = POWER_OF_TEN.sub(lambda m: rf"{m[1]}\times10^{{{'-' if m[2] == '-' else ''}{m[3]}}}", text)
    unit = r"\mathrm{i}" if powers.endswith("i") else ""
    return f"${powers.removesuffix('i')}{unit}$"
