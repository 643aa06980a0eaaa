"""A pencil whose entries are formulas of fields, recorded once for all problems of its shape, and reduced as a formula.

    A(σ) = C⁻¹D = X0 + σ X1 + V γ(σ)⁻¹ τ(σ),   γ = G0 + σ G1,   τ = T0 + σ T1 + σ² T2

as discriminants/sampled_system.py has it for numbers. Which entries vanish is known from the formulas, and the elimination is part of them.
"""

from __future__ import annotations

from collections.abc import Callable, Hashable
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from shootstab.core.straight_line import Program, Recorded, Recorder, program
from shootstab.problems.protocol import ComplexArray

Entries = dict[tuple[int, int], Any]
EliminationRow = dict[tuple[int, int], Any]  # the entries of a row under elimination by (side, column)
I_POWERS = np.array([1, 1j])  # exact: the powers of i by which states and equations are turned so that a system may be real


@dataclass(frozen=True)
class Selection:
    """Some states with the equations that belong to them, each with a phase 0 or 1: entries (i, j) are turned by i^(phase j − phase i)."""

    equations: tuple[int, ...]
    states: tuple[int, ...]
    turned_equations: tuple[int, ...]
    turned_states: tuple[int, ...]

    def of(self, entries: Entries) -> Entries | None:
        """The entries between them; None where other equations hold these states too."""
        rows, columns = ({j: k for k, j in enumerate(kept)} for kept in (self.equations, self.states))
        found = {}
        for (i, j), entry in entries.items():
            if j in columns and not _vanishes(entry):
                if i not in rows:
                    return None
                turn = complex(I_POWERS[self.turned_equations[rows[i]]].conj() * I_POWERS[self.turned_states[columns[j]]])
                found[rows[i], columns[j]] = turn * entry
        return found


@dataclass(frozen=True, eq=False)
class RecordedPencil:
    """What a problem offers whose pencil is a formula.

    formula(fields, parameters, shape) gives the non-zero entries of C0, C1, D0, D1 from lists of recorded numbers, the fields at a point
    and the parameters, where the shape (anything hashable) is all else that it depends on. fields(z) are theirs at points z (p,) that come
    in the order of a path: (i, p), real where z is and the problem allows it. size is the order of the system.
    """

    formula: Callable[[list[Recorded], list[Recorded], Any], tuple[Entries, Entries, Entries, Entries]]
    shape: Hashable
    size: int
    fields: Callable[[ComplexArray], NDArray[np.inexact]]
    parameters: NDArray[np.float64]
    count: int  # the number of fields
    selection: Selection | None = None

    def selected(self, selection: Selection) -> RecordedPencil:
        """The same fields of some states only."""
        return replace(self, selection=selection, size=len(selection.states))

    @property
    def reduced(self) -> ReducedPencil | None:
        """The reduced system as a program; None where it cannot be formed without values, or the selection is no part of its own."""
        return _reduced(self.formula, self.shape, self.size, self.count, len(self.parameters), self.selection)


@dataclass(frozen=True, eq=False)
class ReducedPencil:
    """X and τ by rows without what vanishes, V and γ: results of a program of the fields, of the length h of a step, and of parameters.

    start, column, linear, quadratic and carries are the lists of `kernels.reduced_system.ReducedSystem`, higher powers than σ² being
    absent; results are, in their order,
    the entries of [hX; τ] and its factors of σ and of σ², hV and γ, `counts` of them.
    """

    program: Program
    start: tuple[int, ...]
    column: tuple[int, ...]
    linear: tuple[int, ...]
    quadratic: tuple[int, ...]
    carries: tuple[int, ...]
    moving: int  # m, the rows of C that σ enters

    @property
    def counts(self) -> tuple[int, int, int]:
        entries = len(self.column) + len(self.linear) + len(self.quadratic)
        return entries, len(self.carries) * self.moving, 2 * self.moving**2


@lru_cache(maxsize=64)
def _reduced(
    formula: Callable[..., Any], shape: Hashable, n: int, fields: int, parameters: int, selection: Selection | None
) -> ReducedPencil | None:
    recorder = Recorder()
    *at_point, h = recorder.inputs(fields + 1)
    matrices = formula(at_point, recorder.parameters(parameters), shape)
    chosen = [m if selection is None else selection.of(m) for m in matrices]
    if any(m is None for m in chosen):
        return None
    one = recorder.constant(1.0)
    C0, C1, D0, D1 = ({k: one * v for k, v in m.items() if not _vanishes(v)} for m in chosen if m is not None)
    moving, columns = (sorted({place[axis] for place in C1}) for axis in (0, 1))
    m = len(moving)
    if len(columns) != m:
        return None
    solved = _solve(n, moving, columns, C0, D0, D1)
    if solved is None:
        return None
    X0, X1, V = solved
    V |= {(j, k): one for k, j in enumerate(columns)}
    rows = {i: k for k, i in enumerate(moving)}
    parts: list[Entries] = [{k: h * v for k, v in X.items()} for X in (X0, X1)] + [{}]
    G: list[Entries] = [_product(C, V, rows) for C in (C0, C1)]
    T = [
        _sum({(rows[i], j): v for (i, j), v in D0.items() if i in rows}, _product(C0, X0, rows), -1),
        _sum(_sum({(rows[i], j): v for (i, j), v in D1.items() if i in rows}, _product(C0, X1, rows), -1), _product(C1, X0, rows), -1),
        {k: -v for k, v in _product(C1, X1, rows).items()},
    ]
    for power in range(3):
        parts[power] |= {(n + i, j): v for (i, j), v in T[power].items()}
    present = {place for part in parts for place, v in part.items() if not _vanishes(v)}
    # the rows of τ have the same columns: γ⁻¹ mixes them
    places = sorted(present | {(i, j) for i in range(n, n + m) for row, j in present if row >= n})
    linear, quadratic = ([e for e, k in enumerate(places) if not _vanishes(parts[power].get(k, 0))] for power in (1, 2))
    carries = sorted({i for (i, _), v in V.items() if not _vanishes(v)})
    results = [parts[0].get(k, 0) for k in places]
    results += [parts[1][places[e]] for e in linear] + [parts[2][places[e]] for e in quadratic]
    results += [h * V.get((i, k), 0) for i in carries for k in range(m)]
    results += [g.get((i, k), 0) for g in G for i in range(m) for k in range(m)]
    start = np.searchsorted([i for i, _ in places], range(n + m + 1))
    lists = (tuple(int(i) for i in start), tuple(j for _, j in places), tuple(linear), tuple(quadratic), tuple(carries))
    return ReducedPencil(program(recorder, results), *lists, m)


def _solve(n: int, moving: list[int], columns: list[int], C: Entries, D0: Entries, D1: Entries) -> tuple[Entries, Entries, Entries] | None:
    """X0, X1, V with C [X0, X1, V] = [D0, D1, 0] in the rows that σ does not enter; X vanishes on the columns, where V is the identity.

    Constants are pivots first, then what leaves the rest sparse.
    """
    rows = [i for i in range(n) if i not in moving]
    left: dict[int, EliminationRow] = {i: {(0, j): C[i, j] for j in range(n) if (i, j) in C and j not in columns} for i in rows}
    right: dict[int, EliminationRow] = {i: {} for i in rows}
    for which, D in enumerate((D0, D1)):
        for (i, j), v in D.items():
            if i in right:
                right[i][which, j] = v
    for i in rows:
        right[i] |= {(2, k): -C[i, j] for k, j in enumerate(columns) if (i, j) in C}
    pivots: dict[int, int] = {}
    while len(pivots) < len(rows):
        open_rows = [i for i in rows if i not in pivots]
        candidates = [(i, j) for i in open_rows for _, j in left[i]]
        if not candidates:
            return None
        uses = {j: sum((0, j) in left[i] for i in open_rows) for _, j in candidates}
        filled = {(i, j): (not left[i][0, j].known, (len(left[i]) - 1) * (uses[j] - 1), i, j) for i, j in candidates}
        i, j = min(candidates, key=filled.__getitem__)
        pivot = left[i][0, j]
        left[i] = {k: v / pivot for k, v in left[i].items()}
        right[i] = {k: v / pivot for k, v in right[i].items()}
        pivots[i] = j
        for other in rows:
            factor = left[other].get((0, j))
            if other != i and factor is not None:
                left[other] = {k: v for k, v in _sum(left[other], left[i], -factor).items() if k != (0, j) and not _vanishes(v)}
                right[other] = _sum(right[other], right[i], -factor)
    X0, X1, V = ({(pivots[i], k): v for i in rows for (kind, k), v in right[i].items() if kind == which} for which in range(3))
    return X0, X1, V


def _product(A: Entries, B: Entries, rows: dict[int, int]) -> Entries:
    """Rows of AB, renumbered."""
    out: Entries = {}
    for (i, j), a in A.items():
        if i in rows:
            out = _sum(out, {(rows[i], k): a * b for (r, k), b in B.items() if r == j}, 1)
    return out


def _sum(A: Entries, B: Entries, factor: Any) -> Entries:
    """A + factor·B by entries."""
    out = dict(A)
    for k, b in B.items():
        out[k] = out[k] + factor * b if k in out else factor * b
    return out


def _vanishes(entry: Any) -> bool:
    return bool((entry.coefficient if isinstance(entry, Recorded) else entry) == 0)
