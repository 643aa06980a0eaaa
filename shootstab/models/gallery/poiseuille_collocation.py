"""Plane Poiseuille flow U = 1 − y² on [−1, 1] by Chebyshev collocation; modes exp(iαx + σt), σ = −iαc.

Unknowns are the streamfunction ψ (u = ψ′, v = −iαψ) and ω = ψ″ − α²ψ, minus the vorticity, so that no fourth derivative is formed:
    σ ω = −iαU ω + iαU″ ψ + (ω″ − α²ω)/R,   0 = ψ″ − α²ψ − ω,   ψ(±1) = ψ′(±1) = 0.
The conditions on ψ′ take the place of the first equation at the walls, those on ψ of the second.

Source: S. A. Orszag, J. Fluid Mech. 50 (1971) 689, who has c = 0.23752649 + 0.00373967i for R = 10000, α = 1.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from shootstab.core.errors import InputError
from shootstab.spectral import chebyshev, qz
from shootstab.spectral.chebyshev import RealArray
from shootstab.spectral.qz import DenseMatrix, Spectrum


def assemble(reynolds: float, alpha: float, M: int, even: bool = False) -> tuple[DenseMatrix, DenseMatrix]:
    """(A, B) with A x = σ B x, x = (ω, ψ) at the extrema of degree M, (2M + 2, 2M + 2); rows scaled to largest element 1 in A.

    even=True: only modes with even ψ, from their values at the points y ≥ 0, (2h, 2h) with h = ⌊M/2⌋ + 1.
    Raises InputError unless R > 0, α > 0 and M ≥ 6.
    """
    if not (0.0 < reynolds < math.inf and 0.0 < alpha < math.inf):
        raise InputError(f"reynolds = {reynolds!r}, alpha = {alpha!r}: allowed are finite numbers above 0")
    if M < 6:
        raise InputError(f"M = {M!r}: allowed is an integer of at least 6")
    grid = chebyshev.interval(M)
    y, D = grid.z, grid.D
    D2 = D @ D
    ends = [0, M]
    if even:
        y, D, D2, ends = y[: M // 2 + 1], _fold(D), _fold(D2), [0]
    m = len(y)
    one = np.eye(m)
    laplacian = D2 - alpha**2 * one
    A = np.empty((2, m, 2, m), dtype=complex)
    A[0, :, 0] = laplacian / reynolds - 1j * alpha * np.diag(1 - y**2)
    A[0, :, 1] = -2j * alpha * one
    A[1, :, 0], A[1, :, 1] = -one, laplacian
    B = np.zeros((2, m, 2, m))
    B[0, :, 0] = one
    A[:, ends], B[:, ends] = 0.0, 0.0
    A[0, ends, 1], A[1, ends, 1] = D[ends], one[ends]
    left, right = A.reshape(2 * m, -1), B.reshape(2 * m, -1)
    scale = np.abs(left).max(axis=1, keepdims=True)
    return left / scale, right / scale


def spectrum(reynolds: float, alpha: float, M: int, even: bool = False, filtered: bool = True) -> Spectrum:
    """The spectrum in σ = −iαc at truncation M by QZ, of the whole channel or of the modes with even ψ."""

    def unfold(vectors: DenseMatrix) -> DenseMatrix:
        fields = vectors.T.reshape(vectors.shape[1], 2, -1)
        return chebyshev.coefficients(np.concatenate([fields, fields[..., : (M + 1) // 2][..., ::-1]], axis=-1) if even else fields)

    return qz.spectrum(lambda degree: assemble(reynolds, alpha, degree, even), M, unfold, filtered)


def _fold(D: RealArray) -> RealArray:
    """The matrix D on functions with f(−y) = f(y), given and wanted at the points y ≥ 0 only."""
    M = len(D) - 1
    kept = M // 2 + 1
    folded = D[:kept, :kept].copy()
    mirrored = D[:kept, kept:][:, ::-1]
    folded[:, : mirrored.shape[1]] += mirrored
    return folded


@dataclass(frozen=True)
class PoiseuilleCollocation:
    """The twin of plane Poiseuille flow: see problems.capabilities.Pseudospectral."""

    reynolds: float
    alpha: float
    even: bool

    def spectrum(self, M: int, filtered: bool = True) -> Spectrum:
        """The spectrum at truncation M."""
        return spectrum(self.reynolds, self.alpha, M, even=self.even, filtered=filtered)

    @property
    def ways(self) -> Mapping[str, Callable[[int, complex], tuple[complex, int]]]:
        """QZ alone."""
        return {"qz": lambda M, guess: (qz.nearest(self.spectrum(M, filtered=False), guess), 1)}
