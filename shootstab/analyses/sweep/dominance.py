"""Whether a mode dominates: a count of the modes that grow faster than half as fast, and the search for those that are not known yet."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

from shootstab.analyses.accuracy import Tightening
from shootstab.analyses.asymptotic_scale import asymptotic_scale
from shootstab.analyses.cut_region import count_in_region
from shootstab.analyses.find import find_modes
from shootstab.analyses.growth_law import GrowthLaw
from shootstab.analyses.reference import spectrum
from shootstab.analyses.sweep.following import land
from shootstab.analyses.unstable import LAW_FOLLOWED, SMALLEST_RADIUS, HalfDisc, growth_beyond, of_arcs
from shootstab.core.allowed import GROWTH_FLOOR
from shootstab.core.discriminant import Value
from shootstab.core.errors import ConvergenceError, InputError
from shootstab.core.numerus import number_of
from shootstab.core.regions import Rectangle
from shootstab.discriminants.continuation import Continuation
from shootstab.discriminants.frame import Frame
from shootstab.discriminants.method import AdaptiveDiscriminant
from shootstab.discriminants.shared_meshes import LentMesh, SharedMeshes
from shootstab.problems.capabilities import GROWING_REGION
from shootstab.problems.protocol import Problem
from shootstab.roots.search import Zero

DECAY_NOISE = 1e-7  # chosen: growth rates below this part of the frequencies of the continuous spectrum are not told from decay
SHARE = 0.5  # chosen: modes above this part of the dominant growth rate are counted and followed
NUDGES = (1.0, 0.83, 0.61)  # chosen: factors on a floor on which a mode lies
RAISE = 30.0  # chosen: factor by which the floor rises where it is too near the continuous spectrum for a count
HIGHEST_FLOOR = 1e-4  # chosen: the floor up to which it does
SWEEP_COUNTING = Frame(rtol=1e-5)  # chosen: a phase needs few digits; where it needs more, the tolerance is tightened
SWEEP_FINDING = Frame(rtol=1e-6)  # chosen: a mode that is found is told from one that is known, to SAME_MODE
SUGGESTING_TRUNCATIONS = (40, 64)  # chosen: orders of the pseudospectral spectra that suggest modes
SUGGESTED = 12  # chosen: suggested modes that are tried, the fastest first
COUNTED = ("mode is counted", "modes are counted")  # words for a number of them
SAME_MODE = 1e-5  # chosen: relative distance below which two numbers mean one mode


@dataclass(frozen=True)
class Closure:
    """What says where all growing modes lie: the law of growth, with the discriminant by which it was found, or a theorem (unstable.py)."""

    law: GrowthLaw | None = None
    settled: float = 0.0  # the |σ| from which on σ rules everywhere (see asymptotic_scale.py)
    far: AdaptiveDiscriminant | None = None
    arcs: tuple[LentMesh, ...] = ()  # meshes of far
    theorem: Callable[..., tuple[Rectangle, str]] | None = None

    def region(self, floor: float) -> HalfDisc | Rectangle:
        """A region that holds every mode with Re σ > floor."""
        if self.law is not None:
            return HalfDisc(self.law.radius, floor)
        assert self.theorem is not None
        return self.theorem(floor)[0]

    @property
    def without(self) -> Callable[[Value], Value] | None:
        """What divides D by its growth."""
        return None if self.law is None else self.law.divided_out


@dataclass(frozen=True)
class DominantModes:
    """All modes with Re σ > floor, by falling growth rate; their number is counted in the region of the closure.

    The meshes of continuation, by which they were counted, those of its contours and those of the closure serve a neighbour too.
    """

    modes: tuple[complex, ...]
    floor: float
    closure: Closure
    continuation: Continuation
    contours: tuple[LentMesh, ...]
    evaluations: int


def count_dominant(problem: Problem, known: Sequence[complex], floor: float, before: DominantModes | None = None) -> DominantModes:
    """The modes that grow at least half as fast as the dominant one; known are some that were followed to here.

    The count is made first with the known ones. If there are more, pseudospectral spectra suggest where they are, and at last the half-disc
    is divided. Raises ConvergenceError where the count cannot be made or not all modes are found.
    """
    counting = Continuation(problem, SWEEP_COUNTING, None if before is None else before.continuation.on_the_axis.meshes)
    contours = SharedMeshes(lent=() if before is None else before.contours, to=counting.on_the_axis)
    finding = Continuation(problem, SWEEP_FINDING)
    modes = _distinct(known)
    if before is None:
        modes = _distinct([*modes, *_suggested(finding, SUGGESTING_TRUNCATIONS[0])])
    closure = _closure(problem, None if before is None else before.closure)
    least = lowest_floor(counting, floor)
    for attempt in range(len(SUGGESTING_TRUNCATIONS) + 2):
        level = max(least, SHARE * max((m.real for m in modes), default=0.0))
        count, level, spent = _counted(counting, closure, level, contours)
        growing = [m for m in modes if m.real > level]
        if count == len(growing):
            growing.sort(key=lambda m: (-m.real, m.imag))
            return DominantModes(tuple(growing), level, closure, counting, tuple(contours.of(counting.on_the_axis)), spent)
        if count < len(growing):
            raise ConvergenceError(f"{number_of(count, *COUNTED)} with Re sigma > {level:.2g}, but {len(growing)} found")
        if attempt < len(SUGGESTING_TRUNCATIONS):
            modes = _distinct([*modes, *_suggested(finding, SUGGESTING_TRUNCATIONS[attempt])])
        else:
            _, zeros, _ = find_modes(finding, closure.region(level), [Zero(m) for m in growing])
            modes = _distinct([*modes, *(z.sigma for z in zeros)])
    raise ConvergenceError(f"{number_of(count, *COUNTED)} with Re sigma > {level:.2g}, but only {len(growing)} found")


def _closure(problem: Problem, before: Closure | None) -> Closure:
    """The law of growth, which costs less, or the problem's own theorem where D does not follow one, as it did not at a neighbour.

    Raises ConvergenceError where there is neither.
    """
    theorem = GROWING_REGION.of(problem)
    if theorem is not None and before is not None and before.law is None:
        return Closure(theorem=theorem)
    far = LAW_FOLLOWED.on(problem, begin=None if before is None or before.far is None else before.far.meshes)
    settled = asymptotic_scale(problem, 0.0 if before is None else before.settled)
    arcs = of_arcs(() if before is None else before.arcs, far)
    try:
        law = growth_beyond(far, SMALLEST_RADIUS if before is None or before.law is None else before.law.radius, settled, arcs)
    except ConvergenceError:
        if theorem is None:
            raise
        return Closure(theorem=theorem)
    return Closure(law, settled, far, tuple(arcs.of(far)))


def lowest_floor(continuation: Continuation, floor: float) -> float:
    """The floor, or what the contour needs to keep clear of the continuous spectrum, which decays slower and slower towards infinity."""
    curve = continuation.continuum
    return floor if curve is None else max(floor, DECAY_NOISE * float(abs(curve.sigma.imag).max()))


def _counted(continuation: Continuation, closure: Closure, floor: float, meshes: SharedMeshes) -> tuple[int, float, int]:
    """The number of modes with Re σ above the floor, or above a lower or higher one on which no mode and no singular point lies."""
    tightening = Tightening(continuation)
    level = floor
    while True:
        for nudge in NUDGES:
            try:
                region = closure.region(nudge * level)
            except InputError:  # the theorem says that nothing grows so fast
                return 0, nudge * level, 0
            try:
                _, found = tightening.first(lambda c, r=region: count_in_region(c, r, without=closure.without, meshes=meshes))  # type: ignore[misc]
            except ConvergenceError:
                if nudge == NUDGES[-1] and RAISE * level > max(HIGHEST_FLOOR, floor):
                    raise
            else:
                return found.count, nudge * level, found.evaluations
        level *= RAISE


def suggested(problem: Problem) -> list[complex]:
    """Growing zeros of D next to eigenvalues of a coarse pseudospectral discretization, the fastest first: there may be others."""
    return _suggested(Continuation(problem, SWEEP_FINDING), SUGGESTING_TRUNCATIONS[0])


def next_to(problem: Problem, sigma: complex) -> complex | None:
    """The zero of D next to a mode of a neighbouring problem; None where the iteration does not show that it is the next one."""
    try:
        return land(Continuation(problem, SWEEP_FINDING).along(sigma)[0], sigma)
    except ConvergenceError:
        return None


def _suggested(continuation: Continuation, truncation: int) -> list[complex]:
    """Zeros of D next to the growing eigenvalues of a pseudospectral discretization: suggestions, which a count confirms or not."""
    try:
        raw = spectrum(continuation.problem, truncation, filtered=False).raw
    except InputError:  # no reference for this problem
        return []
    growing = sorted(raw[raw.real > GROWTH_FLOOR], key=lambda s: -s.real)[:SUGGESTED]
    landed = []
    for guess in growing:
        try:
            landed.append(land(continuation.along(complex(guess))[0], complex(guess)))
        except ConvergenceError:
            continue
    return [s for s in landed if s is not None]


def _distinct(modes: Sequence[complex]) -> list[complex]:
    kept: list[complex] = []
    for mode in modes:
        if math.isfinite(abs(mode)) and all(abs(mode - other) > SAME_MODE * abs(mode) for other in kept):
            kept.append(mode)
    return kept
