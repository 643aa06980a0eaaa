"""Perturbations of a layer from where it has come to its limit down to a wall, in balls (theory, lemmas E17 and E19)."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from fractions import Fraction
from functools import cached_property
from typing import Any

from shootstab.core.balls import acb, acb_mat, arb, ctx
from shootstab.core.errors import ConvergenceError
from shootstab.formulation.enclosed import NOWHERE, on_balls
from shootstab.formulation.enclosed_boundary_layer import BoundaryLayerFlow
from shootstab.formulation.expression import Expression
from shootstab.formulation.state_pencil import Powers, StatePencil
from shootstab.multiprecision.arithmetic import Matrix
from shootstab.multiprecision.decaying_graph import decaying_rows, graph
from shootstab.multiprecision.enclosable import ball
from shootstab.multiprecision.frame_enclosure import FrameEnclosure
from shootstab.multiprecision.mapped_tails import change, following
from shootstab.multiprecision.minors import at_sigma, solved
from shootstab.multiprecision.tailed_pencil import BALLS, SOLUTION_CONTRACTION, TailedPencil
from shootstab.multiprecision.tailed_series import TailedSeries, variable

LAYER_LEMMAS = ("C1", "E3", "E4", "E8", "E11", "E17", "E19", "E21", "E22")  # lemmas of the guide's page on proofs
LAYER_OUTER, LAYER_POINTS = 2.0**-4, 40  # chosen: see Enclosable; a value of D takes a second
PATH_BITS, SPARE_PATH_TERMS = 2.0, 12  # chosen: bits that a term of a step gains, from which their number follows; terms beyond those
FIRST_PATH_PART, SHORTEST_PATH_PART = 2.0**-4, 2.0**-16  # chosen: first step tried, and one too short, in the whole way
REGION_SPARE, BITS_SPARE = 1.25, 1.5  # chosen: region and bits for which an enclosure serves, over those asked for


class BoundaryLayerPath:
    """See multiprecision.frame_enclosure.EnclosedPath."""

    def __init__(self, problem: BoundaryLayerEnclosable, regions: Sequence[Any]) -> None:
        self._problem, self.size, self.decaying = problem, problem.system.size, problem.decaying
        self.steps: Sequence[TailedPencil] = self._steps(regions)

    @property
    def multiple(self) -> tuple[Any, ...]:
        """The bits by which the place is settled where the path begins, and the rows over which the decaying space is a graph."""
        return ctx.prec, self._rows

    def far(self, sigma: Any) -> Matrix:
        """The decaying space where the flow is in a box from there on."""
        n, rows = self.size, self._rows
        A = [[TailedSeries([x], 1) for x in row] for row in self._matrix(sigma).tolist()]
        X = graph(A, rows, lambda f: f * 0, 1).tolist()
        others = [i for i in range(n) if i not in rows]
        return [[acb(int(i == j)) for j in rows] if i in rows else X[others.index(i)] for i in range(n)]

    def wall(self, sigma: Any) -> Matrix:
        problem = self._problem
        at = on_balls(acb(ball(problem.left)), {}, problem.flow)
        rows = [[acb(0)] * self.size for _ in range(self.decaying)]
        for power, part in enumerate(problem.system.left):
            for (i, j), entry in part.items():
                rows[i][j] = rows[i][j] + acb(at(entry)) * sigma**power
        return rows

    @property
    def singular(self) -> Sequence[Any]:
        """Nothing known beforehand: where C is singular is seen on the way."""
        return ()

    def analytic(self, sigma: Any) -> bool:
        """Whether C is invertible on the way, and the decaying space enclosed, for the whole ball σ."""
        try:
            self.far(sigma)
            return all(y.is_finite() for step in self.steps for y in step.on_cell(sigma, arb(0), arb(1)).values())
        except ConvergenceError:
            return False

    @cached_property
    def _rows(self) -> tuple[int, ...]:
        return decaying_rows(self._matrix(self._problem.reference), self.decaying)

    def _matrix(self, sigma: Any) -> Any:
        """C⁻¹D for all z beyond."""
        C, D = (_evaluated(on_balls(NOWHERE, {}, self._problem.flow.located.beyond), powers) for powers in self._problem.pencil)
        n, A = self.size, solved(self.size, at_sigma(C, sigma), at_sigma(D, sigma))
        return acb_mat([[A.get((i, j), acb(0)) for j in range(n)] for i in range(n)])

    def _steps(self, regions: Sequence[Any]) -> list[TailedPencil]:
        """Steps from the end of the flow's pieces to the wall, each as long as its contraction lets it be."""
        problem = self._problem
        place, end = problem.flow.located.reach, ball(problem.left - problem.flow.form.wall)
        whole = float((place - end).mid())
        length = FIRST_PATH_PART * whole
        out = list[TailedPencil]()
        while True:
            left = float((place - end).mid())
            last = length >= left
            h = end - place if last else -arb(length)
            step = self._step(ball(problem.flow.form.wall) + place, h)
            reached = math.inf if step is None else max(step.contraction(region) for region in regions) / _allowed(step.terms)
            if step is not None and reached <= 1.0:
                out.append(step)
                if last:
                    return out
                place, length = place + h, min(length * following(reached), 0.75 * left if 0.75 * left > length else left)
            else:
                length = min(length, left) * change(reached)
                if length < SHORTEST_PATH_PART * whole:
                    raise ConvergenceError("no step is short enough for an enclosure along the base flow: the coefficients are singular")

    def _step(self, z: Any, h: Any) -> TailedPencil | None:
        """C dψ/dt = h D ψ; None where the base flow is not enclosed on it."""
        terms = math.ceil(ctx.prec / PATH_BITS) + SPARE_PATH_TERMS
        at = on_balls(variable(acb(z), acb(h), terms), {}, self._problem.flow)
        nothing = TailedSeries([acb(0)], terms, real=True)
        C, D = (_evaluated(lambda entry: nothing + at(entry), powers) for powers in self._problem.pencil)
        D = [{place: y * h for place, y in part.items()} for part in D]
        if not all(y.tail.is_finite() for parts in (C, D) for part in parts for y in part.values()):
            return None
        return TailedPencil(self.size, C, D, terms)


class BoundaryLayerEnclosable:
    """See multiprecision.enclosable.Enclosable: perturbations on the half line to the right of a place left, whose conditions stand in
    the system; reference is an eigenvalue without any property, with as many decaying solutions.
    """

    outer: float = LAYER_OUTER
    most_points: int = LAYER_POINTS

    def __init__(self, flow: BoundaryLayerFlow, system: StatePencil, left: Fraction, decaying: int, reference: complex) -> None:
        self.flow, self.system, self.left, self.decaying, self.reference = flow, system, left, decaying, acb(reference)
        self._kept: tuple[int, list[Any], FrameEnclosure] | None = None

    @property
    def lemmas(self) -> tuple[str, ...]:
        """The lemmas, with that of the scaling where it makes the flow the only one."""
        if self.flow.form.pull is not None:
            return (*(name for name in LAYER_LEMMAS if name != "E21"), "E23")
        return (*LAYER_LEMMAS, *(("E18",) if self.flow.form.scaled else ()))

    @property
    def premise(self) -> str:
        """The flow."""
        return self.flow.premise

    @property
    def pencil(self) -> tuple[Powers, Powers]:
        """C and D by powers of σ."""
        return self.system.C, self.system.D

    def enclosure(self, bits: int, *regions: Any) -> FrameEnclosure:
        """D at so many bits for σ in some balls. Raises ConvergenceError where there is none."""
        if self._kept is not None:
            known, about, found = self._kept
            if bits <= known <= BITS_SPARE * bits and all(any(x.contains(region) for x in about) for region in regions):
                return found
        with BALLS.working(1), ctx.workprec(bits):
            about = [_roomy(acb(region)) for region in regions or (self.reference,)]
            self._kept = bits, about, FrameEnclosure(BoundaryLayerPath(self, about), False)
        return self._kept[2]


def _allowed(terms: int) -> float:
    """The contraction with which (ρh)^N/N!, what the terms leave out in units of e^{ρh}, is below rounding, about; 1 at most."""
    reach = terms / (math.e * math.exp(math.log(2) * ctx.prec / terms))
    return min(1.0, reach / (SOLUTION_CONTRACTION * terms))


def _evaluated(at: Callable[[Expression], Any], powers: Powers) -> list[Mapping[tuple[int, int], Any]]:
    return [{place: at(entry) for place, entry in part.items()} for part in powers]


def _roomy(region: Any) -> Any:
    """A ball about the same middle with room."""
    room = arb(0, REGION_SPARE * abs(region - region.mid()).upper())
    return acb(region.real.mid() + room, region.imag.mid() + room)
