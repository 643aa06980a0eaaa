"""Base flows that have no formula: pieces of Taylor series, which hold every digit of a double, derivatives included."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from shootstab.problems.base_flow_error import off_by
from shootstab.problems.protocol import ComplexArray


@dataclass(frozen=True, eq=False)
class Piecewise:
    """A function of y ≥ 0: on [j h, (j+1) h] the polynomial Σ_m coefficients[j, m] (y − j h)^m, and beyond the last piece its limit.

    The coefficients are (pieces, terms). Points y may be complex: the piece is that of their real part.
    """

    h: float
    coefficients: NDArray[np.float64]
    limit: float

    @property
    def end(self) -> float:
        """Where the limit begins."""
        return self.h * len(self.coefficients)

    def __call__(self, y: ComplexArray) -> ComplexArray:
        """Values (m,) at points y (m,)."""
        at = np.asarray(y)
        beyond = at.real >= self.end  # asked of y itself: the end over the length of a piece may round to less than their number
        inside = np.clip(np.floor(np.minimum(at.real, self.end) / self.h).astype(np.int64), 0, len(self.coefficients) - 1)
        with np.errstate(invalid="ignore"):
            x = np.where(beyond | ~np.isfinite(at), 0.0, at - inside * self.h)
        value = np.zeros_like(x)
        for column in self.coefficients.T[::-1]:
            value = value * x + column[inside]
        return np.asarray(np.where(beyond, self.limit, value))

    def derivative(self) -> Piecewise:
        """d/dy; its limit is 0."""
        m = np.arange(1, self.coefficients.shape[1])
        return Piecewise(self.h, self.coefficients[:, 1:] * m, 0.0)

    def shortened(self, accuracy: float) -> Piecewise:
        """The profile with as few terms as leave out no more than this part of the largest coefficient, and each off by as much as that."""
        sizes = np.abs(self.coefficients * self.h ** np.arange(self.coefficients.shape[1])).max(axis=0)
        kept = int(np.flatnonzero(sizes > accuracy * sizes.max())[-1]) + 1
        return Piecewise(self.h, off_by(self.coefficients[:, :kept], accuracy), self.limit)
