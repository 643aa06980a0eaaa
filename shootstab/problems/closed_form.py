"""Problems in closed form: those that can write down their pencil for numbers of any kind, and so for arrays and power series too.

A `ClosedForm` is six methods. `ClosedProblem` makes a problem of it, for doubles; more digits come from the form itself.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from shootstab.core.series import Series
from shootstab.problems.protocol import ComplexArray, FarFrame, Pencil

FIRST_MESH_POINTS = 33  # chosen: points of the first mesh, which is redistributed

Exact = Callable[[float], Any]  # a parameter as the decimal it stands for, in the arithmetic at work


class ClosedForm(Protocol):
    """What makes a problem ready for any number of digits: formulas with +, −, ·, / and ** for numbers of any kind.

    Every float that enters a formula goes through `exact`, which takes 0.8 for 8/10; integers and 1j may stand as they are. Other
    functions of z than those that +, −, ·, / and ** make are not available.
    """

    @property
    def size(self) -> int:
        """n, the order of the system."""
        ...

    @property
    def decaying(self) -> int:
        """k, the dimension of the space at the far end; there are as many wall rows."""
        ...

    def exact_ends(self, exact: Exact) -> tuple[Any, Any]:
        """z of the far end and of the wall, real: what `exact` gives, or an int, a Fraction, an mpf, or a float for its decimal."""
        ...

    def exact_pencil(self, z: Any, exact: Exact) -> Sequence[Mapping[tuple[int, int], Any]]:
        """C0, C1, D0, D1, or C0, …, Cq, D0, …, Dq, at z by their non-zero entries; z is a number, an array or a power series."""
        ...

    def exact_far(self, sigma: Any, exact: Exact) -> Sequence[Sequence[Any]]:
        """The decaying space (n, k) at the far end, analytic in σ."""
        ...

    def exact_wall(self, exact: Exact) -> Sequence[Sequence[Sequence[Any]]]:
        """W0, W1 (k, n), or more: (W0 + σ W1 + …) ψ = 0 at the wall."""
        ...


@dataclass(frozen=True, eq=False)
class ClosedProblem:
    """A closed form as a problem, without a continuous spectrum: see problems.protocol.Problem."""

    form: ClosedForm

    @property
    def size(self) -> int:
        return self.form.size

    @property
    def decaying(self) -> int:
        return self.form.decaying

    def pencil(self, z: ComplexArray) -> Pencil:
        dense = []
        for part in self.form.exact_pencil(z, complex):
            dense.append(np.zeros((len(z), self.size, self.size), dtype=np.complex128))
            for (i, j), entry in part.items():
                dense[-1][:, i, j] = entry
        half = len(dense) // 2
        return Pencil.of(dense[:half], dense[half:])

    def start(self, sigma: complex, tolerance: float) -> float:
        """The far end."""
        return self._ends[0]

    def far_frame(self, z: float, sigma: complex) -> FarFrame:
        rows = self.form.exact_far(Series((complex(sigma), 1.0 + 0.0j)), complex)
        dual = np.array([[x.coefficients if isinstance(x, Series) else (x, 0) for x in row] for row in rows], dtype=np.complex128)
        return FarFrame(dual[:, :, 0], dual[:, :, 1], 0.0, 0.0)

    def mesh(self, start: float) -> NDArray[np.float64]:
        return np.linspace(start, self._ends[1], FIRST_MESH_POINTS)

    def wall_rows(self) -> tuple[ComplexArray, ...]:
        return tuple(np.array(W, dtype=np.complex128) for W in self.form.exact_wall(complex))

    def with_base_flow_error(self, factor: float) -> ClosedProblem:
        """Itself: the base flow is in closed form."""
        return self

    @property
    def closed_form(self) -> ClosedForm:
        """The form, for more digits than a double holds."""
        return self.form

    @property
    def _ends(self) -> tuple[float, float]:
        far, wall = (complex(end).real for end in self.form.exact_ends(complex))
        return far, wall
