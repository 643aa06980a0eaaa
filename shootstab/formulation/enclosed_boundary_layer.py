"""A boundary layer f‴ = −c f f″, f = f′ = 0 at a wall and f′ → U at infinity, in balls: no shooting (theory, lemma E18).

If g solves the equation with g = g′ = 0, g″ = 1 at the wall, so does f(y) = A g(Ay), and f′ → A² g′(∞): A = (U/g′(∞))^{1/2} (Töpfer 1912).
g‴ = −c g g″ has g″ > 0, and g and g′ rise. Beyond an η_L at which c g(η_L)² ≥ g′(∞)

    0 ≤ g′(∞) − g′ ≤ g″/(c g),   0 ≤ −g‴ ≤ c g(η_L) g″(η_L).
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from typing import Any

from shootstab.core.balls import acb, acb_mat, arb, ctx
from shootstab.core.errors import ConvergenceError
from shootstab.formulation.base_flow import BaseFlow, fixed_at_origin, of_state
from shootstab.formulation.enclosed import NOWHERE, on_balls
from shootstab.formulation.state_pencil import StatePencil
from shootstab.formulation.system import Jet
from shootstab.multiprecision.decaying_graph import decaying_rows, graph
from shootstab.multiprecision.enclosable import ball
from shootstab.multiprecision.minors import at_sigma, minors, solved
from shootstab.multiprecision.tailed_series import TailedSeries

FLOW_BITS, SPARE_FLOW_BITS = 3.5, 24  # chosen: bits that a term of a step gains, from which their number follows; bits beyond those of D
FLOW_STEP = Fraction(1, 4)  # chosen: the length of a step of g; its nearest singular point is 3.9 away from the wall for c = 1/2
FARTHEST_LAYER = 400  # chosen: steps after which g″ has not died away
PREMISE_BITS, PREMISE_DIGITS = 100, 17  # chosen: bits and digits of the flow's number in words
TAIL_TRIES = 30  # chosen: attempts at a tail that maps into itself, each two times as large
THREE = 3  # derived: f, f′ and f″


class BoundaryLayerFlow:
    """U = f′ and its derivatives."""

    def __init__(self, name: str, c: Fraction, wall: Fraction, speed: Fraction) -> None:
        self.name, self.c, self.wall, self.speed = name, c, wall, speed
        self._known: dict[int, tuple[list[list[Any]], Any, Any]] = {}

    @property
    def premise(self) -> str:
        """The flow in words."""
        with ctx.workprec(PREMISE_BITS):
            _, A, _ = self._mesh()
            curvature = (A**THREE).str(PREMISE_DIGITS, radius=False)
        return f"for the only base flow, with d({self.name},2) = {curvature} to {PREMISE_DIGITS - 1} digits at the wall,"

    @property
    def reach(self) -> Any:
        """y_L, from which on the flow is in a box, an arb."""
        states, A, _ = self._mesh()
        return ball(self.wall) + (len(states) - 1) * ball(FLOW_STEP) / A

    @property
    def far(self) -> FarFlow:
        """Balls that hold f′, f″ and f‴ for every y ≥ y_L."""
        states, A, _ = self._mesh()
        g, _, second = states[-1]
        third = ball(self.c) * g * second
        U, least, most = ball(self.speed), (second / (ball(self.c) * g) * A**2).upper(), (A**THREE * second).upper()
        fourth = (A**4 * third).upper()
        found = (U - least).union(U), arb(0).union(most), (-fourth).union(arb(0))
        return FarFlow(self.name, {(self.name, order): acb(x) for order, x in enumerate(found, 1)})

    def on(self, z: Any) -> Callable[[str, int], Any]:
        """The derivatives at z, an acb or a TailedSeries that is linear in t, as functions of name and order."""
        series = self._along(z)

        def given(name: str, order: int) -> Any:
            if order >= len(series):
                raise ConvergenceError(f"d({name},{order}) of the base flow is not enclosed")
            return series[order]

        return given

    def _along(self, z: Any) -> list[Any]:
        """f, f′, f″ and f‴."""
        _, A, _ = self._mesh()
        thick = not isinstance(z, TailedSeries)
        here, step = (z.real, arb(0)) if thick else (z.c[0].real, z.c[1].real if len(z.c) > 1 else arb(0))
        eta, h = A * (here - ball(self.wall)), A * step
        state = self._at(eta)
        values: list[Any] = [acb(x) for x in state]
        if not thick:
            found = advanced(state, h, z.terms, self.c)
            values = found if found is not None else [TailedSeries([acb(0)], z.terms, arb.pos_inf())] * THREE
        g, g1, g2 = values
        powers = [acb(A**m) for m in range(1, THREE + 2)]
        return [x * power for x, power in zip((g, g1, g2, g * g2 * acb(-ball(self.c))), powers, strict=True)]

    def _at(self, eta: Any) -> list[Any]:
        """g, g′, g″ at a place."""
        states, _, _ = self._mesh()
        j = min(max(int(float(eta.mid()) / float(FLOW_STEP)), 0), len(states) - 1)
        off = eta - j * ball(FLOW_STEP)
        if off.is_zero():
            return states[j]
        found = advanced(states[j], off, _terms(), self.c)
        if found is None:
            raise ConvergenceError("the base flow is not enclosed there")
        return [x.at(1).real for x in found]

    def _mesh(self) -> tuple[list[list[Any]], Any, Any]:
        """g, g′, g″ at the ends of steps, A and g′(∞), at the working precision."""
        if ctx.prec not in self._known:
            states, c, small = [[arb(0), arb(0), arb(1)]], ball(self.c), arb(2) ** -(ctx.prec + SPARE_FLOW_BITS)
            with ctx.workprec(3 * (ctx.prec + SPARE_FLOW_BITS)):
                while True:
                    found = advanced(states[-1], ball(FLOW_STEP), _terms(), self.c)
                    if found is None or len(states) > FARTHEST_LAYER:
                        raise ConvergenceError("the base flow is not enclosed: take more bits")
                    states.append([x.at(1).real for x in found])
                    g, g1, g2 = states[-1]
                    if g > 0 and g2 / (c * g) < small and c * g * g > g1 + g2 / (c * g):
                        break
                if not g2 > 0:
                    raise ConvergenceError("the base flow is not enclosed: take more bits")
                limit = g1 + arb(0).union(g2 / (c * g))
                A = (ball(self.speed) / limit).sqrt()
            self._known[ctx.prec] = [[+x for x in state] for state in states], +A, +limit
        return self._known[ctx.prec]


class LayerEnd:
    """See enclosed.DecayingEnd: the end at infinity of a system whose coefficients are functions of the flow alone; it is left at y_L."""

    lemmas = ("E17", "E18")
    inwards = False

    def __init__(self, flow: BoundaryLayerFlow, system: StatePencil, decaying: int, reference: complex) -> None:
        self._flow, self._system, self.decaying, self._reference = flow, system, decaying, acb(reference)

    @property
    def place(self) -> Any:
        """The y_L, an arb."""
        return self._flow.reach

    @property
    def multiple(self) -> tuple[Any, ...]:
        """The bits by which y_L is settled, and the rows over which the decaying space is a graph."""
        return ctx.prec, self._rows

    def minors(self, sigma: Any) -> list[Any]:
        """The minors of the decaying solutions there. Raises ConvergenceError where they are not enclosed."""
        n, rows = self._system.size, self._rows
        A = [[TailedSeries([x], 1) for x in row] for row in self._matrix(sigma).tolist()]
        X = graph(A, rows, lambda f: f * 0, 1).tolist()
        others = [i for i in range(n) if i not in rows]
        return minors([[acb(int(i == j)) for j in rows] if i in rows else X[others.index(i)] for i in range(n)], self.decaying)

    @cached_property
    def _rows(self) -> tuple[int, ...]:
        return decaying_rows(self._matrix(self._reference), self.decaying)

    def _matrix(self, sigma: Any) -> Any:
        """C⁻¹D for all y ≥ y_L."""
        at = on_balls(NOWHERE, {}, self._flow.far)
        C, D = ([{place: at(entry) for place, entry in part.items()} for part in powers] for powers in (self._system.C, self._system.D))
        n, A = self._system.size, solved(self._system.size, at_sigma(C, sigma), at_sigma(D, sigma))
        return acb_mat([[A.get((i, j), acb(0)) for j in range(n)] for i in range(n)])


@dataclass(frozen=True)
class FarFlow:
    """The flow beyond y_L, in balls that hold all of it."""

    name: str
    values: Mapping[Jet, Any]

    def on(self, z: Any) -> Callable[[str, int], Any]:
        """Its functions by name and order; f itself grows, and is no number."""
        return lambda name, order: self.values.get((name, order), NOWHERE)


def advanced(state: list[Any], h: Any, terms: int, c: Fraction) -> list[TailedSeries] | None:
    """g, g′, g″ in t on |t| ≤ 1 from their values at t = 0, dη = h dt; None where no tail is found (lemma C1)."""
    factor = -ball(c)
    a = [[x] for x in state]
    for m in range(terms - 1):
        product = sum((a[0][j] * a[2][m - j] for j in range(m + 1)), arb(0))
        step = h / (m + 1)
        for series, slope in zip(a, (a[1][m], a[2][m], factor * product), strict=True):
            series.append(step * slope)
    last = sum((a[0][j] * a[2][terms - 1 - j] for j in range(terms)), arb(0)) * factor
    size, tails = abs(h) / terms, [arb(0)] * THREE
    for _ in range(TAIL_TRIES):
        g, g1, g2 = (TailedSeries([acb(x) for x in series], terms, tail, real=True) for series, tail in zip(a, tails, strict=True))
        product = (g * g2) * acb(factor)
        bounds = [size * (abs(a[1][-1]) + g1.tail), size * (abs(a[2][-1]) + g2.tail), size * (abs(last) + product.tail)]
        if all(bound <= tail for bound, tail in zip(bounds, tails, strict=True)):
            return [g, g1, g2]
        tails = [(2 * bound).upper() for bound in bounds]
    return None


def _terms() -> int:
    return int(ctx.prec / FLOW_BITS) + SPARE_FLOW_BITS // 2


def boundary_layer_flow(flow: BaseFlow) -> BoundaryLayerFlow | None:
    """The flow in balls, where it is of this kind; otherwise None."""
    if len(flow.unknowns) != 1 or len(flow.states) != THREE or len(flow.ends) != 1:
        return None
    name, ((direction, end),) = flow.unknowns[0], flow.ends
    fixed, others = fixed_at_origin(flow)
    c = _ratio(flow)
    if c is None or not c > 0 or direction < 0 or end.at is not None or others or flow.origin.at is None:
        return None
    if set(fixed) != {0, 1} or any(value.constant is None or value.constant for value in fixed.values()):
        return None
    speed = _limit(flow, end.conditions)
    return None if speed is None or not speed > 0 else BoundaryLayerFlow(name, c, flow.origin.at, speed)


def _ratio(flow: BaseFlow) -> Fraction | None:
    """The c of f‴ = −c f f″."""
    f, _, second = (of_state(state) for state in flow.states)
    ratio = (flow.slopes[2] / (f * second)).constant
    return None if ratio is None or ratio.im else -Fraction(ratio.re)


def _limit(flow: BaseFlow, conditions: tuple[Any, ...]) -> Fraction | None:
    """U of the one condition f′ = U."""
    if len(conditions) != 1:
        return None
    rest = (of_state(flow.states[1]) - conditions[0]).constant
    opposite = (of_state(flow.states[1]) + conditions[0]).constant
    found = rest if rest is not None else opposite
    return None if found is None or found.im else Fraction(found.re)
