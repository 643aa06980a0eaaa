"""What the names in a problem's formulas mean: unknowns, parameters, definitions, the coordinate, the eigenvalue, π."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from shootstab.core.errors import InputError, shortened
from shootstab.formulation.atoms import Atom
from shootstab.formulation.expression import FUNCTIONS, PI, Expression, Z, number, of_atom
from shootstab.formulation.grammar import read
from shootstab.formulation.system import SIGMA, EquationRow, jet, shown

LONGEST_SHOWN = 400  # chosen: characters of a formula that are shown
RESERVED = ("i", "I", "d", "pi", *FUNCTIONS)


@dataclass(frozen=True, eq=False)
class Names:
    """where holds formulas by name, which may use each other; given are functions of the coordinate that no formula defines."""

    unknowns: tuple[str, ...]
    parameters: Mapping[str, Any]
    where: Mapping[str, Any]
    eigenvalue: str = "sigma"
    variable: str = "z"
    given: Sequence[str] = ()
    _open: list[str] = field(default_factory=list, repr=False)
    _known: dict[str, Expression] = field(default_factory=dict, repr=False)

    def __post_init__(self) -> None:
        """Raises InputError for a name that cannot be one, or means two things."""
        seen: dict[str, str] = dict.fromkeys(RESERVED, "reserved")
        groups: list[tuple[str, Sequence[str]]] = [
            *(("unknown", self.unknowns), ("coordinate", [self.variable]), ("eigenvalue", [self.eigenvalue])),
            *(("parameter", list(self.parameters)), ("definition", list(self.where)), ("given function", self.given)),
        ]
        for kind, names in groups:
            for name in names:
                if not isinstance(name, str) or not name.isidentifier():
                    raise InputError(
                        f"the {kind} {shortened(name)}: allowed is a name of letters, digits and _, not beginning with a digit"
                    )
                if name in seen:
                    raise InputError(f"the name {name} is {seen[name]} and {_noun(kind)} too: allowed is one meaning")
                seen[name] = _noun(kind)
        for name, value in self.parameters.items():
            try:
                number(value)
            except InputError as error:
                raise InputError(f"the parameter {name}: {error}") from None
        if not self.unknowns:
            raise InputError("unknowns is empty: allowed is a list of one name or more")

    def expression(self, formula: Any, where: str) -> Expression:
        """What a formula means: text, a number, a SymPy expression. Raises InputError with the place."""
        if isinstance(formula, Expression):
            return formula
        if type(formula).__module__.startswith("sympy"):
            from shootstab.formulation.symbolic import converted

            return converted(formula, where, self.meaning, self.listed, self.variable)
        if isinstance(formula, int | float | complex) and not isinstance(formula, bool):
            return number(formula)
        return read(formula, where, self.meaning, self.listed)

    def meaning(self, name: str) -> Expression:
        """The expression of a name. Raises KeyError."""
        if name in self.unknowns:
            return jet(name)
        if name == self.eigenvalue:
            return SIGMA
        if name == self.variable:
            return Z
        if name == "pi":
            return PI
        if name in self.parameters:
            return number(self.parameters[name])
        if name in self.given:
            return of_atom(Atom("given", name))
        if name not in self.where:
            raise KeyError(name)
        if name not in self._known:
            if name in self._open:
                raise InputError(f"where: {' uses '.join([*self._open, name])}: allowed are definitions that do not use themselves")
            self._open.append(name)
            try:
                self._known[name] = self.expression(self.where[name], f"where {name}")
            finally:
                self._open.pop()
        return self._known[name]

    def text(self, expression: Expression) -> str:
        """A formula as it is shown: in the user's names, parameters by their values, cut where it is long."""
        theirs = {"sigma": self.eigenvalue, "z": self.variable}
        found = re.sub(r"\b(sigma|z)\b", lambda name: theirs[name.group()], str(expression))
        return found if len(found) <= LONGEST_SHOWN else found[:LONGEST_SHOWN] + " …"

    def row_text(self, row: EquationRow) -> str:
        """A row likewise, as a sum of coefficients times derivatives."""
        return " + ".join(f"({self.text(c)})*{shown(at)}" for at, c in sorted(row.items()))

    def listed(self) -> str:
        names = [*self.unknowns, *self.where, *self.given, *self.parameters, self.variable, self.eigenvalue, "pi", "i"]
        return ", ".join(names)


def _noun(kind: str) -> str:
    """The kind of a name with its article."""
    return {"eigenvalue": "the eigenvalue", "unknown": "an unknown"}.get(kind, f"a {kind}")
