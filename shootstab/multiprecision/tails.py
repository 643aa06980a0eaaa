"""What the terms of a linear system's solution leave out: bounds for C dY/dt = D Y and for its regular singular end.

N terms Y_k are balls that hold the exact ones. With D′ = C_0⁻¹ D and F = C_0⁻¹ C, |·| entrywise, ‖·‖ = Σ_j |·_j| and ‖·‖₊ the same
without j = 0, X_i = Σ_{m≥N} |Y_{m,i}| of any column obeys X ≤ G X + R (theory, lemma E11) with

    G = ‖D′‖/N + ‖F‖₊,   R = (1/N) Σ_{k<N} Σ_{j≥N−1−k} |D′_j||Y_k| + Σ_{k<N} (k/N) Σ_{j≥N−k} |F_j||Y_k|,

and at a regular singular end, C t dψ/dt = D ψ, ψ = P(t) t^Λ, Λ = ρ + Nil, ρ > 0, with A_0 = C_0⁻¹D_0 and ν the largest column sum
of |Nil|

    G = (|A_0| + ν + ‖D′‖₊)/(N + ρ) + (1 + ν/(N + ρ)) ‖F‖₊,
    R = Σ_{k<N} (Σ_{j≥N−k} |D′_j| + (k + ρ + ν) Σ_{j≥N−k} |F_j|) |P_k|/(N + ρ).

If G w + R ≤ w for some w and R > 0, then X ≤ w.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from shootstab.core.balls import arb, ctx
from shootstab.core.scaled import TINY
from shootstab.multiprecision.arithmetic import Matrix
from shootstab.multiprecision.tailed_series import NO_TAIL, TailedSeries

Sums = Mapping[tuple[int, int], Sequence[Any]]  # sums Σ_{j≥m} of an entry for m = 0, 1, …
TailedEntries = Mapping[tuple[int, int], TailedSeries]
BOUND_BITS = 64  # chosen: bits of bounds, whose radii are always added
SLACK = 2.0**-20  # chosen: part of the largest R that is added to all, and of w: above the rounding of doubles, without weight in a bound
ABOVE_RADIUS, OF_LARGEST_ENTRY = 1.05, 1e-3  # chosen: the scale, over the spectral radius and at least in the largest entry


class Beyond:
    """Σ_{j≥m} |A_j| entrywise, m = 0 … N, of A(σ) = Σ σ^k A^(k), bounded by Σ |σ|^k Σ_{j≥m} |A_j^(k)|."""

    def __init__(self, parts: Sequence[TailedEntries]) -> None:
        self._parts = [{at: y.beyond() for at, y in part.items()} for part in parts]

    def at_sigma(self, size: Any) -> dict[tuple[int, int], list[Any]]:
        """An upper bound for |σ| = size; where sums end early the last one holds for all later m."""
        out: dict[tuple[int, int], list[Any]] = {}
        for k, part in enumerate(self._parts):
            factor = size**k
            for at, sums in part.items():
                mine = [factor * x for x in sums] if k else sums
                if at in out:
                    other = out[at]
                    p = max(len(mine), len(other))
                    mine = [_nth(mine, m) + _nth(other, m) for m in range(p)]
                out[at] = mine
        return out


@dataclass(frozen=True, eq=False)
class StepBounds:
    """What bounds the tail of a step at one σ: left = |C_0⁻¹| (n, n), Σ_{j≥m} |C_j| and |D_j|, and G (n, n)."""

    left: Matrix
    C: Sums
    D: Sums
    G: Matrix

    @staticmethod
    def of(inverse: Matrix, C: Beyond, D: Beyond, size: Any, terms: int) -> StepBounds:
        """Bounds from inverse = C_0⁻¹ (n, n) and the series at |σ| ≤ size, with so many terms."""
        n = len(inverse)
        with ctx.workprec(BOUND_BITS):
            left, c, d = _absolute(inverse), C.at_sigma(size), D.at_sigma(size)
            G = _nothing(n)
            for (i, j), sums in d.items():
                G[i][j] += sums[0] / terms
            for (i, j), sums in c.items():
                G[i][j] += _nth(sums, 1)
            return StepBounds(left, c, d, _times(left, G))

    def tail(self, terms: Sequence[Matrix]) -> list[Any] | None:
        """X (n,), from the terms Y_k; None where it is not bounded."""
        N = len(terms)
        with ctx.workprec(BOUND_BITS):
            s, R = _largest_of_rows(terms), [NO_TAIL] * len(self.left)
            for (i, j), sums in self.D.items():
                R[i] += sum((_nth(sums, N - 1 - k) * s[k][j] for k in range(N)), NO_TAIL) / N
            for (i, j), sums in self.C.items():
                R[i] += sum((_nth(sums, N - k) * s[k][j] * k for k in range(N)), NO_TAIL) / N
            return dominated(self.G, _applied(self.left, R))


@dataclass(frozen=True, eq=False)
class SingularBounds:
    """What bounds it at a regular singular end, left and G (n, n) as on a step; rate is ρ, nilpotent the largest column sum of |Nil|."""

    left: Matrix
    C: Sums
    D: Sums
    G: Matrix
    rate: Any
    nilpotent: Any

    @staticmethod
    def of(inverse: Matrix, A0: Matrix, C: Beyond, D: Beyond, size: Any, terms: int, rate: Any, nilpotent: Matrix) -> SingularBounds:
        """Bounds from inverse = C_0⁻¹ (n, n), A0 = C_0⁻¹ D_0 (n, n), nilpotent (k, k) and the series at |σ| ≤ size, with so many terms."""
        n = len(inverse)
        with ctx.workprec(BOUND_BITS):
            left, c, d = _absolute(inverse), C.at_sigma(size), D.at_sigma(size)
            nil = largest([sum((abs(x).upper() for x in column), NO_TAIL) for column in zip(*nilpotent, strict=True)])
            first = arb(terms) + rate
            G = _nothing(n)
            for (i, j), sums in d.items():
                G[i][j] += _nth(sums, 1) / first
            for (i, j), sums in c.items():
                G[i][j] += _nth(sums, 1) * (1 + nil / first)
            total = _times(left, G)
            for i, row in enumerate(_absolute(A0)):
                for j, x in enumerate(row):
                    total[i][j] += (x + (nil if i == j else 0)) / first
            return SingularBounds(left, c, d, total, rate, nil)

    def tail(self, terms: Sequence[Matrix]) -> list[Any] | None:
        """X (n,), from the terms P_k; None where it is not bounded."""
        N = len(terms)
        with ctx.workprec(BOUND_BITS):
            s, R, first = _largest_of_rows(terms), [NO_TAIL] * len(self.left), arb(N) + self.rate
            for (i, j), sums in self.D.items():
                R[i] += sum((_nth(sums, N - k) * s[k][j] for k in range(N)), NO_TAIL) / first
            for (i, j), sums in self.C.items():
                R[i] += sum((_nth(sums, N - k) * s[k][j] * (k + self.rate + self.nilpotent) for k in range(N)), NO_TAIL) / first
            return dominated(self.G, _applied(self.left, R))


def dominated(G: Matrix, R: Sequence[Any]) -> list[Any] | None:
    """An upper bound (n,) of every X ≥ 0 with X ≤ G X + R, G (n, n); None where none is seen.

    w ≈ (1 − G)⁻¹ R comes from doubles, in units of the largest of R and with a little added to R, and G w + R ≤ w is checked.
    """
    dense, top = _upper(G), largest(R)
    if not np.isfinite(dense).all() or not top.is_finite():
        return None
    rest = [(arb(0) if top.is_zero() else (r / top).upper()) + arb(SLACK) for r in R]
    with np.errstate(all="ignore"):
        w = (1 + SLACK) * np.linalg.solve(np.eye(len(R)) - dense, [float(r) for r in rest])
    if not (np.isfinite(w).all() and (w > 0).all()):
        return None
    bounds = [arb(x) for x in w.tolist()]
    for row, r, x in zip(G, rest, bounds, strict=True):
        if not sum((g * y for g, y in zip(row, bounds, strict=True)), r) <= x:
            return None
    return [(x * top).upper() for x in bounds]


def spectral_radius(G: Matrix) -> float:
    """The spectral radius of G (n, n) ≥ 0 in doubles, infinite where G is: how fast tails contract, a choice between steps and no bound."""
    dense = _upper(G)
    return float(np.abs(np.linalg.eigvals(dense)).max()) if np.isfinite(dense).all() else math.inf


def perron(dense: np.ndarray[Any, Any]) -> list[float]:
    """w > 0 with A w ≤ r w, about, for A = dense (n, n) ≥ 0 and r = ABOVE_RADIUS times its spectral radius: Σ_k (A/r)^k 1, a choice.

    Of a matrix that is not finite ones, since what it weighs is not finite either.
    """
    size = len(dense)
    if not np.isfinite(dense).all():
        return [1.0] * size
    scale = max(ABOVE_RADIUS * float(np.abs(np.linalg.eigvals(dense)).max()), OF_LARGEST_ENTRY * float(dense.max(initial=0.0)), TINY)
    w = np.linalg.solve(np.eye(size) - dense / scale, np.ones(size))
    return [max(float(x), 1.0) for x in w]


def _upper(G: Matrix) -> np.ndarray[Any, Any]:
    return np.array([[float(x.upper()) for x in row] for row in G])


def _nth(sums: Sequence[Any], m: int) -> Any:
    return sums[min(m, len(sums) - 1)]


def _absolute(A: Matrix) -> Matrix:
    return [[abs(x).upper() for x in row] for row in A]


def _times(A: Matrix, B: Matrix) -> Matrix:
    columns = list(zip(*B, strict=True))
    return [[sum((a * b for a, b in zip(row, column, strict=True)), NO_TAIL) for column in columns] for row in A]


def _applied(A: Matrix, x: Sequence[Any]) -> list[Any]:
    return [row[0] for row in _times(A, [[value] for value in x])]


def _nothing(n: int) -> Matrix:
    return [[NO_TAIL] * n for _ in range(n)]


def _largest_of_rows(terms: Sequence[Matrix]) -> list[list[Any]]:
    """max_q |Y_{k,iq}| for every k and i."""
    return [[largest([abs(x) for x in row]) for row in term] for term in terms]


def largest(numbers: Sequence[Any]) -> Any:
    """The largest of real balls, an upper bound."""
    found = numbers[0]
    for x in numbers[1:]:
        found = found.max(x)
    return found.upper()
