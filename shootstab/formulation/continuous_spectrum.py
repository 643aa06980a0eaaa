"""Where C is singular: det C(z, σ) = 0, found from the equations. For real z that is the continuous spectrum of the inside."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from shootstab.core.errors import InputError
from shootstab.formulation.domain import Domain
from shootstab.formulation.evaluation import on_arrays
from shootstab.formulation.expression import Expression, number
from shootstab.formulation.first_order import FirstOrder
from shootstab.problems.protocol import ComplexArray


@dataclass(frozen=True, eq=False)
class InteriorSpectrum:
    """det C by powers of σ. curves: how many σ_c(z) there are, equal ones counted once if all are equal (single)."""

    determinant: dict[int, Expression]
    domain: Domain
    single: bool

    @property
    def curves(self) -> int:
        """The number of σ_c(z)."""
        return min(self._degree, 1) if self.single else self._degree

    @property
    def _degree(self) -> int:
        return max(self.determinant, default=0)

    @property
    def expression(self) -> Expression | None:
        """σ_c(z) where there is one curve."""
        if not self.single or self._degree == 0:
            return None
        d = self._degree
        return -self.determinant.get(d - 1, number(0)) / (number(d) * self.determinant[d])

    def curve(self, z: Any) -> Any:
        """σ_c at z (m,), real or complex; of several curves, those of `branches` one after the other cannot be told apart: the first."""
        if self.expression is None:
            return self.branches(np.asarray(z))[0]
        with np.errstate(all="ignore"):
            return np.broadcast_to(np.asarray(on_arrays(z, self.domain.given)(self.expression), dtype=np.complex128), np.shape(z)).copy()

    def branches(self, z: ComplexArray) -> list[ComplexArray]:
        """The σ_c (m,) of several curves at points z (m,) along a line, each followed from point to point."""
        at = on_arrays(z, self.domain.given)
        coefficients = [np.broadcast_to(at(self.determinant.get(k, number(0))), z.shape) for k in range(self._degree, -1, -1)]
        found = np.array([np.roots(c) for c in np.array(coefficients).T])
        for i in range(1, len(found)):
            rest = list(found[i])
            for j, before in enumerate(found[i - 1]):
                found[i, j] = rest.pop(int(np.argmin([abs(s - before) for s in rest])))
        return list(found.T)


def interior_spectrum(first: FirstOrder, domain: Domain, variable: str) -> InteriorSpectrum:
    """Raises InputError where C is singular at a point whatever σ is: the order of the equations changes there."""
    determinant = first.determinant
    degree = max(determinant, default=0)
    if not determinant:
        raise InputError("the highest derivatives do not determine each other: the equations are dependent")
    places = [domain.zero(c) for c in determinant.values()]
    if all(place is not None for place in places) and len(determinant) == 1:
        raise InputError(
            f"the order of the equations changes at {variable} = {places[0]:.4g}, where {determinant[degree]} vanishes that multiplies "
            "the highest derivatives: allowed is a domain without such a point inside"
        )
    single = True
    if degree > 1:
        top = determinant[degree]
        s = -determinant.get(degree - 1, number(0)) / (number(degree) * top)
        binomial = number(1)
        for k in range(degree - 1, -1, -1):
            binomial = binomial * number(k + 1) / number(degree - k)
            expected = binomial * top * (-s) ** (degree - k)
            single = single and domain.vanishing(determinant.get(k, number(0)) - expected)
    return InteriorSpectrum(determinant, domain, single)
