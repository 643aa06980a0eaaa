"""The Blasius boundary layer, parallel: Orr–Sommerfeld on 2f‴ + f f″ = 0, U = f′, lengths in √(νx/U_∞), R = √(U_∞x/ν).

Source of the flow: H. Blasius, Z. Math. Phys. 56 (1908) 1; f″(0) = 0.332057336215196 (Boyd, Exp. Math. 8 (1999) 381). Source of the mode:
R. Jordinson, J. Fluid Mech. 43 (1970) 801; R = 580, α = 0.179 in these units, c = 0.36412287 + 0.00795972i. Beware of tables that call
this R one of the displacement thickness, which is 1.7207876575 times as large.
"""

from __future__ import annotations

from functools import cache, partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from shootstab.models.gallery.orr_sommerfeld import CLAMPED, orr_sommerfeld, orr_sommerfeld_equation, require_positive, velocities
from shootstab.models.gallery.profiles import Piecewise
from shootstab.problems import Infinity, LinearProblem, Wall
from shootstab.problems.linear_problem import problem
from shootstab.problems.protocol import ComplexArray

# chosen: the nearest singularity of f is 5.69 away from the wall, and farther from every other point
TAYLOR_LENGTH, TAYLOR_TERMS = 0.25, 26
PROFILE_END = 20.0  # derived: the η at which 1 − U, about exp(−(η−1.7)²/4), is far below the last place
BLASIUS_FLOW = {  # published: the flow in equations, for many digits
    "unknowns": ["f"],
    "equations": ["2*d(f,3) + f*d(f,2) = 0"],
    "left": {"at": 0, "conditions": ["f", "d(f)"]},
    "right": {"infinity": True, "conditions": ["d(f) = 1"]},
}
BLASIUS_ROUNDING = 1e-16  # chosen, a unit of rounding: relative error of the profile


def blasius(reynolds: complex = 580.0, alpha: complex = 0.179, accuracy: float = 0.0) -> LinearProblem:
    """Normal modes exp(σt + iαx), σ = −iαc; the flow is known to rounding, or to the accuracy given."""
    require_positive(reynolds=reynolds, alpha=alpha)
    U = flow() if accuracy == 0.0 else flow().shortened(accuracy)
    U_yy = U.derivative().derivative()

    def profile(y: ComplexArray) -> tuple[ComplexArray, ComplexArray]:
        return U(y), U_yy(y)

    def coarser(factor: float) -> LinearProblem:
        return blasius(reynolds, alpha, BLASIUS_ROUNDING * factor)

    pencil = orr_sommerfeld(profile, reynolds, alpha)
    written = partial(orr_sommerfeld_equation, reynolds, alpha, "d(f)", base=BLASIUS_FLOW)
    own: Any = {"coarser": coarser, "written": written} if accuracy == 0.0 else {}
    return problem(4, pencil, Wall(0.0, CLAMPED), Infinity(), vectorized=True, unknowns=velocities(alpha), variable="y", **own)


@cache
def flow() -> Piecewise:
    """U = f′(η).

    If g solves the equation with g″(0) = 1, so does f(η) = A g(Aη) for every A, and f′(∞) = 1 for A = g′(∞)^(−1/2): no shooting (Töpfer
    1912).
    """
    g = _march(1.0, TAYLOR_LENGTH, int(2 * PROFILE_END / TAYLOR_LENGTH))
    A = float(g[-1, 1]) ** -0.5
    f = _march(A**3, TAYLOR_LENGTH, int(PROFILE_END / TAYLOR_LENGTH))
    m = np.arange(1, TAYLOR_TERMS)
    return Piecewise(TAYLOR_LENGTH, f[:, 1:] * m, 1.0)


def _march(curvature: float, h: float, pieces: int) -> NDArray[np.float64]:
    """Taylor coefficients (pieces, TAYLOR_TERMS) of f with f(0) = f′(0) = 0 and f″(0) as given."""
    m = np.arange(TAYLOR_TERMS)
    out = np.empty((pieces, TAYLOR_TERMS))
    state = np.array([0.0, 0.0, curvature / 2])
    for row in out:
        row[:3] = state
        for j in range(TAYLOR_TERMS - 3):
            # (j+1)(j+2)(j+3) f_{j+3} = −½ Σ_i f_{j−i} (i+1)(i+2) f_{i+2}
            i = np.arange(j + 1)
            row[j + 3] = -0.5 * np.sum(row[j - i] * (i + 1) * (i + 2) * row[i + 2]) / ((j + 1) * (j + 2) * (j + 3))
        powers = row * h**m
        state = np.array([powers.sum(), (m * powers).sum() / h, (m * (m - 1) * powers).sum() / (2 * h * h)])
    return out
