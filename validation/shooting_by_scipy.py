"""The same boundary determinant as a good script would form it: solve_ivp with DOP853, NumPy's QR, and a secant.

The steady flow and the pencil come from the problem; the right-hand side is vectorized over columns, and the R factors are carried along.
"""

from __future__ import annotations

from itertools import pairwise

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

from shootstab.models.chute import ChuteProblem

SUBINTERVALS = 20  # chosen: the length between orthonormalizations
SECANTS = 20  # chosen


class ScipyShooting:
    """D(σ) of one problem."""

    def __init__(self, problem: ChuteProblem) -> None:
        self.problem = problem
        self.rows = problem.wall_rows()

    def determinant(self, sigma: complex, rtol: float, scale: float | None = None) -> tuple[complex, float]:
        """D as a mantissa and a log scale; with a scale given, the mantissa at it."""
        p = self.problem
        start = p.start(sigma, 1e-14)
        far = p.far_frame(start, sigma)
        Y, log_det = far.frame.copy(), complex(far.log_scale)
        heights = np.linspace(start, 0.0, SUBINTERVALS + 1)

        def rhs(z: float, y: NDArray[np.complex128]) -> NDArray[np.complex128]:
            M = p.pencil(np.array([z + 0j]))
            A = np.linalg.solve(M.C0[0] + sigma * M.C1[0], M.D0[0] + sigma * M.D1[0])
            columns = y.reshape(8, -1)
            return np.asarray((A @ columns).reshape(y.shape))

        for above, below in pairwise(heights):
            solution = solve_ivp(rhs, (above, below), Y.ravel(), "DOP853", rtol=rtol, atol=1e-3 * rtol, t_eval=[below])
            Y, R = np.linalg.qr(solution.y[:, -1].reshape(8, 4))
            log_det += np.log(np.diag(R).astype(complex)).sum()
        det = np.linalg.det((self.rows[0] + sigma * self.rows[1]) @ Y)
        reference = log_det.real if scale is None else scale
        return complex(det * np.exp(log_det - reference)), reference

    def root(self, guess: complex, rtol: float, tolerance: float) -> complex:
        """The zero next to the guess, by secants."""
        a, b = guess, guess * (1 + 1e-4)
        fa, scale = self.determinant(a, rtol)
        fb, _ = self.determinant(b, rtol, scale)
        for _ in range(SECANTS):
            step = -fb * (b - a) / (fb - fa)
            a, fa, b = b, fb, b + step
            if abs(step) <= tolerance * abs(b):
                return b
            fb, _ = self.determinant(b, rtol, scale)
        return b
