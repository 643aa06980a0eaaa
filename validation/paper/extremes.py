"""The map of extremes: each parameter to the ends of its range, three methods of shooting and many digits.

A line of the map goes from the flow at tan θ = 0.3, T_∞ = 7 to one end: wavenumber, T_∞, e, the volume fraction at the base, the slope.
In each cell the fastest-growing mode of the pseudospectral reference is the guess; each method is asked for ten digits, and its value is
held against 25. A cell says digits reached, whether the bar is honest, and seconds, or why there is no value; every question has its time,
so that none hangs. The distance to the continuous spectrum is the ladder's (ladder.py); |σ| down to 1e-10 comes with the long waves.
"""

from __future__ import annotations

import csv
import math
from collections.abc import Iterator, Sequence
from dataclasses import asdict, dataclass, fields
from typing import Any

import mpmath
import numpy as np
from claims import Case
from random_chutes import METHODS, Tally, limited, warm

import shootstab as st
from paper.edges import kinematic_speed
from paper.rows import FIGURES, Item, Reproduction, Row
from shootstab.analyses.reference import claims

GRAINS = {"e": 0.8, "e_w": 0.8, "r": 0.6, "tan_theta": 0.3}
MIDDLE, DOWNSLOPE = 7.0, 1e-3  # chosen: T_∞ and k_x of the flow from which the lines of the map go
RTOL, DIGITS = 1e-10, 25  # chosen: what is asked of doubles, and of the value that they are held against
SUGGESTING = 48  # chosen: M of the reference
TIME, TIME_DIGITS = 15.0, 40.0  # chosen: seconds of processor for a question
LINES: dict[str, tuple[float, ...]] = {
    "K": tuple(10.0**n for n in range(-8, 2)),
    "far_temperature": (0.02, 0.05, 0.2, 1.0, 5.0, 20.0, 50.0, 100.0),
    "e": (0.5, 0.6, 0.7, 0.85, 0.9, 0.95, 0.99, 0.999),
    "tan_theta": (0.185, 0.19, 0.2, 0.25, 0.33, 0.36, 0.38, 0.39),
    "dense": (0.02, 0.01, 0.005, 0.002, 0.001, 0.0005),
}  # chosen: "dense" goes over T_∞, with which ν at the base rises from 0.54 to 0.61; ν_m is 0.62
SLOPE_OF = {0.5: 0.433, 0.6: 0.4, 0.7: 0.357, 0.85: 0.263, 0.9: 0.218, 0.95: 0.2, 0.99: 0.15, 0.999: 0.1}  # chosen: flows of T_∞ = 7 exist
QUICK = {"K": (1e-6, 1.0), "e": (0.95,)}
TABLE = "extremes.csv"
MARKS = {"holds": "#009E73", "refused": "#E69F00", "broken": "#D55E00", "no truth": "#56B4E9", "no flow": "0.85", "no mode": "0.7"}


@dataclass(frozen=True)
class ExtremeCell:
    """One method at one place of a line.

    outcome: a key of MARKS; digits right, or by the bar where there is no truth; ratio of bar to error; seconds of processor; why, where
    there is no value.
    """

    line: str
    value: float
    method: str
    outcome: str
    sigma: str = ""
    digits: float = math.nan
    ratio: float = math.nan
    seconds: float = math.nan
    nu_base: float = math.nan
    why: str = ""


def scene(line: str, value: float) -> Any:
    """The problem of a cell. Raises NoFlowError where there is no flow."""
    chute, temperature, k = dict(GRAINS), MIDDLE, DOWNSLOPE
    if line == "K":
        k = value
    elif line == "far_temperature":
        temperature = value
    elif line == "e":
        chute |= {"e": value, "tan_theta": SLOPE_OF[value]}
    elif line == "tan_theta":
        chute |= {"tan_theta": value}
    else:
        temperature = value
    return st.chute.problem(st.chute.steady(far_temperature=temperature, **chute), kx=k, ky=0.0)


def guess_of(problem: Any, line: str, value: float) -> complex | None:
    """The fastest mode of the reference; for long waves, which it does not resolve, the kinematic wave."""
    if line == "K" and value <= 1e-5:
        return -1j * kinematic_speed(problem.flow) * value
    modes = claims(problem, 3, SUGGESTING)
    return complex(max(modes, key=lambda s: s.real)) if len(modes) else None


def cells(line: str, value: float) -> list[ExtremeCell]:
    """Every method at one place."""
    tally = Tally("", 0)
    problem: Any = None
    guess: complex | None = None
    with limited(tally, "flow and reference", TIME):
        try:
            problem = scene(line, value)
        except st.NoFlowError as error:
            return [ExtremeCell(line, value, make().name, "no flow", why=str(error)) for make in METHODS]
        guess = guess_of(problem, line, value)
    if guess is None:
        why = _told(tally) or f"the reference holds no mode at M = {SUGGESTING}"
        return [ExtremeCell(line, value, make().name, "refused" if tally.faults else "no mode", why=why) for make in METHODS]
    modes = [(make().name, *shot(problem, guess, make, tally)) for make in METHODS]
    start = next((mode.sigma for _, mode, *_ in modes if mode is not None and mode.converged), guess)
    truth, why = exact(problem, start)
    return [_cell(line, value, name, mode, seconds, said, truth, why, problem.flow.base["nu"]) for name, mode, seconds, said in modes]


def shot(problem: Any, guess: complex, make: Any, tally: Tally) -> tuple[Any, float, str]:
    """(mode or None, seconds, why not)."""
    import time

    known, began, mode = len(tally.faults), time.process_time(), None
    with limited(tally, make().name, TIME):
        mode = st.refine(problem, guess=guess, rtol=RTOL, method=make(rtol=0.1 * RTOL))
    return mode, time.process_time() - began, "; ".join(words for _, words in tally.faults[known:])


def exact(problem: Any, start: Any) -> tuple[Any, str]:
    """The mode to DIGITS digits, or None and why not."""
    tally, found = Tally("", 0), None
    with limited(tally, f"{DIGITS} digits", TIME_DIGITS):
        found = st.refine(problem, guess=start, digits=DIGITS)
    if found is None:
        return None, _told(tally)
    return (found.sigma, "") if found.converged else (None, found.status)


def _told(tally: Tally) -> str:
    return "; ".join(f"{kind}: {words}" for kind, words in tally.faults)


def _cell(line: str, value: float, name: str, mode: Any, seconds: float, said: str, truth: Any, why: str, nu: float) -> ExtremeCell:
    if mode is None or not mode.converged:
        return ExtremeCell(line, value, name, "refused", seconds=seconds, nu_base=nu, why=said if mode is None else mode.status)
    sigma, size = f"{complex(mode.sigma):.12g}", abs(complex(mode.sigma))
    if not (np.isfinite(complex(mode.sigma)) and math.isfinite(float(mode.error))):
        return ExtremeCell(line, value, name, "broken", sigma, seconds=seconds, nu_base=nu, why="a value that is not finite")
    if truth is None:
        return ExtremeCell(line, value, name, "no truth", sigma, -math.log10(float(mode.error) / size), math.nan, seconds, nu, why)
    with mpmath.workdps(DIGITS + 15):
        error = float(abs(mpmath.mpmathify(mode.sigma) - truth))
    floor = max(error, 1e-16 * size)
    honest = error <= float(mode.error)
    digits, ratio = -math.log10(floor / size), float(mode.error) / floor
    return ExtremeCell(line, value, name, "holds" if honest else "broken", sigma, digits, ratio, seconds, nu)


def asked(lines: dict[str, Sequence[float]], keep: bool) -> list[ExtremeCell]:
    """All cells of these lines, from the table or asked anew and added to it."""
    path = FIGURES / TABLE
    known = _read() if keep else []
    warm()
    for line, values in lines.items():
        for value in values:
            if any(c.line == line and c.value == value for c in known):
                continue
            known += cells(line, value)
            if keep:
                with path.open("w", newline="", encoding="utf-8") as file:
                    writer = csv.writer(file)
                    writer.writerow([f.name for f in fields(ExtremeCell)])
                    writer.writerows([_text(v) for v in asdict(c).values()] for c in known)
    return [c for c in known if c.value in lines.get(c.line, ())]


def _text(value: Any) -> str:
    if isinstance(value, float):
        return "" if math.isnan(value) else f"{value:.6g}"
    return str(value)


def _read() -> list[ExtremeCell]:
    path = FIGURES / TABLE
    if not path.exists():
        return []
    types = {f.name: str(f.type) for f in fields(ExtremeCell)}
    with path.open(newline="", encoding="utf-8") as file:
        lines = list(csv.DictReader(file))
    return [ExtremeCell(**{n: float(t or "nan") if types[n] == "float" else t for n, t in line.items()}) for line in lines]


def map_of(quick: bool) -> Row:
    """The row of the table, with the picture."""
    found = asked(QUICK if quick else LINES, not quick)  # type: ignore[arg-type]
    outcomes = {mark: sum(c.outcome == mark for c in found) for mark in MARKS}
    ratios = [c.ratio for c in found if c.outcome == "holds"]
    reached = [c.digits for c in found if c.outcome == "holds"]
    slow = sum("over time" in c.why and c.outcome == "refused" for c in found)
    judged = len(ratios) + outcomes["broken"]
    cases = (
        Case("cells with a value outside its bar, or not finite", "0", str(outcomes["broken"]), 0.0, f"of {judged} held to 25 digits"),
        Case("cells that hang", "0", str(slow), 0.0, f"over {TIME:g} s"),
        Case("least bar over error", "≥ 1", "≥ 1" if min(ratios) >= 1 else "< 1", 0.0, f"{min(ratios):.2f}"),
        *_reasons(found),
    )
    if not quick:
        draw(found)
    counted = ", ".join(f"{n} {mark}" for mark, n in outcomes.items() if n)
    return Row(
        "every corner of the parameters has a value with an honest bar, or a reason",
        "beyond the paper",
        "wavelengths of hundreds of diameters, T_∞ of order 1 to 10",
        f"{len(found)} cells: {counted}; {min(reached):.1f} to {max(reached):.1f} digits",
        cases,
        figures=() if quick else ("extremes.png", TABLE),
    )


def _reasons(found: Sequence[ExtremeCell]) -> Iterator[Case]:
    """Why there is no value, one case a place and reason."""
    seen = set()
    for c in found:
        if c.outcome in ("refused", "no mode", "no truth") and (c.line, c.value, c.outcome) not in seen:
            seen.add((c.line, c.value, c.outcome))
            yield Case(f"{c.line} = {c.value:g}: {c.outcome}", "a reason", "a reason" if c.why else "none", 0.0, c.why[:160])


def draw(found: Sequence[ExtremeCell]) -> None:
    """One panel a line: digits right of each method along it, and crosses where there is no value."""
    from matplotlib.figure import Figure

    labels = {"K": "$k_x$", "far_temperature": r"$T_\infty$", "e": "e", "tan_theta": r"tanθ", "dense": r"$T_\infty$ of dense flows"}
    figure = Figure(figsize=(11, 6.4), layout="constrained")
    panels = figure.subplots(2, 3).ravel()
    for panel, (line, label) in zip(panels, labels.items(), strict=False):
        for method, marker in zip((make().name for make in METHODS), "os^", strict=True):
            own = sorted((c for c in found if c.line == line and c.method == method), key=lambda c: c.value)
            for mark, colour in MARKS.items():
                some = [c for c in own if c.outcome == mark]
                heights = [c.digits if math.isfinite(c.digits) else 0.3 for c in some]
                panel.plot([c.value for c in some], heights, marker, color=colour, markersize=6, alpha=0.75)
        if line not in ("e", "tan_theta"):
            panel.set_xscale("log")
        panel.set_ylim(0, 16.5)
        panel.axhline(-math.log10(RTOL), color="0.5", linewidth=0.7, linestyle=":")
        panel.set_xlabel(label)
        panel.grid(linewidth=0.4, alpha=0.5)
    for panel in panels[::3]:
        panel.set_ylabel("digits right")
    legend = panels[-1]
    legend.axis("off")
    for mark, colour in MARKS.items():
        legend.plot([], [], "o", color=colour, label={"holds": "within its bar", "broken": "outside its bar"}.get(mark, mark))
    for make, marker in zip(METHODS, "os^", strict=True):
        legend.plot([], [], marker, color="k", fillstyle="none", label=make().name)
    legend.legend(loc="center", frameon=False)
    figure.savefig(FIGURES / "extremes.png", dpi=160)


REPRODUCTION = Reproduction("extremes", "The map of extremes", (Item("map", map_of),))
