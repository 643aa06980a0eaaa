"""Whether a pencil is analytic between the real axis and a path that leaves it: without that D along the path is not D."""

from __future__ import annotations

import itertools
from collections import OrderedDict
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from shootstab.core.errors import InputError
from shootstab.discriminants.deformed_path import DeformedPath
from shootstab.problems.capabilities import UNCHANGING
from shootstab.problems.protocol import ComplexArray, Problem

PANELS, GAUSS_POINTS = 6, 12  # chosen: Gauss's rule on each leg; features a tenth as wide as the path are integrated to 1e−9
REMEMBERED = 16  # chosen: problems and paths that are remembered as analytic, those of one question
CLOSED = 1e-5  # chosen: what the integral around the detour may be, in ∫|f||dz|; a coefficient that is not analytic misses by tenths

# what was found analytic lately; a problem is held, so that no other one has its id
_analytic: OrderedDict[tuple[int, DeformedPath, complex, complex, complex], Problem] = OrderedDict()


def require_analytic(problem: Problem, path: DeformedPath, nodes: NDArray[np.float64]) -> None:
    """Raise InputError unless ∮ f dz = 0 (Cauchy) along the detour and back on the real axis, for every entry f of the pencil.

    nodes (N,) are real, from the far end to the wall. A problem of formulas and numbers is not looked at again soon along a path where it
    was found analytic: its subsystems have its pencil, and meshes of other cells the same path.
    """
    leave, apex, back = path.corners(nodes).tolist()
    asked = (id(problem), path, leave, apex, back)
    if asked in _analytic:
        return
    there, along = _rule([leave, apex, back])
    straight, across = _rule([leave, back])
    near, far = problem.pencil(straight), problem.pencil(there)
    for (name, f), g in zip(far.named.items(), near.named.values(), strict=True):
        loop = np.tensordot(along, f, 1) - np.tensordot(across, g, 1)
        size = np.tensordot(np.abs(along), np.abs(f), 1) + np.tensordot(np.abs(across), np.abs(g), 1)
        off = np.abs(loop) > CLOSED * size
        if off.any():
            raise InputError(
                f"the pencil's {name} is not analytic next to z = {path.centre:.6g}, where the path of integration leaves the real axis to "
                f"pass the continuous spectrum: allowed there are analytic functions of complex z, without abs, .real, comparisons and "
                f"interpolation; or a problem without continuum="
            )
    if UNCHANGING.of(problem):
        _analytic[asked] = problem
        while len(_analytic) > REMEMBERED:
            _analytic.popitem(last=False)


def _rule(corners: list[complex]) -> tuple[ComplexArray, ComplexArray]:
    """Points (m,) and weights (m,) of ∫ f dz along straight legs between the corners, in the order of the path."""
    t, w = _gauss()
    legs = [np.linspace(a, b, PANELS + 1) for a, b in itertools.pairwise(corners)]
    first, last = (np.concatenate([leg[cut] for leg in legs]) for cut in (slice(None, -1), slice(1, None)))
    half = 0.5 * (last - first)[:, None]
    return (first[:, None] + half * (1 + t)).ravel(), (half * w).ravel()


@lru_cache(maxsize=1)
def _gauss() -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Gauss's points and weights on [−1, 1]."""
    return np.polynomial.legendre.leggauss(GAUSS_POINTS)
