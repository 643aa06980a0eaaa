"""A problem of which every eigenvalue is double: two copies of another one side by side, the second driven by the first or not."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from shootstab.problems.protocol import ComplexArray, FarFrame, Pencil, Problem


@dataclass(frozen=True, eq=False)
class Augmented:
    """C ψ′ = D ψ + drive·χ for the second copy ψ, χ the first. With drive = 0 there are two eigenfunctions, else one: σ is defective.

    A drive is for problems that end at walls: it must not reach the decaying space.
    """

    single: Problem
    drive: float = 0.0
    _crude: dict[float, Problem] = field(default_factory=dict, repr=False)

    @property
    def size(self) -> int:
        return 2 * self.single.size

    @property
    def decaying(self) -> int:
        return 2 * self.single.decaying

    def pencil(self, z: ComplexArray) -> Pencil:
        p = self.single.pencil(z)
        C0, C1, D0, D1 = (_blocks(M) for M in (p.C0, p.C1, p.D0, p.D1))
        n = self.single.size
        D0[:, n:, :n] = self.drive * np.eye(n)
        return Pencil(C0, C1, D0, D1)

    def start(self, sigma: complex, tolerance: float) -> float:
        return self.single.start(sigma, tolerance)

    def far_frame(self, z: float, sigma: complex) -> FarFrame:
        far = self.single.far_frame(z, sigma)
        return FarFrame(_blocks(far.frame[None])[0], _blocks(far.tangent[None])[0], 2 * far.log_scale, far.error)

    def mesh(self, start: float) -> NDArray[np.float64]:
        return self.single.mesh(start)

    def wall_rows(self) -> tuple[ComplexArray, ComplexArray]:
        W0, W1 = self.single.wall_rows()
        return _blocks(W0[None])[0], _blocks(W1[None])[0]

    def with_base_flow_error(self, factor: float) -> Problem:
        crude = self.single.with_base_flow_error(factor)
        if crude is self.single:
            return self
        return self._crude.setdefault(factor, Augmented(crude, self.drive))

    @property
    def continuum(self) -> Any:
        return self.single.continuum


def _blocks(M: ComplexArray) -> ComplexArray:
    """diag(M, M) of each of m matrices (m, rows, columns)."""
    points, rows, columns = M.shape
    out = np.zeros((points, 2 * rows, 2 * columns), dtype=np.complex128)
    out[:, :rows, :columns] = out[:, rows:, columns:] = M
    return out
