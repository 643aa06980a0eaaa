"""What was proved: the record of a theorem on eigenvalues, and its statement in words."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from decimal import ROUND_FLOOR, Context, Decimal
from typing import Any, Protocol

import mpmath

from shootstab.core.half_annulus import HalfAnnulus
from shootstab.core.regions import Disc, Rectangle
from shootstab.multiprecision.enclosable import Enclosable

COMMON = ("E1", "E5", "E6", "E7")  # lemmas of the guide's page on proofs; "with multiplicity" rests on E7

Decimals = tuple[str, str]  # real and imaginary part


@dataclass(frozen=True)
class Proof:
    """Proved: exactly `count` eigenvalues, with multiplicity, lie in the region, and none on its boundary.

    region is {"shape": "disc", "centre", "radius"} or {"shape": "rectangle", "corners"} or
    {"shape": "half-annulus", "centre", "inner", "outer"}, its numbers exact decimals. counts are of
    the factors of D, where it has some (parities). margin is the factor by which the decisive inequality holds, the least one of a contour.
    alone is the radius of the largest disc about the same centre in which the count was proved too; floor stands where the count is that
    of all eigenvalues with Re σ ≥ floor, interval (name, low, high, pieces) where it holds for every value of a parameter; premise says in
    words of what base flows it is proved. bits, points and evaluations say what it took, lemmas what it relies on.
    """

    counts: tuple[int, ...]
    region: dict[str, Any]
    margin: float
    bits: int
    points: int
    evaluations: int
    seconds: float
    lemmas: tuple[str, ...]
    alone: float | None = None
    floor: float | None = None
    interval: dict[str, Any] | None = None
    premise: str = ""

    @property
    def count(self) -> int:
        """How many eigenvalues all factors have together."""
        return sum(self.counts)

    @property
    def statement(self) -> str:
        """The theorem in words."""
        many = f"exactly {self.count} eigenvalues"
        before = f"{self.premise} " if self.premise else ""
        before += "" if self.interval is None else "for every {name} from {low} to {high} ".format(**self.interval)
        if self.floor is not None:
            subject = {0: "no eigenvalue has", 1: "exactly one eigenvalue has"}.get(self.count, f"{many} have")
            return f"{before}{subject} Re σ ≥ {self.floor!r}"
        subject = {0: "no eigenvalue lies", 1: "exactly one eigenvalue lies"}.get(self.count, f"{many} lie")
        if self.region["shape"] == "disc":
            return f"{before}{subject} in |σ − ({_shown(self.region['centre'])})| < {self.region['radius']}"
        if self.region["shape"] == "half-annulus":
            centre, radii = self.region["centre"], "{inner} < |σ − ({{}})| < {outer}".format(**self.region)
            return f"{before}{subject} in the half-annulus {radii.format(_shown(centre))}, Re σ > {centre['re']}"
        low, high = self.region["corners"]
        return f"{before}{subject} in the rectangle from {_shown(low)} to {_shown(high)}"


class ProvedPart(Protocol):
    """What was proved of one factor of D, or on one subinterval of a parameter; see Proof."""

    @property
    def count(self) -> int: ...

    @property
    def margin(self) -> float: ...

    @property
    def bits(self) -> int: ...

    @property
    def points(self) -> int: ...

    @property
    def evaluations(self) -> int: ...


def gathered(parts: Sequence[ProvedPart], region: Rectangle | HalfAnnulus | Disc, seconds: float, relied: tuple[str, ...]) -> Proof:
    """The proof on a region that its parts are, each with a count of its own: the least margin, the most bits, all evaluations."""
    return Proof(
        tuple(part.count for part in parts),
        shape_of(region),
        min(part.margin for part in parts),
        max(part.bits for part in parts),
        max(part.points for part in parts),
        sum(part.evaluations for part in parts),
        seconds,
        relied,
    )


def lemmas(forms: Sequence[Enclosable]) -> tuple[str, ...]:
    """What a proof on these factors of D relies on."""
    own = sorted({name for form in forms for name in form.lemmas})
    found = (*COMMON, *own, *(("E9",) if len(forms) > 1 else ()))
    return in_order(found)


def in_order(names: Iterable[str]) -> tuple[str, ...]:
    """Lemmas as the guide has them."""
    return tuple(sorted(names, key=lambda name: (name[0], int(name[1:]))))


def shape_of(region: Rectangle | HalfAnnulus | Disc) -> dict[str, Any]:
    """The region with the decimals that its floats stand for."""
    if isinstance(region, HalfAnnulus):
        centre = complex(region.centre)
        radii = {"inner": repr(float(region.inner)), "outer": repr(float(region.outer))}
        return {"shape": "half-annulus", "centre": named((repr(centre.real), repr(centre.imag))), **radii}
    if isinstance(region, Disc):
        centre = complex(region.centre)
        return {"shape": "disc", "centre": named((repr(centre.real), repr(centre.imag))), "radius": repr(float(region.radius))}
    return {"shape": "rectangle", "corners": [named((repr(v.real), repr(v.imag))) for v in (region.vertices[0], region.vertices[2])]}


def premise(forms: Sequence[Enclosable]) -> str:
    """The base flows of the enclosures that these factors of D made last, as the beginning of a sentence."""
    return " ".join(dict.fromkeys(form.premise for form in forms if form.premise))


def named(at: Decimals) -> dict[str, str]:
    """A complex decimal as it stands in JSON."""
    return {"re": at[0], "im": at[1]}


def at_most(x: float, digits: int) -> str:
    """x in so many digits, rounded down: a radius in which something is proved is never told larger than it is."""
    return f"{float(Context(prec=digits, rounding=ROUND_FLOOR).create_decimal(Decimal(x))):.{digits}g}"


def rounded(x: Any, places: int) -> str:
    """The decimal with so many places behind the point, of a real mpmath number."""
    whole = int(mpmath.nint(x * mpmath.mpf(10) ** places))
    if places <= 0:
        return str(whole * 10**-places)
    digits = str(abs(whole)).rjust(places + 1, "0")
    return f"{'-' if whole < 0 else ''}{digits[:-places]}.{digits[-places:]}"


def _shown(at: dict[str, str]) -> str:
    sign, size = ("−", at["im"][1:]) if at["im"].startswith("-") else ("+", at["im"])
    return f"{at['re']} {sign} {size}i"
