"""The discriminant that holds in each disc: near the continuous spectrum the path of integration is deformed around the singular point.

A disc that the continuous spectrum does not enter has one branch. A disc that it crosses has two analytic functions in it, D continued
from either side: two branches, and of the zeros of each only those on its own side are modes. The others are resonances.
"""

from __future__ import annotations

import math
from collections import OrderedDict
from dataclasses import dataclass

from shootstab.core.errors import OnSpectrum
from shootstab.core.errors import Undecidable as Undecidable
from shootstab.discriminants.adaptive import MOST_BYTES_KEPT
from shootstab.discriminants.deformed_path import DeformedPath
from shootstab.discriminants.method import AdaptiveDiscriminant, MeshedDiscriminant, Meshes, Method
from shootstab.essential_spectrum.barrier import barrier_of
from shootstab.essential_spectrum.interior import SINGULAR_SETTLED, continuum_of
from shootstab.problems.protocol import Problem

NEAR_AXIS = 0.35  # chosen: singular points nearer to the real axis than this, in the scale of the curve, are passed in the complex plane
HEIGHT, HALF_WIDTH = 0.55, 0.7  # chosen: height and half width of a path, in the same scale
DISC_REACH = 0.3  # chosen: the singular points of a disc must stay within this part of the scale around the path's centre
SCALES = math.sqrt(2.0)  # chosen: ratio of the scales that paths have
REAL = "real"
SPACING = 0.25  # chosen: distance of the centres that paths of one scale have, in their half width
SIDE_KNOWN = 10 * SINGULAR_SETTLED  # derived: Im z of a singular point, in the scale of the curve, of which no more than rounding is known


@dataclass(frozen=True)
class Branch:
    """A discriminant that is analytic on a disc, and the side of the real z-axis on which singular points of its own modes lie.

    side is +1 or −1, or 0 if every zero in the disc is a mode.
    """

    discriminant: MeshedDiscriminant
    side: int
    path: str


class Continuation:
    """The branches of a problem. Which path and which mesh serve a σ, or a disc, follows from it alone; what is kept saves time only.

    begin are meshes of a neighbouring problem, with which those along the real axis begin.
    """

    def __init__(self, problem: Problem, method: Method, begin: Meshes | None = None) -> None:
        self.problem, self.method = problem, method
        self.continuum = continuum_of(problem)
        self.barrier = barrier_of(problem)
        self.on_the_axis = method.on(problem, begin=begin)
        self._deformed: OrderedDict[DeformedPath, AdaptiveDiscriminant] = OrderedDict()

    def __repr__(self) -> str:
        return f"Continuation({self.problem!r}, {self.method!r})"

    @property
    def bytes_kept(self) -> int:
        """The memory of the systems on the meshes that are kept by now, along all paths."""
        return sum(along.bytes_kept for along in (self.on_the_axis, *self._deformed.values()))

    def distance(self, sigma: complex) -> float:
        """The distance of σ to the continuous spectrum; infinite if there is none."""
        spectra = [s for s in (self.continuum, self.barrier) if s is not None]
        return min((s.distance(sigma) for s in spectra), default=math.inf)

    @property
    def rightmost(self) -> float:
        """The largest real part on the continuous spectrum; −∞ if there is none."""
        edges = [] if self.continuum is None else [float(self.continuum.sigma.real.max())]
        return max(edges + ([] if self.barrier is None else [self.barrier.rightmost]), default=-math.inf)

    def own_side(self, branch: Branch, zero: complex, error: float) -> bool:
        """Whether a zero of a branch, known to this error, is a mode, and not a resonance on the other side of the continuous spectrum.

        Raises OnSpectrum where the zero lies on the continuous spectrum to its error, Undecidable where its side is not known at all.
        """
        if self.barrier is not None:
            if self.barrier.distance(zero) <= error:
                raise OnSpectrum(f"a zero of D lies on {self.barrier.name} to its error of {error:.1e}, at {zero:.12g}")
            if self.barrier.beyond(zero):
                return False
        if branch.side == 0:
            return True
        assert self.continuum is not None
        z = self.continuum.singular_point(zero)
        if z is None:
            raise Undecidable(f"the side of the continuous spectrum on which a zero of D lies is not known, at {zero:.12g}")
        if self.continuum.distance(zero) <= error + SIDE_KNOWN * self.continuum.scale(z.real) * abs(self.continuum.slope(z.real)):
            raise OnSpectrum(f"a zero of D lies on the continuous spectrum to its error of {error:.1e}, at {zero:.12g}")
        return (z.imag > 0.0) == (branch.side > 0)

    def branches(self, centre: complex, radius: float) -> tuple[Branch, ...]:
        """One branch, or two where the continuous spectrum crosses the disc.

        Raises Undecidable where an end of the continuous spectrum lies in the disc, or where it passes more than once.
        """
        place = self.crossing(centre, radius)
        if place is not None:
            return tuple(self.beside(place, centre, side, radius) for side in (1, -1))
        return (_branch(centre, radius, *self.along(centre)[:2]),)

    def crossing(self, centre: complex, radius: float) -> float | None:
        """The height at which the continuous spectrum passes through a disc; None where it does not. Raises as `branches` does."""
        if self.barrier is not None and self.barrier.distance(centre) <= radius:
            raise Undecidable(f"{self.barrier.name} enters the circle of {radius:.1e}")
        passes = [] if self.continuum is None else self.continuum.passes(centre, radius)
        if not passes:
            return None
        self._require_one_pass(centre, radius, passes)
        return passes[0]

    def at(self, sigma: complex) -> Branch:
        """The branch for a point, with the side on which its singular point lies; on the continuous spectrum itself that of one side."""
        return _branch(sigma, 0.0, *self.along(sigma))

    def along(self, sigma: complex) -> tuple[AdaptiveDiscriminant, str, int]:
        """D along the path that suits σ, every value on the mesh that serves it; the path, and the side of the singular points above it.

        The side is 0 along the real axis, where every zero is one of D itself.
        """
        if self.continuum is None:
            return self.on_the_axis, REAL, 0
        distance, place = self.continuum.nearest(sigma)
        if distance > self.continuum.scale(place) * abs(self.continuum.slope(place)):
            return self.on_the_axis, REAL, 0
        z = self.continuum.singular_point(sigma)
        if z is None or abs(z.imag) > NEAR_AXIS * self.continuum.scale(z.real) or self._beyond(z.real):
            return self.on_the_axis, REAL, 0
        side = 1 if z.imag > 0.0 else -1
        return *self._beside(z.real, side), side

    def across(self, sigma: complex) -> AdaptiveDiscriminant | None:
        """D continued to σ from the other side of the continuous spectrum next to it; None where no path passes there."""
        z = None if self.continuum is None else self.continuum.singular_point(sigma)
        return None if z is None else self._beside(z.real, -1 if z.imag > 0.0 else 1)[0]

    def _require_one_pass(self, centre: complex, radius: float, passes: list[float]) -> None:
        assert self.continuum is not None
        curve = self.continuum
        for end, name in ((complex(curve.sigma[0]), "its end at the wall"), (complex(curve.sigma[-1]), "its end at infinity")):
            if abs(end - centre) <= radius:
                raise Undecidable(f"the continuous spectrum has {name}, {end:.6g}, inside the circle of {radius:.1e}")
        if len(passes) > 1:
            raise Undecidable(f"the continuous spectrum passes {len(passes)} times through the circle of {radius:.1e}")
        z = passes[0]
        if radius > DISC_REACH * curve.scale(z) * abs(curve.slope(z)):
            raise Undecidable(f"the circle of {radius:.1e} is too large for one path around the continuous spectrum")

    def _beyond(self, z: float) -> bool:
        """Whether a height lies outside the range of the samples."""
        assert self.continuum is not None
        return not self.continuum.z[0] < z < self.continuum.z[-1]

    def beside(self, z: float, sigma: complex, side: int, radius: float = 0.0) -> Branch:
        """The branch whose path leaves singular points near z on this side (+1, above the path), on the mesh for a disc around σ."""
        return _branch(sigma, radius, *self._beside(z, side), side)

    def _beside(self, z: float, side: int) -> tuple[AdaptiveDiscriminant, str]:
        """D along the path of a lattice that is nearest to the one through z: paths are few, and none depends on what was asked before."""
        assert self.continuum is not None
        low, high = float(self.continuum.z[0]), float(self.continuum.z[-1])
        scale = SCALES ** round(math.log(self.continuum.scale(z), SCALES))
        spacing = SPACING * HALF_WIDTH * scale
        centre = min(max(low + spacing * round((z - low) / spacing), low), high)
        path = DeformedPath(centre, HALF_WIDTH * scale, -side * HEIGHT * scale)
        if path not in self._deformed:
            inside = min(max(centre, low + 0.5 * spacing), high - 0.5 * spacing)  # no path leads around a singular point at an end
            self._deformed[path] = self.method.on(self.problem, path, self.continuum.at(inside))
            while len(self._deformed) > 1 and sum(along.bytes_kept for along in self._deformed.values()) > MOST_BYTES_KEPT:
                self._deformed.popitem(last=False)
        self._deformed.move_to_end(path)
        return self._deformed[path], str(path)


def _branch(sigma: complex, radius: float, along: AdaptiveDiscriminant, path: str, side: int = 0) -> Branch:
    """D along a path on the one mesh that serves a disc around σ, or σ alone."""
    return Branch(along.around(sigma, radius) if radius > 0.0 else along.at(sigma), side, path)
