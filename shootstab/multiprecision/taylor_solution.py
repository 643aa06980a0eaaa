"""The solution that belongs to a zero of D, to any number of digits: back-substitution through the factors of the Taylor steps.

A step carries the frame Y_s (n, k) to E_s = M_s Y_s, and Y_{s+1} = E_s B_s⁻¹ with B_s its best k rows. At a zero of D there is c with
W Y_N c = 0, W = W0 + σ W1 + … the rows at the wall, and

    c_N = c,   c_s = B_s⁻¹ c_{s+1},   ψ_s = Y_s c_s :

what is solved for goes from the wall outwards, as in discriminants/back_substitution.py. Between two places ψ is the series of the step,
and beyond the first one what the problem knows of its decaying space.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial
from typing import Any

from shootstab.core.errors import InputError
from shootstab.multiprecision import small_matrices as matrices
from shootstab.multiprecision.arithmetic import Arithmetic, Matrix
from shootstab.multiprecision.integration import Expansion, UnknownRows
from shootstab.multiprecision.linear_step import at_sigma, series
from shootstab.multiprecision.taylor import Taylor
from shootstab.multiprecision.taylor_shooting import TaylorShooting

Numbers = list[Any]  # numbers of the arithmetic
OUTSIDE_DIGITS = 1e-15  # chosen: part of the domain by which a z may miss an end that is known as a double


@dataclass(frozen=True, eq=False)
class TaylorSolution:
    """Places z_0 … z_N from the far end to the wall, steps between them, psi (n, 1) at the beginning of each, rows of the unknowns."""

    arithmetic: Arithmetic
    sigma: Any
    z: Numbers
    steps: Sequence[Expansion]
    psi: Sequence[Matrix]
    rows: Sequence[UnknownRows]
    order: int
    farther: Callable[[Any, Any], Mapping[str, Any] | None]
    farthest: float
    _series: dict[int, Mapping[str, list[Any]]] = field(default_factory=dict, repr=False)

    @property
    def names(self) -> tuple[str, ...]:
        """The unknowns."""
        return tuple(self.rows[0])

    @property
    def ends(self) -> tuple[float, float]:
        """The lowest and the highest z of the integration, without what rounding makes of an end at 0."""
        first, last = (float(self.arithmetic.to_mpmath(z)) for z in (self.z[0], self.z[-1]))
        low, high = sorted(0.0 if abs(z) < OUTSIDE_DIGITS * abs(last - first) else z for z in (first, last))
        return low, high

    @property
    def nodes(self) -> Numbers:
        """The places of the steps."""
        return self.z

    @property
    def outer(self) -> Numbers:
        """Places beyond the first one, where something is known there."""
        length = self.z[0] - self.z[-1]
        if self.farthest == math.inf:
            return [self.z[0] + length, self.z[0] + 10 * length]
        outwards = 1 if float(self.arithmetic.to_mpmath(length)) > 0.0 else -1
        return [self.z[0] + outwards * self.arithmetic.number(self.farthest / 2)] if self.farthest > 0.0 else []

    @property
    def extent(self) -> tuple[float, float]:
        """The lowest and the highest z at which something is known."""
        low, high = self.ends
        downwards = self.arithmetic.to_mpmath(self.z[0]) > self.arithmetic.to_mpmath(self.z[-1])
        reached = high + self.farthest if downwards else low - self.farthest
        place = 0.0 if abs(reached) < OUTSIDE_DIGITS * (high - low) else reached
        return (low, place) if downwards else (place, high)

    def __call__(self, z: Any) -> dict[str, Any]:
        """The unknowns by name at one place, a number of the arithmetic. Raises InputError for one outside the domain."""
        place, (low, high) = float(self.arithmetic.to_mpmath(z)), self.ends
        slack = OUTSIDE_DIGITS * (high - low)
        if not low - slack <= place <= high + slack:
            beyond = (z - self.z[0]) * (-1 if self.z[0] < self.z[-1] else 1)
            found = self.farther(z, beyond) if beyond > 0 else None
            if found is None:
                low, high = self.extent
                raise InputError(f"z = {place:g}: allowed is z from {low:.6g} to {high:.6g}")
            return dict(found)
        return self.at(z)

    def at(self, z: Any, prefix: str = "") -> dict[str, Any]:
        """The unknowns whose names begin so, by name, at one place inside the integration."""
        s = self._step(z)
        t = (z - self.z[s]) / self.steps[s].h
        return {name: self._sum(terms, t) for name, terms in self._terms(s).items() if name.startswith(prefix)}

    def _step(self, z: Any) -> int:
        """The step that z lies in."""
        inwards = self.z[-1] - self.z[0]
        return next(s for s in range(len(self.steps)) if s == len(self.steps) - 1 or (self.z[s + 1] - z) * inwards >= 0)

    def _terms(self, s: int) -> Mapping[str, list[Any]]:
        """The coefficients in t of each unknown along a step."""
        if s not in self._series:
            step = self.steps[s]
            C, D = at_sigma(step.C, self.sigma), at_sigma(step.D, self.sigma)
            terms = series(self.arithmetic, len(self.psi[s]), C, {at: e * step.h for at, e in D.items()}, self.psi[s], self.order)
            self._series[s] = {name: self._unknown(row, terms) for name, row in self.rows[s].items()}
        return self._series[s]

    def _unknown(self, row: Mapping[int, Any], terms: Sequence[Matrix]) -> list[Any]:
        total = [self.arithmetic.number(0)] * self.order
        for j, factor in row.items():
            component = [term[j][0] for term in terms]
            if isinstance(factor, Taylor):
                component = _product(self.arithmetic, factor.coefficients(self.order), component)
            else:
                component = [self.arithmetic.complex(factor) * x for x in component] if factor != 1 else component
            total = [self.arithmetic.rounded(a + b) for a, b in zip(total, component, strict=True)]
        return total

    def _sum(self, terms: Sequence[Any], t: Any) -> Any:
        total = terms[-1]
        for term in reversed(terms[:-1]):
            total = self.arithmetic.rounded(total * t + term)
        return total


def solved(shooting: TaylorShooting, sigma: Any) -> tuple[TaylorSolution, Matrix]:
    """The solution at a zero σ of D, with an arbitrary factor, and the combination (k, 1) of the far frame with which it begins.

    The shooting has not integrated yet.
    """
    arithmetic = shooting.arithmetic
    kept = shooting.solving(sigma)
    c = null_vector(arithmetic, matrices.product(arithmetic, kept.wall, kept.frames[-1]))
    psi: list[Matrix] = []
    for Y, best in zip(reversed(kept.frames[:-1]), reversed(kept.factors), strict=True):
        c = [[arithmetic.rounded(x) for x in row] for row in matrices.solve(arithmetic, best, c)]
        psi.insert(0, matrices.product(arithmetic, Y, c))
    z = [kept.at_wall]
    for step in reversed(kept.steps):
        z.insert(0, arithmetic.rounded(z[0] - step.h * arithmetic.number(step.part)))
    farther = partial(shooting.integration.farther, sigma, c)
    farthest = float(shooting.integration.farthest)
    return TaylorSolution(arithmetic, sigma, z, kept.steps, psi, kept.rows, shooting.settings.order, farther, farthest), c


def null_vector(arithmetic: Arithmetic, A: Matrix) -> Matrix:
    """x (k, 1) with A x = 0 as nearly as a singular A (k, k) allows: by elimination with full pivoting, the last unknown being 1."""
    work, order = [list(row) for row in A], list(range(len(A)))
    n = len(work)
    for r in range(n - 1):
        i, j = max(((i, j) for i in range(r, n) for j in range(r, n)), key=lambda at: arithmetic.log2(work[at[0]][at[1]]))
        work[r], work[i] = work[i], work[r]
        order[r], order[j] = order[j], order[r]
        for row in work:
            row[r], row[j] = row[j], row[r]
        for i in range(r + 1, n):
            if not matrices.vanishes(work[i][r]):
                factor = work[i][r] / work[r][r]
                work[i] = [arithmetic.rounded(x - factor * y) for x, y in zip(work[i], work[r], strict=True)]
    x = [arithmetic.number(1)]
    for r in range(n - 2, -1, -1):
        known = sum((a * b for a, b in zip(work[r][r + 1 :], x, strict=True)), arithmetic.number(0))
        x.insert(0, arithmetic.rounded(-known / work[r][r]))
    out = [[arithmetic.number(0)] for _ in range(n)]
    for place, value in zip(order, x, strict=True):
        out[place] = [value]
    return out


def _product(arithmetic: Arithmetic, a: Sequence[Any], b: Sequence[Any]) -> list[Any]:
    """The coefficients of a product of two series, as many as each has."""
    return [
        arithmetic.rounded(sum((a[j] * b[m - j] for j in range(m + 1) if not matrices.vanishes(a[j])), arithmetic.number(0)))
        for m in range(len(a))
    ]
