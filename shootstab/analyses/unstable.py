"""How many modes grow: a count over the whole right half-plane, closed by a theorem on |σ| or, where there is none, by the growth of D.

A theorem is that of the problem (problems.capabilities.GROWING_REGION), such as the numerical range of its equations. Without one: for
large |σ| the solutions vary on the short scale σ^(−1/2), and ln D = 2A σ^(1/2) + B ln σ + …, so that q(σ) = σ D′/D = A σ^(1/2) + B + …
in the right half-plane, to which a zero adds σ/(σ − σ₀): where q follows that law over an arc, and over the next ones out to where σ
rules everywhere (asymptotic_scale.py), none hides between them. The half-disc inside is then counted.
"""

from __future__ import annotations

import cmath
import math
from collections.abc import Sequence
from dataclasses import dataclass, is_dataclass, replace
from typing import Any

from shootstab.analyses.accuracy import Tightening
from shootstab.analyses.asymptotic_scale import asymptotic_scale
from shootstab.analyses.count import counted_twice
from shootstab.analyses.cut_region import RegionCount
from shootstab.analyses.growth_law import GrowthLaw
from shootstab.core.allowed import GROWTH_FLOOR, LARGEST_FLOOR
from shootstab.core.errors import ConvergenceError, InputError
from shootstab.core.given import require_floor
from shootstab.core.regions import Rectangle
from shootstab.discriminants.continuation import Continuation, Undecidable
from shootstab.discriminants.frame import Frame
from shootstab.discriminants.method import AdaptiveDiscriminant, Method
from shootstab.discriminants.shared_meshes import LentMesh, SharedMeshes
from shootstab.problems.capabilities import GROWING_REGION
from shootstab.problems.protocol import Problem

LAW = 0.12  # chosen: departure of q from its law that is allowed on every arc: up to three zeros between two of them depart by more
OUTWARDS = (1.0, 4.0, 16.0, 64.0)  # chosen: radii, in that of the bound, on which the law is checked at least
FALLEN = 0.5  # chosen: the last departure in the largest: the next order of the law falls by half an arc
AS_GOOD_AS_NONE = 1e-3  # chosen: a departure that need not fall
SMALLEST_RADIUS = LARGEST_FLOOR
LARGEST_RADIUS = 1e6  # chosen: the radius up to which a bound is looked for
UNSTABLE_COUNTING = Frame(rtol=1e-8)  # chosen: local error with which growing modes are counted
LAW_FOLLOWED = Frame(rtol=1e-6)  # chosen: a departure of 0.1 in q of some hundreds is seen
MOST_WORK = 40_000  # chosen: steps of all meshes on which a bound is looked for, which take some seconds


@dataclass(frozen=True)
class HalfDisc:
    """|σ| < radius, Re σ > floor ≥ 0."""

    radius: float
    floor: float

    @property
    def _angle(self) -> float:
        return math.acos(self.floor / self.radius)

    @property
    def corners(self) -> tuple[float, ...]:
        return (0.0, 0.5, 1.0)

    @property
    def hull(self) -> tuple[complex, ...]:
        return Rectangle(complex(self.floor, -self.radius), complex(self.radius, self.radius)).vertices

    def boundary(self, t: float) -> complex:
        """The arc from below for t < 1/2, then the straight side down; its points are dense towards the middle, where scales are short."""
        if t <= 0.5:
            return cmath.rect(self.radius, (4 * t - 1) * self._angle)
        height = self.radius * math.sin(self._angle)
        return complex(self.floor, height * (3 - 4 * t) ** 3)

    def parameter(self, sigma: complex) -> float:
        height = self.radius * math.sin(self._angle)
        if sigma.real > 2 * self.floor:
            return (cmath.phase(sigma) / self._angle + 1) / 4
        y = sigma.imag / height
        return (3 - math.copysign(abs(y) ** (1 / 3), y)) / 4

    def contains(self, sigma: complex) -> bool:
        return sigma.real > self.floor and abs(sigma) < self.radius

    def as_dict(self) -> dict[str, Any]:
        return {"shape": "half-disc", "radius": self.radius, "floor": self.floor}


@dataclass(frozen=True)
class Unstable:
    """count modes have Re σ > floor, and all of them lie in the region, none beyond |σ| = radius.

    That no other one has Re σ > floor says the lemma of this name, or, where that is empty, the law of growth, from which q departs by no
    more than departure.
    """

    count: int
    floor: float
    radius: float
    departure: float
    counted: RegionCount
    region: HalfDisc | Rectangle
    lemma: str = ""


def count_unstable(problem: Problem, floor: float = GROWTH_FLOOR, method: Method | None = None) -> Unstable:
    """The number of modes with Re σ > floor.

    Raises Undecidable where the essential spectrum reaches beyond the floor, ConvergenceError where no radius is found beyond which D
    follows its law of growth.
    """
    require_floor(floor)
    used = method or UNSTABLE_COUNTING
    continuation = Continuation(problem, used)
    if continuation.rightmost > floor:
        raise Undecidable(
            f"the essential spectrum reaches Re sigma = {continuation.rightmost:.6g}, right of the floor {floor:.1e}: "
            "the half-plane cannot be counted as a whole; modes can be counted in a region that is named"
        )
    region, lemma, departure = _closed(problem, used, floor)
    _, counted = counted_twice(Tightening(continuation), region)
    radius = region.radius if isinstance(region, HalfDisc) else max(map(abs, region.hull))
    return Unstable(counted.count, floor, radius, departure, counted, region, lemma)


def _closed(problem: Problem, method: Method, floor: float) -> tuple[HalfDisc | Rectangle, str, float]:
    """A region with all modes of Re σ > floor, the lemma by which it has them, and the departure from the law where it is that."""
    theorem = GROWING_REGION.of(problem)
    if theorem is not None:
        try:
            return *theorem(floor), 0.0
        except InputError:
            pass  # the floor lies above all of its region: the law is asked
    accurate = replace(method, rtol=LAW_FOLLOWED.rtol) if is_dataclass(method) and method.rtol > LAW_FOLLOWED.rtol else method
    law = growth_beyond(accurate.on(problem))
    return HalfDisc(law.radius, floor), "", law.departure


def of_arcs(lent: Sequence[LentMesh] = (), to: AdaptiveDiscriminant | None = None) -> SharedMeshes:
    """Meshes for the arcs of `growth_beyond`, of which each has its own; lent are a neighbour's, for its arcs."""
    return SharedMeshes(short=0, within=math.sqrt(OUTWARDS[1]), lent=lent, to=to)


def growth_beyond(
    discriminant: AdaptiveDiscriminant,
    radius: float = SMALLEST_RADIUS,
    settled: float | None = None,
    meshes: SharedMeshes | None = None,
) -> GrowthLaw:
    """The law of growth on an arc from which on D follows it in the right half-plane, with the largest departure seen out there.

    The arc is that of the radius, or one farther out; those that follow reach to settled, the |σ| from which on σ rules everywhere (by
    default found as in asymptotic_scale.py), and the departure falls along them. Raises ConvergenceError, before long, where none is found.
    """
    settled = asymptotic_scale(discriminant.problem) if settled is None else settled
    if settled == math.inf:
        raise ConvergenceError(
            "no bound on |sigma| of growing modes is known: no |sigma| is found from which on sigma rules all rates and conditions; "
            "modes can be counted in a region that is named"
        )
    meshes = of_arcs() if meshes is None else meshes
    work, without, laws = 0, "", list[GrowthLaw]()
    while work <= MOST_WORK and not (radius > LARGEST_RADIUS and not laws):
        try:
            law = GrowthLaw.on(discriminant, radius, meshes)
        except ConvergenceError as error:  # an arc that ends on the continuous spectrum, say: farther out are others
            laws, without = [], f" ({error})"
        else:
            work += law.work
            laws = [*laws, law] if law.departure < LAW else []
        departures = [law.departure for law in laws]
        falls = len(laws) >= len(OUTWARDS) and departures[-1] <= max(FALLEN * max(departures), AS_GOOD_AS_NONE)
        if falls and radius >= settled:
            return replace(laws[0], departure=max(departures))
        radius *= OUTWARDS[1]
    told = f"does not follow its law of growth, ln D = 2A sigma^(1/2) + B ln sigma, up to |sigma| = {radius:.2g}{without}"
    if laws:
        told = (
            f"follows its law of growth from |sigma| = {laws[0].radius:.2g} to {laws[-1].radius:.2g} only, beyond which meshes are too long"
        )
        if laws[-1].radius < settled:
            told += f", but a part of the problem feels sigma from {settled:.1g} on"
    raise ConvergenceError(f"no bound on |sigma| of growing modes is known: D {told}; modes can be counted in a region that is named")


def bound(discriminant: AdaptiveDiscriminant) -> tuple[float, float]:
    """The radius of `growth_beyond`, and the largest departure seen, of D with the local errors of LAW_FOLLOWED."""
    law = growth_beyond(LAW_FOLLOWED.on(discriminant.problem))
    return law.radius, law.departure


def departure_from_law(discriminant: AdaptiveDiscriminant, radius: float) -> float:
    """max |q − A σ^(1/2) − B − C σ^(−1/2)| on the arc, with A, B and C fitted to it, of D with the local errors of LAW_FOLLOWED."""
    return GrowthLaw.on(LAW_FOLLOWED.on(discriminant.problem), radius).departure
