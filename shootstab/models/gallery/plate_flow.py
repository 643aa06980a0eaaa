"""The compressible boundary layer on a flat plate, similar: Sutherland's viscosity, constant Pr and γ, adiabatic or at a given wall
temperature.

With y in √(ν_∞ x/U_∞), velocities in U_∞, temperature and viscosity in their values far away, S = μU′ and Q = μT′/Pr,

    f′ = U/T,  U′ = S/μ,  (ln S)′ = −½ f/μ,  T′ = Pr Q/μ,  Q′ = −½ f Pr Q/μ − (γ−1) M² S²/μ

(the equations of Mack, AGARD R-709 (1984), 10, without the transformation y ↦ η). Everything the stability equations need of U and T, up
to second derivatives, follows from these five without differentiation. They are solved by Chebyshev polynomials on short intervals, to
rounding.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cache, cached_property
from typing import Any

import numpy as np
from numpy.polynomial import chebyshev
from numpy.typing import NDArray

from shootstab.core.errors import NoFlowError
from shootstab.core.given import require_above_0, require_real
from shootstab.core.scaled import TINY
from shootstab.models.catalogue.plate import RANKINES
from shootstab.problems.base_flow_error import off_by
from shootstab.problems.protocol import ComplexArray

NODES = 24  # chosen: Chebyshev points of an interval
INTERVAL = 0.5  # chosen: length of an interval, in √(ν_∞ x/U_∞) and wall temperature
NOTHING = 1e-21  # chosen: the shear stress far away, against that of the wall
LONGEST_INTERVAL = 1.1  # chosen: the same at most, where the wall is hot
MOST_INTERVALS = 400  # chosen: after so many the shear stress has not died away, and there is no boundary layer
NEWTON, PICARD = 30, 40  # chosen: iterations at most of Newton for the wall's values, and of Picard on an interval
STEEP, MACH_STEP = 5.0, 1.1  # chosen: Mach number beyond which the flow at a smaller one, by this factor, is the first guess
PLATE_SETTLED = 2e-15  # chosen: the part of the recovery temperature that a step may leave, ten units of rounding
AIR_GAMMA, AIR_PRANDTL = 1.4, 0.7  # published: ratio of specific heats and Prandtl number of air, in both cases of Malik's
AIR_SUTHERLAND = 198.6 / RANKINES  # published: Sutherland's constant of air, 198.6 degrees Rankine, in kelvin
LARGEST_GAMMA = 5.0  # chosen: ratios of specific heats stay below this
FIRST_SHEAR = 0.33  # derived: the shear stress of Blasius' flow at the wall, 0.33206
SHOOTING_STEP, LEAST_FREE = 1e-6, 1e-2  # chosen: step of the differences of Newton, relative to what is free, which counts as no less
LONGEST_MOVE, FREE_SCALE = 0.3, 0.1  # chosen: part of what is free, and of a scale added to it, that one step of Newton changes
ROUGHLY_MET = 1e-3  # chosen: where U and T miss 1 by more, the flow is marched anew, as far as its shear stress lasts
PICARD_ROUNDING, LEAST_VALUE = 1e-16, 1e-3  # chosen: relative change that ends Picard's iteration, of a state that counts as no less


@dataclass(frozen=True)
class Gas:
    """mach, the far temperature in kelvin, Sutherland's constant in kelvin, prandtl, gamma; wall is T_w/T_∞, None if adiabatic."""

    mach: float
    far_temperature: float
    sutherland: float = AIR_SUTHERLAND
    prandtl: float = AIR_PRANDTL
    gamma: float = AIR_GAMMA
    wall: float | None = None

    def __post_init__(self) -> None:
        for name in ("mach", "far_temperature", "prandtl"):
            require_above_0(name, getattr(self, name))
        require_real("sutherland", self.sutherland, lambda s: s >= 0.0, "a finite number from 0 on")
        require_real("gamma", self.gamma, lambda g: 1.0 < g < LARGEST_GAMMA, f"a number above 1 and below {LARGEST_GAMMA:g}")
        if self.wall is not None:
            require_real("wall", self.wall, lambda w: w > 0.0, "a finite number above 0, or none for an adiabatic wall")

    def viscosity(self, T: NDArray[Any]) -> tuple[NDArray[Any], NDArray[Any], NDArray[Any]]:
        """μ = T^{3/2} (1 + s)/(T + s), s = S/T_∞, with dμ/dT and d²μ/dT², each (m,) as T is."""
        s = self.sutherland / self.far_temperature
        T = np.where(T.real > 0.0, T, np.nan)
        mu = T**1.5 * (1 + s) / (T + s)
        first = 1.5 / T - 1 / (T + s)  # d ln μ/dT
        return mu, mu * first, mu * (first**2 - 1.5 / T**2 + 1 / (T + s) ** 2)

    def slopes(self, state: NDArray[Any]) -> NDArray[Any]:
        """d/dy of (f, U, ln S, T, Q), (5, m) as the state is."""
        f, U, log_S, T, Q = state
        mu, S = self.viscosity(T)[0], np.exp(log_S)
        heating = (self.gamma - 1) * self.mach**2
        half, Pr = 0.5 * f / mu, self.prandtl
        return np.array([U / T, S / mu, -half, Pr * Q / mu, -half * Pr * Q - heating * S * S / mu])


@dataclass(frozen=True, eq=False)
class PlateFlow:
    """The state (f, U, ln S, T, Q) by Chebyshev coefficients (intervals, terms, 5) on intervals of one length; beyond them U = T = 1."""

    gas: Gas
    length: float
    coefficients: NDArray[np.float64]

    @property
    def end(self) -> float:
        """Where the free stream begins."""
        return self.length * len(self.coefficients)

    def at(self, y: ComplexArray) -> ComplexArray:
        """f, U, S, T, Q (5, m) at points y (m,); f, which nothing needs there, is 0 in the free stream."""
        beyond = y.real >= self.end  # asked of y itself: the end over the length of an interval may round to less than their number
        inside = np.clip(np.floor(np.minimum(y.real, self.end) / self.length).astype(np.int64), 0, len(self.coefficients) - 1)
        with np.errstate(invalid="ignore"):
            x = np.where(beyond | ~np.isfinite(y), 0.0, 2 * (y / self.length - inside) - 1)
        below = above = np.zeros((len(y), 5), dtype=x.dtype)
        for k in range(self.coefficients.shape[1] - 1, 0, -1):  # Clenshaw
            below, above = self.coefficients[inside, k] + 2 * x[:, None] * below - above, below
        state = (self.coefficients[inside, 0] + x[:, None] * below - above).T
        state[2] = np.exp(state[2])
        free = np.array([0.0, 1.0, 0.0, 1.0, 0.0])[:, None]
        return np.asarray(np.where(beyond, free, state))

    def shortened(self, accuracy: float) -> PlateFlow:
        """The flow with as few coefficients as leave out no more than this, relative to the largest, and each off by as much as that."""
        sizes = np.abs(self.coefficients).max(axis=(0, 2))
        kept = int(np.flatnonzero(sizes > accuracy * sizes.max())[-1]) + 1
        return PlateFlow(self.gas, self.length, off_by(self.coefficients[:, :kept], accuracy))

    @cached_property
    def wall(self) -> tuple[float, float]:
        """T and the shear stress S = μU′ at the wall."""
        state = self.at(np.zeros(1, dtype=np.complex128))[:, 0].real
        return float(state[3]), float(state[2])


@cache
def plate_flow(gas: Gas) -> PlateFlow:
    """The flow over a plate, by Newton on what is free at the wall: S, and T (adiabatic) or Q.

    Raises NoFlowError where that does not settle.
    """
    recovery = 1 + 0.5 * np.sqrt(gas.prandtl) * (gas.gamma - 1) * gas.mach**2
    shear = FIRST_SHEAR
    if gas.mach > STEEP:
        hotter, shear = plate_flow(replace(gas, mach=gas.mach / MACH_STEP)).wall
        recovery = recovery if gas.wall is not None else 1 + (hotter - 1) * MACH_STEP**2
    free = np.array([shear, recovery if gas.wall is None else shear * (recovery - gas.wall) * gas.prandtl ** (-2 / 3)])
    length = min(INTERVAL * max(recovery, gas.wall or 0.0) ** 0.5, LONGEST_INTERVAL)

    def begin(x: NDArray[np.float64]) -> NDArray[np.float64]:
        log_S = float(np.log(x[0]))
        return np.array([0.0, 0.0, log_S, x[1], 0.0] if gas.wall is None else [0.0, 0.0, log_S, gas.wall, x[1]])

    intervals = None
    for _ in range(NEWTON):
        reached, found = _march(gas, begin(free), length, intervals)
        intervals = len(found)
        missed = reached[[1, 3]] - 1
        jacobian = np.empty((2, 2))
        for j in range(2):
            step = SHOOTING_STEP * max(abs(free[j]), LEAST_FREE) * np.eye(2)[j]
            jacobian[:, j] = (_march(gas, begin(free + step), length, intervals)[0] - reached)[[1, 3]] / step[j]
        move = np.linalg.solve(jacobian, -missed)
        free = free + move * min(1.0, LONGEST_MOVE / max(np.abs(move / (np.abs(free) + FREE_SCALE)).max(), TINY))
        if min(np.abs(missed).max(), np.abs(move).max()) < PLATE_SETTLED * recovery:
            return PlateFlow(gas, length, found)
        if np.abs(missed).max() > ROUGHLY_MET:
            intervals = None
    raise NoFlowError(f"no boundary layer found for {gas}: U and T miss 1 by {np.abs(missed).max():.1e}")


def _march(gas: Gas, state: NDArray[Any], length: float, intervals: int | None) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """The state far away, and Chebyshev coefficients (intervals, NODES, 5); so many intervals, or as many as the shear stress lasts."""
    x = np.cos(np.pi * (np.arange(NODES) + 0.5) / NODES)
    to_coefficients = np.linalg.inv(chebyshev.chebvander(x, NODES - 1))
    least = state[2] + np.log(NOTHING)
    out: list[NDArray[np.float64]] = []
    while len(out) < MOST_INTERVALS and (intervals is None or len(out) < intervals):
        values = np.repeat(state[:, None], NODES, axis=1)
        for _ in range(PICARD):  # Picard's iteration, which a short interval makes fast
            slopes = to_coefficients @ gas.slopes(values).T
            series = chebyshev.chebint(slopes, lbnd=-1, scl=0.5 * length)[:NODES]
            series[0] += state
            new = (chebyshev.chebvander(x, NODES - 1) @ series).T
            settled = np.abs(new - values).max(axis=1) <= PICARD_ROUNDING * np.maximum(np.abs(values).max(axis=1), LEAST_VALUE)
            values = new
            if settled.all():
                break
        out.append(series)
        state = series.sum(axis=0)
        if not np.isfinite(state).all() or state[3] <= 0.0:
            raise NoFlowError(f"no boundary layer found for {gas}: the temperature leaves the range of physics")
        if intervals is None and state[2] < least:
            break
    return state, np.array(out)
