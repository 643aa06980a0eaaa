"""The inviscid shear layer U = tanh y: Rayleigh's equation (U − c)(φ″ − α²φ) = U″φ on the whole line, state (φ, φ′), σ = −iαc.

C = diag(1, σ + iαU) is singular at the critical layers σ = −iαU(y), the segment of the imaginary axis between −iα and iα.
Source: A. Michalke, J. Fluid Mech. 19 (1964) 543: the largest growth rate is 0.1897, at α = 0.4446; α = 1 is neutral with c = 0.
"""

from __future__ import annotations

from functools import partial
from typing import Any

import numpy as np

from shootstab.formulation.problem import EquationProblem, equations
from shootstab.models.gallery.orr_sommerfeld import VELOCITIES, require_positive, velocities
from shootstab.problems import Infinity, LinearProblem
from shootstab.problems.linear_problem import problem
from shootstab.problems.protocol import ComplexArray


def shear_layer(alpha: complex = 0.4446) -> LinearProblem:
    """Normal modes exp(σt + iαx)."""
    require_positive(alpha=alpha)
    a2 = alpha * alpha
    C1, D1 = np.zeros((2, 2)), np.zeros((2, 2), dtype=np.complex128)
    C1[1, 1], D1[1, 0] = 1, a2

    def pencil(y: ComplexArray) -> tuple[Any, ...]:
        U = np.tanh(y)
        C0, D0 = (np.zeros((len(y), 2, 2), dtype=np.complex128) for _ in range(2))
        C0[:, 0, 0], C0[:, 1, 1] = 1, 1j * alpha * U
        D0[:, 0, 1], D0[:, 1, 0] = 1, 1j * alpha * U * (a2 - 2 * (1 - U * U))
        return C0, C1, D0, D1

    def critical(y: ComplexArray) -> ComplexArray:
        return np.asarray(-1j * alpha * np.tanh(y))

    told: Any = {"written": partial(_rayleigh_equation, alpha), "unknowns": velocities(alpha, 2), "variable": "y"}
    return problem(2, pencil, Infinity(), Infinity(), continuum=critical, vectorized=True, **told)


def _rayleigh_equation(alpha: complex) -> EquationProblem:
    """The problem in equations, for many digits; alpha is the decimal that was typed."""
    rayleigh = "(sigma + i*a*U)*(d(phi,2) - a**2*phi) = i*a*d(U,2)*phi"
    known: Any = {"parameters": {"a": alpha}, "where": {"U": "tanh(y)"}, "variable": "y"}
    return equations(["phi", "u", "v"], [rayleigh, *VELOCITIES], Infinity(), Infinity(), **known)
