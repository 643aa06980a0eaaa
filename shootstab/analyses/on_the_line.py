"""A solution on the user's line: over z and in the user's state, whatever subdomains and subsystems it was integrated in."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray

from shootstab.core.errors import ConvergenceError, InputError
from shootstab.discriminants.back_substitution import Solution
from shootstab.discriminants.subsystems import Subsystem
from shootstab.problems.protocol import ComplexArray, Problem
from shootstab.problems.unknowns import InnerSpace, Placement, Unknowns, placements

# chosen: lengths of the integration beyond it at which a decaying space that is known all the way is asked for; at one of them a solution
# of a wall may go on by chance, as sin πz does to z = −1
FARTHER = (0.618, 1.0)
INNER_SAMPLES = 24  # chosen: points between a singular end and where the integration begins at which the largest value is looked for
OUTSIDE = 1e-9  # chosen: part of the domain by which a z given as a decimal may miss its ends


@dataclass(frozen=True, eq=False)
class OnTheLine:
    """The solution of the problem, of which solution.problem is a subsystem or the whole.

    Where two subdomains meet, values are those of the left one. Between an end and where the integration begins they are the solutions that
    the end's space knows there, with the coefficients of the beginning. Where the problem knows its decaying space farther out than the
    integration begins, z may go on there.
    """

    problem: Problem
    solution: Solution
    _farther: dict[int, Solution] = field(default_factory=dict, repr=False)  # the one that reaches farthest, of those that were needed

    def right(self, z: NDArray[np.float64]) -> ComplexArray:
        """φ (m, n) at z (m,). Raises InputError for z outside the domain."""

        def along(placement: Placement, part: Solution, t: ComplexArray) -> ComplexArray:
            return placement.right(_of_whole(part, part.at(t)), t)

        z = self._inside(z, *self.allowed)
        out = np.zeros((len(z), self.placements[0].size), dtype=np.complex128)
        inside = np.zeros(len(z), dtype=bool)
        for placement, space in self._inner_spaces:
            own = self._nearer_than_begun(placement, space, z)
            if own.any():
                out[own] = self._inner(placement, space, z[own])
            inside |= own
        out[~inside] = self._gathered(z[~inside], along)
        return out

    def left(self, z: NDArray[np.float64]) -> ComplexArray:
        """y (m, n), for integrals over rising z. Raises InputError for z outside the domain."""

        def whole(part: Solution, t: ComplexArray) -> ComplexArray:
            rows = part.left_at(t)
            return part.problem.left_of_whole(rows) if isinstance(part.problem, Subsystem) else rows

        def along_z(placement: Placement, part: Solution, t: ComplexArray) -> ComplexArray:
            turn = -1.0 if self.solution.falling == (placement.scale > 0.0) else 1.0
            return turn * placement.left(whole(part, t), t)

        low, high = self.ends
        beyond = -np.inf if self.allowed[0] == -np.inf else low, np.inf if self.allowed[1] == np.inf else high
        return self._gathered(self._inside(z, *beyond), along_z)

    def at_nodes(self, every: int = 1) -> tuple[NDArray[np.float64], ComplexArray]:
        """z (m,) and φ (m, n) at every so many nodes, subdomain after subdomain, and at samples between them and singular ends."""
        whole = _of_whole(self.solution, self.solution.phi[::every])
        z = [placement.z(self.solution.nodes[::every]).real for placement in self.placements]
        states = [placement.right(whole, self.solution.nodes[::every]) for placement in self.placements]
        if len(self._inner_samples):
            z, states = [*z, self._inner_samples], [*states, self.right(self._inner_samples)]
        return np.concatenate(z), np.concatenate(states)

    @cached_property
    def ends(self) -> tuple[float, float]:
        """The lowest and the highest z of the integration."""
        reached = [range_of(placement, self.solution) for placement in self.placements]
        return min(low for low, _ in reached), max(high for _, high in reached)

    @cached_property
    def nodes(self) -> NDArray[np.float64]:
        """The z of the mesh, and of the samples between it and singular ends (m,), rising."""
        z = [placement.z(self.solution.nodes).real for placement in self.placements]
        return np.unique(np.concatenate([*z, self._inner_samples]))

    @cached_property
    def placements(self) -> tuple[Placement, ...]:
        """The placements of the subdomains on the line, by rising z."""
        return tuple(sorted(placements(self.problem), key=lambda placement: range_of(placement, self.solution)))

    @cached_property
    def allowed(self) -> tuple[float, float]:
        """The lowest and the highest z that may be asked for; infinite where the decaying space is known all the way."""
        low, high = self.ends
        for _, space in self._inner_spaces:
            low, high = min(low, float(space.place)), max(high, float(space.place))
        if len(self.placements) > 1 or (low, high) != self.ends:
            return low, high
        start, wall = self.solution.nodes[[0, -1]].real
        try:
            for lengths in FARTHER:
                self.solution.reaching(start + lengths * (start - wall))
        except (InputError, ConvergenceError):  # there is none, or a singular point lies between
            return low, high
        return (low, np.inf) if self.placements[0].z(start).real == high else (-np.inf, high)

    def _gathered(self, z: NDArray[np.float64], of: Callable[[Placement, Solution, ComplexArray], ComplexArray]) -> ComplexArray:
        out = np.zeros((len(z), self.placements[0].size), dtype=np.complex128)
        for placement, inside in self._by_placement(z):
            t = placement.t(z[inside].astype(np.complex128))
            out[inside] = of(placement, self._reaching(t.real), t)
        return out

    def _by_placement(self, z: NDArray[np.float64]) -> Iterator[tuple[Placement, NDArray[np.bool_]]]:
        """The subdomains, each with those of the points that lie in it."""
        bounds = [range_of(placement, self.solution)[1] for placement in self.placements[:-1]]
        place = np.searchsorted(bounds, z, side="left")
        for i, placement in enumerate(self.placements):
            if (inside := place == i).any():
                yield placement, inside

    def _inside(self, z: NDArray[np.float64], low: float, high: float) -> NDArray[np.float64]:
        """The points z (m,), those that miss an end by rounding moved to it. Raises InputError for a point outside."""
        slack = OUTSIDE * (self.ends[1] - self.ends[0])
        outside = (z < low - slack) | (z > high + slack)
        if outside.any():
            raise InputError(f"z = {z[outside][0]:g}: allowed is z from {low:.6g} to {high:.6g}")
        return np.clip(z, low, high)

    @cached_property
    def _inner_samples(self) -> NDArray[np.float64]:
        """z (m,) between singular ends and where the integration begins."""
        parts = (np.arange(INNER_SAMPLES) + 0.5) / INNER_SAMPLES
        start = self.solution.nodes[0]
        found = [
            space.place + parts * (float(placement.z(start).real) - space.place)
            for placement, space in self._inner_spaces
            if np.isfinite(space.place)
        ]
        return np.concatenate([np.empty(0), *found])

    @cached_property
    def _inner_spaces(self) -> list[tuple[Placement, InnerSpace]]:
        """The subdomains with what they know of their solutions beyond their beginning.

        Along one that reaches to infinity by itself the integration itself goes on: see `_reaching`.
        """
        known = [(placement, placement.inner) for placement in self.placements if placement.inner is not None]
        return [(placement, space) for placement, space in known if len(self.placements) > 1 or np.isfinite(space.place)]

    def _nearer_than_begun(self, placement: Placement, space: InnerSpace, z: NDArray[np.float64]) -> NDArray[np.bool_]:
        """The points, of z (m,), that lie between an end and where the integration begins."""
        start, place = float(placement.z(self.solution.nodes[0]).real), space.place
        return (z >= place) & (z < start) if place < start else (z <= place) & (z > start)

    def _inner(self, placement: Placement, space: InnerSpace, z: NDArray[np.float64]) -> ComplexArray:
        """φ (m, n) at points z (m,) there: the solutions of the space with the coefficients that they have where the integration begins."""
        start = self.solution.nodes[:1]
        first = placement.right(_of_whole(self.solution, self.solution.phi[:1]), start)[0]
        basis = space.nearer(placement.z(start).real, self.solution.sigma)[0]
        coefficients = np.linalg.lstsq(basis, first, rcond=None)[0]
        return np.asarray(space.nearer(z, self.solution.sigma) @ coefficients)

    def _reaching(self, t: NDArray[np.float64]) -> Solution:
        """The solution on a mesh as far out as these points."""
        start = self.solution.nodes[0].real
        farthest = float(t.max() if self.solution.falling else t.min())
        slack = OUTSIDE * abs(start - self.solution.nodes[-1].real)
        turn = 1.0 if self.solution.falling else -1.0
        if turn * (farthest - start) <= slack:
            return self.solution
        known = self._farther.get(0)
        if known is None or turn * (farthest - known.nodes[0].real) > 0.0:
            known = self._farther[0] = self.solution.reaching(farthest)
        return known


def _of_whole(part: Solution, states: ComplexArray) -> ComplexArray:
    """States (m, N) of the whole problem, of those (m, size) of what is solved."""
    return part.problem.of_whole(states) if isinstance(part.problem, Subsystem) else states


def in_unknowns(named: Unknowns, sigma: complex, z: NDArray[np.float64], states: ComplexArray) -> ComplexArray:
    """The unknowns (m, q) of states (m, n) at z (m,)."""
    return np.asarray(np.einsum("mqn,mn->mq", named.matrix(z.astype(np.complex128), sigma), states))


def range_of(placement: Placement, solution: Solution) -> tuple[float, float]:
    """The lowest and the highest z of a subdomain."""
    low, high = sorted(placement.z(solution.nodes[[0, -1]]).real.tolist())
    return low, high


def real_points(z: ArrayLike) -> NDArray[np.float64]:
    """z (m,). Raises InputError where it is not real and finite."""
    points = np.ravel(np.asarray(z))
    if points.dtype.kind not in "fiu" or not np.isfinite(points).all():
        raise InputError("z: allowed are finite real numbers")
    return points.astype(np.float64)
