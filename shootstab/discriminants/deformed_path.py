"""Paths of integration in the complex z-plane.

Where σ comes close to the continuous spectrum, a singular point z_s of the system (det C(z_s; σ) = 0) comes close to the real axis. The
coefficients are analytic, so the path may leave the real axis around it. A path that passes z_s on the same side as the real axis gives
D itself; one that passes on the other side gives D continued analytically through the continuous spectrum.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from shootstab.problems.protocol import ComplexArray

FIRST_STEPS = 3  # chosen: first steps on each leg
CLEAR_OF_CORNER = 1e-9  # chosen: nodes nearer to a corner of the detour than this part of its half width are that corner


@dataclass(frozen=True)
class DeformedPath:
    """A detour through centre + i·height that leaves the real axis half_width before the centre and returns as far behind it.

    height > 0 passes above the centre in the z-plane, height < 0 below.
    """

    centre: float
    half_width: float
    height: float

    def deform(self, nodes: NDArray[np.float64]) -> ComplexArray:
        """The nodes (N,) of a mesh with the detour in it, (M,); the ends stay where they are, and a leg that would overshoot ends there."""
        along = 1.0 if nodes[-1] > nodes[0] else -1.0
        leave, apex, back = self.corners(nodes)
        before = nodes[along * nodes < along * leave.real - CLEAR_OF_CORNER * self.half_width]
        behind = nodes[along * nodes > along * back.real + CLEAR_OF_CORNER * self.half_width]
        out = np.linspace(leave, apex, FIRST_STEPS + 1)
        inward = np.linspace(apex, back, FIRST_STEPS + 1)[1:]
        return np.concatenate((before, out, inward, behind)).astype(np.complex128)

    def corners(self, nodes: NDArray[np.float64]) -> ComplexArray:
        """Where a path over real nodes (N,) leaves the real axis, its farthest point from it, and where it is back; (3,)."""
        start, wall = nodes[0], nodes[-1]
        along = 1.0 if wall > start else -1.0
        leave = max(along * start, along * self.centre - self.half_width) * along
        back = min(along * wall, along * self.centre + self.half_width) * along
        return np.array([leave, complex(self.centre, self.height), back], dtype=np.complex128)

    def __str__(self) -> str:
        side = "below" if self.height < 0.0 else "above"
        return f"through z = {self.centre:.4g} {'-' if self.height < 0 else '+'} {abs(self.height):.3g}i, {side} the singular point"
