"""Power series on |t| ≤ 1 with rigorous tails: N balls and a bound on the ℓ¹ norm of every coefficient behind them.

A `TailedSeries` (c_0, …, c_{N−1}; τ) stands for every f(t) = Σ_m f_m t^m with f_m ∈ c_m for m < N and Σ_{m≥N} |f_m| ≤ τ. The set is closed
under the operations below, each of which encloses the exact result (theory, lemma E1). With ‖·‖ the ℓ¹ norm, b = b_0 (1 + u),
s = max(1, |r|) and R = Σ_{k<N} |c_k| Σ_{j≥N−k} |u_j|:

    a b      Σ_{j+k≥N} |a_j||b_k| + τ_a ‖b‖ + τ_b ‖a‖ + τ_a τ_b
    a/b      (τ_a/|b_0| + R)/(1 − ‖u‖)                                   from c_m = a_m/b_0 − Σ_j u_j c_{m−j}
    b^r      s R/(1 − s ‖u‖)                                             from c_m = Σ_j ((r + 1) j/m − 1) u_j c_{m−j}
    exp a    R/(1 − ‖u‖), u = a − a_0                                    from m c_m = Σ_j j u_j c_{m−j}
    ln b     ((τ_u + R)/(1 − ‖u‖))                                       from c_m = u_m − Σ_j (1 − j/m) u_j c_{m−j}

A tail that these inequalities cannot bound, ‖u‖ ≥ 1 or s ‖u‖ ≥ 1, is infinite: the step is too long, and its maker takes a shorter one.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import zip_longest
from typing import Any

from flint import acb, arb

ZERO_BALL, NO_TAIL = acb(0), arb(0)
UNBOUNDED = arb.pos_inf()


class TailedSeries:
    """c (p,) balls, the first p ≤ N = terms coefficients, those behind them up to N zero, and τ ≥ 0."""

    __slots__ = ("c", "tail", "terms")

    def __init__(self, c: Sequence[Any], terms: int, tail: Any = NO_TAIL) -> None:
        self.c, self.terms, self.tail = list(c), terms, tail

    @property
    def norm(self) -> Any:
        """‖f‖, an upper bound."""
        return _sum(abs(x) for x in self.c) + self.tail

    def beyond(self) -> list[Any]:
        """Σ_{j≥m} |f_j| for m = 0 … p, upper bounds; for m from p to N the last of them."""
        sums = [self.tail]
        for x in reversed(self.c):
            sums.append(sums[-1] + abs(x))
        return sums[::-1]

    def _like(self, c: Sequence[Any], tail: Any) -> TailedSeries:
        return TailedSeries(c, self.terms, tail)

    def __neg__(self) -> TailedSeries:
        return self._like([-x for x in self.c], self.tail)

    def __add__(self, other: Any) -> TailedSeries:
        if isinstance(other, TailedSeries):
            return self._like([x + y for x, y in zip_longest(self.c, other.c, fillvalue=ZERO_BALL)], self.tail + other.tail)
        return self._like([self.c[0] + other, *self.c[1:]], self.tail)

    __radd__ = __add__

    def __sub__(self, other: Any) -> Any:
        return self + (-other)

    def __rsub__(self, other: Any) -> Any:
        return (-self) + other

    def __mul__(self, other: Any) -> TailedSeries:
        if not isinstance(other, TailedSeries):
            return self._like([x * other for x in self.c], self.tail * abs(acb(other)))
        a, b, n = self.c, other.c, min(len(self.c) + len(other.c) - 1, self.terms)
        c, tail = [ZERO_BALL] * n, NO_TAIL
        for i, x in enumerate(a):
            for j, y in enumerate(b):
                if i + j < n:
                    c[i + j] += x * y
                else:
                    tail += abs(x) * abs(y)
        if self.tail != 0 or other.tail != 0:
            tail += self.tail * other.norm + other.tail * _sum(abs(x) for x in a)
        return self._like(c, tail)

    __rmul__ = __mul__

    def __truediv__(self, other: Any) -> TailedSeries:
        if not isinstance(other, TailedSeries):
            return self * (1 / acb(other))
        first, u = other._relative()
        scaled = [x / first for x in self.c]
        return _recurrence(u, lambda m: scaled[m] if m < len(scaled) else ZERO_BALL, lambda j, m: -1, self.tail / abs(first), arb(1))

    def __rtruediv__(self, other: Any) -> TailedSeries:
        return self._like([acb(other)], NO_TAIL) / self

    def __pow__(self, exponent: Any) -> TailedSeries:
        """A natural power by multiplication, any other one on the branch of b_0^r that acb takes."""
        if isinstance(exponent, int) and exponent >= 0:
            power = self._like([acb(1)], NO_TAIL)
            for _ in range(exponent):
                power = power * self
            return power
        first, u = self._relative()
        r = acb(exponent)
        size = arb(1).max(abs(r))
        start = first**r
        return _recurrence(u, lambda m: start if m == 0 else ZERO_BALL, lambda j, m: (r + 1) * j / m - 1, NO_TAIL, size)

    def exp(self) -> TailedSeries:
        """e^f."""
        start = self.c[0].exp()
        u = self._like([ZERO_BALL, *self.c[1:]], self.tail)
        return _recurrence(u, lambda m: start if m == 0 else ZERO_BALL, lambda j, m: acb(j) / m, NO_TAIL, arb(1))

    def log(self) -> TailedSeries:
        """ln f on the branch of ln f_0 that acb takes."""
        first, u = self._relative()
        found = _recurrence(u, lambda m: u.c[m] if 0 < m < len(u.c) else ZERO_BALL, lambda j, m: acb(j) / m - 1, u.tail, arb(1))
        shifted: TailedSeries = found + first.log()
        return shifted

    def sqrt(self) -> TailedSeries:
        """f^{1/2}."""
        return self ** (acb(1) / 2)

    def sin(self) -> Any:
        """(e^{if} − e^{−if})/2i."""
        turn = self * acb(0, 1)
        return (turn.exp() - (-turn).exp()) * (1 / acb(0, 2))

    def cos(self) -> TailedSeries:
        """(e^{if} + e^{−if})/2."""
        turn = self * acb(0, 1)
        return (turn.exp() + (-turn).exp()) * (acb(1) / 2)

    def sinh(self) -> Any:
        """(e^f − e^{−f})/2."""
        return (self.exp() - (-self).exp()) * (acb(1) / 2)

    def cosh(self) -> TailedSeries:
        """(e^f + e^{−f})/2."""
        return (self.exp() + (-self).exp()) * (acb(1) / 2)

    def tanh(self) -> Any:
        """1 − 2/(e^{2f} + 1)."""
        return 1 - 2 / ((self * 2).exp() + 1)

    def _relative(self) -> tuple[Any, TailedSeries]:
        """b_0 and u with b = b_0 (1 + u)."""
        first = self.c[0]
        return first, self._like([ZERO_BALL, *(x / first for x in self.c[1:])], self.tail / abs(first))


def variable(centre: Any, step: Any, terms: int) -> TailedSeries:
    """z = centre + step·t."""
    return TailedSeries([acb(centre), acb(step)], terms)


def _recurrence(u: TailedSeries, given: Callable[[int], Any], weight: Callable[[int, int], Any], tail: Any, size: Any) -> TailedSeries:
    """c_m = given(m) + Σ_{j=1}^m weight(j, m) u_j c_{m−j}, where |weight| ≤ size and Σ_{m≥N} |given(m)| ≤ tail."""
    n, p = u.terms, len(u.c)
    c: list[Any] = []
    for m in range(n):
        total = given(m)
        for j in range(1, min(m, p - 1) + 1):
            total = total + weight(j, m) * u.c[j] * c[m - j]
        c.append(total)
    beyond = u.beyond()
    rest = _sum(abs(x) * beyond[min(n - k, p)] for k, x in enumerate(c))
    room = 1 - size * u.norm
    return TailedSeries(c, n, (tail + size * rest) / room if room > 0 else UNBOUNDED)


def _sum(numbers: Any) -> Any:
    return sum(numbers, NO_TAIL)
