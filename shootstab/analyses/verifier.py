"""What lies around one claimed eigenvalue: zeros of D by counting in circles, along meshes of rising accuracy of the method named.

A verdict rests on a count of zeros in a circle, never on an iteration that stopped.
"""

from __future__ import annotations

import math
from contextlib import suppress
from dataclasses import is_dataclass, replace

from shootstab.analyses.accuracy import first_accurate, known_at, otherwise
from shootstab.analyses.claim_size import NEAR_ZERO, NOISY_CHANGE, has_a_size
from shootstab.analyses.refine import refine
from shootstab.analyses.refine_double import NEUTRAL, examine, several
from shootstab.analyses.sighting import Sighting
from shootstab.analyses.verdicts import NEAR_DIGITS, radius_of
from shootstab.analyses.zeros import Crowded, Zeros, zeros_in
from shootstab.core.errors import ConvergenceError, Inaccurate, OnSpectrum
from shootstab.core.records import CONTINUUM, UNRESOLVED, Mode
from shootstab.core.regions import Disc
from shootstab.discriminants.continuation import Continuation, Undecidable
from shootstab.discriminants.method import Method
from shootstab.problems.protocol import Problem
from shootstab.roots.iterations import Root
from shootstab.roots.search import Zero
from shootstab.roots.separation import neutral, surroundings

SMALLER_CIRCLE = 3.0  # chosen: the radius of a circle over which D cannot be continued, over that of the next smaller one
FIRST_CHANGE = 2.5  # chosen: change of ln D over the radius of the first circle around a claim, a few samples' worth
MODES_TOLD_APART = 3  # chosen: modes in a circle that are told apart
CLAIM_NEWTON_STEPS = 8  # chosen: quadratic convergence from two digits to all takes three or four
CLAIM_STEP = 1e-8  # chosen: relative step of Newton's iteration that ends it
ZEROS_RTOL = 1e-5  # chosen: local error with which zeros are looked for; whether it is small enough, a mesh with every step halved tells
TIGHTER = (1e-10, 1e-13)  # chosen: local errors to which D is computed where a circle is too small for the method as it is
FAR_OFF = 10.0  # chosen: radii of the circle of the digits, beyond which a mode need not be known better than to these digits
FIRST_REACH, NEXT_REACH = 100.0, 16.0  # chosen: |σ| of the first mesh on the way to a large claim, and the factor to the next
MOST_LOOSE_STEPS = 800  # chosen: steps of the loose mesh for one claim; where D must be more accurate it is some times as long


class Verifier:
    """Continuations of discriminants of rising accuracy, for many claims. What is seen around a claim does not depend on those before.

    All are of the method given: a loose one in which zeros are looked for, the one that error bounds rest on, and tighter ones.
    """

    def __init__(self, problem: Problem, method: Method, digits: int, atol: float | None = None) -> None:
        self.problem, self.method, self.digits, self._atol = problem, method, digits, atol
        self.continuation = Continuation(problem, method)
        looser = [ZEROS_RTOL] if method.rtol < ZEROS_RTOL else []
        tighter = [rtol for rtol in TIGHTER if rtol < method.rtol]
        variable = is_dataclass(method) and not isinstance(method, type)

        def at(rtol: float) -> Continuation:
            return Continuation(problem, replace(method, rtol=rtol))  # type: ignore[type-var]

        self._continuations = [self.continuation]
        if variable:
            self._continuations = [*map(at, looser), self.continuation, *map(at, tighter)]
        self._too_far = math.inf

    @property
    def settings(self) -> tuple[Problem, Method, int, float | None]:
        """What another verifier is made of that judges as this one does."""
        return self.problem, self.method, self.digits, self._atol

    @property
    def rests_on(self) -> str:
        """The method with which zeros were counted and bounds computed, and its local errors, in words."""
        errors = ", ".join(f"{continuation.method.rtol:.0e}" for continuation in self._continuations)
        return f"counts of zeros and error bounds by {self.method.name}, with local errors of {errors}, the first that is accurate enough"

    @property
    def loose(self) -> Continuation:
        """The continuation in which zeros are looked for first."""
        return self._continuations[0]

    @property
    def farthest(self) -> float:
        """The largest |σ| that can be judged, as far as that is known; infinite as long as no claim was too large."""
        return self._too_far * NEXT_REACH

    def reach_no_farther(self, farthest: float) -> None:
        """Learn the largest |σ| that another verifier can judge."""
        self._too_far = min(self._too_far, farthest / NEXT_REACH)

    def look(self, claim: complex) -> Sighting:
        """The zeros around a claim, in a circle that grows from that of the digits to that of two digits until it holds any."""
        distance = self.continuation.distance(claim)
        radius = radius_of(claim, self.digits) if claim != 0.0 else 0.0
        seen = Sighting(claim, radius, self._atol or 0.0, distance)
        try:
            if distance > max(radius, seen.atol):
                self._require_reach(claim)
            self.loose.crossing(claim, max(radius, seen.atol))
            if self._atol is None:
                atol, near = self._accuracy_next_to_zero(claim, radius)
                seen = replace(seen, atol=atol, near=near)
            seen = replace(seen, radius=max(radius, seen.atol))
            return self._seen(seen)
        except Undecidable as error:
            return replace(seen, refusal=(CONTINUUM, str(error)))
        except ConvergenceError as error:
            return replace(seen, refusal=(UNRESOLVED, str(error)))
        except MemoryError as error:
            return replace(seen, refusal=(UNRESOLVED, f"its mesh does not fit into the memory that is left: {error}"))

    def _seen(self, seen: Sighting) -> Sighting:
        counted, zeros = self._around(seen)
        if zeros.modes:
            return replace(seen, counted=counted, zeros=zeros.modes)
        if zeros.resonances and abs(zeros.resonances[0].sigma - seen.claim) <= seen.radius:
            return replace(seen, counted=counted, resonance=zeros.resonances[0].sigma)
        neighbour = self._neighbour(seen, counted)
        return replace(seen, counted=counted, zeros=() if neighbour is None else (Zero(neighbour),))

    def look_further(self, seen: Sighting) -> Sighting:
        """A claim seen in a larger circle, up to that of two digits, where that can be counted: its mode is another's too."""
        larger = min(self._near(seen), 2 * max(seen.counted, *(abs(z.sigma - seen.claim) for z in seen.zeros)))
        if larger <= seen.counted:
            return seen
        try:
            zeros = self._zeros(Disc(seen.claim, larger), None)
        except ConvergenceError:
            return replace(seen, counted=self._near(seen))  # no more can be known
        return (
            self.look_further(replace(seen, counted=larger))
            if len(zeros.modes) <= len(seen.zeros)
            else replace(seen, counted=larger, zeros=zeros.modes)
        )

    def _accuracy_next_to_zero(self, claim: complex, radius: float) -> tuple[float, float]:
        """The accuracy that double precision gives zeros next to the claim where they have no size of their own, and 0 elsewhere.

        That is NEUTRAL^(1/m) times the scale over which D is like σ^m; with m = 0 no zero is near, and it is about the distance to the
        nearest. Several zeros that D at the claim is known well enough to tell from it are not taken for one: they have sizes of their own.
        It is 0 where the circle of the digits is larger. A claim means a mode there up to the geometric mean of that and the
        scale, half the digits.
        """
        if claim != 0.0 and self._sized_on_every_mesh(claim):
            return 0.0, 0.0
        at = self._continuations[-1].at(claim).discriminant
        if claim != 0.0 and has_a_size(at, claim):
            return 0.0, 0.0
        around = surroundings(at, claim)
        if around.multiplicity > 1 and known_at(self.problem, at, claim):
            around = around.apart
        atol = neutral(around, NEUTRAL)
        return (atol, math.sqrt(atol * around.scale)) if radius < atol < math.inf else (0.0, 0.0)

    def _sized_on_every_mesh(self, claim: complex) -> bool:
        """Whether the loose D has a size of |claim| around the claim, and so has D with all of its errors drawn anew on the mesh halved.

        Zeros at 0 lie elsewhere there, by the error of the loose mesh, which is far above that of the halved one. The count of the zeros
        around the claim asks for the same system.
        """
        loose = self.loose.at(claim).discriminant
        anew = otherwise(self.problem, loose, claim, 1)
        step, other = (D.with_derivative(claim).newton_step for D in (anew, loose))
        alike = abs(other - step) < max(NOISY_CHANGE * abs(step), abs(claim) / NEAR_ZERO - abs(step))
        return alike and has_a_size(loose, claim) and has_a_size(anew, claim)

    def _require_reach(self, claim: complex) -> None:
        """Raise ConvergenceError where so large a |σ| needs a mesh that is too long.

        Solutions vary over σ^(−1/2): 16 times |σ| are 4 times the steps. So the claim is approached from smaller σ of its direction.
        """
        size, reached = abs(claim), FIRST_REACH
        while size > reached * NEXT_REACH:
            probe = claim * (reached / size)
            if self.loose.at(probe).discriminant.steps * math.sqrt(NEXT_REACH) > MOST_LOOSE_STEPS:
                self._too_far = min(self._too_far, reached)
                why = f"solutions for |sigma| = {size:.1e} are so steep that the mesh would need over {MOST_LOOSE_STEPS} steps"
                raise ConvergenceError(why)
            reached *= NEXT_REACH

    def _around(self, seen: Sighting) -> tuple[float, Zeros]:
        """The radius of the largest circle, up to that of two digits, that was counted, and the zeros in it; it grows until there are any.

        A circle along which ln D changes much holds many zeros or needs many samples: the first is chosen by the slope of ln D.
        Raises what the circle of the digits asked for raises, if no larger one can be counted and that cannot either.
        """
        claim, radius, wide = seen.claim, seen.radius, self._near(seen)
        tried = self._first_circle(claim, radius, wide)
        while tried > radius:
            try:
                zeros = self._zeros(Disc(claim, tried), MODES_TOLD_APART)
            except Crowded as crowded:
                tried /= max(SMALLER_CIRCLE, crowded.count)
            except ConvergenceError:
                tried /= SMALLER_CIRCLE
            else:
                return self._grown(claim, tried, zeros, wide)
        return radius, self._zeros(Disc(claim, radius), None)

    def _near(self, seen: Sighting) -> float:
        """The radius of the circle in which a mode may be meant: that of two digits, and the one next to 0, which shares no digits."""
        shared = radius_of(seen.claim, min(NEAR_DIGITS, self.digits)) if seen.claim != 0.0 else 0.0
        return max(seen.radius, shared, seen.near)

    def _first_circle(self, claim: complex, radius: float, wide: float) -> float:
        if wide == radius:
            return radius
        # ln D is flat between two zeros of a row, but beside the row it is as steep as they are dense
        places = (claim, claim + 1j * wide * (claim / abs(claim) if claim != 0.0 else 1.0))
        slope = max(abs(self.loose.at(s).discriminant.with_derivative(s).logarithmic_derivative) for s in places)
        return max(radius, FIRST_CHANGE / slope if slope * wide > FIRST_CHANGE else wide)  # slope may be 0: D is then constant

    def _grown(self, claim: complex, radius: float, zeros: Zeros, wide: float) -> tuple[float, Zeros]:
        """Larger circles, up to the wide one, as long as there is no zero in them and they can be counted."""
        while radius < wide and not zeros.modes:
            larger = min(wide, 2 * radius)
            try:
                zeros = self._zeros(Disc(claim, larger), MODES_TOLD_APART)
            except ConvergenceError:
                break
            radius = larger
        return radius, zeros

    def _zeros(self, disc: Disc, most: int | None) -> Zeros:
        """The zeros found by the first continuation that is accurate enough."""
        return first_accurate(self._continuations, lambda continuation: zeros_in(continuation, disc, most))[1]

    def _neighbour(self, seen: Sighting, empty: float) -> complex | None:
        """The mode that Newton finds between the circle that is empty and that of two digits, which could not be counted.

        It has to arrive on the loose mesh before it begins on the one that error bounds rest on.
        """
        if empty >= self._near(seen):
            return None
        near = self._newton(self.loose, seen.claim, seen)
        return near if near is None or self.loose is self.continuation else self._newton(self.continuation, near, seen)

    def _newton(self, continuation: Continuation, sigma: complex, seen: Sighting) -> complex | None:
        """Where Newton's iteration arrives within the circle of two digits around a claim, None where it leaves it."""
        try:
            for _ in range(CLAIM_NEWTON_STEPS):
                step = continuation.at(sigma).discriminant.with_derivative(sigma).newton_step
                sigma += step
                if not abs(sigma - seen.claim) < self._near(seen):
                    return None
                if abs(step) < CLAIM_STEP * abs(sigma):
                    return sigma
        except ConvergenceError:
            pass  # it leads where D cannot be computed
        return None

    def modes(self, zero: Zero, seen: Sighting) -> list[Mode]:
        """A zero as a mode with its error bar, or those into which a multiple one falls.

        It is known to two digits more than asked for; if the claim is far off anyway, to those asked for, and the loose mesh may do.
        Raises ConvergenceError where it has no finite error bound.
        """
        tight = 10.0 ** -(self.digits + 2)
        far_off = abs(zero.sigma - seen.claim) > FAR_OFF * seen.radius
        try:
            if zero.multiplicity > 1:
                modes = several(self._continuations[-1], zero, tight, seen.atol)
            else:
                modes = [self._simple(zero.sigma, tight, far_off, seen.atol)]
        except MemoryError as error:
            raise ConvergenceError(f"the meshes of its error bound do not fit into the memory that is left: {error}") from error
        for mode in modes:
            if not math.isfinite(mode.error):
                raise ConvergenceError(mode.status)
        return modes

    def _simple(self, sigma: complex, tight: float, far_off: bool, atol: float) -> Mode:
        root = Root(sigma, 0.0, 0, True)
        if far_off and self.loose is not self.continuation:
            with suppress(Inaccurate):
                mode, _ = examine(self.loose, root, 10.0**-self.digits, atol)
                if mode.converged:
                    return mode
        accurate = self._continuations[self._continuations.index(self.continuation) :]
        mode = first_accurate(accurate, lambda continuation: _beside_the_spectrum(continuation, root, tight, atol))[1]
        return mode if mode.converged else refine(self.problem, sigma, tight, method=self.method, atol=atol)


def _beside_the_spectrum(continuation: Continuation, root: Root, tight: float, atol: float) -> Mode:
    """The mode at a root. Raises OnSpectrum where its error does not tell on which side of the continuous spectrum it lies."""
    mode, _ = examine(continuation, root, tight, atol)
    if mode.continuum_distance <= mode.error < math.inf:
        raise OnSpectrum(
            f"the continuous spectrum passes the mode at {mode.continuum_distance:.1e}, inside its error bound {mode.error:.1e}"
        )
    return mode
