"""Equations as rows of a matrix of differential operators: Σ_jk a_jk(z, σ) u_j^{(k)} = 0, a polynomial in σ."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction

from shootstab.core.errors import InputError
from shootstab.core.numerus import number_of
from shootstab.formulation.atoms import Atom
from shootstab.formulation.denominators import cleared
from shootstab.formulation.expression import Expression, number, of_atom
from shootstab.formulation.gaussian import ONE
from shootstab.formulation.vanishing import Vanishing

Jet = tuple[str, int]  # an unknown and the order of its derivative
EquationRow = dict[Jet, Expression]

EIGENVALUE = Atom("eigenvalue", "sigma")
SIGMA = of_atom(EIGENVALUE)


def jet(name: str, order: int = 0) -> Expression:
    """The order-th derivative of an unknown."""
    return of_atom(Atom("jet", name, order))


def equations_for(count: int, unknowns: Sequence[str]) -> str:
    """Words for a number of equations and these unknowns."""
    return f"{number_of(count, 'equation')} for {number_of(len(unknowns), 'unknown')}, {', '.join(unknowns)}"


def shown(at: Jet) -> str:
    """A derivative as the user would write it."""
    name, order = at
    return name if order == 0 else f"d({name})" if order == 1 else f"d({name},{order})"


Denominators = tuple[tuple[str, Expression], ...]  # where each stood, and what it is: see denominators.py


def row_of(expression: Expression, where: str, text: Callable[[Expression], str]) -> tuple[EquationRow, Denominators]:
    """The coefficients of the unknowns and their derivatives, polynomials in the eigenvalue, and the denominators that were cleared.

    text shows an expression in the user's names. Raises InputError for what is not linear in the unknowns.
    """
    row: EquationRow = {}
    for outer, coefficient in expression.collected(lambda atom: atom.kind == "jet"):
        if len(outer) == 1 and outer[0][1] == 1:
            atom = outer[0][0]
            row[atom.name, atom.order] = coefficient
        elif outer:
            product = text(Expression({outer: ONE}))
            raise InputError(f"{where} is not linear: it holds {product}: allowed are the unknowns times functions of the coordinate")
        else:
            raise InputError(f"{where} holds the term {text(coefficient)} without an unknown: allowed are homogeneous linear equations")
    if not row:
        raise InputError(f"{where} holds no unknown: allowed are linear equations for them")
    row, denominators = cleared(row, where)
    return row, tuple((where, denominator) for denominator in denominators)


def linear(row: EquationRow) -> Expression:
    """The expression that a row stands for."""
    total = number(0)
    for (name, order), coefficient in row.items():
        total = total + coefficient * jet(name, order)
    return total


def combined(rows: Iterable[tuple[Expression, EquationRow]], vanishing: Vanishing) -> EquationRow:
    """Σ factor · row, without the coefficients that vanish."""
    total: EquationRow = {}
    for factor, row in rows:
        for at, coefficient in row.items():
            term = factor * coefficient
            total[at] = total[at] + term if at in total else term
    return {at: c for at, c in total.items() if not vanishing(c)}


def differentiated(row: EquationRow, times: int, vanishing: Vanishing) -> EquationRow:
    """d^times/dz^times of the equation."""
    for _ in range(times):
        out: EquationRow = {}
        for (name, order), c in row.items():
            for at, term in (((name, order + 1), c), ((name, order), c.derivative())):
                out[at] = out[at] + term if at in out else term
        row = {at: c for at, c in out.items() if not vanishing(c)}
    return row


def orders(rows: Iterable[EquationRow]) -> dict[str, int]:
    """The highest derivative of each unknown in the rows."""
    found: dict[str, int] = {}
    for row in rows:
        for name, order in row:
            found[name] = max(found.get(name, 0), order)
    return found


def degree(expression: Expression) -> int:
    """The highest power of the eigenvalue in an expression."""
    return max((int(Fraction(e)) for monomial in expression.terms for atom, e in monomial if atom == EIGENVALUE), default=0)


def coefficients(expression: Expression) -> dict[int, Expression]:
    """The coefficient of each power of the eigenvalue, by that power."""
    return {int(outer[0][1]) if outer else 0: c for outer, c in expression.collected(lambda atom: atom == EIGENVALUE)}


@dataclass(frozen=True, eq=False)
class System:
    """The user's equations: unknowns in their order, rows (one an equation), names of the equations as errors call them, and the
    denominators that they were multiplied by.
    """

    unknowns: tuple[str, ...]
    rows: tuple[EquationRow, ...]
    names: tuple[str, ...]
    denominators: Denominators = ()

    @staticmethod
    def of(unknowns: tuple[str, ...], equations: Mapping[str, Expression], text: Callable[[Expression], str]) -> System:
        """The system of named expressions. Raises InputError: not linear, more or fewer equations than unknowns, an unknown nowhere."""
        read = [row_of(expression, where, text) for where, expression in equations.items()]
        rows = tuple(row for row, _ in read)
        if len(rows) != len(unknowns):
            raise InputError(f"{equations_for(len(rows), unknowns)}: allowed are as many")
        held = orders(rows)
        for name in unknowns:
            if name not in held:
                raise InputError(f"no equation holds the unknown {name}: allowed are unknowns that the equations determine")
        return System(unknowns, rows, tuple(equations), tuple(pair for _, found in read for pair in found))
