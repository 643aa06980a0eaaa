"""Elementary functions of series that are known only as far as they have been computed, each by its differential equation.

u = f(a) has u′ = g a′ with g made of u and of functions that are known, so that m u_m = Σ_{j=1}^m j a_j g_{m−j} asks for g below m:

    exp g = u     log g = 1/a     tanh g = 1 − u²     tan g = 1 + u²     sech g = −u tanh a     erf g = 2 π^{−1/2} e^{−a²}
    sin g = cos a, cos g = −sin a     sinh g = cosh a, cosh g = sinh a
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

from shootstab.multiprecision.relaxed_series import RelaxedSeries, RelaxedSystem


@dataclass(frozen=True, eq=False)
class RelaxedFunctions:
    """seed(name, x) is the function of a number, seed('pi', 0) is π; root(x, e) a number's power, exponent(e) an exponent as a number."""

    system: RelaxedSystem
    seed: Callable[[str, Any], Any]
    root: Callable[[Any, Fraction], Any]
    exponent: Callable[[Fraction], Any]

    def apply(self, name: str, a: RelaxedSeries) -> RelaxedSeries:
        """One of expression.FUNCTIONS of the series a."""
        slopes: dict[str, Callable[[RelaxedSeries], RelaxedSeries]] = {
            "exp": lambda u: u,
            "log": lambda u: 1 / a,
            "tanh": lambda u: 1 - u * u,
            "tan": lambda u: 1 + u * u,
            "sech": lambda u: -(u * self.apply("tanh", a)),
            "erf": lambda u: self.apply("exp", -(a * a)) * (2 / self.root(self.seed("pi", 0), Fraction(1, 2))),
            "sin": lambda u: self._solution("cos", a, lambda v: -u),
            "sinh": lambda u: self._solution("cosh", a, lambda v: u),
        }
        if name == "sqrt":
            return a**0.5
        if name in ("cos", "cosh"):
            self.apply("sin" if name == "cos" else "sinh", a)  # its pair makes it too
            return self._solution(name, a, lambda v: v)
        return self._solution(name, a, slopes[name])

    def power(self, a: RelaxedSeries, exponent: Fraction) -> Any:
        """a^e for an exponent that is no natural number."""
        if exponent.denominator == 1:
            return 1 / a ** -int(exponent)
        if exponent == Fraction(1, 2):
            return a**0.5
        return a ** self.exponent(exponent)

    def _solution(self, name: str, a: RelaxedSeries, slope: Callable[[RelaxedSeries], RelaxedSeries]) -> RelaxedSeries:
        """The node of f(a). The slope is looked for where the node is new; there it is made of nodes that come later."""
        later: list[RelaxedSeries] = []
        dot = self.system.arithmetic.dot

        def term(m: int, c: list[Any]) -> Any:
            if m == 0:
                return self.seed(name, a.coefficients[0])
            weighted = [j * x for j, x in enumerate(a.coefficients[1 : m + 1], 1)]
            return dot(weighted, later[0].coefficients[m - 1 :: -1]) / m

        known = len(self.system)
        node = self.system.node((name, id(a)), term, a)
        if len(self.system) > known:
            later.append(slope(node))
        return node
