"""D(σ) by orthonormalized shooting: the frame of the decaying space, carried to the wall."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from shootstab.core.discriminant import Value
from shootstab.core.scaled import Scaled
from shootstab.discriminants.deformed_path import DeformedPath
from shootstab.discriminants.product import Product, shoot
from shootstab.discriminants.sampled_system import SampledSystem
from shootstab.discriminants.shooting import Shooting
from shootstab.kernels.elimination import wall_determinant
from shootstab.kernels.frame_transport import transport
from shootstab.problems.protocol import ComplexArray, FarFrame, Problem


@dataclass(frozen=True)
class Frame:
    """Orthonormalized shooting with local errors below rtol, relative to each component of the frame."""

    rtol: float = 1e-11
    name: str = "frame"

    def on(self, problem: Problem, path: DeformedPath | None = None) -> Shooting | Product:
        """D(σ) of the problem, along the real axis or along a path; the mesh is made at the first σ and grows where another needs it."""
        return shoot(problem, lambda: self, path)

    def propagate(
        self, sampled: SampledSystem, rows: tuple[ComplexArray, ComplexArray], far: FarFrame, sigma: complex, tangent: bool
    ) -> tuple[Value, np.ndarray]:
        """D = det[(W0 + σW1) Y]; the R factors of the orthonormalizations are carried along, so that D is analytic."""
        errors = np.empty(len(sampled.nodes) - 1)
        system, at, Y, dY, W0, W1 = sampled.numbers(sigma, far.frame, far.tangent, *rows)
        log_det, trace = transport(system, at, Y, dY, tangent, errors)
        det, slope = wall_determinant(W0, W1, at, Y, dY)
        return Value(sigma, Scaled(det, log_det + far.log_scale), slope + complex(trace) * det), errors
