"""The first-order system with its conditions, made affine in σ: what the engine takes.

Where σ occurs to a power q above 1, the states J that it multiplies so are carried again: ξ^(1) = σ ψ_J, …, ξ^(q−1) = σ ξ^(q−2), so that
σ^m ψ_J = σ ξ^(m−1). Each copy follows from

    ξ′ − σ ψ_J′ = κ (ξ − σ ψ_J),

and ξ − σ ψ_J = c e^{κz} is zero everywhere if it is at one place. Between two finite ends κ = 0, and a condition at one of them says so.
With an end at infinity κ is such that e^{κz} grows towards it: what decays has c = 0, without a condition, and with two such ends the
count of decaying solutions is right for either sign. σ ψ_J′ is put in from the row of ψ_J where that needs no further copies. The modes
are those of the polynomial problem, with their multiplicities.
"""

from __future__ import annotations

from dataclasses import dataclass

from shootstab.core.errors import InputError
from shootstab.formulation.expression import Expression, number
from shootstab.formulation.first_order import Entries, FirstOrder
from shootstab.formulation.system import SIGMA, Row, coefficients, degree

Condition = dict[int, Expression]  # of the states by their number, polynomials in σ


@dataclass(frozen=True, eq=False)
class AffineSystem:
    """(C0 + σ C1) ψ′ = (D0 + σ D1) ψ by non-zero entries, functions of z, and the rows (W0, W1) at the ends, by (row, state)."""

    size: int
    C0: Entries
    C1: Entries
    D0: Entries
    D1: Entries
    left: tuple[Entries, Entries]
    right: tuple[Entries, Entries]
    left_rows: int
    right_rows: int

    @property
    def parts(self) -> tuple[Entries, ...]:
        """C0, C1, D0, D1."""
        return self.C0, self.C1, self.D0, self.D1


def affine(
    first: FirstOrder, left: list[Condition], right: list[Condition], finite: tuple[bool, bool], holding: tuple[bool, bool]
) -> AffineSystem:
    """See above. left and right are the conditions at the ends that hold any.

    Raises InputError where copies are needed between two finite ends without conditions.
    """
    n = first.order
    rows = [[{(0, j): c for j, c in row.items()} for row in end] for end in (left, right)]
    everything = [first.C, first.D, *rows[0], *rows[1]]
    highest: dict[int, int] = {}
    for entries in everything:
        for (_, j), entry in entries.items():
            highest[j] = max(highest.get(j, 1), degree(entry))
    copies: dict[tuple[int, int], int] = {}
    for j, power in sorted(highest.items()):
        for m in range(1, power):
            copies[j, m] = n + len(copies)
    plain = {i for i in range(n) if [(at, c) for at, c in first.C.items() if at[0] == i] == [((i, i), number(1))]}
    kappa = number(0) if all(finite) else number(1 if not finite[1] else -1)
    C, D = _split(first.C, copies), _split(first.D, copies)
    extra: list[tuple[int, int]] = []
    for (j, m), at in copies.items():
        below = copies.get((j, m - 1), j)
        slope = {(0, k): c * SIGMA**m for (i, k), c in first.D.items() if i == j}
        C[0][at, at] = number(1)
        if kappa:
            D[0][at, at], D[1][at, below] = kappa, -kappa
        if j in plain and all(degree(c) <= highest.get(k, 1) for (_, k), c in slope.items()):
            for part, found in zip(D, _split(slope, copies), strict=True):
                for (_, k), c in found.items():
                    part[at, k] = part[at, k] + c if (at, k) in part else c
        else:
            C[1][at, below] = number(-1)
        extra.append((at, below))
    ends = [[_split(row, copies) for row in end] for end in rows]
    if extra and all(finite):
        if not any(holding):
            raise InputError("between two ends without conditions the eigenvalue occurs to higher powers: that is not offered")
        moving = [any(degree(c) for row in end for c in row.values()) for end in (left, right)]
        at_right = holding[1] and (not holding[0] or (moving[1] and not moving[0]))
        ends[at_right] += [({(0, at): number(1)}, {(0, below): number(-1)}) for at, below in extra]
    stacked = [tuple({(r, j): c for r, row in enumerate(end) for (_, j), c in row[part].items()} for part in (0, 1)) for end in ends]
    return AffineSystem(n + len(copies), C[0], C[1], D[0], D[1], stacked[0], stacked[1], len(ends[0]), len(ends[1]))  # type: ignore[arg-type]


def in_states(rows: list[tuple[str, Row]], first: FirstOrder) -> list[Condition]:
    """The conditions on the states. Raises InputError for one that holds already, by the equations."""
    number_of = {state: i for i, state in enumerate(first.states)}
    out = []
    for where, row in rows:
        reduced = first.in_states(row)
        if not reduced:
            raise InputError(f"{where} says nothing: the equations themselves make it true; allowed are conditions that they leave open")
        out.append({number_of[at]: c for at, c in reduced.items()})
    return out


def _split(entries: Entries, copies: dict[tuple[int, int], int]) -> tuple[Entries, Entries]:
    """What stands before σ⁰ and before σ¹, higher powers of σ with the copies of their states."""
    fixed: Entries = {}
    moving: Entries = {}
    for (i, j), entry in entries.items():
        for power, c in coefficients(entry).items():
            if power == 0:
                fixed[i, j] = c
            else:
                moving[i, copies[j, power - 1] if power > 1 else j] = c
    return fixed, moving
