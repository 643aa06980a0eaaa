"""D(σ) enclosed in a ball: Taylor steps with rigorous tails on the compound vector.

The solutions Y (n, k) that the first end admits are carried as y = Λ^k Y, which obeys y′ = A^(k) y with A = C⁻¹D, and D = Σ_I w_I y_I
with the minors w of the conditions at the other end: no division by anything that depends on the solution, no orthonormalization, and one
ball for each component. σ is thin: a circle is sampled, never enclosed (theory, lemmas E2 and E3).

On a step z = z_0 + h t, |t| ≤ 1, with B = h A^(k) = Σ B_j t^j + (tail): the coefficients (m + 1) y_{m+1} = Σ_{j≤m} B_j y_{m−j} are
computed for m + 1 < N, and X_i = Σ_{m≥N} |y_{m,i}| obeys X ≤ G X + R with

    G = ‖B‖/N,   R = (1/N) Σ_{k<N} Σ_{j≥N−1−k} |B_j| |y_k|,

entrywise. If G w ≤ g w for some w > 0 and g < 1, then X ≤ w max_l (R_l/w_l)/(1 − g).
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

import numpy as np

from shootstab.core.balls import acb, acb_mat, arb, ctx
from shootstab.core.errors import ConvergenceError
from shootstab.core.scaled import TINY
from shootstab.multiprecision.enclosable import EnclosableSystem, ball
from shootstab.multiprecision.growth import log_bound
from shootstab.multiprecision.minors import MinorEntries, at_sigma, compound, solved
from shootstab.multiprecision.tailed_series import NO_TAIL, TailedSeries, variable, widened
from shootstab.multiprecision.tails import largest, perron

ENCLOSURE_STEPS = 20_000  # chosen, a budget: some minutes for one D
SHORTEST_ENCLOSURE = 2.0**-40  # chosen: a step below this part of the whole way means a singular point of the coefficients
# chosen: subintervals over which the growth of |y| is bounded; more make the bound tighter, fewer looser, none wrong
GROWTH_SUBINTERVALS = 96
OUTER, MOST_POINTS = 0.5, 96  # chosen: the largest disc about σ on which |D| is bounded, in |σ|, and the values of D that it may take
SEEN_TAIL_BITS, SEEN_PART = 16, 2.0**-12  # chosen: bits of a tail that is let pass; steps, in the way that is left, short enough for any
FEWEST_TERMS = 12  # chosen: terms of the series of a step


@dataclass(frozen=True, eq=False)
class BetweenEnds:
    """See enclosable.Enclosable: a system between two ends."""

    system: EnclosableSystem
    outer: float = OUTER
    most_points: int = MOST_POINTS
    premise: str = ""

    @property
    def lemmas(self) -> tuple[str, ...]:
        """The lemmas of steps, compound matrices and their growth, and of the system."""
        return ("E2", "E3", "E4", *self.system.lemmas)

    def enclosure(self, bits: int, *regions: Any) -> Enclosure:
        """The enclosure, which is one and the same D for every region."""
        return Enclosure(self.system, bits)


@dataclass(frozen=True, eq=False)
class Enclosure:
    """See enclosable.BoundedDiscriminant: a system between two ends, in so many bits."""

    problem: EnclosableSystem
    bits: int
    real: bool = False

    @property
    def multiple(self) -> tuple[Any, ...]:
        """The multiple of the system."""
        return self.problem.multiple

    @property
    def terms(self) -> int:
        """N: (ρh)^N/N! falls below 2^−bits for the longest step; at least FEWEST_TERMS."""
        n, reach, size = 1, self.reach, 0.0
        while size > -self.bits or n < FEWEST_TERMS:
            size += math.log2(reach / n)
            n += 1
        return n

    @property
    def reach(self) -> float:
        """ρ(|A^(k)|) h of the longest step; chosen so that the number of terms is a few times it."""
        return max(2.0, self.bits / 8)

    def __call__(self, sigma: Any) -> Any:
        """A ball that holds D(σ) for every σ in the ball given, which should be thin. To be called at the working precision."""
        return self._at_wall(sigma, self.carried(sigma, self._start(sigma)))

    def carried(self, sigma: Any, y: Any) -> Any:
        """The compound vector y (m, 1) at the second end from that at the first."""
        here, wall = self.problem.ends()
        whole = float((wall - here).mid())
        if whole == 0.0 and (wall - here).is_zero():
            return y
        length = whole
        for _ in range(ENCLOSURE_STEPS):
            y, taken, last = self._step(sigma, y, here, wall, length)
            if last:
                return y
            here = here + arb(taken)
            length = 2.0 * taken
        raise ConvergenceError(f"the enclosure of D would need more than {ENCLOSURE_STEPS} steps at sigma = {complex(sigma.mid()):.6g}")

    def growth(self, sigma: Any) -> Any:
        """An upper bound on ln |D| over the whole ball σ, by comparison along the way (theory, lemma E4)."""
        start, wall = self.problem.ends()
        n, k, length = self.problem.size, self.problem.decaying, (wall - start) / GROWTH_SUBINTERVALS
        places = (acb((start + length * i).union(start + length * (i + 1))) for i in range(GROWTH_SUBINTERVALS))
        cells = ((length, self._system(z, sigma)) for z in places)
        return log_bound(n, k, cells, self.problem.start(sigma), self.problem.wall(sigma))

    def analytic(self, sigma: Any) -> bool:
        """Whether |D| has a bound on the whole ball σ."""
        try:
            return bool(self.growth(sigma).is_finite())
        except ConvergenceError:
            return False

    def rougher(self, bits: int) -> Enclosure:
        """Itself: its values are cheap, and where it begins may depend on the precision."""
        return self

    def room(self, sigma: complex) -> float:
        """Infinite: where D is singular is not known beforehand."""
        return math.inf

    def _step(self, sigma: Any, y: Any, here: Any, wall: Any, longest: float) -> tuple[Any, float, bool]:
        """The compound vector after one step, its length and whether it ends at the wall."""
        left = wall - here
        whole = abs(float(left.mid()))
        length = min(abs(longest), self._natural(sigma, here))
        while True:
            last = length >= whole
            h = left if last else arb(math.copysign(length, float(left.mid())))
            carried = self._carried(sigma, y, here, h, whole)
            if carried is not None:
                return carried, float(h.mid()), last
            length = 0.5 * min(length, whole)
            if length < SHORTEST_ENCLOSURE * max(whole, TINY):
                raise ConvergenceError(
                    f"no step is short enough for an enclosure at z = {float(here.mid()):.6g}: the coefficients are singular"
                )

    def _unseen(self, total: Any, tail: list[Any]) -> bool:
        """Whether the tail is about as small as rounding: what coefficients with a near singular point leave out falls slowly."""
        size = largest([abs(x) for x in total.entries()])
        return bool(largest(tail) <= size * arb(2) ** (SEEN_TAIL_BITS - self.bits))

    def _natural(self, sigma: Any, here: Any) -> float:
        """A length of step from the spectral radius of |A^(k)| here, in doubles: a choice, not a bound."""
        A = compound(self.problem.size, self.problem.decaying, self._system(acb(here), sigma))
        size = math.comb(self.problem.size, self.problem.decaying)
        dense = np.zeros((size, size))
        for (i, j), entry in A.items():
            dense[i, j] = float(abs(entry).mid())
        return self.reach / max(float(np.abs(np.linalg.eigvals(dense)).max()), TINY)

    def _carried(self, sigma: Any, y: Any, here: Any, h: Any, longest: float) -> Any:
        """y at the end of the step, or None where its tail cannot be bounded, or is seen though the step is a large part of the longest."""
        N, size = self.terms, y.nrows()
        A = compound(self.problem.size, self.problem.decaying, self._system(variable(here, h, N), sigma))
        entries = {at: _series(entry, N) * acb(h) for at, entry in A.items()}
        orders = range(max(len(e.c) for e in entries.values()))
        B = [_matrix(size, {at: e.c[m] for at, e in entries.items() if m < len(e.c)}) for m in orders]
        terms, total = [y], y
        for m in range(N - 1):
            new = B[0] * terms[m]
            for j in range(1, min(m + 1, len(B))):
                new += B[j] * terms[m - j]
            terms.append(new * (acb(1) / (m + 1)))
            total = total + terms[-1]
        tail = self._tail(entries, terms)
        if tail is None or (abs(h) > arb(SEEN_PART * longest) and not self._unseen(total, tail)):
            return None
        return acb_mat(size, 1, [widened(total[i, 0], tail[i]) for i in range(size)])

    def _tail(self, entries: dict[tuple[int, int], TailedSeries], terms: list[Any]) -> list[Any] | None:
        """X of the head of this module."""
        N, size = len(terms), terms[0].nrows()
        beyond = {at: e.beyond() for at, e in entries.items()}
        if not all(sums[0].is_finite() for sums in beyond.values()):
            return None
        dense = np.zeros((size, size))
        for at, sums in beyond.items():
            dense[at] = float(sums[0].upper())
        w = perron(dense)
        rows, rest = [NO_TAIL] * size, [NO_TAIL] * size
        for (i, j), sums in beyond.items():
            rows[i] += sums[0] * arb(w[j])
            p = len(sums) - 1
            first = N - p if sums[p].is_zero() else 0  # where |B_j| vanishes from j = p on, only the last p terms of y meet it
            for k in range(max(first, 0), N):
                rest[i] += sums[min(N - 1 - k, p)] * abs(terms[k][j, 0])
        g = largest([row / arb(x) for row, x in zip(rows, w, strict=True)]) / N
        if not g < arb(0.5):
            return None
        ratio = largest([r / N / arb(x) for r, x in zip(rest, w, strict=True)]) / (1 - g)
        return [arb(x) * ratio for x in w]

    def _system(self, z: Any, sigma: Any) -> MinorEntries:
        """A = C⁻¹ D at z, a number or a series, by its non-zero entries."""
        C, D = self.problem.pencil(z)
        n = self.problem.size
        if not any(C[1:]) and dict(C[0]) == {(i, i): 1 for i in range(n)}:
            return at_sigma(D, sigma)
        return solved(n, at_sigma(C, sigma), at_sigma(D, sigma))

    def _start(self, sigma: Any) -> Any:
        found = self.problem.start(sigma)
        return acb_mat(len(found), 1, found)

    def _at_wall(self, sigma: Any, y: Any) -> Any:
        return sum((w * y[i, 0] for i, w in enumerate(self.problem.wall(sigma))), acb(0))


def at_bits(bits: int) -> Any:
    """The context in which everything is computed with so many bits."""
    return ctx.workprec(bits)


def decimal(text: str) -> Any:
    """A decimal as a ball at the working precision."""
    return ball(Fraction(text))


def _series(entry: Any, terms: int) -> TailedSeries:
    return entry if isinstance(entry, TailedSeries) else TailedSeries([acb(entry)], terms)


def _matrix(size: int, entries: dict[tuple[int, int], Any]) -> Any:
    out = acb_mat(size, size)
    for at, e in entries.items():
        out[at] = e
    return out
