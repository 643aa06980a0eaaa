"""The solutions that decay towards an end at infinity in balls, where coefficients come to their limits like an exponential.

With x = e^{−κ d z} the end is a regular singular point, C x dψ/dx = −(d/κ) D ψ (exponentials.py). A = C⁻¹ (−(d/κ) D) has at x = 0 simple
eigenvalues μ_q with eigenvectors v_q, those that decay with Re μ_q > 0, and the solutions x^{μ_q} P_q(x), P_q(0) = v_q. Over the factors
x^{μ_q} and one minor of the v_q their minors are analytic in σ (theory, lemma E12).
"""

from __future__ import annotations

import math
from functools import cached_property
from itertools import combinations
from typing import Any

import numpy as np

from shootstab.core.balls import acb, acb_mat, arb, ctx
from shootstab.core.errors import ConvergenceError
from shootstab.formulation.enclosed import on_balls
from shootstab.formulation.exponentials import ExponentialEnd
from shootstab.multiprecision import small_matrices as matrices
from shootstab.multiprecision.minors import at_sigma, minors
from shootstab.multiprecision.tailed_pencil import BALLS, TailedPencil
from shootstab.multiprecision.tailed_series import TailedSeries
from shootstab.multiprecision.tails import radius_of_doubles
from shootstab.problems.ends import INFINITIES

HIGHEST_ORDER = 60  # chosen: binary orders down to which an x is looked for at which the series holds
DECAY_BITS = 4.0  # chosen: bits that a term gains on the one before it, about, from which their number follows
TERMS_OVER_RADIUS = 3.0  # chosen: terms at least, over the spectral radius of |A_0|: two times it make the tail contract by a half
SPARE_TERMS = 12  # chosen: terms beyond those that DECAY_BITS asks for


class EnclosedInfinity:
    """One end of a system of n states, of which k solutions decay."""

    lemmas = ("E12", "E11")
    inwards = False

    def __init__(self, end: ExponentialEnd, size: int, decaying: int, reference: complex) -> None:
        """reference: an eigenvalue, any one with k decaying solutions; it settles where the end is left."""
        self._end, self._size, self.decaying, self._reference = end, size, decaying, acb(reference)

    @property
    def place(self) -> Any:
        """The z at which the end is left, an arb."""
        return self._order * arb(2).log() / self._rate * self._end.direction

    @property
    def multiple(self) -> tuple[Any, ...]:
        """The binary order of x where it is left, and the rows of the minor of the eigenvectors that the others are divided by."""
        return self._order, self._rows

    def minors(self, sigma: Any) -> list[Any]:
        """The k-minors of the decaying solutions there, the subsets of rows in lexicographic order.

        Raises ConvergenceError where it is not proved that k of them decay and the others grow.
        """
        pencil = self._pencil(self._order)
        vectors = self._decaying_vectors(pencil, sigma)
        columns = []
        for exponent, vector in vectors:
            found = pencil.decaying(sigma, [[x] for x in vector], exponent, [[arb(0)]])
            if found is None:
                raise ConvergenceError(f"at {INFINITIES[self._end.direction]} the decaying solutions are not enclosed: take more bits")
            columns.append([row[0] for row in found])
        unit = acb_mat([[vector[i] for _, vector in vectors] for i in self._rows]).det()
        if not abs(unit) > 0:
            raise ConvergenceError(f"at {INFINITIES[self._end.direction]} the decaying solutions are not told apart: take more bits")
        return [y / unit for y in minors([list(row) for row in zip(*columns, strict=True)], self.decaying)]

    @cached_property
    def _order(self) -> int:
        """The end is left at x = 2^−order."""
        if self._end.constant:
            return 0
        for order in range(1, HIGHEST_ORDER):
            if self._pencil(order).contraction(self._reference, arb(1), [[arb(0)]]) <= 1.0:
                return order
        raise ConvergenceError(f"at {INFINITIES[self._end.direction]} no start of the series of decaying solutions is found")

    @cached_property
    def _rows(self) -> tuple[int, ...]:
        """The rows whose minor of the eigenvectors is the largest at the reference: any one that is not zero would do."""
        vectors = self._decaying_vectors(self._pencil(self._order), self._reference)
        subsets = combinations(range(self._size), self.decaying)
        return max(subsets, key=lambda rows: float(abs(acb_mat([[v[i] for _, v in vectors] for i in rows]).det()).lower()))

    @property
    def _rate(self) -> Any:
        """κ."""
        return acb(on_balls(acb(0), {})(self._end.rate)).real

    def _pencil(self, order: int) -> TailedPencil:
        terms = max(math.ceil(ctx.prec / DECAY_BITS) + SPARE_TERMS, self._least_terms)
        x = TailedSeries([acb(0), acb(2) ** -order], terms, real=True)
        at, factor, nothing = on_balls(x, {}), acb(-self._end.direction) / self._rate, x * 0
        C = [{place: nothing + at(entry) for place, entry in part.items()} for part in self._end.C]
        D = [{place: (nothing + at(entry)) * factor for place, entry in part.items()} for part in self._end.D]
        return TailedPencil(self._size, C, D, terms)

    @cached_property
    def _least_terms(self) -> int:
        """The number with which the series contracts where |A_0| is large: its spectral radius at the reference tells; a choice."""
        at, factor = on_balls(acb(0), {}), -self._end.direction / float(self._rate.mid())
        C, D = (
            at_sigma([{place: at(e) for place, e in part.items()} for part in parts], self._reference)
            for parts in (self._end.C, self._end.D)
        )
        C0, D0 = (np.zeros((self._size, self._size), dtype=np.complex128) for _ in range(2))
        for full, part in ((C0, C), (D0, D)):
            for place, entry in part.items():
                full[place] = complex(acb(entry).mid())
        return math.ceil(TERMS_OVER_RADIUS * radius_of_doubles(np.abs(np.linalg.solve(C0, factor * D0))))

    def _decaying_vectors(self, pencil: TailedPencil, sigma: Any) -> list[tuple[Any, list[Any]]]:
        """(μ_q, v_q) of those with Re μ_q > 0."""
        n, where = range(self._size), INFINITIES[self._end.direction]
        C, D = (at_sigma([{at: y.c[0] for at, y in part.items()} for part in parts], sigma) for parts in (pencil.C, pencil.D))
        C0, D0 = ([[part.get((i, j), acb(0)) for j in n] for i in n] for part in (C, D))
        try:
            exponents, found = acb_mat(matrices.product(BALLS, matrices.inverse(BALLS, C0), D0)).eig(right=True, algorithm="rump")
        except ValueError:
            raise ConvergenceError(
                f"at {where} two exponents of the solutions are not told apart: take a smaller disc, or more bits"
            ) from None
        growing = sum(bool(mu.real < 0) for mu in exponents)
        decaying = [q for q in n if exponents[q].real > 0]
        if len(decaying) != self.decaying or growing + len(decaying) != self._size:
            raise ConvergenceError(
                f"at {where} it is not proved that {self.decaying} of {self._size} solutions decay and the others grow: "
                "sigma may lie on the essential spectrum, or next to it"
            )
        return [(exponents[q], [found[i, q] for i in n]) for q in decaying]
