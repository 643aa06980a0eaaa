"""What a problem is: C(σ) ψ′ = D(σ) ψ with a decaying space at the far end and rows at the wall, polynomials in σ, affine mostly."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

ComplexArray = NDArray[np.complex128]
GENERIC_SIGMA = 0.35  # chosen: a real σ that is no special value of anything; what holds there by accident holds nowhere else


@dataclass(frozen=True)
class Pencil:
    """C = C0 + σ C1 + … and D = D0 + σ D1 + … at m points, each (m, n, n), or at one, (n, n); higher are (C2, D2), (C3, D3), …"""

    C0: ComplexArray
    C1: ComplexArray
    D0: ComplexArray
    D1: ComplexArray
    higher: tuple[tuple[ComplexArray, ComplexArray], ...] = ()

    @classmethod
    def of(cls, C: Sequence[ComplexArray], D: Sequence[ComplexArray]) -> Pencil:
        """The pencil of the coefficients of C and of D, (m, n, n), as many of both and two at least."""
        return cls(C[0], C[1], D[0], D[1], tuple(zip(C[2:], D[2:], strict=True)))

    @property
    def C(self) -> tuple[ComplexArray, ...]:
        """C0, C1, …, (m, n, n)."""
        return (self.C0, self.C1, *(C for C, _ in self.higher))

    @property
    def D(self) -> tuple[ComplexArray, ...]:
        """D0, D1, …, (m, n, n)."""
        return (self.D0, self.D1, *(D for _, D in self.higher))

    @property
    def named(self) -> dict[str, ComplexArray]:
        """All by their names, C0, C1, …, D0, D1, …, (m, n, n)."""
        return {f"{name}{k}": M for name, part in (("C", self.C), ("D", self.D)) for k, M in enumerate(part)}

    def each(self, change: Callable[[ComplexArray], ComplexArray]) -> Pencil:
        """The pencil with every matrix, (m, n, n), changed."""
        return Pencil.of([change(M) for M in self.C], [change(M) for M in self.D])

    def stretched(self, factor: float) -> Pencil:
        """The pencil over t with z = factor·t: D times the factor."""
        return Pencil.of(self.C, [factor * M for M in self.D])

    def rescaled(self, unit: complex) -> Pencil:
        """The pencil in v with σ = unit·v."""
        return Pencil.of(*([unit**k * M if k else M for k, M in enumerate(part)] for part in (self.C, self.D)))


class PencilSource(Protocol):
    """What sampling asks for: a pencil and its size."""

    @property
    def size(self) -> int:
        """n, the number of components."""
        ...

    def pencil(self, z: ComplexArray) -> Pencil:
        """C and D at points z (m,)."""
        ...


@dataclass(frozen=True)
class FarFrame:
    """A basis of the decaying space at a point, analytic in σ: frame · exp(log_scale/k) per column.

    frame and its σ-derivative tangent are (n, k); error bounds their relative error.
    """

    frame: ComplexArray
    tangent: ComplexArray
    log_scale: float
    error: float


class Problem(Protocol):
    """What the engine asks of a problem. Points z run from the far end to the wall and may be complex. A problem does not change."""

    def __hash__(self) -> int: ...

    @property
    def size(self) -> int:
        """n, the order of the system."""
        ...

    @property
    def decaying(self) -> int:
        """k, the dimension of the decaying space; there are as many wall rows."""
        ...

    def pencil(self, z: ComplexArray) -> Pencil:
        """The matrices at the points z (m,), which come in the order of the path."""
        ...

    def start(self, sigma: complex, tolerance: float) -> float:
        """A place as near to the wall as a far frame of this relative accuracy can be given for σ."""
        ...

    def far_frame(self, z: float, sigma: complex) -> FarFrame:
        """The decaying space at z."""
        ...

    def mesh(self, start: float) -> NDArray[np.float64]:
        """Points (m,) from start to the wall, both included, roughly as dense as the solutions vary: a first mesh."""
        ...

    def wall_rows(self) -> tuple[ComplexArray, ...]:
        """W0, W1, … (k, n), two at least: (W0 + σ W1 + …) ψ = 0 at the wall."""
        ...

    def with_base_flow_error(self, factor: float) -> Problem:
        """The same problem with its base flow computed less accurately by this factor; itself if the base flow is in closed form."""
        ...
