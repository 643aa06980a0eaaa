"""The system of equations as a recorded pencil: what varies with z are powers of atoms, and the entries are polynomials in them."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from shootstab.core.straight_line import Recorded
from shootstab.formulation.atoms import Atom, Exponent
from shootstab.formulation.domain import Domain
from shootstab.formulation.evaluation import on_arrays
from shootstab.formulation.expression import Expression
from shootstab.formulation.state_pencil import StatePencil
from shootstab.problems.protocol import ComplexArray
from shootstab.problems.recorded_pencil import Entries, RecordedPencil
from shootstab.problems.subdomains import Subdomain
from shootstab.problems.two_point import TwoPointReduction


@dataclass(frozen=True, eq=False)
class RecordedStates:
    """The matrices of a system, on each of the subdomains that a problem is laid out in, as polynomials in factors.

    Rows whose own derivative is multiplied by a function of z that has no zero on the domain are divided by it: it becomes a pivot that is
    known.
    """

    system: StatePencil
    domain: Domain
    subdomains: tuple[Subdomain, ...]

    @cached_property
    def factors(self) -> tuple[tuple[Atom, Exponent], ...]:
        """The powers of atoms that are computed at each point: the atoms themselves, and powers that are no natural ones."""
        found = {_base(*power) for part in self._parts for entry in part.values() for monomial in entry.terms for power in monomial}
        return tuple(sorted(found))

    @property
    def pencil(self) -> RecordedPencil:
        """The pencil of the system, of which every elimination divides by known numbers only."""
        size = self.system.size * sum(1 + subdomain.augmented for subdomain in self.subdomains)
        count = len(self.factors) * len(self.subdomains)
        return RecordedPencil(_entries, self, size, self._fields, np.zeros(0), count, constant_pivots=True)

    @property
    def _parts(self) -> tuple[dict[tuple[int, int], Expression], ...]:
        return (*self.system.C, *self.system.D)

    @cached_property
    def _divisors(self) -> dict[int, Expression]:
        """The coefficients of the rows' own derivatives, by row, where they vary with z alone and have no zero."""
        moving = {place for part in self.system.C[1:] for place in part}
        own = {i: self.system.C[0][i, i] for i in range(self.system.size) if (i, i) in self.system.C[0] and (i, i) not in moving}
        return {i: entry for i, entry in own.items() if entry.constant is None and self.domain.regular(entry)}

    def _fields(self, t: ComplexArray) -> NDArray[np.inexact]:
        rows: list[NDArray[np.inexact]] = []
        for subdomain in self.subdomains:
            z = subdomain.points(t)
            with np.errstate(all="ignore"):  # numbers that are not finite are found where the system is computed
                at = on_arrays(z if z.imag.any() else z.real.copy(), self.domain.given)
                rows += [np.broadcast_to(at.factor(*power), z.shape) for power in self.factors]
        return np.array(rows) if rows else np.zeros((0, len(t)))

    def recorded(self, fields: list[Recorded]) -> tuple[Entries, ...]:
        """The non-zero entries of C0, C1, …, D0, D1, … from the factors at a point, those of one subdomain after the other."""
        n, first, count = self.system.size, 0, len(self.factors)
        C: list[Entries] = [{} for _ in self.system.C]
        D: list[Entries] = [{} for _ in self.system.D]
        for k, subdomain in enumerate(self.subdomains):
            if subdomain.augmented:
                C[0] |= {(first + i, first + i): 1.0 for i in range(n)}
                first += n
            own = fields[k * count : (k + 1) * count]
            divisors = {i: self._value(entry, own) for i, entry in self._divisors.items()}
            for whole, parts, scale in ((C, self.system.C, 1.0), (D, self.system.D, subdomain.scale)):
                for power, part in enumerate(parts):
                    for (i, j), entry in part.items():
                        whole[power][first + i, first + j] = scale * self._value(entry, own) / divisors.get(i, 1.0)
            first += n
        return (*C, *D)

    def _value(self, expression: Expression, fields: list[Recorded]) -> Recorded | complex:
        known = dict(zip(self.factors, fields, strict=True))
        total: Recorded | complex = 0.0
        for monomial, c in expression.terms.items():
            term: Recorded | complex = complex(c) if c.im else complex(c).real
            for power in monomial:
                base = _base(*power)
                term = term * (known[base] if base == power else known[base] ** int(power[1]))
            total = total + term
        return total


def recorded_pencil(system: StatePencil, domain: Domain, reduction: TwoPointReduction) -> RecordedPencil | None:
    """The pencil of a system as it is laid out; None where subdomains run across interfaces."""
    crossed = any(subdomain.crossed is not None for subdomain in reduction.subdomains)
    return None if crossed else RecordedStates(system, domain, reduction.subdomains).pencil


def _base(atom: Atom, exponent: Exponent) -> tuple[Atom, Exponent]:
    """The factor of which this power is one."""
    return (atom, 1) if Fraction(exponent).denominator == 1 and exponent > 0 else (atom, exponent)


def _entries(fields: list[Recorded], parameters: list[Recorded], shape: RecordedStates) -> tuple[Entries, ...]:
    return shape.recorded(fields)
