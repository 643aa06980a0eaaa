"""Which discriminant to use where: near the continuous spectrum the path of integration is deformed around the singular point.

A disc that the continuous spectrum does not enter has one branch. A disc that it crosses has two analytic functions in it, D continued
from either side: two branches, and of the zeros of each only those on its own side are modes. The others are resonances.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from shootstab.core.errors import Undecidable as Undecidable
from shootstab.discriminants.deformed_path import DeformedPath
from shootstab.discriminants.method import MeshedDiscriminant, Method
from shootstab.essential_spectrum.barrier import barrier_of
from shootstab.essential_spectrum.interior import continuum_of
from shootstab.problems.protocol import Problem

NEAR = 0.35  # singular points nearer to the real axis than this, in the scale of the curve, are passed in the complex plane
HEIGHT, HALF_WIDTH = 0.55, 0.7  # of a path, in the same scale
REACH = 0.3  # the singular points of a disc must stay within this part of the scale around the path's centre
SIZE_RATIO = 4.0  # ratio of |σ| over which one mesh serves


@dataclass(frozen=True)
class Branch:
    """A discriminant that is analytic on a disc, and the side of the real z-axis on which singular points of its own modes lie.

    side is +1 or −1, or 0 if every zero in the disc is a mode.
    """

    discriminant: MeshedDiscriminant
    side: int
    path: str


def size_class(sigma: complex) -> int:
    """The size of |σ| in powers of SIZE_RATIO: one mesh serves all σ of a size."""
    return round(math.log(abs(sigma) or 1.0) / math.log(SIZE_RATIO))


class Continuation:
    """The branches of a problem, made when they are first needed and kept."""

    def __init__(self, problem: Problem, method: Method) -> None:
        self.problem, self.method = problem, method
        self.continuum = continuum_of(problem)
        self.barrier = barrier_of(problem)
        self._real: dict[int, MeshedDiscriminant] = {}
        self._deformed: list[tuple[DeformedPath, int, MeshedDiscriminant]] = []

    def distance(self, sigma: complex) -> float:
        """The distance of σ to the continuous spectrum; infinite if there is none."""
        spectra = [s for s in (self.continuum, self.barrier) if s is not None]
        return min((s.distance(sigma) for s in spectra), default=math.inf)

    @property
    def rightmost(self) -> float:
        """The largest real part on the continuous spectrum; −∞ if there is none."""
        edges = [] if self.continuum is None else [float(self.continuum.sigma.real.max())]
        return max(edges + ([] if self.barrier is None else [self.barrier.rightmost]), default=-math.inf)

    def own_side(self, branch: Branch, zero: complex) -> bool:
        """Whether a zero of a branch is a mode, and not a resonance on the other side of the continuous spectrum.

        Raises Undecidable where the zero lies on the continuous spectrum to rounding.
        """
        if self.barrier is not None:
            if self.barrier.distance(zero) == 0.0:
                raise Undecidable(f"a zero of D lies on the continuous spectrum of an end at infinity, at {zero:.12g}")
            if self.barrier.beyond(zero):
                return False
        if branch.side == 0:
            return True
        assert self.continuum is not None
        z = self.continuum.singular_point(zero)
        if z is None or abs(z.imag) < 1e-9 * self.continuum.scale(z.real):
            raise Undecidable(f"a zero of D lies on the continuous spectrum, at {zero:.12g}")
        return (z.imag > 0.0) == (branch.side > 0)

    def branches(self, centre: complex, radius: float) -> tuple[Branch, ...]:
        """One branch, or two where the continuous spectrum crosses the disc.

        Raises Undecidable where an end of the continuous spectrum lies in the disc, or where it passes more than once.
        """
        if self.barrier is not None and self.barrier.distance(centre) <= radius:
            raise Undecidable(f"the continuous spectrum of an end at infinity enters the circle of {radius:.1e}")
        if self.continuum is None:
            return (self._on_the_axis(centre),)
        passes = self.continuum.passes(centre, radius)
        if not passes:
            return (self._one_side(centre),)
        self._require_one_pass(centre, radius, passes)
        place = passes[0]
        return tuple(self.beside(place, centre, side) for side in (1, -1))

    def at(self, sigma: complex) -> Branch:
        """The branch for a point; on the continuous spectrum itself that of one side."""
        if self.continuum is None:
            return self._on_the_axis(sigma)
        return self._one_side(sigma)

    def _one_side(self, centre: complex) -> Branch:
        assert self.continuum is not None
        distance, place = self.continuum.nearest(centre)
        if distance > self.continuum.scale(place) * abs(self.continuum.slope(place)):
            return self._on_the_axis(centre)
        z = self.continuum.singular_point(centre)
        if z is None or abs(z.imag) > NEAR * self.continuum.scale(z.real) or self._beyond(z.real):
            return self._on_the_axis(centre)
        branch = self.beside(z.real, centre, 1 if z.imag > 0.0 else -1)
        return Branch(branch.discriminant, 0, branch.path)

    def _require_one_pass(self, centre: complex, radius: float, passes: list[float]) -> None:
        assert self.continuum is not None
        curve = self.continuum
        for end, name in ((complex(curve.sigma[0]), "its end at the wall"), (complex(curve.sigma[-1]), "its end at infinity")):
            if abs(end - centre) <= radius:
                raise Undecidable(f"the continuous spectrum has {name}, {end:.6g}, inside the circle of {radius:.1e}")
        if len(passes) > 1:
            raise Undecidable(f"the continuous spectrum passes {len(passes)} times through the circle of {radius:.1e}")
        z = passes[0]
        if radius > REACH * curve.scale(z) * abs(curve.slope(z)):
            raise Undecidable(f"the circle of {radius:.1e} is too large for one path around the continuous spectrum")

    def _beyond(self, z: float) -> bool:
        """Whether a height lies outside the range of the samples."""
        assert self.continuum is not None
        return not self.continuum.z[0] < z < self.continuum.z[-1]

    def _on_the_axis(self, sigma: complex) -> Branch:
        size = size_class(sigma)
        if size not in self._real:
            self._real[size] = self._on_the_real_axis(size)
        return Branch(self._real[size], 0, "real")

    def _on_the_real_axis(self, size: int) -> MeshedDiscriminant:
        """A discriminant for |σ| of this size, which begins with the mesh of the nearest size there is."""
        if not self._real:
            return self.method.on(self.problem)
        nearest = min(self._real, key=lambda known: abs(known - size))
        return self._real[nearest].warm_started(self.problem)

    def beside(self, z: float, sigma: complex, side: int) -> Branch:
        """The branch whose path leaves singular points near z on this side: side +1, above the path; sigma tells the size of |σ|."""
        assert self.continuum is not None
        scale = self.continuum.scale(z)
        size = size_class(sigma)
        for path, known, discriminant in self._deformed:
            alike = 0.7 < path.half_width / (HALF_WIDTH * scale) < 1.4
            if known == size and alike and path.height * side < 0.0 and abs(path.centre - z) < 0.3 * HALF_WIDTH * scale:
                return Branch(discriminant, side, str(path))
        path = DeformedPath(z, HALF_WIDTH * scale, -side * HEIGHT * scale)
        discriminant = self.method.on(self.problem, path)
        # off the detour the mesh of any other path for such |σ| serves as well
        others = [d for _, known, d in reversed(self._deformed) if known == size] + [d for b, d in self._real.items() if b == size]
        if others:
            discriminant.reuse_mesh_of(others[0])
        self._deformed.append((path, size, discriminant))
        return Branch(discriminant, side, str(path))
