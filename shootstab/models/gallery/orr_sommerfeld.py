"""The Orr–Sommerfeld equation of a parallel flow U(y), as a first-order system in (φ, φ′, φ″, φ‴).

    (D² − α²)² φ = R [(σ + iαU)(D² − α²) − iαU″ + V (D² − α²) D] φ,   σ = −iαc

for normal modes φ(y) exp(σt + iαx); V is a constant velocity across the flow, negative towards a wall below (suction). Complex α and R
are allowed.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from shootstab.core.errors import InputError, shortened
from shootstab.core.given import is_complex
from shootstab.formulation.conditions import Conditions
from shootstab.formulation.problem import EquationProblem, equations
from shootstab.problems import Infinity
from shootstab.problems.protocol import ComplexArray

VelocityProfile = Callable[[ComplexArray], tuple[ComplexArray, ComplexArray]]  # U, U″ at points
AffineMatrices = Callable[[ComplexArray], tuple[ComplexArray, ComplexArray]]  # D0, D1

VELOCITIES = ("u = d(phi)", "v = -i*a*phi")  # exact: what eigenfunctions are shown in, of the streamfunction
CLAMPED = np.eye(2, 4)  # exact: φ = φ′ = 0
REGION_MARGIN = 2.0**-20  # chosen: part by which a region that holds all growing modes is widened, far above rounding


def orr_sommerfeld(profile: VelocityProfile, reynolds: complex, alpha: complex, V: float = 0.0) -> AffineMatrices:
    """D0 (m, 4, 4) and D1 (4, 4) as a function of y (m,), from the profile U, U″ (m,); C is the identity."""
    a2, R = alpha * alpha, reynolds
    D1 = np.zeros((4, 4), dtype=np.complex128)
    D1[3, 0], D1[3, 2] = -R * a2, R

    def matrices(y: ComplexArray) -> tuple[ComplexArray, ComplexArray]:
        U, U_yy = profile(y)
        D0 = np.zeros((len(y), 4, 4), dtype=np.complex128)
        D0[:, [0, 1, 2], [1, 2, 3]] = 1.0
        D0[:, 3, 0] = -a2 * a2 - 1j * alpha * R * (U * a2 + U_yy)
        D0[:, 3, 1] = -R * V * a2
        D0[:, 3, 2] = 2 * a2 + 1j * alpha * R * U
        D0[:, 3, 3] = R * V
        return D0, D1

    return matrices


def orr_sommerfeld_equation(
    reynolds: complex, alpha: complex, U: str, V: str = "0", base: Mapping[str, Any] | None = None
) -> EquationProblem:
    """The problem on the half-line y > 0 in equations, for many digits; every parameter is the decimal that was typed.

    U and V are formulas in y, R, and the unknowns of a base flow.
    """
    viscous = "(d(phi,4) - 2*a**2*d(phi,2) + a**4*phi)/R"
    return equations(
        ["phi", "u", "v"],
        [f"{viscous} = (sigma + i*a*U)*(d(phi,2) - a**2*phi) - i*a*d(U,2)*phi + ({V})*(d(phi,3) - a**2*d(phi))", *VELOCITIES],
        Conditions(0, ["phi", "d(phi)"]),
        Infinity(),
        parameters={"R": reynolds, "a": alpha},
        where={"U": U},
        base=base,
        variable="y",
    )


def velocities(alpha: complex, size: int = 4) -> dict[str, ComplexArray]:
    """What eigenfunctions are shown in: the streamfunction φ, and the velocities u = φ′ and v = −iαφ; rows over (φ, φ′, …)."""
    row = np.eye(size, dtype=np.complex128)
    return {"phi": row[0], "u": row[1], "v": -1j * alpha * row[0]}


def require_positive(**values: complex) -> None:
    """Raise InputError unless every value is finite with a real part above 0."""
    for name, value in values.items():
        if not (is_complex(value) and value.real > 0.0):
            raise InputError(f"{name} = {shortened(value)}: allowed is a finite number above 0")
