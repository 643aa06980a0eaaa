"""What the terms of a linear system's solution leave out: bounds for C dY/dt = D Y and for its regular singular end.

N terms are balls that hold the exact ones. With A = C⁻¹D, F = C_0⁻¹C, |·| entrywise, ‖·‖ = Σ_j |·_j| and ‖·‖₊ the same without
j = 0, X_i is Σ_{m≥N} max_q |·_{m,iq}|, and obeys X ≤ G X + R (theory, lemma E11): that of A with

    G = ‖F‖₊,   R = Σ_{m≥N} |C_0⁻¹| |D_m| 1 + Σ_{k<N} Σ_{j≥N−k} |F_j| max_q |A_k|_q,

that of Y with

    G = ‖A‖/N,   R = (1/N) Σ_{k<N} Σ_{j≥N−1−k} |A_j| |Y_k|,

and at a regular singular end, C t dψ/dt = D ψ, ψ = P(t) t^Λ, Λ = ρ + Nil, ρ > 0, ν the largest column sum of |Nil|, that of P with

    G = (‖A‖ + ν)/(N + ρ),   R = Σ_{k<N} Σ_{j≥N−k} |A_j| |P_k|/(N + ρ).

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
SizedEntries = Mapping[tuple[int, int], Sequence[Any]]  # |A_m| for m = 0, 1, …
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
class QuotientBounds:
    """What bounds the tail of A = C⁻¹D at one σ: left = |C_0⁻¹| (n, n), Σ_{j≥m} |C_j| and |D_j|, and G = ‖F‖₊ (n, n)."""

    left: Matrix
    C: Sums
    D: Sums
    G: Matrix

    @staticmethod
    def of(inverse: Matrix, C: Beyond, D: Beyond, size: Any) -> QuotientBounds:
        """Bounds from inverse = C_0⁻¹ (n, n) and the series at |σ| ≤ size."""
        with ctx.workprec(BOUND_BITS):
            left, c, d = _absolute(inverse), C.at_sigma(size), D.at_sigma(size)
            G = _nothing(len(inverse))
            for (i, j), sums in c.items():
                G[i][j] += _nth(sums, 1)
            return QuotientBounds(left, c, d, _times(left, G))

    def tail(self, A: SizedEntries, terms: int) -> list[Any] | None:
        """X (n,), from the moduli of so many terms of A; None where it is not bounded."""
        with ctx.workprec(BOUND_BITS):
            rows: dict[int, list[Sequence[Any]]] = {}
            for (i, _), sizes in A.items():
                rows.setdefault(i, []).append(sizes)
            s = {i: [largest([x[k] for x in row if k < len(x)] or [NO_TAIL]) for k in range(terms)] for i, row in rows.items()}
            R = [NO_TAIL] * len(self.left)
            for (i, _), sums in self.D.items():
                R[i] += _nth(sums, terms)
            for (i, j), sums in self.C.items():
                R[i] += _met(sums, s.get(j, ()), terms)
            return dominated(self.G, _applied(self.left, R))


@dataclass(frozen=True, eq=False)
class SolutionBounds:
    """What bounds the tail of the solutions: Σ_{j≥m} |A_j|, G (n, n), the N + ρ by which R is divided, and N − 1 or N of its sums."""

    A: Sums
    G: Matrix
    over: Any
    first: int

    @staticmethod
    def of_step(size: int, A: SizedEntries, tail: Sequence[Any], terms: int) -> SolutionBounds:
        """Bounds on a step from the moduli of the terms of A (size, size), and X of A."""
        with ctx.workprec(BOUND_BITS):
            sums = _beyond(size, A, tail)
            return SolutionBounds(sums, _over(size, sums, NO_TAIL, arb(terms)), arb(terms), terms - 1)

    @staticmethod
    def of_singular_end(size: int, A: SizedEntries, tail: Sequence[Any], terms: int, rate: Any, nilpotent: Matrix) -> SolutionBounds:
        """Bounds at a singular end of rate ρ and nilpotent (k, k)."""
        with ctx.workprec(BOUND_BITS):
            sums, over = _beyond(size, A, tail), arb(terms) + rate
            nil = largest([sum((abs(x).upper() for x in column), NO_TAIL) for column in zip(*nilpotent, strict=True)])
            return SolutionBounds(sums, _over(size, sums, nil, over), over, terms)

    def tail(self, terms: Sequence[Matrix]) -> list[Any] | None:
        """X (n,), from the terms Y_k or P_k; None where it is not bounded."""
        with ctx.workprec(BOUND_BITS):
            s = list(zip(*([largest([abs(x) for x in row]) for row in term] for term in terms), strict=True))
            R = [NO_TAIL] * len(self.G)
            for (i, j), sums in self.A.items():
                R[i] += _met(sums, s[j], self.first)
            return dominated(self.G, [x / self.over for x in R])


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
    return radius_of_doubles(_upper(G))


def radius_of_doubles(dense: np.ndarray[Any, Any]) -> float:
    """The same of a matrix (n, n) of doubles."""
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


def _beyond(size: int, A: SizedEntries, tail: Sequence[Any]) -> Sums:
    """Σ_{j≥m} |A_j| of every entry, the entries without terms too."""
    out = {}
    for i in range(size):
        for j in range(size):
            sums = [tail[i]]
            for x in reversed(A.get((i, j), ())):
                sums.append(sums[-1] + x)
            out[i, j] = sums[::-1]
    return out


def _over(size: int, sums: Sums, nilpotent: Any, over: Any) -> Matrix:
    return [[(sums[i, j][0] + (nilpotent if i == j else NO_TAIL)) / over for j in range(size)] for i in range(size)]


def _met(sums: Sequence[Any], s: Sequence[Any], first: int) -> Any:
    """Σ_k s_k Σ_{j≥first−k}."""
    last = len(sums) - 1  # sums from there on are the same
    few = max(0, first - last + 1)
    return sums[last] * sum(s[:few], NO_TAIL) + sum((sums[first - k] * s[k] for k in range(few, len(s))), NO_TAIL)


def largest(numbers: Sequence[Any]) -> Any:
    """The largest of real balls, an upper bound."""
    found = numbers[0]
    for x in numbers[1:]:
        found = found.max(x)
    return found.upper()
