"""The continuous spectrum of an end at infinity, point by point: σ for which the limiting matrix has a rate iℓ."""

from __future__ import annotations

import numpy as np
import scipy.linalg

from shootstab.problems.linear.split import Limit
from shootstab.problems.protocol import ComplexArray
from shootstab.vocabulary.errors import Undecidable

PER_DECADE = 60
DECADES = 5  # of ℓ on either side of the rates' own size
TRUE = 1e-6  # relative residual in ℓ: an infinite σ comes out as a large finite one, with none of the rates asked for


def essential_points(limits: list[Limit]) -> ComplexArray:
    """Points on the curves of all ends, (m,), ℓ from far below to far above the size of the rates."""
    points: list[complex] = []
    for limit in limits:
        sizes = _sizes(limit)
        for ell in np.concatenate((-sizes[::-1], [0.0], sizes)):
            points += _on_curve(limit, float(ell), float(sizes[0]))
    return np.array(points, dtype=np.complex128)


def _sizes(limit: Limit) -> np.ndarray:
    scale = max(float(np.abs(limit.D0).max()), 1e-300) / max(float(np.abs(limit.C0).max()), 1e-300)
    scale = np.sqrt(scale) if scale > 1.0 else scale
    return scale * 10.0 ** np.arange(-DECADES, DECADES, 1.0 / PER_DECADE)


def _on_curve(limit: Limit, ell: float, smallest: float) -> list[complex]:
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
