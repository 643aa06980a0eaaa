"""Elementary functions of a power series, by the differential equations that they satisfy: O(N²) operations for N terms.

A series is the list of its coefficients; a_m′ stands for m a_m, the coefficients of x a′. With c = f(a):

    exp     m c_m = Σ j a_j c_{m−j}                     log     m a_0 c_m = m a_m − Σ_{0<j<m} j c_j a_{m−j}
    a^e     m a_0 c_m = Σ (e j − (m − j)) a_j c_{m−j}   erf     m c_m from c′ = 2 π^{−1/2} e^{−a²} a′
    sin, cos; sinh, cosh; tanh, sech (t′ = s² a′, s′ = −s t a′); tan (t′ = (1 + t²) a′): pairs, one from the other
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

Numbers = list[Any]


@dataclass(frozen=True, eq=False)
class SeriesFunctions:
    """dot(a, b) is Σ a_j b_j; seed(name, x) the function of a number, and seed('pi', 0) is π; root(x, e) a number's power."""

    dot: Callable[[Sequence[Any], Sequence[Any]], Any]
    seed: Callable[[str, Any], Any]
    root: Callable[[Any, Fraction], Any]

    def apply(self, name: str, a: Numbers) -> Numbers:
        """One of expression.FUNCTIONS of the series a."""
        if name == "sqrt":
            return self.power(a, Fraction(1, 2))
        if name in ("sin", "cos", "sinh", "cosh"):
            return self._pair(a, *(("sin", "cos", -1) if name in ("sin", "cos") else ("sinh", "cosh", 1)))[name in ("cos", "cosh")]
        if name in ("tanh", "sech"):
            return self._tanh_sech(a)[name == "sech"]
        return {"exp": self._exp, "log": self._log, "tan": self._tan, "erf": self._erf}[name](a)

    def power(self, a: Numbers, exponent: Fraction) -> Numbers:
        """a^e; a_0 may not be zero."""
        if exponent.denominator == 1 and exponent < 0:
            return self._reciprocal(natural_power(a, -int(exponent), self.product))
        c = [self.root(a[0], exponent)]
        p, q = exponent.numerator, exponent.denominator
        weighted = _slopes(a)
        for m in range(1, len(a)):
            back = c[m - 1 :: -1]
            total = (p + q) * self.dot(weighted[1 : m + 1], back) - q * m * self.dot(a[1 : m + 1], back)
            c.append(total / (q * m * a[0]))
        return c

    def _reciprocal(self, a: Numbers) -> Numbers:
        c = [1 / a[0]]
        for m in range(1, len(a)):
            c.append(-self.dot(a[1 : m + 1], c[m - 1 :: -1]) / a[0])
        return c

    def product(self, a: Numbers, b: Numbers) -> Numbers:
        """a b."""
        return [self.dot(a[: m + 1], b[m::-1]) for m in range(len(a))]

    def _exp(self, a: Numbers) -> Numbers:
        c, slopes = [self.seed("exp", a[0])], _slopes(a)
        for m in range(1, len(a)):
            c.append(self.dot(slopes[1 : m + 1], c[m - 1 :: -1]) / m)
        return c

    def _log(self, a: Numbers) -> Numbers:
        c, slopes = [self.seed("log", a[0])], [0 * a[0]]
        for m in range(1, len(a)):
            slopes.append((m * a[m] - self.dot(slopes[1:m], a[m - 1 : 0 : -1])) / a[0] if m > 1 else a[1] / a[0])
            c.append(slopes[m] / m)
        return c

    def _pair(self, a: Numbers, odd: str, even: str, sign: int) -> tuple[Numbers, Numbers]:
        s, c, slopes = [self.seed(odd, a[0])], [self.seed(even, a[0])], _slopes(a)
        for m in range(1, len(a)):
            both = [self.dot(slopes[1 : m + 1], x[m - 1 :: -1]) / m for x in (c, s)]
            s.append(both[0])
            c.append(sign * both[1])
        return s, c

    def _tanh_sech(self, a: Numbers) -> tuple[Numbers, Numbers]:
        t, s = [self.seed("tanh", a[0])], [self.seed("sech", a[0])]
        slopes, ss, st = _slopes(a), [], []
        for m in range(1, len(a)):
            ss.append(self.dot(s, s[::-1]))
            st.append(self.dot(s, t[::-1]))
            t.append(self.dot(slopes[1 : m + 1], ss[::-1]) / m)
            s.append(-self.dot(slopes[1 : m + 1], st[::-1]) / m)
        return t, s

    def _tan(self, a: Numbers) -> Numbers:
        t, slopes, squares = [self.seed("tan", a[0])], _slopes(a), []
        for m in range(1, len(a)):
            square = self.dot(t, t[::-1])
            squares.append(1 + square if m == 1 else square)
            t.append(self.dot(slopes[1 : m + 1], squares[::-1]) / m)
        return t

    def _erf(self, a: Numbers) -> Numbers:
        bell = self._exp([-x for x in self.product(a, a)])
        factor = 2 / self.root(self.seed("pi", a[0]), Fraction(1, 2))
        slopes = _slopes(a)
        return [self.seed("erf", a[0])] + [factor * self.dot(slopes[1 : m + 1], bell[m - 1 :: -1]) / m for m in range(1, len(a))]


def natural_power(x: Any, n: int, product: Callable[[Any, Any], Any]) -> Any:
    """xⁿ, n ≥ 1, by at most 2 log₂ n products: x may be a series that begins with zero, and n as large as a file says."""
    result = x
    for bit in bin(n)[3:]:
        result = product(result, result)
        result = product(result, x) if bit == "1" else result
    return result


def _slopes(a: Numbers) -> Numbers:
    return [j * x for j, x in enumerate(a)]
