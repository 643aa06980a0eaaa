"""D(σ) by compound matrices: the decaying space as a vector of ∧^k Cⁿ, carried to the wall."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from shootstab.core.discriminant import Value
from shootstab.core.scaled import Scaled
from shootstab.discriminants.deformed_path import DeformedPath
from shootstab.discriminants.product import Product, shoot
from shootstab.discriminants.sampled_system import SampledSystem
from shootstab.discriminants.shooting import Shooting
from shootstab.kernels.exterior import induced, minors_with_slope
from shootstab.kernels.minor_transport import transport_minors
from shootstab.problems.protocol import ComplexArray, FarFrame, Problem


@dataclass(frozen=True)
class Compound:
    """Compound matrices with local errors below rtol, relative to what each minor can be at most for the sizes of its rows.

    Nothing is orthonormalized and nothing divided: y′ = A^(k) y is linear, and D the product of two vectors of n!/(k!(n−k)!)
    components. The price is their number, and steps that resolve sums of k rates.
    """

    rtol: float = 1e-11
    name: str = "compound"

    def on(self, problem: Problem, path: DeformedPath | None = None) -> Shooting | Product:
        """D(σ) of the problem, along the real axis or along a path; the mesh is made at the first σ and grows where another needs it."""
        return shoot(problem, lambda: self, path)

    def propagate(
        self, sampled: SampledSystem, rows: tuple[ComplexArray, ComplexArray], far: FarFrame, sigma: complex, tangent: bool
    ) -> tuple[Value, np.ndarray]:
        """D = Σ_I w_I y_I, w and y the minors of W0 + σW1 and of Y: by Cauchy–Binet det[(W0 + σW1) Y]."""
        n, k = far.frame.shape
        lists = induced(n, k)
        # columns of size 1, and by the way a number that depends on the basis: in another one everything rounds otherwise
        norms = np.linalg.norm(far.frame, axis=0)
        y, dy = minors_with_slope(far.frame / norms, far.tangent / norms, lists.subsets)
        errors = np.empty(len(sampled.nodes) - 1)
        system, at, y, dy = sampled.numbers(sigma, y, dy)
        log_scale = transport_minors(system, at, *lists, y, dy, tangent, errors)
        w, dw = minors_with_slope((rows[0] + sigma * rows[1]).T, rows[1].T, lists.subsets)
        with np.errstate(invalid="ignore", over="ignore"):  # a mesh too coarse for y: the errors tell
            D, dD = w @ y, w @ dy + dw @ y
        log_scale += math.log(norms.prod()) + far.log_scale
        return Value(sigma, Scaled(complex(D), log_scale), complex(dD)), errors
