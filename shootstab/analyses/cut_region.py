"""How many modes a region holds, cut along the continuous spectrum.

The contour is the boundary of the region, both sides of every part of the curve inside it, and small circles around the ends of the
curve that lie inside. On the curve D has two values, one continued from each side, and both are computed there along deformed paths. With z
rising, the left side of the curve is the one of singular points above the real z-axis (σ_c is analytic, so it keeps orientation):

    2πi n = Σ_boundary Δ ln D + Σ_curve (Δ ln D_left − Δ ln D_right) − Σ_ends ∮ d ln D.

What lies inside the circles around the ends is not counted, and is named.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from itertools import pairwise

import numpy as np

from shootstab.analyses.accuracy import Inaccurate, MeshedValue, require_accurate
from shootstab.core.discriminant import Value
from shootstab.core.division import BISECTIONS
from shootstab.core.errors import ConvergenceError
from shootstab.core.regions import Disc, Region, size
from shootstab.core.scaled import EPSILON
from shootstab.discriminants.continuation import Continuation, Undecidable
from shootstab.discriminants.method import MeshedDiscriminant
from shootstab.discriminants.shared_meshes import SharedMeshes
from shootstab.essential_spectrum.interior import SampledContinuum
from shootstab.roots.winding import Legs, change, follow, whole_turns

END_RADIUS = 1e-5  # chosen: radius of the circles around the ends, in the extent of the curve
OFF = 1e-9  # chosen: how far from a crossing, in t or in z, the two sides are told apart
ROUNDINGS = 64  # chosen: the same in roundings of σ, for a region so small that its boundary rounds to more
RIM_OF_END = 16  # chosen: points of such a circle that must all lie in the region
CLOSURE_SLACK = 1e-2  # chosen: part of a turn, as the legs of the contour meet to OFF only


@dataclass(frozen=True)
class RegionCount:
    """count modes in the region outside the discs left_out, which surround ends of the continuous spectrum.

    closure is how far from a whole number the turns of D's phase were; evaluations how often D was computed; legs the contour; cut says
    whether the continuous spectrum enters the region.
    """

    count: int
    closure: float
    left_out: tuple[Disc, ...]
    evaluations: int
    legs: Legs = field(default=(), repr=False)
    cut: bool = False


class _Contour:
    """Legs of a contour, followed one after the other, with every sample and the discriminant that it is of.

    The legs are those of D without a factor that has no zero and no singular point in the region, the samples those of D.
    """

    def __init__(
        self, continuation: Continuation, most: float, without: Callable[[Value], Value] | None, meshes: SharedMeshes | None
    ) -> None:
        self.continuation, self.most, self._without = continuation, most, without
        self.samples: list[MeshedValue] = []
        self._meshes = SharedMeshes() if meshes is None else meshes
        self.legs: list[tuple[int, tuple[Value, ...]]] = []

    def off_the_curve(self, sigma: complex) -> Value:
        """D along whatever path suits σ: it is the same function."""
        return self._value(self._meshes.at(self.continuation.along(sigma)[0], sigma), sigma)

    def begin_at(self, sigma: complex) -> None:
        """Have a mesh for σ, which most others may share where it asks most of one; that there is none is said when σ is asked for."""
        with suppress(ConvergenceError):
            self._meshes.at(self.continuation.along(sigma)[0], sigma)

    def on_the_curve(self, z: float, side: int) -> Value:
        """D at σ_c(z), continued from the side of singular points above (+1) or below (−1) the real z-axis."""
        assert self.continuation.continuum is not None
        sigma = self.continuation.continuum.at(z)
        return self._value(self.continuation.beside(z, sigma, side).discriminant, sigma)

    def follow(self, sign: int, evaluate: Callable[[float], Value], stops: Sequence[float], closed: bool = False) -> None:
        """Add a leg, which counts with this sign."""
        self.legs.append((sign, tuple(follow(evaluate, stops, closed))))

    def counted(self, left_out: tuple[Disc, ...], cut: bool) -> RegionCount:
        """The turns of D's phase as a number of modes. Raises Inaccurate where D is not known well enough for it."""
        phase = sum(sign * sum(change(a, b).imag for a, b in pairwise(values)) for sign, values in self.legs)
        count = whole_turns(phase, CLOSURE_SLACK)
        require_accurate(self.continuation.problem, self.samples)
        closure = abs(phase / (2 * math.pi) - count)
        return RegionCount(count, closure, left_out, sum(len(values) for _, values in self.legs), tuple(self.legs), cut)

    def _value(self, discriminant: MeshedDiscriminant, sigma: complex) -> Value:
        value = discriminant.with_derivative(sigma)
        self.samples.append((discriminant, value))
        if len(self.samples) > self.most:
            raise Inaccurate(
                f"D is noise along the contour, or has too many zeros next to it: {len(self.samples)} samples do not follow it"
            )
        return value if self._without is None else self._without(value)


def count_in_region(
    continuation: Continuation,
    region: Region,
    most: float = math.inf,
    without: Callable[[Value], Value] | None = None,
    meshes: SharedMeshes | None = None,
) -> RegionCount:
    """Count the modes in a region, with so many samples of D at most.

    without divides D by a function that is analytic and not 0 in the region: the quotient may turn less along the contour. meshes are those
    that other contours left, and receive the new ones.
    Raises Undecidable where the continuous spectrum runs over itself, or an end of it lies on the boundary; Inaccurate where D is not
    known well enough, or most samples do not suffice; ConvergenceError where a mode lies on the contour.
    """
    if continuation.barrier is not None and continuation.barrier.enters(region):
        raise Undecidable(f"{continuation.barrier.name} enters the region")
    if continuation.barrier is not None and continuation.barrier.beyond(region.boundary(0.0)):
        raise Undecidable("the region lies beyond the continuous spectrum of an end at infinity")
    curve = continuation.continuum
    contour = _Contour(continuation, most, without, meshes)
    if curve is None:
        _follow_boundary(contour, region, region.corners, closed=True)
        return contour.counted((), False)
    inside = parts_inside(curve, region)
    if inside and _runs_over_itself(curve):
        raise Undecidable("the continuous spectrum runs over itself inside the region: nothing tells the sides apart")
    ends = ends_inside(curve, region)
    contour.begin_at(region.boundary(region.parameter(complex(curve.sigma[-1]))))  # next to the end at infinity meshes begin farthest out
    for first, last in _between_crossings(curve, region, inside):
        stops = [first, *(t for t in region.corners if first < t < last), *(t + 1 for t in region.corners if first < t + 1 < last), last]
        _follow_boundary(contour, region, stops, closed=last - first == 1.0)
    for low, high in inside:
        stops = list(outside_ends(curve, low, high, ends))
        for side in (1, -1):
            contour.follow(side, lambda z, side=side: contour.on_the_curve(z, side), stops)  # type: ignore[misc]
    for disc, crossing in ends:
        turn = disc.parameter(crossing)
        stops = [turn + OFF, turn + 0.5, turn + 1 - OFF]
        contour.follow(-1, lambda t, d=disc: contour.off_the_curve(d.boundary(t % 1.0)), stops)  # type: ignore[misc]
    return contour.counted(tuple(d for d, _ in ends), bool(inside))


def _follow_boundary(contour: _Contour, region: Region, stops: Sequence[float], closed: bool) -> None:
    """The boundary of the region from the first stop to the last."""
    contour.follow(1, lambda t: contour.off_the_curve(region.boundary(t % 1.0)), stops, closed)


def parts_inside(curve: SampledContinuum, region: Region) -> list[tuple[float, float]]:
    """Intervals of z over which σ_c lies inside the region."""
    curve = curve.resolved(*_extent(region))
    held = np.array([region.contains(complex(s)) for s in curve.sigma])
    flips = np.flatnonzero(held[1:] != held[:-1])
    cuts = [_crossing(curve, region, float(curve.z[i]), float(curve.z[i + 1])) for i in flips]
    bounds = ([float(curve.z[0])] if held[0] else []) + cuts + ([float(curve.z[-1])] if held[-1] else [])
    return list(zip(bounds[::2], bounds[1::2], strict=True))


def _extent(region: Region) -> tuple[complex, float, float]:
    """The middle of a region, the radius of a circle around it that holds the region, and about its least width."""
    hull = np.array(region.hull)
    centre = complex(hull.mean())
    from_centre = hull - centre
    area = float(np.abs((from_centre.conj() * np.roll(from_centre, -1)).imag.sum())) / 2
    radius = float(np.abs(from_centre).max())
    return centre, radius, area / radius


def _crossing(curve: SampledContinuum, region: Region, low: float, high: float) -> float:
    """The z between two samples at which the curve crosses the boundary."""
    at_low = region.contains(curve.at(low))
    for _ in range(BISECTIONS):
        middle = (low + high) / 2
        if region.contains(curve.at(middle)) == at_low:
            low = middle
        else:
            high = middle
    return (low + high) / 2


def _between_crossings(curve: SampledContinuum, region: Region, inside: list[tuple[float, float]]) -> list[tuple[float, float]]:
    """Intervals of t on the boundary from just behind one crossing of the curve to just before the next."""
    ends = {float(curve.z[0]), float(curve.z[-1])}
    ts = sorted(region.parameter(curve.at(z)) for part in inside for z in part if z not in ends)
    if not ts:
        return [(0.0, 1.0)]
    off = max(OFF, ROUNDINGS * EPSILON * max(map(abs, region.hull)) / size(region))
    return [(a + off, b - off) for a, b in pairwise([*ts, ts[0] + 1.0])]


def ends_inside(curve: SampledContinuum, region: Region) -> list[tuple[Disc, complex]]:
    """A circle around each end of the curve inside the region, and the point where the curve leaves it."""
    found = []
    for disc, order in zip(end_discs(curve), (1, -1), strict=True):
        if not region.contains(disc.centre):
            continue
        if not all(region.contains(disc.boundary(k / RIM_OF_END)) for k in range(RIM_OF_END)):
            raise Undecidable(f"an end of the continuous spectrum, {disc.centre:.6g}, lies on the boundary of the region")
        found.append((disc, _leaves(curve, disc, order)))
    return found


def end_discs(curve: SampledContinuum) -> tuple[Disc, Disc]:
    """The circles around the ends at the wall and at infinity, inside of which nothing is counted."""
    radius = END_RADIUS * float(np.abs(curve.sigma - curve.sigma[-1]).max())
    return Disc(complex(curve.sigma[0]), radius), Disc(complex(curve.sigma[-1]), radius)


def _leaves(curve: SampledContinuum, disc: Disc, order: int) -> complex:
    """Where the curve, followed from its end in the disc, crosses the circle."""
    outside = np.flatnonzero(np.abs(curve.sigma - disc.centre) >= disc.radius)
    i = int(outside[0] if order > 0 else outside[-1])
    low, high = sorted((float(curve.z[i]), float(curve.z[i - order])))
    return curve.at(_crossing(curve, disc, low, high))


def outside_ends(curve: SampledContinuum, low: float, high: float, ends: list[tuple[Disc, complex]]) -> tuple[float, float]:
    """The interval of z without what lies in the circles around the ends."""
    for disc, crossing in ends:
        z = curve.nearest(crossing)[1]
        if disc.contains(curve.at(low)):
            low = z
        elif disc.contains(curve.at(high)):
            high = z
    return low, high


def _runs_over_itself(curve: SampledContinuum) -> bool:
    """Whether the curve turns back along itself, as σ_c on the real axis does when it is not monotonic."""
    d = np.diff(curve.sigma)
    forward = (d[1:] * d[:-1].conj()).real
    return bool((forward < 0.0).any())
