"""What is to be said of one claimed eigenvalue.

A verdict rests on a count of zeros in a circle, never on an iteration that stopped. The circle that N digits mean is the one around the
square of numbers that round to the claimed one at N significant digits: radius 10^(e+1−N)/√2 for a largest part of 10^e ≤ |x| < 10^(e+1).
"""

from __future__ import annotations

import math
from dataclasses import replace

from shootstab.analyses.accuracy import Inaccurate
from shootstab.analyses.find import modes_of
from shootstab.analyses.refine import refine
from shootstab.analyses.refine_double import examine
from shootstab.analyses.zeros import Crowded, Zeros, zeros_in
from shootstab.core.errors import ConvergenceError
from shootstab.core.records import CONFIRMED, CONTINUUM, INACCURATE, SPURIOUS, UNRESOLVED, Mode, Verdict, digits_between
from shootstab.core.regions import Disc
from shootstab.discriminants.continuation import Continuation, Undecidable
from shootstab.discriminants.frame import Frame
from shootstab.discriminants.method import Method
from shootstab.problems.protocol import Problem
from shootstab.roots.iterations import Root
from shootstab.roots.search import Zero

NEAR_DIGITS = 2  # a claim that shares fewer digits with a mode does not mean it
SHRINK = 3.0  # from one circle to the next smaller one, where D cannot be continued over it
STEEPEST = 2.5  # change of ln D over the radius of the first circle around a claim
FEW = 3  # modes in a circle that are told apart
NEWTON_STEPS = 8
LOOSE = 1e-5  # local error with which zeros are looked for: whether it is small enough, a mesh with every step halved tells
FAR_OFF = 10.0  # radii of the circle of the digits asked for, beyond which a mode need not be known better than to these digits
REACH, FURTHER = 100.0, 16.0  # |σ| of the first mesh that is tried on the way to a large claim, and the factor to the next
MOST_STEPS = 800  # of the loose mesh for one claim: where D must be more accurate it is some times as long


def radius_of(claim: complex, digits: int) -> float:
    """The radius of the circle that so many digits of the claim mean; for 0, of the smallest number."""
    size = max(abs(claim.real), abs(claim.imag))
    if size == 0.0:
        return 10.0**-digits
    return float(10.0 ** (math.floor(math.log10(size)) + 1 - digits) / math.sqrt(2))


class Verifier:
    """Continuations of discriminants of rising accuracy, for many claims. A verdict does not depend on those given before."""

    def __init__(self, problem: Problem, method: Method, digits: int) -> None:
        self.problem, self.digits = problem, digits
        self.continuation = Continuation(problem, method)
        looser = [Continuation(problem, Frame(rtol=LOOSE))] if method.rtol < LOOSE else []
        self._continuations = [
            *looser,
            self.continuation,
            *(Continuation(problem, Frame(rtol=rtol)) for rtol in (1e-10, 1e-13) if rtol < method.rtol),
        ]
        self._too_far = math.inf

    @property
    def loose(self) -> Continuation:
        """The continuation in which zeros are looked for first."""
        return self._continuations[0]

    @property
    def reach(self) -> float:
        """The largest |σ| that can be judged, as far as that is known; infinite as long as no claim was too large."""
        return self._too_far * FURTHER

    def verdict(self, claim: complex) -> Verdict:
        """What the zeros around the claim say of it."""
        distance = self.continuation.distance(claim)
        try:
            self._continuations[0].branches(claim, radius_of(claim, self.digits))
            self._require_reach(claim)
            judged = self._judge(claim)
        except Undecidable as error:
            judged = Verdict(claim, CONTINUUM, str(error))
        except ConvergenceError as error:
            judged = Verdict(claim, UNRESOLVED, str(error))
        return replace(judged, continuum_distance=distance)

    def _judge(self, claim: complex) -> Verdict:
        radius = radius_of(claim, self.digits)
        counted, zeros = self._around(claim, radius)
        if zeros.modes:
            return self._mode(claim, zeros.modes, radius)
        if zeros.resonances and abs(zeros.resonances[0].sigma - claim) <= radius:
            why = f"the zero at {zeros.resonances[0].sigma:.6g} lies beyond the continuous spectrum: a resonance, not a mode"
            return Verdict(claim, SPURIOUS, why)
        neighbour = self._neighbour(claim, counted)
        if neighbour is None:
            return Verdict(claim, SPURIOUS, f"no zero of D within {counted:.1e}")
        return self._mode(claim, (Zero(neighbour),), radius)

    def _require_reach(self, claim: complex) -> None:
        """Raise ConvergenceError where so large a |σ| needs a mesh that is too long.

        Solutions vary over σ^(−1/2): 16 times |σ| are 4 times the steps. So the claim is approached from smaller σ of its direction.
        """
        size, reached = abs(claim), REACH
        while size > reached * FURTHER:
            probe = claim * (reached / size)
            if self._continuations[0].at(probe).discriminant.steps * math.sqrt(FURTHER) > MOST_STEPS:
                self._too_far = min(self._too_far, reached)
                raise ConvergenceError(f"solutions for |sigma| = {size:.1e} are so steep that the mesh would need over {MOST_STEPS} steps")
            reached *= FURTHER

    def _around(self, claim: complex, radius: float) -> tuple[float, Zeros]:
        """The radius of the largest circle, up to that of two digits, that was counted, and the zeros in it; it grows until there are any.

        A circle along which ln D changes much holds many zeros or needs many samples: the first is chosen by the slope of ln D.
        Raises what the circle of the digits asked for raises, if no larger one can be counted and that cannot either.
        """
        wide = max(radius, self._near(claim))
        tried = self._first_circle(claim, radius, wide)
        while tried > radius:
            try:
                zeros = self._zeros(Disc(claim, tried), FEW)
            except Crowded as crowded:
                tried /= max(SHRINK, crowded.count)
            except ConvergenceError:
                tried /= SHRINK
            else:
                return self._grown(claim, tried, zeros, wide)
        return radius, self._zeros(Disc(claim, radius), None)

    def _near(self, claim: complex) -> float:
        """The radius of the circle of two digits; 0 shares none with any other number."""
        return radius_of(claim, min(NEAR_DIGITS, self.digits) if claim != 0.0 else self.digits)

    def _first_circle(self, claim: complex, radius: float, wide: float) -> float:
        if wide == radius:
            return radius
        # between two zeros of a row ln D is flat, but beside the row it is as steep as they are dense
        places = (claim, claim * complex(1.0, wide / abs(claim)))
        slope = max(abs(self._continuations[0].at(s).discriminant.with_derivative(s).logarithmic_derivative) for s in places)
        return max(radius, min(wide, STEEPEST / slope))

    def _grown(self, claim: complex, radius: float, zeros: Zeros, wide: float) -> tuple[float, Zeros]:
        """Larger circles, up to the wide one, as long as there is no zero in them and they can be counted."""
        while radius < wide and not zeros.modes:
            larger = min(wide, 2 * radius)
            try:
                zeros = self._zeros(Disc(claim, larger), FEW)
            except ConvergenceError:
                break
            radius = larger
        return radius, zeros

    def _zeros(self, disc: Disc, most: int | None) -> Zeros:
        """By the first continuation that is accurate enough."""
        for continuation in self._continuations[:-1]:
            try:
                return zeros_in(continuation, disc, most)
            except Inaccurate:
                continue
        return zeros_in(self._continuations[-1], disc, most)

    def _neighbour(self, claim: complex, empty: float) -> complex | None:
        """The mode that Newton finds between the circle that is empty and that of two digits, which could not be counted."""
        wide = self._near(claim)
        sigma = claim
        if empty >= wide:
            return None
        try:
            for _ in range(NEWTON_STEPS):
                step = self.continuation.at(sigma).discriminant.with_derivative(sigma).newton_step
                sigma += step
                if not abs(sigma - claim) < wide:
                    return None
                if abs(step) < 1e-8 * abs(sigma):
                    return sigma
        except ConvergenceError:
            pass  # it leads where D cannot be computed
        return None

    def _mode(self, claim: complex, zeros: tuple[Zero, ...], radius: float) -> Verdict:
        """Whether a claim shares the digits with the nearest of the zeros around it."""
        near = [z for z in zeros if abs(z.sigma - claim) <= radius]
        zero = min(zeros, key=lambda z: abs(z.sigma - claim))
        modes = self._polish(zero, abs(zero.sigma - claim) > FAR_OFF * radius)
        if len(near) > 1 or len(modes) > 1:
            several = max(len(near), len(modes))
            return Verdict(claim, UNRESOLVED, f"{several} modes lie in the circle of {radius:.1e} that {self.digits} digits mean")
        (mode,) = modes
        off = abs(claim - mode.sigma)
        agreed = digits_between(max(off, mode.error), abs(mode.sigma))
        found = Verdict(claim, UNRESOLVED, "", complex(mode.sigma), mode.error, multiplicity=mode.multiplicity)
        if off - mode.error > radius:
            why = f"a mode lies {off:.1e} away: {agreed:.1f} digits agree, {self.digits} were asked for"
            return replace(found, verdict=INACCURATE, why=why, digits_agreed=agreed)
        if off + mode.error > radius:
            why = f"the mode, {off:.1e} away and known to {mode.error:.1e}, may lie on either side of the circle of {radius:.1e}"
            return replace(found, why=why)
        many = f", of multiplicity {mode.multiplicity}" if mode.multiplicity > 1 else ""
        return replace(found, verdict=CONFIRMED, why=f"exactly one zero of D within {radius:.1e}{many}", digits_agreed=agreed)

    def _polish(self, zero: Zero, far_off: bool) -> list[Mode]:
        """The mode with its error bar, or those into which a multiple zero falls.

        It is known to two digits more than asked for; if the claim is far off anyway, to those asked for, and the loose mesh may do.
        """
        tight = 10.0 ** -(self.digits + 2)
        modes = modes_of(self.continuation, zero, tight) if zero.multiplicity > 1 else [self._simple(zero.sigma, tight, far_off)]
        for mode in modes:
            if not math.isfinite(mode.error):
                raise ConvergenceError(mode.status)
        return modes

    def _simple(self, sigma: complex, tight: float, far_off: bool) -> Mode:
        root = Root(sigma, 0.0, 0, True)
        if far_off and self.loose is not self.continuation:
            mode, _ = examine(self.loose, root, 10.0**-self.digits)
            if mode.converged:
                return mode
        mode, _ = examine(self.continuation, root, tight)
        return mode if mode.converged else refine(self.problem, sigma, tight)
