"""Section 2.1: the order of the system, where it is singular, and figure 1, the continuous spectrum of the high flow.

The order is found twice: by hand, as A.3 says in words (tests/linearization.py), and by the package's own reduction of the written
equations (2.1)-(2.7), which knows nothing of the chute.
"""

from __future__ import annotations

import sys
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import sympy as sp
from claims import Case
from scenes import problem

import shootstab as st
from paper.pictures import BLUE, panels, save
from paper.rows import Item, Reproduction, Row, if_all_hold, write_csv
from shootstab.formulation.domain import Domain
from shootstab.formulation.first_order import first_order as reduced
from shootstab.formulation.names import Names
from shootstab.formulation.system import System
from shootstab.models.chute.tabulated import as_background, tabulated

sys.path.insert(0, str(Path(__file__).parents[2] / "tests"))
from linearization import BASE_NAMES, KX, SIGMA, first_order, jet, residuals

UNKNOWNS = ("nu1", "u1", "v1", "w1", "T1")
WAVE = {"k_x": 0.3, "k_y": -0.7, "tan_theta": 0.3}  # chosen: any
SLOPES = (0.25, 0.30, 0.35)  # chosen: the slopes of figure 8, its ends and its middle
TEMPERATURES = (0.1, 0.5, 2.0, 7.0, 30.0)  # chosen: T_∞ from dense flows to dilute ones
POSITIVE = ("nu", "a", "b", "K", "K_star", "xi", "eta")  # exact: what (2.13) is made of
POINTS = 400  # chosen: heights at which the curve is drawn
TOP = 150.0  # chosen: height up to which figure 1 is drawn, where Re σ_c is 1e-9


def grown(z: Any, order: int) -> Any:
    """A stand-in for every base function: none of its derivatives vanishes."""
    return np.exp(z) if isinstance(z, np.ndarray) else sp.exp(z)


def order_eight(quick: bool) -> Row:
    """The size of φ with C invertible, and what the reduction of the written equations finds."""
    C, _ = first_order()
    names = Names(UNKNOWNS, WAVE, {}, given=tuple(f"{name}0" for name in BASE_NAMES))
    written = {f"equation {i}": names.expression(r.first.doit(), f"equation {i}") for i, r in enumerate(residuals(), 1)}
    domain = Domain(0.0, 1.0, {f"{name}0": grown for name in BASE_NAMES})
    found = reduced(System.of(UNKNOWNS, written, names.text), domain.vanishing, domain.regular)
    cases = (
        Case("by hand, φ of (A 8) with det C not zero", "8", str(C.rows) if determinant() != 0 else "less", 0.0),
        Case("by the machine, from the written equations", "8", str(found.order), 0.0),
    )
    return Row("the system (2.12) is of order eight", "2.1", "eight", f"{C.rows} by hand, {found.order} by the package's reduction", cases)


@cache
def determinant() -> sp.Expr:
    """det C of the derived system."""
    return sp.expand(first_order()[0].det(method="berkowitz"))


def determinant_is_a9(quick: bool) -> Row:
    """The determinant of the derived C against (A 9), and (2.13) as its zero."""
    eta, xi, K, K_star, a, b, nu, u = (jet(name, 0) for name in ("eta", "xi", "K", "K_star", "a", "b", "nu", "u"))
    viscous = xi + sp.Rational(4, 3) * eta
    printed = -(eta**2) * (K * viscous * (SIGMA + sp.I * KX * u) + a * nu * K + b * nu * K_star)
    sigma_c = -nu * (a * K + b * K_star) / (K * viscous) - sp.I * KX * u
    cases = (
        Case("det C − (A 9)", "0", str(sp.expand(determinant() - printed)), 0.0),
        Case("det C at σ_c of (2.13)", "0", str(sp.simplify(determinant().subs(SIGMA, sigma_c))), 0.0),
    )
    return Row(
        "det C is (A 9), and vanishes at σ_c of (2.13)", "(A 9), (2.13)", "(A 9)", if_all_hold(cases, "the same, symbolically"), cases
    )


def stable_side(quick: bool) -> Row:
    """Whether all that (2.13) is made of is positive over the whole flow, on flows from dilute to dense."""
    smallest, rightmost, count = np.inf, -np.inf, 0
    for slope in SLOPES[1:2] if quick else SLOPES:
        for temperature in TEMPERATURES[::2] if quick else TEMPERATURES:
            flow = st.chute.steady(far_temperature=temperature, e=0.8, e_w=0.8, r=0.6, tan_theta=slope)
            p = st.chute.problem(flow, 5e-4, 0.0)
            z = p.continuum.heights(POINTS)
            bg = as_background(tabulated(flow.chute, flow.states_at(z), derivatives=False).real, derivatives=False)
            smallest = min(smallest, *(float(np.min(getattr(bg, name)[0])) for name in POSITIVE))
            rightmost = max(rightmost, float(p.continuum(z.astype(complex)).real.max()))
            count += 1
    cases = (
        Case("all of ν0, a0, b0, K0, K0*, ξ0, η0 positive", "yes", "yes" if smallest > 0.0 else f"one is {smallest:.1e}", 0.0),
        Case("Re σ_c ≤ 0 at every height", "yes", "yes" if rightmost <= 0.0 else f"up to {rightmost:.1e}", 0.0),
    )
    said = f"on {count} flows, T_∞ from {TEMPERATURES[0]:g} to {TEMPERATURES[-1]:g}, {POINTS} heights each; largest Re σ_c {rightmost:.0e}"
    return Row("Re σ_c ≤ 0: the continuous spectrum makes no instability", "2.1", "each quantity in (2.13) is positive", said, cases)


def figure_1(quick: bool) -> Row:
    """σ_c(z) of the high flow at k_x = 5e-4: real and imaginary part against z, and the curve."""
    p = problem("fig2")
    z = np.linspace(0.0, TOP, POINTS)
    sigma = p.continuum(z.astype(complex))
    limit = -1j * p.kx * p.flow.far_velocity
    files: tuple[str, ...] = ()
    if not quick:
        figure, axes = panels(1, 3, (10.0, 3.2))
        for panel, part, label in zip(axes[0], (sigma.real, sigma.imag), ("Re $σ_c$", "Im $σ_c$"), strict=False):
            panel.plot(z, part, color=BLUE)
            panel.set_xlabel("z / d")
            panel.set_ylabel(label)
        axes[0, 2].plot(sigma.real, sigma.imag, color=BLUE)
        axes[0, 2].plot(sigma.real[0], sigma.imag[0], "o", color=BLUE, label="base")
        axes[0, 2].plot(limit.real, limit.imag, "x", color="black", label="z → ∞")
        axes[0, 2].set_xlabel("Re $σ_c$")
        axes[0, 2].set_ylabel("Im $σ_c$")
        axes[0, 2].legend(frameon=False, fontsize="small")
        figure.suptitle("Figure 1: continuous spectrum of the high flow, $Q_0$ = 3, $k_x$ = 5e−4, $k_y$ = 0", fontsize="medium")
        files = (save(figure, "figure1.png"), write_csv("figure1.csv", {"z": z, "re": sigma.real, "im": sigma.imag}))
    end = complex(sigma[-1])
    cases = (
        Case(f"|σ_c({TOP:g}) − σ_c(∞)| below 1e-6", "yes", "yes" if abs(end - limit) < 1e-6 else f"{abs(end - limit):.1e}", 0.0),
        Case("σ_c at the base", "", f"{complex(sigma[0]):.6g}", None),
    )
    least = f"least Re σ_c {sigma.real.min():.4g}, at z = {z[sigma.real.argmin()]:.3g}"
    return Row(
        "figure 1: Re σ_c → 0 as z → ∞",
        "2.1, figure 1",
        "the curve σ_c(z) of the high flow, which ends on the imaginary axis",
        f"from {complex(sigma[0]):.4g} at the base to {limit.imag:.4g}i; {least}",
        cases,
        figures=files,
    )


REPRODUCTION = Reproduction(
    "order_and_continuum",
    "The order of the equations and the continuous spectrum",
    (Item("order", order_eight), Item("det C", determinant_is_a9), Item("stable side", stable_side), Item("figure 1", figure_1)),
)
