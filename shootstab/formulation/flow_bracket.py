"""The free value of a layer that is pulled to its limit: a bracket in which there is a solution (theory, lemma E23).

From a place on, a flow that does not come to the limit leaves it, upwards with w > W and p > 0, or downwards. The ends of the bracket are
seen to leave it one way and the other; w at that place rises or falls with the free value, and a secant finds the value between.
"""

from __future__ import annotations

from typing import Any

from shootstab.core.balls import acb, arb, ctx
from shootstab.core.errors import ConvergenceError
from shootstab.formulation.base_solution import solved
from shootstab.formulation.boundary_layer_form import BoundaryLayerForm
from shootstab.formulation.enclosed_flow_steps import FlowPiece, FlowSteps, around
from shootstab.formulation.flow_arrival import FlowArrival, pulled_arrival
from shootstab.formulation.flow_fields import FlowFields
from shootstab.formulation.flow_origin import FARTHEST_LAYER, ROUNDED_FLOW_BITS, SPARE_FLOW_BITS, begun
from shootstab.multiprecision.enclosable import ball

FIRST_SECANT = 2.0**-40  # chosen: distance of the first two free values
BRACKET_SECANTS = 24  # chosen: secants at most, each of which gains more than half as many digits again


class FlowBracket:
    """The free value of one layer."""

    def __init__(self, form: BoundaryLayerForm) -> None:
        self.form, self.steps = form, FlowSteps(form)

    def located(self) -> tuple[list[Any], Any, list[FlowPiece], FlowArrival]:
        """See flow_origin.FlowOrigin.located: a solution lies within the radius, maybe others too."""
        bits = ctx.prec + SPARE_FLOW_BITS
        radius, form = arb(2) ** (ROUNDED_FLOW_BITS // 2 - bits), self.form
        with ctx.workprec(bits + ROUNDED_FLOW_BITS):
            x = [arb(solved(form.flow)[0].free[0]).mid()]
            reach = self._settled(x[0], bits)
            x.append((x[0] + arb(FIRST_SECANT)).mid())
            v = [self._above(s, reach)[0].mid() for s in x]
            for _ in range(BRACKET_SECANTS):
                if v[1] == v[0]:
                    break
                x = [x[1], (x[1] - v[1] * (x[1] - x[0]) / (v[1] - v[0])).mid()]
                if 4 * abs(x[1] - x[0]) < radius:
                    break
                v = [v[1], self._above(x[1], reach)[0].mid()]
            s = x[1]
            ends = [self._above((s + side * radius / 2).mid(), reach) for side in (1, -1)]  # inside of the set of all flows
            sides = {1 if all(y > 0 for y in end) else -1 if all(y < 0 for y in end) else 0 for end in ends}
            pieces = self._passed(s, radius, reach)
            beyond = pulled_arrival(form, [around(y, r) for y, r in zip(pieces[-1].middle, pieces[-1].sets[1], strict=True)])
        if sides != {1, -1} or beyond is None:
            raise ConvergenceError("no bracket of the value at the wall is proved to hold a base flow that settles: take more bits")
        return [s], radius, pieces, beyond

    def _settled(self, s: Any, bits: int) -> Any:
        """A place at which what is damped has fallen to so many bits: a choice. Raises ConvergenceError where there is none."""
        form, (state, sets), start, fallen = self.form, begun(self.form, [s], arb(0)), arb(0), 0.0
        for _ in range(FARTHEST_LAYER):
            piece = self.steps.step(start, state, sets)
            start, state, sets = start + piece.h, piece.middle, piece.sets
            at = FlowFields(form.flow, dict(zip(form.flow.states, map(acb, state), strict=True))).evaluator
            ((a, c),) = form.damping
            fallen += float((acb(state[form.carrier]) * at(a) + acb(at(c))).real.mid()) * float(piece.h)
            if fallen > bits * float(arb(2).log()):
                return start
        raise ConvergenceError("the base flow does not come to its limit, as far as it is enclosed: take more bits")

    def _above(self, s: Any, reach: Any) -> tuple[Any, Any]:
        """w − W and p there."""
        piece = self._passed(s, arb(0), reach)[-1]
        end = [around(y, r) for y, r in zip(piece.middle, piece.sets[0], strict=True)]
        return end[self.form.settling[0]] - ball(self.form.limits[0]), end[self.form.falling[0]]

    def _passed(self, s: Any, radius: Any, reach: Any) -> list[FlowPiece]:
        """The flow up to there."""
        (state, sets), pieces, start = begun(self.form, [s], radius), list[FlowPiece](), arb(0)
        while start < reach:
            piece = self.steps.step(start, state, sets, reach - start)
            pieces.append(piece)
            start, state, sets = start + piece.h, piece.middle, piece.sets
        return pieces
