"""Something else in place of an atom."""

from __future__ import annotations

from shootstab.formulation.atoms import Atom
from shootstab.formulation.expression import Expression, function, number, of_atom
from shootstab.formulation.gaussian import ONE


def substituted(expression: Expression, atom: Atom, value: Expression) -> Expression:
    """The expression with a value in place of an atom, in arguments too."""
    if value == of_atom(atom):
        return expression
    total = number(0)
    for monomial, c in expression.terms.items():
        product = Expression({(): c})
        for factor, e in monomial:
            if factor == atom:
                product = product * value**e
            elif factor.argument is not None and atom in factor.argument.atoms():
                inner = substituted(factor.argument, atom, value)
                product = product * (inner**e if factor.kind == "base" else function(factor.name, inner) ** e)
            else:
                product = product * Expression({((factor, e),): ONE})
        total = total + product
    return total
