"""A multiple eigenvalue, or several that double precision does not tell apart, as one mode with its multiplicity.

Next to an m-fold zero an error δ of D moves the zeros by about δ^(1/m), in all directions, while their mean stays put. So a multiple mode
is the mean of the zeros, and its error bound the smallest circle in which m of them can be counted: on it every way in which D is
inaccurate changes D by less than D itself, and by Rouché's theorem the true D has as many zeros inside.
"""

from __future__ import annotations

import math

from shootstab.analyses.error_budget import FLOW_NOISE, FLOWS, NOISE, PROBE, SAFETY
from shootstab.core.errors import ConvergenceError
from shootstab.core.records import CONVERGED, Budget, Mode
from shootstab.core.regions import Disc
from shootstab.discriminants.continuation import Continuation
from shootstab.discriminants.method import MeshedDiscriminant
from shootstab.problems.protocol import Problem
from shootstab.roots.search import moments
from shootstab.roots.winding import Winding, wind

AGREEMENT = 0.3  # of the errors of D, relative to D, all along the circle: 1 would do
GOAL = 0.1  # what the next circle is chosen for
CIRCLES = 10
WIDER = 8.0  # from a circle that is too small to be counted to the next
WIDEST = 1e-2  # of |σ|
PROBES = 4


def multiple(continuation: Continuation, centre: complex, multiplicity: int, radius: float, rtol: float) -> Mode:
    """The mode of this multiplicity around a centre, in a circle about as small as D allows; radius is that of the first.

    Raises ConvergenceError where so many zeros cannot be counted in any circle.
    """
    branch = continuation.at(centre)
    before = branch.discriminant.evaluations
    best: tuple[Disc, complex] | None = None
    for _ in range(CIRCLES):
        disc = Disc(centre, radius)
        winding = wind(branch.discriminant, disc)
        off = _inaccuracy(continuation.problem, branch.discriminant, winding) if winding.count == multiplicity else math.inf
        if off > AGREEMENT:
            if best is not None or radius > WIDEST * abs(centre):
                break
            radius *= WIDER
            continue
        best = disc, moments(winding)[0]
        smaller = radius * max((off / GOAL) ** (1 / multiplicity), 1e-3)
        if smaller > 0.5 * radius:
            break
        # the mean must not leave the middle of the next circle
        centre, radius = best[1], smaller
    if best is None:
        raise ConvergenceError(f"D is not accurate enough to count {multiplicity} modes within {radius:.1e} of {centre:.12g}")
    disc, mean = best
    error = disc.radius + abs(mean - disc.centre)
    asked = rtol * abs(mean)
    status = CONVERGED
    if error > asked:
        status = f"not converged: {multiplicity} modes lie within {error:.1e} of {mean:.12g}, and {asked:.1e} was asked for"
    return Mode(
        mean,
        error,
        Budget(0.0, 0.0, 0.0, error, 0.0),
        status,
        continuation.method.name,
        branch.discriminant.evaluations - before,
        0.0,
        continuation.distance(mean),
        branch.path,
        multiplicity,
    )


def _inaccuracy(problem: Problem, D: MeshedDiscriminant, winding: Winding) -> float:
    """The largest sum of the relative errors of D at some samples: of the mesh, of rounding, the far field and the steady flow."""
    crude = problem.with_base_flow_error(FLOWS[0])
    worst = 0.0
    for value in winding.samples[:: max(1, len(winding.samples) // PROBES)]:
        off = abs(D.refined()(value.sigma).over(value.D) - 1)
        off += NOISE * abs(D.with_rotated_basis(1)(value.sigma).over(value.D) - 1)
        off += SAFETY * abs(D.with_perturbed_start(1, PROBE)(value.sigma).over(value.D) - 1) / PROBE * D.far_error(value.sigma)
        if crude is not problem:
            off += FLOW_NOISE * abs(D.on_same_mesh(crude)(value.sigma).over(value.D) - 1)
        worst = max(worst, off)
    return worst
