"""Problems quadratic in their eigenvalue, brought to the affine form.

Spatial stability asks for wavenumbers λ, and viscous terms hold λ²:

    (C0 + λ C1) φ′ = (D0 + λ D1 + λ² D2) φ.

With ξ = λφ_J for the q components J that D2 acts on, λ² D2 φ = λ (D2)_J ξ. ξ must follow from a differential equation too, and be found
equal to λφ_J:

    ξ′ − λ φ_J′ = κ (ξ − λ φ_J),   κ > 0.

So ξ − λφ_J grows as e^{κz} towards infinity. In the decaying space it vanishes: that space has the dimension that it had, its φ are
those of the quadratic problem, and the wall rows stay as they are. The order is n + q, and D(λ) the same but for the factor of its
normalization. (The companion form without κ has a rate 0, which neither decays nor grows, and an equation without derivative breaks C.)
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from shootstab.core.errors import InputError
from shootstab.problems.protocol import ComplexArray


def affine(C0: Any, C1: Any, D0: Any, D1: Any, D2: Any, J: list[int], kappa: float = 1.0) -> tuple[ComplexArray, ...]:
    """C0, C1, D0, D1 (m, n+q, n+q) of the larger system, from (m, n, n); J are the columns of D2 that are not zero anywhere.

    Its state is (φ, ξ). For an end at z = +∞; towards −∞ kappa must be negative. Raises InputError where D2 acts on other components.
    """
    m, n, _ = D2.shape
    rest = np.delete(np.arange(n), J)
    if np.abs(D2[:, :, rest]).max(initial=0.0) > 0.0:
        raise InputError(f"D2 acts on other components than {J}: allowed are all on which it does")
    q = len(J)
    out = [np.zeros((m, n + q, n + q), dtype=np.complex128) for _ in range(4)]
    for big, small in zip(out, (C0, C1, D0, D1), strict=True):
        big[:, :n, :n] = small
    extra = n + np.arange(q)
    out[0][:, extra, extra] = 1.0
    out[1][:, extra, J] = -1.0
    out[2][:, extra, extra] = kappa
    out[3][:, extra, J] = -kappa
    out[3][:, :n, n:] = D2[:, :, J]
    return tuple(out)


def with_zeros(rows: ArrayLike, q: int) -> ComplexArray:
    """Wall rows (k, n) for the larger state, (k, n + q)."""
    W = np.asarray(rows, dtype=np.complex128)
    return np.concatenate((W, np.zeros((len(W), q))), axis=1)
