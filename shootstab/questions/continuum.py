"""How far a point of the σ-plane lies from the continuous spectrum."""

from __future__ import annotations

import math

import numpy as np

from shootstab.problems.protocol import ComplexArray, Problem

POINTS = 4001


def distance_to_continuum(problem: Problem, sigma: complex) -> float:
    """The distance of sigma to the polyline through so many points of σ_c; infinite without a continuous spectrum."""
    curve = problem.continuum(POINTS)
    return math.inf if curve is None else distance_to_curve(curve, sigma)


def distance_to_curve(curve: ComplexArray, sigma: complex) -> float:
    """The distance of a point to a polyline (m,)."""
    a, d = curve[:-1], np.diff(curve)
    length2 = np.abs(d) ** 2
    with np.errstate(divide="ignore", invalid="ignore"):
        t = np.where(length2 > 0.0, ((sigma - a) * d.conj()).real / length2, 0.0)
    nearest = a + np.clip(t, 0.0, 1.0) * d
    return float(np.abs(sigma - nearest).min())
