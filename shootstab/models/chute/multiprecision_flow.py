"""The steady chute flow to any number of digits: its series at infinity, Taylor steps down, and the base.

From the far field, T, u and Q are convergent series in ν0; below, ν, T, u, Q and Φ = ∫_z^∞ ν (u − u_∞) dz are Taylor series in z.
All recurrences come from evaluating `slopes` on series. u is taken relative to u_∞ until the slip at the base fixes it.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from shootstab.core.errors import ConvergenceError
from shootstab.core.scaled import TINY
from shootstab.core.series import Series
from shootstab.models.chute import constitutive as law
from shootstab.models.chute.balance import slip, slopes
from shootstab.models.chute.parameters import Chute
from shootstab.models.chute.steady_flow import Flow
from shootstab.multiprecision.arithmetic import TAIL_TERMS, Arithmetic
from shootstab.multiprecision.relaxed_series import RelaxedSeries, RelaxedSystem
from shootstab.multiprecision.settings import Settings, step_limit

FLOW_NEWTONS = 60  # chosen: the most steps of Newton; each doubles the digits
PLACED = 0.9  # chosen: part of the digits that the last step of Newton to a place leaves as they are
HIGHEST_START = -7.0  # chosen: log2 of the ν0 at which the way down begins, at most
FAR_SHIFTS = 0, 0, 1, 0  # derived: x dQ/dx + Q = Q_z/decay + Q, in which Q_m cancels on the right
FLUX = 4  # exact: the place of Φ in a state (ν, T, u, Q, Φ)
UNIT_TRIALS = 8  # chosen: powers of two that are tried as the unit of a step's series
UNIT_GRAIN, UNIT_LEAP = 2, 2  # chosen: log2 of the unit over the step, at most, and by how much a unit changes that shows no limit
State = list[Any]


def far_series(arithmetic: Arithmetic, chute: Chute, far_temperature: Any, terms: int, tolerance: float = 0.0) -> list[list[Any]]:
    """Coefficients in x = ν0 of (ν, T, u − u_∞, Q, Φ); used, where they may be rounded, no farther than where 10^−tolerance is left.

    x dT/dx = T′/(ν0′/ν0) and so on. On the right of that for Q, Q_m cancels, and nothing else of order m counts: every order is computed
    with zeros for its unknowns first, and again with what came out.
    """
    zero, one = arithmetic.number(0), arithmetic.number(1)
    system = RelaxedSystem(arithmetic)
    y = nu, T, u, Q, _ = [system.unknown() for _ in range(5)]
    decay, T_z, u_z, Q_z = slopes(nu, T, Q, chute.ep, chute.tan_theta, chute.radial_law, arithmetic.pi)
    right = T_z / decay, u_z / decay, Q_z / decay + Q, -(nu * (u / decay))
    first = [zero, far_temperature, zero, zero, zero]
    compiled, unit = arithmetic.recurrence(system, y, right), math.floor(HIGHEST_START)
    for _ in range(UNIT_TRIALS):
        if compiled is None:
            break
        series = compiled.expand_singular(first, FAR_SHIFTS, unit, terms)
        limit = -math.inf if series is None else min(_far_limits(arithmetic, series, tolerance))
        if series is not None and unit - UNIT_GRAIN <= limit:
            return series
        unit = unit - UNIT_LEAP if limit == -math.inf else math.ceil(limit)
    system.clear()
    for m in range(terms):
        _set(m, (nu, one if m == 1 else zero), *((x, zero if m else x0) for x, x0 in zip(y[1:], first[1:], strict=True)))
        system.extend(m)
        if m > 0:
            found = [arithmetic.rounded(f.coefficients[m] / (m + shift)) for f, shift in zip(right, FAR_SHIFTS, strict=True)]
            _set(m, *zip(y[1:], found, strict=True))
            system.extend(m)
    return [x.coefficients for x in y]


def _set(m: int, *values: tuple[RelaxedSeries, Any]) -> None:
    for node, value in values:
        del node.coefficients[m:]
        node.coefficients.append(value)


def evaluate(arithmetic: Arithmetic, coefficients: list[Any], x: Any) -> Any:
    """Σ c_m x^m by Horner's rule."""
    total = coefficients[-1]
    for c in coefficients[-2::-1]:
        total = arithmetic.rounded(total * x + c)
    return total


@dataclass(frozen=True)
class FlowAtBase:
    """Where the flow ends: the state there, u_∞ that the slip asks for, and the mass flux Q0."""

    state: State
    far_velocity: Any
    mass_flux: Any


class Descent:
    """The flow of one T_∞ on its way down from ν0 = start, expanded where it has arrived.

    length, a double, is how far the base lies below the start.
    """

    def __init__(self, arithmetic: Arithmetic, chute: Chute, settings: Settings, state: State, length: float) -> None:
        self.arithmetic, self.chute, self.settings = arithmetic, chute, settings
        self.state, self.remaining = state, length
        self._graph = RelaxedSystem(arithmetic)
        self._y = [self._graph.unknown() for _ in range(5)]
        nu, T, u, Q, _ = self._y
        decay, *rest = slopes(nu, T, Q, chute.ep, chute.tan_theta, chute.radial_law, arithmetic.pi)
        self._slopes = [nu * decay, *rest, -(nu * u)]
        self._compiled = arithmetic.recurrence(self._graph, self._y, self._slopes)
        self._log_unit = math.ceil(math.log2(length)) if length > 0.0 else 0

    def expand(self) -> tuple[list[list[Any]], float]:
        """Taylor coefficients in z of the state here, and the step (a positive double) up to which they hold."""
        found = self._by_loops()
        if found is None:
            series = self._by_numbers()
            found = series, min(self._limits(series))
        return found[0], 2.0 ** found[1]

    def _by_loops(self) -> tuple[list[list[Any]], float] | None:
        """The coefficients are accurate as far as 2^log_unit: it has to be the next power of two beyond the step."""
        if self._compiled is not None:
            for _ in range(UNIT_TRIALS):
                series = self._compiled.expand(self.state, self._log_unit, self.settings.order)
                unit, limit = self._log_unit, -math.inf if series is None else min(self._limits(series))
                if series is not None and unit - UNIT_GRAIN <= limit <= unit:
                    return series, limit
                self._log_unit = unit + (UNIT_LEAP if limit > 0.0 else -UNIT_LEAP) if math.isinf(limit) else math.ceil(limit)
        return None

    def _by_numbers(self) -> list[list[Any]]:
        self._graph.clear()
        for node, value in zip(self._y, self.state, strict=True):
            node.coefficients.append(value)
        for m in range(self.settings.order - 1):
            self._graph.extend(m)
            nexts = [self.arithmetic.rounded(s.coefficients[m] / (m + 1)) for s in self._slopes]
            _set(m + 1, *zip(self._y, nexts, strict=True))
        return [list(y.coefficients) for y in self._y]

    def _limits(self, series: list[list[Any]]) -> list[float]:
        nu, T, u, Q = (self.arithmetic.log2(c[0]) for c in series[:4])
        scales = nu, T, max(u, T / 2), max(Q, nu + T / 2)
        return [_limit(self.arithmetic, c, s, self.settings.tolerance) for c, s in zip(series[:4], scales, strict=True)]

    def advance(self, series: list[list[Any]], step: Any) -> None:
        """Go to the end of a step (negative, downwards)."""
        self.state = [evaluate(self.arithmetic, c, step) for c in series]
        self.remaining += float(self.arithmetic.to_mpmath(step))

    def to_base(self, series: list[list[Any]]) -> Any:
        """The step that ends at the base: Newton on the energy condition, from where doubles see it."""
        arithmetic = self.arithmetic
        x = arithmetic.number(-self.remaining)
        slopes_of = [[m * c for m, c in enumerate(y)][1:] for y in series[:4]]
        goal = -PLACED * arithmetic.log2(arithmetic.number(10)) * self.settings.digits + math.log2(abs(self.remaining) + TINY)
        best = math.inf
        for _ in range(FLOW_NEWTONS):
            pairs = [Series((evaluate(arithmetic, y, x), evaluate(arithmetic, s, x))) for y, s in zip(series, slopes_of, strict=False)]
            defect = energy_defect(self.chute, pairs[0], pairs[1], pairs[3], arithmetic.pi)
            step = arithmetic.rounded(defect[0] / defect[1])
            x = arithmetic.rounded(x - step)
            size = arithmetic.log2(step)
            if size < goal or (size < goal / 2 and size >= best):
                return x
            best = size
        raise ConvergenceError("the base of the flow cannot be located: its energy condition is met by grazing")

    def at_base(self) -> FlowAtBase:
        """The base, if the flow has arrived there: u_∞ from the slip, Q0 = Φ + u_∞ p."""
        arithmetic, chute = self.arithmetic, self.chute
        nu, T, u, Q, flux = self.state
        g0, _ = law.radial(nu, chute.radial_law)
        u_z = slopes(nu, T, Q, chute.ep, chute.tan_theta, chute.radial_law, arithmetic.pi)[2]
        far_velocity = arithmetic.rounded(slip(nu, T, u_z, g0, chute.r, chute.tan_theta, arithmetic.pi) - u)
        pressure = nu * law.reduced_pressure(nu, chute.ep, chute.radial_law) * T
        return FlowAtBase(self.state, far_velocity, arithmetic.rounded(flux + far_velocity * pressure))


def energy_defect(chute: Chute, nu: Any, T: Any, Q: Any, pi: Any) -> Any:
    """q/p − tanθ u_slip + Δ √T, zero at the base, for numbers and series."""
    delta = chute.wall_dissipation(pi)
    g0, _ = law.radial(nu, chute.radial_law)
    u_z = slopes(nu, T, Q, chute.ep, chute.tan_theta, chute.radial_law, pi)[2]
    u = slip(nu, T, u_z, g0, chute.r, chute.tan_theta, pi)
    return Q / (law.reduced_pressure(nu, chute.ep, chute.radial_law) * T) - chute.tan_theta * u + delta * T**0.5


def start_of(arithmetic: Arithmetic, series: list[list[Any]], settings: Settings) -> float:
    """log2 of the largest ν0 at which the far-field series hold."""
    return min(*_far_limits(arithmetic, series, settings.far_tolerance), HIGHEST_START) - settings.far_shift


def _far_limits(arithmetic: Arithmetic, series: list[list[Any]], tolerance: float) -> list[float]:
    log_T = arithmetic.log2(series[1][0])
    scales = (log_T, log_T / 2, 1.5 * log_T)
    return [_limit(arithmetic, c, s, tolerance) for c, s in zip(series[1:4], scales, strict=True)]


def _limit(arithmetic: Arithmetic, series: list[Any], scale: float, tolerance: float) -> float:
    return step_limit([arithmetic.log2(x) for x in series[-TAIL_TERMS:]], len(series), scale, tolerance)


def descend(
    arithmetic: Arithmetic,
    chute: Chute,
    far_temperature: Any,
    settings: Settings,
    seen: Flow,
    progress: Callable[[], None],
) -> FlowAtBase:
    """The base of the flow that decays to T_∞; seen is the same flow in doubles, which tells how far the base lies below a ν0."""
    series = far_series(arithmetic, chute, far_temperature, settings.far_terms, settings.far_tolerance)
    nu = seen.inside(2.0 ** start_of(arithmetic, series, settings))
    start = arithmetic.number(nu)
    descent = Descent(arithmetic, chute, settings, [evaluate(arithmetic, c, start) for c in series], seen.height(nu))
    while True:
        progress()
        y, h = descent.expand()
        if h >= descent.remaining:
            descent.advance(y, descent.to_base(y))
            return descent.at_base()
        descent.advance(y, arithmetic.number(-h))
