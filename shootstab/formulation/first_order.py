"""The first-order system that a reduction ends with: C(z, σ) ψ′ = D(z, σ) ψ, and every unknown in terms of its states ψ."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Set
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.optimize import linear_sum_assignment

from shootstab.core.errors import InputError
from shootstab.formulation.expression import Expression, number, quotient
from shootstab.formulation.linear_algebra import determinant
from shootstab.formulation.reduction import Reduction, reduced
from shootstab.formulation.system import SIGMA, EquationRow, Jet, System, coefficients, combined, degree, differentiated
from shootstab.formulation.vanishing import Vanishing

ExpressionEntries = dict[tuple[int, int], Expression]
MOST_SUBSTITUTIONS = 2000  # chosen: substitutions in one expression, more than any needs
NO_DERIVATIVE = 1e6  # chosen: price of a row for an unknown whose highest derivative it has not, above all others
PRICE_OF_DEGREE = 100.0  # chosen: price of a power of σ in the factor of that derivative, above that of any number of its terms


@dataclass(frozen=True, eq=False)
class FirstOrder:
    """states: ψ, each an unknown (or a flux) with the order of its derivative; C and D by their non-zero entries, polynomials in σ.

    rules give what is no state: row = 0 holds, and finds the jet that it is filed under. fluxes are the unknowns that were introduced.
    factors: what equations were multiplied by that may vanish somewhere, with the names of the equations. leading: the coefficients of the
    highest derivatives, and leading_names the equations that these rows came from.
    """

    states: tuple[Jet, ...]
    C: ExpressionEntries
    D: ExpressionEntries
    rules: Mapping[str, tuple[Jet, EquationRow]]
    fluxes: Mapping[str, EquationRow]
    factors: tuple[tuple[Expression, str], ...]
    leading: tuple[dict[str, Expression], ...]
    leading_names: tuple[str, ...]
    vanishing: Vanishing

    @property
    def order(self) -> int:
        """n."""
        return len(self.states)

    @property
    def degree(self) -> int:
        """The degree of the system in σ."""
        return max(degree(entry) for entries in (self.C, self.D) for entry in entries.values())

    @cached_property
    def determinant(self) -> dict[int, Expression]:
        """det C by powers of σ."""
        columns = sorted({name for row in self.leading for name in row})
        whole = {power: c for power, c in coefficients(determinant(self.leading, columns)).items() if not self.vanishing(c)}
        return dict(sorted(whole.items()))

    def in_states(self, row: EquationRow, beside: Iterable[Jet] = ()) -> EquationRow:
        """The same in terms of the states, and of what may stand beside them, up to a factor that vanishes for single σ at most."""
        return reduced_to(row, {*self.states, *beside}, self.rule, self.vanishing)

    def rule(self, at: Jet) -> EquationRow:
        """The row that finds this jet from lower ones."""
        (_, top), row = self.rules[at[0]]
        return differentiated(row, at[1] - top, self.vanishing)


def reduced_to(row: EquationRow, states: Set[Jet], rule_for: Callable[[Jet], EquationRow], vanishing: Vanishing) -> EquationRow:
    """A row in terms of the states alone, by rules of which each finds a jet from lower ones."""
    for _ in range(MOST_SUBSTITUTIONS):
        foreign = [at for at in row if at not in states]
        if not foreign:
            return row
        name, order = max(foreign, key=lambda at: at[1])
        rule = rule_for((name, order))
        pivot, x = rule[name, order], row[name, order]
        p, x = (number(1), x / pivot) if degree(pivot) == 0 else (pivot, x)
        row = combined([(p, row), (-x, rule)], vanishing)
        row.pop((name, order), None)
    raise InputError(f"a condition needs more than {MOST_SUBSTITUTIONS} substitutions: allowed are lower derivatives")


def first_order(system: System, vanishing: Vanishing, regular: Callable[[Expression], bool]) -> FirstOrder:
    """The reduction of a system as a first-order one. Raises InputError where there is none."""
    reduction: Reduction = reduced(system, vanishing, regular)
    tops = reduction.tops
    if sum(tops.values()) == 0:
        raise InputError("the equations hold no derivative that remains: they are no differential equations for the unknowns")
    names = [*(name for name in system.unknowns if name in tops), *(name for name in reduction.fluxes if name in tops)]
    states = tuple((name, k) for name in names for k in range(tops[name]))
    at = {state: i for i, state in enumerate(states)}
    C: ExpressionEntries = {(i, i): number(1) for (name, k), i in at.items() if k + 1 < tops[name]}
    D: ExpressionEntries = {(i, i + 1): number(1) for (name, k), i in at.items() if k + 1 < tops[name]}
    leading: list[dict[str, Expression]] = []
    ordered = _in_order(reduction, names, tops)
    leading_names = tuple(where for where, _ in ordered)
    for name, (_, row) in zip(names, ordered, strict=True):
        place = at[name, tops[name] - 1]
        leading.append({other: row[other, tops[other]] for other in names if (other, tops[other]) in row})
        for other, c in leading[-1].items():
            C[place, at[other, tops[other] - 1]] = c
        for jet, c in row.items():
            if jet[1] < tops[jet[0]]:
                D[place, at[jet]] = -c
    _free_of_sigma(C, D, vanishing, regular)
    rules = {jet[0]: (jet, row) for jet, row in (*reduction.rules, *_solved(reduction, names, tops))}
    return FirstOrder(states, C, D, rules, reduction.fluxes, tuple(reduction.factors), tuple(leading), leading_names, vanishing)


def _free_of_sigma(C: ExpressionEntries, D: ExpressionEntries, vanishing: Vanishing, regular: Callable[[Expression], bool]) -> None:
    """Subtract rows of C and D from others, multiplied by functions of z that have no zero and no pole, so that σ leaves rows of C.

    Where the terms with σ of one row of C are a multiple of another's, one row with σ does for both: det C is the same.
    """

    def moving(i: int) -> EquationRow:
        rows = ((j, {k: c for k, c in coefficients(entry).items() if k > 0}) for (row, j), entry in C.items() if row == i)
        return {("", j): sum((c * SIGMA**k for k, c in terms.items()), number(0)) for j, terms in rows if terms}

    rows = sorted({i for (i, _), entry in C.items() if degree(entry) > 0})
    for i in rows:
        own = moving(i)
        for r in rows:
            other = moving(r)
            if r == i or not own or own.keys() != other.keys():
                continue
            jet = next(iter(own))
            factor = quotient(other[jet], own[jet])
            if factor is None or degree(factor) > 0 or not regular(factor):
                continue
            if all(vanishing(other[at] - factor * own[at]) for at in own):
                for entries in (C, D):
                    for (_, j), entry in [item for item in entries.items() if item[0][0] == i]:
                        left = entries.pop((r, j), number(0)) - factor * entry
                        if not vanishing(left):
                            entries[r, j] = left


def _in_order(reduction: Reduction, names: list[str], tops: dict[str, int]) -> list[tuple[str, EquationRow]]:
    """The rows, with the names of the equations they came from, in the order of the unknowns whose highest derivatives they have.

    Where a number stands at that derivative the row is divided by it.
    """
    price = np.full((len(names), len(names)), NO_DERIVATIVE)
    for i, row in enumerate(reduction.rows):
        for j, name in enumerate(names):
            if (name, tops[name]) in row:
                c = row[name, tops[name]]
                price[j, i] = 0.0 if c.constant is not None else 1.0 + len(c.terms) + PRICE_OF_DEGREE * degree(c)
    _, chosen = linear_sum_assignment(price)
    out = []
    for name, i in zip(names, chosen, strict=True):
        row = reduction.rows[i]
        pivot = row.get((name, tops[name]), number(0)).constant
        out.append((reduction.names[i], {at: c / number(pivot) for at, c in row.items()} if pivot else row))
    return out


def _solved(reduction: Reduction, names: list[str], tops: dict[str, int]) -> list[tuple[Jet, EquationRow]]:
    """The rows combined so that each holds one of the highest derivatives only."""
    rows = [dict(row) for row in reduction.rows]
    left = list(range(len(rows)))
    found: list[tuple[Jet, int]] = []
    for _ in names:
        done = {jet for jet, _ in found}
        options = [
            (i, (name, tops[name])) for i in left for name in names if (name, tops[name]) in rows[i] and (name, tops[name]) not in done
        ]
        i, jet = min(
            options, key=lambda at: (rows[at[0]][at[1]].constant is None, degree(rows[at[0]][at[1]]), len(rows[at[0]][at[1]].terms))
        )
        for r in range(len(rows)):
            if r != i and jet in rows[r]:
                pivot, x = rows[i][jet], rows[r][jet]
                p, x = (number(1), x / pivot) if degree(pivot) == 0 else (pivot, x)
                rows[r] = combined([(p, rows[r]), (-x, rows[i])], reduction.vanishing)
                rows[r].pop(jet, None)
        left.remove(i)
        found.append((jet, i))
    return [(jet, rows[i]) for jet, i in found]
