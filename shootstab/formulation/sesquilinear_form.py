"""Sesquilinear forms Σ ∫ ū_i^{(p)} c(z) u_j^{(q)} dz of the unknowns on a real interval, and their real parts by integration by parts.

What multiplying equations by conjugates of unknowns and integrating gives. Two moves bring the real part of any such form to one that is
Hermitian at every z, and to terms at the ends:

    ∫ ū^{(p)} c v^{(q)} = [ū^{(p)} c v^{(q−1)}] − ∫ ū^{(p+1)} c v^{(q−1)} − ∫ ū^{(p)} c′ v^{(q−1)}   while q > p + 1,
    Re ∫ u* G u′ = ½[u* G_h u] − ½ ∫ u* G_h′ u + Re ∫ u* G_a u′,   G_h = (G + G*)/2,  G_a = (G − G*)/2.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from fractions import Fraction

from shootstab.formulation.expression import Expression, number
from shootstab.formulation.gaussian import Gaussian
from shootstab.formulation.system import Jet
from shootstab.formulation.vanishing import Vanishing

Form = dict[tuple[Jet, Jet], Expression]  # coefficients by the conjugated factor and the other one

HALF = number(Fraction(1, 2))  # exact


class NotRealError(ValueError):
    """A coefficient holds a function of a complex argument, whose conjugate is not written down."""


@dataclass(frozen=True, eq=False)
class RealPart:
    """The real part of a form: entries, Hermitian at every real z, and what stands at the right end less what stands at the left one."""

    entries: Form
    at_ends: Form


def conjugated(expression: Expression) -> Expression:
    """The conjugate on the real axis, where every function in it is real. Raises NotRealError where an argument is not."""
    if any(c.im for atom in expression.atoms() if atom.argument is not None for c in atom.argument.terms.values()):
        raise NotRealError
    return Expression({monomial: Gaussian(c.re, -c.im) for monomial, c in expression.terms.items()})


def added(forms: Iterable[Form], vanishing: Vanishing) -> Form:
    """The sum of the forms, without the entries that vanish."""
    total: Form = {}
    for form in forms:
        for at, c in form.items():
            total[at] = total[at] + c if at in total else c
    return {at: c for at, c in total.items() if not vanishing(c)}


def scaled(form: Form, factor: Expression) -> Form:
    """The form times a function of z."""
    return {at: factor * c for at, c in form.items()}


def adjoint(form: Form) -> Form:
    """The form whose value is the conjugate."""
    return {(v, u): conjugated(c) for (u, v), c in form.items()}


def real_part(form: Form, vanishing: Vanishing) -> RealPart:
    """See the head of this file. The derivatives in the form must not be of lower order than those of the conjugated factors."""
    balanced, at_ends = _balanced(form)
    entries: list[Form] = []
    orders = sorted({order for ((_, order), _) in balanced})
    for p in orders:
        same = {at: c for at, c in balanced.items() if at[0][1] == at[1][1] == p}
        entries += [scaled(same, HALF), scaled(adjoint(same), HALF)]
        G = {(i, j): c for ((i, order), (j, q)), c in balanced.items() if order == p and q == p + 1}
        mirrored = {(j, i): conjugated(c) for (i, j), c in G.items()}
        for sign, part in ((1, G), (-1, mirrored)):
            for (i, j), c in part.items():
                hermitian = HALF * c  # G_h is the sum over both parts
                at_ends.append({((i, p), (j, p)): HALF * hermitian})
                entries.append({((i, p), (j, p)): -(HALF * hermitian.derivative())})
                skew = hermitian if sign > 0 else -hermitian
                entries.append({((i, p), (j, p + 1)): HALF * skew})
                entries.append({((j, p + 1), (i, p)): HALF * conjugated(skew)})
    return RealPart(added(entries, vanishing), added(at_ends, vanishing))


def _balanced(form: Form) -> tuple[Form, list[Form]]:
    """The form with orders that differ by one at most, and the terms at the ends that this gives."""
    left, at_ends = list(form.items()), []
    balanced: Form = {}
    while left:
        ((i, p), (j, q)), c = left.pop()
        if q <= p + 1:
            at = ((i, p), (j, q))
            balanced[at] = balanced[at] + c if at in balanced else c
            continue
        at_ends.append({((i, p), (j, q - 1)): c})
        left += [(((i, p + 1), (j, q - 1)), -c), (((i, p), (j, q - 1)), -c.derivative())]
    return balanced, at_ends
