"""A multiple eigenvalue, or several that double precision does not tell apart, as one mode with its multiplicity.

Next to an m-fold zero an error δ of D moves the zeros by about δ^(1/m), in all directions, while their mean stays put. So a multiple mode
is the mean of the zeros, and its error bound the smallest circle in which m of them can be counted: on it every way in which D is
inaccurate changes D by less than D itself, and by Rouché's theorem the true D has as many zeros inside.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from shootstab.analyses.error_budget import FAR_PROBE, FLOW_NOISE, FLOWS, NOISE, SAFETY, change_by_walls
from shootstab.core.discriminant import Discriminant
from shootstab.core.errors import ConvergenceError, Inaccurate
from shootstab.core.numerus import number_of
from shootstab.core.records import CONVERGED, Budget, Mode
from shootstab.core.regions import Disc
from shootstab.discriminants.continuation import Continuation
from shootstab.discriminants.method import MeshedDiscriminant
from shootstab.problems.protocol import Problem
from shootstab.roots.iterations import newton
from shootstab.roots.search import moments
from shootstab.roots.separation import surroundings
from shootstab.roots.winding import Limited, Winding, wind

ROUCHE_RATIO = 0.3  # chosen: errors of D, relative to D, all along the circle; by Rouché's theorem 1 would do
GOAL = 0.1  # chosen, below ROUCHE_RATIO: what the next circle is made for
CIRCLES = 12  # chosen: circles tried in all; twelve that are NEXT_CIRCLE reach over ten powers of ten
WIDEST_CLUSTER = 0.5  # chosen: the widest circle, in the larger of |σ| and the scale of D there: wider ones would hold other modes
WORTHWHILE = 0.8  # chosen: ratio of a circle to the next one that is still tried
SMALLEST_NEXT = 1e-3  # chosen: the radius of the next circle over that of one in which zeros are counted, at least
NEXT_CIRCLE = 8.0  # chosen: the radius of the next circle over that of one that is too small to be counted
WIDE_ENOUGH = 1.25  # chosen: the next circle over the one in which the errors of D would be just small enough
CIRCLE_PROBES = 4  # chosen: samples of a circle at which the errors of D are measured
POLISHED_STEP = 1e-12  # chosen: relative step with which zeros inside a circle are told apart
MOST_ON_CIRCLE = 400  # chosen: evaluations along one small circle, ten times those that zeros in its middle need
THIRD = 1 / 3  # chosen: radius of the circle that is to hold one zero alone, in the distance to the nearest other


def count_in(discriminant: Discriminant, disc: Disc) -> Winding:
    """The zeros in a small disc. Raises ConvergenceError where one lies on its boundary, or D is noise there."""
    return wind(Limited(discriminant, discriminant.evaluations + MOST_ON_CIRCLE), disc)


@dataclass(frozen=True)
class Cluster:
    """multiplicity zeros of D inside disc, counted where D is accurate enough for that, about their mean."""

    disc: Disc
    mean: complex
    winding: Winding

    @property
    def multiplicity(self) -> int:
        return self.winding.count

    @property
    def error(self) -> float:
        """How far from the mean each of the zeros may lie."""
        return self.disc.radius + abs(self.mean - self.disc.centre)


def cluster(continuation: Continuation, centre: complex, radius: float, multiplicity: int | None = None, goal: float = 0.0) -> Cluster:
    """The zeros around a centre, in a circle about as small as D allows, or as the goal; radius is that of the first circle.

    Without a multiplicity it is that of the first circle in which zeros can be counted. Raises Inaccurate where there is none, up to one
    of WIDEST_CLUSTER.
    """
    branch = continuation.at(centre)
    best: Cluster | None = None
    for _ in range(CIRCLES):
        disc = Disc(centre, radius)
        try:
            winding = count_in(branch.discriminant, disc)
        except ConvergenceError:  # a zero lies on this circle, or D is noise on it
            winding = None
        counted = winding is not None and winding.count > 0 and multiplicity in (None, winding.count)
        off = _inaccuracy(continuation.problem, branch.discriminant, winding) if counted and winding is not None else math.inf
        if winding is None or off > ROUCHE_RATIO:
            if best is not None:
                break
            # what D is off by moves zeros by a length, so that against a wider circle it is less
            wider = radius * min(NEXT_CIRCLE, WIDE_ENOUGH * off / ROUCHE_RATIO)
            if wider > WIDEST_CLUSTER * _size(branch.discriminant, centre, wider, multiplicity):
                break
            radius = wider
            continue
        multiplicity = winding.count
        best = Cluster(disc, moments(winding)[0], winding)
        smaller = radius * max((off / GOAL) ** (1 / multiplicity), SMALLEST_NEXT)
        if smaller > WORTHWHILE * radius or best.error <= goal:
            break
        # the mean must not leave the middle of the next circle
        centre, radius = best.mean, smaller
    if best is None:
        many = "modes" if multiplicity is None else number_of(multiplicity, "mode")
        raise Inaccurate(f"no circle around {centre:.12g}, up to one of {radius:.1e}, is found in which D counts {many} for certain")
    return best


def _size(discriminant: Discriminant, centre: complex, radius: float, multiplicity: int | None) -> float:
    """|centre|, or where the circle is wide against that and D is like that power of the distance for longer, the length of that."""
    size = abs(centre)
    if radius <= WIDEST_CLUSTER * size:
        return size
    around = surroundings(discriminant, centre)
    return max(size, around.scale) if around.multiplicity > 0 and multiplicity in (None, around.multiplicity) else size


def told_apart(continuation: Continuation, found: Cluster) -> list[complex]:
    """The zeros of a cluster where circles hold each of them alone; empty where D does not tell them apart."""
    D = continuation.at(found.mean).discriminant
    zeros: list[complex] = []
    for start in moments(found.winding)[1]:
        root = newton(D, start, POLISHED_STEP)
        if not root.converged or not found.disc.contains(root.sigma) or root.sigma in zeros:
            return []
        zeros.append(root.sigma)
    for zero in zeros:
        gap = min((abs(zero - other) for other in zeros if other != zero), default=found.disc.radius)
        try:
            winding = count_in(D, Disc(zero, THIRD * gap))
        except ConvergenceError:
            return []
        if winding.count != 1 or not _inaccuracy(continuation.problem, D, winding) <= ROUCHE_RATIO:
            return []
    return zeros


def multiple(continuation: Continuation, found: Cluster, rtol: float, atol: float = 0.0) -> Mode:
    """A cluster as one mode: its mean, and as error bound the circle."""
    branch = continuation.at(found.mean)
    error, asked = found.error, max(rtol * abs(found.mean), atol)
    status = CONVERGED
    if error > asked:
        lie = number_of(found.multiplicity, "mode lies", "modes lie")
        status = f"not converged: {lie} within {error:.1e} of {found.mean:.12g}, and {asked:.1e} was asked for"
    return Mode(
        found.mean,
        error,
        Budget(0.0, 0.0, 0.0, error, 0.0),
        status,
        continuation.method.name,
        0,
        0.0,
        continuation.distance(found.mean),
        branch.path,
        found.multiplicity,
        atol=atol,
    )


def _inaccuracy(problem: Problem, D: MeshedDiscriminant, winding: Winding) -> float:
    """The largest sum of the relative errors of D at some samples: of the mesh, of rounding, the far field and the steady flow.

    To that is added how much walls change D that stand next to singular points.
    """
    crude = problem.with_base_flow_error(FLOWS[0])
    worst = 0.0
    probes = winding.samples[:: max(1, len(winding.samples) // CIRCLE_PROBES)]
    for value in probes:
        off = abs(D.refined()(value.sigma).over(value.D) - 1)
        off += NOISE * abs(D.with_rotated_basis(1)(value.sigma).over(value.D) - 1)
        off += SAFETY * abs(D.with_perturbed_start(1, FAR_PROBE)(value.sigma).over(value.D) - 1) / FAR_PROBE * D.far_error(value.sigma)
        if crude is not problem:
            off += FLOW_NOISE * abs(D.on_same_mesh(crude)(value.sigma).over(value.D) - 1)
        worst = max(worst, off)
    return worst + change_by_walls(problem, [(D, value) for value in probes])
