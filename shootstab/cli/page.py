"""`verify --html`: one file that needs no network, with the verdicts to sort and filter, the complex plane to zoom into, the error budgets,
eigenfunctions, the scene, and the command that makes it again.

The complex plane and the eigenfunctions are drawn by plotly.js, which lies in the file. (Bokeh's script is a quarter of its size, but its
package brings pandas; nobody should need that to look at a table.) The table is sorted and filtered by the forty lines of page.js.
"""

from __future__ import annotations

import html
import importlib.util
import platform
import re
import sys
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from importlib import resources
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from shootstab import __version__
from shootstab.cli import exports, plane, plots
from shootstab.cli.lines import with_i
from shootstab.cli.tables import sentence
from shootstab.cli.verdict_looks import css
from shootstab.core.errors import InputError
from shootstab.core.records import VERDICTS, Mode, Report
from shootstab.io.files import write_text
from shootstab.io.notation import held_complex

if TYPE_CHECKING:
    from shootstab.analyses.eigenfunction_double import Eigenfunction
    from shootstab.io.scenes import Scene

PLOTLY_MARKS = {"o": "circle", "^": "triangle-up", "x": "x-thin", "+": "cross-thin", "D": "diamond", "*": "star", "d": "diamond-tall"}
MARK_SIZE = 10  # chosen: size of a mark, in pixels
THIN = ("x-thin", "cross-thin")  # marks that are lines, which plotly draws in the colour of the line alone
GREY_LINE = "#7d7d7d"  # readable on white and on black
LEGEND = {"orientation": "h", "yref": "container", "y": 0, "yanchor": "bottom"}  # a place below the name of the axis, on any width
UNBROKEN = re.compile(r"\d\.\d+e[-+]\d+")  # a browser breaks lines at a hyphen
AXES = {"xaxis": "Re", "yaxis": "Im"}  # exact: the part of the eigenvalue on each axis
MENU_PLACE = {"x": 0, "xanchor": "left", "y": 1, "yanchor": "bottom", "pad": {"b": 4, "t": 0}}  # chosen: a place above the left end
CONFIGURATION = {"responsive": True, "displaylogo": False, "scrollZoom": True}
PAGE_HEIGHTS = 201  # chosen: heights of an eigenfunction on a page, which is loaded over a network


@dataclass(frozen=True, eq=False)
class Page:
    """What the page shows; modes are refined ones with their budgets, and eigenfunctions those of some of them.

    left_out says of the other modes, in sentences, why they have none.
    """

    report: Report
    scene: Scene
    modes: Sequence[Mode]
    eigenfunctions: Sequence[Eigenfunction]
    left_out: Sequence[str]
    command: str


def require(path: Path) -> None:
    """Raise InputError if no such page can be made here."""
    if importlib.util.find_spec("plotly") is None:
        raise InputError(f"{path}: a page needs plotly: install it with `pip install 'shootstab[report]'`")


def save(page: Page, path: Path) -> None:
    """Write the file. Raises OutputError."""
    write_text(path, made(page))


def made(page: Page) -> str:
    """The page as text."""
    from plotly.offline import get_plotlyjs

    own = resources.files("shootstab.cli")
    sections = [
        ("Verdicts", _verdicts(page)),
        ("Complex plane", _complex_plane(page)),
        ("Error budgets", _budgets(page.modes)),
        ("Eigenfunctions", _eigenfunctions(page)),
        ("Where this comes from", _provenance(page)),
    ]
    body = "\n".join(f"<section><h2>{title}</h2>{content}</section>" for title, content in sections)
    title = html.escape(f"{page.scene.name}: {sentence(page.report)}")
    return "\n".join(
        [
            '<!doctype html><html lang="en"><head><meta charset="utf-8">',
            '<meta name="viewport" content="width=device-width, initial-scale=1">',
            f"<title>{title}</title><style>{(own / 'page.css').read_text(encoding='utf-8')}{css()}</style>",
            f"<script>{get_plotlyjs()}</script></head><body>",
            f"<h1>{html.escape(page.scene.name)}</h1><p>{html.escape(page.scene.heading)}</p>",
            f"<p class=sentence>{html.escape(sentence(page.report))}</p>{body}",
            f"<script>{(own / 'page.js').read_text(encoding='utf-8')}</script></body></html>",
        ]
    )


def _complex_plane(page: Page) -> str:
    figure, seen = _plane(page)
    words = [_searched(page.report), *([seen] if seen else [])]
    return _figure(figure, "plane") + "".join(f"<p>{html.escape(said)}</p>" for said in words)


def _verdicts(page: Page) -> str:
    headings, rows = exports.cells(page.report, page.scene.symbol)
    present = [v for v in (*VERDICTS, "missing") if any(row[2] == v for row in rows)]
    boxes = "".join(f'<label><input type=checkbox checked value="{v}"> {v}</label>' for v in present)
    head = "".join(f"<th tabindex=0 aria-sort=none>{html.escape(h)}</th>" for h in headings)
    keys = [_sort_keys(page.report, i, row) for i, row in enumerate(rows)]
    body = "".join(
        f'<tr data-verdict="{row[2]}">' + "".join(_cell(cell, key, i) for i, (cell, key) in enumerate(zip(row, of, strict=True))) + "</tr>"
        for row, of in zip(rows, keys, strict=True)
    )
    search = '<input type=search placeholder="text in a row" aria-label="text in a row">'
    table = f"<table id=verdicts><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table>"
    return f"<form>{boxes}{search}<output></output></form><div class=wide>{table}</div>"


def _cell(text: str, key: str, column: int) -> str:
    inner = UNBROKEN.sub(r"<span class=unbroken>\g<0></span>", html.escape(text))
    return f'<td data-key="{html.escape(key)}">{f"<b class={text}>{inner}</b>" if column == 2 else inner}</td>'


def _sort_keys(report: Report, place: int, row: Sequence[str]) -> list[str]:
    """What each cell is sorted by: eigenvalues by growth, numbers as numbers, words as they are."""
    if place < len(report.verdicts):
        v = report.verdicts[place]
        sigma = "" if v.sigma is None else repr(complex(v.sigma).real)
        error = "" if v.error is None else repr(float(v.error))
        return [row[0], repr(complex(v.claimed).real), row[2], sigma, error, repr(v.digits_agreed or 0.0), row[6]]
    m = report.missing[place - len(report.verdicts)]
    return ["", "", row[2], repr(complex(m.sigma).real), repr(float(m.error)), "", ""]


def _plane(page: Page) -> tuple[dict[str, Any], str]:
    """The claims, the modes, the continuous spectrum, and what was searched; and a sentence on what is not in sight at first, if any."""
    groups, near = plots.of_report(page.report, page.scene)
    reasons = {complex(v.claimed): f"{i}: {v.verdict}<br>{html.escape(with_i(v.why))}" for i, v in enumerate(page.report.verdicts, 1)}
    traces: list[dict[str, Any]] = []
    line = plane.continuum(page.scene)
    if line is not None:
        traces.append(_line("continuous spectrum", line, {"color": GREY_LINE, "width": 3}))
    rim = plots.rim(page.report.region)
    if rim is not None:
        traces.append(_line("region searched", rim, {"color": GREY_LINE, "width": 1, "dash": "dot"}))
    for group in groups:
        if group.points.size:
            symbol, colour = PLOTLY_MARKS[group.marker], group.settings.get("color", GREY_LINE)
            hollow = group.settings.get("markerfacecolor") == "none"
            marker = {
                "symbol": "circle-open" if hollow else symbol,
                "size": 1.5 * MARK_SIZE if hollow else MARK_SIZE,
                "color": GREY_LINE if hollow else colour,
            }
            if symbol in THIN:
                marker["line"] = {"width": 2, "color": colour}
            elif "markeredgecolor" in group.settings and not hollow:
                marker["line"] = {"width": 1.5, "color": GREY_LINE}  # yellow alone is not seen on white
            text = [
                f"{z.real:.12g} {'-' if z.imag < 0 else '+'} {abs(z.imag):.12g}i<br>{reasons.get(z, '')}" for z in group.points.tolist()
            ]
            points = {"x": group.points.real.tolist(), "y": group.points.imag.tolist(), "text": text, "hoverinfo": "text+name"}
            traces.append({"type": "scatter", "mode": "markers", "name": group.label, "marker": marker, **points})
    drawn = np.concatenate([np.empty(0, dtype=np.complex128), *(group.points for group in groups), *([] if rim is None else [rim])])
    magnified, near = plane.in_view(drawn, near)
    ranges = _ranges(near)
    layout = {axis: {"title": {"text": plane.label(part, page.scene)}, "range": ranges[axis]} for axis, part in AXES.items()}
    if not magnified:
        return {"data": traces, "layout": {**layout, "legend": LEGEND}}, ""
    centre, width, height = near
    told = np.array([complex(v.claimed) for v in page.report.verdicts] + [complex(m.sigma) for m in page.report.missing])
    seen = int(((np.abs(told.real - centre.real) <= width) & (np.abs(told.imag - centre.imag) <= height)).sum())
    views = {"magnified": ranges, "all": _ranges(plane.around(drawn, 0.0))}
    buttons = [{"label": name, "method": "relayout", "args": [{f"{axis}.range": of[axis] for axis in AXES}]} for name, of in views.items()]
    menu = {"type": "buttons", "direction": "right", "showactive": False, "buttons": buttons, **MENU_PLACE}
    said = f"The magnified part, which is shown first, holds {seen} of the {len(told)} rows above; the button “all” shows the others."
    return {"data": traces, "layout": {**layout, "legend": LEGEND, "updatemenus": [menu]}}, said


def _ranges(box: plane.Box) -> dict[str, list[float]]:
    """The ranges of both axes."""
    centre, width, height = box
    return {"xaxis": [centre.real - width, centre.real + width], "yaxis": [centre.imag - height, centre.imag + height]}


def _line(name: str, points: Any, style: Mapping[str, Any]) -> dict[str, Any]:
    x, y = points.real.tolist(), points.imag.tolist()
    return {"type": "scatter", "mode": "lines", "name": name, "x": x, "y": y, "line": dict(style), "hoverinfo": "name"}


def _eigenfunctions(page: Page) -> str:
    """The figures of eigenfunctions, and why other modes have none."""
    shown = enumerate(page.eigenfunctions)
    figures = "".join(f"<div class=kept>{_caption(f, page.scene.symbol)}{_figure(_shape(f), f'mode{i}')}</div>" for i, f in shown)
    return figures + "".join(f"<p>{html.escape(with_i(why))}</p>" for why in page.left_out) or "<p>No mode was found.</p>"


def _shape(found: Eigenfunction) -> dict[str, Any]:
    """The unknowns of an eigenfunction over z, upwards: real parts solid, imaginary ones dashed."""
    z, values = found.sampled(PAGE_HEIGHTS)
    traces = []
    for i, (name, f) in enumerate(values.items()):
        colour = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9")[i % 6]
        largest = float(np.abs(f).max())
        if largest == 0.0:
            traces.append(_line(f"{name} = 0", 1j * z[[0, -1]], {"color": colour, "width": 2}))
            continue
        for part, of, dash in (("Re", f.real, "solid"), ("Im", f.imag, "dash")):
            label = f"{part} {name} / {largest:.3g}"
            trace = _line(label, of / largest + 1j * z, {"color": colour, "dash": dash, "width": 2})
            traces.append({**trace, "hoverinfo": "x+y+name"})
    titles = {"xaxis": "each unknown over its largest value", "yaxis": found.variable}
    layout = {**{axis: {"title": {"text": title}} for axis, title in titles.items()}, "legend": LEGEND}
    return {"data": traces, "layout": layout}


def _caption(found: Eigenfunction, symbol: str) -> str:
    """What an eigenfunction belongs to, and how well it is known."""
    sigma = held_complex(found.mode.sigma, found.mode.error)
    kind = f", {found.kind}" if found.kind else ""
    relative = "each unknown" if found.mode.multiplicity == 1 else "all unknowns"
    several = "" if found.mode.multiplicity == 1 else f" One of the solutions at a mode of multiplicity {found.mode.multiplicity}."
    title = html.escape(f"{symbol} = {sigma}{kind}")
    return f"<h3>{title}</h3><p>Error {found.error:.1e} of the largest value of {relative}.{several}</p>"


def _figure(figure: Mapping[str, Any], name: str) -> str:
    """The place of a figure, and its data for page.js; an escaped slash ends no script."""
    import json

    data = json.dumps({**figure, "config": CONFIGURATION}, allow_nan=False).replace("</", "<\\/")
    return f'<div class=figure id={name}></div><script type="application/json" data-figure={name}>{data}</script>'


def _budgets(modes: Sequence[Mode]) -> str:
    if not modes:
        return "<p>No mode was refined.</p>"
    parts = list(modes[0].budget.as_dict())
    head = "".join(f"<th>{h.replace('_', ' ')}</th>" for h in ("mode", "error", *parts, "path"))
    rows = "".join(
        f"<tr><td>{held_complex(m.sigma, m.error)}</td><td>{float(m.error):.1e}</td>"
        + "".join(f"<td>{f'{float(value):.0e}' if value else '0'}</td>" for value in m.budget.as_dict().values())
        + f"<td>{html.escape(m.path)}</td></tr>"
        for m in modes
    )
    return f"<div class=wide><table><thead><tr>{head}</tr></thead><tbody>{rows}</tbody></table></div>"


def _searched(report: Report) -> str:
    undecided = " ".join(f"Not searched: {with_i(what)}." for what in report.undecided)
    return f"{sentence(report)} {undecided}".strip()


def _provenance(page: Page) -> str:
    rests = f"Verdicts rest on {page.report.rests_on}." if page.report.rests_on else ""
    versions: dict[str, str] = {
        name: sys.modules[name].__version__ for name in ("numpy", "scipy", "numba", "plotly") if name in sys.modules
    }
    versions = {"shootstab": __version__, "Python": platform.python_version(), **versions}
    listed = ", ".join(f"{name} {version}" for name, version in versions.items())
    return f"<p>{html.escape(rests)}</p><p>{html.escape(listed)}</p><pre>{html.escape(page.command)}</pre>"
