"""The limiting matrix at an end, split by count into the solutions that decay fastest and the others.

A = C⁻¹D has n rates μ. Ordered by the real part in the direction of the end, the first k span the decaying space. Nothing asks whether a
real part is negative: next to the continuous spectrum it may be as small as it likes, and the space stays analytic in σ as long as there is
a gap between the k-th and the next. In the Schur form A = Q T Qᴴ with the k rates first, T11 Z − Z T22 = −T12 gives the spectral projector

    P = Q [I, −Z; 0, 0] Qᴴ = X ℓ,   X = Q [I; 0],   ℓ = [I, −Z] Qᴴ,

and with B = A′ in the basis (X, X2), X2 = Q [Z; I], its derivative P′ = X G ℓ2 + X2 H ℓ,

    G T22 − T11 G = −B12,   H T11 − T22 H = B21

(T. Kato, Perturbation Theory for Linear Operators, II.4).
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import scipy.linalg
from numpy.typing import NDArray

from shootstab.core.errors import Undecidable
from shootstab.problems.protocol import ComplexArray

CLOSE = 1e-12  # of the largest rate: a gap below this is rounding


@dataclass(frozen=True, eq=False)
class AsymptoticPencil:
    """The pencil at an end, C0, C1, D0, D1 (n, n), and direction: +1 towards z = +∞, −1 towards −∞."""

    C0: ComplexArray
    C1: ComplexArray
    D0: ComplexArray
    D1: ComplexArray
    direction: int

    def matrix(self, sigma: complex) -> tuple[ComplexArray, ComplexArray]:
        """direction·C⁻¹D and its σ-derivative: in either direction what decays has a negative real part.

        Raises Undecidable where C is singular.
        """
        C = self.C0 + sigma * self.C1
        try:
            A = np.linalg.solve(C, self.D0 + sigma * self.D1)
            slope = np.linalg.solve(C, self.D1 - self.C1 @ A)
        except np.linalg.LinAlgError:
            raise Undecidable(f"C is singular at the end at infinity for sigma = {sigma:.6g}: it lies on the continuous spectrum") from None
        return np.asarray(self.direction * A), np.asarray(self.direction * slope)

    def rescaled(self, unit: complex) -> AsymptoticPencil:
        """The same for v with σ = unit·v."""
        return replace(self, C1=unit * self.C1, D1=unit * self.D1)

    def rates(self, sigma: complex) -> ComplexArray:
        """The n rates, by rising real part."""
        rates = np.linalg.eigvals(self.matrix(sigma)[0])
        return np.asarray(rates[np.argsort(rates.real)])

    def splitting(self, sigma: complex, k: int) -> SpectralSplitting:
        """The k solutions that decay fastest. Raises Undecidable where the k-th rate and the next have one real part."""
        A, slope = self.matrix(sigma)
        n = len(A)
        if k in (0, n):
            whole = np.eye(n, dtype=np.complex128)
            X, X2 = whole[:, :k], whole[:, k:]
            return SpectralSplitting(
                A, slope, X, X2, X.T, np.zeros((k, n - k), dtype=np.complex128), np.zeros((n - k, k), dtype=np.complex128), X2.T
            )
        rates = np.sort(np.linalg.eigvals(A).real)
        gap = rates[k] - rates[k - 1]
        if not gap > CLOSE * np.abs(rates).max():
            raise Undecidable(f"at infinity the rates {k} and {k + 1} have one real part at sigma = {sigma:.6g}: the continuous spectrum")
        middle = 0.5 * (rates[k] + rates[k - 1])
        T, Q, found = scipy.linalg.schur(A, output="complex", sort=lambda mu: mu.real < middle)
        if found != k:
            raise Undecidable(f"at infinity the rates {k} and {k + 1} cannot be told apart at sigma = {sigma:.6g}: the continuous spectrum")
        T11, T12, T22 = T[:k, :k], T[:k, k:], T[k:, k:]
        Z = sylvester(T11, T22, -T12)
        X, left = Q[:, :k], Q[:, :k].conj().T - Z @ Q[:, k:].conj().T
        X2, left2 = Q[:, :k] @ Z + Q[:, k:], Q[:, k:].conj().T
        G = sylvester(T11, T22, left @ slope @ X2)
        H = -sylvester(T22, T11, left2 @ slope @ X)
        return SpectralSplitting(A, slope, X, X2, left, G, H, left2)


def sylvester(T: ComplexArray, U: ComplexArray, right: ComplexArray) -> ComplexArray:
    """T S − S U = right for triangular T and U."""
    solved, scale, _ = scipy.linalg.lapack.ztrsyl(T, U, right, isgn=-1)
    return np.asarray(solved / scale)


@dataclass(frozen=True, eq=False)
class SpectralSplitting:
    """A and A′ (n, n), bases X (n, k) and X2 (n, n−k) of the two invariant spaces, their dual rows left and left2, and G, H of P′."""

    A: ComplexArray
    A_slope: ComplexArray
    X: ComplexArray
    X2: ComplexArray
    left: ComplexArray
    G: ComplexArray
    H: ComplexArray
    left2: ComplexArray

    @property
    def trace(self) -> complex:
        """The sum of the k rates."""
        return complex(np.trace(self.left @ self.A @ self.X))

    @property
    def trace_slope(self) -> complex:
        """Its derivative, tr(ℓ A′ X)."""
        return complex(np.trace(self.left @ self.A_slope @ self.X))

    def projected(self, R: ComplexArray) -> tuple[ComplexArray, ComplexArray]:
        """P R and P′ R for R (n, k)."""
        M = self.left @ R
        return self.X @ M, self.X @ (self.G @ (self.left2 @ R)) + self.X2 @ (self.H @ M)

    def slope(self, R: ComplexArray) -> complex:
        """tr[(ℓR)⁻¹ ℓ P′ R]: see kato_frame.py."""
        return complex(np.trace(np.linalg.solve(self.left @ R, self.G @ (self.left2 @ R))))


def decaying_count(rates: NDArray[np.complex128]) -> int:
    """How many rates decay."""
    return int((rates.real < 0.0).sum())


def gap(rates: NDArray[np.complex128], k: int) -> float:
    """The distance of the real parts of the k-th and the next rate; infinite if one of the two spaces is empty."""
    return float(rates[k].real - rates[k - 1].real) if 0 < k < len(rates) else np.inf
