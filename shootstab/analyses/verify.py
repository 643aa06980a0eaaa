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
from shootstab.analyses.refine_double import TIGHTEST, require_atol
from shootstab.analyses.unstable import count_unstable
from shootstab.analyses.verdicts import Circle, finite_claims, spurious, verdict_on
from shootstab.analyses.verifier import Sighting, Verifier
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
CONFUSED_WITHIN = 3.0  # chosen: radii of the circle of the digits within which zeros are told apart together
WIDER_THAN_CONFUSED = 2.0  # chosen: a circle around zeros that were confused, in the largest distance from their mean
SAME_AS = 1e-12  # chosen: relative distance of two modes that are one, beside their error bounds
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
) -> Report:
    """Verdicts to so many digits, in the order of the claims, and the modes missing from them.

    eigenvalues are numbers (m,), or one. A claim counts as right within atol too, in the units of sigma; by default that is 1e−12 of the
    scale |2D′/D″| over which D is linear at the mode, which matters next to 0 only, and every verdict says what it was. Claims and modes
    are assigned to each other as a whole: n claims on n modes inside one circle are confirmed together.

    missing says how missing modes are looked for: "region", the default where a region is given, in that; "within", the default else, among
    the claims, so that a list is never told to lack a mode beyond itself; "none". The report carries where, in words and as a region with
    the number of claims in it, and names what could not be searched. With unstable=True the whole half-plane of growing modes is counted
    besides, by a bound on |σ| (see unstable.py), so that "no other unstable mode" is a statement.

    Raises InputError for claims that are not finite numbers, for no digits or more than DOUBLE_DIGITS, and for a wish that does not go with
    the region.
    """
    claims = finite_claims(eigenvalues)
    require_whole("digits", digits, 1, DOUBLE_DIGITS)
    wish = require_missing(missing, region)
    require_atol(atol)
    tolerance = max(10.0 ** -(digits + EXTRA_DIGITS), TIGHTEST)
    verifier = Verifier(problem, method_named(method, tolerance) or Frame(rtol=tolerance), digits, atol)
    seen: dict[int, Sighting] = {}
    # neighbours share meshes, which are not kept for ever; and in one order, whatever the list's, a mode is refined from the same place
    clock = StageClock(None if progress is None else lambda done, total, left: progress(done, total))
    searches = (wish != NONE) + unstable
    clock.plan([1.0] * len(claims) + [1.0 + SEARCH_SHARE * len(claims)] * searches)
    for i in sorted(range(len(claims)), key=lambda i: (abs(claims[i]), claims[i].real, claims[i].imag)):
        seen[i] = verifier.look(claims[i])
        clock.done()
    verdicts = Assembly(verifier, seen).verdicts()
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
    """The modes around all claims, each with its error bar and computed once, and the claims that they answer."""

    def __init__(self, verifier: Verifier, seen: Mapping[int, Sighting]) -> None:
        """seen by the claim's place in the list, in the order in which the claims are to be gone through."""
        self._verifier, self._seen = verifier, dict(seen)
        self._modes: list[Mode] = []
        self._known: list[dict[Zero, tuple[int, ...]]] = [{} for _ in seen]
        self._lost: dict[int, str] = {}  # claims around which a zero has no error bound, and why

    def verdicts(self) -> list[Verdict]:
        """The verdicts, in the order of the claims."""
        for i, seen in self._seen.items():
            if seen.zeros:
                nearest = min(seen.zeros, key=lambda zero: abs(zero.sigma - seen.claim))
                reach = max(CONFUSED_WITHIN * seen.radius, abs(nearest.sigma - seen.claim) + CONFUSED_WITHIN * seen.radius)
                self._learn_all(i, [z for z in seen.zeros if z is nearest or abs(z.sigma - seen.claim) <= reach + z.radius])
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
                self._seen[i] = self._verifier.look_further(self._seen[i])
                self._learn_all(i, self._seen[i].zeros)
            given = assign(self._candidates())
        sigmas, often = np.array([complex(mode.sigma) for mode in self._modes]), Counter(given)
        return [self._verdict(i, given, sigmas, often) for i in range(len(self._seen))]

    def _learn_all(self, i: int, zeros: Sequence[Zero]) -> None:
        """The modes that several zeros are; those in one neighbourhood together, as iterations confuse them."""
        left = list(zeros)
        while left:
            near = [z for z in left if abs(z.sigma - left[0].sigma) <= CONFUSED_WITHIN * self._seen[i].radius + z.radius + left[0].radius]
            left = [z for z in left if z not in near]
            self._learn(i, _together(near))
        numbers = {j for some in self._known[i].values() for j in some}
        if i not in self._lost and sum(self._modes[j].multiplicity for j in numbers) < sum(z.multiplicity for z in zeros):
            self._learn(i, _together(zeros))  # iterations from several of them came to one mode

    def _learn(self, i: int, zero: Zero) -> None:
        """The modes that a zero is, as numbers in the list of all."""
        if zero in self._known[i] or i in self._lost:
            return
        try:
            modes = self._verifier.modes(zero, self._seen[i])
        except ConvergenceError as error:
            self._lost[i] = str(error)
            return
        self._known[i][zero] = tuple(self._number(mode) for mode in modes)

    def _number(self, mode: Mode) -> int:
        """Where a mode stands in the list; one that lies within the bounds of one that is listed is the same."""
        for j, other in enumerate(self._modes):
            if abs(mode.sigma - other.sigma) <= mode.error + other.error + SAME_AS * abs(other.sigma):
                if mode.multiplicity == other.multiplicity and mode.error < other.error:
                    self._modes[j] = mode
                return j
        self._modes.append(mode)
        return len(self._modes) - 1

    def _candidates(self) -> list[list[Candidate]]:
        """The modes that each claim may mean."""
        return [self._candidates_of(i) for i in range(len(self._seen))]

    def _candidates_of(self, i: int) -> list[Candidate]:
        numbers = [] if i in self._lost else sorted({j for some in self._known[i].values() for j in some})
        return [self._candidate(j, self._seen[i]) for j in numbers]

    def _candidate(self, j: int, seen: Sighting) -> Candidate:
        mode = self._modes[j]
        off = abs(complex(mode.sigma) - seen.claim)
        return Candidate(j, mode.multiplicity, off, float(mode.error), abs(complex(mode.sigma)), seen.radius)

    def _verdict(self, i: int, given: Sequence[int | None], sigmas: NDArray[np.complex128], often: Mapping[int | None, int]) -> Verdict:
        """sigmas are those of all modes, often says to how many claims each is given."""
        seen = self._seen[i]
        if seen.refusal is not None:
            return self._said(Verdict(seen.claim, *seen.refusal), seen)
        if i in self._lost:
            return self._said(Verdict(seen.claim, UNRESOLVED, self._lost[i]), seen)
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


def _together(zeros: Sequence[Zero]) -> Zero:
    """Several zeros as one multiple zero about their mean."""
    if len(zeros) == 1:
        return zeros[0]
    count = sum(z.multiplicity for z in zeros)
    mean = sum(z.multiplicity * z.sigma for z in zeros) / count
    return Zero(mean, count, WIDER_THAN_CONFUSED * max(abs(z.sigma - mean) + z.radius for z in zeros))


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
