"""The map of extremes: each parameter to the ends of its range, three methods of shooting, the reference, and many digits.

A line of the map goes from the flow at tan θ = 0.3, T_∞ = 7 to one end: wavenumbers along and across the slope, T_∞, e, the volume fraction
at the base, the slope; |σ| falls to 1e-10 with the waves across it. The line of distances to the continuous spectrum takes its waves and
guesses from the ladder (ladder.py). Elsewhere the guess is the fastest-growing mode of the pseudospectral reference. Each method is asked
for ten digits, and its value is held against 18, or where these cannot be had against the other methods. A cell says digits reached,
whether the bar is honest, and seconds, or why there is no value; every question has its time, and warnings are errors.
"""

from __future__ import annotations

import csv
import itertools
import math
import time
import warnings
from collections.abc import Iterator, Sequence
from dataclasses import asdict, dataclass, fields
from functools import cache
from typing import Any

import mpmath
import numpy as np
from claims import Case
from random_chutes import BIG, METHODS, RAISED, SLOW, Tally, limited, warm
from scenes import problem as built_in

import shootstab as st
from paper.edges import kinematic_speed
from paper.ladder import BY_DIGITS, RUNGS, SCENE, ladder
from paper.rows import FIGURES, Item, Reproduction, Row
from shootstab.analyses.reference import claims
from shootstab.models.chute import chute_collocation

GRAINS = {"e": 0.8, "e_w": 0.8, "r": 0.6, "tan_theta": 0.3}
MIDDLE, DOWNSLOPE = 7.0, 1e-3  # chosen: T_∞ and k_x of the flow from which the lines of the map go
RTOL, DIGITS = 1e-10, 18  # chosen: what is asked of doubles, and of the value that they are held against
SUGGESTING, REFERENCE = 48, 96  # chosen: M of the reference that suggests, and of the one held against the truth
LONG, ACROSS = 1e-5, 1e-3  # chosen: k_x and k_y below which the asymptotics of long waves is the guess: −i c k_x, and σ ∝ k_y²
TIME, TIME_DIGITS = 20.0, 30.0  # chosen: seconds of processor for a question
LINES: dict[str, tuple[float, ...]] = {
    "K": tuple(10.0**n for n in range(-8, 2)),
    "ky": (3e-7, 3e-6, 1e-5, 1e-4, 1e-3, 1e-2, 0.1, 1.0, 10.0),
    "far_temperature": (0.02, 0.05, 0.2, 1.0, 5.0, 20.0, 50.0, 100.0),
    "e": (0.5, 0.6, 0.7, 0.85, 0.9, 0.95, 0.99, 0.999),
    "tan_theta": (0.185, 0.19, 0.2, 0.25, 0.33, 0.36, 0.38, 0.39),
    "dense": (0.02, 0.01, 0.005, 0.002, 0.001, 0.0005),
}  # chosen: "dense" goes over T_∞, with which ν at the base rises from 0.54 to 0.61; ν_m is 0.62
SLOPE_OF = {0.5: 0.433, 0.6: 0.4, 0.7: 0.357, 0.85: 0.263, 0.9: 0.218, 0.95: 0.2, 0.99: 0.15, 0.999: 0.1}  # chosen: flows of T_∞ = 7 exist
QUICK: dict[str, tuple[float, ...]] = {"K": (1e-6, 1.0), "e": (0.95,)}
TABLE = "extremes.csv"
UNSEEN = 0.3  # chosen: the height at which the picture shows a cell without a value
HOLDS, REFUSED, BROKEN, LATE, AGREE, VALUE, NO_FLOW, NO_MODE = (
    "holds", "refused", "broken", "over time", "no truth, methods agree", "the reference", "no flow", "no mode"
)  # fmt: skip
MARKS = {
    HOLDS: "#009E73",
    AGREE: "#56B4E9",
    REFUSED: "#E69F00",
    LATE: "#CC79A7",
    BROKEN: "#D55E00",
    VALUE: "0.45",
    NO_FLOW: "0.85",
    NO_MODE: "0.7",
}
PSEUDOSPECTRAL = f"pseudospectral, M = {REFERENCE}"  # the name of the reference among the methods


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


@cache
def rungs() -> dict[float, tuple[float, complex]]:
    """(k_x, σ) by the distance to the continuous spectrum, as the ladder finds them."""
    return {wanted: (rung.kx, rung.sigma) for wanted, rung in zip(RUNGS, ladder(RUNGS), strict=True)}


def scene(line: str, value: float) -> Any:
    """The problem of a cell. Raises NoFlowError where there is no flow."""
    if line == "distance":
        return st.chute.problem(built_in(SCENE).flow, kx=rungs()[value][0], ky=0.0)
    chute, temperature, k = dict(GRAINS), MIDDLE, (DOWNSLOPE, 0.0)
    if line == "K":
        k = (value, 0.0)
    elif line == "ky":
        k = (0.0, value)
    elif line == "far_temperature":
        temperature = value
    elif line == "e":
        chute |= {"e": value, "tan_theta": SLOPE_OF[value]}
    elif line == "tan_theta":
        chute |= {"tan_theta": value}
    else:
        temperature = value
    return st.chute.problem(st.chute.steady(far_temperature=temperature, **chute), kx=k[0], ky=k[1])


def guess_of(problem: Any, line: str, value: float) -> complex | None:
    """The fastest mode of the reference; for what it does not resolve the asymptotics of long waves; on the ladder its own."""
    if line == "distance":
        return rungs()[value][1]
    if line == "K" and value <= LONG:
        return -1j * kinematic_speed(problem.flow) * value
    if line == "ky" and value < ACROSS:
        shorter = st.chute.problem(problem.flow, 0.0, ACROSS)
        found = guess_of(shorter, line, ACROSS)
        return None if found is None else complex(st.refine(shorter, found, rtol=RTOL).sigma) * (value / ACROSS) ** 2
    modes = claims(problem, 3, SUGGESTING)
    if len(modes):
        return complex(max(modes, key=lambda s: s.real))
    # a dense flow holds layers at the base that such an M does not resolve; its waves are long still
    return -1j * kinematic_speed(problem.flow) * problem.kx if line in ("dense", "far_temperature") else None


@dataclass(frozen=True)
class MethodAnswer:
    """What one method says: a mode or the value of the reference, or the kind of fault and its words; seconds of processor."""

    method: str
    mode: Any = None
    value: complex | None = None
    fault: str = ""
    why: str = ""
    seconds: float = math.nan


def cells(line: str, value: float) -> list[ExtremeCell]:
    """Every method at one place."""
    tally = Tally("", 0)
    problem: Any = None
    guess: complex | None = None
    names = [*(make().name for make in METHODS), PSEUDOSPECTRAL]
    with limited(tally, "flow and reference", TIME), warnings.catch_warnings():
        warnings.simplefilter("error")
        try:
            problem = scene(line, value)
        except st.NoFlowError as error:
            return [ExtremeCell(line, value, name, NO_FLOW, why=str(error)) for name in names]
        guess = guess_of(problem, line, value)
    if guess is None:
        outcome = _outcome(tally.faults[0][0]) if tally.faults else NO_MODE
        why = _told(tally) or f"the reference holds no mode at M = {SUGGESTING}"
        return [ExtremeCell(line, value, name, outcome, why=why) for name in names]
    answers = [shot(problem, guess, make) for make in METHODS]
    answers.append(referred(problem, guess))
    start = next((a.mode.sigma for a in answers if a.mode is not None and a.mode.converged), guess)
    near = line == "distance" and value < BY_DIGITS
    truth, why = (None, "many digits take minutes here") if near else exact(problem, start)
    alike = truth is not None or agreeing([a.mode for a in answers if a.mode is not None and a.mode.converged])
    return [_cell(line, value, a, truth, why, alike, problem.flow.base["nu"]) for a in answers]


def shot(problem: Any, guess: complex, make: Any) -> MethodAnswer:
    """What a method of shooting says."""
    tally, began, mode = Tally("", 0), time.process_time(), None
    with limited(tally, make().name, TIME), warnings.catch_warnings():
        warnings.simplefilter("error")
        mode = st.refine(problem, guess=guess, rtol=RTOL, method=make(rtol=0.1 * RTOL))
    return _answer(make().name, tally, time.process_time() - began, mode=mode)


def referred(problem: Any, guess: complex) -> MethodAnswer:
    """The eigenvalue of the reference's matrices next to the guess."""
    tally, began, found = Tally("", 0), time.process_time(), None
    with limited(tally, PSEUDOSPECTRAL, TIME):
        found = chute_collocation.refine(problem.flow, problem.kx, problem.ky, guess, REFERENCE).sigma
    return _answer(PSEUDOSPECTRAL, tally, time.process_time() - began, value=found)


def _answer(name: str, tally: Tally, seconds: float, **found: Any) -> MethodAnswer:
    kind, words = tally.faults[0] if tally.faults else ("", "")
    return MethodAnswer(name, **found, fault=kind, why=words, seconds=seconds)


def exact(problem: Any, start: Any) -> tuple[Any, str]:
    """The mode to DIGITS digits, or None and why not."""
    tally, found = Tally("", 0), None
    with limited(tally, f"{DIGITS} digits", TIME_DIGITS):
        found = st.refine(problem, guess=start, digits=DIGITS)
    if found is None:
        return None, _told(tally)
    return (found.sigma, "") if found.converged else (None, found.status)


def agreeing(modes: Sequence[Any]) -> bool:
    """Whether all of these lie within each other's bars."""
    return all(abs(complex(a.sigma) - complex(b.sigma)) <= float(a.error) + float(b.error) for a, b in itertools.combinations(modes, 2))


def _told(tally: Tally) -> str:
    return "; ".join(f"{kind}: {words}" for kind, words in tally.faults)


def _outcome(fault: str) -> str:
    """The outcome of a cell without a value, by the kind of its fault: whatever is raised beside a refusal is a broken promise."""
    return LATE if fault == SLOW else BROKEN if fault in (RAISED, BIG) else REFUSED


def _cell(line: str, value: float, answer: MethodAnswer, truth: Any, why: str, alike: bool, nu: float) -> ExtremeCell:
    told = {"seconds": answer.seconds, "nu_base": nu}
    if answer.fault:
        return ExtremeCell(line, value, answer.method, _outcome(answer.fault), why=answer.why, **told)
    mode = answer.mode
    if mode is not None and not mode.converged:
        return ExtremeCell(line, value, answer.method, REFUSED, why=mode.status, **told)
    sigma = complex(answer.value if mode is None else mode.sigma)
    size, text = abs(sigma), f"{sigma:.12g}"
    if not (np.isfinite(sigma) and (mode is None or math.isfinite(float(mode.error)))):
        outcome, said = (VALUE, "did not settle") if mode is None else (BROKEN, "a value that is not finite")
        return ExtremeCell(line, value, answer.method, outcome, text, why=said, **told)
    if truth is None:
        if mode is None:
            return ExtremeCell(line, value, answer.method, VALUE, text, why=why, **told)
        outcome = AGREE if alike else BROKEN
        return ExtremeCell(line, value, answer.method, outcome, text, -math.log10(float(mode.error) / size), why=why, **told)
    with mpmath.workdps(DIGITS + 15):
        error = float(abs(mpmath.mpmathify(sigma if mode is None else mode.sigma) - truth))
    floor = max(error, 1e-16 * size)
    digits = max(0.0, -math.log10(floor / size))
    if mode is None:
        return ExtremeCell(line, value, answer.method, VALUE, text, digits, **told)
    outcome = HOLDS if error <= float(mode.error) else BROKEN
    return ExtremeCell(line, value, answer.method, outcome, text, digits, float(mode.error) / floor, **told)


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
    lines = dict(QUICK) if quick else {**LINES, "distance": RUNGS}
    found = asked(lines, not quick)
    outcomes = {mark: sum(c.outcome == mark for c in found) for mark in MARKS}
    ratios = [c.ratio for c in found if c.outcome == HOLDS]
    reached = [c.digits for c in found if c.outcome == HOLDS]
    referred = [c.digits for c in found if c.outcome == VALUE and math.isfinite(c.digits)]
    broken = f"{outcomes[BROKEN]}" + "".join(f"; {c.line} = {c.value:g}, {c.method}: {c.why[:80]}" for c in found if c.outcome == BROKEN)
    late = f"{outcomes[LATE]}" + "".join(f"; {c.line} = {c.value:g}, {c.method}" for c in found if c.outcome == LATE)
    cases = (
        Case("values outside their bars or not finite, warnings, faults", "0", broken, 0.0, f"{len(ratios)} held to {DIGITS} digits"),
        Case("cells that hang", "0", late, 0.0, f"over {TIME:g} s"),
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
        f"{len(found)} cells: {counted}; {min(reached):.1f} to {max(reached):.1f} digits where the bar holds, bar over error "
        f"{np.median(ratios):.0f} in the median; {PSEUDOSPECTRAL}: {min(referred):.1f} to {max(referred):.1f} digits",
        cases,
        figures=() if quick else ("extremes.png", TABLE),
    )


def _reasons(found: Sequence[ExtremeCell]) -> Iterator[Case]:
    """Why there is no value, one case a place and reason."""
    seen = set()
    for c in found:
        if c.outcome in (REFUSED, NO_MODE, AGREE) and (c.line, c.value, c.outcome) not in seen:
            seen.add((c.line, c.value, c.outcome))
            yield Case(f"{c.line} = {c.value:g}: {c.outcome}", "a reason", "a reason" if c.why else "none", 0.0, c.why[:160])


def draw(found: Sequence[ExtremeCell]) -> None:
    """One panel a line: digits right of each method along it, and crosses where there is no value."""
    from matplotlib.figure import Figure

    labels = {
        "K": "$k_x$, $k_y$ = 0",
        "ky": "$k_y$, $k_x$ = 0",
        "far_temperature": r"$T_\infty$",
        "e": "e",
        "tan_theta": r"tanθ",
        "dense": r"$T_\infty$ of dense flows",
        "distance": "distance to the continuous spectrum, over |σ|",
    }
    figure = Figure(figsize=(14, 6.8), layout="constrained")
    panels = figure.subplots(2, 4).ravel()
    markers = dict(zip([*(make().name for make in METHODS), PSEUDOSPECTRAL], "os^x", strict=True))
    for panel, (line, label) in zip(panels, labels.items(), strict=False):
        for method, marker in markers.items():
            for mark, colour in MARKS.items():
                some = [c for c in found if (c.line, c.method, c.outcome) == (line, method, mark)]
                heights = [c.digits if math.isfinite(c.digits) else UNSEEN for c in some]
                panel.plot([c.value for c in some], heights, marker, color=colour, markersize=6, alpha=0.75)
        if line not in ("e", "tan_theta"):
            panel.set_xscale("log")
        panel.set_ylim(0, 16.5)
        panel.axhline(-math.log10(RTOL), color="0.5", linewidth=0.7, linestyle=":")
        panel.set_xlabel(label)
        panel.grid(linewidth=0.4, alpha=0.5)
    for panel in panels[::4]:
        panel.set_ylabel(f"digits right ({UNSEEN:g}: no value)")
    legend = panels[-1]
    legend.axis("off")
    said = {HOLDS: "within its bar", BROKEN: "outside its bar, or raised", VALUE: "the reference, which has no bar"}
    for mark, colour in MARKS.items():
        if any(c.outcome == mark for c in found):
            legend.plot([], [], "o", color=colour, label=said.get(mark, mark))
    for method, marker in markers.items():
        legend.plot([], [], marker, color="k", fillstyle="none", label=method)
    legend.legend(loc="center", frameon=False)
    figure.savefig(FIGURES / "extremes.png", dpi=160)


REPRODUCTION = Reproduction("extremes", "The map of extremes", (Item("map", map_of),))
