"""Whether an expression vanishes identically.

Polynomials in z, 1/z, π, jets and the eigenvalue have one form only: they vanish where no term is left. With functions in them they are
evaluated at points of the complex plane without any property, near the domain of the problem, to EVALUATED digits, parameters that are
left open at such numbers too, since a term that vanishes for one value of them may not for others: a value below
10^−AGREEING of the sum of the sizes of its terms at each of them is zero. An analytic function other than zero that is so small at all of
these points does not come from a formula that somebody wrote down. Functions that are given, not
written, are tested in doubles at real points.
"""

from __future__ import annotations

import numpy as np

from shootstab.formulation.evaluation import Given, on_arrays, on_mpmath
from shootstab.formulation.expression import Expression

EVALUATED = 60  # chosen: digits of the evaluation
AGREEING = 40  # chosen: digits of it that agree where it vanishes
CLOSE_IN_DOUBLES = 1e-13  # chosen: the same where a function is given in doubles
PLACES = (0.3819660113 + 0.0618033989j, 0.7071067812 - 0.0440220341j)  # chosen: points along the domain and beside it, in its lengths
SIGMAS = (0.6180339887 + 0.4142135624j, -0.5772156649 + 0.2718281828j)  # chosen: one σ of no property for each of them
# kinds of factors that are independent of each other
SIMPLE = ("variable", "eigenvalue", "constant", "parameter", "jet")


class Vanishing:
    """The test on a domain from left to right, ends at infinity replaced by finite ones; or at a place, where both are the same."""

    def __init__(self, left: float, right: float, given: Given) -> None:
        self._left, self._right, self.given = left, right, given
        self._known: dict[Expression, bool] = {}

    def __call__(self, expression: Expression) -> bool:
        """Whether it is zero for every z and eigenvalue. Functions that are given to doubles only are tested as such."""
        if not expression.terms:
            return True
        alone = len(expression.terms) == 1 and not (self._left == self._right and self._held(expression))
        if alone or all(atom.kind in SIMPLE for monomial in expression.terms for atom, _ in monomial):
            return False
        if expression not in self._known:
            self._known[expression] = all(self._at(expression, *point) for point in zip(PLACES, SIGMAS, strict=True))
        return self._known[expression]

    def _at(self, expression: Expression, place: complex, sigma: complex) -> bool:
        if self._held(expression):
            return self._in_doubles(expression, place, sigma)
        import mpmath

        with mpmath.workdps(EVALUATED):
            z = mpmath.mpf(self._left) + mpmath.mpc(place) * (mpmath.mpf(self._right) - mpmath.mpf(self._left))
            opened = {atom: mpmath.mpc(sigma) * (2 + i) for i, atom in enumerate(a for a in expression.atoms() if a.kind == "parameter")}
            at = on_mpmath(z, self.given, mpmath.mpc(sigma), opened)
            terms = [at(Expression({monomial: c})) for monomial, c in expression.terms.items()]
            size = mpmath.fsum(abs(x) for x in terms)
            return bool(abs(mpmath.fsum(terms)) <= mpmath.mpf(10) ** -AGREEING * size)

    def _held(self, expression: Expression) -> bool:
        """Whether functions that are given are in it."""
        return any(atom.kind == "given" for atom in expression.atoms())

    def _in_doubles(self, expression: Expression, place: complex, sigma: complex) -> bool:
        """The test at real points, for functions that are given for real arrays only."""
        z = np.array([self._left + place.real * (self._right - self._left)])
        at = on_arrays(z, self.given, np.array([sigma]))
        terms = [complex(np.ravel(at(Expression({monomial: c})))[0]) for monomial, c in expression.terms.items()]
        return bool(abs(sum(terms)) <= CLOSE_IN_DOUBLES * sum(map(abs, terms)))
