"""Ends at infinity whose decaying solutions are enclosed as a graph: coefficients are series in an exponential, or powers (lemma E17).

x = e^{−κ d z} = 2^{−order} t, dx/ds = −κ x with s = d z; or r^{−1/p} = R^{−1/p} t, r = |z|, R = 2 (5/4)^order, ds = r^q dr, where
ψ_j = r^{s_j} φ_j.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from functools import cached_property
from typing import Any

from shootstab.core.balls import acb, acb_mat, arb, ctx
from shootstab.core.errors import ConvergenceError
from shootstab.formulation.asymptotic_end import AsymptoticEnd
from shootstab.formulation.enclosed import on_balls
from shootstab.formulation.exponentials import ExponentialEnd
from shootstab.formulation.state_pencil import Powers
from shootstab.multiprecision.decaying_graph import SeriesMatrix, decaying_rows, graph
from shootstab.multiprecision.minors import at_sigma, minors, solved
from shootstab.multiprecision.tailed_series import TailedSeries
from shootstab.problems.ends import INFINITIES

HIGHEST_GRAPH_ORDER = 40  # chosen: binary orders of t down to which an end is looked for at which the series holds
GRAPH_BITS, SPARE_GRAPH_TERMS = 2.0, 10  # chosen: bits that a term gains on the one before it, and terms beyond those
LEAST_GAIN_BITS = 24  # chosen: bits by which a tube is wider than rounding at most, where the end is left


class EnclosedGraph:
    """See enclosed.DecayingEnd: n states, of which k solutions decay towards the end."""

    lemmas = ("E17",)
    inwards = True

    def __init__(self, end: ExponentialEnd | AsymptoticEnd, size: int, decaying: int, reference: complex) -> None:
        """reference: an eigenvalue, any one with k decaying solutions; it settles where the end is left."""
        self._end, self._size, self.decaying, self._reference = end, size, decaying, acb(reference)

    @property
    def place(self) -> Any:
        """The z at which the end is left, an arb."""
        return self._end.direction * self._distance(self._order)

    @property
    def multiple(self) -> tuple[Any, ...]:
        """The binary order of t where it is left, and the rows over which the space is a graph."""
        return self._order, self._rows

    def minors(self, sigma: Any) -> list[Any]:
        """The minors of the decaying solutions there. Raises ConvergenceError where they are not enclosed."""
        X = self._graph(sigma, self._order).tolist()
        n, k = self._size, self.decaying
        others = [i for i in range(n) if i not in self._rows]
        rows = [[acb(int(q == self._rows.index(i))) for q in range(k)] if i in self._rows else X[others.index(i)] for i in range(n)]
        return minors([[x * factor for x in row] for row, factor in zip(rows, self._scales(self._order), strict=True)], k)

    @cached_property
    def _order(self) -> int:
        """The first at which the tube is hardly wider than rounding."""
        with ctx.workprec(ctx.prec):
            for order in range(1, HIGHEST_GRAPH_ORDER):
                try:
                    X = self._graph(self._reference, order)
                except ConvergenceError:
                    continue
                if all(max(x.real.rad(), x.imag.rad()) < arb(2) ** (LEAST_GAIN_BITS - ctx.prec) for x in X.entries()):
                    return order
        raise ConvergenceError(f"at {INFINITIES[self._end.direction]} no start of the series of decaying solutions is found")

    @cached_property
    def _rows(self) -> tuple[int, ...]:
        A = self._matrix(self._reference, HIGHEST_GRAPH_ORDER, 2)
        return decaying_rows(acb_mat([[entry.c[0] for entry in row] for row in A]), self.decaying)

    def _graph(self, sigma: Any, order: int) -> Any:
        n, k = self._size, self.decaying
        if k in (0, n):
            return acb_mat(n - k, k)
        terms = math.ceil(ctx.prec / GRAPH_BITS) + SPARE_GRAPH_TERMS
        return graph(self._matrix(sigma, order, terms), self._rows, self._slope(order), terms // 2)

    def _matrix(self, sigma: Any, order: int, terms: int) -> SeriesMatrix:
        """A(t) with dψ/ds = A ψ."""
        t = TailedSeries([acb(0), acb(self._unit(order))], terms, real=True)
        at, nothing = on_balls(t, {}), t * 0

        def series(powers: Powers) -> list[Mapping[tuple[int, int], TailedSeries]]:
            return [{place: nothing + at(entry) for place, entry in part.items()} for part in powers]

        A = solved(self._size, at_sigma(series(self._end.C), sigma), at_sigma(series(self._end.D), sigma))
        d, every = self._end.direction, range(self._size)
        out = [[A[i, j] * acb(d) if (i, j) in A else nothing for j in every] for i in every]
        if isinstance(self._end, AsymptoticEnd):
            p, Q = self._end.root, self._end.rank
            for i, s in enumerate(self._end.shifts):
                if s:  # S r^{−1−q} in units of 1/p
                    out[i][i] = out[i][i] - t ** (p + Q) * (acb(s) / p)
        return out

    def _slope(self, order: int) -> Any:
        if isinstance(self._end, ExponentialEnd):
            kappa = acb(on_balls(acb(0), {})(self._end.rate))

            def falling(f: TailedSeries) -> TailedSeries:
                return TailedSeries([c * (-m * kappa) for m, c in enumerate(f.c)], f.terms)

            return falling
        p, Q = self._end.root, self._end.rank
        shift, factor = p + Q, -(acb(self._unit(order)) ** (p + Q)) / p

        def slower(f: TailedSeries) -> TailedSeries:
            return TailedSeries([acb(0)] * shift + [c * (m * factor) for m, c in enumerate(f.c)], max(f.terms, len(f.c) + shift))

        return slower

    def _unit(self, order: int) -> Any:
        """The x or r^{−1/p} at which the end is left."""
        return arb(2) ** -order if isinstance(self._end, ExponentialEnd) else self._distance(order) ** (arb(-1) / self._end.root)

    def _distance(self, order: int) -> Any:
        if isinstance(self._end, ExponentialEnd):
            return order * arb(2).log() / acb(on_balls(acb(0), {})(self._end.rate)).real
        return 2 * (arb(5) / 4) ** order

    def _scales(self, order: int) -> list[Any]:
        if isinstance(self._end, ExponentialEnd):
            return [acb(1)] * self._size
        return [acb(1 / self._unit(order)) ** s for s in self._end.shifts]
