"""A base flow in doubles: solved once with digits to spare, and rounded.

Each step of the solution is a polynomial about the place where it begins; beyond a reach the flow is linear (see base_integration.py).
Points may be complex: the polynomial is that of their real part, and holds in a disc about its centre; outside there is no number.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from fractions import Fraction
from functools import cache, cached_property
from typing import Any

import mpmath
import numpy as np
from numpy.typing import NDArray

from shootstab.core.errors import ConvergenceError, InputError
from shootstab.formulation.base_flow import BaseFlow, fixed_at_origin
from shootstab.formulation.base_guess import guessed
from shootstab.formulation.base_integration import FlowBranch, difference, shorter_steps
from shootstab.formulation.base_shooting import FlowShooting, OriginValues, settled_flow
from shootstab.formulation.evaluation import on_arrays
from shootstab.formulation.system import shown
from shootstab.multiprecision.backends import choose
from shootstab.multiprecision.settings import Settings
from shootstab.problems.base_flow_error import off_by

BASE_DIGITS = 20.0  # chosen: digits of the first solution
BASE_ROUNDING = 1e-16  # chosen, a unit of rounding: relative error of the polynomials in doubles
DOUBLE_EXACT = 1e-17  # chosen: relative error of a solution that is to be rounded to doubles
MOST_BASE_DIGITS = 200.0  # chosen: digits at which a flow that is so sensitive is given up
SHOWN_DIGITS = 12  # chosen: digits of a base flow's values in words
FAR_OUT = 1e9  # chosen: farther than any reach
DISC_DIGITS = 16.0  # chosen: digits to which a polynomial holds in its disc


@dataclass(frozen=True, eq=False)
class FlowTable:
    """edges (J + 1,) from left to right; in the cell between two of them the states are Σ coefficients[j, :, m] (z − centres[j])^m
    (J, n, N), |z − centres[j]| ≤ radii[j]. Outside of the edges they are limits + drifts (z − edge), (2, n), on the left and on the right.
    """

    flow: BaseFlow
    edges: NDArray[np.float64]
    centres: NDArray[np.float64]
    radii: NDArray[np.float64]
    coefficients: NDArray[np.float64]
    limits: NDArray[np.float64]
    drifts: NDArray[np.float64]
    _last: dict[bytes, NDArray[Any]] = field(default_factory=dict, repr=False)  # what was asked for last, every derivative asks anew

    def states(self, z: NDArray[Any]) -> NDArray[Any]:
        """The states (n, m) at points z (m,), real or complex."""
        key = z.dtype.char.encode() + z.tobytes()
        if key not in self._last:
            self._last.clear()
            self._last[key] = self._at(z)
        return self._last[key]

    def _at(self, z: NDArray[Any]) -> NDArray[Any]:
        x = np.real(z)
        cell = np.clip(np.searchsorted(self.edges, x, side="right") - 1, 0, len(self.centres) - 1)
        offset = z - self.centres[cell]
        total = np.zeros((len(z), len(self.flow.states)), dtype=np.result_type(z, np.float64))
        with np.errstate(all="ignore"):
            for m in range(self.coefficients.shape[2] - 1, -1, -1):
                total = total * offset[:, None] + self.coefficients[cell, :, m]
        total[np.abs(offset) > self.radii[cell]] = np.nan
        for side, outside in ((0, x < self.edges[0]), (1, x > self.edges[-1])):
            if outside.any():
                edge = self.edges[0 if side == 0 else -1]
                steady = self.drifts[side] == 0.0
                away = np.where(steady, 0.0, (z[outside] - edge)[:, None])
                total[outside] = self.limits[side] + self.drifts[side] * away
        return total.T

    def derivative(self, name: str, z: Any, order: int) -> Any:
        """d^order/dz^order of an unknown at points z, in their shape."""
        points = np.atleast_1d(np.asarray(z))
        state = name, order
        if state in self.flow.states:
            found = self.states(points)[self.flow.states.index(state)]
        else:
            states = dict(zip(self.flow.states, self.states(points), strict=True))

            def known(other: str, at: int) -> Any:
                return states[other, at] if (other, at) in states else evaluator(self.flow.higher(other, at))

            given = {other: _KnownFunction(known, other) for other in self.flow.unknowns}
            evaluator = on_arrays(points, given)
            found = np.broadcast_to(np.asarray(evaluator(self.flow.higher(name, order))), points.shape)
        return found.reshape(np.shape(z))

    def off(self, factor: float) -> FlowTable:
        """Each coefficient off by so many roundings."""
        off = BASE_ROUNDING * factor
        coefficients, limits, drifts = (off_by(numbers, off) for numbers in (self.coefficients, self.limits, self.drifts))
        return replace(self, coefficients=coefficients, limits=limits, drifts=drifts, _last={})


@dataclass(frozen=True, eq=False)
class _KnownFunction:
    known: Any
    name: str

    def __call__(self, z: Any, order: int) -> Any:
        return self.known(self.name, order)


@dataclass(frozen=True, eq=False)
class FlowFunction:
    """One unknown of a base flow, as z, order ↦ its derivative; the flow is solved when it is asked for first."""

    flow: BaseFlow
    name: str
    factor: float = 0.0

    def __call__(self, z: Any, order: int) -> Any:
        return self._table.derivative(self.name, z, order)

    @cached_property
    def _table(self) -> FlowTable:
        return table_of(self.flow, self.factor)


def functions(flow: BaseFlow | None, factor: float = 0.0) -> Mapping[str, FlowFunction]:
    """All unknowns of a base flow by name, computed less accurately by a factor other than 0."""
    return {} if flow is None else {name: FlowFunction(flow, name, factor) for name in flow.unknowns}


@cache
def table_of(flow: BaseFlow, factor: float = 0.0) -> FlowTable:
    """The flow in doubles. Raises InputError where there is none."""
    return table_of(flow).off(factor) if factor else _table(flow, solved(flow)[1])


@cache
def solved(flow: BaseFlow) -> tuple[OriginValues, list[FlowBranch]]:
    """The values at the origin so that every state is right to a rounding all along, and the way to each end.

    Numbers are those of the arithmetic that is installed. Raises InputError where the conditions are not met.
    """
    arithmetic, settings = choose(), Settings.of(BASE_DIGITS)
    try:
        known = _begun(flow)
        while BASE_DIGITS + known.lost <= MOST_BASE_DIGITS:
            found, branches = settled_flow(arithmetic, settings, flow, known, lambda: None)
            finer = FlowShooting(arithmetic, settings.finer().more_precise(), flow, lambda: None, found.lost)
            with finer.working():
                again, better = finer.newton(found, once=True)
                off = difference(arithmetic, branches, better)
            if off <= DOUBLE_EXACT:
                return replace(again, lost=found.lost), better
            known = replace(found, lost=found.lost + max(4.0, 2.0 + math.log10(off / DOUBLE_EXACT)))
    except ConvergenceError as error:
        raise InputError(str(error)) from error
    raise InputError(f"base: the solution is so sensitive that {MOST_BASE_DIGITS:.0f} digits do not determine it")


def _begun(flow: BaseFlow) -> OriginValues:
    """What collocation knows of the values at the origin, and of the reaches. Raises ConvergenceError."""
    state, lengths = guessed(flow)
    assert flow.origin.at is not None
    reaches = {d: flow.origin.at + d * Fraction(length) for d, length in lengths.items()}
    fixed = fixed_at_origin(flow)[0]
    return OriginValues(tuple(mpmath.mpf(float(x)) for i, x in enumerate(state) if i not in fixed), reaches)


def _table(flow: BaseFlow, ways: list[FlowBranch]) -> FlowTable:
    arithmetic, settings = choose(), Settings.of(BASE_DIGITS)
    cells, n = [], len(flow.states)
    limits, drifts = np.full((2, n), np.nan), np.zeros((2, n))
    with arithmetic.working(settings.digits):
        for way in ways:
            side = 0 if way.direction < 0 else 1
            for step in shorter_steps(arithmetic, settings, flow, way):
                centre, length = (float(arithmetic.to_mpmath(x)) for x in (step.centre, step.length))
                numbers = [[float(arithmetic.to_mpmath(c)) for c in series] for series in step.coefficients]
                cells.append(
                    (min(centre, centre + way.direction * length), max(centre, centre + way.direction * length), centre, length, numbers)
                )
            if way.limit is not None and way.drift is not None:
                limits[side] = [float(arithmetic.to_mpmath(x)) for x in way.limit]
                drifts[side] = [float(arithmetic.to_mpmath(x)) for x in way.drift]
    cells.sort(key=lambda cell: cell[0])
    terms = max(len(series) for cell in cells for series in cell[4])
    coefficients = np.array([[series + [0.0] * (terms - len(series)) for series in cell[4]] for cell in cells])
    wider = 10 ** ((BASE_DIGITS - DISC_DIGITS) / terms)
    edges = np.array([cells[0][0], *(cell[1] for cell in cells)])
    radii = np.array([cell[3] * wider for cell in cells])
    return FlowTable(flow, edges, np.array([cell[2] for cell in cells]), radii, coefficients, limits, drifts)


def limit_of(flow: BaseFlow, direction: int, name: str, order: int) -> float:
    """A derivative far out towards an end at infinity, to the digits that are shown of it."""
    assert flow.origin.at is not None
    far = float(flow.origin.at) + direction * FAR_OUT
    return float(f"{float(table_of(flow).derivative(name, np.array([far]), order)[0]):.{SHOWN_DIGITS}g}")


def found_values(flow: BaseFlow, variable: str) -> list[str]:
    """The states at the origin in words, and where the flow has settled towards infinity."""
    found, ways = solved(flow)
    arithmetic = choose()
    assert flow.origin.at is not None
    first = [arithmetic.to_mpmath(series[0]) for series in ways[0].steps[0].coefficients]
    numbers = ", ".join(f"{shown(state)} = {mpmath.nstr(x, SHOWN_DIGITS)}" for state, x in zip(flow.states, first, strict=True))
    told = [f"{numbers} at {variable} = {float(flow.origin.at):g}"]
    return told + [f"settled at {variable} = {float(reach):.3g}" for reach in found.reaches.values()]
