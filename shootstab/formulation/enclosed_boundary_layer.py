"""A base flow that is a boundary layer (boundary_layer_form.py) in balls, at places and on series (lemmas E18, E19, E21 and E22)."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

from shootstab.core.balls import acb, arb, ctx
from shootstab.core.errors import ConvergenceError
from shootstab.formulation.boundary_layer_form import BoundaryLayerForm
from shootstab.formulation.enclosed_flow_steps import FlowPiece, around
from shootstab.formulation.flow_arrival import FlowArrival
from shootstab.formulation.flow_bracket import FlowBracket
from shootstab.formulation.flow_fields import FlowFields
from shootstab.formulation.flow_origin import FlowOrigin
from shootstab.formulation.system import shown
from shootstab.multiprecision.enclosable import ball
from shootstab.multiprecision.tailed_series import TailedSeries

PREMISE_BITS, PREMISE_DIGITS = 100, 17  # chosen: bits and digits of the flow's numbers in words


@dataclass(frozen=True, eq=False)
class LocatedFlow:
    """The flow at one working precision: free values with a radius, pieces from the wall on, and what is beyond them."""

    free: list[Any]
    radius: Any
    pieces: Sequence[FlowPiece]
    beyond: FlowArrival

    @property
    def reach(self) -> Any:
        """The length of all pieces, exact."""
        return self.pieces[-1].start + self.pieces[-1].h


class BoundaryLayerFlow:
    """See enclosed.FlowInBalls: the solution next to the one that doubles know."""

    def __init__(self, form: BoundaryLayerForm) -> None:
        self.form, self._origin = form, FlowOrigin(form) if form.pull is None else FlowBracket(form)
        self._known: dict[int, LocatedFlow] = {}

    @property
    def premise(self) -> str:
        """The flow in words."""
        with ctx.workprec(PREMISE_BITS):
            at = self.located
            numbers = [
                f"{shown(self.form.flow.states[i])} = {x.str(PREMISE_DIGITS, radius=False)}"
                for i, x in zip(self.form.free, at.free, strict=True)
            ]
            values = f"{' and '.join(numbers)} to {PREMISE_DIGITS - 1} digits at the wall"
            if isinstance(self._origin, FlowBracket):
                return f"a base flow with {values} exists{self._near(at)}, and for every such flow"
            if self.form.scaled:
                return f"for the only base flow, with {values},"
            within = 10.0 ** math.floor(math.log10(float(self._origin.alone)))
            return f"for the base flow with {values}, the only one within {within:.0e} of these values,"

    def _near(self, at: LocatedFlow) -> str:
        """Where a flow that is pulled to its limit stays next to it; others in the bracket, if there are any, are not spoken of."""
        (place,), distance = self.form.settling, 10.0 ** math.ceil(math.log10(float(at.beyond.moved)))
        limit = f"{shown(self.form.flow.states[place])} = {self.form.limits[0]}"
        return f" that stays within {distance:.0e} of {limit} from {float(self.reach):.4g} on"

    @property
    def located(self) -> LocatedFlow:
        """The flow at the working precision. Raises ConvergenceError where it is not enclosed."""
        if ctx.prec not in self._known:
            free, radius, pieces, beyond = self._origin.located()
            self._known[ctx.prec] = LocatedFlow(free, radius, pieces, beyond)
        return self._known[ctx.prec]

    @property
    def reach(self) -> Any:
        """The z from which on the flow is in a box, an arb."""
        return ball(self.form.wall) + self.located.reach

    def on(self, z: Any) -> Callable[[str, int], Any]:
        """The functions at z, an acb or a TailedSeries that is linear in t, by name and order."""
        flow, along = self.form.flow, isinstance(z, TailedSeries)
        state = self.state((z.c[0] if along else z).real - ball(self.form.wall))
        values: Sequence[Any] = [acb(x) for x in state]
        if along:
            step = z.c[1].real if len(z.c) > 1 else arb(0)
            found = self._origin.steps.series(state, step, z.terms)
            values = [TailedSeries([acb(0)], z.terms, arb.pos_inf())] * len(state) if found is None else found
        return FlowFields(flow, dict(zip(flow.states, values, strict=True))).on(z)

    def state(self, distance: Any) -> list[Any]:
        """The states at a distance from the wall, an arb, of which what is in front of the wall is no part.

        Raises ConvergenceError beyond the last piece.
        """
        at, found = self.located, list[list[Any]]()
        for piece in at.pieces:
            t = (distance - piece.start) / piece.h
            if t.upper() < 0 or t.lower() > 1:
                continue
            if piece is at.pieces[-1] and not t <= 1:
                raise ConvergenceError("the base flow is not enclosed so far from its wall")
            part = t if t >= 0 and t <= 1 else t.lower().max(arb(0)).union(t.upper().min(arb(1)))
            found.append([around(x.at(part).real, r) for x, r in zip(piece.fields, piece.spread, strict=True)])
        if not found:
            raise ConvergenceError("the base flow is not enclosed so far from its wall")
        out = found[0]
        for other in found[1:]:
            out = [x.union(y) for x, y in zip(out, other, strict=True)]
        return out
