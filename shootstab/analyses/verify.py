"""A verdict on every claimed eigenvalue, and the modes that the claimed spectrum lacks."""

from __future__ import annotations

import cmath
from collections.abc import Callable, Iterable
from dataclasses import replace
from typing import Any

from shootstab.analyses.claims import Verifier
from shootstab.analyses.find import find_modes
from shootstab.analyses.missing import NONE, NOT_SEARCHED, Missing, claimed_modes, find_missing, modes_with_bounds, require_missing
from shootstab.analyses.unstable import HalfDisc, count_unstable
from shootstab.core.errors import InputError
from shootstab.core.records import (
    CONFIRMED,
    SPURIOUS,
    Mode,
    Report,
    Verdict,
)
from shootstab.core.regions import Region
from shootstab.discriminants.continuation import Continuation
from shootstab.discriminants.frame import Frame
from shootstab.discriminants.method import Method
from shootstab.problems.protocol import Problem
from shootstab.roots.search import Zero

Progress = Callable[[int, int], None]


def verify(
    problem: Problem,
    eigenvalues: Iterable[Any],
    digits: int = 6,
    region: Region | None = None,
    method: Method | None = None,
    progress: Progress | None = None,
    unstable: bool = False,
    missing: str | None = None,
) -> Report:
    """Verdicts to so many digits, in the order of the claims, and the modes missing from them.

    missing says how missing modes are looked for: "region", the default where a region is given, in that; "within", the default else, among
    the claims, so that a list is never told to lack a mode beyond itself; "none". The report carries where, in words and as a region with
    the number of claims in it, and names what could not be searched. With unstable=True the whole half-plane of growing modes is counted
    besides, by a bound on |σ| (see unstable.py), so that "no other unstable mode" is a statement.

    Raises InputError for claims that are not finite numbers, and for a wish that does not go with the region.
    """
    claims = [complex(c) for c in eigenvalues]
    if not claims:
        raise InputError("no eigenvalues to verify: at least one is needed")
    for i, c in enumerate(claims):
        if not cmath.isfinite(c):
            raise InputError(f"eigenvalue {i + 1} is {c}: allowed is a finite number")
    if not 1 <= digits <= 12:
        raise InputError(f"digits = {digits}: allowed is 1 to 12")
    wish = require_missing(missing, region)
    tolerance = 10.0 ** -(digits + 2)
    verifier = Verifier(problem, method or Frame(rtol=max(tolerance, 1e-13)), digits)
    judged: dict[int, Verdict] = {}
    # neighbours share meshes, which are not kept for ever
    for i in sorted(range(len(claims)), key=lambda i: abs(claims[i])):
        judged[i] = verifier.verdict(claims[i])
        if progress is not None:
            progress(len(judged), len(claims))
    verdicts = _one_claim_a_mode([judged[i] for i in range(len(claims))])
    lacking = Missing((), NOT_SEARCHED, ())
    if wish != NONE:
        lacking = find_missing(verifier.continuation, verdicts, region, verifier.loose, verifier.reach)
    if unstable:
        found = [Zero(complex(m.sigma), m.multiplicity, m.error) for m in lacking.modes]
        more, said = _unstable(verifier.continuation, [*claimed_modes(verdicts), *found])
        lacking = lacking._replace(modes=lacking.modes + more, searched=f"{lacking.searched}; {said}")
    return Report(
        tuple(verdicts),
        lacking.modes,
        digits,
        lacking.searched,
        lacking.undecided,
        region=lacking.region,
        claims_inside=lacking.claims_inside,
    )


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


def _unstable(continuation: Continuation, known: list[Zero]) -> tuple[tuple[Mode, ...], str]:
    """The unstable modes that are not known, and what is now known of all of them."""
    growing = [k.sigma.real for k in known if k.sigma.real > 0.0]
    counted = count_unstable(continuation.problem, min(1e-8, 1e-3 * min(growing, default=1.0)), continuation.method)
    said = f"in all {counted.count} modes have Re sigma > {counted.floor:.1e}, none of them |sigma| > {counted.radius:g}"
    if counted.count == sum(k.multiplicity for k in known if k.sigma.real > counted.floor):
        return (), said
    return modes_with_bounds(continuation, find_modes(continuation, HalfDisc(counted.radius, counted.floor), known)[1]), said
