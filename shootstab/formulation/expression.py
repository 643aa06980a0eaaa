"""Expressions: sums of products of powers of atoms, with exact coefficients; every formula of a problem is one.

A monomial is a product of atoms with exponents, an `Expression` a sum of monomials with Gaussian rationals in front. Atoms are z, the
eigenvalue, π, jets (the derivatives of an unknown), functions of expressions, functions that are given otherwise (a base flow), and
expressions as bases of powers that cannot be multiplied out, such as (1 + z²)⁻¹. Sums are multiplied out, so that what cancels is gone
and polynomials in z, 1/z, π and the eigenvalue have one form only. Relations between functions (sin² + cos² = 1) are not known here: see
vanishing.py.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterable, Iterator
from fractions import Fraction
from typing import Any

from shootstab.core.errors import InputError
from shootstab.formulation.atoms import Atom, Exponent
from shootstab.formulation.gaussian import ONE, Gaussian

MOST_MONOMIALS = 4000  # chosen: monomials that a power of a sum is multiplied out to at most


Monomial = tuple[tuple[Atom, Exponent], ...]


class Expression:
    """Σ coefficient · monomial; immutable."""

    __slots__ = ("_key", "terms")

    def __init__(self, terms: dict[Monomial, Gaussian]) -> None:
        """terms without zero coefficients."""
        self.terms = terms
        self._key: str | None = None

    @property
    def key(self) -> str:
        """What tells it from any other."""
        if self._key is None:
            parts = sorted(f"{c.re},{c.im}*" + "*".join(f"{a.key}^{e}" for a, e in m) for m, c in self.terms.items())
            self._key = "[" + "+".join(parts) + "]"
        return self._key

    def __bool__(self) -> bool:
        return bool(self.terms)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Expression) and self.terms == other.terms

    def __hash__(self) -> int:
        return hash(self.key)

    def __neg__(self) -> Expression:
        return Expression({m: -c for m, c in self.terms.items()})

    def __add__(self, other: Expression) -> Expression:
        terms = dict(self.terms)
        _accumulate(terms, other.terms.items())
        return Expression(terms)

    def __sub__(self, other: Expression) -> Expression:
        return self + (-other)

    def __mul__(self, other: Expression) -> Expression:
        terms: dict[Monomial, Gaussian] = {}
        for (m, c), (n, d) in itertools.product(self.terms.items(), other.terms.items()):
            product = _product(m, n)
            if isinstance(product, Expression):
                _accumulate(terms, ((k, c * d * x) for k, x in product.terms.items()))
            else:
                _accumulate(terms, ((product, c * d),))
        return Expression(terms)

    def __truediv__(self, other: Expression) -> Expression:
        """Exact where other divides it. Raises ZeroDivisionError for a divisor without terms."""
        if len(other.terms) > 1:
            found = quotient(self, other)
            if found is not None:
                return found
        return self * other**-1

    def __pow__(self, exponent: Exponent) -> Expression:
        """Natural powers multiplied out, others as powers of a base. Raises InputError where that grows too long."""
        if exponent == 0:
            return number(1)
        if len(self.terms) == 1 and Fraction(exponent).denominator == 1:
            ((monomial, c),) = self.terms.items()
            result = Expression({(): c.power(int(exponent))})
            for atom, e in monomial:
                result = result * _power_of(atom, e * exponent)
            return result
        if not self.terms:
            if exponent < 0:
                raise ZeroDivisionError
            return self
        if Fraction(exponent).denominator == 1 and exponent < 0:
            common = min(dict(monomial).get(VARIABLE, 0) for monomial in self.terms)
            if common:  # z alone is a factor of its own: poles at 0 are seen
                return Z ** (common * exponent) * (self * Z**-common) ** exponent
        if Fraction(exponent).denominator == 1 and exponent > 0:
            if len(self.terms) ** min(int(exponent), MOST_MONOMIALS) > MOST_MONOMIALS:
                told = f"a sum of {len(self.terms)} terms to the power {exponent} is too long to be multiplied out"
                raise InputError(f"{told}: allowed are up to {MOST_MONOMIALS} products")
            half = self ** (int(exponent) // 2)
            return half * half * self if int(exponent) % 2 else half * half
        return _root(self, exponent)

    def derivative(self) -> Expression:
        """d/dz."""
        total = number(0)
        for monomial, c in self.terms.items():
            for i, (atom, e) in enumerate(monomial):
                inner = slope(atom)
                if inner:
                    rest = Expression({monomial[:i] + monomial[i + 1 :]: c * Gaussian(e)})
                    total = total + rest * _power_of(atom, e - 1) * inner
        return total

    def atoms(self) -> set[Atom]:
        """All in it, those of arguments included."""
        found: set[Atom] = set()
        for monomial in self.terms:
            for atom, _ in monomial:
                if atom not in found:
                    found.add(atom)
                    if atom.argument is not None:
                        found |= atom.argument.atoms()
        return found

    def __str__(self) -> str:
        return " + ".join(_shown(m, c) for m, c in self.terms.items()).replace("+ -", "- ") or "0"

    def collected(self, wanted: Callable[[Atom], bool]) -> Iterator[tuple[Monomial, Expression]]:
        """The sums that multiply each product of the wanted atoms."""
        parts: dict[Monomial, dict[Monomial, Gaussian]] = {}
        for monomial, c in self.terms.items():
            outer = tuple(x for x in monomial if wanted(x[0]))
            parts.setdefault(outer, {})[tuple(x for x in monomial if not wanted(x[0]))] = c
        for outer, terms in parts.items():
            yield outer, Expression(terms)

    @property
    def constant(self) -> Gaussian | None:
        """The value of an expression that is a number, else None."""
        if not self.terms:
            return Gaussian(0)
        return self.terms.get(()) if len(self.terms) == 1 else None


def held_kinds(*expressions: Expression) -> set[str]:
    """The kinds of all atoms in them, those of arguments included."""
    return {atom.kind for expression in expressions for atom in expression.atoms()}


def number(x: Any) -> Expression:
    """A number, exactly."""
    value = Gaussian.of(x)
    return Expression({(): value} if value else {})


def of_atom(atom: Atom) -> Expression:
    """An atom alone."""
    return Expression({((atom, 1),): ONE})


def function(name: str, argument: Expression) -> Expression:
    """One of FUNCTIONS of an expression; at 0 its value."""
    if not argument and name in AT_ZERO:
        return number(AT_ZERO[name])
    return of_atom(Atom("function", name, 0, argument))


VARIABLE = Atom("variable", "z")
Z = of_atom(VARIABLE)
PI = of_atom(Atom("constant", "pi"))

AT_ZERO = {"exp": 1, "sin": 0, "cos": 1, "tan": 0, "sinh": 0, "cosh": 1, "tanh": 0, "sech": 1, "erf": 0}
SLOPES: dict[str, Callable[[Expression], Expression]] = {
    "exp": lambda a: function("exp", a),
    "log": lambda a: a**-1,
    "sin": lambda a: function("cos", a),
    "cos": lambda a: -function("sin", a),
    "tan": lambda a: number(1) + function("tan", a) ** 2,
    "sinh": lambda a: function("cosh", a),
    "cosh": lambda a: function("sinh", a),
    "tanh": lambda a: function("sech", a) ** 2,
    "sech": lambda a: -function("sech", a) * function("tanh", a),
    "erf": lambda a: number(2) * PI ** Fraction(-1, 2) * function("exp", -(a**2)),
}
FUNCTIONS = (*SLOPES, "sqrt")


def slope(atom: Atom) -> Expression:
    """d/dz of an atom."""
    if atom.kind == "variable":
        return number(1)
    if atom.kind in ("jet", "given"):
        return of_atom(Atom(atom.kind, atom.name, atom.order + 1))
    if atom.argument is None:
        return number(0)
    argument: Expression = atom.argument
    inner = argument.derivative()
    if atom.kind == "base" or not inner:
        return inner
    return SLOPES[atom.name](argument) * inner


def quotient(a: Expression, b: Expression) -> Expression | None:
    """a/b where b divides a, by leading monomials; None where that does not come out, and where the eigenvalue is left below."""
    order = sorted({atom for e in (a, b) for m in e.terms for atom, _ in m}, key=lambda atom: (atom.kind != "eigenvalue", atom.key))

    def rank(monomial: Monomial) -> list[Exponent]:
        powers = dict(monomial)
        return [powers.get(atom, 0) for atom in order]

    first = max(b.terms, key=rank)
    inverse = Expression({first: b.terms[first]}) ** -1
    result, rest = number(0), a
    for _ in range(4 * len(a.terms) + 4):
        if not rest:
            return None if any(atom.kind == "eigenvalue" and e < 0 for m in result.terms for atom, e in m) else result
        top = max(rest.terms, key=rank)
        term = Expression({top: rest.terms[top]}) * inverse
        result, rest = result + term, rest - term * b
    return None


def _accumulate(terms: dict[Monomial, Gaussian], more: Iterable[tuple[Monomial, Gaussian]]) -> None:
    for monomial, c in more:
        total = terms[monomial] + c if monomial in terms else c
        if total:
            terms[monomial] = total
        else:
            terms.pop(monomial, None)


def _product(m: Monomial, n: Monomial) -> Monomial | Expression:
    """A sum where the base of a power comes to a natural power again."""
    if not m or not n:
        return m or n
    powers = dict(m)
    whole = None
    for atom, e in n:
        total = powers.pop(atom, 0) + e
        if total == 0:
            continue
        if atom.kind == "base" and total > 0 and Fraction(total).denominator == 1:
            expanded = _power_of(atom, int(total))
            whole = expanded if whole is None else whole * expanded
        else:
            powers[atom] = total
    monomial = tuple(sorted(powers.items()))
    return monomial if whole is None else whole * Expression({monomial: ONE})


def _power_of(atom: Atom, exponent: Exponent) -> Expression:
    if exponent == 0:
        return number(1)
    if atom.kind == "base" and atom.argument is not None and Fraction(exponent).denominator == 1 and exponent > 0:
        base: Expression = atom.argument
        return base ** int(exponent)
    return Expression({((atom, exponent),): ONE})


def _root(base: Expression, exponent: Exponent) -> Expression:
    """A power that stays one. Powers of integers are taken where they come out; bases have the coefficient 1 in front where they can."""
    c = base.constant
    if c is not None and not c.im and c.re > 0:
        root = Fraction(c.re)
        e = Fraction(exponent)
        parts = [round(x ** (1 / e.denominator)) for x in (root.numerator, root.denominator)]
        if parts[0] ** e.denominator == root.numerator and parts[1] ** e.denominator == root.denominator:
            return Expression({(): Gaussian(Fraction(*parts)).power(e.numerator)})
    return Expression({((Atom("base", "", 0, base), exponent),): ONE})


def _shown(monomial: Monomial, c: Gaussian) -> str:
    factors = [str(a) if e == 1 else f"{a}**{e if e > 0 and Fraction(e).denominator == 1 else f'({e})'}" for a, e in monomial]
    if factors and c in (ONE, -ONE):
        return ("" if c == ONE else "-") + "*".join(factors)
    return "*".join([str(c), *factors])
