"""The limiting matrix at an end, split by count into the solutions that decay fastest and the others.

A = C⁻¹D has n rates μ. Ordered by the real part in the direction of the end, the first k span the decaying space. Nothing asks whether a
real part is negative: next to the continuous spectrum it may be as small as it likes, and the space stays analytic in σ as long as there is
a gap between the k-th and the next. In the Schur form A = Q T Qᴴ with the k rates first, T11 Z − Z T22 = −T12 gives the spectral projector

    P = Q [I, −Z; 0, 0] Qᴴ = X ℓ,   X = Q [I; 0],   ℓ = [I, −Z] Qᴴ,

and with B = A′ in the basis (X, X2), X2 = Q [Z; I], its derivative P′ = X G ℓ2 + X2 H ℓ,

    G T22 − T11 G = −B12,   H T11 − T22 H = B21

(T. Kato, Perturbation Theory for Linear Operators, II.4). A is balanced first, so that its norm is no larger than its rates make it.

How well the space is known. Rounding changes A by E, ‖E‖ ≈ ε‖A‖, and turns the space by ‖E‖/sep(T11, T22), as long as
‖E‖ ‖T12‖ < sep²/4 (G. W. Stewart, SIAM Review 15 (1973), theorem 4.11). Beyond that the gap itself may be rounding: a defective pair,
two equal rates with one solution, splits by √‖E‖ in some direction, and a space is found where there is none.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
import scipy.linalg
from numpy.typing import NDArray

from shootstab.core import polynomial
from shootstab.core.errors import Undecidable
from shootstab.core.scaled import EPSILON
from shootstab.problems.protocol import ComplexArray, Pencil

CLOSE_RATES = 1e-12  # chosen: a gap below this part of the largest rate is rounding
UNRESOLVED_GAP = 100.0  # chosen: ‖E‖ ‖T12‖ in units of sep², times this; a defective pair that rounding has split has 1/4 to 1


@dataclass(frozen=True, eq=False)
class AsymptoticPencil:
    """The pencil at an end, its matrices (n, n), and direction: +1 towards z = +∞, −1 towards −∞."""

    pencil: Pencil
    direction: int

    def matrix(self, sigma: complex) -> tuple[ComplexArray, ComplexArray]:
        """direction·C⁻¹D and its σ-derivative, each (n, n): in either direction what decays has a negative real part.

        Raises Undecidable where C is singular.
        """
        A, slope = self.matrices(np.array([sigma]))
        return A[0], slope[0]

    def matrices(self, sigmas: ComplexArray) -> tuple[ComplexArray, ComplexArray]:
        """`matrix` at sigmas (m,), each (m, n, n). Raises Undecidable where C is singular at one of them."""
        at = sigmas[:, None, None]
        C, D = (np.asarray(polynomial.value(part, at)) for part in (self.pencil.C, self.pencil.D))
        moved = [np.asarray(polynomial.slope(part, at)) for part in (self.pencil.D, self.pencil.C)]
        try:
            A = np.linalg.solve(C, D)
            slope = np.linalg.solve(C, moved[0] - moved[1] @ A)
        except np.linalg.LinAlgError:
            where = f"sigma = {sigmas[0]:.6g}" if len(sigmas) == 1 else "some sigma of a circle"
            raise Undecidable(f"C is singular at the end at infinity for {where}: it lies on the continuous spectrum") from None
        return np.asarray(self.direction * A), np.asarray(self.direction * slope)

    def rescaled(self, unit: complex) -> AsymptoticPencil:
        """The same for v with σ = unit·v."""
        return replace(self, pencil=self.pencil.rescaled(unit))

    def rates(self, sigma: complex) -> ComplexArray:
        """The rates (n,), by rising real part."""
        rates = np.linalg.eigvals(self.matrix(sigma)[0])
        return np.asarray(rates[np.argsort(rates.real)])

    def rates_at(self, sigmas: ComplexArray) -> ComplexArray:
        """The rates (m, n) at sigmas (m,), in no order; NaN where C is singular."""
        C, D = (polynomial.value(part, sigmas[:, None, None]) for part in (self.pencil.C, self.pencil.D))
        whole = np.linalg.cond(C, 1) < 1.0 / EPSILON
        rates = np.full(D.shape[:2], np.nan, dtype=np.complex128)
        rates[whole] = np.linalg.eigvals(self.direction * np.linalg.solve(C[whole], D[whole]))
        return rates

    def splitting(self, sigma: complex, k: int) -> SpectralSplitting:
        """The k solutions that decay fastest.

        Raises Undecidable where the k-th rate and the next have one real part, or one to rounding.
        """
        A, slope = self.matrix(sigma)
        n = len(A)
        if k in (0, n):
            whole = np.eye(n, dtype=np.complex128)
            X, X2 = whole[:, :k], whole[:, k:]
            return SpectralSplitting(
                A, slope, X, X2, X.T, np.zeros((k, n - k), dtype=np.complex128), np.zeros((n - k, k), dtype=np.complex128), X2.T, 0.0
            )
        with np.errstate(invalid="ignore"):  # SciPy casts scales to integers, for a permutation that is not asked for
            balanced, (scales, _) = scipy.linalg.matrix_balance(A, permute=False, separate=True)
        rates = np.sort(np.linalg.eigvals(balanced).real)
        gap = rates[k] - rates[k - 1]
        if not gap > CLOSE_RATES * np.abs(rates).max():
            raise Undecidable(f"at infinity the rates {k} and {k + 1} have one real part at sigma = {sigma:.6g}: the continuous spectrum")
        middle = 0.5 * (rates[k] + rates[k - 1])
        T, Q, found = scipy.linalg.schur(balanced, output="complex", sort=lambda mu: mu.real < middle)
        error = math.inf if found != k else _rounding(T, k)
        if not math.isfinite(error):
            raise Undecidable(f"at infinity the rates {k} and {k + 1} are one to rounding at sigma = {sigma:.6g}: no space is told apart")
        T11, T12, T22 = T[:k, :k], T[:k, k:], T[k:, k:]
        Z = sylvester(T11, T22, -T12)
        rows, columns = Q.conj().T / scales, scales[:, None] * Q
        X, left = columns[:, :k], rows[:k] - Z @ rows[k:]
        X2, left2 = columns[:, :k] @ Z + columns[:, k:], rows[k:]
        G = sylvester(T11, T22, left @ slope @ X2)
        H = -sylvester(T22, T11, left2 @ slope @ X)
        return SpectralSplitting(A, slope, X, X2, left, G, H, left2, error)


def _rounding(T: ComplexArray, k: int) -> float:
    """The relative error ‖E‖/sep of the space of the first k rates; infinite where these are not told from the others."""
    _, _, _, _, _, sep, _ = scipy.linalg.lapack.ztrsen(
        np.arange(len(T)) < k, T, np.eye(len(T)), job=b"V", wantq=0, lwork=2 * k * (len(T) - k)
    )
    with np.errstate(over="ignore"):  # a norm that is no double tells nothing apart
        changed, coupling = EPSILON * float(np.linalg.norm(T)), float(np.linalg.norm(T[:k, k:]))
    if not math.isfinite(changed) or UNRESOLVED_GAP * changed * coupling > sep * sep:
        return math.inf
    return changed / float(sep)


def sylvester(T: ComplexArray, U: ComplexArray, right: ComplexArray) -> ComplexArray:
    """S (k, l) with T S − S U = right, for triangular T (k, k) and U (l, l)."""
    solved, scale, _ = scipy.linalg.lapack.ztrsyl(T, U, right, isgn=-1)
    return np.asarray(solved / scale)


@dataclass(frozen=True, eq=False)
class SpectralSplitting:
    """A and A′ (n, n), bases X (n, k) and X2 (n, n−k) of the two invariant spaces, their dual rows left and left2, and G, H of P′.

    rounding is the relative error of X that rounding makes.
    """

    A: ComplexArray
    A_slope: ComplexArray
    X: ComplexArray
    X2: ComplexArray
    left: ComplexArray
    G: ComplexArray
    H: ComplexArray
    left2: ComplexArray
    rounding: float

    @property
    def trace(self) -> complex:
        """The sum of the k rates."""
        return complex(np.trace(self.left @ self.A @ self.X))

    @property
    def trace_slope(self) -> complex:
        """The σ-derivative of the trace, tr(ℓ A′ X)."""
        return complex(np.trace(self.left @ self.A_slope @ self.X))

    def projected(self, R: ComplexArray) -> tuple[ComplexArray, ComplexArray]:
        """P R and P′ R for R (n, k)."""
        M = self.left @ R
        return self.X @ M, self.X @ (self.G @ (self.left2 @ R)) + self.X2 @ (self.H @ M)

    def slope(self, R: ComplexArray) -> complex:
        """tr[(ℓR)⁻¹ ℓ P′ R] for R (n, k): see kato_frame.py."""
        return complex(np.trace(np.linalg.solve(self.left @ R, self.G @ (self.left2 @ R))))


def decaying_count(rates: NDArray[np.complex128]) -> int:
    """How many of the rates (n,) decay."""
    return int((rates.real < 0.0).sum())


def gap(rates: NDArray[np.complex128], k: int) -> float:
    """The distance of the real parts of the k-th and the next of the rates (n,); infinite if one of the two spaces is empty."""
    return float(rates[k].real - rates[k - 1].real) if 0 < k < len(rates) else np.inf
