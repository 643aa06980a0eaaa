"""From ends and interfaces to subdomains, and the counts that must agree: as many solutions as conditions."""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass

import numpy as np
import scipy.linalg

from shootstab.core.errors import InputError, ShootstabError
from shootstab.problems.decaying_space import ConstantSpace, DecayingSpace
from shootstab.problems.ends import Infinity, Interface, Wall
from shootstab.problems.kato_frame import KatoFrame, reference_points
from shootstab.problems.pencil_function import PencilFunction
from shootstab.problems.protocol import ComplexArray
from shootstab.problems.splitting import AsymptoticPencil, decaying_count, gap
from shootstab.problems.subdomains import Subdomain
from shootstab.problems.truncation import limit_at, tails, truncation_distance

SAMPLES = 2001  # of a line on which a continuum is sampled
SIDES = {-1: "left", 1: "right"}
NAMES = {-1: "-infinity", 1: "+infinity"}


@dataclass(frozen=True, eq=False)
class TwoPointReduction:
    """The subdomains, all from t = start to t = end, and the rows (W0, W1) that hold at t = end."""

    subdomains: tuple[Subdomain, ...]
    start: float
    end: float
    rows: tuple[ComplexArray, ComplexArray]

    @property
    def size(self) -> int:
        """Components of all subdomains."""
        return int(self.rows[0].shape[1])

    @property
    def lines(self) -> tuple[ComplexArray, ...]:
        """Points of each subdomain, real z."""
        t = np.linspace(self.start, self.end, SAMPLES)
        return tuple((subdomain.offset + subdomain.scale * t).astype(np.complex128) for subdomain in self.subdomains)


def reduce_to_two_points(
    matrices: PencilFunction,
    left: Wall | Infinity,
    right: Wall | Infinity,
    interfaces: tuple[Interface, ...],
    fold: float,
    near: complex | None,
) -> TwoPointReduction:
    """Raises InputError for a problem that does not fit together."""
    n = matrices.size
    joints = _joints(left, right, interfaces)
    ends = {-1: left, 1: right}
    rows = {side: end.matrices(n, SIDES[side]) for side, end in ends.items() if isinstance(end, Wall)}
    limits = _limits(matrices, ends)
    counts, reference = _counts(n, ends, rows, limits, near)
    if not joints and isinstance(left, Infinity) and isinstance(right, Infinity):
        joints = (Interface(fold, np.eye(n), -np.eye(n)),)
    origin = {-1: joints[0].z if joints else _place(right), 1: joints[-1].z if joints else _place(left)}
    truncation = {
        side: _truncation(matrices, end, limits[side], side, origin[side]) for side, end in ends.items() if isinstance(end, Infinity)
    }
    T = max(truncation.values(), default=1.0)

    def far(side: int) -> DecayingSpace | ConstantSpace:
        """The space at an end, or all of Cⁿ at a wall whose rows hold σ."""
        end = ends[side]
        if isinstance(end, Wall):
            free = np.eye(n, dtype=np.complex128) if rows[side][1].any() else _null_space(rows[side][0])
            return ConstantSpace(np.asarray(free, dtype=np.complex128))
        distance = T if joints else truncation[side]
        limit = limits[side]
        tail = None if end.start is not None else tails(matrices, limit, origin[side], distance)
        z = origin[side] + side * distance
        if end.start is not None:
            limit = AsymptoticPencil(*matrices.at(z), side)
        return DecayingSpace(KatoFrame(limit, counts[side], reference, distance), matrices, origin[side], z, tail, NAMES[side])

    if not joints:
        return _one_subdomain(ends, rows, truncation, far)
    return _many_subdomains(n, ends, rows, joints, T, far)


def _one_subdomain(ends, rows, truncation, far) -> TwoPointReduction:  # type: ignore[no-untyped-def]
    """t is z itself: from infinity to the wall, or from the wall whose rows do not hold σ to the other."""
    side = next((s for s in (-1, 1) if isinstance(ends[s], Infinity)), None)
    if side is None:
        side = next((s for s in (-1, 1) if not rows[s][1].any()), None)
    if side is not None:
        end = _place(ends[-side])
        start = end + side * truncation[side] if side in truncation else _place(ends[side])
        return TwoPointReduction((Subdomain(0.0, 1.0, far(side)),), start, end, rows[-side])
    W0, W1 = (scipy.linalg.block_diag(a, b) for a, b in zip(rows[-1], rows[1], strict=True))
    return TwoPointReduction((Subdomain(0.0, 1.0, far(-1), augmented=True),), _place(ends[-1]), _place(ends[1]), (W0, W1))


def _many_subdomains(n, ends, rows, joints, T, far) -> TwoPointReduction:  # type: ignore[no-untyped-def]
    """One subdomain to the left of the first joint, one to the right of the last, and augmented ones between them."""
    subdomains: list[Subdomain] = []
    inner: list[int] = []  # first column of ψ of each subdomain
    outer: list[int] = []  # and of a, or of ψ where there is no a

    def add(offset: float, scale: float, space: DecayingSpace | ConstantSpace, augmented: bool, at: tuple[float, ...]) -> None:
        begin = outer[-1] + n * (1 + subdomains[-1].augmented) if subdomains else 0
        subdomains.append(Subdomain(offset, scale, space, augmented, at))
        outer.append(begin)
        inner.append(begin + n * augmented)

    def add_end(side: int, joint: Interface) -> None:
        end = ends[side]
        rate = 1.0 if isinstance(end, Infinity) else abs(end.z - joint.z) / T
        add(joint.z, side * rate, far(side), isinstance(end, Wall) and bool(rows[side][1].any()), (joint.z,))

    add_end(-1, joints[0])
    for a, b in itertools.pairwise(joints):
        add(b.z, -(b.z - a.z) / T, ConstantSpace(np.eye(n, dtype=np.complex128)), True, (a.z, b.z))
    add_end(1, joints[-1])
    size = outer[-1] + n * (1 + subdomains[-1].augmented)
    W: list[list[ComplexArray]] = [[], []]
    for side, at in ((-1, 0), (1, -1)):
        if subdomains[at].augmented:
            for part, row in zip(W, rows[side], strict=True):
                part.append(_placed(row, outer[at], size))
    for j, joint in enumerate(joints):
        for part, M in zip(W, joint.matrices(n), strict=True):
            behind = inner[j + 1] if j + 1 == len(joints) else outer[j + 1]
            part.append(_placed(M[:, :n], inner[j], size) + _placed(M[:, n:], behind, size))
    return TwoPointReduction(tuple(subdomains), T, 0.0, (np.concatenate(W[0]), np.concatenate(W[1])))


def _placed(rows: ComplexArray, first: int, size: int) -> ComplexArray:
    """Rows over the components from first on, and zeros for the others."""
    out = np.zeros((len(rows), size), dtype=np.complex128)
    out[:, first : first + rows.shape[1]] = rows
    return out


def _joints(left: Wall | Infinity, right: Wall | Infinity, interfaces: tuple[Interface, ...]) -> tuple[Interface, ...]:
    """The interfaces from left to right."""
    joints = tuple(sorted(interfaces, key=lambda joint: joint.z))
    places = [_place(left, -1), *(joint.z for joint in joints), _place(right, 1)]
    if not all(a < b for a, b in itertools.pairwise(places)):
        listed = ", ".join(f"{z:g}" for z in places)
        raise InputError(f"ends and interfaces lie at z = {listed}: allowed are different points, the left end first")
    return joints


def _place(end: Wall | Infinity, side: int = 0) -> float:
    return end.z if isinstance(end, Wall) else side * math.inf


def _limits(matrices: PencilFunction, ends: dict[int, Wall | Infinity]) -> dict[int, AsymptoticPencil]:
    """What the pencil is at the infinite ends; frozen where there is no limit."""
    limits = {}
    for side, end in ends.items():
        if isinstance(end, Infinity):
            if end.start is not None:
                limits[side] = AsymptoticPencil(*matrices.at(side * end.start), side)
            else:
                limits[side] = limit_at(matrices, side, end.limit, NAMES[side])
    return limits


def _truncation(matrices: PencilFunction, end: Infinity, limit: AsymptoticPencil, side: int, origin: float) -> float:
    """How far from origin to begin."""
    if end.start is None:
        return truncation_distance(matrices, limit, origin, NAMES[side])
    distance = end.start - side * origin
    if distance <= 0.0:
        raise InputError(f"at {NAMES[side]} start = {end.start:g}: allowed is a |z| beyond {origin:g}")
    return distance


def _counts(
    n: int,
    ends: dict[int, Wall | Infinity],
    rows: dict[int, tuple[ComplexArray, ComplexArray]],
    limits: dict[int, AsymptoticPencil],
    near: complex | None,
) -> tuple[dict[int, int], complex]:
    """How many solutions begin at each end, and a σ at which as many decay, by the widest gap."""
    fixed = {side: n - len(W0) for side, (W0, _) in rows.items()}
    if len(fixed) == 2 and sum(fixed.values()) != n:
        conditions = [len(W0) for W0, _ in rows.values()]
        told = f"{conditions[0]} rows at the left wall and {conditions[1]} at the right"
        raise InputError(f"{told}: allowed are {n} in all, the order of the system")
    wanted = {s: end.decaying for s, end in ends.items() if isinstance(end, Infinity) and end.decaying is not None}
    for side, k in wanted.items():
        if not 0 <= k <= n:
            raise InputError(f"at {NAMES[side]} decaying = {k}: allowed is 0 to {n}")
    best: tuple[float, complex, dict[int, int]] | None = None
    seen = ""
    for sigma in reference_points().tolist() if near is None else [complex(near)]:
        try:
            rates = {side: limit.rates(sigma) for side, limit in limits.items()}
        except (np.linalg.LinAlgError, ShootstabError) as error:  # C is singular at this σ: not one to begin at
            seen = seen or str(error)
            continue
        counts = {**fixed, **{side: decaying_count(r) for side, r in rates.items()}}
        told = " and ".join(f"{counts[s]} of {n} solutions decay towards {NAMES[s]}" for s in rates)
        seen = seen or f"{told} at sigma = {sigma:g}"
        if sum(counts.values()) != n or any(counts[s] != k for s, k in wanted.items()):
            continue
        width = min((gap(r, counts[s]) / np.abs(r).max() for s, r in rates.items() if np.abs(r).max() > 0.0), default=math.inf)
        width /= 1.0 + abs(math.log10(abs(sigma)))  # and not far from where modes are
        # growth comes first: another direction must be wider by far
        if best is None or width > (1.0 if (best[1].real > 0.0) == (sigma.real > 0.0) else 100.0) * best[0]:
            best = (width, sigma, counts)
    if best is not None:
        return best[2], best[1]
    if len(limits) == 1:
        ((side, _),) = limits.items()
        at_wall = len(rows[-side][0])
        asked = f"{at_wall} rows at the wall ask for {at_wall}"
    else:
        asked = f"allowed are {n} in all, the order of the system"
    if wanted:
        asked += ", and " + " and ".join(f"decaying = {k} was given at {NAMES[s]}" for s, k in wanted.items())
    raise InputError(f"{seen}, and nowhere as many as needed: {asked}")


def _null_space(W0: ComplexArray) -> ComplexArray:
    """The solutions (n, n−m) that rows (m, n) allow; unit vectors where rows are."""
    used = np.flatnonzero((W0 != 0).any(axis=0))
    if len(used) == len(W0):
        return np.delete(np.eye(W0.shape[1], dtype=np.complex128), used, axis=1)
    return np.asarray(scipy.linalg.null_space(W0), dtype=np.complex128)
