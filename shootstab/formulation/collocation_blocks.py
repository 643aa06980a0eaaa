"""One layer of a problem in a collocation: its unknowns over a basis, its equations at points, and rows that hold at single places."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from shootstab.core.errors import InputError
from shootstab.formulation.collocation_counts import Counts
from shootstab.formulation.evaluation import Given
from shootstab.formulation.layers import Layer
from shootstab.formulation.scaled_values import scaled_values
from shootstab.formulation.system import EquationRow, coefficients, degree
from shootstab.spectral.bases import Basis, BasisExtent, BasisPoints


@dataclass(frozen=True, eq=False)
class UnknownColumns:
    """The columns of one unknown: values of its functions at points; an amplitude has one column and neither basis nor points."""

    first: int
    shape: BasisExtent
    basis: Basis | None = None
    at: BasisPoints | None = None

    def values(self, order: int) -> NDArray[np.float64]:
        """The order-th derivative, (points, width)."""
        if self.basis is None or self.at is None:
            return np.ones((1, 1))
        return self.basis.matrix(self.at, self.shape, order)


@dataclass(frozen=True, eq=False)
class LayerBlock:
    """A layer with its basis; first is the column where its coefficients begin, N + d_j of the unknown j."""

    layer: Layer
    counts: Counts
    basis: Basis
    N: int
    first: int

    @property
    def shapes(self) -> list[BasisExtent]:
        """How each unknown is expanded."""
        return [BasisExtent(self.N + d, d) for d in self.counts[0]]

    @property
    def lengths(self) -> list[int]:
        """Coefficients of each unknown."""
        return [shape.width for shape in self.shapes]

    def columns(self, at: BasisPoints) -> dict[str, UnknownColumns]:
        """Those of each unknown, at points."""
        starts = (self.first + np.cumsum([0, *self.lengths[:-1]])).tolist()
        both = zip(starts, self.shapes, strict=True)
        return {name: UnknownColumns(*pair, self.basis, at) for name, pair in zip(self.layer.system.unknowns, both, strict=True)}

    def equations(self, shape: tuple[int, int]) -> list[NDArray[np.complex128]]:
        """The equations at their points, each (q + 1, m, n) by powers of σ, points and columns; shape is that without points."""
        out = []
        for row, c in zip(self.layer.system.rows, self.counts[1], strict=True):
            at = self.basis.points(self.N + c)
            out.append(sampled(row, at.z, self.columns(at), shape, self.layer.domain.given))
        return out


def sampled(
    row: EquationRow, z: NDArray[np.float64], columns: Mapping[str, UnknownColumns], shape: tuple[int, int], given: Given
) -> NDArray[np.complex128]:
    """A row at the points z (m,), (highest + 1, m, columns), shape = (highest + 1, columns).

    What grows along z is divided, at each point, by the largest exponential in the row. Raises InputError for what is not finite.
    """
    parts = [(name, order, power, part) for (name, order), c in row.items() for power, part in coefficients(c).items()]
    with np.errstate(all="ignore"):  # what is not finite is refused
        scaled = [scaled_values(part, z, given) for *_, part in parts]
        largest = np.max([np.where(values == 0, -np.inf, logs) for values, logs in scaled], axis=0)
        out = np.zeros((shape[0], len(z), shape[1]), dtype=np.complex128)
        for (name, order, power, _), (values, logs) in zip(parts, scaled, strict=True):
            at = columns[name]
            factor = np.where(values == 0, 0.0, values * np.exp(logs - largest))
            out[power, :, at.first : at.first + at.shape.width] += factor[:, None] * at.values(order)
    if not np.isfinite(out).all():
        raise InputError("a coefficient of the equations is not finite inside the domain, or one of the conditions at an end")
    return out


def highest_power(rows: Sequence[EquationRow]) -> int:
    """The highest power of σ in rows."""
    return max(degree(coefficient) for row in rows for coefficient in row.values())
