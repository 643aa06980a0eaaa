"""The values of a base flow at its origin: Newton's method on its conditions, from a first guess to any number of digits."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import Any

import mpmath

from shootstab.core.errors import ConvergenceError
from shootstab.core.progress import StepDone
from shootstab.formulation.base_flow import BaseFlow, fixed_at_origin
from shootstab.formulation.base_integration import FlowBranch, FlowState, at_state, branch, difference
from shootstab.multiprecision.arithmetic import Arithmetic
from shootstab.multiprecision.settings import Settings

BASE_NEWTONS = 40  # chosen: iterations at most, each of which doubles the digits
SETTLED_SHARE = 0.6  # chosen: part of the digits, in which the last step of Newton may still show
ROUNDS = 60  # chosen: times that the reach of an end at infinity is moved out
STRETCH = Fraction(3, 2)  # chosen: growth of the reach, in one round at most
SAFE_GROWTH = math.log(0.1)  # chosen: log of what an error at the reach may grow to when the reach moves out
SLOW_SHARE = 0.75  # chosen: part of its digits that y″ has lost in the middle of the way where it falls as a power; half is exponential
SLOW_DIGITS = 1.5  # chosen: times the digits asked for, beyond which what is left of y″ is rounding, and tells nothing
UNSETTLED_SHARE = 0.25  # chosen: part of the way that a decay would take, by which the reach moves out while none is seen yet
LOST_UNSEEN = 2.0  # chosen: digits that may be lost beside those set aside, out of the guard digits
MOST_LOST = 2000.0  # chosen: digits lost at which a flow is given up
PLACE_DENOMINATOR = 1024  # chosen: fractions of a reach
A_LITTLE_FARTHER = 1.05  # chosen: the last step over the way that is wanted, so that rounding leaves none after it
MOST_PLACES = 64  # chosen: steps of the whole way at most

Reaches = Mapping[int, Fraction]  # reaches by the direction of the end


@dataclass(frozen=True, eq=False)
class OriginValues:
    """The values at the origin that are free, as mpmath numbers, the reaches, and the Jacobian of the conditions by these values.

    lost is the number of digits by which a state knows less than these values: log10 of what an error of theirs grows to on the way.
    """

    free: tuple[Any, ...]
    reaches: Reaches
    jacobian: Any = None
    lost: float = 0.0


class FlowShooting:
    """A base flow in one arithmetic with one choice of settings and digits to lose beside; to be used inside its working precision."""

    def __init__(self, arithmetic: Arithmetic, settings: Settings, flow: BaseFlow, progress: StepDone, lost: float = 0.0) -> None:
        self.arithmetic, self.settings, self.flow, self._progress = arithmetic, settings.with_loss(lost), flow, progress
        self._lost = lost
        fixed, self._others = fixed_at_origin(flow)
        assert flow.origin.at is not None
        with self.working():
            self._origin = arithmetic.number(flow.origin.at)
            nothing = [arithmetic.number(0)] * len(flow.states)
            self._fixed = {i: at_state(arithmetic, flow, self._origin, nothing, expression) for i, expression in fixed.items()}
        self._places = [i for i in range(len(flow.states)) if i not in fixed]

    @contextmanager
    def working(self) -> Iterator[None]:
        """The working precision."""
        with self.arithmetic.working(self.settings.digits), mpmath.workdps(self.settings.digits):
            yield

    def state(self, free: tuple[Any, ...]) -> FlowState:
        """The state at the origin."""
        values = dict(self._fixed) | dict(zip(self._places, map(self.arithmetic.number, free), strict=True))
        return [values[i] for i in range(len(self.flow.states))]

    def branches(self, found: OriginValues) -> list[FlowBranch]:
        """The flow from the origin to every end."""
        out = []
        for direction, end in self.flow.ends:
            self._progress()
            reach = end.at if end.at is not None else found.reaches[direction]
            out.append(branch(self.arithmetic, self.settings, self.flow, self.state(found.free), direction, end, reach))
        return out

    def defects(self, found: OriginValues, branches: list[FlowBranch]) -> list[Any]:
        """What the conditions that are not fulfilled by themselves leave, mpmath numbers."""
        arithmetic, flow = self.arithmetic, self.flow
        values = [at_state(arithmetic, flow, self._origin, self.state(found.free), condition) for condition in self._others]
        for (direction, end), way in zip(flow.ends, branches, strict=True):
            place = arithmetic.number(end.at if end.at is not None else found.reaches[direction])
            values += [at_state(arithmetic, flow, place, way.end, condition) for condition in end.conditions]
        return [arithmetic.to_mpmath(value) for value in values]

    def linearized(self, found: OriginValues, branches: list[FlowBranch], here: list[Any]) -> OriginValues:
        """The values with the derivatives of the defects by differences, to half the digits that are not lost, and with those lost."""
        columns, lost = [], 0.0
        share = mpmath.mpf(10) ** round(-0.5 * (self.settings.digits + self._lost))
        for j, x in enumerate(found.free):
            step = (abs(x) or mpmath.mpf(1)) * share
            moved = replace(found, free=tuple(y + step if i == j else y for i, y in enumerate(found.free)))
            there = self.branches(moved)
            columns.append([(b - a) / step for a, b in zip(here, self.defects(moved, there), strict=True)])
            lost = max(lost, float(mpmath.log10(max(difference(self.arithmetic, branches, there) / share, 1))))
        return replace(found, jacobian=mpmath.matrix(columns).T, lost=lost)

    def newton(self, found: OriginValues, once: bool = False) -> tuple[OriginValues, list[FlowBranch]]:
        """The values at which the conditions hold, with the reaches as they are; or after one step. Raises ConvergenceError."""
        for _ in range(BASE_NEWTONS):
            branches = self.branches(found)
            if not found.free:
                return found, branches
            here = self.defects(found, branches)
            found = self.linearized(found, branches, here)
            step = self.step(found.jacobian, here)
            size = max(abs(d) / (abs(x) or 1) for d, x in zip(step, found.free, strict=True))
            found = replace(found, free=tuple(x - d for x, d in zip(found.free, step, strict=True)))
            if once or size <= mpmath.mpf(10) ** (-SETTLED_SHARE * self.settings.tolerance):
                return found, self.branches(found)
        raise ConvergenceError("the conditions of the base flow are not met: Newton's method does not settle")

    def step(self, jacobian: Any, defects: list[Any]) -> list[Any]:
        """The step by which Newton's method lowers the free values. Raises ConvergenceError where the conditions do not determine them."""
        try:
            return list(mpmath.lu_solve(jacobian, mpmath.matrix(defects)))
        except ZeroDivisionError:
            raise ConvergenceError("the conditions of the base flow do not determine it next to this solution") from None

    def settled(self, found: OriginValues) -> tuple[OriginValues, list[FlowBranch]]:
        """The flow with reaches so far out that the flow has settled to the far tolerance. Raises ConvergenceError where it does not.

        Where more digits are lost than were set aside for that, what is found so far.
        """
        found, branches = self.newton(found, once=True)
        for _ in range(ROUNDS):
            if found.lost > self._lost + LOST_UNSEEN:
                return found, branches
            moved = dict(found.reaches)
            for (direction, end), way in zip(self.flow.ends, branches, strict=True):
                if end.at is None and way.settled > -self.settings.far_tolerance:
                    moved[direction] = self._farther(found.reaches[direction], way, direction)
            if moved == found.reaches:
                for way in branches:
                    self._require_exponential(way)
                return self.newton(found)
            found, branches = self.newton(replace(found, reaches=moved), once=True)
        places = ", ".join(f"{float(reach):.3g}" for reach in found.reaches.values())
        told = f"the base flow does not settle up to {places}"
        raise ConvergenceError(f"{told}: allowed is one that comes to its limit exponentially by then")

    def _require_exponential(self, way: FlowBranch) -> None:
        """Raise ConvergenceError where most of the fall lies in the first half of the way, as it does for powers of the coordinate."""
        if way.half < SLOW_SHARE * way.settled and way.settled > -SLOW_DIGITS * self.settings.far_tolerance:
            raise ConvergenceError(
                "the base flow comes to its limit slower than exponentially: allowed is one that comes to it exponentially"
            )

    def _farther(self, reach: Fraction, way: FlowBranch, direction: int) -> Fraction:
        """The next reach: as far as the decay asks, and as is safe."""
        assert self.flow.origin.at is not None
        distance = direction * (reach - self.flow.origin.at)
        most = distance * (STRETCH - 1)
        if way.rate > 0.0:
            level = min(way.settled * math.log(10), SAFE_GROWTH)
            wanted = (self.settings.far_tolerance * math.log(10) + level) / way.rate
            safe = max(SAFE_GROWTH - level, 1.0) / way.rate
            if not self._places:  # where nothing is sought, nothing has to be safe
                safe = wanted if level < SAFE_GROWTH else UNSETTLED_SHARE * wanted
            most = min(most, Fraction(max(min(A_LITTLE_FARTHER * wanted, safe), float(distance) / MOST_PLACES)))
        unit = distance / PLACE_DENOMINATOR
        return reach + direction * max(1, round(most / unit)) * unit


def settled_flow(
    arithmetic: Arithmetic, settings: Settings, flow: BaseFlow, known: OriginValues, progress: StepDone
) -> tuple[OriginValues, list[FlowBranch]]:
    """See FlowShooting.settled, with so many digits beside as are lost on the way. Raises ConvergenceError."""
    lost = known.lost
    while lost <= MOST_LOST:
        shooting = FlowShooting(arithmetic, settings, flow, progress, lost)
        with shooting.working():
            known, branches = shooting.settled(known)
        if known.lost <= lost + LOST_UNSEEN:
            return replace(known, lost=max(lost, known.lost)), branches
        lost = known.lost
    raise ConvergenceError(f"the base flow loses {lost:.0f} digits on its way: allowed is one that is less sensitive")
