"""A pencil whose entries are formulas of fields, recorded once for all problems of its shape, and reduced as a formula.

    A(σ) = C⁻¹D = X(σ) + V γ(σ)⁻¹ τ(σ),   X, γ and τ polynomials in σ: of degrees q, q and 2q for C and D of degree q,

as discriminants/sampled_system.py has it for numbers. Which entries vanish is known from the formulas, and the elimination is part of them.
"""

from __future__ import annotations

from collections.abc import Callable, Hashable
from dataclasses import dataclass, replace
from functools import lru_cache
from itertools import product
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

    formula(fields, parameters, shape) gives the non-zero entries of C0, C1, …, D0, D1, … from lists of recorded numbers, the fields at a
    point and the parameters, where the shape (anything hashable) is all else that it depends on. fields(z) are theirs at points z (p,) that
    come in the order of a path: (i, p), real where z is and the problem allows it. size is the order of the system. constant_pivots: the
    elimination divides by numbers that are known and by nothing that may vanish somewhere.
    """

    formula: Callable[[list[Recorded], list[Recorded], Any], tuple[Entries, ...]]
    shape: Hashable
    size: int
    fields: Callable[[ComplexArray], NDArray[np.inexact]]
    parameters: NDArray[np.float64]
    count: int  # the number of fields
    selection: Selection | None = None
    constant_pivots: bool = False

    def selected(self, selection: Selection) -> RecordedPencil:
        """The same fields of some states only."""
        return replace(self, selection=selection, size=len(selection.states))

    def perturbed(self, seed: int, amount: float) -> RecordedPencil:
        """The same with every entry that is no known number changed by random relative amounts up to this one, anew at every point."""
        entries = _unknown_entries(self.formula, self.shape, self.count, len(self.parameters))

        def fields(z: ComplexArray) -> NDArray[np.inexact]:
            noise = np.random.default_rng(seed).uniform(-1.0, 1.0, (entries, len(z)))
            return np.concatenate((self.fields(z), 1.0 + amount * noise))

        return replace(self, formula=_with_factors, shape=(self.formula, self.shape, self.count), fields=fields, count=self.count + entries)

    @property
    def reduced(self) -> ReducedPencil | None:
        """The reduced system as a program; None where it cannot be formed without values, or the selection is no part of its own."""
        return _reduced(self.formula, self.shape, self.size, self.count, len(self.parameters), self.selection, self.constant_pivots)


@dataclass(frozen=True, eq=False)
class ReducedPencil:
    """X and τ by rows without what vanishes, V and γ: results of a program of the fields, of the length h of a step, and of parameters.

    start, column, linear, higher, powers and carries are the lists of `kernels.reduced_system.ReducedSystem`; results are, in their order,
    the entries of [hX; τ] and its factors of σ and of higher powers, hV and the coefficients of γ, `counts` of them.
    """

    program: Program
    start: tuple[int, ...]
    column: tuple[int, ...]
    linear: tuple[int, ...]
    higher: tuple[int, ...]
    powers: tuple[int, ...]
    carries: tuple[int, ...]
    moving: int  # m, the rows of C that σ enters
    of_gamma: int  # the coefficients of γ, two at least

    @property
    def counts(self) -> tuple[int, int, int]:
        entries = len(self.column) + len(self.linear) + len(self.higher)
        return entries, len(self.carries) * self.moving, self.of_gamma * self.moving**2


@lru_cache(maxsize=64)
def _unknown_entries(formula: Callable[..., Any], shape: Hashable, fields: int, parameters: int) -> int:
    """How many entries are no known numbers."""
    recorder = Recorder()
    matrices = formula(recorder.inputs(fields), recorder.parameters(parameters), shape)
    return sum(isinstance(v, Recorded) and not v.known for m in matrices for v in m.values())


def _with_factors(fields: list[Recorded], parameters: list[Recorded], shape: Any) -> tuple[Entries, ...]:
    """The entries of a formula, those that are no known numbers multiplied by a further field each."""
    formula, inner, count = shape
    factors = iter(fields[count:])
    matrices = formula(fields[:count], parameters, inner)
    return tuple({k: v * next(factors) if isinstance(v, Recorded) and not v.known else v for k, v in m.items()} for m in matrices)


@lru_cache(maxsize=64)
def _reduced(
    formula: Callable[..., Any],
    shape: Hashable,
    n: int,
    fields: int,
    parameters: int,
    selection: Selection | None,
    constant_pivots: bool,
) -> ReducedPencil | None:
    recorder = Recorder()
    *at_point, h = recorder.inputs(fields + 1)
    matrices = formula(at_point, recorder.parameters(parameters), shape)
    own = [m if selection is None else selection.of(m) for m in matrices]
    if any(m is None for m in own):
        return None
    one = recorder.constant(1.0)
    present = [{k: one * v for k, v in m.items() if not _vanishes(v)} for m in own if m is not None]
    C, D = present[: len(present) // 2], present[len(present) // 2 :]
    moving, columns = (sorted({place[axis] for part in C[1:] for place in part}) for axis in (0, 1))
    m = len(moving)
    # C1 X, C2 X, … vanish with the columns that σ enters; where these do not serve, the derivatives that the moving rows are for do
    columns += [i for i in moving if i not in columns][: max(0, m - len(columns))]
    choices = [columns] * (len(columns) == m) + [moving] * constant_pivots
    solutions = ((chosen, _solve(n, moving, chosen, C[0], D, constant_pivots)) for chosen in choices)
    columns, solved = next(((chosen, found) for chosen, found in solutions if found is not None), (columns, None))
    if solved is None:
        return None
    *X, V = solved
    V |= {(j, k): one for k, j in enumerate(columns)}
    rows = {i: k for k, i in enumerate(moving)}
    G = [_product(part, V, rows) for part in C]
    T: list[Entries] = [{(rows[i], j): v for (i, j), v in part.items() if i in rows} for part in D] + [{} for _ in D[1:]]
    for (i, left), (j, right) in product(enumerate(C), enumerate(X)):
        T[i + j] = _sum(T[i + j], _product(left, right, rows), -1)
    parts: list[Entries] = [{k: h * v for k, v in x.items()} for x in X] + [{} for _ in D[1:]]
    for power, tau in enumerate(T):
        parts[power] |= {(n + i, j): v for (i, j), v in tau.items()}
    used = {place for part in parts for place, v in part.items() if not _vanishes(v)}
    # the rows of τ have the same columns: γ⁻¹ mixes them
    places = sorted(used | {(i, j) for i in range(n, n + m) for row, j in used if row >= n})
    factors = [[e for e, k in enumerate(places) if not _vanishes(part.get(k, 0))] for part in parts]
    linear, higher = factors[1], [(power, e) for power, entries in enumerate(factors) if power > 1 for e in entries]
    carries = sorted({i for (i, _), v in V.items() if not _vanishes(v)})
    results = [parts[0].get(k, 0) for k in places]
    results += [parts[1][places[e]] for e in linear] + [parts[power][places[e]] for power, e in higher]
    results += [h * V.get((i, k), 0) for i in carries for k in range(m)]
    results += [g.get((i, k), 0) for g in G for i in range(m) for k in range(m)]
    start = np.searchsorted([i for i, _ in places], range(n + m + 1))
    lists = (tuple(int(i) for i in start), tuple(j for _, j in places), tuple(linear))
    powers = tuple(e for _, e in higher), tuple(power for power, _ in higher)
    return ReducedPencil(program(recorder, results), *lists, *powers, tuple(carries), m, len(G))


def _solve(n: int, moving: list[int], columns: list[int], C: Entries, D: list[Entries], constant_pivots: bool) -> list[Entries] | None:
    """X0, X1, …, V with C [X0, X1, …, V] = [D0, D1, …, 0] in the rows that σ does not enter.

    X vanishes on the columns, where V is the identity. Constants are pivots first, then, if not constants alone are, what leaves the rest
    sparse.
    """
    rows = [i for i in range(n) if i not in moving]
    left: dict[int, EliminationRow] = {i: {(0, j): C[i, j] for j in range(n) if (i, j) in C and j not in columns} for i in rows}
    right: dict[int, EliminationRow] = {i: {} for i in rows}
    for which, part in enumerate(D):
        for (i, j), v in part.items():
            if i in right:
                right[i][which, j] = v
    for i in rows:
        right[i] |= {(len(D), k): -C[i, j] for k, j in enumerate(columns) if (i, j) in C}
    pivots: dict[int, int] = {}
    while len(pivots) < len(rows):
        open_rows = [i for i in rows if i not in pivots]
        candidates = [(i, j) for i in open_rows for _, j in left[i] if left[i][0, j].known or not constant_pivots]
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
    return [{(pivots[i], k): v for i in rows for (kind, k), v in right[i].items() if kind == which} for which in range(len(D) + 1)]


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
