"""One eigenvalue of A x = σ B x by inverse iteration, where a whole spectrum would be waste."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from shootstab.core.errors import ConvergenceError
from shootstab.spectral.qz import DenseMatrix

INVERSE_SETTLED = 1e-14  # chosen: a step below this part of |σ| ends the iteration
HELD = 3  # chosen: iterations with the guess as shift, so that the mode nearest to the guess wins
MOST_QUOTIENTS = 40  # chosen: iterations at most, of which some five are needed next to an eigenvalue
STALLED_STEP = 1e-9  # chosen: relative step below which one that does not shrink is rounding


@dataclass(frozen=True, eq=False)
class Refined:
    """An eigenvalue of the matrices, which is not yet one of the differential equation.

    sigma; iterations, each one LU factorization after the first HELD; residual = ‖(A − σB)x‖/(‖A‖‖x‖ + |σ|‖B‖‖x‖), Frobenius and
    Euclidean; change, the length of the last step in σ; vector (n,), of Euclidean length 1.
    """

    sigma: complex
    iterations: int
    residual: float
    change: float
    vector: DenseMatrix


def refine(A: DenseMatrix, B: DenseMatrix, guess: complex, max_iterations: int = MOST_QUOTIENTS) -> Refined:
    """The eigenvalue of A, B (n, n) next to guess by two-sided Rayleigh quotient iteration: x ← (A − σB)⁻¹Bx, y ← (A − σB)⁻ᴴBᴴy,
    σ ← σ + yᴴ(A − σB)x/(yᴴBx). A step falls as the cube of the one before.

    Source: A. M. Ostrowski, Arch. Rational Mech. Anal. 1–4 (1958–59). Raises ConvergenceError if the steps do not die out.
    """
    from scipy.linalg import lu_factor, lu_solve

    n = len(A)
    generator = np.random.default_rng(n)
    # real matrices with a real guess stay in real arithmetic, and their eigenvalue real
    real = not (np.iscomplexobj(A) or np.iscomplexobj(B) or complex(guess).imag)
    sigma: Any = complex(guess).real if real else complex(guess)
    shift = sigma
    x, y = (_unit(generator.standard_normal((n, 2)) @ np.array([1.0, 0.0 if real else 1.0j])) for _ in range(2))
    lu = lu_factor(A - shift * B)
    previous = np.inf
    for iteration in range(1, max_iterations + 1):
        if iteration > HELD:
            shift = sigma
            lu = lu_factor(A - shift * B)
        x = _unit(lu_solve(lu, B @ x))
        y = _unit(lu_solve(lu, B.conj().T @ y, trans=2))
        yB = y.conj() @ B
        following = (y.conj() @ (A @ x)) / (yB @ x)
        change, sigma = abs(following - sigma), following
        stalled = change >= previous and change <= STALLED_STEP * abs(sigma)
        if iteration > HELD and (change <= INVERSE_SETTLED * abs(sigma) or stalled):
            return Refined(complex(sigma), iteration, _residual(A, B, sigma, x), float(change), x)
        previous = change
    raise ConvergenceError(
        f"inverse iteration from {complex(guess):.6g} did not settle in {max_iterations} iterations: "
        f"it stands at {complex(sigma):.6g}, last step {previous:.1e}"
    )


def _unit(x: DenseMatrix) -> DenseMatrix:
    return np.asarray(x / np.linalg.norm(x))


def _residual(A: DenseMatrix, B: DenseMatrix, sigma: complex, x: DenseMatrix) -> float:
    """Relative to what rounding alone leaves; x has length 1."""
    return float(np.linalg.norm(A @ x - sigma * (B @ x)) / (np.linalg.norm(A) + abs(sigma) * np.linalg.norm(B)))
