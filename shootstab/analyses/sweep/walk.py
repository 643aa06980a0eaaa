"""The dominant mode along one line of points: counted at some of them, followed between.

At every so many points, the anchors, the modes that grow at least half as fast as the dominant one are counted, and all are known. From
anchor to anchor each of them is followed, forwards those of the one and backwards those of the other that the first does not have. At a
point between, the fastest of them dominates, unless a mode unknown at both anchors has risen past half its growth rate and sunk again
in between: that is what `followed` leaves open and `proved` does not.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field, replace

from shootstab.analyses.error_budget import gradient_by_steps, integration_error
from shootstab.analyses.refine import refine
from shootstab.analyses.sweep.dominance import SAME_MODE, DominantModes, count_dominant
from shootstab.analyses.sweep.following import ARRIVED, LOST, FollowedMode, follow, land
from shootstab.analyses.sweep.grid import GridLine
from shootstab.analyses.sweep.outcomes import FOLLOWED, NONE_GROWS, PROVED, Outcome
from shootstab.core.allowed import COUNT_EVERY, GROWTH_FLOOR, MOST_EVERY, MOST_SWEEP_DIGITS, SWEEP_DIGITS
from shootstab.core.errors import ConvergenceError
from shootstab.core.given import require_floor, require_whole
from shootstab.core.records import UNRESOLVED
from shootstab.discriminants.frame import Frame
from shootstab.discriminants.shared_meshes import NeighbouringD
from shootstab.problems.capabilities import Family
from shootstab.problems.protocol import Problem

SPREAD = 10.0  # chosen: factor on the parts of the error that are measured at two points of a line only
AUDITS, TRIES = 2, 8  # chosen: points of a line at which all parts of the error are to be measured, and how many are tried
MESH = 1e-8  # chosen: local errors on the meshes, unless the digits ask for smaller ones
NEGLIGIBLE_STEP = 1e-3  # chosen: a step of Newton below this part of the accuracy needs no other one to tell what it leaves


@dataclass(frozen=True)
class WalkSettings:
    """What is asked of every point: digits of σ; a count at every `every`-th point of a line; the Re σ above which a mode counts."""

    digits: int = SWEEP_DIGITS
    every: int = COUNT_EVERY
    floor: float = GROWTH_FLOOR

    def __post_init__(self) -> None:
        require_whole("digits", self.digits, 1, MOST_SWEEP_DIGITS)
        require_whole("every", self.every, 1, MOST_EVERY)
        require_floor(self.floor)


@dataclass
class Place:
    """What is known of one point while the walk passes by. modes are the zeros of D there, by followed."""

    modes: dict[int, complex] = field(default_factory=dict)
    counted: bool = False
    growing: bool = False  # whether the count found anything
    floor: float | None = None
    trouble: str | None = None
    evaluations: int = 0


def walk(family: Family, settings: WalkSettings, line: GridLine) -> list[Outcome]:
    """What is to be said of each point of the line. Trouble at one point is said of that point, and does not stop the walk."""
    outcomes: list[Outcome] = [_without_problem(family, line.values(i)) or Outcome("") for i in range(len(line.points))]
    for first, last in _stretches([not o.status for o in outcomes]):
        walked = _Walk(family, line, settings, first, last).outcomes()
        outcomes[first : last + 1] = [replace(o, beside=family.beside(line.values(i))) for i, o in enumerate(walked, first)]
    return outcomes


def _without_problem(family: Family, values: dict[str, float]) -> Outcome | None:
    """What is to be said where there is nothing to solve."""
    absent = family.absent(values)
    return None if absent is None else Outcome(absent)


def _stretches(good: Sequence[bool]) -> list[tuple[int, int]]:
    """First and last of each run of neighbours that are good."""
    starts = [i for i, g in enumerate(good) if g and (i == 0 or not good[i - 1])]
    ends = [i for i, g in enumerate(good) if g and (i == len(good) - 1 or not good[i + 1])]
    return list(zip(starts, ends, strict=True))


class _Walk:
    """A walk from one point to another, over points that all have a problem."""

    def __init__(self, family: Family, line: GridLine, settings: WalkSettings, first: int, last: int) -> None:
        self._family, self._line, self._settings = family, line, settings
        self._first, self._last = first, last
        self._method = Frame(rtol=min(MESH, 10.0**-settings.digits))
        self._places = {i: Place() for i in range(first, last + 1)}
        self._followed: dict[int, FollowedMode] = {}
        self._made = 0
        self._problems: dict[float, Problem] = {}
        self._kept: dict[float, NeighbouringD] = {}
        self._latest: NeighbouringD | None = None  # its meshes are those that the next one begins with
        self._dominant: DominantModes | None = None

    def outcomes(self) -> list[Outcome]:
        """Count at the anchors, follow between them, and say what came out."""
        self._anchor(self._first)
        found: list[Outcome] = []
        before = self._first
        for i in range(self._first + 1, self._last + 1):
            lost = self._advance(i)
            if lost or i == self._last or i - before >= self._settings.every:
                self._retrace(self._anchor(i), before, i)
                found += [self._outcome(j, (before, i)) for j in range(before, i)]
                self._forget(i)
                before = i
        found.append(self._outcome(before, (before, before)))
        return self._with_bounds(found)

    # the way along the line

    def _advance(self, i: int) -> bool:
        """Follow every followed to point i; whether one did not arrive."""
        for key, followed in list(self._followed.items()):
            if follow(followed, float(i), self._at) == ARRIVED:
                self._places[i].modes[key] = followed.last
            else:
                del self._followed[key]
        return len(self._places[i].modes) < len(self._places[i - 1].modes)

    def _anchor(self, i: int) -> list[int]:
        """Count at point i; the branches that are new there."""
        place = self._places[i]
        try:
            here = count_dominant(self._problem(float(i)), list(place.modes.values()), self._settings.floor, self._dominant)
        except ConvergenceError as error:
            place.trouble = str(error)
            return []
        self._dominant = here
        place.counted, place.growing, place.floor, place.evaluations = True, bool(here.modes), here.floor, here.evaluations
        new = []
        for counted in here.modes:
            if not _among(counted, place.modes.values()):
                mode = land(self._at(float(i)), counted) or counted  # the count's mesh is coarse
                self._made += 1
                self._followed[self._made] = FollowedMode([float(i)], [mode])
                place.modes[self._made] = mode
                new.append(self._made)
        for key, followed in list(self._followed.items()):
            if followed.last.real <= here.floor:  # far below the dominant mode
                del self._followed[key]
                place.modes.pop(key, None)
        return new

    def _retrace(self, new: Sequence[int], before: int, here: int) -> None:
        """Follow branches that were found at one anchor back towards the one before."""
        for key in new:
            back = FollowedMode(list(self._followed[key].places), list(self._followed[key].sigmas))
            for i in range(here - 1, before, -1):
                place = self._places[i]
                reached = follow(back, float(i), self._at)
                if reached == LOST:
                    place.trouble = place.trouble or f"the mode {back.last:.6g} near it cannot be followed to here"
                if reached != ARRIVED or _among(back.last, place.modes.values()):
                    break  # it is gone, or met by a followed that is known: they are one from here on
                place.modes[key] = back.last

    # problems and their discriminants

    def _problem(self, place: float) -> Problem:
        if place not in self._problems:
            self._problems[place] = self._family.problem(self._line.values(place))
        return self._problems[place]

    def _at(self, place: float) -> NeighbouringD:
        """D at a place on the line, which begins with the meshes of the last one."""
        if place not in self._kept:
            self._latest = NeighbouringD(self._problem(place), self._method, self._latest)
            self._kept[place] = self._latest
        return self._kept[place]

    def _forget(self, here: int) -> None:
        """Tables are large: drop those of the points behind."""
        self._kept = {p: d for p, d in self._kept.items() if p >= here}
        self._problems = {p: d for p, d in self._problems.items() if p >= here}

    # what came out

    def _outcome(self, i: int, anchors: tuple[int, int]) -> Outcome:
        """Status, the dominant mode on the halved mesh, and the part of its error that the integration makes."""
        place = self._places[i]
        status, proved = self._status(place, [self._places[a] for a in anchors])
        if not place.modes:
            return Outcome(status, proved, floor=place.floor, evaluations=place.evaluations)
        sigma = max(place.modes.values(), key=lambda s: (s.real, s.imag))
        here = self._at(float(i))
        try:
            coarse = here.at(sigma).vanishing_at(sigma)
            fine = coarse.refined()
            values = coarse, coarse.with_derivative(sigma), fine, fine.with_derivative(sigma)
            _, shares = gradient_by_steps(*values) or (None, None)
            left, step = integration_error(*values, shares), values[-1].newton_step
            sigma += step
            rest = abs(fine.with_derivative(sigma).newton_step) if abs(step) > NEGLIGIBLE_STEP * self._rtol * abs(sigma) else 0.0
        except ConvergenceError as error:
            return Outcome(f"{UNRESOLVED}: {error}", floor=place.floor)
        spent = here.evaluations + fine.evaluations + place.evaluations
        return Outcome(status, proved, sigma, left + rest, place.floor, spent)

    def _status(self, place: Place, anchors: Sequence[Place]) -> tuple[str, bool]:
        if place.trouble is not None:
            return f"{UNRESOLVED}: {place.trouble}", False
        if place.counted:
            return (PROVED if place.growing else NONE_GROWS), True
        for anchor in anchors:
            if anchor.trouble is not None:
                return f"{UNRESOLVED}: no count on one side, {anchor.trouble}", False
        grows = any(s.real > self._settings.floor for s in place.modes.values())
        return (FOLLOWED if grows else NONE_GROWS), False

    @property
    def _rtol(self) -> float:
        return 10.0**-self._settings.digits

    def _with_bounds(self, outcomes: list[Outcome]) -> list[Outcome]:
        """The outcomes with whole error bounds: all parts are measured at two points, and counted SPREAD times at the others.

        Where the bound misses the digits, the point is refined by itself.
        """
        known = [i for i, o in enumerate(outcomes) if o.sigma is not None]
        audited: dict[int, Outcome] = {}
        for i in list(_from_both_ends(known))[:TRIES]:
            refined = self._refined(i, outcomes[i])
            if refined is not None:
                audited[i] = refined
            if len(audited) == AUDITS:
                break
        others = SPREAD * max((o.error or 0.0 for o in audited.values()), default=float("inf"))
        for i in known:
            outcomes[i] = audited.get(i) or self._bounded(i, outcomes[i], others)
        return outcomes

    def _bounded(self, i: int, outcome: Outcome, others: float) -> Outcome:
        assert outcome.sigma is not None and outcome.error is not None
        bound = outcome.error + others
        if bound <= self._rtol * abs(outcome.sigma):
            return replace(outcome, error=bound)
        refined = self._refined(i, outcome)
        if refined is not None:
            return refined
        why = f"{UNRESOLVED}: the error bound {bound:.1e} misses {self._settings.digits} digits"
        return replace(outcome, error=bound, status=why, proved=False)

    def _refined(self, i: int, outcome: Outcome) -> Outcome | None:
        """The mode with a proof that it is one and all parts of its error measured; None where that does not give the digits."""
        mode = refine(self._problem(float(self._first + i)), outcome.sigma, self._rtol)
        if not mode.converged or not _among(mode.sigma, [outcome.sigma]):
            return None
        return replace(outcome, sigma=mode.sigma, error=float(mode.error), evaluations=outcome.evaluations + mode.evaluations)


def _among(mode: complex, known: Iterable[complex | None]) -> bool:
    """Whether a number means one of the modes known."""
    return any(other is not None and abs(mode - other) <= SAME_MODE * abs(mode) for other in known)


def _from_both_ends(indices: Sequence[int]) -> Iterator[int]:
    """First, last, second, last but one, …"""
    low, high = 0, len(indices) - 1
    while low <= high:
        yield indices[low]
        if high > low:
            yield indices[high]
        low, high = low + 1, high - 1
