"""Where C is singular: det C(z, σ) = 0, found from the equations. For real z that is the continuous spectrum of the inside."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from shootstab.core.errors import InputError
from shootstab.formulation.domain import ZERO_TOLERANCE, Domain
from shootstab.formulation.evaluation import on_arrays
from shootstab.formulation.expression import Expression, number, quotient
from shootstab.formulation.first_order import FirstOrder
from shootstab.formulation.names import Names
from shootstab.formulation.system import SIGMA, coefficients, degree, shown
from shootstab.problems.protocol import ComplexArray

LARGE_ON_CURVE = 10.0  # chosen: the size, in the median of |σ_c|, beyond which σ_c may be on its way to a pole
LEAVING_TO = 1e12  # chosen: the size, in that of its last sample before a pole, up to which σ_c is followed along a ray


@dataclass(frozen=True, eq=False)
class InteriorSpectrum:
    """det C by powers of σ. curves: how many σ_c(z) there are, equal ones counted once if all are equal (single).

    factors are the σ_c that are known as expressions, as often as each occurs, and rest is what det C is beside them, by powers of σ.
    """

    determinant: dict[int, Expression]
    domain: Domain
    single: bool
    factors: tuple[Expression, ...]
    rest: dict[int, Expression]

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
        """σ_c (m,) at z (m,), real or complex; of several curves the first of `branches`, which no formula tells from the others."""
        if self.expression is None:
            return self.branches(np.asarray(z))[0]
        with np.errstate(all="ignore"):
            return np.broadcast_to(np.asarray(on_arrays(z, self.domain.given)(self.expression), dtype=np.complex128), np.shape(z)).copy()

    @cached_property
    def through_infinity(self) -> bool:
        """Whether the one curve has a pole on the domain, ends included: α = ω/U at a wall, where U vanishes."""
        if self.expression is None:
            return False
        ends = np.array([end for end in (self.domain.left, self.domain.right) if np.isfinite(end)])
        return bool(not np.isfinite(self.curve(ends)).all() or len(self.stretches) > 1)

    @cached_property
    def stretches(self) -> tuple[tuple[NDArray[np.float64], ComplexArray], ...]:
        """The one curve as (z, σ_c), each (m,), on every stretch between its poles; next to a pole it goes on as it leaves for infinity.

        A pole lies between two samples where σ_c is larger halfway than at both, and there larger than elsewhere.
        """
        z = self.domain.points
        sizes = np.abs(self.curve(z))
        z = z[ZERO_TOLERANCE * sizes <= np.median(sizes)]
        sigma, halfway = self.curve(z), np.abs(self.curve(0.5 * (z[1:] + z[:-1])))
        sizes = np.abs(sigma)
        with np.errstate(invalid="ignore"):
            poles = ~(halfway <= np.maximum(sizes[1:], sizes[:-1])) & ~(halfway <= LARGE_ON_CURVE * np.median(sizes))
        found = []
        for places, values in zip(*(np.split(a, np.flatnonzero(poles) + 1) for a in (z, sigma)), strict=True):
            low, high = (LEAVING_TO * v if abs(v) > LARGE_ON_CURVE * np.median(sizes) else v for v in (values[0], values[-1]))
            found.append((np.concatenate((places[:1], places, places[-1:])), np.concatenate(([low], values, [high]))))
        return tuple(found)

    def branches(self, z: ComplexArray) -> list[ComplexArray]:
        """The σ_c (m,) of several curves at points z (m,) along a line: those known as expressions, and the others followed along it."""
        at = on_arrays(z, self.domain.given)
        known = [np.array(np.broadcast_to(at(curve), z.shape), dtype=np.complex128) for curve in self.factors]
        left = max(self.rest, default=0)
        if not left:
            return known
        powers = [np.broadcast_to(at(self.rest.get(k, number(0))), z.shape) for k in range(left, -1, -1)]
        found = np.array([np.roots(c) for c in np.array(powers).T])
        for i in range(1, len(found)):
            rest = list(found[i])
            for j, before in enumerate(found[i - 1]):
                found[i, j] = rest.pop(int(np.argmin([abs(s - before) for s in rest])))
        return [*known, *found.T]


def interior_spectrum(first: FirstOrder, domain: Domain, names: Names) -> InteriorSpectrum:
    """The determinant of C on the domain, with its curves.

    Raises InputError where C is singular at a point whatever σ is: the order of the equations changes there.
    """
    determinant = first.determinant
    highest = max(determinant, default=0)
    if not determinant:
        raise InputError("the highest derivatives are dependent: allowed are equations that determine those of all unknowns")
    places = [domain.zero(c) for c in determinant.values()]
    if all(place is not None for place in places) and len(determinant) == 1:
        singular = {(i, name) for i, row in enumerate(first.leading) for name, c in row.items() if domain.zero(c) is not None}
        if not singular:  # no coefficient vanishes by itself, but rows with several of them become dependent
            singular = {(i, name) for i, row in enumerate(first.leading) for name in row if len(row) > 1}
        orders = {name: 1 + max(order for at, order in first.states if at == name) for name in sorted({name for _, name in singular})}
        equations = dict.fromkeys(first.leading_names[i] for i in sorted({i for i, _ in singular}))
        told = f"{', '.join(shown(jet) for jet in orders.items())} in {', '.join(equations)}"
        raise InputError(
            f"the order of the equations changes at {names.variable} = {places[0]:.4g}, where {names.text(determinant[highest])} vanishes, "
            f"or has a pole, that multiplies {told}: allowed is a domain without such a point inside"
        )
    single = True
    if highest > 1:
        top = determinant[highest]
        s = -determinant.get(highest - 1, number(0)) / (number(highest) * top)
        binomial = number(1)
        for k in range(highest - 1, -1, -1):
            binomial = binomial * number(k + 1) / number(highest - k)
            expected = binomial * top * (-s) ** (highest - k)
            single = single and domain.vanishing(determinant.get(k, number(0)) - expected)
    factors, rest = _factors(determinant, [c for row in first.leading for c in row.values()])
    return InteriorSpectrum(determinant, domain, single, factors, rest)


def _factors(determinant: dict[int, Expression], entries: Iterable[Expression]) -> tuple[tuple[Expression, ...], dict[int, Expression]]:
    """The σ_c that the entries of the leading coefficients show by themselves, where their factors divide det C; and what is left of it."""
    whole = number(0)
    for power, c in determinant.items():
        whole = whole + c * SIGMA**power
    found = []
    for entry in dict.fromkeys(e for e in entries if degree(e) == 1):
        while degree(whole) > 1 and (smaller := quotient(whole, entry)) is not None and degree(smaller) == degree(whole) - 1:
            found.append(_zero(entry))
            whole = smaller
    if degree(whole) == 1:
        return (*found, _zero(whole)), {}
    return tuple(found), coefficients(whole)


def _zero(linear: Expression) -> Expression:
    """The zero of an expression that is linear in σ."""
    parts = coefficients(linear)
    return -parts.get(0, number(0)) / parts[1]
