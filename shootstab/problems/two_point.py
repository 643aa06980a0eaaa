"""The two-point reduction: ends and interfaces as subdomains on one line, with the rows that hold where all of them arrive.

Without an interface there is one subdomain and t is z itself. On the whole line with its fold, or with interfaces whose conditions hold σ
or cannot be solved, t = 0 is where a subdomain meets the next, and all begin at the same t: see subdomains.py. Other interfaces a
subdomain runs across: see crossed.py.
"""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import scipy.linalg
from numpy.typing import NDArray

from shootstab.core.errors import InputError
from shootstab.problems.beginnings import InfiniteBeginning, WallBeginning, infinite_beginning
from shootstab.problems.consistent_splitting import ConsistentSplitting, EndConditions, consistent_splitting
from shootstab.problems.crossed import Crossed, can_be_crossed
from shootstab.problems.decaying_space import ConstantSpace, DecayingSpace
from shootstab.problems.ends import INFINITIES, WALLS, Infinity, Interface, Wall
from shootstab.problems.knots import hair, pair
from shootstab.problems.pencil_function import PencilFunction
from shootstab.problems.protocol import ComplexArray
from shootstab.problems.splitting import AsymptoticPencil
from shootstab.problems.subdomains import Subdomain
from shootstab.problems.truncation import Approach, limit_at, middle
from shootstab.problems.unknowns import Placement

LINE = 2001  # chosen: points of a subdomain at which a continuous spectrum that no path leads around is sampled

Beginnings = dict[int, WallBeginning | InfiniteBeginning]  # beginnings by side: −1 left, +1 right


@dataclass(frozen=True, eq=False)
class TwoPointReduction:
    """The subdomains, all from t = start to t = end, and the rows (W0, W1, …), each (k, size), that hold at t = end."""

    subdomains: tuple[Subdomain, ...]
    start: float
    end: float
    rows: tuple[ComplexArray, ...]

    @property
    def size(self) -> int:
        """Components of all subdomains."""
        return int(self.rows[0].shape[1])

    def over(self, start: float, end: float) -> TwoPointReduction:
        """The reduction with its line laid out from t = start to t = end."""
        stretch = (self.end - self.start) / (end - start)
        shift = self.start - stretch * start
        return TwoPointReduction(tuple(subdomain.on(shift, stretch) for subdomain in self.subdomains), start, end, self.rows)

    @property
    def intervals(self) -> tuple[tuple[float, float], ...]:
        """The z that each subdomain covers, rising."""
        ends = [sorted(subdomain.offset + subdomain.scale * t for t in (self.start, self.end)) for subdomain in self.subdomains]
        return tuple((low, high) for low, high in ends)

    @property
    def starts(self) -> dict[int, float]:
        """The |z| at which ends at infinity begin, by side, of those that lie on that side of z = 0."""
        return {far.kato_frame.limit.direction: abs(far.z) for far in self._at_infinity if far.kato_frame.limit.direction * far.z > 0.0}

    @property
    def reference(self) -> complex | None:
        """The σ at which decaying solutions are counted; None without an end at infinity."""
        return next((far.kato_frame.reference for far in self._at_infinity), None)

    @property
    def _at_infinity(self) -> list[DecayingSpace]:
        return [subdomain.far for subdomain in self.subdomains if isinstance(subdomain.far, DecayingSpace)]

    def placements(self, size: int) -> tuple[Placement, ...]:
        """Where the components of each subdomain, so many in the user's pencil, live; of an augmented one those of ψ, behind those of a."""
        first, out = 0, []
        for subdomain in self.subdomains:
            first += size * subdomain.augmented
            out.append(Placement(subdomain.offset, subdomain.scale, first, size, subdomain.crossed, subdomain.inner))
            first += size
        return tuple(out)

    def pairs(self, knots: NDArray[np.float64]) -> NDArray[np.float64]:
        """The t (M, 2) on either side of each z of the knots (K,), in every subdomain that it lies inside."""
        found = []
        for subdomain, (low, high) in zip(self.subdomains, self.intervals, strict=True):
            for knot in knots[(knots > low) & (knots < high)].tolist():
                found.append([(z - subdomain.offset) / subdomain.scale for z in pair(knot, high - low, subdomain.offset)])
        return np.array(found).reshape(-1, 2)

    @property
    def jumps(self) -> NDArray[np.float64]:
        """The z (k,) of the interfaces that a subdomain runs across."""
        return np.concatenate([[], *(subdomain.crossed.places for subdomain in self.subdomains if subdomain.crossed is not None)])

    @property
    def lines(self) -> tuple[ComplexArray, ...]:
        """Real points z (m,) of each subdomain, in the order of t, on every stretch between interfaces that it runs across."""
        found = []
        for subdomain in self.subdomains:
            way = subdomain.crossed.places.tolist() if subdomain.crossed is not None else []
            ends = [subdomain.offset + subdomain.scale * t for t in (self.start, self.end)]
            for a, b in itertools.pairwise([ends[0], *way, ends[1]]):
                z = np.linspace(a, b, LINE)
                off = float(hair(max(abs(a), abs(b)), abs(b - a)))
                found.append(np.clip(z, min(a, b) + off * (a in way), max(a, b) - off * (b in way)).astype(np.complex128))
        return tuple(found)


def reduce_to_two_points(
    pencil: PencilFunction,
    left: Wall | Infinity,
    right: Wall | Infinity,
    interfaces: tuple[Interface, ...],
    fold: float | None,
    near: complex | None,
) -> TwoPointReduction:
    """The reduction; without a fold both sides of the whole line meet where the coefficients vary.

    near is a σ at which the solutions that decay are as many as are wanted, None if that is to be found.

    Raises InputError for a problem that does not fit together.
    """
    n = pencil.size
    ordered = _ordered(left, right, interfaces)
    walls = {side: WallBeginning.of(end, side, n) for side, end in ((-1, left), (1, right)) if isinstance(end, Wall)}
    infinities = {side: end for side, end in ((-1, left), (1, right)) if isinstance(end, Infinity)}
    limits = {side: limit_of_end(pencil, end, side) for side, end in infinities.items()}
    splitting = _splitting(n, walls, infinities, limits, near)
    whole_line = len(infinities) == 2
    if fold is None:
        fold = _fold(pencil, infinities, limits, splitting) if whole_line and not ordered else 0.0
    joints, crossed = _divided(ordered, n, whole_line, fold)
    beginnings: Beginnings = dict(walls)
    for side, end in infinities.items():
        origin = (joints[0].z if side < 0 else joints[-1].z) if joints else walls[-side].z
        begun = infinite_beginning(pencil, end, limits[side], splitting.counts[side], splitting.reference, origin)
        beginnings[side] = begun.beyond([joint.z for joint in crossed])
    return _many_subdomains(n, beginnings, joints, crossed) if joints else _one_subdomain(n, beginnings, crossed)


def _divided(ordered: tuple[Interface, ...], n: int, whole_line: bool, fold: float) -> tuple[tuple[Interface, ...], tuple[Interface, ...]]:
    """The interfaces at which subdomains meet, and those that they run across. On the whole line one is the fold, made where none is."""
    crossed = [joint for joint in ordered if can_be_crossed(joint, n)]
    way = Crossed.on_the_way(crossed, -np.inf, np.inf, 1.0, n)
    if way is not None and not way.well_conditioned:
        crossed = []
    if whole_line and len(crossed) == len(ordered):
        if not ordered:
            return (Interface(fold, np.eye(n), -np.eye(n)),), ()
        crossed.remove(min(crossed, key=lambda joint: abs(joint.z - fold)))
    return tuple(joint for joint in ordered if joint not in crossed), tuple(crossed)


def _ordered(left: Wall | Infinity, right: Wall | Infinity, interfaces: tuple[Interface, ...]) -> tuple[Interface, ...]:
    """The interfaces from left to right. Raises InputError where they do not lie between the ends."""
    joints = tuple(sorted(interfaces, key=lambda joint: joint.z))
    places = [
        left.z if isinstance(left, Wall) else -np.inf,
        *(joint.z for joint in joints),
        right.z if isinstance(right, Wall) else np.inf,
    ]
    if not all(a < b for a, b in itertools.pairwise(places)):
        listed = ", ".join(f"{z:g}" for z in places)
        raise InputError(f"ends and interfaces lie at z = {listed}: allowed are different points, the left end first")
    return joints


def limit_of_end(pencil: PencilFunction, end: Infinity, side: int) -> AsymptoticPencil:
    """What the pencil is at an infinite end; frozen at the start where it has no limit."""
    if end.expansion is not None:
        return end.expansion.limit
    if end.start is not None and end.limit is None:
        return AsymptoticPencil(pencil.at(side * end.start), side)
    return limit_at(pencil, side, end.limit, INFINITIES[side])


def _fold(
    pencil: PencilFunction, infinities: dict[int, Infinity], limits: dict[int, AsymptoticPencil], splitting: ConsistentSplitting
) -> float:
    """0, or where the coefficients are at their limits there, the middle of where they are not: no mode lives far from that."""
    if any(end.start is not None or end.expansion is not None for end in infinities.values()):
        return 0.0
    left, right = (Approach(pencil, limits[side], splitting.counts[side], splitting.reference, 0.0) for side in (-1, 1))
    return middle(left, right)


def _splitting(
    n: int, walls: dict[int, WallBeginning], infinities: dict[int, Infinity], limits: dict[int, AsymptoticPencil], near: complex | None
) -> ConsistentSplitting:
    """How many solutions begin at each end. Raises InputError where they are not as many as conditions."""
    free = {side: n - len(wall.rows[0]) for side, wall in walls.items()}
    if len(free) == 2 and sum(free.values()) != n:
        told = " and ".join(f"{n - k} rows at the {WALLS[side]} wall" for side, k in free.items())
        raise InputError(f"{told}: allowed are {n} in all, the order of the system")
    given = {side: end.decaying for side, end in infinities.items() if end.decaying is not None}
    for side, k in given.items():
        if not 0 <= k <= n:
            raise InputError(f"at {INFINITIES[side]} decaying = {k}: allowed is 0 to {n}")
    return consistent_splitting(EndConditions(n, free, limits, given), near)


def _one_subdomain(n: int, beginnings: Beginnings, crossed: tuple[Interface, ...]) -> TwoPointReduction:
    """The one subdomain from infinity to the wall, or from a wall whose rows do not hold σ to the other; where both hold it, augmented."""
    for side, far in sorted(beginnings.items(), key=lambda item: isinstance(item[1], WallBeginning)):
        other = beginnings[-side]
        if isinstance(other, WallBeginning) and not far.holds_sigma:
            way = Crossed.on_the_way(crossed, -np.inf, np.inf, float(-side), n)
            subdomain = Subdomain(0.0, 1.0, far.space(far.distance), crossed=way)
            return TwoPointReduction((subdomain,), far.z, other.z, tuple(map(subdomain.arriving, other.rows)))
    left, right = beginnings[-1], beginnings[1]
    assert isinstance(left, WallBeginning) and isinstance(right, WallBeginning)
    subdomain = Subdomain(0.0, 1.0, left.space(0.0), augmented=True, crossed=Crossed.on_the_way(crossed, -np.inf, np.inf, 1.0, n))
    arriving = tuple(map(subdomain.arriving, right.rows))
    rows = tuple(scipy.linalg.block_diag(a, b) for a, b in zip(*_to_one_degree([left.rows, arriving]), strict=True))
    return TwoPointReduction((subdomain,), left.z, right.z, rows)


def _many_subdomains(n: int, beginnings: Beginnings, joints: tuple[Interface, ...], crossed: tuple[Interface, ...]) -> TwoPointReduction:
    """One subdomain to the left of the first joint, one to the right of the last, and augmented ones between them, over t from T to 0."""
    T = max((b.distance for b in beginnings.values() if isinstance(b, InfiniteBeginning)), default=1.0)

    def outermost(side: int, joint: Interface) -> Subdomain:
        begun = beginnings[side]
        length = abs(begun.z - joint.z)
        way = Crossed.on_the_way(crossed, *((-np.inf, joint.z) if side < 0 else (joint.z, np.inf)), float(-side), n)
        return Subdomain(joint.z, side * length / T, begun.space(length), begun.holds_sigma, (joint.z,), way)

    free = ConstantSpace(np.eye(n, dtype=np.complex128))
    between = [
        Subdomain(b.z, -(b.z - a.z) / T, free, True, (a.z, b.z), Crossed.on_the_way(crossed, a.z, b.z, 1.0, n))
        for a, b in itertools.pairwise(joints)
    ]
    subdomains = (outermost(-1, joints[0]), *between, outermost(1, joints[-1]))
    # the places of each subdomain: the first component of its beginning, a or ψ, and that of ψ where it arrives
    widths = [n * (1 + subdomain.augmented) for subdomain in subdomains]
    begins = [sum(widths[:j]) for j in range(len(widths))]
    arrives = [begin + n * subdomain.augmented for begin, subdomain in zip(begins, subdomains, strict=True)]
    parts: list[tuple[ComplexArray, ...]] = []
    for side, at in ((-1, 0), (1, -1)):
        begun = beginnings[side]
        if isinstance(begun, WallBeginning) and begun.holds_sigma:
            parts.append(tuple(_placed(W, begins[at], sum(widths)) for W in begun.rows))
    for j, joint in enumerate(joints):
        # the solution of the last subdomain arrives at its joint; of one in between it is a, its value where it begins
        last = j + 1 == len(joints)
        behind = arrives[j + 1] if last else begins[j + 1]
        powers = []
        for M in joint.matrices(n):
            after = subdomains[j + 1].arriving(M[:, n:]) if last else M[:, n:]
            powers.append(_placed(subdomains[j].arriving(M[:, :n]), arrives[j], sum(widths)) + _placed(after, behind, sum(widths)))
        parts.append(tuple(powers))
    rows = tuple(np.concatenate(power) for power in zip(*_to_one_degree(parts), strict=True))
    return TwoPointReduction(subdomains, T, 0.0, rows)


def _to_one_degree(polynomials: Sequence[tuple[ComplexArray, ...]]) -> list[tuple[ComplexArray, ...]]:
    """Each with zeros for the higher powers that it lacks."""
    most = max(map(len, polynomials))
    return [(*p, *[np.zeros_like(p[0]) for _ in range(most - len(p))]) for p in polynomials]


def _placed(rows: ComplexArray, first: int, size: int) -> ComplexArray:
    """Rows (m, ·) over the components from first on, and zeros for the others, (m, size)."""
    out = np.zeros((len(rows), size), dtype=np.complex128)
    out[:, first : first + rows.shape[1]] = rows
    return out
