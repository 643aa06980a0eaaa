"""The continuous spectrum of an end at infinity, point by point: σ for which the limiting matrix has a rate iℓ."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import scipy.linalg
from numpy.typing import NDArray

from shootstab.core import polynomial
from shootstab.core.scaled import TINY
from shootstab.essential_spectrum.curves import Curve
from shootstab.problems.splitting import AsymptoticPencil

PER_DECADE = 40  # chosen: neighbouring σ ~ ℓ^p differ by p·6 %
RATE_DECADES = 5  # chosen: decades of ℓ on either side of the rates' own size
TRUE = 1e-6  # chosen: relative residual in ℓ; an infinite σ comes out as a large finite one, with none of the rates asked for
# the largest distance, in their size, of σ of neighbouring ℓ on one curve; 5 times what σ ~ ℓ^p makes of it, p ≤ 4
NEIGHBOURS_APART = 0.3  # chosen
INFINITE_SIGMA = 1e-14  # chosen: an eigenvalue α/β of the pencil with a smaller |β/α| is infinite but for rounding
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
    found = [scipy.linalg.eig(a, b, right=False, homogeneous_eigvals=True) for a, b in zip(*pairs, strict=True)]
    alpha, beta = (np.array([pair[i] for pair in found]) for i in (0, 1))
    finite = np.abs(beta) > INFINITE_SIGMA * np.abs(alpha)
    sigma = alpha[finite] / beta[finite]
    rates = limit.direction * limit.rates_at(sigma)
    wanted = np.broadcast_to(ells[:, None], finite.shape)[finite]
    allowed = TRUE * np.maximum(np.maximum(np.abs(wanted), smallest), LEAST_RATE * np.abs(rates).max(axis=1))
    kept = np.abs(rates - 1j * wanted[:, None]).min(axis=1) <= allowed
    owners = np.nonzero(finite)[0][kept]
    return [sigma[kept][owners == i].tolist() for i in range(len(ells))]
