"""An end at infinity at which coefficients go as powers of the coordinate, with what is exponentially small beside them left out.

With r = |z|, d = ±1 the direction of the end, ψ_j = r^{s_j} φ_j and every row divided by the power of r of its C_ii, the system becomes

    dφ/dr = r^q A φ,   A = d Ĉ⁻¹ D̂ − S r^{−1−q},   S = diag(s),   Ĉ and D̂ power series in t = r^{−1/p}, Ĉ_0 regular.

q = Q/p is the least for which there are such s: 0 for coefficients that come to a limit, 1 for y″ = (i z² − σ) y, 1/2 for y″ = z y.
Solutions go as exp ∫ r^q λ dr with the eigenvalues λ of A_0; those that decay are told from the others by the real parts of λ.
Source: W. Wasow, Asymptotic Expansions for Ordinary Differential Equations (1965), sections 11 and 12.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import pairwise

from shootstab.core.errors import InputError
from shootstab.formulation.expression import VARIABLE, Expression, Z
from shootstab.formulation.far_coefficients import Text, in_inverse, kept_far_out
from shootstab.formulation.first_order import ExpressionEntries
from shootstab.formulation.state_pencil import Powers, StatePencil
from shootstab.problems.ends import INFINITIES

ROOTS = (1, 2, 3, 4)  # chosen: p that are tried
FASTEST_GROWTH = 8  # chosen: q that is tried at most


@dataclass(frozen=True, eq=False)
class AsymptoticEnd:
    """Ĉ and D̂ by powers of σ as expressions in t, which their variable stands for; p, Q, s and the powers of r that rows were divided by
    (own), all in units of 1/p, and d.

    dropped says whether anything exponentially small was left out.
    """

    root: int
    rank: int
    shifts: tuple[int, ...]
    own: tuple[int, ...]
    C: Powers
    D: Powers
    direction: int
    dropped: bool

    @property
    def constant(self) -> bool:
        """Whether the coefficients are, but for what was left out."""
        return self.rank == 0 and not any(VARIABLE in entry.atoms() for part in (*self.C, *self.D) for entry in part.values())

    def window(self, nonzero: Sequence[bool]) -> int:
        """How many successive terms of a solution's series may vanish before others do not, where these of the coefficients do not."""
        orders = [0, *(j for j, held in enumerate(nonzero) if held and j > 0)]
        return self.root + self.rank + max((b - a for a, b in pairwise(orders)), default=1)


def asymptotic_end(system: StatePencil, direction: int, text: Text = str) -> AsymptoticEnd:
    """Raises InputError where a coefficient, shown by text, does not go as a power, beside what is exponentially small."""
    where = f"at {INFINITIES[direction]}"
    both = system.C, system.D
    kept = [[{at: kept_far_out(e, direction, where, text) for at, e in part.items()} for part in powers] for powers in both]
    dropped = any(a[at] != b[at] for own, powers in zip(kept, both, strict=True) for a, b in zip(own, powers, strict=True) for at in a)
    kept = [[{at: e for at, e in part.items() if e.terms} for part in powers] for powers in kept]
    found = []
    for root in ROOTS:
        C, D = ([{at: in_inverse(e, direction, root) for at, e in part.items()} for part in powers] for powers in kept)
        exponents = [dict(m).get(VARIABLE, 0) for part in (*C, *D) for e in part.values() for m in e.terms]
        if all(Fraction(e).denominator == 1 for e in exponents):
            rank, s, own, scaled_C, scaled_D = _scaled(C, D, system.size, root, where)
            found.append((Fraction(rank, root), AsymptoticEnd(root, rank, s, own, scaled_C, scaled_D, direction, dropped)))
    if not found:
        told = f"allowed are exponents that are multiples of 1/{ROOTS[-1]}"
        raise InputError(f"{where} the coefficients do not go as such powers of the coordinate: {told}")
    return min(found, key=lambda pair: pair[0])[1]


def _degree(entry: Expression) -> int:
    """The highest power of r^{1/p} in an expression of t."""
    return -min(int(dict(monomial).get(VARIABLE, 0)) for monomial in entry.terms)


def _scaled(
    C: list[ExpressionEntries], D: list[ExpressionEntries], n: int, root: int, where: str
) -> tuple[int, tuple[int, ...], tuple[int, ...], Powers, Powers]:
    """Q, s, own, Ĉ and D̂."""
    held = [[_degree(part[i, i]) for part in C if (i, i) in part] for i in range(n)]
    if not all(held):
        raise InputError(f"{where} the coefficient of a highest derivative is exponentially small: allowed are ones that go as powers")
    own = [max(degrees) for degrees in held]
    in_C = [(i, j, _degree(e) - own[i]) for part in C for (i, j), e in part.items()]
    in_D = [(i, j, _degree(e) - own[i]) for part in D for (i, j), e in part.items()]
    for rank in range(FASTEST_GROWTH * root + 1):
        s = _shifts(in_C, in_D, n, rank)
        if s is not None:
            break
    else:
        raise InputError(f"{where} the coefficients grow faster than the power {FASTEST_GROWTH}: that is not offered")

    def scaled(part: ExpressionEntries, extra: int) -> ExpressionEntries:
        return {(i, j): e * Z ** (s[i] + own[i] - s[j] + extra) for (i, j), e in part.items()}

    return rank, tuple(s), tuple(own), tuple(scaled(part, 0) for part in C), tuple(scaled(part, rank) for part in D)


def _shifts(in_C: list[tuple[int, int, int]], in_D: list[tuple[int, int, int]], n: int, rank: int) -> list[int] | None:
    """The largest s ≤ 0 with s_j + c_ij ≤ s_i and s_j + d_ij ≤ s_i + Q; None where there are none."""
    s = [0] * n
    for _ in range(n + 1):
        changed = False
        for bounds, slack in ((in_C, 0), (in_D, rank)):
            for i, j, w in bounds:
                if s[j] + w > s[i] + slack:
                    s[j], changed = s[i] + slack - w, True
        if not changed:
            return s
    return None
