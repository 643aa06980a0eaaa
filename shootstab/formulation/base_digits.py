"""A base flow that solves equations of its own, in many digits: what an integration over it asks of it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from fractions import Fraction
from typing import Any

import mpmath

from shootstab.core.progress import StepDone
from shootstab.formulation.base_flow import BaseFlow
from shootstab.formulation.base_integration import FlowBranch, FlowRecurrence, fields_of, state_on
from shootstab.formulation.base_shooting import FlowShooting, settled_flow
from shootstab.formulation.base_solution import solved
from shootstab.formulation.series_digits import BaseFields
from shootstab.multiprecision.arithmetic import Arithmetic
from shootstab.multiprecision.integration import BaseFlowNumbers
from shootstab.multiprecision.settings import Settings
from shootstab.multiprecision.taylor import Taylor, real_series

FARTHER_REACH = Fraction(9, 8)  # chosen: times the reach, where the flow is to be known farther out


class FlowDigits:
    """What is known of the flow's values at its origin improves from one precision to the next."""

    def __init__(self, flow: BaseFlow) -> None:
        """Raises InputError where there is none."""
        self.flow = flow
        self.known, _ = solved(flow)

    def base(self, arithmetic: Arithmetic, settings: Settings, progress: StepDone) -> BaseFlowNumbers:
        """The free values at the origin, as they differ from those that are known: zero. See multiprecision.integration.

        The values themselves hold more digits than the integration works with, those that are lost on the way.
        """
        self.known, _ = settled_flow(arithmetic, settings, self.flow, self.known, progress)
        return tuple(mpmath.mpf(0) for _ in self.known.free)

    def series(self, arithmetic: Arithmetic, settings: Settings, base: BaseFlowNumbers) -> FlowSeries:
        """The flow with these values at the origin; with others, found anew, where it is to be known farther out."""
        return FlowSeries(arithmetic, settings, self, base)


class FlowSeries:
    """The flow in one arithmetic with one choice of settings."""

    def __init__(self, arithmetic: Arithmetic, settings: Settings, digits: FlowDigits, base: BaseFlowNumbers) -> None:
        self._arithmetic, self.flow, known = arithmetic, digits.flow, digits.known
        lost = known.lost * (float(FARTHER_REACH) if known.reaches else 1.0)
        self._shooting = FlowShooting(arithmetic, settings, digits.flow, lambda: None, lost)
        assert self.flow.origin.at is not None
        self._origin = self.flow.origin.at
        with self._shooting.working():
            found = replace(known, free=tuple(x + d for x, d in zip(known.free, base, strict=True)))
            if settings.far_shift and found.reaches:
                moved = {d: self._origin + FARTHER_REACH * (reach - self._origin) for d, reach in found.reaches.items()}
                found, branches = self._shooting.newton(replace(found, reaches=moved), once=True)
            else:
                branches = self._shooting.branches(found)
        self._known, self._found, self._branches = known, found, {way.direction: way for way in branches}
        self._recurrence = FlowRecurrence(arithmetic, self.flow)

    def corrected(self) -> BaseFlowNumbers:
        """The values at the origin after one more step of Newton, as they differ from those that were known."""
        found, step = self._found, []
        with self._shooting.working():
            if found.jacobian is not None:
                step = self._shooting.step(found.jacobian, self._shooting.defects(found, list(self._branches.values())))
            return tuple(x - d - y for x, d, y in zip(found.free, step, self._known.free, strict=True))

    def reach(self, direction: int) -> Fraction:
        """Where the flow has settled on the way to infinity."""
        return self._found.reaches[direction]

    def limit(self, direction: int) -> BaseFields:
        """The functions at infinity."""
        limit = self._branches[direction].limit
        assert limit is not None
        return fields_of(self.flow, dict(zip(self.flow.states, limit, strict=True)))

    def at(self, z: Any) -> BaseFields:
        """The values of the functions at one place."""
        state = state_on(self._arithmetic, self._way(z, 0), z)
        return fields_of(self.flow, dict(zip(self.flow.states, state, strict=True)))

    def along(self, z: Taylor) -> BaseFields:
        """The functions as series, for z = z_0 + z_1 t."""
        arithmetic, (here, step) = self._arithmetic, z.coefficients(2)
        way = self._way(here, step)
        state = state_on(arithmetic, way, here)
        if way.limit is not None and way.drift is not None and way.direction * (here - way.steps[-1].centre) > way.steps[-1].length:
            nothing = [arithmetic.number(0)] * (z.terms - 2)
            series: list[list[Any]] = [[value, step * slope, *nothing] for value, slope in zip(state, way.drift, strict=True)]
        else:
            series = self._recurrence.expand(here, step, state, z.terms)
        values: Mapping[Any, Any] = {s: real_series(arithmetic, c) for s, c in zip(self.flow.states, series, strict=True)}
        return fields_of(self.flow, values)

    def _way(self, z: Any, towards: Any) -> FlowBranch:
        """The way on which a place lies; at the origin itself the one on which the next ones do."""
        ahead = self._arithmetic.to_mpmath(z) - mpmath.mpf(self._origin.numerator) / self._origin.denominator
        sign = ahead or self._arithmetic.to_mpmath(self._arithmetic.number(1) * towards)
        return self._branches.get(1 if sign > 0 else -1) or next(iter(self._branches.values()))
