"""Problems as their sources print them, in scene files: what the reduction finds, and the published digits; `--table` prints a table,
`--mistakes` those of users and what they are told."""

from __future__ import annotations

import math
import sys
import time
import tomllib
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any, TypeVar

import mpmath
from claims import Case, Claim, main

import shootstab as st
from shootstab.core.errors import InputError
from shootstab.core.records import Mode
from shootstab.core.scene_notes import Known, known
from shootstab.formulation.dedalus_table import problem_table
from shootstab.formulation.equation_scene import from_table
from shootstab.formulation.problem import EquationProblem

DEDALUS = Path(__file__).parent / "dedalus"  # scenes in the spelling of Dedalus' scripts, as its users write them
SCENES = Path(__file__).parent.parent / "shootstab" / "models" / "catalogue" / "scenes"
POISEUILLE = "0.0037396706229794099322", "-0.23752648882047010745"
MANY = 40  # chosen: digits
T = TypeVar("T")


@dataclass(frozen=True)
class Written:
    """A scene as text: its tables, and what is published of it."""

    name: str
    text: str

    @cached_property
    def tables(self) -> dict[str, Any]:
        """The tables of the scene file."""
        return tomllib.loads(self.text)

    @property
    def lines(self) -> int:
        """Lines that the user writes: those of the table [problem], or [dedalus]."""
        table = "[dedalus]" if "dedalus" in self.tables else "[problem]"
        return len(self.text[self.text.index(table) :].strip().splitlines())

    @property
    def published(self) -> Known:
        """The eigenvalue, with the digits of it that hold and their source."""
        found = known(self.tables)
        assert found is not None, self.name
        return found

    def problem(self) -> EquationProblem:
        """Read and reduced."""
        return from_table(problem_table(self.tables["dedalus"])[0] if "dedalus" in self.tables else self.tables["problem"])


def noted(order: int, value: tuple[str, str], digits: int, source: str, text: str) -> str:
    """A scene with its order and what is published of it."""
    return f'[about]\norder = {order}\n[published]\nvalue = ["{value[0]}", "{value[1]}"]\ndigits = {digits}\nsource = "{source}"\n{text}'


PLANE = """
[problem]
unknowns = ["u", "v", "p"]
parameters = { R = 10000, a = 1 }
where = { U = "1 - z**2" }
equations = [
  "sigma*u + i*a*U*u + v*d(U) + i*a*p = (d(u,2) - a**2*u)/R",
  "sigma*v + i*a*U*v + d(p) = (d(v,2) - a**2*v)/R",
  "i*a*u + d(v) = 0",
]
left = { at = -1, conditions = ["u", "v"] }
right = { at = 1, conditions = ["u", "v"] }
"""
FREE = """
[problem]
unknowns = ["u", "w", "p", "T"]
parameters = { a = 2.5, Pr = 0.71, Ra = 1000 }
equations = [
  "sigma*u/Pr + i*a*p = d(u,2) - a**2*u",
  "sigma*w/Pr + d(p) = d(w,2) - a**2*w + Ra*T",
  "i*a*u + d(w) = 0",
  "sigma*T = d(T,2) - a**2*T + w",
]
left = { at = 0, conditions = ["d(u)", "w", "T"] }
right = { at = 1, conditions = ["d(u)", "w", "T"] }
"""
LAYER = """
[problem]
unknowns = ["u", "v", "p"]
parameters = { a = 0.4446 }
where = { U = "tanh(z)" }
equations = ["(sigma + i*a*U)*u + v*d(U) + i*a*p = 0", "(sigma + i*a*U)*v + d(p) = 0", "i*a*u + d(v) = 0"]
left = "infinity"
right = "infinity"
"""


def spatial(plate: str) -> str:
    """Malik's case 6 of the scene file of his case 3: α as the eigenvalue, for given ω, at M = 4.5, R = 1500 and T0 = 1100 °R."""
    changes = {
        'variable = "y"': 'variable = "y"\neigenvalue = "alpha"\nreference = 0.253',
        "M = 2.5": "M = 4.5",
        "s = 0.74475, R = 3000, alpha = 0.06, beta = 0.1": f"s = {198.6 * 5.05 / 1100!r}, R = 1500, omega = 0.23, beta = 0",
        'L = "sigma + a*U"': 'L = "-i*omega + a*U"',
    }
    text = plate[plate.index("[problem]") :]
    for old, new in changes.items():
        assert old in text, old
        text = text.replace(old, new)
    return noted(8, ("0.2534012", "-0.0024936"), 7, "Malik 1990, case 6, re-computed; Mack's bulk viscosity", text)


WRITTEN = (
    Written("plane Poiseuille, u v p", noted(4, POISEUILLE, 20, "Orszag 1971, re-computed", PLANE)),
    Written("Bénard, u w p T, free", noted(6, ("2.973306944007455851022", "0"), 20, "exact: see models/gallery/benard.py", FREE)),
    Written("Malik 6, spatial", spatial((SCENES / "mack.toml").read_text(encoding="utf-8"))),
    Written("shear layer, u v p", noted(2, ("0.1897", "0"), 4, "Michalke 1964", LAYER)),
    *(Written(name, file.read_text(encoding="utf-8")) for name, file in sorted((file.stem, file) for file in SCENES.glob("*.toml"))),
    *(Written(f"Dedalus: {file.stem}", file.read_text(encoding="utf-8")) for file in sorted(DEDALUS.glob("*.toml"))),
)


# what is changed in PLANE: the mistake, the text, and what stands in its place
MISTAKES = (
    ("a condition is forgotten", 'right = { at = 1, conditions = ["u", "v"] }', 'right = { at = 1, conditions = ["u"] }'),
    ("a condition too many", 'conditions = ["u", "v"] }\nright', 'conditions = ["u", "v", "p"] }\nright'),
    (
        "all conditions at one end",
        'left = { at = -1, conditions = ["u", "v"] }\nright = { at = 1, conditions = ["u", "v"] }',
        'left = { at = -1, conditions = ["u", "v", "d(u)", "p"] }\nright = { at = 1, conditions = [] }',
    ),
    ("a condition that the equations make true", 'conditions = ["u", "v"] }\nright', 'conditions = ["u", "i*a*u + d(v)"] }\nright'),
    ("the ends are exchanged", "at = -1", "at = 2"),
    ("a name that is not known", "v*d(U)", "v*d(W)"),
    ("a term that is not linear", "v*d(U)", "v*d(u)"),
    ("a term without an unknown", "i*a*p = (d(u,2)", "i*a*p + 1 = (d(u,2)"),
    ("an equation is missing", '  "i*a*u + d(v) = 0",\n', ""),
    ("an equation stands twice", "i*a*u + d(v) = 0", "2*(sigma*u + i*a*U*u + v*d(U) + i*a*p) = 2*(d(u,2) - a**2*u)/R"),
    ("no eigenvalue", "sigma*", "0*"),
    ("a coefficient without a limit", 'right = { at = 1, conditions = ["u", "v"] }', 'right = "infinity"'),
    ("a coefficient that is singular at an end", '"1 - z**2"', '"1/(1 - z)"'),
    ("a parenthesis is not closed", "(d(v,2) - a**2*v)/R", "(d(v,2) - a**2*v/R"),
)


def told(old: str, new: str) -> str | None:
    """What is said of PLANE with a mistake in it; None where nothing is."""
    assert old in PLANE, old
    try:
        Written("mistake", PLANE.replace(old, new)).problem()
    except InputError as error:
        return str(error)
    return None


@dataclass(frozen=True)
class SceneFound:
    """What came of a scene, each with its processor seconds in ms; many is the mode in many digits where they are offered."""

    problem: EquationProblem
    reduced: float
    mode: Mode
    one: float
    many: Mode | None
    refused: str
    whole: float


def timed(make: Callable[[], T]) -> tuple[T, float]:
    """What it makes, and its processor time in ms."""
    began = time.process_time()
    made = make()
    return made, 1e3 * (time.process_time() - began)


def found(case: Written, quick: bool = False) -> SceneFound:
    """Everything once before it is timed, but for many digits; the mode is that of a problem that has not been asked before."""
    guess = case.published.double * (1 + 1e-4)
    st.refine(case.problem(), guess)
    problem, reduced = timed(case.problem)
    mode, one = timed(lambda: st.refine(problem, guess))
    many, whole, refused = None, 0.0, ""
    if not quick:
        try:
            many, whole = timed(lambda: st.refine(problem, mode.sigma, digits=MANY))
        except InputError as error:
            refused = str(error)
    return SceneFound(problem, reduced, mode, one, many, refused, whole)


def agreed(sigma: Any, published: Known) -> float:
    """The decimals that a mode shares with the published value, relative to its size; all that are published, where it shares these."""
    with mpmath.workdps(MANY):
        value = mpmath.mpc(*published.value)
        off = abs(mpmath.mpmathify(sigma) - value) / abs(value)
        return min(float(published.digits), float(-mpmath.log10(off))) if off else float(published.digits)


def inside(problem: EquationProblem) -> str:
    """The continuous spectrum of the inside in words, that of the first layer."""
    text = next(text for heading, text in problem.explanation if heading.startswith("continuous spectrum inside"))
    return "none" if text.startswith("none") else text.split(",")[0]


def at_ends(problem: EquationProblem) -> str:
    """The essential spectrum of the ends at infinity in words, each once."""
    told = [text for heading, text in problem.explanation if heading.startswith("essential spectrum")]
    return "; ".join(dict.fromkeys(told)) or "none"


def cases(quick: bool) -> Iterator[Case]:
    """Order and eigenvalue of each; quick: without many digits. And mistakes, each of which is refused in words."""
    for what, old, new in MISTAKES:
        said = told(old, new)
        yield Case(what, "refused", "taken" if said is None else "refused", 0.0, said or "")
    for case in WRITTEN:
        got, said = found(case, quick), case.published
        size = max(abs(said.double.real), abs(said.double.imag))
        allowed = (10.0 ** (math.floor(math.log10(size)) + 1 - said.digits) + got.mode.error) / size
        note = f"{case.lines} lines, {got.reduced:.0f} ms to reduce, {got.one:.0f} ms a mode; {said.source}"
        yield Case(case.name, said.double, complex(got.mode.sigma), allowed, note)
        order = str(case.tables["about"]["order"])
        yield Case(f"{case.name}, order", order, f"{got.problem.first_order.order}", 0.0, f"σ_c inside: {inside(got.problem)}")
        if got.many is not None:
            yield Case(f"{case.name}, {MANY} digits", "converged", got.many.status, 0.0, f"{1e-3 * got.whole:.1f} s")


def mistakes() -> None:
    """The table for validation/README.md: mistakes of users, and what they are told."""
    print("| mistake | told |\n|---|---|")
    for what, old, new in MISTAKES:
        print(f"| {what} | {told(old, new)} |")


def table() -> None:
    """The table for validation/README.md; times are processor times."""
    print(f"| problem | lines | order | σ_c inside | essential, ends | published: digits | agreed | reduction | one mode | {MANY} digits |")
    print("|---|---|---|---|---|---|---|---|---|---|")
    chosen = [case for case in WRITTEN if not sys.argv[2:] or case.name in sys.argv[2:]]
    for case in chosen:
        got = found(case)
        digits = f"refused: {got.refused}" if got.many is None else f"{1e-3 * got.whole:.1f} s"
        if got.many is not None and not got.many.converged:
            digits = got.many.status
        shared = agreed(got.mode.sigma if got.many is None else got.many.sigma, case.published)
        said = f"{inside(got.problem)} | {at_ends(got.problem)} | {case.published.source}: {case.published.digits} | {shared:.1f}"
        times = f"{got.reduced:.0f} ms | {got.one:.0f} ms | {digits}"
        print(f"| {case.name} | {case.lines} | {got.problem.first_order.order} | {said} | {times} |", flush=True)


CLAIM = Claim(
    "A problem as its source prints it is brought to first order by the machine, with the right order, and gives the published digits.",
    "as named with each",
    cases,
)

if __name__ == "__main__":
    if "--table" in sys.argv:
        table()
    elif "--mistakes" in sys.argv:
        mistakes()
    else:
        main(CLAIM)
