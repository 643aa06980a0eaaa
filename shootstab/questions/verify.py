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

import numpy as np

from shootstab.discriminants.frame import Frame
from shootstab.discriminants.protocol import Examinable, Method
from shootstab.problems.protocol import ComplexArray, Problem
from shootstab.questions.continuum import POINTS, distance_to_curve
from shootstab.questions.refine import examine, find_near, refine
from shootstab.roots.find import find
from shootstab.roots.iterations import newton
from shootstab.roots.winding import wind
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
CLEAR = 0.9  # of the distance to the continuous spectrum, what a circle may take
Progress = Callable[[int, int], None]


def verify(
    problem: Problem,
    eigenvalues: Iterable[Any],
    digits: int = 6,
    region: Rectangle | None = None,
    method: Method | None = None,
    progress: Progress | None = None,
) -> Report:
    """Verdicts to so many digits, in the order of the claims, and the modes missing from them.

    Missing modes are looked for in the region; without one, in the part of the box spanned by the unstable claims that lies right of the
    continuous spectrum. The report says where. Raises InputError for claims that are not finite numbers.
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
    missing, searched, undecided = _missing(problem, judge.discriminant, verdicts, region)
    return Report(tuple(verdicts), missing, digits, searched, undecided)


def radius_of(claim: complex, digits: int) -> float:
    """The radius of the circle that so many digits of the claim mean; for 0, of the smallest number."""
    size = max(abs(claim.real), abs(claim.imag))
    if size == 0.0:
        return 10.0**-digits
    return float(10.0 ** (math.floor(math.log10(size)) + 1 - digits) / math.sqrt(2))


class Judge:
    """One discriminant and one curve of the continuous spectrum, for many claims."""

    def __init__(self, problem: Problem, method: Method, digits: int) -> None:
        self.problem, self.digits = problem, digits
        self.discriminant = method.on(problem)
        self._curve: ComplexArray | None = problem.continuum(POINTS)

    def verdict(self, claim: complex) -> Verdict:
        """Count in the circle of the digits asked for; if it is empty, in the wider one of a mode with fewer digits."""
        distance = math.inf if self._curve is None else distance_to_curve(self._curve, claim)
        radius = radius_of(claim, self.digits)
        if distance <= radius / CLEAR:
            why = f"the continuous spectrum passes at {distance:.1e}, inside the circle of {radius:.1e} that {self.digits} digits mean"
            return Verdict(claim, CONTINUUM, why, continuum_distance=distance)
        try:
            judged = self._judge(claim, radius, distance)
        except ConvergenceError as error:
            judged = Verdict(claim, UNRESOLVED, str(error))
        return replace(judged, continuum_distance=distance)

    def _judge(self, claim: complex, radius: float, distance: float) -> Verdict:
        count = self._count(claim, radius)
        if count == 1:
            return self._confirm(claim, radius)
        if count > 1:
            return Verdict(claim, UNRESOLVED, f"{count} modes lie in the circle of {radius:.1e} that {self.digits} digits mean")
        wide = min(radius_of(claim, min(NEAR_DIGITS, self.digits)), CLEAR * distance)
        count = self._count(claim, wide) if wide > radius else 0
        if count == 0:
            return Verdict(claim, SPURIOUS, f"no zero of D within {wide:.1e}")
        near = self._nearest(claim, wide)
        agreed = digits_between(abs(claim - near.sigma), abs(near.sigma))
        why = f"a mode lies {abs(claim - near.sigma):.1e} away: {agreed:.1f} digits agree, {self.digits} were asked for"
        return Verdict(claim, INACCURATE, why, complex(near.sigma), near.error, agreed)

    def _count(self, claim: complex, radius: float) -> int:
        return wind(self.discriminant, Disc(claim, radius)).count

    def _confirm(self, claim: complex, radius: float) -> Verdict:
        mode = self._polish(claim)
        off = abs(claim - mode.sigma)
        if off + mode.error > radius:
            why = f"the mode, {off:.1e} away and known to {mode.error:.1e}, may lie on either side of the circle of {radius:.1e}"
            return Verdict(claim, UNRESOLVED, why, complex(mode.sigma), mode.error)
        agreed = digits_between(max(off, mode.error), abs(mode.sigma))
        return Verdict(claim, CONFIRMED, f"exactly one zero of D within {radius:.1e}", complex(mode.sigma), mode.error, agreed)

    def _nearest(self, claim: complex, wide: float) -> Mode:
        """The mode nearest to the claim, of those in the wide circle."""
        root = newton(self.discriminant, claim, 1e-10)
        if root.converged and abs(root.sigma - claim) < wide and self._count(claim, 0.99 * abs(root.sigma - claim)) == 0:
            return self._polish(root.sigma)
        corner = complex(wide, wide)
        zeros = find(self.discriminant, Rectangle(claim - corner, claim + corner))
        return self._polish(min(zeros, key=lambda z: abs(z - claim)))

    def _polish(self, near: complex) -> Mode:
        rtol = 10.0 ** -(self.digits + 2)
        root = find_near(self.discriminant, near, 1e-3 * rtol)
        mode = examine(self.problem, self.discriminant, root, rtol, "frame")
        if not mode.converged:
            mode = refine(self.problem, near, rtol)
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


def _missing(
    problem: Problem, discriminant: Examinable, verdicts: list[Verdict], region: Rectangle | None
) -> tuple[tuple[Mode, ...], str, tuple[str, ...]]:
    """Modes in the region that no claim means; where they were looked for; what could not be searched."""
    box = region or _unstable_box(problem, [v.claimed for v in verdicts])
    if box is None:
        return (), "missing modes were not looked for: no claim is unstable and no region was given", ()
    where = f"missing modes were looked for from {complex(box.lower_left):.6g} to {complex(box.upper_right):.6g}"
    curve = problem.continuum(POINTS)
    if curve is not None and any(box.contains(complex(s)) for s in curve):
        held = f"the region from {box.lower_left} to {box.upper_right} holds continuous spectrum"
        return (), "missing modes were not looked for", (held,)
    try:
        zeros = find(discriminant, box)
    except ConvergenceError as error:
        return (), "missing modes were not looked for", (str(error),)
    known = [v.sigma for v in verdicts if v.sigma is not None]
    lacking = [z for z in zeros if all(abs(z - k) > 1e-6 * abs(z) for k in known)]
    return tuple(refine(problem, z) for z in lacking), where, ()


def _unstable_box(problem: Problem, claims: list[complex]) -> Rectangle | None:
    """The box of the unstable claims, a quarter larger, right of the continuous spectrum."""
    unstable = np.array([c for c in claims if c.real > 0.0])
    if unstable.size == 0:
        return None
    curve = problem.continuum(POINTS)
    edge = -math.inf if curve is None else float(curve.real.max())
    right = 1.25 * unstable.real.max()
    left = max(edge, 0.0) + 1e-3 * unstable.real.max()
    height = max(unstable.imag.max() - unstable.imag.min(), right)
    return Rectangle(complex(left, unstable.imag.min() - 0.25 * height), complex(right, unstable.imag.max() + 0.25 * height))
