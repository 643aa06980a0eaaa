"""The reduction of equations of any order to a first-order system, by row reduction over the ring of differential operators.

Let c_j be the highest derivative of the unknown u_j, and g_i the gap of equation i: the largest g such that its g-th derivative holds no
higher derivatives than these. L_ij is the coefficient of u_j^{(c_j)} in that derivative, a function of z and σ. Three steps, repeated:

    L singular          a combination λᵀ of its rows vanishes, and Σ λ_i d^{g_i − g_k} (row i) takes the place of a row k with the
                        smallest gap: its gap grows. Where nothing is left of it the equations are dependent.
    some g_i > 0        row i, a constraint on the derivatives below the highest, and its derivatives remove u_j^{(c_j − g_i)} and higher
                        ones from the other rows: c_j falls by g_i.
    some c_j = 0        u_j is found from one row and removed from the others.

At the end L u^{(c)} + lower derivatives = 0 with L nonsingular for almost every z and σ, and the order is n = Σ c_j. The second
step does not change Σ c_j − Σ g_i. Instead of dividing by a coefficient that holds σ, or that is one of several in its row, fluxes become
unknowns: with q_i = Σ_j L_ij u_j^{(c_j − 1)} row i starts with q_i′, and c_j falls by 1.

Source: the idea of row-reduced matrices, T. Kailath, Linear Systems (1980), 6.3, here with coefficients that depend on z.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace

from shootstab.core.errors import InputError
from shootstab.formulation.expression import Expression, number, quotient
from shootstab.formulation.linear_algebra import left_null_vector
from shootstab.formulation.system import EquationRow, Jet, System, combined, degree, differentiated, orders
from shootstab.formulation.vanishing import Vanishing

MOST_REDUCTIONS = 400  # chosen: steps of a reduction, more than any needs


@dataclass
class Reduction:
    """The rows as they change. regular(expression) says whether a function of z has no zero on the domain.

    rules are relations that hold beside the rows: pivot · jet = expression in lower jets, for what was removed, newest last. names are
    those of the equations that a row came from; factors what rows were multiplied by that may vanish, with the equation.
    """

    rows: list[EquationRow]
    names: list[str]
    vanishing: Vanishing
    regular: Callable[[Expression], bool]
    rules: list[tuple[Jet, EquationRow]] = field(default_factory=list)
    fluxes: dict[str, EquationRow] = field(default_factory=dict)
    factors: list[tuple[Expression, str]] = field(default_factory=list)

    def run(self) -> None:
        """Reduce to the end. Raises InputError for equations that are dependent, or determine nothing."""
        for _ in range(MOST_REDUCTIONS):
            if not self._step():
                return
        raise InputError(f"the equations {', '.join(self.names)} cannot be brought to first order in {MOST_REDUCTIONS} steps")

    @property
    def tops(self) -> dict[str, int]:
        """c_j."""
        return orders(self.rows)

    def gaps(self) -> list[int]:
        """g_i."""
        c = self.tops
        return [min(c[name] - order for name, order in row) for row in self.rows]

    def leading(self) -> list[dict[str, Expression]]:
        """L, row by row."""
        c = self.tops
        return [
            {name: e for (name, order), e in row.items() if order == c[name] - g} for row, g in zip(self.rows, self.gaps(), strict=True)
        ]

    def _step(self) -> bool:
        """Whether there was anything to do."""
        if self._settled_zero_orders():
            return True
        L, g = self.leading(), self.gaps()
        null = left_null_vector(L, sorted(self.tops), self.vanishing)
        if null is not None:
            self._lower_a_row(null, g)
            return True
        if any(g):
            self._use_a_constraint(L, g)
            return True
        return self._removed_undifferentiated(last=True)

    def _settled_zero_orders(self) -> bool:
        """Unknowns without derivatives go first where a number multiplies them: that is no more than putting in what they are."""
        return self._removed_undifferentiated(last=False)

    # L singular

    def _lower_a_row(self, null: dict[int, Expression], g: list[int]) -> None:
        lowest = min(g[i] for i in null)
        candidates = [i for i in null if g[i] == lowest]
        k = min(candidates, key=lambda i: (_cost(null[i], self.regular), -_size(self.rows[i]), i))
        divisor = null[k] if degree(null[k]) == 0 and self.regular(null[k]) else number(1)
        terms = [(x / divisor, differentiated(self.rows[i], g[i] - lowest, self.vanishing)) for i, x in null.items()]
        row = combined(terms, self.vanishing)
        involved = ", ".join(self.names[i] for i in sorted(null))
        if not row:
            raise InputError(f"{involved} are dependent, one follows from the others: allowed are equations that determine the unknowns")
        if divisor == number(1) and null[k].constant is None:
            self.factors.append((null[k], self.names[k]))
        self.rows[k] = self._without_factors(row)

    # gaps

    def _use_a_constraint(self, L: list[dict[str, Expression]], g: list[int]) -> None:
        options = [(i, name) for i in range(len(L)) if g[i] > 0 for name in L[i]]
        alone = [(i, name) for i, name in options if len(L[i]) == 1]
        for among, worst in ((alone, 1), (None, 0), (options, 1), (options, 3)):
            if among is None:
                if self._took_fluxes(L, g):
                    return
                continue
            best = min(among, key=lambda at: (_cost(L[at[0]][at[1]], self.regular), g[at[0]], _size(self.rows[at[0]])), default=None)
            if best is not None and _cost(L[best[0]][best[1]], self.regular) <= worst:
                i, name = best
                self._eliminate(i, (name, self.tops[name] - g[i]))
                return

    def _eliminate(self, e: int, at: Jet) -> None:
        """Row e removes u^{(k)} and its derivatives from the other rows."""
        name, k = at
        for i in range(len(self.rows)):
            if i != e:
                for order in range(orders([self.rows[i]]).get(name, -1), k - 1, -1):
                    if (name, order) in self.rows[i]:
                        self._subtract(i, e, order - k, (name, order), at)

    def _subtract(self, i: int, e: int, times: int, target: Jet, at: Jet) -> None:
        """Row i ← p·(row i) − x·d^times (row e), p = 1 where the pivot may be divided by."""
        pivot, x = self.rows[e][at], self.rows[i][target]
        if degree(pivot) == 0 and self.regular(pivot):
            p, x = number(1), x / pivot
        else:
            p = pivot
            self.factors.append((pivot, self.names[i]))
        row = combined([(p, self.rows[i]), (-x, differentiated(self.rows[e], times, self.vanishing))], self.vanishing)
        row.pop(target, None)
        if not row:
            raise InputError(f"{self.names[i]} follows from the other equations: allowed are equations that determine the unknowns")
        self.rows[i] = self._without_factors(row)

    def _took_fluxes(self, L: list[dict[str, Expression]], g: list[int]) -> bool:
        """Whether fluxes could become unknowns, for a constraint with gap 1, so that gaps shrink and the order stays what it is."""
        c = self.tops
        for e in (i for i in range(len(L)) if g[i] == 1):
            trial = replace(self, rows=list(self.rows), names=list(self.names), fluxes=dict(self.fluxes))
            for i, row in enumerate(self.rows):
                columns = [name for name in sorted(L[e]) if (name, c[name]) in row]
                if columns:
                    trial._flux(i, columns, c)
            after = trial.gaps()
            if sum(after) < sum(g) and sum(trial.tops.values()) - sum(after) == sum(c.values()) - sum(g):
                self.rows, self.names, self.fluxes = trial.rows, trial.names, trial.fluxes
                return True
        return False

    def _flux(self, i: int, columns: list[str], c: dict[str, int]) -> None:
        """q = Σ L_ij u_j^{(c_j − 1)}: row i starts with q′."""
        row = dict(self.rows[i])
        weights = {name: row.pop((name, c[name])) for name in columns}
        whole = number(1)
        if len(columns) == 1 and weights[columns[0]].constant is not None:
            whole, weights = weights[columns[0]], {columns[0]: number(1)}
        flux = f"q{len(self.fluxes) + 1}"
        self.fluxes[flux] = {(name, c[name] - 1): w for name, w in weights.items()}
        change: EquationRow = {(flux, 1): number(1), **{(name, c[name] - 1): -w.derivative() for name, w in weights.items()}}
        self.rows[i] = combined([(number(1), row), (whole, change)], self.vanishing)
        self.rows.append({(flux, 0): number(-1), **self.fluxes[flux]})
        self.names.append(f"the flux in {self.names[i]}")

    # unknowns without derivatives

    def _removed_undifferentiated(self, last: bool) -> bool:
        """One of them, where there is one; before the end only by a number, and from a row with no more than it must have."""
        c = self.tops
        options = [(i, name) for i, row in enumerate(self.rows) for name in c if c[name] == 0 and (name, 0) in row]
        if not options or len(self.rows) == 1:
            return False
        i, name = min(options, key=lambda at: (_cost(self.rows[at[0]][at[1], 0], self.regular), self._rise(*at), _size(self.rows[at[0]])))
        if not last and (_cost(self.rows[i][name, 0], self.regular) > 0 or self._rise(i, name) > 0):
            return False
        self._eliminate(i, (name, 0))
        self.rules.append(((name, 0), self.rows.pop(i)))
        self.names.pop(i)
        return True

    def _rise(self, e: int, name: str) -> int:
        """The rise of the orders of the others if row e removed this unknown."""
        others = [row for i, row in enumerate(self.rows) if i != e]
        if not any((name, 0) in row for row in others):
            return 0
        c = orders(others)
        return sum(max(0, order - c.get(other, 0)) for other, order in orders([self.rows[e]]).items() if other != name)

    def _without_factors(self, row: EquationRow) -> EquationRow:
        """The row divided by what rows were multiplied by, where that comes out."""
        for factor, _ in self.factors:
            if degree(factor):
                divided = {at: quotient(c, factor) for at, c in row.items()}
                if all(c is not None for c in divided.values()):
                    row = {at: c for at, c in divided.items() if c is not None}
        return row


def _cost(pivot: Expression, regular: Callable[[Expression], bool]) -> int:
    """0 for a number, 1 for a function of z without zeros, 2 for one with zeros, 3 where σ is in it."""
    if pivot.constant is not None:
        return 0
    if degree(pivot):
        return 3
    return 1 if regular(pivot) else 2


def _size(row: EquationRow) -> int:
    return sum(len(c.terms) for c in row.values())


def reduced(system: System, vanishing: Vanishing, regular: Callable[[Expression], bool]) -> Reduction:
    """The reduction of a system, done. Raises InputError."""
    reduction = Reduction([dict(row) for row in system.rows], list(system.names), vanishing, regular)
    reduction.rows = [combined([(number(1), row)], vanishing) for row in reduction.rows]
    reduction.run()
    return reduction
