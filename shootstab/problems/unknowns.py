"""What the state of a problem stands for: its unknowns by name, and where on the user's line each component lives.

The engine integrates ψ over t; what a user calls W or ν̂ is a linear combination of ψ, and one z may lie in any of several subdomains.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

from shootstab.core.errors import InputError
from shootstab.problems.capabilities import PLACEMENTS, UNKNOWNS
from shootstab.problems.crossed import Crossed
from shootstab.problems.protocol import ComplexArray, Problem


@dataclass(frozen=True, eq=False)
class Unknowns:
    """names (q,) of the unknowns, and matrix(z, σ) (m, q, n), which gives them from the state at points z (m,): u = matrix ψ.

    variable is what the problem calls z.
    """

    names: tuple[str, ...]
    matrix: Callable[[ComplexArray, complex], ComplexArray]
    variable: str = "z"

    @classmethod
    def named(cls, given: Mapping[str, ArrayLike] | Sequence[str], size: int, variable: str = "z") -> Unknowns:
        """Combinations where rows (size,) are given, components where names are, psi1, psi2, … where nothing is. Raises InputError."""
        if not isinstance(variable, str) or not variable.isidentifier():
            raise InputError(f"variable = {variable!r}: allowed is a name")
        names = given if len(given) else [f"psi{i}" for i in range(1, size + 1)]
        made = cls.combinations(names, size) if isinstance(names, Mapping) else cls.components(names, size)
        return cls(made.names, made.matrix, variable)

    @classmethod
    def combinations(cls, rows: Mapping[str, ArrayLike], size: int) -> Unknowns:
        """The unknowns by name, each a row of numbers (size,) over the state. Raises InputError for other rows."""
        if not rows:
            raise InputError("unknowns is empty: allowed are names, each with a row over the components")
        stacked = [np.asarray(row) for row in rows.values()]
        for name, row in zip(rows, stacked, strict=True):
            if not isinstance(name, str) or row.shape != (size,) or row.dtype.kind not in "biufc" or not np.isfinite(row).all():
                raise InputError(f"unknowns[{name!r}]: allowed is a row of {size} finite numbers, one for each component")
        constant = np.array(stacked, dtype=np.complex128)
        return cls(tuple(rows), lambda z, sigma: np.broadcast_to(constant, (len(z), *constant.shape)))

    @classmethod
    def components(cls, names: Sequence[str], size: int) -> Unknowns:
        """Names for the first components of the state. Raises InputError where they are too many, or not different."""
        if isinstance(names, str) or not 0 < len(set(names)) == len(names) <= size:
            raise InputError(f"unknowns = {names!r}: allowed are different names, at most {size}, one for each component")
        return cls.combinations(dict(zip(names, np.eye(size), strict=False)), size)

    def in_units_of(self, unit: complex) -> Unknowns:
        """The same for an eigenvalue v, σ = unit·v."""
        return Unknowns(self.names, lambda z, v: self.matrix(z, unit * v), self.variable)


class InnerSpace(Protocol):
    """Solutions that are regular at an end, known between it and where the integration begins."""

    @property
    def place(self) -> float:
        """The z of the end."""
        ...

    def nearer(self, z: NDArray[np.float64], sigma: complex) -> ComplexArray:
        """A basis (m, n, k) at points z (m,) between the end and the beginning."""
        ...


@dataclass(frozen=True)
class Placement:
    """ψ on z = offset + scale·t, as the components first … first + size of what is integrated over t; T of it across interfaces.

    inner is the space of solutions that are known from a singular end to where the integration begins; None where there is no such end.
    """

    offset: float
    scale: float
    first: int
    size: int
    crossed: Crossed | None = None
    inner: InnerSpace | None = None

    def z(self, t: ComplexArray) -> ComplexArray:
        """Points (m,) of the user's line, of t (m,)."""
        return self.offset + self.scale * t

    def t(self, z: ComplexArray) -> ComplexArray:
        """Points (m,) of the line of integration, of z (m,)."""
        return (z - self.offset) / self.scale

    def right(self, states: ComplexArray, t: ComplexArray) -> ComplexArray:
        """ψ (m, n) of states (m, N) of the whole at t (m,): T φ behind interfaces."""
        own = states[..., self.first : self.first + self.size]
        return own if self.crossed is None else self.crossed.solution(own, self.z(t))

    def left(self, rows: ComplexArray, t: ComplexArray) -> ComplexArray:
        """The left solution (m, n) from rows (m, N), that of the whole at t (m,): y T⁻¹ behind interfaces."""
        own = rows[..., self.first : self.first + self.size]
        return own if self.crossed is None else self.crossed.left_solution(own, self.z(t))


def placements(problem: Problem) -> tuple[Placement, ...]:
    """One for each subdomain; a problem without placements of its own is integrated over z itself."""
    found: tuple[Placement, ...] = PLACEMENTS.of(problem) or (Placement(0.0, 1.0, 0, problem.size),)
    return found


def unknowns(problem: Problem) -> Unknowns:
    """The unknowns that the problem names, or the components ψ1, ψ2, … of its state."""
    found: Unknowns | None = UNKNOWNS.of(problem)
    if found is not None:
        return found
    size = placements(problem)[0].size
    return Unknowns.named((), size)
