"""Polynomials in σ by their coefficients, the constant one first; these are matrices, or numbers and series of any kind."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray


def value(coefficients: Sequence[Any], sigma: Any) -> Any:
    """Σ c_k σ^k by Horner's rule."""
    total = coefficients[-1]
    for c in reversed(coefficients[:-1]):
        total = c + sigma * total
    return total


def slope(coefficients: Sequence[Any], sigma: Any) -> Any:
    """Σ k c_k σ^(k−1), of degree 1 at least."""
    return value([k * c if k > 1 else c for k, c in enumerate(coefficients)][1:], sigma)


def companion(coefficients: Sequence[NDArray[Any]]) -> tuple[NDArray[np.complex128], NDArray[np.complex128]]:
    """A, B (…, qn, qn) with A x = σ B x where Σ σ^k P_k y = 0 for x = (y, σy, …, σ^(q−1) y); coefficients P_k (…, n, n), degree q."""
    *lower, top = np.broadcast_arrays(*coefficients)
    q, n, shape = len(lower), top.shape[-1], top.shape[:-2]
    A, B = (np.zeros((*shape, q, n, q, n), dtype=np.complex128) for _ in range(2))
    for m in range(q - 1):
        A[..., m, :, m + 1, :] = B[..., m, :, m, :] = np.eye(n)
    for m, P in enumerate(lower):
        A[..., -1, :, m, :] = P
    B[..., -1, :, -1, :] = -top
    return A.reshape(*shape, q * n, q * n), B.reshape(*shape, q * n, q * n)


def size_of_root(coefficients: Sequence[float]) -> float:
    """The smallest |σ| at which a later term of sizes c_k |σ|^k has come to that of the first; 0 where there is none, or no first."""
    first, *later = coefficients
    sizes = [(first / c) ** (1.0 / k) for k, c in enumerate(later, 1) if c > 0.0] if first > 0.0 else []
    return min((size for size in sizes if np.isfinite(size)), default=0.0)
