"""The misprints of the paper's appendix: what each does to the growth rates that the paper publishes.

The tables of A.2 and A.3 stand in tests/paper_tables.py, each misprint corrected or left in by its name; tests/models/chute prove that
corrected they are the linearization of (2.1)-(2.7), and as printed are wrong there and nowhere else. Here the first-order system that
they give is a problem of one's own, on the paper's domain, with (2.20)-(2.22) at its end and the right wall: a misprint with which the
published modes are lost is none of the code that computed them, and one that moves them beyond their last digit neither.
"""

from __future__ import annotations

import math
import sys
from collections.abc import Callable
from functools import cache, partial
from pathlib import Path
from typing import Any

import numpy as np
import sympy as sp
from claims import Case, number
from scenes import GUESS, problem

import shootstab as st
from paper.rows import Item, Reproduction, Row, if_all_hold
from paper.truncation import NU_TRUNCATION, truncated
from shootstab.core.errors import ShootstabError
from shootstab.models.chute.background import Background, background
from shootstab.models.chute.far_field import decay_matrix

sys.path.insert(0, str(Path(__file__).parents[2] / "tests"))
from linearization import KX, KY, SIGMA, TAN, first_order, jet
from paper_tables import ERRATA, NONE, paper_first_order, to_psi

SCENES = ("high", "mid", "low")
PUBLISHED = {"high": 0.00397, "mid": 0.00102, "low": 0.00727 - 0.0119j}  # published: section 3.2
UNIT = dict.fromkeys(SCENES, 1e-5)  # exact: the last digit of Re σ that the paper prints
GROWTH_RATES = ", ".join(f"{name} {sigma.real:g}" for name, sigma in PUBLISHED.items())
ORDERS = dict.fromkeys(("nu", "T", "u"), 2)  # exact: orders of the z-derivatives that the tables hold, 1 but for these
RTOL = 1e-6  # chosen: a misprint that shows moves the third digit
ALIKE = 1e-6  # chosen: part of the growth rate within which two formulations agree
SAME = 0.2  # chosen: part of |σ| within which a mode of the misprinted system can be taken for the published one
NO_MODE = "no such mode"


@cache
def symbols() -> tuple[tuple[sp.Symbol, str, int], ...]:
    """The symbol of each jet, its field of Background, and its order."""
    names = [name for name in Background.__dataclass_fields__ if name not in ("decay", "nu_z", "T_z", "u_z")]
    return tuple((jet(name, order), name, order) for name in names for order in range(ORDERS.get(name, 1) + 1))


@cache
def entries(printed: frozenset[str]) -> tuple[tuple[tuple[int, int, int], ...], Callable[..., Any]]:
    """Where C0, C1, D0, D1 of ψ are not zero, (matrix, row, column), and what stands there: a function of k_x, k_y, tanθ and the jets."""
    parts = []
    for A in to_psi(*paper_first_order(printed)):
        A = A.applyfunc(sp.expand)
        slope = A.diff(SIGMA)
        parts += [A.subs(SIGMA, 0), slope]
    places = tuple((k, i, j) for k, A in enumerate(parts) for i in range(A.rows) for j in range(A.cols) if A[i, j] != 0)
    values = [parts[k][i, j] for k, i, j in places]
    return places, sp.lambdify((KX, KY, TAN, *(s for s, _, _ in symbols())), values, "numpy", cse=True)


def value(bg: Background, name: str, order: int) -> Any:
    """A field or its derivative."""
    if order == 2:
        return getattr(bg, f"{name}_z")[1]
    return getattr(bg, name)[order]


def misprinted(name: str, printed: frozenset[str]) -> Any:
    """A scene with these misprints left in, on the domain and with the conditions of the paper, and with the right wall."""
    p = problem(name)
    places, formula = entries(printed)

    def pencil(z: Any) -> tuple[Any, ...]:
        log_nu, T, u, Q = p.flow.states_at(np.asarray(z)).T[:4]
        bg = background(p.flow.chute, np.exp(log_nu), T, u, Q, math.pi)
        found = formula(p.kx, p.ky, p.flow.chute.tan_theta, *(value(bg, field, order) for _, field, order in symbols()))
        parts = np.zeros((4, len(z), p.size, p.size), dtype=complex)
        for (k, i, j), entry in zip(places, found, strict=True):
            parts[k, :, i, j] = entry
        return tuple(parts)

    return truncated(p, p.flow.height(NU_TRUNCATION), decay_matrix(p.kx, p.ky), pencil)


@cache
def true_mode(name: str) -> complex:
    """The mode of the equations themselves."""
    return complex(st.refine(problem(name), guess=GUESS[name], rtol=1e-11).sigma)


def effect(name: str, printed: frozenset[str]) -> tuple[complex | None, str]:
    """The mode of the misprinted system next to the true one; None where there is none, and why.

    Newton's iteration, which settles in a few steps where there is a mode, is not asked where a count finds none.
    """
    sigma = true_mode(name)
    try:
        p = misprinted(name, printed)
        if not st.count(p, st.Disc(sigma, SAME * abs(sigma)), method=st.Frame(rtol=1e-5)):
            return None, f"no zero of D within {SAME:.0%} of the true mode, by a count"
        mode = st.refine(p, guess=sigma, rtol=RTOL)
    except ShootstabError as error:
        return None, str(error)
    return (complex(mode.sigma), "") if mode.converged else (None, mode.status)


@cache
def derived() -> tuple[sp.Matrix, sp.Matrix]:
    """C, D (8, 8) of the linearized equations (2.1)-(2.7), reduced to first order: no table of the paper is used."""
    return first_order()


def wrong_places(printed: frozenset[str]) -> str:
    """The entries, counted from 1, at which these tables differ from the derived ones as expressions; 'none'."""
    found = []
    for letter, theirs, ours in zip("CD", paper_first_order(printed), derived(), strict=True):
        places = ((i, j) for i in range(theirs.rows) for j in range(theirs.cols))
        found += [f"{letter}{i + 1}{j + 1}" for i, j in places if sp.expand(theirs[i, j] - ours[i, j]) != 0]
    return ", ".join(found) or "none"


def corrected(quick: bool) -> Row:
    """The tables with all ten corrections are the linearization, and give the product's own modes by another far field."""
    cases = [Case("entries that differ from the derived ones", "none", wrong_places(NONE), 0.0)]
    for name in SCENES[: 1 if quick else 3]:
        sigma, why = effect(name, NONE)
        cases.append(
            Case(f"{name}: σ of the tables against the product's", true_mode(name), NO_MODE if sigma is None else sigma, ALIKE, why)
        )
    return Row(
        "A.2 and A.3 with ten corrections",
        "A.2, A.3",
        "the linearization of (2.1)-(2.7)",
        if_all_hold(cases, "the same as derived symbolically, entry by entry; σ by the tables is σ by the product"),
        tuple(cases),
    )


def as_printed(erratum: str, quick: bool) -> Row:
    """One misprint left in: where the system differs from the derived one, and what becomes of the growth rates."""
    cases = [Case("entries that differ from the derived ones", "none", wrong_places(frozenset({erratum})), 0.0)]
    said = []
    for name in SCENES[: 1 if quick else 3]:
        true, (sigma, why) = true_mode(name).real, effect(name, frozenset({erratum}))
        paper = PUBLISHED[name].real
        if sigma is None:
            cases.append(Case(f"{name}: growth rate", number(paper), NO_MODE, 0.0, why))
            said.append(f"{name} lost")
        else:
            shows = abs(sigma.real - true) > UNIT[name]
            cases.append(Case(f"{name}: growth rate", paper, sigma.real, UNIT[name] / paper, f"moved by {sigma.real - true:.1e}"))
            said.append(f"{name} {sigma.real:.6f}" + (" (shows)" if shows else ""))
    return Row(f"{erratum} as printed", "A.2" if erratum[0] == "N" else "A.3", GROWTH_RATES, ", ".join(said), tuple(cases))


def slope_at_the_wall(quick: bool) -> Row:
    """(A 14) gives S_z no −½ A r² ∂v/∂y, which a wall that is isotropic in its plane has: the mid flow with it."""
    flow = st.chute.steady(mass_flux=3.0, branch="mid", wall="isotropic", e=0.8, e_w=0.8, r=0.6, tan_theta=0.3)
    mode = st.refine(st.chute.problem(flow, 0.0, 0.0125), guess=true_mode("mid"), rtol=1e-9)
    paper = PUBLISHED["mid"].real
    cases = (
        Case("mid, wall as printed", paper, true_mode("mid").real, 0.5 * UNIT["mid"] / paper),
        Case("mid, isotropic wall", paper, mode.sigma.real, None, f"rounds to {mode.sigma.real:.5f}"),
    )
    return Row(
        "S_z of (A 14) lacks −½Ar² ∂v/∂y: what the isotropic wall would give",
        "(A 14)",
        f"mid {paper:g}, by the wall as printed",
        f"mid {mode.sigma.real:.7f} by the isotropic wall, {true_mode('mid').real:.7f} as printed: "
        + if_all_hold(cases, f"{paper:g} is that of the wall as printed"),
        cases,
    )


QUICK = frozenset({"N21", "C58"})  # chosen: one that moves the mode and one that loses it
REPRODUCTION = Reproduction(
    "errata",
    "Misprints of the appendix, each left in alone",
    (
        Item("corrected", corrected),
        *(Item(erratum, partial(as_printed, erratum), erratum in QUICK) for erratum in sorted(ERRATA)),
        Item("isotropic wall", slope_at_the_wall),
    ),
)
