"""Coefficients rational in the eigenvalue, cleared: a row times its denominators has the same solutions where none of them vanishes.

A denominator is the eigenvalue itself, or a sum that holds it, to a negative power. The row is multiplied by the lowest power of each, and
divided again by what then divides all of its coefficients, so that it does not vanish at a zero of a denominator.
"""

from __future__ import annotations

from collections.abc import Hashable, Mapping
from typing import TypeVar

from shootstab.core.errors import InputError
from shootstab.formulation.atoms import Atom, Exponent
from shootstab.formulation.expression import Expression, Monomial, number, of_atom, quotient
from shootstab.formulation.gaussian import ONE

K = TypeVar("K", bound=Hashable)
MOST_ROUNDS = 16  # chosen: denominators within each other


def cleared(row: Mapping[K, Expression], where: str) -> tuple[dict[K, Expression], tuple[Expression, ...]]:
    """The row without denominators that hold the eigenvalue, and these. Raises InputError where they are nested too deep."""
    found: list[Expression] = []
    out = dict(row)
    for _ in range(MOST_ROUNDS):
        lowest = _lowest(out)
        if not lowest:
            return out, tuple(found)
        out = {at: _times(c, lowest) for at, c in out.items()}
        for atom in lowest:
            base = of_atom(atom) if atom.argument is None else atom.argument
            found += [] if base in found else [base]
            while (divided := _divided(out, base)) is not None:
                out = divided
    raise InputError(f"{where}: the eigenvalue stands in more than {MOST_ROUNDS} denominators within each other")


def holds_eigenvalue(atom: Atom) -> bool:
    """Whether the eigenvalue occurs in it."""
    return atom.kind == "eigenvalue" or (atom.argument is not None and any(map(holds_eigenvalue, atom.argument.atoms())))


def _divided(row: Mapping[K, Expression], divisor: Expression) -> dict[K, Expression] | None:
    """The row over a divisor of all its coefficients; None where it is none."""
    found = {at: quotient(c, divisor) for at, c in row.items()}
    out = {at: c for at, c in found.items() if c is not None}
    return out if len(out) == len(row) and not _lowest(out) else None


def _lowest(row: Mapping[K, Expression]) -> dict[Atom, Exponent]:
    """The lowest powers below zero of what holds the eigenvalue."""
    out: dict[Atom, Exponent] = {}
    for c in row.values():
        for monomial in c.terms:
            for atom, e in monomial:
                if e < 0 and holds_eigenvalue(atom):
                    out[atom] = min(out.get(atom, 0), e)
    return out


def _times(c: Expression, lowest: Mapping[Atom, Exponent]) -> Expression:
    """Each monomial by itself, so that powers of one base cancel before they are multiplied out."""
    total = number(0)
    for monomial, factor in c.terms.items():
        powers = dict(monomial)
        rest: Monomial = tuple((atom, e) for atom, e in monomial if atom not in lowest)
        product = Expression({rest: factor})
        for atom, least in lowest.items():
            e = powers.get(atom, 0) - least
            if e:
                product = product * (Expression({((atom, e),): ONE}) if atom.argument is None else atom.argument**e)
        total = total + product
    return total
