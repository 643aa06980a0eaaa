"""D(σ) enclosed on given steps: the decaying space as a graph over k of its rows, carried by the difference of a Möbius map.

On a step Y(1) = Φ Y(0), Φ (n, n) a ball for the terms and another for what they leave out (tails.py). The space is the range of Y = (I; G),
I in k rows and G (n − k, k) a ball about Ḡ. With M = Φ Y, M̄ = Φ (I; Ḡ), J the k rows of it that are best independent, F̄ = M̄_c M̄_J⁻¹
and Φ₂ the columns of Φ that belong to G,

    M_c M_J⁻¹ = F̄ + (Φ₂_c − F̄ Φ₂_J) (G − Ḡ) M_J⁻¹

exactly: what is uncertain in G is carried by the derivative of the map, which contracts. D = det[W(σ) Y] times the determinants of all M_J.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from shootstab.core.balls import acb, acb_mat, arb, ctx
from shootstab.core.errors import ConvergenceError
from shootstab.multiprecision import small_matrices as matrices
from shootstab.multiprecision.arithmetic import Matrix
from shootstab.multiprecision.enclosable import row_minors
from shootstab.multiprecision.growth import log_bound
from shootstab.multiprecision.minors import minors
from shootstab.multiprecision.tailed_pencil import BALLS, TailedPencil

PART_OF_TERMS = 0.7  # chosen: the least part of the terms of a step, with which the tail is bounded
CELLS_OF_STEP = 4  # chosen: cells over which growth is bounded; more make the bound tighter, fewer looser, none wrong


class EnclosedPath(Protocol):
    """A problem from a decaying end to its wall, in steps, at one working precision."""

    @property
    def size(self) -> int:
        """n."""
        ...

    @property
    def decaying(self) -> int:
        """k."""
        ...

    @property
    def multiple(self) -> tuple[Any, ...]:
        """See enclosable.BoundedDiscriminant."""
        ...

    @property
    def steps(self) -> Sequence[TailedPencil]:
        """One after the other."""
        ...

    def far(self, sigma: Any) -> Matrix:
        """A basis (n, k) of the decaying space where the steps begin, analytic in σ, as balls."""
        ...

    def wall(self, sigma: Any) -> Matrix:
        """The rows W(σ) (k, n)."""
        ...

    @property
    def singular(self) -> Sequence[Any]:
        """Balls at which D may not be analytic, as far as they are known beforehand."""
        ...

    def analytic(self, sigma: Any) -> bool:
        """Whether D is seen to be analytic on the whole ball σ."""
        ...


@dataclass(frozen=True, eq=False)
class _ShortenedPath:
    """See EnclosedPath: another one whose steps have a part of their terms, no less than PART_OF_TERMS of them.

    Its ends are those of the other one, at the bits of that: where a path begins may depend on the precision.
    """

    path: EnclosedPath
    part: float
    bits: int

    @property
    def size(self) -> int:
        return self.path.size

    @property
    def decaying(self) -> int:
        return self.path.decaying

    @property
    def multiple(self) -> tuple[Any, ...]:
        with ctx.workprec(self.bits):
            return self.path.multiple

    @cached_property
    def steps(self) -> Sequence[TailedPencil]:
        """The steps by fewer terms."""
        return [step.shortened(math.ceil(max(self.part, PART_OF_TERMS) * step.terms)) for step in self.path.steps]

    def far(self, sigma: Any) -> Matrix:
        with ctx.workprec(self.bits):
            return self.path.far(sigma)

    def wall(self, sigma: Any) -> Matrix:
        with ctx.workprec(self.bits):
            return self.path.wall(sigma)

    @property
    def singular(self) -> Sequence[Any]:
        with ctx.workprec(self.bits):
            return self.path.singular

    def analytic(self, sigma: Any) -> bool:
        with ctx.workprec(self.bits):
            return self.path.analytic(sigma)


@dataclass(frozen=True, eq=False)
class FrameEnclosure:
    """See multiprecision.enclosable.BoundedDiscriminant: D of a path."""

    path: EnclosedPath
    real: bool
    _values: dict[Any, Any] = field(default_factory=dict, repr=False)  # values by σ: searches and circles ask for some twice

    @property
    def multiple(self) -> tuple[Any, ...]:
        """The multiple of the path."""
        return self.path.multiple

    def __call__(self, sigma: Any) -> Any:
        key = tuple(tuple(part.man_exp()) for x in (sigma.real, sigma.imag) for part in (x.mid(), x.rad()))
        if key not in self._values:
            self._values[key] = self._enclosed(sigma)
        return self._values[key]

    def _enclosed(self, sigma: Any) -> Any:
        path = self.path
        rows, graph, det = _normalized(_matrix(path.far(sigma)))
        for step in path.steps:
            found = step.carried(sigma, *_begun(path.size, rows, graph.mid()))
            if found is None:
                raise ConvergenceError(f"a step is too long for an enclosure at sigma = {complex(acb(sigma).mid()):.6g}")
            known, second = map(_matrix, found)
            rows, graph, factor = _moved(known, second, graph)
            det = det * factor
        W = _matrix(path.wall(sigma))
        return det * (_columns(W, rows) + _columns(W, _others(path.size, rows)) * graph).det()

    def rougher(self, bits: int) -> FrameEnclosure:
        """The same D by fewer terms, for so many bits; to be asked for at the working precision of this one."""
        return FrameEnclosure(_ShortenedPath(self.path, bits / ctx.prec, ctx.prec), self.real)

    def analytic(self, sigma: Any) -> bool:
        """Whether D is seen to be analytic on the whole ball σ."""
        return self.path.analytic(sigma)

    @cached_property
    def _places(self) -> tuple[NDArray[np.complex128], NDArray[np.float64]]:
        """The middles and radii of what is singular, in doubles."""
        places = self.path.singular
        return np.array([complex(x.mid()) for x in places]), np.array([float(abs(x - x.mid()).upper()) for x in places])

    def room(self, sigma: complex) -> float:
        """The distance of σ to what is singular, infinite where nothing is."""
        middles, radii = self._places
        return max(0.0, float((np.abs(middles - sigma) - radii).min(initial=math.inf)))

    def growth(self, sigma: Any) -> Any:
        """An upper bound of ln |D| for all σ in a ball, by lemma E4."""
        path = self.path
        n, k, length = path.size, path.decaying, arb(1) / CELLS_OF_STEP
        start, end = minors(path.far(sigma), k), row_minors(path.wall(sigma))
        cells = (
            (length, step.on_cell(sigma, arb(i) / CELLS_OF_STEP, arb(i + 1) / CELLS_OF_STEP))
            for step in path.steps
            for i in range(CELLS_OF_STEP)
        )
        return log_bound(n, k, cells, start, end)


def _normalized(Y: Any) -> tuple[list[int], Any, Any]:
    rows = matrices.pivots(BALLS, Y.mid().tolist())
    top = _rows(Y, rows)
    return rows, _solved(_rows(Y, _others(Y.nrows(), rows)), top), top.det()


def _begun(n: int, rows: Sequence[int], middle: Any) -> tuple[Matrix, Matrix]:
    """(I; Ḡ) (n, k) and (0; I) (n, n − k), with I or 0 in these rows; numbers are real where all are."""
    table, others = middle.tolist(), _others(n, rows)
    if all(x.imag.is_zero() for row in table for x in row):
        table = [[x.real for x in row] for row in table]
    one, nothing = BALLS.number(1), BALLS.number(0)
    first = {row: [one if q == p else nothing for q in range(len(rows))] for p, row in enumerate(rows)}
    first |= dict(zip(others, table, strict=True))
    second = [[one if i == row else nothing for row in others] for i in range(n)]
    return [first[i] for i in range(n)], second


def _moved(known: Any, second: Any, graph: Any) -> tuple[list[int], Any, Any]:
    """The rows, G and the factor of D after a step, from M̄ = Φ (I; Ḡ) and Φ₂."""
    n = known.nrows()
    chosen = matrices.pivots(BALLS, known.mid().tolist())
    others, off = _others(n, chosen), graph - graph.mid()
    moved = _rows(known, chosen)
    F = _solved(_rows(known, others), moved)
    whole = moved + _rows(second, chosen) * off
    spread = _solved((_rows(second, others) - F * _rows(second, chosen)) * off, whole)
    return chosen, F + spread, whole.det()


def _solved(B: Any, A: Any) -> Any:
    """B A⁻¹."""
    try:
        return B * A.inv()
    except ZeroDivisionError:
        raise ConvergenceError("the enclosures are too wide to tell the decaying solutions apart: take more bits") from None


def _matrix(A: Matrix) -> Any:
    return acb_mat([[acb(x) for x in row] for row in A])


def _others(n: int, rows: Sequence[int]) -> list[int]:
    return [i for i in range(n) if i not in rows]


def _rows(A: Any, rows: Sequence[int]) -> Any:
    table = A.tolist()
    return acb_mat([table[i] for i in rows])


def _columns(A: Any, columns: Sequence[int]) -> Any:
    return acb_mat([[row[j] for j in columns] for row in A.tolist()])
