"""Shooting against the pseudospectral reference on chute scenes drawn at random: digits in agreement over the truncation M.

The scenes are those of validation/random_chutes.py, with a seed of their own. In each the fastest-growing mode that a QZ of M = 48 holds
to be converged is the guess of both: of shooting, whose value comes with a bound, and of inverse iteration on the matrices of every M. The
two share the steady flow and nothing else. Where they agree in fewer than ALIKE digits at the largest M, Taylor series of DIGITS digits,
which share no line of integration with either, decide. Where shooting and many digits find no mode, a verdict on the guess says whether
there is one: by a count, not by an iteration.

The table of all scenes is kept in figures/two-methods.csv as it grows, and what stands there is not asked again. One run of the full form
asks for ONE_RUN of processor time at most; the row says how many scenes are there, and the next run goes on.
"""

from __future__ import annotations

import csv
import itertools
import math
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, fields, replace
from pathlib import Path
from typing import Any

import mpmath
import numpy as np
from claims import Case
from random_chutes import Drawn, Tally, limited, scenes, warm

import shootstab as st
from paper.rows import FIGURES, Item, Reproduction, Row, processor_time
from shootstab.analyses.reference import claims
from shootstab.core.records import CONFIRMED, INACCURATE
from shootstab.models.chute import chute_collocation as chute

SEED = 3  # chosen
NUMBER, QUICK = 300, 3  # chosen: scenes with a mode that the full form asks about, and the quick one
ONE_RUN = 900.0  # chosen: seconds of processor after which a run asks about no further scene
SUGGESTING, SUGGESTED_TO = 48, 4  # chosen: M of the spectrum that holds the mode, and the digits to which it believes itself
TRUNCATIONS = (16, 24, 32, 48, 64, 96, 128)  # chosen: half octaves
RTOL = 1e-10  # chosen: the accuracy asked of shooting
ALIKE = 8.0  # chosen: digits of agreement below which many digits decide
DIGITS = 25  # chosen: those of the value that decides
TIME, TIME_DIGITS = 20.0, 90.0  # chosen: seconds of processor for one question, and for that of many digits
MOST = 16.0  # exact: digits of a double, beyond which agreement is not counted
TABLE = FIGURES / "two-methods.csv"
NO_FLOW, NO_MODE = "no flow", f"QZ holds no mode at M = {SUGGESTING}"
SHOOTING, PSEUDOSPECTRAL, BOTH, OPEN = "shooting", "pseudospectral", "both to fewer digits", "not decided"
NO_VERDICT = "none in time"


@dataclass(frozen=True)
class AskedScene:
    """What one draw came to: skipped, and why, or the mode by shooting with its bound, and the digits in which each M agrees with it.

    judge: where they differ, who is right; its errors are those of shooting and of the largest M against the value of many digits. verdict:
    where that is not decided, what the count about the guess says.
    """

    index: int
    skipped: str = ""
    parameters: str = ""
    sigma: str = ""
    bound: float = math.nan
    digits: str = ""
    judge: str = ""
    truth: str = ""
    error_of_shooting: float = math.nan
    error_of_pseudospectral: float = math.nan
    why: str = ""
    verdict: str = ""

    @property
    def agreement(self) -> list[float]:
        """Digits in agreement at each of TRUNCATIONS; 0 where the iteration did not settle."""
        return [float(d) for d in self.digits.split()]


def agreement(a: complex, b: complex) -> float:
    """−log10 |a − b|/|b|, from 0 to MOST; 0 where one is not finite."""
    difference = abs(a - b) / abs(b)
    if not math.isfinite(difference):
        return 0.0
    return MOST if difference <= 10.0**-MOST else max(0.0, -math.log10(difference))


def asked(index: int, drawn: Drawn) -> AskedScene:
    """One draw, asked of both."""
    parameters, far_temperature, kx, ky = drawn
    told = ", ".join(f"{k} = {v}" for k, v in {**parameters, "far_temperature": far_temperature, "kx": kx, "ky": ky}.items())
    tally, scene = Tally("", index), AskedScene(index, parameters=told)
    problem, guess = posed(drawn, tally)
    if guess is None and not tally.faults:
        return AskedScene(index, NO_FLOW if problem is None else NO_MODE)
    if guess is None:
        return replace(scene, judge=OPEN, why=told_of(tally))
    mode: Any = None
    with limited(tally, "shooting", TIME):
        mode = st.refine(problem, guess=guess, rtol=RTOL)
    values = [pseudospectral(problem, guess, M, tally) for M in TRUNCATIONS]
    if mode is None or not mode.converged:
        judge = replace(scene, judge=OPEN, why=f"shooting: {told_of(tally) if mode is None else mode.status}")
        return decided(problem, replace(judge, digits=" ".join("0" for _ in values)), guess, values[-1], tally)
    digits = [agreement(value, complex(mode.sigma)) for value in values]
    scene = replace(scene, sigma=f"{complex(mode.sigma):.15g}", bound=float(mode.error), digits=" ".join(f"{d:.1f}" for d in digits))
    return scene if digits[-1] >= ALIKE else decided(problem, scene, mode.sigma, values[-1], tally)


def posed(drawn: Drawn, tally: Tally) -> tuple[Any, complex | None]:
    """The problem of a draw and the fastest-growing mode of the reference; None where there is no flow, no mode, or no time."""
    parameters, far_temperature, kx, ky = drawn
    problem: Any = None
    with limited(tally, "flow and reference", TIME):
        try:
            problem = st.chute.problem(st.chute.steady(far_temperature=far_temperature, **parameters), kx=kx, ky=ky)
        except st.NoFlowError:
            return None, None
        modes = claims(problem, SUGGESTED_TO, SUGGESTING)
        return problem, complex(max(modes, key=lambda s: s.real)) if len(modes) else None
    return problem, None


def with_verdict(scene: AskedScene, drawn: Drawn) -> AskedScene:
    """A scene that is not decided, with the verdict on the guess to the digits to which the reference believes itself."""
    tally, told = Tally("", scene.index), NO_VERDICT
    problem, guess = posed(drawn, tally)
    with limited(tally, "verdict", TIME):
        if guess is not None:
            told = st.verify(problem, [guess], digits=SUGGESTED_TO, missing="none").verdicts[0].verdict
    return replace(scene, verdict=told)


def pseudospectral(problem: Any, guess: complex, M: int, tally: Tally) -> complex:
    """The eigenvalue of the matrices of this M next to the guess; NaN where the iteration does not settle."""
    with limited(tally, f"M = {M}", TIME):
        return chute.refine(problem.flow, problem.kx, problem.ky, guess, M).sigma
    return complex(math.nan, math.nan)


def decided(problem: Any, scene: AskedScene, guess: Any, value: complex, tally: Tally) -> AskedScene:
    """The scene with what many digits next to the guess say of it."""
    found: Any = None
    with limited(tally, f"{DIGITS} digits", TIME_DIGITS):
        found = st.refine(problem, guess=guess, digits=DIGITS)
    if found is None or not found.converged:
        return replace(scene, judge=OPEN, why="; ".join(w for w in (scene.why, told_of(tally) if found is None else found.status) if w))
    with mpmath.workdps(DIGITS + 15):
        size = float(abs(found.sigma))
        shooting = float(abs(mpmath.mpmathify(complex(scene.sigma)) - found.sigma)) / size if scene.sigma else math.nan
        other = float(abs(mpmath.mpmathify(value) - found.sigma)) / size if np.isfinite(value) else math.nan
        truth = mpmath.nstr(found.sigma, DIGITS)
    right = 10.0**-ALIKE
    judge = SHOOTING if shooting <= right else PSEUDOSPECTRAL if other <= right else BOTH
    return replace(scene, judge=judge, truth=truth, error_of_shooting=shooting, error_of_pseudospectral=other)


def told_of(tally: Tally) -> str:
    """What went wrong, in words."""
    return "; ".join(f"{kind}: {words}" for kind, words in tally.faults)


def read(table: Path = TABLE) -> list[AskedScene]:
    """What is in the table; a last line that was cut short is not."""
    if not table.exists():
        return []
    whole = table.read_text(encoding="utf-8")
    types = {f.name: f.type for f in fields(AskedScene)}
    convert = {"int": int, "float": lambda s: float(s or "nan"), "str": str}
    lines = csv.DictReader(whole[: whole.rfind("\n") + 1].splitlines())
    return [AskedScene(**{name: convert[str(types[name])](text) for name, text in line.items()}) for line in lines]


def scenes_asked(number: int, table: Path | None, seconds: float = ONE_RUN) -> list[AskedScene]:
    """The scenes, with a mode as many as are wanted or these seconds of processor allow, and what was skipped on the way.

    They are taken from the table, or asked anew and added to it.
    """
    known = {} if table is None else {scene.index: scene for scene in read(table)}
    warm()
    for index, drawn in itertools.takewhile(lambda draw: draw[0] <= max(known, default=-1), scenes(SEED)):
        if index in known and known[index].judge == OPEN and not known[index].verdict:
            known[index] = with_verdict(known[index], drawn)
    if table is not None:
        table.parent.mkdir(exist_ok=True)
        with table.open("w", newline="", encoding="utf-8") as file:  # a line that was cut short is left out
            csv.writer(file).writerows([[f.name for f in fields(AskedScene)], *(line(scene) for scene in known.values())])
    found: list[AskedScene] = []
    began = processor_time()
    for index, drawn in scenes(SEED):
        if sum(not scene.skipped for scene in found) >= number:
            break
        scene = known.get(index)
        if scene is None:
            if processor_time() - began > seconds:
                break
            scene = asked(index, drawn)
            if scene.judge == OPEN:
                scene = with_verdict(scene, drawn)
            if table is not None:
                with table.open("a", newline="", encoding="utf-8") as file:
                    csv.writer(file).writerow(line(scene))
        found.append(scene)
    return found


def line(scene: AskedScene) -> list[str]:
    """A line of the table; what is not known is empty."""
    values = [getattr(scene, f.name) for f in fields(AskedScene)]
    return ["" if isinstance(v, float) and math.isnan(v) else f"{v:.3g}" if isinstance(v, float) else str(v) for v in values]


def row(quick: bool) -> Row:
    """The row of the table, with the picture."""
    found = scenes_asked(QUICK if quick else NUMBER, None if quick else TABLE)
    used = [scene for scene in found if not scene.skipped]
    skipped = Counter(scene.skipped for scene in found if scene.skipped)
    table = np.array([scene.agreement for scene in used if scene.sigma])
    medians, asked_of = np.median(table, axis=0), -math.log10(RTOL)
    asked_for = QUICK if quick else NUMBER
    left = f"{len(used)} of {asked_for} scenes so far" if len(used) < asked_for else ""
    differ = [scene for scene in used if scene.judge]
    judges = Counter(scene.judge for scene in differ)
    verdicts = Counter(scene.verdict for scene in differ if scene.judge == OPEN)
    within = sum(scene.error_of_shooting * abs(complex(scene.sigma)) <= scene.bound for scene in differ if scene.sigma and scene.truth)
    of = sum(bool(scene.sigma and scene.truth) for scene in differ)
    cases = [
        Case("scenes asked of both", f"{asked_for}", f"{len(used)}", None, ", ".join(f"{n} draws: {w}" for w, n in skipped.items())),
        Case(f"the median digits grow with M, up to the {asked_of:.0f} asked of shooting", "yes", "yes" if grows(medians) else "no", 0.0),
        Case("where they differ, the pseudospectral value is right and shooting is not", "0", str(judges[PSEUDOSPECTRAL]), 0.0),
        Case(
            "where they do not decide, the value of QZ is a mode by the count",
            "0",
            str(sum(verdicts[name] for name in (CONFIRMED, INACCURATE))),
            0.0,
            ", ".join(f"{n} {verdict}" for verdict, n in sorted(verdicts.items())),
        ),
        Case("where many digits decide, the bound of shooting holds", f"{of} of {of}", f"{within} of {of}", 0.0 if of else None),
        *by_truncation(table),
    ]
    if not quick:
        draw(table)
    said = ", ".join(f"{n} {judge}" for judge, n in sorted(judges.items())) or "none"
    if verdicts:
        said += f" ({', '.join(f'{n} {verdict}' for verdict, n in sorted(verdicts.items()))} by the count about the value of QZ)"
    reached = ", ".join(f"{m:.1f} at M = {M}" for M, m in zip(TRUNCATIONS, medians, strict=True))
    lost = sum(not scene.sigma for scene in used)
    return Row(
        "the pseudospectral value converges to that of shooting as M grows",
        "2.4, 4.1",
        "M must be large enough; no second method",
        f"{len(used)} of {asked_for} scenes; shooting finds no mode at the guess in {lost}; in the {len(table)} others median digits in "
        f"agreement {reached}; fewer than {ALIKE:.0f} at the last, or no mode, in {len(differ)}, where {DIGITS} digits say: {said}",
        tuple(cases),
        left=left,
        figures=() if quick else ("two-methods.png", TABLE.name),
    )


def grows(medians: np.ndarray) -> bool:
    """Whether the digits grow from each M to the next, until they are those asked of shooting, and reach them."""
    capped = np.minimum(medians, -math.log10(RTOL))
    return bool(((np.diff(capped) > 0) | (capped[:-1] == -math.log10(RTOL))).all() and capped[-1] == -math.log10(RTOL))


def by_truncation(table: np.ndarray) -> Iterator[Case]:
    """How many scenes agree in 4, 8 and 10 digits at each M, to be seen."""
    for M, column in zip(TRUNCATIONS, table.T, strict=True):
        counts = ", ".join(f"{(column >= d).mean():.0%} in {d}" for d in (4, 8, 10))
        yield Case(f"M = {M}: scenes that agree", counts, counts, None, f"median {np.median(column):.1f} digits, least {column.min():.1f}")


def draw(table: np.ndarray) -> None:
    """Digits in agreement over M: the median, and how the scenes scatter about it."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(6.4, 4.2), layout="constrained")
    panel = figure.subplots()
    levels: Sequence[float] = (5, 25, 50, 75, 95)
    low, quarter, median, three, high = np.percentile(table, levels, axis=0)
    panel.fill_between(TRUNCATIONS, low, high, color="#0072B2", alpha=0.15, linewidth=0, label="5 % to 95 % of the scenes")
    panel.fill_between(TRUNCATIONS, quarter, three, color="#0072B2", alpha=0.3, linewidth=0, label="25 % to 75 %")
    panel.plot(TRUNCATIONS, median, "o-", color="#0072B2", label="median")
    panel.axhline(-math.log10(RTOL), color="0.4", linewidth=0.8, linestyle=":")
    panel.annotate("asked of shooting", (TRUNCATIONS[0], -math.log10(RTOL)), textcoords="offset points", xytext=(0, 3), fontsize="small")
    panel.set_xscale("log")
    panel.set_xticks(TRUNCATIONS, [str(M) for M in TRUNCATIONS])
    panel.minorticks_off()
    panel.set_ylim(0, None)
    panel.set_xlabel("truncation M of the pseudospectral series")
    panel.set_ylabel("digits in which the mode agrees with shooting")
    panel.set_title(f"The fastest-growing mode of {len(table)} chute scenes drawn at random", fontsize="medium")
    panel.grid(linewidth=0.4, alpha=0.5)
    panel.legend(loc="lower right", frameon=True, fontsize="small")
    figure.savefig(FIGURES / "two-methods.png", dpi=160)


REPRODUCTION = Reproduction("two_methods", "Shooting against pseudospectral over random scenes", (Item("random scenes", row),))
