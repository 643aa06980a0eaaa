"""D(σ) by compound matrices: the decaying space as a vector of ∧^k Cⁿ, carried to the wall."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Self

import numpy as np

from shootstab.core import polynomial
from shootstab.core.discriminant import Value
from shootstab.core.scaled import Scaled
from shootstab.discriminants.adaptive import adaptive
from shootstab.discriminants.method import DEFAULT_RTOL, Propagation, require_tolerance
from shootstab.discriminants.sampled_system import SampledSystem
from shootstab.kernels.exterior import induced, minors_with_slope
from shootstab.kernels.minor_transport import transport_minors
from shootstab.problems.protocol import ComplexArray, FarFrame


@dataclass(frozen=True)
class Compound:
    """Compound matrices with local errors below rtol, relative to what each minor can be at most for the sizes of its rows.

    Nothing is orthonormalized and nothing divided: y′ = A^(k) y is linear, and D the product of two vectors of n!/(k!(n−k)!)
    components. The price is their number, and steps that resolve sums of k rates.
    """

    rtol: float = DEFAULT_RTOL
    name: str = "compound"

    on = adaptive

    def __post_init__(self) -> None:
        require_tolerance(self)

    def fixed_at(self, sampled: SampledSystem, far: FarFrame, sigma: complex) -> Self:
        """Itself: on a mesh nothing is chosen."""
        return self

    def propagate(
        self, sampled: SampledSystem, rows: tuple[ComplexArray, ...], far: FarFrame, sigma: complex, tangent: bool
    ) -> Propagation:
        """D = Σ_I w_I y_I, w and y the minors of W(σ) and of Y: by Cauchy–Binet det[W(σ) Y]."""
        n, k = far.frame.shape
        lists = induced(n, k)
        # columns of size 1; the samples of rounding rely on it too: in a rotated basis these norms differ, and everything rounds otherwise
        norms = np.linalg.norm(far.frame, axis=0)
        y, dy = minors_with_slope(far.frame / norms, far.tangent / norms, lists.subsets)
        errors = np.empty(len(sampled.nodes) - 1)
        system, at, y, dy = sampled.numbers(sigma, y, dy)
        log_scale = transport_minors(system, at, *lists, y, dy, tangent, errors)
        w, dw = minors_with_slope(polynomial.value(rows, sigma).T, polynomial.slope(rows, sigma).T, lists.subsets)
        with np.errstate(invalid="ignore", over="ignore"):  # a mesh too coarse for y: the errors tell
            D, dD = w @ y, w @ dy + dw @ y
        log_scale += float(np.log(norms).sum()) + far.log_scale
        return Propagation(Value(sigma, Scaled(complex(D), log_scale), complex(dD)), errors)
