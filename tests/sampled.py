"""Linear systems that the kernels' tests integrate, as dense arrays and as the kernels take them."""

from __future__ import annotations

import numpy as np

from shootstab.discriminants.sampled_system import sample
from shootstab.kernels import tableau
from shootstab.kernels.reduced_system import ReducedSystem


def without_resolvent(h: np.ndarray, X: np.ndarray) -> ReducedSystem:
    """The system with X (N, 12, 2, n, n) alone, m = 0."""
    steps, n = len(h), X.shape[3]
    empty = (np.zeros((steps, 12, *shape), complex) for shape in ((n, 0), (2, 0, 0), (3, 0, n)))
    return sample(h, X, *empty)


def constant(A: np.ndarray, dA: np.ndarray, length: complex, steps: int) -> ReducedSystem:
    """ψ′ = (A + σ dA) ψ."""
    X = np.broadcast_to(np.stack((A, dA)), (steps, 12, 2, *A.shape)).copy()
    return without_resolvent(np.full(steps, length / steps, dtype=complex), X)


def between(system: tuple[np.ndarray, np.ndarray, np.ndarray], start: complex, end: complex, steps: int) -> ReducedSystem:
    """ψ′ = (P cos z + Q sin 2z + σR) ψ."""
    P, Q, R = system
    h = np.full(steps, (end - start) / max(steps, 1), complex)
    z = (start + (np.arange(steps)[:, None] + tableau.C[:12]) * (end - start) / max(steps, 1))[..., None, None]
    return without_resolvent(h, np.stack((P * np.cos(z) + Q * np.sin(2 * z), R + 0 * z), axis=2))


def spoilt(system: ReducedSystem) -> ReducedSystem:
    """With a NaN in the second step."""
    P = system.P.copy()
    P[1, 4, 4] = np.nan
    return system._replace(P=P)
