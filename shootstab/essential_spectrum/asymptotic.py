"""The continuous spectrum of an end at infinity, point by point: σ for which the limiting matrix has a rate iℓ."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import scipy.linalg
import scipy.optimize

from shootstab.core.errors import Undecidable
from shootstab.essential_spectrum.curves import Curve
from shootstab.problems.splitting import AsymptoticPencil

PER_DECADE = 40  # chosen: neighbouring σ ~ ℓ^p differ by p·6 %
RATE_DECADES = 5  # chosen: of ℓ on either side of the rates' own size
TRUE = 1e-6  # chosen: relative residual in ℓ; an infinite σ comes out as a large finite one, with none of the rates asked for
# chosen: of their size, how far apart σ of neighbouring ℓ lie at most on one curve; 5 times what σ ~ ℓ^p makes of it, p ≤ 4
NEIGHBOURS_APART = 0.3


def essential_curve(limit: AsymptoticPencil) -> Curve:
    """The curves of an end, for ℓ = 0 and ℓ from far below to far above the size of the rates, both signs."""
    size = max(float(np.abs(limit.D0).max()), 1e-300) / max(float(np.abs(limit.C0).max()), 1e-300)
    size = float(np.sqrt(size)) if size > 1.0 else size
    sizes = size * 10.0 ** np.arange(-RATE_DECADES, RATE_DECADES, 1.0 / PER_DECADE)
    ells = np.concatenate((-sizes[::-1], [0.0], sizes))
    points = [on_curve(limit, float(ell), float(sizes[0])) for ell in ells]
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
    return Curve(begin, end, low_ends, high_ends, lambda ell: on_curve(limit, ell, float(sizes[0])), scale)


def _paired(here: list[complex], there: list[complex]) -> list[tuple[complex, complex]]:
    """σ of neighbouring ℓ on the same curve: the assignment of the least total distance."""
    if not here or not there:
        return []
    rows, columns = scipy.optimize.linear_sum_assignment(np.abs(np.subtract.outer(np.array(here), np.array(there))))
    return [(here[i], there[j]) for i, j in zip(rows.tolist(), columns.tolist(), strict=True)]


def on_curve(limit: AsymptoticPencil, ell: float, smallest: float) -> list[complex]:
    """All σ with a rate iℓ: (D0 − iℓ C0) v = −σ (D1 − iℓ C1) v."""
    left, right = limit.D0 - 1j * ell * limit.C0, -(limit.D1 - 1j * ell * limit.C1)
    alpha, beta = scipy.linalg.eig(left, right, right=False, homogeneous_eigvals=True)
    kept = []
    for a, b in zip(alpha.tolist(), beta.tolist(), strict=True):
        if abs(b) <= 1e-14 * abs(a):
            continue
        sigma = a / b
        try:
            rates = limit.direction * limit.rates(sigma)
        except Undecidable:
            continue
        if np.abs(rates - 1j * ell).min() <= TRUE * max(abs(ell), smallest, float(np.abs(rates).max()) * 1e-3):
            kept.append(sigma)
    return kept
