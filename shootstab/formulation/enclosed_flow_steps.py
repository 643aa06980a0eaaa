"""Steps of a base flow in balls: its Taylor series with a tail, and how far flows of other states are from it at most.

The tail is that of lemma C1. Two flows of y′ = F(y) differ by δ with δ′ = A δ, A a mean of ∂F/∂y over states between them. Where M holds
upper bounds of Re A_ii and |A_ij| along the step, |δ| at its end is e^{hM} times that at its beginning at most, entrywise (lemma E22), and
on the way e^{hM₊} times it, M₊ being M without what is negative: what dies away in the flow dies away in the bound.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

from shootstab.core.balls import acb, arb, arb_mat, ctx
from shootstab.core.errors import ConvergenceError
from shootstab.formulation.base_integration import FlowRecurrence
from shootstab.formulation.boundary_layer_form import BoundaryLayerForm
from shootstab.formulation.flow_fields import FlowFields
from shootstab.multiprecision.enclosable import ball
from shootstab.multiprecision.mapped_tails import SHORTER, SolutionSeries, tailed
from shootstab.multiprecision.tailed_pencil import BALLS
from shootstab.multiprecision.tailed_series import widened
from shootstab.multiprecision.tails import largest

FLOW_BITS, SPARE_FLOW_TERMS = 3.5, 12  # chosen: bits that a term of a step gains, from which their number follows; terms beyond those
ROUGH_BITS, ROUGH_TERMS = 64, 24  # chosen: the derivative of the flow map is asked for in a few digits
SHORTEST_FLOW_STEP = 2.0**-20  # chosen: a step at which a solution has run into a singularity
LAST_COEFFICIENTS = 4  # chosen: last terms that show how long a step may be; one alone may vanish by symmetry
LONGEST_FLOW_STEP = 1.0  # chosen: what dies away on a longer one is not seen to


@dataclass(frozen=True, eq=False)
class FlowPiece:
    """A step from start on, of length h, both exact: series in t of the flow through one state, and bounds (n,) of how far others are
    from it on the step; at its end middle, exact, and for each of the sets that were carried bounds (n,).
    """

    start: Any
    h: Any
    fields: SolutionSeries
    spread: list[Any]
    middle: list[Any]
    sets: list[list[Any]]


class FlowSteps:
    """Steps of one layer; states are lists of arb, or of acb for complex flows."""

    def __init__(self, form: BoundaryLayerForm) -> None:
        self.form = form
        self._jacobian = form.derivatives()
        self._recurrences: dict[int, FlowRecurrence] = {}

    @property
    def terms(self) -> int:
        """The terms of a step at the working precision."""
        return math.ceil(ctx.prec / FLOW_BITS) + SPARE_FLOW_TERMS

    def series(self, state: Sequence[Any], h: Any, terms: int) -> SolutionSeries | None:
        """The flow through a state on a step of length h; None where no tail is found."""
        return self._closed(self._expanded(state, terms), h)

    def step(self, start: Any, state: list[Any], sets: list[list[Any]], longest: Any = None) -> FlowPiece:
        """A step of the flow through an exact state, no longer than an exact length. Raises ConvergenceError where none is short enough."""
        coefficients = self._expanded(state, self.terms)
        h = min(LONGEST_FLOW_STEP, self._natural(coefficients))
        last = longest is not None and arb(h) >= longest
        while h > SHORTEST_FLOW_STEP or last:
            length = longest if last else arb(h)
            found = self._closed(coefficients, length)
            growth = None if found is None else self._growth(state, sets, found, length)
            if found is not None and growth is not None:
                on_way, at_end = growth
                end = [y.at(1) if isinstance(x, acb) else y.at(1).real for x, y in zip(state, found, strict=True)]
                middle = [x.mid() for x in end]
                rest = [abs(x - m).upper() for x, m in zip(end, middle, strict=True)]
                carried = [[(a + b).upper() for a, b in zip(_times(at_end, spread), rest, strict=True)] for spread in sets]
                widest = [largest(list(column)) for column in zip(*sets, strict=True)]
                return FlowPiece(start, length, found, [x.upper() for x in _times(on_way, widest)], middle, carried)
            h = SHORTER * float(length)
            last = False
        raise ConvergenceError("the base flow is not enclosed: take more bits")

    def _expanded(self, state: Sequence[Any], terms: int) -> list[list[Any]]:
        if ctx.prec not in self._recurrences:
            self._recurrences[ctx.prec] = FlowRecurrence(BALLS, self.form.flow, (_function, _power))
        return self._recurrences[ctx.prec].expand(arb(0), arb(1), list(state), terms)

    def _closed(self, coefficients: Sequence[Sequence[Any]], h: Any) -> SolutionSeries | None:
        """The series of these terms in t, z = z_0 + h t, with tails."""
        flow, N = self.form.flow, len(coefficients[0])
        real = all(not isinstance(c, acb) for series in coefficients for c in series)

        def needed(fields: SolutionSeries) -> list[Any]:
            at = FlowFields(flow, dict(zip(flow.states, fields, strict=True))).evaluator
            slopes = [at(F) for F in flow.slopes]
            return [abs(h) / N * F.beyond()[min(N - 1, len(F.c))] for F in slopes]

        return tailed(coefficients, h, needed, real)

    def _natural(self, coefficients: Sequence[Sequence[Any]]) -> float:
        """The length of step at which the last terms have fallen to rounding, in doubles: a choice, not a bound."""
        size = max(0.0, *(BALLS.log2(series[0]) for series in coefficients))
        last = range(len(coefficients[0]) - LAST_COEFFICIENTS, len(coefficients[0]))
        logs = [(BALLS.log2(series[m]) - size + ctx.prec) / m for series in coefficients for m in last]
        return float(2.0 ** -max(logs)) if max(logs) > -math.inf else LONGEST_FLOW_STEP

    def _growth(self, state: Sequence[Any], sets: Sequence[Sequence[Any]], thin: SolutionSeries, h: Any) -> tuple[Any, Any] | None:
        """e^{hM₊} and e^{hM} (n, n) for all flows that begin in the widest set; None where they are not enclosed."""
        with ctx.workprec(ROUGH_BITS):
            widest = [largest(list(column)) for column in zip(*sets, strict=True)]
            rough = self.series([around(x, radius) for x, radius in zip(state, widest, strict=True)], h, ROUGH_TERMS)
            if rough is None:
                return None
            part = acb(arb(0).union(arb(1)))
            M = self._comparison([x.at(part) for x in rough], h)
            if M is not None:  # what the first bound says of these flows makes a second one
                near = [x.at(part) for x in thin]
                M = self._comparison([widened(x, r) for x, r in zip(near, _times(_exponential(M, True), widest), strict=True)], h)
            return None if M is None else (_exponential(M, True), _exponential(M, False))

    def _comparison(self, values: Sequence[Any], h: Any) -> list[list[Any]] | None:
        """hM from states that hold all flows on the step; None where it is not finite."""
        at = FlowFields(self.form.flow, dict(zip(self.form.flow.states, values, strict=True))).evaluator
        M = [[arb(0)] * len(values) for _ in values]
        for (i, j), entry in self._jacobian.items():
            value = acb(at(entry)) * h
            M[i][j] = value.real.upper() if i == j else abs(value).upper()
        return M if all(x.is_finite() for row in M for x in row) else None


def around(x: Any, radius: Any) -> Any:
    """The ball about x, real or complex as x is."""
    spread = arb(0, arb(radius).upper())
    return acb(x.real + spread, x.imag + spread) if isinstance(x, acb) else x + spread


def _exponential(M: Sequence[Sequence[Any]], above: bool) -> Any:
    """e^M, or e^{M₊}."""
    return arb_mat([[max(x, arb(0)) if above else x for x in row] for row in M]).exp()


def _times(A: Any, x: Sequence[Any]) -> list[Any]:
    return [abs(row[0]) for row in (A * arb_mat([[value] for value in x])).tolist()]


def _function(name: str, x: Any) -> Any:
    """A function of a ball; π."""
    return arb.pi() if name == "pi" else getattr(x, name)()


def _power(x: Any, exponent: Fraction) -> Any:
    return x ** ball(exponent)
