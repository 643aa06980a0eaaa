"""What is to be said of a claimed eigenvalue, once the modes around it are known and each is given to one claim.

The circle that N digits mean is the one around the square of numbers that round to the claimed one at N significant digits: radius
10^(e+1−N)/√2 for a largest part of 10^e ≤ |x| < 10^(e+1). Next to 0, where digits of σ mean nothing, it is at least the absolute accuracy.
"""

from __future__ import annotations

import cmath
import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any

from shootstab.core.errors import InputError, shortened
from shootstab.core.numerus import number_of
from shootstab.core.records import CONFIRMED, INACCURATE, SPURIOUS, UNRESOLVED, Mode, Verdict, digits_between

NEAR_DIGITS = 2  # chosen: a claim that shares fewer digits with a mode does not mean it


def radius_of(claim: complex, digits: int) -> float:
    """The radius of the circle that so many digits of the claim mean. Raises InputError for 0, which has no digits."""
    size = max(abs(claim.real), abs(claim.imag))
    if size == 0.0:
        raise InputError("0 has no significant digits: allowed is a claim other than 0, or an absolute accuracy")
    return float(10.0 ** (math.floor(math.log10(size)) + 1 - digits) / math.sqrt(2))


def finite_claims(eigenvalues: Any) -> list[complex]:
    """The claims as complex numbers. Raises InputError where there are none, or one is not a finite number."""
    given = eigenvalues if isinstance(eigenvalues, Iterable) and not isinstance(eigenvalues, str) else [eigenvalues]
    claims = []
    for i, value in enumerate(given, 1):
        try:
            claims.append(complex(value))
        except (TypeError, ValueError, OverflowError):
            raise InputError(f"eigenvalue {i} is {shortened(value)}: allowed is a finite number") from None
        if not cmath.isfinite(claims[-1]):
            raise InputError(f"eigenvalue {i} is {claims[-1]}: allowed is a finite number")
    if not claims:
        raise InputError("no eigenvalues to verify: at least one is needed")
    return claims


@dataclass(frozen=True)
class Circle:
    """The circle that the digits of a claim mean: its radius, not below the absolute accuracy atol; the modes in it, and how many claims
    were given one of these. counted: the circle itself was counted, and all that was seen lies in it."""

    radius: float
    atol: float
    digits: int
    modes: Sequence[Mode]
    claims: int
    counted: bool = False

    @property
    def count(self) -> int:
        """The modes, with their multiplicities."""
        return sum(mode.multiplicity for mode in self.modes)


def verdict_on(claim: complex, mode: Mode, circle: Circle) -> Verdict:
    """The verdict on a claim that was given a mode."""
    sigma, error = complex(mode.sigma), float(mode.error)
    off = abs(claim - sigma)
    agreed = digits_between(max(off, error), abs(sigma))
    growth = digits_between(max(abs(claim.real - sigma.real), error), abs(sigma.real))
    verdict, why = CONFIRMED, _confirmed(mode, circle)
    if circle.counted and mode.multiplicity > 1 and off <= circle.radius:
        pass  # the bound of a multiple mode is a circle too, and this one is proven
    elif off - error > circle.radius:
        verdict, why = INACCURATE, f"a mode lies {off:.1e} away: {agreed:.1f} digits agree, {circle.digits} were asked for"
    elif off + error > circle.radius:
        where = f"the mode, {off:.1e} away and known to {error:.1e},"
        if mode.multiplicity > 1:
            where = f"{mode.multiplicity} modes lie within {error:.1e} of {sigma:.6g}, where D does not tell them apart: each"
        verdict, why = UNRESOLVED, f"{where} may lie on either side of the circle of {circle.radius:.1e}"
    elif len(circle.modes) > 1 and circle.claims < circle.count:
        circle_of = f"the circle of {circle.radius:.1e} that {circle.digits} digits mean"
        why = f"{circle.count} modes lie in {circle_of}, and {circle.claims} of the claims"
        verdict = UNRESOLVED
    if min(abs(sigma.real), abs(claim.real)) > 0.0 and sigma.real * claim.real < 0.0 and abs(sigma.real) > max(error, circle.atol):
        why += f"; the growth rate has the wrong sign: {claim.real:.3g} is claimed, and the mode has {sigma.real:.3g}"
    return Verdict(
        claim,
        verdict,
        why,
        sigma,
        error,
        None if verdict == UNRESOLVED else agreed,
        multiplicity=mode.multiplicity,
        growth_digits=growth,
        atol=circle.atol,
    )


def _confirmed(mode: Mode, circle: Circle) -> str:
    within = f"within {circle.radius:.1e}"
    if circle.atol == circle.radius:
        within += ", the absolute accuracy next to 0"
    if len(circle.modes) > 1:
        return f"{number_of(circle.count, 'zero')} of D and {number_of(circle.claims, 'claim')} {within}, confirmed together"
    if mode.multiplicity > 1:
        return f"a zero of multiplicity {mode.multiplicity}, or as many not told apart, {within}, and {circle.claims} of the claims"
    return f"exactly one zero of D {within}"


def spurious(claim: complex, why: str, atol: float = 0.0) -> Verdict:
    """The verdict on a claim that no mode answers."""
    return Verdict(claim, SPURIOUS, why, atol=atol)
