"""Tables that a person can read. A number is shown to the digits that its error leaves, an error to two."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

from rich.box import SIMPLE
from rich.console import RenderableType
from rich.table import Table
from rich.text import Text

from shootstab.cli.lines import GAP, PAGE, filled, with_i
from shootstab.cli.reasons import told
from shootstab.cli.selection import rows
from shootstab.cli.verdict_looks import MISSING_LOOK, VERDICT_LOOKS
from shootstab.core.allowed import DOUBLE_DIGITS
from shootstab.core.numerus import number_of
from shootstab.core.records import (
    CONFIRMED,
    Mode,
    Report,
    Verdict,
    digits_between,
)
from shootstab.core.regions import Region
from shootstab.io.notation import claimed_digits, held, held_complex

if TYPE_CHECKING:
    from shootstab.analyses.cut_region import RegionCount
    from shootstab.analyses.find import Found
    from shootstab.analyses.proved_verdicts import ProvedVerdict
    from shootstab.io.scenes import Scene
    from shootstab.models.chute import Flow

ABSENT = "–"
MORE_DIGITS = 2  # chosen: digits shown beyond those asked for
ROUNDED_DIGITS = 1e-9  # chosen: what rounding makes of two equal numbers of digits
# headings of columns of numbers, which stand on the right
OF_NUMBERS = ("error", "digits", "times", "drift", "tail", "z", "ν", "T", "u", "time", "memory", "work")
FLOW_DIGITS = 1e-12  # chosen: the relative accuracy of a steady flow

Parts = list[RenderableType]


def report(found: Report, scene: Scene, only: str | None = None, sort: str | None = None) -> Parts:
    """Verdicts and missing modes, the reasons, and one sentence.

    Where a row would be wider than the page, the mode stands below the claim: a number is never cut.
    """
    shown = rows(found, only, sort)
    lines = []
    for number, verdict in shown:
        cells = _mode_cells(verdict.sigma, verdict.error) if verdict.sigma is not None else (ABSENT, ABSENT)
        lines.append((str(number), claimed_digits(verdict.claimed, found.digits), verdict.verdict, *cells, _agreement(verdict)))
    for mode in found.missing:
        lines.append(("", ABSENT, "missing", *_mode_cells(mode.sigma, mode.error), ABSENT))
    headings = ("#", in_symbol("claimed σ", scene), "verdict", f"mode {scene.symbol}", "error", "digits")
    if _width([headings, *lines]) <= PAGE:
        table = ruled("", *headings[1:])
        for row, claimed, said, *others in lines:
            table.add_row(row, claimed, _coloured(said), *others)
    else:
        table = ruled("", f"{headings[1]}, {headings[3]}", *(h for h in headings[2:] if h != headings[3]))
        for row, claimed, said, mode_text, *others in lines:
            both = claimed if mode_text == ABSENT else mode_text if claimed == ABSENT else f"{claimed}\n{mode_text}"
            table.add_row(row, both, _coloured(said), *others)
    rests = [paragraph(f"Rests on {found.rests_on}.")] if found.rests_on else []
    listed = [table] if lines else [Text(f"None of the {len(found.verdicts)} verdicts is {only}.\n")]
    return [heading(scene), *listed, *told(found, shown), *_left_out(found), paragraph(sentence(found)), *rests]


def _width(lines: Sequence[Sequence[str]]) -> int:
    """The columns of a page that a table with these lines takes."""
    return sum(max(map(len, column)) for column in zip(*lines, strict=True)) + (len(lines[0]) - 1) * GAP


def theorems(found: Report, proofs: Sequence[ProvedVerdict]) -> Parts:
    """What was proved of each claim, by its number in the table, and why the others were not; then of which base flows."""
    parts: Parts = []
    flows: dict[str, list[str]] = {}
    for number, (verdict, proof) in enumerate(zip(found.verdicts, proofs, strict=False), 1):
        against = f", against the verdict {verdict.verdict}" if proof.contradicts else ""
        said = f"proved{against}: {proof.short}" if proof.short is not None else f"not proved: {proof.reason}"
        parts.append(paragraph(f"{number} {said}."))
        if proof.premise:
            flows.setdefault(proof.premise, []).append(str(number))
    return [*parts, *(paragraph(f"Of {', '.join(numbers)}: {premise} that holds.") for premise, numbers in flows.items())]


def _left_out(found: Report) -> Parts:
    if not found.dropped:
        return []
    entries = number_of(found.dropped, "entry that is", "entries that are")
    return [Text(f"Left out of the file: {entries} infinite, not a number, or 1e15 and more.")]


def paragraph(sentence: str) -> Text:
    """A sentence on a page's width."""
    return Text(filled(with_i(sentence)))


def heading(scene: Scene) -> Text:
    """What the scene is, on a page's width."""
    return Text(filled(scene.heading))


def _mode_cells(sigma: Any, error: float | None) -> tuple[str, str]:
    return held_complex(sigma, error), _two_figures(error)


def _agreement(verdict: Verdict) -> str:
    """Digits agreed; where the difference is below the error of the mode, at least as many as the mode has."""
    if verdict.digits_agreed is None or verdict.sigma is None:
        return ABSENT
    known = digits_between(verdict.error or 0.0, abs(verdict.sigma))
    return f"≥{known:.1f}" if verdict.digits_agreed >= known - ROUNDED_DIGITS else f"{verdict.digits_agreed:.1f}"


def sentence(found: Report) -> str:
    """How many of each, then where modes were looked for and how many of the claims lie there, and what is missing there."""
    total, counts = len(found.verdicts), dict(found.summary)
    missing, confirmed = counts.pop("missing"), counts.pop(CONFIRMED)
    others = "".join(f", {n} {verdict}" for verdict, n in counts.items() if n)
    said = f"{confirmed} of {number_of(total, 'eigenvalue')} confirmed to {number_of(found.digits, 'digit')}{others}."
    lost = "no mode is missing" if missing == 0 else f"{number_of(missing, 'mode is', 'modes are')} missing"
    searched = with_i(found.searched[:1].upper() + found.searched[1:])
    if found.region is None:
        return f"{said} {searched}{f'; {lost}' if missing else ''}."
    return f"{said} {searched}: {lost}."


def mode(found: Mode, scene: Scene, asked: int | None = None) -> Parts:
    """One mode and what its error is made of; of σ at most MORE_DIGITS digits more than were asked for."""
    parts = [f"{name.replace('_', ' ')} {_two_figures(value)}" for name, value in found.budget.as_dict().items()]
    least = 0.0 if asked is None else float(abs(found.sigma)) * 10.0 ** -(asked + MORE_DIGITS)
    rows = {
        in_symbol("σ", scene): held_complex(found.sigma, max(found.error, least)),
        "error": f"{_two_figures(found.error)} ({', '.join(parts[:2])},\n       {', '.join(parts[2:])})",
        "digits": f"{found.digits:.1f}",
        "status": found.status,
        "method": f"{found.method}, {number_of(found.evaluations, 'evaluation')}, {found.seconds:.2g} s, {_path(found.path)}",
    }
    if found.atol > 0.0 and found.error > 0.0 and abs(found.sigma) < found.scale:
        rows["absolute accuracy"] = f"{_two_figures(found.atol)} suffices here, where D is linear over {_two_figures(found.scale)}"
    if found.converged and math.isfinite(found.guess_distance):
        rows["from the guess"] = _two_figures(found.guess_distance) + (f": {found.nearer}" if found.nearer else "")
    if found.system:
        rows["system"] = found.system
    if found.multiplicity > 1:
        rows["multiplicity"] = f"{found.multiplicity}: so many eigenvalues, equal or not told apart, lie within the error"
    if math.isfinite(found.continuum_distance):
        rows["continuous spectrum"] = f"at a distance of {_two_figures(found.continuum_distance)}"
    return [heading(scene), pairs((name, with_i(value)) for name, value in rows.items())]


def _path(path: str) -> str:
    """The path of integration in words: real, or through a complex point."""
    return f"{path} path in z" if " " not in path else f"path in z {path}"


def count(region: Region, found: RegionCount, scene: Scene, lemma: str = "") -> Parts:
    """One sentence, by which lemma the region holds all growing modes, and what was left out."""
    said = f"{scene.name}: {number_of(found.count, 'mode')} inside the {_shape(region)}."
    closed = f"The phase of D closed to {found.closure:.0e} of a turn, in {number_of(found.evaluations, 'evaluation')}."
    left = [f"Not counted: what lies within {d.radius:.1e} of the end {d.centre:.6g} of the continuous spectrum." for d in found.left_out]
    floor = min(corner.real for corner in region.hull)
    others = [f"None outside of it has Re σ > {floor:.1e}, by lemma {lemma} of `shootstab guide proofs`."] if lemma else []
    return [paragraph(line) for line in (f"{said} {closed}", *others, *left)]


def found(answer: Found, region: Region, scene: Scene) -> Parts:
    """A table of modes, the resonances under it, and the count."""
    table = ruled("", in_symbol("mode σ", scene), "error", "digits", "times", "continuum")
    for number, m in enumerate(answer.modes, 1):
        away = _two_figures(m.continuum_distance) if math.isfinite(m.continuum_distance) else ABSENT
        table.add_row(str(number), *_mode_cells(m.sigma, m.error), f"{m.digits:.1f}", str(m.multiplicity), away)
    parts: Parts = [heading(scene), *([table] if answer.modes else [])]
    if answer.resonances is not None:
        listed = ", ".join(f"{complex(r):.8g}" for r in answer.resonances) or "none"
        parts.append(paragraph(f"Resonances beyond the continuous spectrum, which are not modes: {listed}."))
    return [*parts, *count(region, answer.counted, scene)]


def _shape(region: Region) -> str:
    form = region.as_dict()
    if form["shape"] == "disc":
        return f"disc of radius {form['radius']:g} around {_pair(form['centre'])}"
    if form["shape"] == "half-disc":
        return f"half-plane Re σ > {form['floor']:.1e} (none has |σ| > {form['radius']:g})"
    return f"{form['shape']} with corners {' and '.join(_pair(c) for c in form['corners'])}"


def _pair(corner: Mapping[str, str]) -> str:
    return f"({float(corner['re']):g}, {float(corner['im']):g})"


def steady(flow: Flow, profiles: Mapping[str, Sequence[float]], scene: Scene) -> Parts:
    """The flow's numbers, and its profiles at eleven heights."""
    numbers = {
        "far temperature T∞": flow.far_temperature,
        "ν at the base": flow.base["nu"],
        "T at the base": flow.base["T"],
        "u at the base (slip)": flow.base["u"],
        "mass flux Q0": flow.mass_flux,
        "hold-up M0": flow.hold_up,
        "centre of mass h0": flow.centre_of_mass,
    }
    rows = {name: held(value, abs(value) * FLOW_DIGITS) for name, value in numbers.items()}
    table = ruled("profiles, in units of d and g cosθ", "z", "ν", "T", "u", numbered=False)
    step = (len(profiles["z"]) - 1) // 10
    for row in zip(*(profiles[name][::step] for name in ("z", "nu", "T", "u")), strict=True):
        table.add_row(*(f"{value:.6g}" for value in row))
    return [heading(scene), pairs(rows.items()), table]


def spectrum(found: Any, raw: bool, scene: Scene) -> Parts:
    """The filtered spectrum with what it passed, or all that QZ gave."""
    every, passing = number_of(len(found.raw), "eigenvalue"), number_of(len(found.eigenvalues), "passes", "pass")
    if raw:
        table = ruled("unfiltered", in_symbol("σ", scene))
        for number, sigma in enumerate(found.raw, 1):
            table.add_row(str(number), held_complex(complex(sigma), abs(complex(sigma)) * 10.0**-DOUBLE_DIGITS or None))
        return [
            heading(scene),
            table,
            paragraph(f"{every} of the pencil at truncation {found.truncation}; {passing} both filters."),
        ]
    table = ruled("", in_symbol("σ", scene), "drift", "tail")
    for number, (sigma, drift, tail) in enumerate(zip(found.eigenvalues, found.drift, found.tail, strict=True), 1):
        shown = held_complex(complex(sigma), float(drift) or None)
        table.add_row(str(number), shown, _two_figures(drift), _two_figures(tail))
    sentence = f"Of {every} at truncation {found.truncation}, {passing} both filters."
    return [heading(scene), table, paragraph(sentence)]


def in_symbol(title: str, scene: Scene) -> str:
    """A heading with the scene's symbol for σ, and its unit."""
    title = title.replace("σ", scene.symbol)
    return f"{title} / {scene.unit}" if scene.unit else title


def _two_figures(value: float | None) -> str:
    return ABSENT if value is None else f"{float(value):.1e}"


def _coloured(verdict: str) -> Text:
    return Text(verdict, style=(MISSING_LOOK if verdict == "missing" else VERDICT_LOOKS[verdict]).style)


def ruled(title: str, *headings: str, numbered: bool = True) -> Table:
    """A table with these headings, the first column for numbers of rows unless numbered is False."""
    table = Table(title=Text(title) if title else None, title_justify="left", box=SIMPLE, pad_edge=False, padding=(0, GAP - 1, 0, 0))
    if numbered:
        table.add_column("#", justify="right", no_wrap=True)
    for heading in headings:
        numeric = heading in OF_NUMBERS
        table.add_column(Text(heading), justify="right" if numeric else "left", no_wrap=True)
    return table


def pairs(rows: Iterable[tuple[str, str]]) -> Table:
    """Names and values, without rules; a value that the page does not hold on one line goes on below itself."""
    rows = list(rows)
    room = PAGE - GAP - max(len(name) for name, _ in rows)  # rich pads two columns by one character each
    table = Table(box=None, show_header=False, pad_edge=False)
    table.add_column(no_wrap=True, style="dim")
    table.add_column(no_wrap=True)
    for name, value in rows:
        table.add_row(Text(name), Text(filled(value, width=room)))
    return table
