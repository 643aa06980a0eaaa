"""The asymptotic suction boundary layer U = 1 − e^{−y}, V = −1/R: lengths in its displacement thickness.

Source: L. M. Hocking, Quart. J. Mech. Appl. Math. 28 (1975) 341: R_c = 54370, α_c = 0.1555, c_r = 0.150.
"""

from __future__ import annotations

from functools import partial

import numpy as np

from shootstab.models.gallery.orr_sommerfeld import CLAMPED, orr_sommerfeld, orr_sommerfeld_equation, require_positive, velocities
from shootstab.problems import Infinity, LinearProblem, Wall
from shootstab.problems.linear_problem import problem
from shootstab.problems.protocol import ComplexArray


def suction(reynolds: complex = 54370.0, alpha: complex = 0.1555) -> LinearProblem:
    """Normal modes exp(σt + iαx), σ = −iαc."""
    require_positive(reynolds=reynolds, alpha=alpha)

    def profile(y: ComplexArray) -> tuple[ComplexArray, ComplexArray]:
        decay = np.exp(-y)
        return 1 - decay, -decay

    pencil = orr_sommerfeld(profile, reynolds, alpha, V=-1 / complex(reynolds).real)
    written, shown = partial(orr_sommerfeld_equation, reynolds, alpha, "1 - exp(-y)", "-1/R"), velocities(alpha)
    return problem(4, pencil, Wall(0.0, CLAMPED), Infinity(), vectorized=True, written=written, unknowns=shown, variable="y")
