"""Resonances: zeros of D continued through the continuous spectrum, beyond it. They are not eigenvalues."""

from __future__ import annotations

import numpy as np

from shootstab.analyses.cut_region import ends_inside, outside_ends, parts_inside
from shootstab.analyses.zeros import search_on
from shootstab.core.regions import Polygon, Region, size
from shootstab.discriminants.continuation import Continuation
from shootstab.problems.capabilities import Continuum
from shootstab.roots.iterations import newton
from shootstab.roots.search import find

DEPTH = 0.2  # chosen: how far beyond the real z-axis singular points are followed, in the scale of the curve
STRIDE = 0.3  # chosen: the distance from one strip of the curve to the next, in the same scale
ONE_ZERO = 1e-7  # chosen: zeros found on two branches nearer to each other than this part of a strip are one
RESONANCE_STEP = 1e-10  # chosen: relative length of the last step to a zero of D itself, below ONE_ZERO of a strip
EDGE = 6  # chosen: points along a side of a strip


def find_resonances(continuation: Continuation, region: Region) -> list[complex]:
    """The resonances next to those parts of the continuous spectrum that lie in the region, on both sides of it.

    The curve is covered by strips, images under σ_c of rectangles in the z-plane that reach DEPTH·scale beyond the real axis; the zeros in
    each are those of the continuation that reaches it. The circles around the ends are left out. Empty without continuous spectrum.
    """
    curve = continuation.continuum
    if curve is None:
        return []
    found: list[complex] = []
    ends = ends_inside(curve, region)
    for part in parts_inside(curve, region):
        z, high = outside_ends(curve, *part, ends)
        while z < high:
            scale = curve.scale(z)
            width = min(STRIDE * scale, high - z)
            for side in (1, -1):
                strip = _image(curve.curve, z, width, -side * DEPTH * scale)
                middle = curve.at(z + width / 2)
                branch = continuation.beside(z + width / 2, middle, side, max(abs(v - middle) for v in strip.vertices))
                for zero in find(search_on(continuation.problem, branch), strip):
                    # a subsystem that is not singular has its modes on both sides: they are modes, not resonances
                    own = newton(continuation.at(zero.sigma).discriminant, zero.sigma, RESONANCE_STEP)
                    same = ONE_ZERO * size(strip)
                    if all(abs(zero.sigma - other) > same for other in [own.sigma, *found]):
                        found.append(zero.sigma)
            z += width
    return found


def _image(curve: Continuum, z: float, width: float, depth: float) -> Polygon:
    """σ_c of the rectangle from z to z + width and from the real axis to depth·i."""
    along, down = np.linspace(0.0, width, EDGE), np.linspace(0.0, depth, EDGE)
    rim = np.concatenate((z + along, z + width + 1j * down[1:], z + 1j * depth + along[::-1][1:], z + 1j * down[::-1][1:-1]))
    return Polygon(tuple(curve(rim.astype(np.complex128)).tolist()))
