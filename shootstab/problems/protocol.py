"""What a problem is: (C0 + σ C1) ψ′ = (D0 + σ D1) ψ with a decaying space at the far end and rows at the wall."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

ComplexArray = NDArray[np.complex128]
GENERIC_SIGMA = 0.35  # chosen: a real σ that is no special value of anything; what holds there by accident holds nowhere else


@dataclass(frozen=True)
class Pencil:
    """The matrices at m points, each (m, n, n)."""

    C0: ComplexArray
    C1: ComplexArray
    D0: ComplexArray
    D1: ComplexArray


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

    def wall_rows(self) -> tuple[ComplexArray, ComplexArray]:
        """W0, W1 (k, n): (W0 + σ W1) ψ = 0 at the wall."""
        ...

    def with_base_flow_error(self, factor: float) -> Problem:
        """The same problem with its base flow computed less accurately by this factor; itself if the base flow is in closed form."""
        ...
