"""What each misprint of the paper's appendix does to the growth rates that it publishes.

The tables of A.2 and A.3 stand in tests/paper_tables.py, each misprint corrected or left in by its name; tests/models/chute prove that
corrected they are the linearization of (2.1)-(2.7), and as printed are wrong there and nowhere else. Here the first-order system that
they give is a problem of one's own, with its decaying space found from its limit: what has no mode is no misprint of the code that
computed the paper's figures, and what has another growth rate neither.
"""

from __future__ import annotations

import math
import sys
from collections.abc import Callable, Iterator
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import sympy as sp
from claims import Case, Claim, main
from scenes import GUESS, problem

import shootstab as st
from shootstab.core.errors import ShootstabError
from shootstab.models.chute.background import Background, background
from shootstab.models.chute.perturbations import Perturbations

sys.path.insert(0, str(Path(__file__).parents[1] / "tests"))
from linearization import KX, KY, SIGMA, TAN, jet
from paper_tables import ERRATA, NONE, paper_first_order, to_psi

PUBLISHED = {"high": 0.00397, "mid": 0.00102, "low": 0.00727 - 0.0119j}
UNIT = {"high": 1e-5, "mid": 1e-5, "low": 1e-4}  # exact: of the last digit that the paper prints
SINGULAR = frozenset({"C58", "C62", "C73"})  # exact: without one of these a row of C is empty or a derivative missing
ORDERS = dict.fromkeys(("nu", "T", "u"), 2)  # exact: of the z-derivatives that the tables hold, 1 but for these
TOP = 1e-15  # chosen: ν0 where the coefficients have their limits to rounding
ALIKE = 1e-9  # chosen: of the growth rate, within which two formulations agree


@cache
def symbols() -> tuple[tuple[sp.Symbol, str, int], ...]:
    """The symbol of each jet, its field of Background, and its order."""
    names = [name for name in Background.__dataclass_fields__ if name not in ("decay", "nu_z", "T_z", "u_z")]
    return tuple((jet(name, order), name, order) for name in names for order in range(ORDERS.get(name, 1) + 1))


@cache
def matrices(printed: frozenset[str]) -> Callable[..., Any]:
    """(C0, C1, D0, D1) of ψ with these misprints left in, as a function of k_x, k_y, tanθ and the jets."""
    parts = []
    for A in to_psi(*paper_first_order(printed)):
        A = A.applyfunc(sp.expand)
        slope = A.diff(SIGMA)
        parts += [A.subs(SIGMA, 0), slope]
    return sp.lambdify((KX, KY, TAN, *(s for s, _, _ in symbols())), parts, "numpy", cse=True)


def value(bg: Background, name: str, order: int) -> complex:
    """A field or its derivative at one point."""
    if order == 2:
        return getattr(bg, f"{name}_z")[1]
    return getattr(bg, name)[order]


def misprinted(p: Perturbations, printed: frozenset[str], guess: complex) -> Any:
    """The problem with these misprints left in, of the right wall and with the decaying space of its own limit."""

    def pencil(z: float) -> tuple[Any, ...]:
        log_nu, T, u, Q = p.flow.states_at(z)[:4]
        bg = background(p.flow.chute, np.exp(log_nu), T, u, Q, math.pi)
        jets = [value(bg, name, order) for _, name, order in symbols()]
        return tuple(np.array(A, dtype=complex) for A in matrices(printed)(p.kx, p.ky, p.flow.chute.tan_theta, *jets))

    W0, W1 = p.wall_rows()
    return st.problem(p.size, pencil, st.Wall(0.0, W0, W1), st.Infinity(start=p.flow.height(TOP)), continuum=False, reference=guess)


def effect(name: str, printed: frozenset[str]) -> tuple[complex | None, str]:
    """The mode that the misprinted system has nearest to the true one, or why there is none."""
    try:
        mode = st.refine(misprinted(problem(name), printed, GUESS[name]), guess=GUESS[name], rtol=1e-9)
    except ShootstabError as error:
        return None, str(error)
    return (mode.sigma, "") if mode.status == "converged" else (None, mode.status)


def cases(quick: bool) -> Iterator[Case]:
    """The corrected tables first, which must give the product's own modes by another far field; then each misprint."""
    scenes = ("high",) if quick else tuple(PUBLISHED)
    for name in scenes:
        p = problem(name)
        mode = st.refine(p, guess=GUESS[name], rtol=1e-11)
        sigma, why = effect(name, NONE)
        yield Case(f"{name}: the tables, corrected", mode.sigma, sigma if sigma is not None else math.nan, ALIKE, why)
        for erratum in sorted(ERRATA):
            if quick and erratum not in ("N21", "C58", "D44"):
                continue
            sigma, why = effect(name, frozenset({erratum}))
            label = f"{name}: {erratum} as printed"
            if erratum in SINGULAR:
                yield Case(label, "no mode", "no mode" if sigma is None else "a mode", 0.0, why)
            elif sigma is None:
                yield Case(label, "", "no mode", None, why)
            else:
                off = abs(sigma - mode.sigma)
                shows = "shows" if off > UNIT[name] else "does not show"
                yield Case(label, mode.sigma, sigma, None, f"{off / abs(mode.sigma):.1e} of it: {shows} in the paper's digits")


CLAIM = Claim(
    "The appendix, corrected, gives the three growth rates; a misprint left in moves them as shown, and none of C58, C62, C73 may lack.",
    "Woodhouse & Hogg 2010, A.2 and A.3; guide/theory.md 1.3",
    cases,
)

if __name__ == "__main__":
    main(CLAIM)
