"""Where to begin: the nearest place at which the decaying space of a constant matrix is that of the problem.

Where the coefficients come to a limit, that is where they have come to it, whatever the solutions do: a mode that decays as e^{−0.02 z}
in a potential sech² z starts at z = 20. The error left is, to first order and component by component in the basis V of the solutions at
infinity,

    |V⁻¹| ∫_z^∞ |C⁻¹(ΔD − ΔC A)| ds |V|.

The place is that from which on the integrand is negligible against the rates, at a σ of the problem's own size: what each matrix is for
itself does not matter, as a D1 that vanishes at infinity shows. From which on: coefficients may be at their limit at first and leave it
farther out, as sech²(z − 40) does. So they are sampled over all distances first, and the place lies beyond the last sample off the limit.

Where they have no limit the matrix is frozen at z. Its space turns at the rate |ℓ2 A_z X|; of what it is wrong by, only that which
the integration towards the wall has not damped by the gap between the rates after half the way is an error of the mode.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from shootstab.core import polynomial
from shootstab.core.errors import InputError
from shootstab.problems.pencil_function import PencilFunction
from shootstab.problems.protocol import Pencil
from shootstab.problems.splitting import AsymptoticPencil, SpectralSplitting, gap

NEGLIGIBLE_RATE = 1e-20  # chosen: part of the rates; so |σ| may be 1e4 times the problem's own size before its rounding is passed
NEAREST_TRIED, FARTHEST_TRIED = 2.0**-10, 2.0**20  # chosen: distances tried
TAIL_SAMPLES = 64  # chosen: samples of the coefficients from a distance out to TAIL_LENGTH times it and 1 more
TAIL_LENGTH = 2.0  # chosen: the tail is sampled out to so many times the distance, 1 more
SCAN_RATIO = 1.02  # chosen: ratio of the distances of the scan; sech²(z − z0), 46 wide down to NEGLIGIBLE_RATE, is seen up to z0 = 2000
SCAN_BLOCKS = 30  # chosen: blocks of one octave each in which the scan is computed; what cannot be computed ends it
LIMIT_ROUNDING = 4 * float(np.finfo(float).eps)  # chosen: some roundings of an entry's limit: less does not say that the limit is left
WAY = 9  # chosen: points at which the gap is sampled between a frozen end and half the way
LARGEST_SIGMA = 1e6  # chosen: times the reference, the largest σ for which coefficients are to be at their limit
TURNING_STEP = 1e-3  # chosen: relative step of the difference that tells how fast the decaying space turns
ZERO_ROW = 1e-8  # chosen: the least size of a row of the decaying frame, in the largest


def limit_at(pencil: PencilFunction, direction: int, given: tuple[object, ...] | None, where: str) -> AsymptoticPencil:
    """The pencil at ±∞, as given or as the function says. Raises InputError where it says nothing finite."""
    source = pencil if given is None else PencilFunction(pencil.size, lambda z: given)
    try:
        return AsymptoticPencil(source.at(direction * math.inf), direction)
    except InputError as error:
        if given is not None:
            raise InputError(f"the limit given at {where}: {error}") from error
        advice = "allowed is a finite limit there, or st.Infinity(limit=...), or st.Infinity(start=...) where there is none"
        raise InputError(f"at {where}: {error}: {advice}") from error


@dataclass(frozen=True, eq=False)
class Approach:
    """How the coefficients come to their limit at one end, where k solutions decay at σ = reference; origin is where distances begin."""

    pencil: PencilFunction
    limit: AsymptoticPencil
    k: int
    reference: complex
    origin: float

    @cached_property
    def _split(self) -> SpectralSplitting:
        return self.limit.splitting(self.reference, self.k)

    @cached_property
    def _size(self) -> float:
        """The |σ| for which the limit is to be reached: of the problem's own size, next to the origin."""
        nearest = self.pencil.at(self.origin + self.limit.direction * NEAREST_TRIED)
        own = polynomial.size_of_root([float(np.abs(M).max()) for M in nearest.D])
        return min(max(abs(self.reference), own), LARGEST_SIGMA * abs(self.reference))

    def _integrand(self, at: Pencil, rounding: float = 0.0) -> NDArray[np.float64]:
        """The integrand (m,) at m points against the rates; an entry that is off by less than its rounding is at its limit."""
        split, ends = self._split, self.limit.pencil.named.values()
        off = [np.where(rounding * np.abs(end) < M, M, 0.0) for M, end in zip(_off(self.limit, at), ends, strict=True)]
        to_basis = np.abs(np.concatenate((split.left, split.left2)))
        from_basis = np.abs(np.concatenate((split.X, split.X2), axis=1))
        rates = float((to_basis @ np.abs(split.A) @ from_basis).max()) or 1.0
        moved = _moved(self.limit, off, split, self.reference, self._size)
        return np.asarray((to_basis @ moved @ from_basis).max(axis=(1, 2)) / rates)

    def settled(self, distance: float) -> bool:
        """Whether the coefficients are at their limit from this distance on, out to TAIL_LENGTH times it and one more."""
        z = self.origin + self.limit.direction * distance * np.geomspace(1.0, 1.0 + TAIL_LENGTH, TAIL_SAMPLES)
        return bool(self._integrand(self.pencil(z.astype(np.complex128))).max() <= NEGLIGIBLE_RATE)

    def off_the_limit(self, direction: int) -> NDArray[np.float64]:
        """The distances (k,) from the origin, of those surveyed in this direction, rising, at which the limit is not reached."""
        distances, at = _scanned(self.pencil, direction, self.origin)
        return distances if at is None else distances[self._integrand(at, LIMIT_ROUNDING) > NEGLIGIBLE_RATE]


def truncation_distance(approach: Approach, where: str) -> float:
    """How far from the origin the coefficients have come to their limit to rounding.

    Raises InputError where they come to it slower than exponentially.
    """
    far = float(max(approach.off_the_limit(approach.limit.direction), default=NEAREST_TRIED))
    while not approach.settled(far):
        far *= 2.0
        if far > FARTHEST_TRIED:
            raise InputError(
                f"at {where} the coefficients are not at their limit at |z| = {far / 2:.0e}: "
                "allowed are coefficients that come to it exponentially, or st.Infinity(start=...)"
            )
    if far == NEAREST_TRIED:
        return far
    low, high = far / 2, far
    for _ in range(5):
        middle = 0.5 * (low + high)
        low, high = (low, middle) if approach.settled(middle) else (middle, high)
    return high


def middle(left: Approach, right: Approach) -> float:
    """The middle of where the coefficients are off their limits, seen from the origin of both; the origin if it lies there."""
    edges = []
    for approach in (left, right):
        outwards = approach.limit.direction
        outer = approach.off_the_limit(outwards)[-1:]
        inner = approach.off_the_limit(-outwards)[:1]
        edges.append(approach.origin + outwards * (outer[0] if outer.size else -inner[0] if inner.size else 0.0))
    low, high = edges
    return left.origin if low <= left.origin <= high or not low < high else float(0.5 * (low + high))


def tails(pencil: PencilFunction, limit: AsymptoticPencil, origin: float, distance: float) -> tuple[NDArray[np.float64], ...]:
    """∫|ΔC0|, ∫|ΔC1|, …, ∫|ΔD0|, …, each (n, n), from there outwards; beyond the samples as of coefficients that fall off as 1/s²."""
    s = distance * np.geomspace(1.0, 1.0 + TAIL_LENGTH, TAIL_SAMPLES)
    at = pencil((origin + limit.direction * s).astype(np.complex128))
    return tuple(np.trapezoid(M, s, axis=0) + s[-1] * M[-1] for M in _off(limit, at))


def tail_error(limit: AsymptoticPencil, tail: tuple[NDArray[np.float64], ...], split: SpectralSplitting, sigma: complex) -> float:
    """The relative error of the frame, largest over its rows, that coefficients off their limit by a tail (n, n) each make."""
    if not any(part.any() for part in tail):
        return 0.0
    moved = _moved(limit, tail, split, sigma, abs(sigma))
    return _relative(split, np.abs(np.concatenate((split.left, split.left2))) @ moved @ np.abs(split.X))


def _moved(
    limit: AsymptoticPencil, off: Sequence[NDArray[np.float64]], split: SpectralSplitting, sigma: complex, size: float
) -> NDArray[np.float64]:
    """|C⁻¹| (|ΔD| + |ΔC| |A|), (…, n, n), for |ΔC0|, |ΔC1|, …, |ΔD0|, … of the same shape and |σ| = size in them."""
    C, D = (polynomial.value(part, size) for part in (off[: len(off) // 2], off[len(off) // 2 :]))
    inverse = np.abs(np.linalg.inv(polynomial.value(limit.pencil.C, sigma)))
    return np.asarray(inverse @ (D + C @ np.abs(split.A)))


def frozen_error(
    pencil: PencilFunction, limit: AsymptoticPencil, origin: float, z: float, split: SpectralSplitting, k: int, sigma: complex
) -> float:
    """The relative error that the frozen space at z makes after half the way to the origin, damped by the gap."""
    step = TURNING_STEP * (z - origin)
    near = AsymptoticPencil(pencil.at(z - step), limit.direction).matrix(sigma)[0]
    turning = np.abs(split.left2 @ (split.A - near) @ split.X) / abs(step)
    way = np.linspace(1.0, 0.5, WAY)
    gaps = [gap(AsymptoticPencil(pencil.at(origin + (z - origin) * x), limit.direction).rates(sigma), k) for x in way]
    damped = math.exp(-float(np.trapezoid(gaps[::-1], abs(z - origin) * way[::-1])))
    return damped * _relative(split, np.concatenate((np.zeros((k, k)), turning / gaps[0])))


def _relative(split: SpectralSplitting, moved: NDArray[np.float64]) -> float:
    """|V| moved against the size of X, row by row; rows of X that are as good as zero count as ZERO_ROW of the largest.

    It is 0 where nothing decays.
    """
    if split.X.shape[1] == 0:
        return 0.0
    rows = np.linalg.norm(split.X, axis=1)
    change = (np.abs(np.concatenate((split.X, split.X2), axis=1)) @ moved).max(axis=1)
    return float((change / np.maximum(rows, ZERO_ROW * rows.max())).max())


def _scanned(pencil: PencilFunction, direction: int, origin: float) -> tuple[NDArray[np.float64], Pencil | None]:
    """Distances (m,) over all that are tried, and the pencil there, up to where it cannot be computed; None if that is nowhere.

    cosh overflows at 711, and exp(2z)/(1 + exp(2z))² is no number from z = 355 on: what lies beyond is not seen.
    """
    distances = np.exp(np.arange(math.log(NEAREST_TRIED), math.log(FARTHEST_TRIED), math.log(SCAN_RATIO)))
    z = (origin + direction * distances).astype(np.complex128)
    seen: list[Pencil] = []
    for block in np.array_split(z, SCAN_BLOCKS):
        try:
            seen.append(pencil(block))
        except InputError:
            for point in block:
                at = _at_point(pencil, point)
                if at is None:
                    break
                seen.append(at)
            break
    if not seen:
        return distances[:0], None
    C, D = ([np.concatenate(power) for power in zip(*parts, strict=True)] for parts in ([p.C for p in seen], [p.D for p in seen]))
    return distances[: len(C[0])], Pencil.of(C, D)


def _at_point(pencil: PencilFunction, z: complex) -> Pencil | None:
    """The matrices at one point, each (1, n, n); None where they cannot be computed."""
    try:
        return pencil(np.array([z], dtype=np.complex128))
    except InputError:
        return None


def _off(limit: AsymptoticPencil, at: Pencil) -> list[NDArray[np.float64]]:
    """|ΔC0|, |ΔC1|, …, |ΔD0|, …, by which the matrices lie off their limit."""
    return [np.abs(M - end) for M, end in zip(at.named.values(), limit.pencil.named.values(), strict=True)]
