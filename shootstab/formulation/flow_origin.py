"""The free values of a layer at its wall: one solution next to those that doubles know, and a ball that holds it (theory, lemma E21).

G(s) = w(∞; s) − W is analytic in the free values s, complex ones too. With |G(s) − G(c)| ≤ M for all s within R of c, Cauchy's estimate
gives what central differences of a width qR leave, M q²/(R(1 − q²)), and |∂²G| ≤ 2M/(R − ρ)² within ρ. With A next to the inverse of DG(c),
s ↦ s − A G(s) contracts by L there, and has a fixed point within |A G(s)|/(1 − L) of an s, one alone within ρ.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from shootstab.core.balls import acb, arb, arb_mat, ctx
from shootstab.core.errors import ConvergenceError
from shootstab.formulation.base_solution import solved
from shootstab.formulation.boundary_layer_form import BoundaryLayerForm
from shootstab.formulation.enclosed import on_balls
from shootstab.formulation.enclosed_flow_steps import FlowPiece, FlowSteps, around
from shootstab.formulation.flow_arrival import FlowArrival, arrival
from shootstab.multiprecision.enclosable import ball
from shootstab.multiprecision.tails import largest

FARTHEST_LAYER = 400  # chosen: steps after which a flow has not come to its limit
ORIGIN_BITS, ARRIVAL_BITS = 128, 100  # chosen: bits with which the contraction is found, and to which flows arrive for that
CENTRE_BITS, EXACT_BITS = 64, 1024  # chosen: bits of the values next to which the solution is, and with which they are moved exactly
WIDEST_FREE, NARROWER_FREE, NARROWEST_FREE = -12, 4, -60  # chosen: binary orders of R that are tried, and from one to the next
DIFFERENCE_ORDER, ALONE_ORDER = 20, 6  # chosen: binary orders of q, and of ρ/R to begin with
LEAST_CONTRACTION = 0.25  # chosen: an L below 1, so that a ball is not much wider than a step of Newton
SPARE_FLOW_BITS = 24  # chosen: bits, beyond those of D, to which the flow is known
ROUNDED_FLOW_BITS = 16  # chosen: bits beyond those, which the steps lose
ORIGIN_STEPS = 12  # chosen: steps of Newton's method, each of which gains some thirty bits


@dataclass(frozen=True, eq=False)
class Passage:
    """The flow from the wall on, in pieces, and its arrival; wide is that of all flows whose free values are within a radius."""

    pieces: list[FlowPiece]
    thin: FlowArrival
    wide: FlowArrival


class FlowOrigin:
    """The free values of one layer; its contraction is found when it is asked for first."""

    def __init__(self, form: BoundaryLayerForm) -> None:
        self.form, self.steps = form, FlowSteps(form)
        self._best: list[Any] = []
        self._contraction: tuple[list[Any], Any, Any, Any] | None = None

    def located(self) -> tuple[list[Any], Any, list[FlowPiece], FlowArrival]:
        """Exact free values s, a radius around them in which the solution lies, and all flows in it, in pieces and beyond them.

        It holds at the working precision. Raises ConvergenceError where none is proved to be there.
        """
        centre, A, L, rho = self._contracted()
        radius, small = arb(2) ** (ROUNDED_FLOW_BITS // 2 - ctx.prec - SPARE_FLOW_BITS), arb(2) ** (-ctx.prec - SPARE_FLOW_BITS)
        with ctx.workprec(ctx.prec + SPARE_FLOW_BITS + ROUNDED_FLOW_BITS):
            s = self._best or centre
            for _ in range(ORIGIN_STEPS):
                passage = self._passed(s, radius, small)
                move = _applied(A, passage.thin.defects)
                inside = largest([abs(x - c) for x, c in zip(s, centre, strict=True)]) + radius < rho
                if inside and largest([abs(x) for x in move]) / (1 - L) < radius:
                    return s, radius, passage.pieces, passage.wide
                s = self._best = [(x - d).mid() for x, d in zip(s, move, strict=True)]
        raise ConvergenceError("the values of the base flow at the wall are not enclosed: take more bits")

    @property
    def alone(self) -> Any:
        """A radius around the solution in which it is the only one."""
        return (self._contracted()[3] / 2).lower()

    def _contracted(self) -> tuple[list[Any], Any, Any, Any]:
        """c, A, L and ρ; ρ is so small that the solution is within ρ/2 of c."""
        if self._contraction is None:
            with ctx.workprec(CENTRE_BITS):
                centre = [(+arb(x)).mid() for x in solved(self.form.flow)[0].free]
            with ctx.workprec(ORIGIN_BITS):
                order = WIDEST_FREE
                while self._contraction is None:
                    try:
                        self._contraction = self._contracting(centre, arb(2) ** order)
                    except ConvergenceError:
                        order -= NARROWER_FREE
                        if order < NARROWEST_FREE:
                            raise
        return self._contraction

    def _contracting(self, centre: list[Any], R: Any) -> tuple[list[Any], Any, Any, Any]:
        m, q, small = len(centre), arb(2) ** -DIFFERENCE_ORDER, arb(2) ** -ARRIVAL_BITS
        about = self._passed([acb(x) for x in centre], R, small)
        M = largest([abs(acb(a - b)) for a, b in zip(about.wide.defects, about.thin.defects, strict=True)])
        left_out = arb(0, (M * q**2 / (R * (1 - q**2))).upper())
        columns = []
        for j in range(m):
            ends = [self._passed(_moved(centre, j, side * q * R), arb(0), small) for side in (1, -1)]
            apart = [(a - b) / (2 * q * R) for a, b in zip(*(end.thin.defects for end in ends), strict=True)]
            columns.append([acb(x).real + left_out for x in apart])
        DG = arb_mat([list(row) for row in zip(*columns, strict=True)])
        try:
            A = DG.mid().inv().mid()
        except ZeroDivisionError:
            raise ConvergenceError("the conditions of the base flow do not determine it next to this solution") from None
        rest, size = _norm(arb_mat([[int(i == j) for j in range(m)] for i in range(m)]) - A * DG), _norm(A)
        step = largest([abs(x) for x in _applied(A, [acb(x).real for x in about.thin.defects])])
        rho = R * arb(2) ** -ALONE_ORDER
        L = rest + size * m * m * rho * 2 * M / (R - rho) ** 2
        while not L < LEAST_CONTRACTION and rho > step:
            rho = rho / 2
            L = rest + size * m * m * rho * 2 * M / (R - rho) ** 2
        if not (L < LEAST_CONTRACTION and step / (1 - L) < rho / 2):
            raise ConvergenceError("the conditions of the base flow are not proved to determine it")
        return centre, A, L.upper(), rho.lower()

    def _passed(self, free: Sequence[Any], radius: Any, small: Any) -> Passage:
        """The flow with exact free values until it is so near to its limit. Raises ConvergenceError."""
        form, (state, sets), pieces, start = self.form, begun(self.form, free, radius), list[FlowPiece](), arb(0)

        while len(pieces) < FARTHEST_LAYER:
            piece = self.steps.step(start, state, sets)
            pieces.append(piece)
            start, state, sets = start + piece.h, piece.middle, piece.sets
            thin, wide = (arrival(form, [around(x, r) for x, r in zip(state, spread, strict=True)]) for spread in sets)
            if thin is not None and wide is not None and thin.moved < small:
                return Passage(pieces, thin, wide)
        raise ConvergenceError("the base flow does not come to its limit, as far as it is enclosed: take more bits")


def begun(form: BoundaryLayerForm, free: Sequence[Any], radius: Any) -> tuple[list[Any], list[list[Any]]]:
    """The state at the wall, exact, and two sets about it: what else is known of it, and free values within a radius."""
    assert all(x.is_exact() for x in free)
    at, given = on_balls(acb(ball(form.wall)), {}), dict(zip(form.free, free, strict=True))
    first = [given[i] if i in given else acb(at(form.fixed[i])).real for i in range(len(form.flow.states))]
    state = [acb(x.mid()) if isinstance(free[0], acb) else x.mid() for x in first]
    known = [(arb(0) if i in given else x.rad()) for i, x in enumerate(first)]
    return state, [known, [radius if i in given else x for i, x in enumerate(known)]]


def _moved(free: Sequence[Any], j: int, step: Any) -> list[Any]:
    """The values with the j-th one moved, exactly."""
    with ctx.workprec(EXACT_BITS):
        return [x + step if i == j else x for i, x in enumerate(free)]


def _applied(A: Any, x: Sequence[Any]) -> list[Any]:
    return [row[0] for row in (A * arb_mat([[acb(value).real] for value in x])).tolist()]


def _norm(A: Any) -> Any:
    return largest([sum((abs(x) for x in row), arb(0)) for row in A.tolist()])
