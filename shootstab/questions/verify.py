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
from shootstab.questions.find import find_modes
from shootstab.questions.refine import examine, refine
from shootstab.questions.unstable import count_unstable
from shootstab.questions.zeros import Inaccurate, Zeros, zeros_in
from shootstab.roots.iterations import Root, newton
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
from shootstab.vocabulary.regions import Disc, Rectangle

NEAR_DIGITS = 2  # a claim that shares fewer digits with a mode does not mean it
MARGIN = 0.05  # of the box that the claims span
CLEAR = 1e-4  # of the box, how far right of the continuous spectrum a search begins
NOT_SEARCHED = "missing modes were not looked for"
SHRINK = 3.0  # from one circle to the next smaller one, where D cannot be continued over it
Progress = Callable[[int, int], None]


def verify(
    problem: Problem,
    eigenvalues: Iterable[Any],
    digits: int = 6,
    region: Rectangle | None = None,
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
        more, said = _unstable(judge.atlas, [*(v.sigma for v in verdicts if v.sigma is not None), *(m.sigma for m in missing)])
        missing, searched = missing + more, f"{searched}; {said}"
    return Report(tuple(verdicts), missing, digits, searched, undecided)


def radius_of(claim: complex, digits: int) -> float:
    """The radius of the circle that so many digits of the claim mean; for 0, of the smallest number."""
    size = max(abs(claim.real), abs(claim.imag))
    if size == 0.0:
        return 10.0**-digits
    return float(10.0 ** (math.floor(math.log10(size)) + 1 - digits) / math.sqrt(2))


class Judge:
    """Atlases of discriminants of rising accuracy, for many claims."""

    def __init__(self, problem: Problem, method: Method, digits: int) -> None:
        self.problem, self.digits = problem, digits
        self.atlas = Atlas(problem, method)
        self._atlases = [self.atlas, *(Atlas(problem, Frame(rtol=rtol)) for rtol in (1e-10, 1e-13) if rtol < method.rtol)]

    def verdict(self, claim: complex) -> Verdict:
        """Look for modes in the circle of the digits asked for; if there is none, in the wider one of a mode with fewer digits."""
        distance = self.atlas.distance(claim)
        radius = radius_of(claim, self.digits)
        try:
            judged = self._judge(claim, radius)
        except Undecidable as error:
            judged = Verdict(claim, CONTINUUM, str(error))
        except ConvergenceError as error:
            judged = Verdict(claim, UNRESOLVED, str(error))
        return replace(judged, continuum_distance=distance)

    def _judge(self, claim: complex, radius: float) -> Verdict:
        near = self._zeros(Disc(claim, radius))
        if len(near.modes) == 1:
            return self._confirm(claim, near.modes[0], radius)
        if len(near.modes) > 1:
            return Verdict(claim, UNRESOLVED, f"{len(near.modes)} modes lie in the circle of {radius:.1e} that {self.digits} digits mean")
        if near.resonances:
            why = f"the zero at {near.resonances[0]:.6g} lies beyond the continuous spectrum: a resonance, not a mode"
            return Verdict(claim, SPURIOUS, why)
        zero = self._neighbour(claim)
        if zero is None:
            wide, zeros = self._widest(claim, radius)
            if not zeros:
                return Verdict(claim, SPURIOUS, f"no zero of D within {wide:.1e}")
            zero = min(zeros, key=lambda z: abs(z - claim))
        mode = self._polish(zero)
        agreed = digits_between(abs(claim - mode.sigma), abs(mode.sigma))
        why = f"a mode lies {abs(claim - mode.sigma):.1e} away: {agreed:.1f} digits agree, {self.digits} were asked for"
        return Verdict(claim, INACCURATE, why, complex(mode.sigma), mode.error, agreed)

    def _zeros(self, disc: Disc, most: int | None = None) -> Zeros:
        """By the first atlas that is accurate enough."""
        for atlas in self._atlases[:-1]:
            try:
                return zeros_in(atlas, disc, most)
            except Inaccurate:
                continue
        return zeros_in(self._atlases[-1], disc, most)

    def _neighbour(self, claim: complex) -> complex | None:
        """The mode that Newton finds from the claim, if it lies in the circle of two digits: cheaper than a count, and proved later."""
        wide = radius_of(claim, min(NEAR_DIGITS, self.digits))
        try:
            root = newton(self.atlas.at(claim).discriminant, claim, 1e-8, most=8)
            if not root.converged or abs(root.sigma - claim) > wide:
                return None
            root = newton(self.atlas.at(root.sigma).discriminant, root.sigma, 1e-8, most=4)
        except ConvergenceError:
            return None
        return root.sigma if root.converged and abs(root.sigma - claim) < wide else None

    def _widest(self, claim: complex, radius: float) -> tuple[float, tuple[complex, ...]]:
        """The mode in the circle of two digits, or in the largest smaller one in which there is one at most and it can be counted."""
        wide = radius_of(claim, min(NEAR_DIGITS, self.digits))
        while wide > radius:
            try:
                return wide, self._zeros(Disc(claim, wide), 1).modes
            except ConvergenceError:
                wide /= SHRINK
        return radius, ()

    def _confirm(self, claim: complex, zero: complex, radius: float) -> Verdict:
        mode = self._polish(zero)
        off = abs(claim - mode.sigma)
        if off + mode.error > radius:
            why = f"the mode, {off:.1e} away and known to {mode.error:.1e}, may lie on either side of the circle of {radius:.1e}"
            return Verdict(claim, UNRESOLVED, why, complex(mode.sigma), mode.error)
        agreed = digits_between(max(off, mode.error), abs(mode.sigma))
        return Verdict(claim, CONFIRMED, f"exactly one zero of D within {radius:.1e}", complex(mode.sigma), mode.error, agreed)

    def _polish(self, zero: complex) -> Mode:
        rtol = 10.0 ** -(self.digits + 2)
        mode, _ = examine(self.atlas, Root(zero, 0.0, 0, True), rtol)
        if not mode.converged:
            mode = refine(self.problem, zero, rtol)
        if not math.isfinite(mode.error):
            raise ConvergenceError(mode.status)
        return mode


def _one_claim_a_mode(verdicts: list[Verdict]) -> list[Verdict]:
    """A simple mode answers one claim, the nearest; what else was taken for it is spurious, with the reason."""
    owners: dict[int, int] = {}
    out = list(verdicts)
    order = sorted((i for i, v in enumerate(verdicts) if v.sigma is not None), key=lambda i: -(verdicts[i].digits_agreed or 0.0))
    for i in order:
        v = verdicts[i]
        assert v.sigma is not None
        for j in owners:
            other = verdicts[j].sigma
            assert other is not None
            if abs(v.sigma - other) <= (v.error or 0.0) + (verdicts[j].error or 0.0) + 1e-12 * abs(other):
                what = "repeats" if v.verdict == CONFIRMED else "is farther from the mode than"
                why = f"{what} claim {j + 1}, and the mode is simple"
                out[i] = replace(v, verdict=SPURIOUS, why=why, sigma=None, error=None, digits_agreed=None)
                break
        else:
            owners[i] = i
    return out


def _missing(atlas: Atlas, verdicts: list[Verdict], region: Rectangle | None) -> tuple[tuple[Mode, ...], str, tuple[str, ...]]:
    """Modes in the region that no claim means; where they were looked for; what could not be searched."""
    box = region or _box([v.claimed for v in verdicts])
    if box is None:
        return (), NOT_SEARCHED, ("the claims span no box, and no region was given",)
    known = [v.sigma for v in verdicts if v.sigma is not None]
    undecided: tuple[str, ...] = ()
    try:
        modes, whole = find_modes(atlas, box, known)
    except Undecidable as error:
        # the part right of the continuous spectrum, where instability is
        undecided = (f"left of the continuous spectrum: {error}",)
        edge = max(atlas.rightmost, 0.0) + CLEAR * abs(complex(box.upper_right))
        if complex(box.upper_right).real <= edge:
            return (), NOT_SEARCHED, undecided
        box = Rectangle(complex(max(edge, complex(box.lower_left).real), complex(box.lower_left).imag), box.upper_right)
        try:
            modes, whole = find_modes(atlas, box, known)
        except ConvergenceError as again:
            return (), NOT_SEARCHED, (*undecided, str(again))
    except ConvergenceError as error:
        return (), NOT_SEARCHED, (str(error),)
    where = f"missing modes were looked for from {complex(box.lower_left):.6g} to {complex(box.upper_right):.6g}"
    left_out = tuple(f"what lies within {d.radius:.1e} of the end {d.centre:.6g} of the continuous spectrum" for d in whole.left_out)
    return tuple(refine(atlas.problem, z) for z in modes), where, undecided + left_out


def _unstable(atlas: Atlas, known: list[complex]) -> tuple[tuple[Mode, ...], str]:
    """The unstable modes that are not known, and what is now known of all of them."""
    growing = [k.real for k in known if k.real > 0.0]
    counted = count_unstable(atlas.problem, min(1e-8, 1e-3 * min(growing, default=1.0)), atlas.method)
    said = f"in all {counted.count} modes have Re sigma > {counted.floor:.1e}, none of them |sigma| > {counted.radius:g}"
    if counted.count == sum(k.real > counted.floor for k in known):
        return (), said
    half = Rectangle(complex(counted.floor, -counted.radius), complex(counted.radius, counted.radius))
    return tuple(refine(atlas.problem, z) for z in find_modes(atlas, half, known)[0]), said


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
