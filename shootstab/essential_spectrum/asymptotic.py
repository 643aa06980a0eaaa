"""The continuous spectrum of an end at infinity, point by point: σ for which the limiting matrix has a rate iℓ."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import scipy.linalg

from shootstab.core.errors import Undecidable
from shootstab.essential_spectrum.curves import Curve
from shootstab.problems.splitting import AsymptoticPencil

PER_DECADE = 40
DECADES = 5  # of ℓ on either side of the rates' own size
TRUE = 1e-6  # relative residual in ℓ: an infinite σ comes out as a large finite one, with none of the rates asked for
ALIKE = 0.3  # of their size, how far apart σ of neighbouring ℓ lie at most


def essential_curve(limit: AsymptoticPencil) -> Curve:
    """The curves of an end, ℓ from far below to far above the size of the rates."""
    scale = max(float(np.abs(limit.D0).max()), 1e-300) / max(float(np.abs(limit.C0).max()), 1e-300)
    scale = float(np.sqrt(scale)) if scale > 1.0 else scale
    sizes = scale * 10.0 ** np.arange(-DECADES, DECADES, 1.0 / PER_DECADE)
    ells = np.concatenate((-sizes[::-1], [0.0], sizes))
    points = [on_curve(limit, float(ell), float(sizes[0])) for ell in ells]
    middle = max((abs(s) for s in points[len(sizes)]), default=0.0)
    pieces = []
    for (low, here), (high, there) in pairwise(zip(ells.tolist(), points, strict=True)):
        for s in here:
            if there:
                nearest = min(there, key=lambda t, s=s: abs(t - s))  # type: ignore[misc]
                if abs(nearest - s) <= ALIKE * max(abs(s), abs(nearest), middle):
                    pieces.append((s, nearest, low, high))
    begin, end = (np.array([p[i] for p in pieces], dtype=np.complex128) for i in (0, 1))
    low_ends, high_ends = (np.array([p[i] for p in pieces], dtype=np.float64) for i in (2, 3))
    return Curve(begin, end, low_ends, high_ends, lambda ell: on_curve(limit, ell, float(sizes[0])))


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
