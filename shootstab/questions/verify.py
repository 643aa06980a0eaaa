"""A verdict on every claimed eigenvalue, and the modes that the claimed spectrum lacks.

A verdict rests on a count of zeros in a circle, never on an iteration that stopped. The circle that N digits mean is the one around the
square of numbers that round to the claimed one at N significant digits: radius 10^(e+1−N)/√2 for a largest part of 10^e ≤ |x| < 10^(e+1).
"""

from __future__ import annotations

import cmath
import math
from collections.abc import Callable, Iterable
from dataclasses import replace
from typing import Any

from shootstab.discriminants.atlas import Atlas, Undecidable
from shootstab.discriminants.continuum import continuum_of
from shootstab.discriminants.frame import Frame
from shootstab.discriminants.protocol import Method
from shootstab.problems.protocol import Problem
from shootstab.questions.find import find_modes, modes_of
from shootstab.questions.refine import examine, refine
from shootstab.questions.unstable import HalfDisc, count_unstable
from shootstab.questions.zeros import Crowded, Inaccurate, Zeros, zeros_in
from shootstab.roots.find import Zero
from shootstab.roots.iterations import Root
from shootstab.vocabulary.errors import ConvergenceError, InputError
from shootstab.vocabulary.records import (
    CONFIRMED,
    CONTINUUM,
    INACCURATE,
    SPURIOUS,
    UNRESOLVED,
    Mode,
    Report,
    Verdict,
    digits_between,
)
from shootstab.vocabulary.regions import Disc, Rectangle, Region

NEAR_DIGITS = 2  # a claim that shares fewer digits with a mode does not mean it
MARGIN = 0.05  # of the box that the claims span
CLEAR = 1e-4  # of the box, how far right of the continuous spectrum a search begins
NOT_SEARCHED = "missing modes were not looked for"
SHRINK = 3.0  # from one circle to the next smaller one, where D cannot be continued over it
STEEPEST = 2.5  # change of ln D over the radius of the first circle around a claim
FEW = 3  # modes in a circle that are told apart
NEWTON_STEPS = 8
LOOSE = 1e-5  # local error with which zeros are looked for: whether it is small enough, a mesh with every step halved tells
REACH, FURTHER = 100.0, 16.0  # |σ| of the first mesh that is tried on the way to a large claim, and the factor to the next
MOST_STEPS = 800  # of the loose mesh for one claim: where D must be more accurate it is some times as long
MOST_TURNS = 60.0  # of D's phase along the box in which missing modes are looked for
SMALLER = 4.0  # by which the box of the claims is made smaller where it has more
POINTS = 12
MISSING_RTOL = 1e-10
Progress = Callable[[int, int], None]


def verify(
    problem: Problem,
    eigenvalues: Iterable[Any],
    digits: int = 6,
    region: Region | None = None,
    method: Method | None = None,
    progress: Progress | None = None,
    unstable: bool = False,
) -> Report:
    """Verdicts to so many digits, in the order of the claims, and the modes missing from them.

    Missing modes are looked for in the region; without one, in the box that the claims span, cut along the continuous spectrum. The report
    says where, and names what could not be searched. With unstable=True the whole half-plane of growing modes is counted besides, by
    a bound on |σ| (see unstable.py), so that "no other unstable mode" is a statement.

    Raises InputError for claims that are not finite numbers.
    """
    claims = [complex(c) for c in eigenvalues]
    if not claims:
        raise InputError("no eigenvalues to verify: at least one is needed")
    for i, c in enumerate(claims):
        if not cmath.isfinite(c):
            raise InputError(f"eigenvalue {i + 1} is {c}: allowed is a finite number")
    if not 1 <= digits <= 12:
        raise InputError(f"digits = {digits}: allowed is 1 to 12")
    tolerance = 10.0 ** -(digits + 2)
    judge = Judge(problem, method or Frame(rtol=max(tolerance, 1e-13)), digits)
    judged: dict[int, Verdict] = {}
    # the mesh only grows, and large σ need a finer one: small σ first
    for i in sorted(range(len(claims)), key=lambda i: abs(claims[i])):
        judged[i] = judge.verdict(claims[i])
        if progress is not None:
            progress(len(judged), len(claims))
    verdicts = _one_claim_a_mode([judged[i] for i in range(len(claims))])
    missing, searched, undecided = _missing(judge.atlas, verdicts, region)
    if unstable:
        found = [Zero(complex(m.sigma), m.multiplicity, m.error) for m in missing]
        more, said = _unstable(judge.atlas, [*_claimed_modes(verdicts), *found])
        missing, searched = missing + more, f"{searched}; {said}"
    return Report(tuple(verdicts), missing, digits, searched, undecided)


def radius_of(claim: complex, digits: int) -> float:
    """The radius of the circle that so many digits of the claim mean; for 0, of the smallest number."""
    size = max(abs(claim.real), abs(claim.imag))
    if size == 0.0:
        return 10.0**-digits
    return float(10.0 ** (math.floor(math.log10(size)) + 1 - digits) / math.sqrt(2))


class Judge:
    """Atlases of discriminants of rising accuracy, for many claims, best in the order of their size: the meshes only grow."""

    def __init__(self, problem: Problem, method: Method, digits: int) -> None:
        self.problem, self.digits = problem, digits
        self.atlas = Atlas(problem, method)
        looser = [Atlas(problem, Frame(rtol=LOOSE))] if method.rtol < LOOSE else []
        self._atlases = [*looser, self.atlas, *(Atlas(problem, Frame(rtol=rtol)) for rtol in (1e-10, 1e-13) if rtol < method.rtol)]
        self._reach = REACH
        self._too_far = math.inf

    def verdict(self, claim: complex) -> Verdict:
        """What the zeros around the claim say of it."""
        distance = self.atlas.distance(claim)
        try:
            self._atlases[0].charts(claim, radius_of(claim, self.digits))
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
        size = abs(claim)
        while size > self._reach * FURTHER and self._reach < self._too_far:
            probe = claim * (self._reach / size)
            discriminant = self._atlases[0].at(probe).discriminant
            discriminant(probe)
            if discriminant.steps * math.sqrt(FURTHER) > MOST_STEPS:
                self._too_far = self._reach
            else:
                self._reach *= FURTHER
        if size > self._too_far * FURTHER:
            raise ConvergenceError(f"solutions for |sigma| = {size:.1e} are so steep that the mesh would need over {MOST_STEPS} steps")

    def _around(self, claim: complex, radius: float) -> tuple[float, Zeros]:
        """The radius of the largest circle, up to that of two digits, that was counted, and the zeros in it; it grows until there are any.

        A circle along which ln D changes much holds many zeros or needs many samples: the first is chosen by the slope of ln D.
        Raises what the circle of the digits asked for raises, if no larger one can be counted and that cannot either.
        """
        wide = max(radius, radius_of(claim, NEAR_DIGITS))
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

    def _first_circle(self, claim: complex, radius: float, wide: float) -> float:
        if wide == radius:
            return radius
        # between two zeros of a row ln D is flat, but beside the row it is as steep as they are dense
        places = (claim, claim * complex(1.0, wide / abs(claim))) if claim != 0.0 else (claim,)
        slope = max(abs(self._atlases[0].at(s).discriminant.with_slope(s).slope) for s in places)
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
        """By the first atlas that is accurate enough."""
        for atlas in self._atlases[:-1]:
            try:
                return zeros_in(atlas, disc, most)
            except Inaccurate:
                continue
        return zeros_in(self._atlases[-1], disc, most)

    def _neighbour(self, claim: complex, empty: float) -> complex | None:
        """The mode that Newton finds between the circle that is empty and that of two digits, which could not be counted."""
        wide = radius_of(claim, min(NEAR_DIGITS, self.digits))
        sigma = claim
        if empty >= wide:
            return None
        try:
            for _ in range(NEWTON_STEPS):
                step = self.atlas.at(sigma).discriminant.with_slope(sigma).newton_step
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
        modes = self._polish(min(zeros, key=lambda z: abs(z.sigma - claim)))
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

    def _polish(self, zero: Zero) -> list[Mode]:
        """The mode with its error bar, or those into which a multiple zero falls."""
        rtol = 10.0 ** -(self.digits + 2)
        if zero.multiplicity > 1:
            modes = modes_of(self.atlas, zero, rtol)
        else:
            modes = [examine(self.atlas, Root(zero.sigma, 0.0, 0, True), rtol)[0]]
            if not modes[0].converged:
                modes = [refine(self.problem, zero.sigma, rtol)]
        for mode in modes:
            if not math.isfinite(mode.error):
                raise ConvergenceError(mode.status)
        return modes


def _one_claim_a_mode(verdicts: list[Verdict]) -> list[Verdict]:
    """A mode answers as many claims as its multiplicity, the nearest; what else was taken for it is spurious, with the reason."""
    owners: dict[int, int] = {}  # claims that a mode answers, and how many more of them it may
    out = list(verdicts)
    order = sorted((i for i, v in enumerate(verdicts) if v.sigma is not None), key=lambda i: -(verdicts[i].digits_agreed or 0.0))
    for i in order:
        v = verdicts[i]
        owner = next((j for j in owners if _same_mode(v, verdicts[j])), None)
        if owner is None:
            owners[i] = v.multiplicity - 1
        elif owners[owner] > 0:
            owners[owner] -= 1
        else:
            what = "repeats" if v.verdict == CONFIRMED else "is farther from the mode than"
            how = "simple" if v.multiplicity == 1 else f"of multiplicity {v.multiplicity} only"
            why = f"{what} claim {owner + 1}, and the mode is {how}"
            out[i] = replace(v, verdict=SPURIOUS, why=why, sigma=None, error=None, digits_agreed=None, multiplicity=1)
    return out


def _same_mode(v: Verdict, w: Verdict) -> bool:
    assert v.sigma is not None
    assert w.sigma is not None
    return abs(v.sigma - w.sigma) <= (v.error or 0.0) + (w.error or 0.0) + 1e-12 * abs(w.sigma)


def _missing(atlas: Atlas, verdicts: list[Verdict], region: Region | None) -> tuple[tuple[Mode, ...], str, tuple[str, ...]]:
    """Modes in the region that no claim means; where they were looked for; what could not be searched."""
    claims = [v.claimed for v in verdicts]
    undecided: tuple[str, ...] = ()
    box = region
    if box is None:
        box, undecided = _searchable(atlas, claims)
        if box is None:
            return (), NOT_SEARCHED, undecided
    known = _claimed_modes(verdicts)
    low, high = _extremes(box)
    try:
        zeros, whole = find_modes(atlas, box, known)
    except Undecidable as error:
        # the part right of the continuous spectrum, where instability is
        assert atlas.continuum is not None
        undecided += (f"left of the continuous spectrum: {error}",)
        edge = max(float(atlas.continuum.sigma.real.max()), 0.0) + CLEAR * abs(high)
        if not isinstance(box, Rectangle) or high.real <= edge:
            return (), NOT_SEARCHED, undecided
        low = complex(max(edge, low.real), low.imag)
        try:
            zeros, whole = find_modes(atlas, Rectangle(low, high), known)
        except ConvergenceError as again:
            return (), NOT_SEARCHED, (*undecided, str(again))
    except ConvergenceError as error:
        return (), NOT_SEARCHED, (*undecided, str(error))
    where = f"missing modes were looked for from {low:.6g} to {high:.6g}, which holds {whole.count}"
    left_out = tuple(f"what lies within {d.radius:.1e} of the end {d.centre:.6g} of the continuous spectrum" for d in whole.left_out)
    return _modes(atlas, zeros), where, undecided + left_out


def _searchable(atlas: Atlas, claims: list[complex]) -> tuple[Rectangle | None, tuple[str, ...]]:
    """The box that the claims span, without the largest of them where the contour around it would be too long; what was left out."""
    kept = list(claims)
    while True:
        box = _box(kept)
        if box is None:
            return None, ("the claims span no box, and no region was given",)
        if _turns(atlas, box) <= MOST_TURNS:
            break
        limit = max(map(abs, kept)) / SMALLER
        kept = [c for c in kept if abs(c) <= limit]
        if not kept:
            return None, ("the box that the claims span is too large to be searched: name a region",)
    if len(kept) == len(claims):
        return box, ()
    return box, (f"the part of the box that the {len(claims) - len(kept)} largest claims add: name a region to search there",)


def _turns(atlas: Atlas, box: Rectangle) -> float:
    """About how often the phase of D turns along the boundary, or ln |D| changes by 2π: a measure of its cost."""
    turns = 0.0
    for k in range(POINTS):
        sigma = box.boundary((k + 0.5) / POINTS)
        try:
            slope = atlas.at(sigma).discriminant.with_slope(sigma).slope
        except ConvergenceError:
            return math.inf
        turns += abs(slope) * abs(box.boundary((k + 1) / POINTS) - box.boundary(k / POINTS)) / (2 * math.pi)
    return turns


def _claimed_modes(verdicts: list[Verdict]) -> list[Zero]:
    """The modes that claims mean, a multiple one as often as it is claimed."""
    return [Zero(v.sigma, 1, v.error or 0.0) for v in verdicts if v.sigma is not None]


def _extremes(region: Region) -> tuple[complex, complex]:
    """Lower left and upper right of what the region reaches over."""
    hull = region.hull
    re, im = [v.real for v in hull], [v.imag for v in hull]
    return complex(min(re), min(im)), complex(max(re), max(im))


def _modes(atlas: Atlas, zeros: list[Zero]) -> tuple[Mode, ...]:
    return tuple(mode for zero in zeros for mode in modes_of(atlas, zero, MISSING_RTOL))


def _unstable(atlas: Atlas, known: list[Zero]) -> tuple[tuple[Mode, ...], str]:
    """The unstable modes that are not known, and what is now known of all of them."""
    growing = [k.sigma.real for k in known if k.sigma.real > 0.0]
    counted = count_unstable(atlas.problem, min(1e-8, 1e-3 * min(growing, default=1.0)), atlas.method)
    said = f"in all {counted.count} modes have Re sigma > {counted.floor:.1e}, none of them |sigma| > {counted.radius:g}"
    if counted.count == sum(k.multiplicity for k in known if k.sigma.real > counted.floor):
        return (), said
    return _modes(atlas, find_modes(atlas, HalfDisc(counted.radius, counted.floor), known)[0]), said


def _box(claims: list[complex]) -> Rectangle | None:
    """The box that the claims span, a little larger so that none of them lies on its boundary."""
    re, im = [c.real for c in claims], [c.imag for c in claims]
    size = max(max(re) - min(re), max(im) - min(im), 0.1 * max(map(abs, claims)))
    if size == 0.0:
        return None
    margin = MARGIN * size * complex(1, 1)
    return Rectangle(complex(min(re), min(im)) - margin, complex(max(re), max(im)) + margin)


def unstable_box(problem: Problem, claims: Iterable[complex]) -> Rectangle | None:
    """The box of the unstable claims, half as large again, right of the continuous spectrum; None if no claim is unstable."""
    unstable = [c for c in claims if c.real > 0.0]
    if not unstable:
        return None
    curve = continuum_of(problem)
    edge = 0.0 if curve is None else max(float(curve.sigma.real.max()), 0.0)
    top, low, high = max(c.real for c in unstable), min(c.imag for c in unstable), max(c.imag for c in unstable)
    height = max(high - low, top)
    return Rectangle(complex(edge + 1e-3 * top, low - 0.5 * height), complex(1.5 * top, high + 0.5 * height))
