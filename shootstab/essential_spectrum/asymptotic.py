"""The continuous spectrum of an end at infinity, point by point: σ for which the limiting matrix has a rate iℓ."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
from numpy.typing import NDArray
from scipy.linalg.lapack import zggev

from shootstab.core import polynomial
from shootstab.core.scaled import EPSILON, TINY
from shootstab.essential_spectrum.curves import Curve
from shootstab.problems.protocol import ComplexArray
from shootstab.problems.splitting import AsymptoticPencil

PER_DECADE = 40  # chosen: neighbouring σ ~ ℓ^p differ by p·6 %
RATE_DECADES = 5  # chosen: decades of ℓ on either side of the rates' own size
TRUE = 1e-6  # chosen: relative residual in ℓ; an infinite σ comes out as a large finite one, with none of the rates asked for
# the largest distance, in their size, of σ of neighbouring ℓ on one curve; 5 times what σ ~ ℓ^p makes of it, p ≤ 4
NEIGHBOURS_APART = 0.3  # chosen
INFINITE_SIGMA = 1e-14  # chosen: an eigenvalue α/β of the pencil with a smaller |β/α| is infinite but for rounding
BESIDE_RATE = 0.1  # chosen: how far from iℓ the trace is taken, in what a rate may be off
LEAST_RATE = 1e-3  # chosen: a smaller rate, in the largest of its σ, is known to rounding of so large a one


def essential_curve(limit: AsymptoticPencil) -> Curve:
    """The curves of an end, for ℓ = 0 and ℓ from far below to far above the size of the rates, both signs."""
    size = max(float(np.abs(limit.pencil.D0).max()), TINY) / max(float(np.abs(limit.pencil.C0).max()), TINY)
    size = float(np.sqrt(size)) if size > 1.0 else size
    sizes = size * 10.0 ** np.arange(-RATE_DECADES, RATE_DECADES, 1.0 / PER_DECADE)
    ells = np.concatenate((-sizes[::-1], [0.0], sizes))
    points = on_curve(limit, ells, float(sizes[0]))
    segments = []
    for (low, here), (high, there) in pairwise(zip(ells.tolist(), points, strict=True)):
        through_zero = low == 0.0 or high == 0.0  # σ(0) may vanish, and then differs from its neighbours by their whole size
        for s, t in _paired(here, there):
            if through_zero or abs(t - s) <= NEIGHBOURS_APART * max(abs(s), abs(t)):
                segments.append((s, t, low, high))
    begin, end = (np.array([p[i] for p in segments], dtype=np.complex128) for i in (0, 1))
    low_ends, high_ends = (np.array([p[i] for p in segments], dtype=np.float64) for i in (2, 3))
    at_size = [abs(s) for i in (RATE_DECADES * PER_DECADE, -RATE_DECADES * PER_DECADE - 1) for s in points[i]]
    scale = max(at_size, default=0.0)
    return Curve(begin, end, low_ends, high_ends, lambda ell: on_curve(limit, np.array([ell]), float(sizes[0]))[0], scale)


def _paired(here: list[complex], there: list[complex]) -> list[tuple[complex, complex]]:
    """σ of neighbouring ℓ on the same curve: the assignment of the least total distance."""
    if not here or not there:
        return []
    from scipy.optimize import linear_sum_assignment

    rows, columns = linear_sum_assignment(np.abs(np.subtract.outer(np.array(here), np.array(there))))
    return [(here[i], there[j]) for i, j in zip(rows.tolist(), columns.tolist(), strict=True)]


def on_curve(limit: AsymptoticPencil, ells: NDArray[np.float64], smallest: float) -> list[list[complex]]:
    """All σ with a rate iℓ, for each ℓ of ells (m,): det(D − iℓ C) = 0, without those of no rate, as large ones in place of ∞."""
    pairs = polynomial.companion([D - 1j * ells[:, None, None] * C for C, D in zip(limit.pencil.C, limit.pencil.D, strict=True)])
    found = [zggev(a, b, compute_vl=0, compute_vr=0)[:2] for a, b in zip(*pairs, strict=True)]
    alpha, beta = (np.array([pair[i] for pair in found]) for i in (0, 1))
    finite = np.abs(beta) > INFINITE_SIGMA * np.abs(alpha)
    sigma = alpha[finite] / beta[finite]
    wanted = np.broadcast_to(ells[:, None], finite.shape)[finite]
    size = np.maximum(np.abs(wanted), smallest)
    kept = _has_rate(limit, sigma, wanted, size)
    rest = np.flatnonzero(~kept)
    rates = limit.direction * limit.rates_at(sigma[rest])
    allowed = TRUE * np.maximum(size[rest], LEAST_RATE * np.abs(rates).max(axis=1, initial=0.0))
    kept[rest] = np.abs(rates - 1j * wanted[rest, None]).min(axis=1, initial=np.inf) <= allowed
    owners = np.nonzero(finite)[0][kept]
    first = np.searchsorted(owners, np.arange(len(ells) + 1)).tolist()
    values = sigma[kept].tolist()
    return [values[a:b] for a, b in pairwise(first)]


def _has_rate(limit: AsymptoticPencil, sigmas: ComplexArray, ells: NDArray[np.float64], size: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Whether σ (m,) are seen at once to have a rate iℓ to TRUE of a size, (m,) each; those that are not may have one.

    The rate nearest to a number μ is no farther from it than n/|tr (C⁻¹D − μ)⁻¹|, the sum of n terms being no larger than the largest. μ is
    beside iℓ, where the matrix is not singular.
    """
    C, D = (np.asarray(polynomial.value(part, sigmas[:, None, None])) for part in (limit.pencil.C, limit.pencil.D))
    beside = BESIDE_RATE * TRUE * size
    try:
        inverse = np.linalg.solve(D - (1j * ells + beside)[:, None, None] * C, C)
    except np.linalg.LinAlgError:
        return np.zeros(len(sigmas), dtype=np.bool_)
    trace = np.abs(np.trace(inverse, axis1=1, axis2=2))
    near = len(limit.pencil.D0) <= trace * (TRUE * size - beside)
    near[near] = np.linalg.cond(C[near], 1) < 1.0 / EPSILON
    return np.asarray(near)
