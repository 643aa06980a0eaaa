"""A base flow by Taylor series in any arithmetic: from its origin to its ends, and the values at the origin that its conditions ask for.

The state y at the origin is found by Newton's method on the conditions at the ends (shooting). An end at infinity is a place, its reach, so
far out that the flow has settled there: y″ has fallen to 10^−tolerance of the largest that each state has had. Beyond the reach the state
is linear: what has fallen to nothing against its largest value is zero, and F of that is the slope.

An error at the origin grows on the way; the precision takes it in, and the reach goes out no faster than the accuracy of the values allows.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

from shootstab.core.errors import ConvergenceError
from shootstab.formulation.base_flow import BaseEnd, BaseFlow
from shootstab.formulation.evaluation import Evaluator
from shootstab.formulation.expression import Expression
from shootstab.formulation.series_digits import BaseFields, NumberFunctions, on_numbers, on_relaxed
from shootstab.formulation.system import Jet
from shootstab.multiprecision.arithmetic import TAIL_TERMS, Arithmetic
from shootstab.multiprecision.relaxed_series import RelaxedSeries, RelaxedSystem
from shootstab.multiprecision.settings import Settings

MOST_BASE_STEPS = 4000  # chosen: Taylor steps from the origin to an end
STEP_BITS = 0.25  # chosen: bits by which log2 of a step is lowered until its series holds
LOWEST_STEP = -400.0  # chosen: log2 of a step at which a solution has run into a singularity
FADED_SHARE = 0.9  # chosen: part of the digits to which a flow has settled, by which a value has fallen that is taken for zero
SIZE_TERMS = 0.5  # chosen: part of the terms of a series, the first ones, that show how large a solution is along a step

FlowState = list[Any]


@dataclass(frozen=True, eq=False)
class FlowStep:
    """Taylor coefficients of each state in z − centre, for |z − centre| ≤ length towards the branch's end."""

    centre: Any
    length: Any
    coefficients: list[list[Any]]


@dataclass(frozen=True, eq=False)
class FlowBranch:
    """The flow from the origin to one end. settled is log10 of what is left of y″ there, against its largest, half the same in the middle
    of the way, rate how fast it dies away; limit and drift are the state at the reach and its slope beyond, None at a finite end.
    """

    direction: int
    steps: list[FlowStep]
    end: FlowState
    settled: float
    half: float
    rate: float
    limit: FlowState | None
    drift: FlowState | None


class FlowRecurrence:
    """The Taylor recurrence of a base flow."""

    def __init__(self, arithmetic: Arithmetic, flow: BaseFlow, numbers: NumberFunctions | None = None) -> None:
        self.arithmetic, self.flow = arithmetic, flow
        self._graph = RelaxedSystem(arithmetic)
        self._z, *self._y = (self._graph.unknown() for _ in range(1 + len(flow.states)))
        at = on_relaxed(self._graph, self._z, fields_of(flow, dict(zip(flow.states, self._y, strict=True))), numbers)
        self._slopes = [self._as_series(at(slope)) for slope in flow.slopes]

    def _as_series(self, value: Any) -> RelaxedSeries:
        return value if isinstance(value, RelaxedSeries) else 0 * self._z + value

    def expand(self, z: Any, step: Any, state: FlowState, terms: int) -> list[list[Any]]:
        """The first coefficients of each state, so many, in (z′ − z)/step. Raises ConvergenceError where F is not finite, or not real."""
        arithmetic, zero = self.arithmetic, self.arithmetic.number(0)
        self._graph.clear()
        try:
            for m in range(terms):
                self._z.coefficients.append(z if m == 0 else step if m == 1 else zero)
                for i, y in enumerate(self._y):
                    y.coefficients.append(state[i] if m == 0 else arithmetic.rounded(step * self._slopes[i].coefficients[m - 1] / m))
                self._graph.extend(m)
        except (ValueError, TypeError, ZeroDivisionError, OverflowError):
            raise self._singular(z) from None
        return [list(y.coefficients) for y in self._y]

    def logs(self, z: Any, series: list[list[Any]]) -> list[list[float]]:
        """log2 of all coefficients of series about z. Raises ConvergenceError where one is not finite."""
        try:
            return [[self.arithmetic.log2(c) for c in y] for y in series]
        except (ValueError, OverflowError):
            raise self._singular(z) from None

    def _singular(self, z: Any) -> ConvergenceError:
        return ConvergenceError(f"the base flow is singular, or not real, at {float(self.arithmetic.to_mpmath(z)):.6g}")


def fields_of(flow: BaseFlow, values: Mapping[Jet, Any]) -> BaseFields:
    """The functions of the base flow where its states have these values."""

    def fields(at: Evaluator, name: str, order: int) -> Any:
        known = values.get((name, order))
        return at(flow.higher(name, order)) if known is None else known

    return fields


def branch(
    arithmetic: Arithmetic, settings: Settings, flow: BaseFlow, state: FlowState, direction: int, end: BaseEnd, reach: Fraction
) -> FlowBranch:
    """The flow from its origin to the reach, or to a finite end. Raises ConvergenceError."""
    recurrence = FlowRecurrence(arithmetic, flow)
    one = arithmetic.number(1)
    assert flow.origin.at is not None
    z, target = arithmetic.number(flow.origin.at), arithmetic.number(reach)
    largest, steepest, steps = [-math.inf] * len(state), [-math.inf] * len(state), []
    sharpest, start = [-math.inf] * len(state), z
    turns: list[tuple[float, list[float]]] = []
    longest = float(arithmetic.log2(target - z))
    for _ in range(MOST_BASE_STEPS):
        series = recurrence.expand(z, one, state, settings.order)
        logs = recurrence.logs(z, series)
        log_step = _step(logs, largest, longest, settings)
        left = abs(target - z)
        last = log_step >= arithmetic.log2(left)
        h = left if last else arithmetic.number(2.0**log_step)
        sharpest = [max(seen, y[2]) for seen, y in zip(sharpest, logs, strict=True)]
        turns.append((2.0 ** arithmetic.log2(z - start), [y[2] for y in logs]))
        steepest = [max(seen, y[1]) for seen, y in zip(steepest, logs, strict=True)]
        largest = [max(seen, _size(y, min(log_step, arithmetic.log2(left)))) for seen, y in zip(largest, logs, strict=True)]
        steps.append(FlowStep(z, h, series))
        state = [value(arithmetic, y, direction * h) for y in series]
        z, longest = arithmetic.rounded(z + direction * h), log_step + 1
        if last:
            break
    else:
        told = f"the base flow takes more than {MOST_BASE_STEPS} Taylor steps to {float(reach):.6g}"
        raise ConvergenceError(f"{told}: allowed is one that varies less on its way, or settles sooner")
    if end.at is not None:
        return FlowBranch(direction, steps, state, -math.inf, -math.inf, 0.0, None, None)
    logs = recurrence.logs(z, recurrence.expand(z, one, state, 4))
    settled = _fallen([y[2] for y in logs], sharpest)
    half = _fallen([y for x, y in turns if 2 * x <= abs(float(reach - flow.origin.at))][-1], sharpest)
    rate = min((3 * 2.0 ** (y[3] - y[2]) for y in logs if min(y[2:]) > -math.inf), default=0.0)
    faded = _faded(arithmetic, settings, state, largest)
    drift = _faded(arithmetic, settings, [y[1] for y in recurrence.expand(z, one, faded, 2)], steepest)
    return FlowBranch(direction, steps, state, settled * math.log10(2), half * math.log10(2), rate, faded, drift)


def _fallen(turns: Sequence[float], sharpest: Sequence[float]) -> float:
    """log2 of what is left of y″, of the state that has most of it left."""
    return max((now - seen for now, seen in zip(turns, sharpest, strict=True) if now > -math.inf), default=-math.inf)


def _faded(arithmetic: Arithmetic, settings: Settings, values: FlowState, largest: Sequence[float]) -> FlowState:
    """Values (n,) with zero for those that have fallen to nothing against the log2 of their largest."""
    least = -FADED_SHARE * math.log2(10) * settings.far_tolerance
    return [arithmetic.number(0) if arithmetic.log2(y) - seen < least else y for y, seen in zip(values, largest, strict=True)]


def value(arithmetic: Arithmetic, coefficients: Sequence[Any], x: Any) -> Any:
    """Σ c_m x^m by Horner's rule."""
    total = coefficients[-1]
    for c in coefficients[-2::-1]:
        total = arithmetic.rounded(total * x + c)
    return total


def at_state(arithmetic: Arithmetic, flow: BaseFlow, z: Any, state: FlowState, expression: Expression) -> Any:
    """An expression of the base flow where it has this state."""
    return arithmetic.rounded(
        arithmetic.number(1) * on_numbers(arithmetic, z, fields_of(flow, dict(zip(flow.states, state, strict=True))))(expression)
    )


def _size(logs: Sequence[float], log_step: float) -> float:
    """log2 of how large a series is along a step."""
    return max(log + m * log_step for m, log in enumerate(logs[: max(2, int(SIZE_TERMS * len(logs)))]))


def _step(logs: Sequence[Sequence[float]], largest: Sequence[float], longest: float, settings: Settings) -> float:
    """log2 of the step at which the last terms of every state are below 10^−tolerance of its size, so far and along the step."""
    log_step = longest
    while log_step > LOWEST_STEP:
        tails = [max(log + m * log_step for m, log in enumerate(y) if m >= len(y) - TAIL_TERMS) for y in logs]
        sizes = [max(seen, _size(y, log_step)) for seen, y in zip(largest, logs, strict=True)]
        if all(tail <= size - settings.tolerance * math.log2(10) for tail, size in zip(tails, sizes, strict=True)):
            return log_step
        log_step -= STEP_BITS
    raise ConvergenceError("the base flow runs into a singularity")


def difference(arithmetic: Arithmetic, first: list[FlowBranch], second: list[FlowBranch]) -> float:
    """The largest one of two solutions, at the steps of the first, of each state against its largest value."""
    worst = 0.0
    for one, two in zip(first, second, strict=True):
        for i in range(len(one.end)):
            sizes = [abs(step.coefficients[i][0]) for step in one.steps] + [abs(one.end[i])]
            apart = [abs(one.end[i] - two.end[i])]
            apart += [abs(step.coefficients[i][0] - state_on(arithmetic, two, step.centre)[i]) for step in one.steps]
            size, off = max(sizes), max(apart)
            worst = max(worst, float(arithmetic.to_mpmath(off / size)) if size > 0 else 0.0)
    return worst


def state_on(arithmetic: Arithmetic, way: FlowBranch, z: Any) -> FlowState:
    """The state at a place between the origin and the end of a way, or, where the end is at infinity, beyond its reach."""
    steps = way.steps
    low, high = 0, len(steps) - 1
    while low < high:
        middle = (low + high + 1) // 2
        if way.direction * (z - steps[middle].centre) >= 0:
            low = middle
        else:
            high = middle - 1
    step = steps[low]
    beyond = way.direction * (z - step.centre) - step.length
    if way.limit is not None and way.drift is not None and beyond > 0:
        return [a + way.direction * beyond * b for a, b in zip(way.limit, way.drift, strict=True)]
    return [value(arithmetic, c, z - step.centre) for c in step.coefficients]


def shorter_steps(arithmetic: Arithmetic, settings: Settings, flow: BaseFlow, way: FlowBranch) -> list[FlowStep]:
    """The same way in the steps of these settings: a long one loses in rounding what its terms are larger than their sum."""
    recurrence, out = FlowRecurrence(arithmetic, flow), list[FlowStep]()
    first, last = way.steps[0], way.steps[-1]
    z, end = first.centre, last.centre + way.direction * last.length
    largest, longest = [-math.inf] * len(flow.states), float(arithmetic.log2(end - z))
    for _ in range(MOST_BASE_STEPS):
        series = recurrence.expand(z, arithmetic.number(1), state_on(arithmetic, way, z), settings.order)
        logs, left = recurrence.logs(z, series), abs(end - z)
        log_step = _step(logs, largest, longest, settings)
        ends = log_step >= arithmetic.log2(left)
        h = left if ends else arithmetic.number(2.0**log_step)
        out.append(FlowStep(z, h, series))
        if ends:
            return out
        largest = [max(seen, _size(y, log_step)) for seen, y in zip(largest, logs, strict=True)]
        z, longest = arithmetic.rounded(z + way.direction * h), log_step + 1
    raise ConvergenceError(f"the base flow takes more than {MOST_BASE_STEPS} Taylor steps: allowed is one that varies less on its way")
