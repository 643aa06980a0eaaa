"""A verdict on every claimed eigenvalue, and the modes that the claimed spectrum lacks."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from shootstab.analyses.assignment import Candidate, assign, shared
from shootstab.analyses.find import find_modes
from shootstab.analyses.missing import (
    NONE,
    NOT_SEARCHED,
    Missing,
    claimed_modes,
    find_missing,
    modes_with_bounds,
    require_missing,
    told_missing,
)
from shootstab.analyses.nearest import with_nearest
from shootstab.analyses.neighbourhoods import SAME_AS, Neighbourhood, neighbourhoods, same, with_modes
from shootstab.analyses.refine_double import TIGHTEST, require_atol
from shootstab.analyses.sighting import Sighting
from shootstab.analyses.unstable import count_unstable
from shootstab.analyses.verdicts import Circle, finite_claims, spurious, verdict_on
from shootstab.analyses.verifier import Verifier
from shootstab.core.allowed import DOUBLE_DIGITS, GROWTH_FLOOR, VERDICT_DIGITS
from shootstab.core.errors import ConvergenceError
from shootstab.core.given import require_whole
from shootstab.core.numerus import number_of
from shootstab.core.progress import Progress, StageClock
from shootstab.core.records import UNRESOLVED, Mode, Report, Verdict
from shootstab.core.regions import Region
from shootstab.discriminants.continuation import Continuation
from shootstab.discriminants.frame import Frame
from shootstab.discriminants.method import Method
from shootstab.discriminants.named import method_named
from shootstab.problems.protocol import Problem
from shootstab.roots.search import Zero

SEARCH_SHARE = 0.5  # chosen: the time of a search for missing modes over that of all claims; only the progress shown rests on it
EXTRA_DIGITS = 2  # chosen: digits computed beyond those asked for
BELOW_KNOWN = 1e-3  # chosen: the floor of the count of growing modes, in the least growth rate that is known


def verify(
    problem: Problem,
    eigenvalues: Any,
    digits: int = VERDICT_DIGITS,
    region: Region | None = None,
    method: Method | str | None = None,
    progress: Progress | None = None,
    unstable: bool = False,
    missing: str | None = None,
    atol: float | None = None,
    workers: int | None = 1,
    cluster: str | None = None,
) -> Report:
    """Verdicts to so many digits, in the order of the claims, and the modes missing from them.

    eigenvalues are numbers (m,), or one. A claim counts as right within atol too, in the units of sigma; by default that is 1e−12 of the
    scale |2D′/D″| over which D is linear at the mode, which matters next to 0 only, and every verdict says what it was. Claims and modes
    are assigned to each other as a whole: n claims on n modes inside one circle are confirmed together.

    missing says how missing modes are looked for: "region", the default where a region is given, in that; "within", the default else, among
    the claims, so that a list is never told to lack a mode beyond itself; "none". The report carries where, in words and as a region with
    the number of claims in it, and names what could not be searched. With unstable=True the whole half-plane of growing modes is counted
    besides, by a bound on |σ| (see unstable.py), so that "no other unstable mode" is a statement.

    workers: processes of this machine that judge claims, None: one a core where that saves time; cluster: the address of a Dask scheduler,
    in place of them. Verdicts do not depend on it.

    Raises InputError for claims that are not finite numbers, for no digits or more than DOUBLE_DIGITS, for a wish that does not go with
    the region, and for a problem that cannot be sent to other processes.
    """
    claims = finite_claims(eigenvalues)
    require_whole("digits", digits, 1, DOUBLE_DIGITS)
    wish = require_missing(missing, region)
    require_atol(atol)
    tolerance = max(10.0 ** -(digits + EXTRA_DIGITS), TIGHTEST)
    verifier = Verifier(problem, method_named(method, tolerance) or Frame(rtol=tolerance), digits, atol)
    clock = StageClock(None if progress is None else lambda done, total, left: progress(done, total))
    searches = (wish != NONE) + unstable
    clock.plan([1.0] * len(claims) + [1.0 + SEARCH_SHARE * len(claims)] * searches)
    around = neighbourhoods(verifier, claims, workers, cluster, clock.done)
    verdicts = Assembly(verifier, around).verdicts()
    lacking = Missing((), NOT_SEARCHED, ())
    if wish != NONE:
        try:
            lacking = find_missing(verifier.continuation, verdicts, region, verifier.loose, verifier.farthest, clock.step_done)
        except (ConvergenceError, MemoryError) as error:
            lacking = lacking._replace(undecided=(f"missing modes: {error}",))
    if unstable:
        clock.done()
        found = [Zero(complex(m.sigma), m.multiplicity, m.error) for m in lacking.modes]
        try:
            more, said = _unstable(verifier.continuation, [*claimed_modes(verdicts), *found])
            lacking = lacking._replace(modes=lacking.modes + more, searched=f"{lacking.searched}; {said}")
        except (ConvergenceError, MemoryError) as error:
            lacking = lacking._replace(undecided=(*lacking.undecided, f"the half-plane of growing modes: {error}"))
    absent, unsure = told_missing(_unanswered(lacking.modes, verdicts), verdicts)
    lacking = lacking._replace(undecided=lacking.undecided + unsure)
    return Report(
        tuple(with_nearest(problem, verdicts, absent)),
        absent,
        digits,
        lacking.searched,
        lacking.undecided,
        region=lacking.region,
        claims_inside=lacking.claims_inside,
        rests_on=verifier.rests_on,
    )


class Assembly:
    """The modes around all claims, and the claims that they answer."""

    def __init__(self, verifier: Verifier, around: Mapping[int, Neighbourhood]) -> None:
        """around by the claim's place in the list, in the order in which the claims are to be gone through."""
        self._verifier, self._around = verifier, dict(around)
        self._modes: list[Mode] = []
        self._numbers: list[list[int]] = [[] for _ in around]  # places in that list of the modes around each claim

    def verdicts(self) -> list[Verdict]:
        """The verdicts, in the order of the claims."""
        for i in self._around:
            self._number_all(i)
        given = assign(self._candidates())
        # who shares a mode with a claim that got none looks further: there may be one for each
        looked: set[int] = set()
        while True:
            candidates = self._candidates()
            ask = [
                i
                for group in shared(candidates)
                if any(given[i] is None and candidates[i] for i in group)
                for i in group
                if i not in looked
            ]
            if not ask:
                break
            for i in ask:
                looked.add(i)
                seen = self._verifier.look_further(self._around[i].seen)
                self._around[i] = with_modes(self._verifier, replace(self._around[i], seen=seen), seen.zeros)
                self._number_all(i)
            given = assign(self._candidates())
        sigmas, often = np.array([complex(mode.sigma) for mode in self._modes]), Counter(given)
        return [self._verdict(i, given, sigmas, often) for i in range(len(self._around))]

    def _number_all(self, i: int) -> None:
        self._numbers[i] = sorted({self._number(mode) for some in self._around[i].modes.values() for mode in some})

    def _number(self, mode: Mode) -> int:
        """Where a mode stands in the list; one that lies within the bounds of one that is listed is the same."""
        for j, other in enumerate(self._modes):
            if same(mode, other):
                if mode.multiplicity == other.multiplicity and mode.error < other.error:
                    self._modes[j] = mode
                return j
        self._modes.append(mode)
        return len(self._modes) - 1

    def _candidates(self) -> list[list[Candidate]]:
        """The modes that each claim may mean."""
        return [self._candidates_of(i) for i in range(len(self._around))]

    def _candidates_of(self, i: int) -> list[Candidate]:
        around = self._around[i]
        return [self._candidate(j, around.seen) for j in self._numbers[i]] if around.lost is None else []

    def _candidate(self, j: int, seen: Sighting) -> Candidate:
        mode = self._modes[j]
        off = abs(complex(mode.sigma) - seen.claim)
        return Candidate(j, mode.multiplicity, off, float(mode.error), abs(complex(mode.sigma)), seen.radius)

    def _verdict(self, i: int, given: Sequence[int | None], sigmas: NDArray[np.complex128], often: Mapping[int | None, int]) -> Verdict:
        """sigmas are those of all modes, often says to how many claims each is given."""
        seen, lost = self._around[i].seen, self._around[i].lost
        if seen.refusal is not None:
            return self._said(Verdict(seen.claim, *seen.refusal), seen)
        if lost is not None:
            return self._said(Verdict(seen.claim, UNRESOLVED, lost), seen)
        number = given[i]
        if number is not None:
            inside = np.flatnonzero(np.abs(sigmas - seen.claim) <= seen.radius).tolist()
            circle = Circle(
                seen.radius,
                seen.atol,
                self._verifier.digits,
                [self._modes[j] for j in inside],
                sum(often[j] for j in inside),
                seen.counted <= seen.radius,
            )
            return self._said(verdict_on(seen.claim, self._modes[number], circle), seen)
        rivals = self._candidates_of(i)
        if rivals:
            best = max(rivals, key=lambda c: c.worth)
            return self._said(spurious(seen.claim, self._taken(best, given)), seen)
        if seen.resonance is not None:
            why = f"the zero at {seen.resonance:.6g} lies beyond the continuous spectrum: a resonance, not a mode"
            return self._said(spurious(seen.claim, why), seen)
        return self._said(spurious(seen.claim, f"no zero of D within {seen.counted:.1e}"), seen)

    def _taken(self, mode: Candidate, given: Sequence[int | None]) -> str:
        """Why a claim gets nothing though a mode is near."""
        owner = next(i for i, g in enumerate(given) if g == mode.mode)
        what = "repeats" if mode.off <= mode.radius + mode.error else "is farther from the mode than"
        how = "simple" if mode.multiplicity == 1 else f"of multiplicity {mode.multiplicity} only"
        return f"{what} claim {owner + 1}, and the mode is {how}"

    def _said(self, verdict: Verdict, seen: Sighting) -> Verdict:
        return replace(verdict, continuum_distance=seen.distance, atol=seen.atol)


def _unanswered(missing: Sequence[Mode], verdicts: Sequence[Verdict]) -> tuple[Mode, ...]:
    """The modes found missing, less as many as claims mean them: of several near ones a search may take another than is known."""
    out: list[Mode] = []
    spent: dict[complex, int] = {}  # the number of missing modes given beside each mode that claims mean
    for mode in missing:
        own = [
            v
            for v in verdicts
            if v.sigma is not None and abs(v.sigma - mode.sigma) <= (v.error or 0.0) + mode.error + SAME_AS * abs(v.sigma)
        ]
        if not own or not math.isfinite(mode.error) or own[0].sigma is None:
            out.append(mode)
            continue
        known = own[0].sigma
        left = max(mode.multiplicity, *(v.multiplicity for v in own)) - len(own) - spent.get(known, 0)
        if left > 0:
            given = min(left, mode.multiplicity)
            spent[known] = spent.get(known, 0) + given
            out.append(replace(mode, multiplicity=given))
    return tuple(out)


def _unstable(continuation: Continuation, known: list[Zero]) -> tuple[tuple[Mode, ...], str]:
    """The unstable modes that are not known, and what is now known of all of them."""
    growing = [k.sigma.real for k in known if k.sigma.real > 0.0]
    counted = count_unstable(continuation.problem, min(GROWTH_FLOOR, BELOW_KNOWN * min(growing, default=1.0)), continuation.method)
    many = number_of(counted.count, "mode has", "modes have")
    said = f"in all {many} Re sigma > {counted.floor:.1e}, none with |sigma| > {counted.radius:g}"
    said += f" (by lemma {counted.lemma})" if counted.lemma else ""
    if counted.count == sum(k.multiplicity for k in known if k.sigma.real > counted.floor):
        return (), said
    return modes_with_bounds(continuation, find_modes(continuation, counted.region, known)[1]), said
