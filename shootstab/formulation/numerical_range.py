"""How far eigenvalues reach to the right, by the numerical range of the equations: a theorem, not an estimate (lemma P3 of the guide).

Each equation is multiplied by a weight w(z) and by the conjugate of one unknown, the products are added and integrated. In equations that
are linear in the eigenvalue this is σ S(u) = L(u) with forms S and L. Where S(u) is real and not negative, and

    b S − Re(e^{−iθ} L) ≥ 0   at every z,

once integrated by parts (sesquilinear_form.py), as a Hermitian form in the unknowns and their derivatives, with nothing left at the ends,
every eigenvalue has Re(e^{−iθ} σ) ≤ b. An unknown in whose own equation no eigenvalue stands (a pressure) has no other equation than
that it must drop out: this says what the weight of its equation is. The form is looked at in doubles to find b, and enclosed over the
whole interval in balls to prove it.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction

import numpy as np
from numpy.typing import NDArray

from shootstab.formulation.domain import Domain
from shootstab.formulation.evaluation import on_arrays
from shootstab.formulation.expression import Expression, Z, number
from shootstab.formulation.gaussian import Gaussian
from shootstab.formulation.sesquilinear_form import Form, NotRealError, RealPart, added, conjugated, real_part, scaled
from shootstab.formulation.statement import Statement
from shootstab.formulation.stretches import has_limits, stretches
from shootstab.formulation.system import Jet, coefficients, degree
from shootstab.formulation.vanishing import Vanishing
from shootstab.problems.ends import Infinity

MOST_PAIRED = 6  # chosen: unknowns whose assignments to equations are all tried
PHASES = tuple(Gaussian(*x) for x in ((1, 0), (-1, 0), (0, 1), (0, -1)))  # defined: by what an equation may be multiplied


@dataclass(frozen=True, eq=False)
class EnergyForm:
    """S and Re(e^{−iθ} L), each a sum over groups of equations whose weights are free against each other."""

    weight: tuple[Form, ...]
    rotated: tuple[Form, ...]

    @property
    def jets(self) -> list[Jet]:
        """The unknowns and derivatives in either, in order."""
        return sorted({jet for form in (*self.weight, *self.rotated) for at in form for jet in at})


def energy_form(statement: Statement, direction: Gaussian) -> EnergyForm | None:
    """The form for e^{iθ} = direction, |direction| = 1; None where no weights are found that make it one."""
    vanishing = statement.domain.vanishing
    if any(degree(c) > 1 for row in statement.system.rows for c in row.values()):
        return None
    for pairing in _pairings(statement):
        for measure in (number(1), Z, Z * Z):
            try:
                found = _with(statement, pairing, measure, direction, vanishing)
            except NotRealError:
                return None
            if found is not None:
                return found
    return None


def _pairings(statement: Statement) -> Iterator[tuple[str, ...]]:
    """Ways to give each equation one unknown, whose conjugate multiplies it: one that the eigenvalue stands with, where it holds it."""
    system = statement.system
    if len(system.unknowns) > MOST_PAIRED:
        return
    holding = [{jet[0] for jet, c in row.items() if 1 in coefficients(c)} for row in system.rows]
    for order in itertools.permutations(system.unknowns):
        if all(name in held or not held for name, held in zip(order, holding, strict=True)):
            yield order


def _with(
    statement: Statement, pairing: Sequence[str], measure: Expression, direction: Gaussian, vanishing: Vanishing
) -> EnergyForm | None:
    rows = statement.system.rows
    split = [{jet: coefficients(c) for jet, c in row.items()} for row in rows]
    evolving = [any(1 in powers for powers in row.values()) for row in split]
    turned = Expression({(): Gaussian(-direction.re, direction.im)})  # −e^{−iθ}: L is what stands on the other side
    weights: dict[str, Expression] = {}
    growing: dict[str, RealPart] = {}
    for name, row, evolves in zip(pairing, split, evolving, strict=True):
        if not evolves:
            continue
        part: Form = {((name, 0), jet): powers[1] for jet, powers in row.items() if 1 in powers}
        found = _positive(part, measure, statement, vanishing)
        if found is None:
            return None
        weights[name], growing[name] = found
    rest: dict[str, Form] = {
        name: {((name, 0), jet): turned * powers[0] for jet, powers in row.items() if 0 in powers}
        for name, row in zip(pairing, split, strict=True)
    }
    for name in pairing:
        if name not in weights:
            weight = _constraint_weight(name, rest, weights)
            if weight is None:
                return None
            weights[name] = weight
    groups = _groups(pairing, rest, [name for name, evolves in zip(pairing, evolving, strict=True) if not evolves])
    forms = []
    for group in groups:
        whole = real_part(added([scaled(rest[name], weights[name]) for name in group], vanishing), vanishing)
        if not _nothing_at_ends(whole.at_ends, statement):
            return None
        forms.append(whole.entries)
    weight_forms = tuple(added([growing[name].entries for name in group if name in growing], vanishing) for group in groups)
    found_form = EnergyForm(weight_forms, tuple(forms))
    on_the_diagonal = {u for form in (*weight_forms, *forms) for u, v in form if u == v}
    return found_form if on_the_diagonal == set(found_form.jets) else None


def _positive(part: Form, measure: Expression, statement: Statement, vanishing: Vanishing) -> tuple[Expression, RealPart] | None:
    """A weight with which ∫ ū S u is real, with nothing at the ends, and whose coefficients begin positive; None where there is none.

    The caller proves in balls that the form is positive everywhere.
    """
    for phase in PHASES:
        weight = Expression({(): phase}) * measure
        form = scaled(part, weight)
        real, imaginary = real_part(form, vanishing), real_part(scaled(form, number(-1j)), vanishing)
        if imaginary.entries or not (_nothing_at_ends(real.at_ends, statement) and _nothing_at_ends(imaginary.at_ends, statement)):
            continue
        own = [c for (u, v), c in real.entries.items() if u == v]
        first = on_arrays(statement.domain.points[:1], {})
        if own and all(np.ravel(np.real(first(c)))[0] >= 0.0 for c in own):
            return weight, real
    return None


def _constraint_weight(name: str, rest: dict[str, Form], weights: dict[str, Expression]) -> Expression | None:
    """The weight with which an unknown drops out of the real part where it meets its first partner."""
    for order in (1, 0):
        for other, known in weights.items():
            own, theirs = rest[name].get(((name, 0), (other, order))), rest[other].get(((other, 0), (name, order)))
            if own is not None and theirs is not None:
                mirrored = conjugated(known * theirs)
                return (mirrored if order else -mirrored) / own
    return None


def _groups(pairing: Sequence[str], rest: dict[str, Form], constraints: Sequence[str]) -> list[list[str]]:
    """The groups of unknowns whose weights are tied, by constraints and by derivatives of one in the equation of another."""
    ties = [{name, v[0]} for name, form in rest.items() for _, v in form if v[1] > 0 or name in constraints or v[0] in constraints]
    groups = [{name} for name in pairing]
    for tied in ties:
        groups = [g for g in groups if not g & tied] + [set().union(*(g for g in groups if g & tied))]
    return [[name for name in pairing if name in g] for g in groups]


def _nothing_at_ends(terms: Form, statement: Statement) -> bool:
    """Whether every boundary term vanishes: a factor of it by a condition there, or its coefficient, or all factors towards infinity."""
    for end, rows, direction in ((statement.left, statement.left_rows, -1), (statement.right, statement.right_rows, 1)):
        if isinstance(end, Infinity):
            if not has_limits(list(terms.values()), direction):
                return False
            continue
        zero = {jet for _, row in rows if len(row) == 1 for jet, c in row.items() if c.constant}
        at = number(Fraction(repr(float(end.at))))  # type: ignore[union-attr]
        for (u, v), c in terms.items():
            if u not in zero and v not in zero and _value(c, at):
                return False
    return True


def _value(c: Expression, at: Expression) -> bool:
    """Whether a polynomial in z has another value than zero at a place; anything else counts as having one."""
    if any(atom != next(iter(Z.terms))[0][0] for atom in c.atoms()):
        return True
    if not at and any(exponent < 0 for monomial in c.terms for _, exponent in monomial):
        return True
    total = number(0)
    for monomial, factor in c.terms.items():
        term = Expression({(): factor})
        for _, exponent in monomial:
            term = term * at**exponent
        total = total + term
    return bool(total)


def sampled(form: Form, jets: Sequence[Jet], domain: Domain, fractions: NDArray[np.float64]) -> NDArray[np.complex128]:
    """The form as matrices (m, k, k), k = len(jets), at these fractions of every stretch of the domain.

    Raises InputError as `stretches` does.
    """
    where = {jet: i for i, jet in enumerate(jets)}
    out = []
    for part in stretches(domain, list(form.values())):
        x = float(part.low) + float(part.high - part.low) * fractions
        matrices = np.zeros((len(x), len(jets), len(jets)), dtype=np.complex128)
        at = on_arrays(x, {})
        for (u, v), c in form.items():
            matrices[:, where[u], where[v]] = at(part.written(c))
        out.append(matrices)
    return np.concatenate(out)
