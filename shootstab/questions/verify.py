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

from shootstab.discriminants.atlas import Atlas, Undecidable
from shootstab.discriminants.frame import Frame
from shootstab.discriminants.protocol import Method
from shootstab.problems.protocol import Problem
from shootstab.questions.refine import examine, refine
from shootstab.questions.zeros import Inaccurate, Zeros, zeros_in
from shootstab.roots.find import find
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
from shootstab.vocabulary.regions import Disc, Rectangle

NEAR_DIGITS = 2  # a claim that shares fewer digits with a mode does not mean it
SHRINK = 3.0  # from one circle to the next smaller one, where D cannot be continued over it
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
    missing, searched, undecided = _missing(judge.atlas, verdicts, region)
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
        wide, zeros = self._widest(claim, radius)
        if not zeros:
            return Verdict(claim, SPURIOUS, f"no zero of D within {wide:.1e}")
        mode = self._polish(min(zeros, key=lambda z: abs(z - claim)))
        agreed = digits_between(abs(claim - mode.sigma), abs(mode.sigma))
        why = f"a mode lies {abs(claim - mode.sigma):.1e} away: {agreed:.1f} digits agree, {self.digits} were asked for"
        return Verdict(claim, INACCURATE, why, complex(mode.sigma), mode.error, agreed)

    def _zeros(self, disc: Disc) -> Zeros:
        """By the first atlas that is accurate enough."""
        for atlas in self._atlases[:-1]:
            try:
                return zeros_in(atlas, disc)
            except Inaccurate:
                continue
        return zeros_in(self._atlases[-1], disc)

    def _widest(self, claim: complex, radius: float) -> tuple[float, tuple[complex, ...]]:
        """The modes in the circle of two digits, or in the largest smaller one in which they can be counted."""
        wide = radius_of(claim, min(NEAR_DIGITS, self.digits))
        while wide > radius:
            try:
                return wide, self._zeros(Disc(claim, wide)).modes
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
    box = region or _unstable_box(atlas, [v.claimed for v in verdicts])
    if box is None:
        return (), "missing modes were not looked for: no claim is unstable and no region was given", ()
    where = f"missing modes were looked for from {complex(box.lower_left):.6g} to {complex(box.upper_right):.6g}"
    if atlas.continuum is not None and any(box.contains(complex(s)) for s in atlas.continuum.sigma):
        held = f"the region from {box.lower_left} to {box.upper_right} holds continuous spectrum"
        return (), "missing modes were not looked for", (held,)
    try:
        zeros = find(atlas.method.on(atlas.problem), box)
    except ConvergenceError as error:
        return (), "missing modes were not looked for", (str(error),)
    known = [v.sigma for v in verdicts if v.sigma is not None]
    lacking = [z for z in zeros if all(abs(z - k) > 1e-6 * abs(z) for k in known)]
    return tuple(refine(atlas.problem, z) for z in lacking), where, ()


def _unstable_box(atlas: Atlas, claims: list[complex]) -> Rectangle | None:
    """The box of the unstable claims, a quarter larger, right of the continuous spectrum."""
    unstable = np.array([c for c in claims if c.real > 0.0])
    if unstable.size == 0:
        return None
    edge = -math.inf if atlas.continuum is None else float(atlas.continuum.sigma.real.max())
    right = 1.25 * unstable.real.max()
    left = max(edge, 0.0) + 1e-3 * unstable.real.max()
    height = max(unstable.imag.max() - unstable.imag.min(), right)
    return Rectangle(complex(left, unstable.imag.min() - 0.25 * height), complex(right, unstable.imag.max() + 0.25 * height))
