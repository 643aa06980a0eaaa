"""The regular solutions at a regular singular end in balls, power series in the distance from it (theory, lemma E14).

With ψ_j = x^{s_j} φ_j the system is C x dφ/dx = D φ, D = D̂ − Ĉ S (regular_singular.py). Regular are the solutions whose unknowns are
power series in x. Their first coefficients φ_m, x^{ρ+m}, m < count, are the null space of one matrix: some coefficients are free, a square
block gives the others, and exact_rank.py shows that no fewer are free. The recurrence gives the rest of the series.
"""

from __future__ import annotations

import math
from fractions import Fraction
from functools import cached_property
from typing import Any

from shootstab.core.balls import acb, acb_mat, arb, ctx
from shootstab.core.errors import ConvergenceError
from shootstab.formulation.enclosed import on_balls
from shootstab.formulation.exact_rank import shown_exactly
from shootstab.formulation.regular_singular import RegularSingularEnd, SolutionFamily
from shootstab.multiprecision.arithmetic import Matrix
from shootstab.multiprecision.enclosable import ball
from shootstab.multiprecision.minors import at_sigma, minors
from shootstab.multiprecision.tailed_pencil import TailedPencil
from shootstab.multiprecision.tailed_series import TailedSeries

LEAST_DISTANCE_ORDER = 60  # chosen: binary orders down to which a distance is looked for at which the series holds
SERIES_BITS = 4.0  # chosen: bits that a term gains on the one before it, about, from which their number follows
SPARE_SERIES_TERMS = 12  # chosen: terms beyond those that SERIES_BITS asks for
NO_NILPOTENT = [[arb(0)]]


def is_enclosed(end: RegularSingularEnd, bounded: list[int]) -> bool:
    """Whether the regular solutions are power series of one family whose number is shown exactly.

    Raises InputError where a coefficient's series are not rational.
    """
    if len(end.families) != 1 or any(family.exponent != round(family.exponent.real) for family in end.families):
        return False
    (family,) = end.families
    last = round(family.exponent.real) + family.count
    return all(last + end.shifts[j] >= 0 for j in bounded) and shown_exactly(end, family)


class EnclosedAxis:
    """See enclosed.DecayingEnd: an end for which is_enclosed holds, at z0, left in a direction."""

    lemmas = ("E14", "E11")
    inwards = False

    def __init__(self, end: RegularSingularEnd, at: Fraction, direction: int, farthest: float, reference: complex) -> None:
        """farthest: how far from z0 it may be left; reference: an eigenvalue, any one; it settles where it is left."""
        self._end, self._at, self._direction, self._reference = end, at, direction, acb(reference)
        self._farthest = math.floor(math.log2(farthest))
        self.decaying = end.columns

    @property
    def place(self) -> Any:
        """The z at which the end is left, an arb."""
        return ball(self._at) + self._direction * self._distance

    @property
    def multiple(self) -> tuple[Any, ...]:
        """The binary order of the distance at which it is left, and the coefficients that are free."""
        return self._order, self._end.families[0].free

    @property
    def _distance(self) -> Any:
        return arb(2) ** (self._farthest - self._order)

    def minors(self, sigma: Any) -> list[Any]:
        """The minors of the regular solutions there. Raises ConvergenceError where they are not enclosed."""
        (family,) = self._end.families
        pencil, rho = self._pencil(self._order), round(family.exponent.real)
        self._none_before(pencil, sigma, rho)
        found = pencil.continued(sigma, self._first(pencil, sigma, family), rho)
        if found is None:
            raise ConvergenceError("the regular solutions at a singular end are not enclosed: take more bits")
        rows = [[x * self._distance ** (rho + s) for x in row] for row, s in zip(found, self._end.shifts, strict=True)]
        return minors(rows, self.decaying)

    @cached_property
    def _order(self) -> int:
        rho = arb(round(self._end.families[0].exponent.real))
        for order in range(LEAST_DISTANCE_ORDER):
            if self._pencil(order).contraction(self._reference, rho, NO_NILPOTENT) <= 1.0:
                return order
        raise ConvergenceError("no start of the series of regular solutions at a singular end is found")

    def _pencil(self, order: int) -> TailedPencil:
        """C and D as series in x over the distance."""
        terms = max(math.ceil(ctx.prec / SERIES_BITS) + SPARE_SERIES_TERMS, 2 * self._end.families[0].count)
        x = TailedSeries([acb(0), acb(2) ** (self._farthest - order)], terms, real=True)
        at, nothing, shifts = on_balls(x, {}), x * 0, self._end.shifts
        C, D = ([{place: nothing + at(entry) for place, entry in part.items()} for part in powers] for powers in self._end.parts)
        for power, part in enumerate(C):
            for (i, j), y in part.items():
                if shifts[j]:
                    D[power][i, j] = D[power].get((i, j), nothing) - y * acb(shifts[j])
        return TailedPencil(len(shifts), C, D, terms)

    def _none_before(self, pencil: TailedPencil, sigma: Any, rho: int) -> None:
        """Regular solutions begin with no order below ρ: L_0 is invertible at these. Raises ConvergenceError where that is not seen."""
        if rho > 0:
            every = range(len(self._end.shifts))
            C, D = (at_sigma([{at: y.c[0] for at, y in part.items()} for part in parts], sigma) for parts in (pencil.C, pencil.D))
            for m in range(rho):
                L = acb_mat([[m * C.get((i, j), acb(0)) - D.get((i, j), acb(0)) for j in every] for i in every])
                if L.det().contains(0):
                    raise ConvergenceError("at a singular end it is not seen that no regular solution begins with a lower order")

    def _first(self, pencil: TailedPencil, sigma: Any, family: SolutionFamily) -> list[Matrix]:
        """φ_m (n, k), m < count."""
        n, rho, k = len(self._end.shifts), round(family.exponent.real), len(family.free)
        C, D = (
            [at_sigma([{at: _coefficient(y, q) for at, y in part.items()} for part in parts], sigma) for q in range(family.count)]
            for parts in (pencil.C, pencil.D)
        )
        place = {at: i for i, at in enumerate(family.allowed)}
        M = [[acb(0)] * len(family.allowed) for _ in family.rows]
        for r, row in enumerate(family.rows):
            m, i = divmod(row, n)
            for q in range(m + 1):
                for j in range(n):
                    column = place.get((m - q) * n + j)
                    if column is not None:
                        M[r][column] = (rho + m - q) * C[q].get((i, j), acb(0)) - D[q].get((i, j), acb(0))
        others = [i for i in range(len(family.allowed)) if i not in family.free]
        phi = [[[acb(0)] * k for _ in range(n)] for _ in range(family.count)]
        for q, free in enumerate(family.free):
            m, j = divmod(family.allowed[free], n)
            phi[m][j][q] = acb(1)
        if others:
            left, right = (acb_mat([[row[i] for i in places] for row in M]) for places in (others, list(family.free)))
            try:
                found = (left.inv() * -right).tolist()
            except ZeroDivisionError:
                raise ConvergenceError("at a singular end the first coefficients of regular solutions are not enclosed") from None
            for i, values in zip(others, found, strict=True):
                m, j = divmod(family.allowed[i], n)
                phi[m][j] = list(values)
        return phi


def _coefficient(y: TailedSeries, q: int) -> Any:
    return y.c[q] if q < len(y.c) else acb(0)
