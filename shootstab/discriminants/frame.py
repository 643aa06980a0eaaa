"""D(σ) by orthonormalized shooting: the frame of the decaying space, carried to the wall."""

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
from shootstab.discriminants.zero_gradient import CarriedFrames
from shootstab.kernels.elimination import wall_determinant
from shootstab.kernels.frame_transport import transport
from shootstab.problems.protocol import ComplexArray, FarFrame


@dataclass(frozen=True)
class Frame:
    """Orthonormalized shooting with local errors below rtol, relative to each component of the frame."""

    rtol: float = DEFAULT_RTOL
    name: str = "frame"

    on = adaptive

    def __post_init__(self) -> None:
        require_tolerance(self)

    def fixed_at(self, sampled: SampledSystem, far: FarFrame, sigma: complex) -> Self:
        """Itself: on a mesh nothing is chosen."""
        return self

    def propagate(
        self, sampled: SampledSystem, rows: tuple[ComplexArray, ...], far: FarFrame, sigma: complex, tangent: bool
    ) -> Propagation:
        """D = det[W(σ) Y]; the R factors of the orthonormalizations are carried along, so that D is analytic."""
        errors = np.empty(len(sampled.nodes) - 1)
        system, at, Y, dY, *W = sampled.numbers(sigma, far.frame, far.tangent, *rows)
        frames = np.empty((len(sampled.nodes), *Y.shape), Y.dtype) if tangent else None
        log_det, trace = transport(system, at, Y, dY, tangent, errors, frames)
        at_wall = (polynomial.value(W, at), polynomial.slope(W, at), Y, dY)
        det, slope = wall_determinant(*(a.astype(np.complex128, copy=False) for a in at_wall))
        way = None if frames is None else CarriedFrames(frames, Y, dY, complex(trace))
        return Propagation(Value(sigma, Scaled(det, log_det + far.log_scale), slope + complex(trace) * det), errors, True, way)
