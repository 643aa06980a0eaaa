"""How many solutions begin at each end, and a σ at which that splitting is consistent.

A mode is a solution that decays at both ends, and as many solutions as conditions are needed: with k₋ and k₊ solutions that decay
towards the ends (n − m at a wall with m rows), k₋ + k₊ = n. Many splittings add up. For y″ + a y′ − b y = σ y on the whole line 1 + 1
does right of the essential spectrum, the parabola σ = −b − ℓ² + iaℓ, and 0 + 2 does inside it; D belongs to one of them. It is the one
of the component of the plane that reaches to Re σ → +∞, where the problem of growth rates is well posed (consistent splitting;
T. Kapitula & K. Promislow, Spectral and Dynamical Stability of Nonlinear Waves, 2013, section 3.1). Where the eigenvalue is no growth
rate, as in −y″ = λ y, the essential spectrum itself goes that way; then the next direction of −1, i, −i that keeps away from it is taken.

A direction keeps away from the essential spectrum if around its farthest point σ the disc of radius |σ|/4 has one splitting. So does
the middle of a sector; the inside of a parabola, however wide, does not.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from shootstab.core import polynomial
from shootstab.core.errors import InputError, Undecidable
from shootstab.problems.ends import INFINITIES
from shootstab.problems.protocol import ComplexArray
from shootstab.problems.splitting import CLOSE_RATES, AsymptoticPencil, decaying_count, gap

OUTWARD_DIRECTIONS = (1.0, -1.0, 1j, -1j)  # chosen: growth first
SIZES = 10.0 ** np.arange(-4, 11)  # chosen: |σ| in the problem's own scale; up to 1e10 an advection of 1e4 in that scale is seen through
DISC_RADIUS = 0.25  # chosen: radius, in |σ|, of the disc that has to have one splitting
DISC_RIM = np.exp(0.25j * np.pi * np.arange(8))  # chosen: points on its boundary


@dataclass(frozen=True)
class ConsistentSplitting:
    """counts by side (−1 left, +1 right): the solutions that begin at each end, n in all, as they do at σ = reference."""

    counts: dict[int, int]
    reference: complex


@dataclass(frozen=True)
class Sample:
    """What the limits give at σ: the counts of all ends, and by how much, relative to the largest rate, these are told apart.

    width is 0 where a real part is 0 to rounding, so that nothing can be counted.
    """

    sigma: complex
    counts: dict[int, int]
    width: float


def _width(limit: AsymptoticPencil, sigma: complex, rates: ComplexArray) -> float:
    """The gap between rates that decay and others, or between all and 0 where they are of one kind, relative to the largest rate.

    0 where it is rounding.
    """
    k, largest, clear = decaying_count(rates), float(np.abs(rates).max()), float(np.abs(rates.real).min())
    if not clear > CLOSE_RATES * largest:
        return 0.0
    try:
        limit.splitting(sigma, k)
    except Undecidable:
        return 0.0
    return (gap(rates, k) if 0 < k < len(rates) else clear) / largest


@dataclass(frozen=True)
class EndConditions:
    """n, the order; fixed, by side, the solutions that a wall leaves free; the limits of infinite ends, and the counts given for them."""

    n: int
    fixed: dict[int, int]
    limits: dict[int, AsymptoticPencil]
    given: dict[int, int]

    def sample(self, sigma: complex) -> Sample | None:
        """The splitting at σ; None where C is singular."""
        counts, width = dict(self.fixed), math.inf
        for side, limit in self.limits.items():
            try:
                rates = limit.rates(sigma)
            except Undecidable:
                return None
            counts[side] = decaying_count(rates)
            width = min(width, _width(limit, sigma, rates))
        return Sample(sigma, counts, width)

    def fits(self, sample: Sample) -> bool:
        """Whether as many solutions begin as are needed, and those at infinity are as many as were given."""
        return sum(sample.counts.values()) == self.n and all(sample.counts[side] == k for side, k in self.given.items())

    def keeps_away(self, sample: Sample) -> bool:
        """Whether the disc around σ has one splitting."""
        around = (self.sample(sample.sigma * (1.0 + DISC_RADIUS * turn)) for turn in DISC_RIM.tolist())
        return all(other is not None and other.width > 0.0 and other.counts == sample.counts for other in around)

    @property
    def scale(self) -> float:
        """A size of σ: the smallest at which entries that σ multiplies come to those that are fixed; 1 where there is none."""
        parts = [part for limit in self.limits.values() for part in (limit.pencil.C, limit.pencil.D)]
        sizes = [polynomial.size_of_root([float(np.abs(M).max()) for M in part]) for part in parts]
        return min((size for size in sizes if size > 0.0), default=1.0)


def consistent_splitting(conditions: EndConditions, near: complex | None) -> ConsistentSplitting:
    """The splitting right of the essential spectrum, or that at σ = near.

    Raises InputError where none has as many solutions as conditions, with the counts that were found.
    """
    if near is not None:
        sample = conditions.sample(complex(near))
        if sample is None:
            raise InputError(
                f"C is singular at an end at infinity for reference = {near:g}: allowed is a sigma off the continuous spectrum"
            )
        if not conditions.fits(sample):
            raise _refusal(conditions, sample, "reference")
        return ConsistentSplitting(sample.counts, sample.sigma)
    rays: list[list[Sample]] = []
    for sigmas in _rays(conditions.scale):
        rays.append([s for s in (conditions.sample(sigma) for sigma in sigmas.tolist()) if s is not None])
        component = list(_outermost_component(conditions, rays[-1]))
        if component:
            return _widest(conditions, component)
    # bounded components: for large |σ| too few or too many solutions decay in every direction
    fitting = [s for ray in rays for s in ray if s.width > 0.0 and conditions.fits(s)]
    if fitting:
        return _widest(conditions, fitting)
    seen = [s for ray in rays for s in ray]
    if not seen:
        raise InputError(
            "C is singular at an end at infinity, whatever sigma is: allowed is a pencil that can be solved for the derivative"
        )
    if not any(s.width > 0.0 for s in seen):
        ends = " and ".join(INFINITIES[side] for side in conditions.limits)
        told = f"at {ends} rates have a real part that is 0, or one to rounding, whatever sigma is, as next to a regular singular point"
        raise InputError(f"{told}: allowed are rates of which it is known whether they decay, or st.Wall(z, rows) short of that end")
    raise _refusal(conditions, next(s for s in seen if s.width > 0.0))


def _rays(scale: float) -> Iterator[NDArray[np.complex128]]:
    """σ from large to small in every direction."""
    for direction in OUTWARD_DIRECTIONS:
        yield np.asarray(direction * scale * SIZES[::-1], dtype=np.complex128)


def _outermost_component(conditions: EndConditions, ray: list[Sample]) -> Iterator[Sample]:
    """Samples with the splitting of the farthest, inwards as long as it is that; none where this does not fit or does not keep away."""
    known = [sample for sample in ray if sample.width > 0.0]
    if not known or not conditions.fits(known[0]) or not conditions.keeps_away(known[0]):
        return
    for sample in known:
        if sample.counts != known[0].counts:
            return
        yield sample


def _widest(conditions: EndConditions, samples: list[Sample]) -> ConsistentSplitting:
    """The splitting of the sample with the widest gap, not far from the problem's own scale, where modes are."""
    best = max(samples, key=lambda s: min(s.width, 1.0) / (1.0 + abs(math.log10(abs(s.sigma) / conditions.scale))))
    return ConsistentSplitting(best.counts, best.sigma)


def _refusal(conditions: EndConditions, sample: Sample, asked: str = "sigma") -> InputError:
    """What was found, at the reference that was asked for or at one σ of all that were tried, and what is needed."""
    n = conditions.n
    seen = " and ".join(f"{sample.counts[side]} of {n} solutions decay towards {INFINITIES[side]}" for side in conditions.limits)
    if len(conditions.limits) == 1:
        ((side, _),) = conditions.limits.items()
        at_wall = n - conditions.fixed[-side]
        needed = f"{at_wall} rows at the wall ask for {at_wall}, and allowed are no fewer and no more"
    else:
        needed = f"allowed are {n} in all, the order of the system"
    if conditions.given:
        needed += ", and " + " and ".join(f"decaying = {k} was given at {INFINITIES[side]}" for side, k in conditions.given.items())
    elsewhere = ", and nowhere as many as needed" if asked == "sigma" else ""
    return InputError(f"{seen} at {asked} = {sample.sigma:g}{elsewhere}: {needed}")
