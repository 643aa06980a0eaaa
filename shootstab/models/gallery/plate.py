"""The compressible flat plate: temporal modes, σ = −iω for given α, and spatial ones, α for given ω (see plate_system.py for the
equations).

Source: M. R. Malik, J. Comput. Phys. 86 (1990) 376, cases 3 and 6; length √(ν_∞x/U_∞), R = √(U_∞x/ν_∞).
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import partial
from typing import Any

import numpy as np

from shootstab.core.errors import InputError
from shootstab.core.given import require_real
from shootstab.models.catalogue.plate import MALIK_CASES, RANKINES
from shootstab.models.gallery.orr_sommerfeld import require_positive
from shootstab.models.gallery.plate_equations import plate_equations
from shootstab.models.gallery.plate_flow import AIR_GAMMA, Gas, PlateFlow, plate_flow
from shootstab.models.gallery.plate_system import PLATE_SIZE, PolynomialEntries, background, system
from shootstab.problems import Infinity, LinearProblem, Wall
from shootstab.problems.linear_problem import problem
from shootstab.problems.protocol import ComplexArray

STOKES = -2 / 3  # exact: second coefficient of viscosity, in μ, by Stokes' hypothesis
MACK = 2 / 3 * (1.2 - 1)  # derived: the same for Mack's ratio 1.2 of bulk viscosity
MOST_VISCOSITY = 100.0  # chosen: the same stays below this
RANKINE = 1 / RANKINES  # derived: kelvin in a degree Rankine
STILL_WALL = np.eye(PLATE_SIZE)[[0, 2, 4, 6]]  # exact: u = v = θ = w = 0
SHOWN_COMPONENTS = {"u": 0, "v": 2, "w": 6, "p": 3, "theta": 4}  # unknowns that are shown, and their places in the state
PLATE_ROUNDING = 1e-16  # chosen, a unit of rounding: relative error of the profile
BETWEEN_SPECTRA = 1.1  # chosen: the α of c = 0.91, in ω: between the acoustic spectra, c < 1 − 1/M and c > 1 + 1/M, and beside c = 1

PlateMatrices = Callable[[ComplexArray], tuple[Any, ...]]


def stagnation(mach: float, temperature: float, gamma: float = AIR_GAMMA) -> float:
    """The far temperature for a stagnation temperature in the same unit."""
    return temperature / (1 + 0.5 * (gamma - 1) * mach**2)


def plate_temporal(
    gas: Gas, reynolds: float, alpha: float, beta: float = 0.0, second: float = STOKES, accuracy: float = 0.0
) -> LinearProblem:
    """The eigenvalue is σ = −iω. second is m, the second coefficient of viscosity in μ."""
    _require(reynolds, second, alpha=alpha)

    def pencil(flow: PlateFlow) -> PlateMatrices:
        def matrices(y: ComplexArray) -> tuple[Any, ...]:
            C, D = system(background(flow, y), gas, reynolds, beta, second)
            at = {(i, j): alpha**i for i in range(3) for j in range(2)}
            return tuple(_dense(part, at, ((0, j), (1, j), (2, j)), len(y)) for part in (C, D) for j in range(2))

        return matrices

    def coarser(factor: float) -> LinearProblem:
        return plate_temporal(gas, reynolds, alpha, beta, second, factor * PLATE_ROUNDING)

    wall, matrices = Wall(0.0, STILL_WALL), pencil(_flow(gas, accuracy))
    written = partial(plate_equations, gas, {"R": reynolds, "m": second, "alpha": alpha, "beta": beta})
    own: Any = {} if accuracy else {"coarser": coarser, "written": written}
    return problem(PLATE_SIZE, matrices, wall, Infinity(), vectorized=True, unknowns=_shown(), variable="y", **own)


def plate_spatial(
    gas: Gas, reynolds: float, omega: float, beta: float = 0.0, second: float = STOKES, accuracy: float = 0.0
) -> LinearProblem:
    """The eigenvalue is α, to the second power: in α², aΔ and aΛ."""
    _require(reynolds, second, omega=omega)

    def pencil(flow: PlateFlow) -> PlateMatrices:
        def matrices(y: ComplexArray) -> tuple[Any, ...]:
            C, D = system(background(flow, y), gas, reynolds, beta, second)
            at = {(i, j): (-1j * omega) ** j for i in range(3) for j in range(2)}
            return tuple(_dense(part, at, ((i, 0), (i, 1)), len(y)) for part in (C, D) for i in range(3))

        return matrices

    def coarser(factor: float) -> LinearProblem:
        return plate_spatial(gas, reynolds, omega, beta, second, factor * PLATE_ROUNDING)

    end, matrices, near = Wall(0.0, STILL_WALL), pencil(_flow(gas, accuracy)), BETWEEN_SPECTRA * omega
    written = partial(plate_equations, gas, {"R": reynolds, "m": second, "omega": omega, "beta": beta}, near)
    own: Any = {} if accuracy else {"coarser": coarser, "written": written}
    return problem(PLATE_SIZE, matrices, end, Infinity(), reference=near, vectorized=True, unknowns=_shown(), variable="y", **own)


def plate(
    mach: float,
    far_temperature: float,
    reynolds: float,
    alpha: float | None = None,
    omega: float | None = None,
    beta: float = 0.0,
    second: float = STOKES,
    **gas: float,
) -> LinearProblem:
    """Temporal modes for a given α, or spatial ones for a given ω; far_temperature in kelvin, gas: sutherland, prandtl, gamma, wall."""
    if (alpha is None) == (omega is None):
        raise InputError("alpha (temporal modes) and omega (spatial modes): allowed is exactly one of them")
    made = Gas(mach, far_temperature, **gas)
    if alpha is not None:
        return plate_temporal(made, reynolds, alpha, beta, second)
    assert omega is not None
    return plate_spatial(made, reynolds, omega, beta, second)


def malik_3(second: float = MACK) -> LinearProblem:
    """M = 2.5, R = 3000, α = 0.06, β = 0.1, T0 = 600 °R, adiabatic; temporal."""
    return _malik(3, second)


def malik_6(second: float = MACK) -> LinearProblem:
    """M = 4.5, R = 1500, ω = 0.23, β = 0, T0 = 1100 °R, adiabatic; spatial."""
    return _malik(6, second)


def _malik(case: int, second: float) -> LinearProblem:
    mach, stagnant, reynolds, wave = MALIK_CASES[case]
    return plate(mach, stagnation(mach, stagnant) * RANKINE, reynolds, second=second, **wave)


def _shown() -> dict[str, ComplexArray]:
    """The rows (8,) of SHOWN_COMPONENTS over the state."""
    return {name: np.eye(PLATE_SIZE, dtype=np.complex128)[i] for name, i in SHOWN_COMPONENTS.items()}


def _flow(gas: Gas, accuracy: float) -> PlateFlow:
    flow = plate_flow(gas)
    return flow.shortened(accuracy) if accuracy else flow


def _dense(
    entries: PolynomialEntries, at: Mapping[tuple[int, int], complex], powers: tuple[tuple[int, int], ...], points: int
) -> ComplexArray:
    """Σ over these powers of α and σ of the coefficients, (points, 8, 8), at the values given for them."""
    out = np.zeros((points, PLATE_SIZE, PLATE_SIZE), dtype=np.complex128)
    for (i, j), polynomial in entries.items():
        for power in powers:
            if power in polynomial:
                out[:, i, j] += at[power] * polynomial[power]
    return out


def _require(reynolds: float, second: float, **others: float) -> None:
    require_positive(reynolds=reynolds, **others)
    allowed = f"-2/3 (Stokes) or more, and below {MOST_VISCOSITY:g}, in units of the viscosity"
    require_real("second", second, lambda s: STOKES <= s < MOST_VISCOSITY, allowed)
