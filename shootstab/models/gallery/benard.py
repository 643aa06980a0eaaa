"""Rayleigh–Bénard convection: a layer 0 < z < 1 heated from below, state (W, W′, W″, W‴, θ, θ′), time in h²/κ.

    (σ/Pr)(D² − a²) W = (D² − a²)² W − Ra a² θ,   σ θ = (D² − a²) θ + W

with θ = W = 0 at both walls and W′ = 0 (rigid) or W″ = 0 (free). Two free walls: W = sin nπz, and with k² = n²π² + a²

    (σ/Pr + k²)(σ + k²) k² = Ra a².

Source: S. Chandrasekhar, Hydrodynamic and Hydromagnetic Stability (1961), II; rigid: Ra_c = 1707.76177710, a_c = 3.11632355.
"""

from __future__ import annotations

import math
from functools import partial
from typing import Any

import numpy as np

from shootstab.core.errors import InputError
from shootstab.core.regions import Rectangle
from shootstab.formulation.conditions import Conditions
from shootstab.formulation.problem import EquationProblem, equations
from shootstab.models.gallery.orr_sommerfeld import REGION_MARGIN, require_positive
from shootstab.problems import LinearProblem, Wall
from shootstab.problems.linear_problem import problem

ROWS = {"rigid": [0, 1, 4], "free": [0, 2, 4]}
CONDITIONS = {"rigid": ["W", "d(W)", "theta"], "free": ["W", "d(W,2)", "theta"]}


def benard(
    rayleigh: complex = 1707.7617771, wavenumber: complex = 3.11632355, prandtl: float = 1.0, lower: str = "rigid", upper: str = "rigid"
) -> LinearProblem:
    """Normal modes exp(σt + i a·x)."""
    require_positive(rayleigh=rayleigh, wavenumber=wavenumber, prandtl=prandtl)
    for name, wall in (("lower", lower), ("upper", upper)):
        if wall not in ROWS:
            raise InputError(f"{name} = {wall!r}: allowed is rigid or free")
    a2 = wavenumber * wavenumber
    D0 = np.eye(6, k=1, dtype=np.complex128)
    D0[3] = [-a2 * a2, 0, 2 * a2, 0, rayleigh * a2, 0]
    D0[5] = [-1, 0, 0, 0, a2, 0]
    D1 = np.zeros((6, 6), dtype=np.complex128)
    D1[3, 0], D1[3, 2], D1[5, 4] = -a2 / prandtl, 1 / prandtl, 1
    rows = np.eye(6)
    walls = Wall(0.0, rows[ROWS[lower]]), Wall(1.0, rows[ROWS[upper]])
    written = partial(in_equations, rayleigh, wavenumber, prandtl, lower, upper)
    growing = partial(_growing, rayleigh, wavenumber, prandtl) if complex(rayleigh).imag == complex(wavenumber).imag == 0 else None
    told: Any = {"written": written, "growing_region": growing, "unknowns": {"W": rows[0], "theta": rows[4]}}
    return problem(6, lambda z: (D0, D1), *walls, vectorized=True, **told)


def _growing(rayleigh: Any, wavenumber: Any, prandtl: float, floor: float, /, **largest: float) -> tuple[Rectangle, str]:
    """A rectangle that holds every σ with Re σ ≥ floor, by lemma P2 of the guide's page on proofs: σ is real and at most

        √(Ra a² Pr/(π² + a²)).

    largest: the largest value of parameters that vary, in place of those of the problem: the bound rises with each of them.
    Source: A. Pellew & R. V. Southwell, Proc. R. Soc. Lond. A 176 (1940) 312. Raises InputError where the floor lies above that.
    """
    values = {"rayleigh": rayleigh, "wavenumber": wavenumber, "prandtl": prandtl, **largest}
    rayleigh, prandtl, a2, height = values["rayleigh"], values["prandtl"], abs(values["wavenumber"]) ** 2, math.pi**2
    top = math.sqrt(abs(rayleigh) * a2 * prandtl / (height + a2)) * (1 + REGION_MARGIN)
    if not floor < top:
        raise InputError(f"floor = {floor!r}: allowed is a number below {top:.6g}, above which no mode grows")
    return Rectangle(complex(floor, -height), complex(top, height)), "P2"


def in_equations(rayleigh: complex, wavenumber: complex, prandtl: float, lower: str, upper: str) -> EquationProblem:
    """The problem in equations, for many digits and proofs; every parameter is the decimal that was typed."""
    return equations(
        ["W", "theta"],
        [
            "sigma*(d(W,2) - a**2*W)/prandtl - (d(W,4) - 2*a**2*d(W,2) + a**4*W) + rayleigh*a**2*theta",
            "sigma*theta - (d(theta,2) - a**2*theta) - W",
        ],
        Conditions(0, CONDITIONS[lower]),
        Conditions(1, CONDITIONS[upper]),
        parameters={"rayleigh": rayleigh, "wavenumber": wavenumber, "prandtl": prandtl},
        where={"a": "wavenumber"},
    )


def free_growth_rate(rayleigh: float, wavenumber: float, prandtl: float = 1.0, n: int = 1) -> float:
    """The larger σ of two free walls, exactly."""
    k2 = (n * np.pi) ** 2 + wavenumber**2
    half = 0.5 * k2 * (1 + prandtl)
    return float(-half + np.sqrt(half**2 - prandtl * (k2 * k2 - rayleigh * wavenumber**2 / k2)))
