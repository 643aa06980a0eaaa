"""∂σ/∂p of a mode by the adjoint: the problem is differenced, never the mode.

With ψ scaled as in eigenfunction_double.py, σ(p + h) − σ(p) is −(⟨ψ, (δD − δC d/dz) φ⟩ + …) to first order in what h changes, so that its
central difference is exact but for the curvature of the problem in p, which a second step of half the length tells.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from shootstab.analyses.eigenfunction_double import Eigenfunction
from shootstab.core.errors import InputError
from shootstab.problems.capabilities import FAMILY, Family

STEP_OF_PARAMETER = 1e-3  # chosen: relative; its square is left of a central difference, and its fourth power of two of them
RICHARDSON = 3.0  # derived: 2² − 1, for central differences of steps h and h/2


@dataclass(frozen=True)
class Sensitivity:
    """∂σ/∂p at p = value, with an estimate of the error of the differences."""

    parameter: str
    value: float
    derivative: complex
    error: float


def sensitivities(found: Eigenfunction, parameters: Sequence[str]) -> list[Sensitivity]:
    """The derivatives of a mode by parameters of its family, each with all others held.

    Raises InputError for a problem without a family, a parameter that it has not, and one whose change couples what is apart.
    """
    if not isinstance(found, Eigenfunction):
        raise InputError(f"{type(found).__name__} is no eigenfunction: allowed is what st.eigenfunction(problem, guess) gives")
    family_of = FAMILY.required(found.problem)
    out = []
    for name in parameters:
        family: Family = family_of((name,))
        value = float(family.here[name])
        if value == 0.0:
            raise InputError(f"{name} = 0: allowed is a parameter other than 0, as its change is relative")

        def slope(h: float, family: Family = family, name: str = name, value: float = value) -> complex:
            ahead, behind = (found.shift(family.problem({name: value + d})) for d in (h, -h))
            return (ahead - behind) / (2.0 * h)

        h = STEP_OF_PARAMETER * abs(value)
        coarse, fine = slope(h), slope(0.5 * h)
        correction = (fine - coarse) / RICHARDSON
        out.append(Sensitivity(name, value, fine + correction, abs(correction)))
    return out
