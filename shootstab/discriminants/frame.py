"""D(σ) by orthonormalized shooting: the frame of the decaying space, carried to the wall."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Self

import numpy as np

from shootstab.core import polynomial
from shootstab.core.discriminant import Value
from shootstab.core.scaled import Scaled
from shootstab.discriminants.adaptive import Adaptive
from shootstab.discriminants.deformed_path import DeformedPath
from shootstab.discriminants.method import Meshes, Propagation, require_tolerance
from shootstab.discriminants.sampled_system import SampledSystem
from shootstab.kernels.elimination import wall_determinant
from shootstab.kernels.frame_transport import transport
from shootstab.problems.protocol import ComplexArray, FarFrame, Problem


@dataclass(frozen=True)
class Frame:
    """Orthonormalized shooting with local errors below rtol, relative to each component of the frame."""

    rtol: float = 1e-11
    name: str = "frame"

    def __post_init__(self) -> None:
        require_tolerance(self.rtol)

    def on(
        self, problem: Problem, path: DeformedPath | None = None, centre: complex | None = None, begin: Meshes | None = None
    ) -> Adaptive:
        """D(σ) of the problem, along the real axis or along a path meant for σ = centre; begin are meshes of a neighbouring problem.

        Raises InputError where D is asked for and the problem is wrong, ConvergenceError where no mesh is found.
        """
        return Adaptive(problem, self, path, centre, begin)

    def settled(self, sampled: SampledSystem, far: FarFrame, sigma: complex) -> Self:
        """Itself: on a mesh nothing is chosen."""
        return self

    def propagate(
        self, sampled: SampledSystem, rows: tuple[ComplexArray, ...], far: FarFrame, sigma: complex, tangent: bool
    ) -> Propagation:
        """D = det[W(σ) Y]; the R factors of the orthonormalizations are carried along, so that D is analytic."""
        errors = np.empty(len(sampled.nodes) - 1)
        system, at, Y, dY, *W = sampled.numbers(sigma, far.frame, far.tangent, *rows)
        log_det, trace = transport(system, at, Y, dY, tangent, errors)
        det, slope = wall_determinant(polynomial.value(W, at), polynomial.slope(W, at), Y, dY)
        return Propagation(Value(sigma, Scaled(det, log_det + far.log_scale), slope + complex(trace) * det), errors)
