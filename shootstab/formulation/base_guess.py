"""A base flow to a few digits: collocation of its boundary-value problem (SciPy's solve_bvp), from what its user guesses or from zero.

Each end has its way z = origin ± L t, 0 ≤ t ≤ 1, all of them as one system; at an end at infinity L is doubled until the flow has settled.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from shootstab.core.errors import ConvergenceError, InputError
from shootstab.core.scene_keys import LARGEST_NUMBER
from shootstab.formulation.base_flow import BaseFlow, fixed_at_origin
from shootstab.formulation.evaluation import Given, on_arrays
from shootstab.formulation.expression import Expression

Reals = NDArray[np.float64]

COLLOCATION_TOLERANCE = 1e-6  # chosen: relative residual; Newton's method goes on from there
FIRST_NODES, MOST_NODES = 33, 1000  # chosen: nodes of the first mesh and of the last
ROUGHLY_SETTLED = 1e-4  # chosen: y″ at the end against its largest, where the way is long enough
LENGTHS = tuple(2.0**k for k in range(15))  # chosen: lengths of ways to infinity that are tried, each begun with the one before
SHORT_LENGTHS = tuple(2.0**-k for k in range(1, 11))  # chosen: those that are tried then
PROBED = (0.7, 1.3)  # chosen: factors of states of no property for which slopes are tested for being finite
MOST_FAILURES = 3  # chosen: ways without a solution after which no others are tried


def guessed(flow: BaseFlow) -> tuple[Reals, dict[int, float]]:
    """The state (n,) at the origin, and the lengths of the ways to infinity by direction.

    Raises ConvergenceError, InputError where the equations are singular at an end.
    """
    _require_regular_ends(flow)
    infinite = [direction for direction, end in flow.ends if end.at is None]
    if len(fixed_at_origin(flow)[0]) == len(flow.states):  # an initial-value problem, for which nothing has to be guessed
        return np.zeros(len(flow.states)), dict.fromkeys(infinite, 1.0)
    if not infinite:
        found = _solved(flow, {})
        if found is None:
            raise _not_found(flow)
        return found.sol(0.0)[: len(flow.states)], {}
    for lengths in (LENGTHS, SHORT_LENGTHS):
        last, failures = None, 0
        for length in lengths:
            last = _solved(flow, dict.fromkeys(infinite, length), last if lengths is LENGTHS else None)
            failures = failures + 1 if last is None else 0
            places = {} if last is None else _settled_places(flow, last, infinite, length)
            if last is not None and None not in places.values():
                return last.sol(0.0)[: len(flow.states)], {d: place for d, place in places.items() if place is not None}
            if failures == MOST_FAILURES:
                break
    raise _not_found(flow)


def _require_regular_ends(flow: BaseFlow) -> None:
    """Raise InputError where the slopes are not finite at a finite end for one of two states of no property."""
    for place in [end.at for end in (flow.origin, *(end for _, end in flow.ends)) if end.at is not None]:
        states = np.outer(np.sqrt(np.arange(2.0, 2.0 + len(flow.states))), PROBED)
        if not np.isfinite(_at(flow, np.full(2, float(place)), states, flow.slopes)).all(axis=0).any():
            raise InputError(
                f"base: its equations are singular at the end at {float(place):g}: that is not offered; allowed are ends at which they "
                "are regular, or a flow that is a formula, in where"
            )


def _not_found(flow: BaseFlow) -> ConvergenceError:
    names = ", ".join(flow.unknowns)
    return ConvergenceError(
        f"base: no solution for {names} is found from {'its guess' if any(map(bool, flow.guess)) else 'zero'}: allowed is another guess = "
        "{ ... } with functions of the coordinate"
    )


def _at(flow: BaseFlow, z: Reals, y: Reals, expressions: tuple[Expression, ...]) -> Reals:
    """Expressions (k, m) where the states are y (n, m) at z (m,); what is not real is no number."""
    given: Given = {name: _SampledFunction(flow, z, y, name) for name in flow.unknowns}
    at = on_arrays(z, given)
    with np.errstate(all="ignore"):
        values = [np.broadcast_to(np.asarray(at(e), dtype=np.complex128), z.shape) for e in expressions]
    return np.array([np.where(v.imag == 0.0, v.real, np.nan) for v in values])


class _SampledFunction:
    """A function of the base flow where its states are known at all points."""

    def __init__(self, flow: BaseFlow, z: Reals, y: Reals, name: str) -> None:
        self._flow, self._z, self._y, self._name = flow, z, y, name

    def __call__(self, z: Any, order: int) -> Any:
        state = self._name, order
        if state in self._flow.states:
            return self._y[self._flow.states.index(state)]
        return _at(self._flow, self._z, self._y, (self._flow.higher(*state),))[0]


def _ways(flow: BaseFlow, lengths: dict[int, float]) -> list[tuple[float, float]]:
    """(origin, signed length) of each way."""
    assert flow.origin.at is not None
    origin = float(flow.origin.at)
    return [(origin, direction * lengths[direction] if end.at is None else float(end.at) - origin) for direction, end in flow.ends]


def _solved(flow: BaseFlow, lengths: dict[int, float], last: Any = None) -> Any:
    """The solution of solve_bvp, or None; begun with a solution on half the lengths if there is one."""
    n, ways = len(flow.states), _ways(flow, lengths)

    def slopes(t: Reals, y: Reals) -> Reals:
        out = [length * _at(flow, origin + length * t, y[i * n : i * n + n], flow.slopes) for i, (origin, length) in enumerate(ways)]
        return np.nan_to_num(np.concatenate(out), nan=LARGEST_NUMBER, posinf=LARGEST_NUMBER, neginf=-LARGEST_NUMBER)

    def conditions(start: Reals, end: Reals) -> Reals:
        out = [_at(flow, np.array([ways[0][0]]), start[:n, None], flow.origin.conditions)[:, 0]] if flow.origin.conditions else []
        out += [start[:n] - start[i * n : i * n + n] for i in range(1, len(ways))]
        for i, ((origin, length), (_, at)) in enumerate(zip(ways, flow.ends, strict=True)):
            if at.conditions:
                out.append(_at(flow, np.array([origin + length]), end[i * n : i * n + n, None], at.conditions)[:, 0])
        return np.nan_to_num(np.concatenate(out), nan=LARGEST_NUMBER, posinf=LARGEST_NUMBER, neginf=-LARGEST_NUMBER)

    from scipy.integrate import solve_bvp  # half a second, for those who need it

    t = np.linspace(0.0, 1.0, FIRST_NODES)
    first = np.concatenate([_at(flow, origin + length * t, np.zeros((n, len(t))), flow.guess) for origin, length in ways])
    if last is not None:
        first = last.sol(np.minimum(2 * t, 1.0))
    with np.errstate(all="ignore"):
        try:
            found = solve_bvp(slopes, conditions, t, first, tol=COLLOCATION_TOLERANCE, max_nodes=MOST_NODES)
        except (ValueError, np.linalg.LinAlgError, OverflowError, RuntimeError):
            return None
    return found if found.status == 0 and np.isfinite(found.y).all() else None


def _settled_places(flow: BaseFlow, found: Any, infinite: list[int], length: float) -> dict[int, float | None]:
    """The first distance by direction from which on y″ is small, None where it is not at the end; farther out errors only grow."""
    n, out = len(flow.states), dict[int, float | None]()
    assert flow.origin.at is not None
    for i, (direction, _) in enumerate(flow.ends):
        if direction in infinite:
            z = float(flow.origin.at) + direction * length * found.x
            turns = np.abs(_at(flow, z, found.y[i * n : i * n + n], tuple(slope.derivative() for slope in flow.slopes)))
            moving = np.flatnonzero(~(turns <= ROUGHLY_SETTLED * turns.max(axis=1, keepdims=True)).all(axis=0))
            first = 1 if not len(moving) else int(moving[-1]) + 1
            out[direction] = length * float(found.x[first]) if first < len(found.x) else None
    return out
