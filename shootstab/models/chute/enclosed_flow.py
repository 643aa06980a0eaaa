"""The steady chute flow enclosed: balls for its terms, bounds for what is left out, and a base of which there is one only.

The recurrences are those of many digits (multiprecision_flow.py). With y = Σ y_m t^m on a step, m y_m = h f(y)_{m−1}. For tails
r = Σ_{m≥N} |y_m| the map y ↦ y(0) + h ∫ f(y) takes {r} into itself where

    (|h|/N) (|f_{N−1}| + τ_f(r)) ≤ r,

τ_f being the tail of f on series with these tails, and has a fixed point there: the solution (theory, lemma C1). In the far field x d/dx
stands for d/dt, and (1/N) τ_f(r) ≤ r is asked for, with 1/(N + 1) for Q.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

from shootstab.core.balls import arb, ctx
from shootstab.core.errors import ConvergenceError
from shootstab.core.series import Series
from shootstab.models.chute.balance import slopes
from shootstab.models.chute.flow_set import FlowDerivative, FlowSet, TailedFields
from shootstab.models.chute.multiprecision_flow import Descent, FlowAtBase, energy_defect, far_series
from shootstab.models.chute.parameters import Chute
from shootstab.multiprecision.flint_backend import FlintArithmetic
from shootstab.multiprecision.mapped_tails import change, following, tailed
from shootstab.multiprecision.settings import Settings
from shootstab.multiprecision.tailed_series import NO_TAIL, TailedSeries

SHORTEST_PART, SMALLEST_START = 2.0**-12, 2.0**-48  # chosen: where attempts at a step, and at a start of the far field, end
LAST_STEP_OVER = 1.05  # chosen: the last step over the way to the base, which lies inside it
BASE_ITERATIONS = 12  # chosen: Newton steps to the base, each of which doubles its digits
BASE_ROOM = 16.0  # chosen: half width of the interval searched for the base over the step of Newton's iteration
SHOWN_ROOM = 2.0  # chosen: radii about its ν0 within which the base is alone; printed in decimals, a ball is wider by a tenth of one
NO_BASE = "the base of the flow cannot be enclosed: take more bits, unless its energy condition is met by grazing"
DERIVATIVE_BITS, DERIVATIVE_TERMS = 64, 32  # chosen: the flow map's derivative is asked for in a few digits
CELLS, CELL_DEPTH = 4, 6  # chosen: cells of a step in which the energy condition is looked at, and how often one is halved

Slopes = Callable[[Any, Any, Any, Any], Sequence[Any]]


@dataclass(frozen=True, eq=False)
class Piece:
    """The flow on a step downwards: fields as series in t, 0 ≤ t ≤ 1, with z = z_0 + h t, h < 0 a ball."""

    h: Any
    fields: TailedFields

    def at(self, t: Any) -> list[Any]:
        """The fields at t, a ball in [0, 1], as balls."""
        return [y.at(t).real for y in self.fields]


@dataclass(frozen=True, eq=False)
class EnclosedFlow:
    """A flow for every T_∞ in a ball: far fields as series in ν0/start, pieces from there to the base, and what holds at the base.

    first says whether the energy condition was proved to hold nowhere between the start of the pieces and the base. depth is that of the
    base below the start; alone is a pair of depths between which, for every T_∞ in the ball, it holds at the base only.
    """

    chute: Chute
    far_temperature: Any
    start: Any
    far: TailedFields
    pieces: tuple[Piece, ...]
    base: FlowAtBase
    first: bool
    depth: Any
    alone: tuple[Any, Any]

    def same_base(self, other: EnclosedFlow) -> bool:
        """Whether the base of one of these flows, enclosed from the same start, is proved to be the one enclosed here."""
        low, high = self.alone
        return bool(self.start == other.start and low < other.depth and other.depth < high)


class EnclosedDescent:
    """The flow of the chute that decays to T_∞, a ball, on its way down."""

    def __init__(self, chute: Chute, far_temperature: Any, settings: Settings) -> None:
        """chute: its parameters as balls."""
        self._arithmetic = FlintArithmetic(radii=True)
        self._chute, self._far_temperature, self._settings = chute, far_temperature, settings

    def far(self, start: float, contraction: Callable[[TailedFields], float] = lambda fields: 0.0) -> tuple[Any, TailedFields]:
        """The start ν0, or a smaller one at which the series hold and their contraction is 1 at most, and these series."""
        N = self._settings.far_terms
        terms = far_series(self._arithmetic, self._chute, self._far_temperature, N)
        nu = arb(start)
        while nu > SMALLEST_START:
            found = tailed(terms, nu, self._needed_far)
            reached = math.inf if found is None else contraction(found)
            if found is not None and reached <= 1.0:
                return nu, found
            nu = (nu * change(reached)).mid()
        raise ConvergenceError(f"no volume fraction above {SMALLEST_START:.1e} is small enough for an enclosure of the far field")

    def descend(self, nu: Any, far: TailedFields, length: float, contraction: Callable[[Piece], float] = lambda piece: 0.0) -> EnclosedFlow:
        """The flow from a volume fraction down to its base, which doubles see so far below, in pieces with a contraction of 1 at most."""
        chute, part = self._chute, 1.0
        pieces: list[Piece] = []
        here = FlowSet.about([y.at(1).real for y in far])
        left, first = length, True
        while True:
            series, natural = Descent(self._arithmetic, chute, self._settings, here.middle, left).expand()
            while True:
                reach = natural * part
                last = LAST_STEP_OVER * left < reach
                h = arb(-LAST_STEP_OVER * left if last else -min(reach, 0.75 * left))
                found = self._carried(here, series, h)
                reached = math.inf if found is None else contraction(found[0])
                if found is not None and reached <= 1.0:
                    break
                part *= change(reached)
                if part < SHORTEST_PART:
                    raise ConvergenceError("no step is short enough for an enclosure along the steady flow")
            piece, there = found
            if last:
                t, box, steady = _base(chute, piece, left / abs(float(h.mid())))
                end = _up_to(piece, t)
                state = end.at(1)
                base = Descent(self._arithmetic, chute, self._settings, state, 0.0).at_base()
                above = sum((-piece.h for piece in pieces), arb(0))
                alone = (above - h * box.lower()).upper(), (above - h * box.upper()).lower()
                every = (*pieces, end)
                return EnclosedFlow(chute, self._far_temperature, nu, far, every, base, first and steady, above - h * t, alone)
            first = first and _not_met(chute, piece.at, arb(0))
            pieces.append(piece)
            part = min(1.0, part * following(reached))
            here = there
            left += float(h.mid())

    def step(self, here: FlowSet, h: Any) -> tuple[Piece, FlowSet] | None:
        """A step of a length h < 0 of all flows of a set, and the set at its end; None where it is too long."""
        series, _ = Descent(self._arithmetic, self._chute, self._settings, here.middle, 0.0).expand()
        return self._carried(here, series, h)

    def _carried(self, here: FlowSet, series: Sequence[Sequence[Any]], h: Any) -> tuple[Piece, FlowSet] | None:
        """A step of all flows of a set, from the terms of the one in its middle, and the set at its end; None where it is too long."""
        thin = tailed(series, h, partial(self._needed, h))
        if thin is None:
            return None
        with ctx.workprec(DERIVATIVE_BITS):
            few = replace(self._settings, order=min(self._settings.order, DERIVATIVE_TERMS))
            rough, _ = Descent(self._arithmetic, self._chute, few, here.hull, 0.0).expand()
            fields = tailed(rough, h, partial(self._needed, h))
            derivative = None if fields is None else FlowDerivative.along(self._chute, fields, h)
        if derivative is None:
            return None
        return Piece(h, here.spread(thin, derivative)), here.carried(thin, derivative)

    def _needed_far(self, fields: TailedFields) -> list[Any]:
        nu, _, u, Q, _ = fields
        N = nu.terms
        decay, T_x, u_x, Q_x = _slopes_of(self._chute, fields)
        rates = T_x / decay, u_x / decay, Q_x / decay + Q, nu * u / decay  # x d/dx of T, u, Q and, up to its sign, Φ
        return [NO_TAIL, *(f.tail / (N + (i == 2)) for i, f in enumerate(rates))]

    def _needed(self, h: Any, fields: TailedFields) -> list[Any]:
        nu, _, u, *_ = fields
        N = nu.terms
        decay, T_z, u_z, Q_z = _slopes_of(self._chute, fields)
        return [abs(h) / N * f.beyond()[min(N - 1, len(f.c))] for f in (nu * decay, T_z, u_z, Q_z, -(nu * u))]


def _slopes_of(chute: Chute, state: Sequence[Any]) -> Any:
    """(ν′/ν, T′, u′, Q′) at a state."""
    nu, T, _, Q, *_ = state
    return slopes(nu, T, Q, chute.ep, chute.tan_theta, chute.radial_law, arb.pi())


def _defect(chute: Chute, state: Sequence[Any]) -> Series:
    """The defect of the energy condition and its derivative along z, at a state."""
    nu, T, _, Q, *_ = state
    decay, T_z, _, Q_z = _slopes_of(chute, state)
    found: Series = energy_defect(chute, Series((nu, nu * decay)), Series((T, T_z)), Series((Q, Q_z)), arb.pi())
    return found


def _not_met(chute: Chute, at: Callable[[Any], list[Any]], low: Any) -> bool:
    """Whether the defect is seen to be negative for all t in (low, 1], cell by cell."""
    cells = [(low + (1 - low) * arb(i) / CELLS, low + (1 - low) * arb(i + 1) / CELLS, 0) for i in range(CELLS)]
    while cells:
        a, b, depth = cells.pop()
        state = at(a.union(b))
        # Q/p and the slip have their limits at ν0 = 0, but the wall's shear function does not: 5/(8 ν g0)
        value = _defect(chute, state)[0] if state[0] > 0 else arb.nan()
        if value < 0:
            continue
        if depth == CELL_DEPTH:
            return False
        cells += [(a, (a + b) / 2, depth + 1), ((a + b) / 2, b, depth + 1)]
    return True


def _base(chute: Chute, piece: Piece, near: float) -> tuple[Any, Any, bool]:
    """t of the base, a ball in which the energy condition is met exactly once, and a wider one in which it is met there only.

    Volume fractions in decimals tell the bases in the wider one apart. Third, whether the condition is met nowhere before on the piece.
    """
    t = arb(near)
    change = arb(1)
    for _ in range(BASE_ITERATIONS):
        defect = _defect(chute, piece.at(t))
        change = (defect[0] / _slope(defect, piece)).mid()
        t = (t - change).mid()
    value, h = _defect(chute, piece.at(t)), piece.h
    width = (BASE_ROOM * abs(value[0] / (value[1] * h))).upper()
    box = t + arb(0, width)
    if not (box > 0 and box < 1):  # the tails bound nothing beyond t = 1
        raise ConvergenceError(NO_BASE)
    inside = piece.at(box)
    rate = _defect(chute, inside)[1] * h
    found = t - value[0] / rate
    a, b, nu = (piece.at(x)[0] for x in (box.lower(), box.upper(), found))
    shown = nu + arb(0, SHOWN_ROOM * nu.rad())
    one_way = not _slopes_of(chute, inside)[0].contains(0)  # along the box ν0 rises or falls
    if not (box.contains(found) and one_way and ((a < shown and shown < b) or (b < shown and shown < a))):
        raise ConvergenceError(NO_BASE)
    return found, box, _rises_to(chute, piece, found)


def _slope(defect: Series, piece: Piece) -> Any:
    return defect[1] * piece.h


def _rises_to(chute: Chute, piece: Piece, t: Any) -> bool:
    """Whether the defect is negative on [0, t) of a piece: cells in which it is seen to be so, then cells in which it rises."""
    cells = [(t.upper() * i / 2**CELL_DEPTH, t.upper() * (i + 1) / 2**CELL_DEPTH) for i in range(2**CELL_DEPTH)]
    rising = False
    for a, b in cells:
        defect = _defect(chute, piece.at(a.union(b)))
        if not rising and defect[0] < 0:
            continue
        rising = True
        if not defect[1] * piece.h > 0:
            return False
    return True


def _up_to(piece: Piece, t: Any) -> Piece:
    """The part of it from 0 to t ≤ 1, a ball, with t = 1 at its end."""
    fields = []
    for y in piece.fields:
        c, power = [], arb(1)
        for x in y.c:
            c.append(x * power)
            power = power * t
        fields.append(TailedSeries(c, y.terms, y.tail, True))
    return Piece(piece.h * t, tuple(fields))
