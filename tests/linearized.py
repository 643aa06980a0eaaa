"""Pencils quadratic in their eigenvalue by one affine in it and larger: a second way to the same modes.

    (C0 + λ C1) φ′ = (D0 + λ D1 + λ² D2) φ.

With ξ = λφ_J for the q components J that D2 acts on, λ² D2 φ = λ (D2)_J ξ. ξ follows from a differential equation too, and is found
equal to λφ_J:

    ξ′ − λ φ_J′ = κ (ξ − λ φ_J),   κ > 0.

So ξ − λφ_J grows as e^{κz} towards infinity. In the decaying space it vanishes: that space has the dimension that it had, its φ are
those of the quadratic problem, and the wall rows stay as they are. The order is n + q, and D(λ) the same but for a factor.
"""

from __future__ import annotations

import numpy as np


def linearized(C0: np.ndarray, C1: np.ndarray, D: list[np.ndarray], J: list[int], kappa: float = 1.0) -> tuple[np.ndarray, ...]:
    """C0, C1, D0, D1 (m, n+q, n+q), from C0, C1 and D0, D1, D2 (m, n, n); J are the columns in which D2 has entries."""
    m, n, _ = D[2].shape
    q = len(J)
    extra = n + np.arange(q)
    out = [np.zeros((m, n + q, n + q), dtype=np.complex128) for _ in range(4)]
    for big, small in zip(out, (C0, C1, D[0], D[1]), strict=True):
        big[:, :n, :n] = small
    out[0][:, extra, extra] = 1.0
    out[1][:, extra, J] = -1.0
    out[2][:, extra, extra] = kappa
    out[3][:, extra, J] = -kappa
    out[3][:, :n, n:] = D[2][:, :, J]
    return tuple(out)
