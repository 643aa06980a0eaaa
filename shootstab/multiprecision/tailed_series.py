"""Power series on |t| ≤ 1 with rigorous tails: N balls and a bound on the ℓ¹ norm of every coefficient behind them.

A `TailedSeries` (c_0, …, c_{N−1}; τ) stands for every f(t) = Σ_m f_m t^m with f_m ∈ c_m for m < N and Σ_{m≥N} |f_m| ≤ τ. The set is closed
under the operations below, each of which encloses the exact result (theory, lemma E1). The first N coefficients of a result depend on no
others: they are those of FLINT's series. With ‖·‖ the ℓ¹ norm, b = b_0 (1 + u), s = max(1, |r|) and R = Σ_{k<N} |c_k| Σ_{j≥N−k} |u_j|,
the tails are

    a b      Σ_{m≥N} |Σ_{j+k=m} a_j b_k| + τ_a ‖b‖ + τ_b ‖a‖ + τ_a τ_b
    a/b      (τ_a/|b_0| + R)/(1 − ‖u‖)                                   from c_m = a_m/b_0 − Σ_j u_j c_{m−j}
    b^r      s R/(1 − s ‖u‖)                                             from c_m = Σ_j ((r + 1) j/m − 1) u_j c_{m−j}
    exp a    R/(1 − ‖u‖), u = a − a_0                                    from m c_m = Σ_j j u_j c_{m−j}
    ln b     ((τ_u + R)/(1 − ‖u‖))                                       from c_m = u_m − Σ_j (1 − j/m) u_j c_{m−j}
    erf a    Σ_{k<N} |g_k| Σ_{j≥N−k} |u_j| + τ_g ‖u‖, g = 2 e^{−a²}/√π    from m c_m = Σ_j j u_j g_{m−j}

A tail that these inequalities cannot bound, ‖u‖ ≥ 1 or s ‖u‖ ≥ 1, is infinite: the step is too long, and its maker takes a shorter one.
So it is where b may cross the cut of a logarithm or root, the negative axis, on |t| ≤ 1; a series whose coefficients are all real and
that is negative throughout keeps to the upper side of it, as numbers do.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from itertools import zip_longest
from typing import Any

from shootstab.core.balls import acb, acb_poly, acb_series, arb, ctx

ZERO_BALL, NO_TAIL = acb(0), arb(0)
UNBOUNDED = arb.pos_inf()


class TailedSeries:
    """c (p,) balls, the first p ≤ N = terms coefficients, those behind them up to N zero, and τ ≥ 0.

    real says that the coefficients are known to be real, those of the tail included.
    """

    __slots__ = ("_norm", "_polynomial", "c", "real", "tail", "terms")

    def __init__(self, c: Sequence[Any], terms: int, tail: Any = NO_TAIL, real: bool = False) -> None:
        self.c, self.terms, self.tail, self.real = list(c) or [ZERO_BALL], terms, tail, real
        self._norm: Any = None
        self._polynomial: Any = None

    @property
    def norm(self) -> Any:
        """‖f‖, an upper bound."""
        if self._norm is None:
            self._norm = _norm(self.c) + self.tail
        return self._norm

    @property
    def polynomial(self) -> Any:
        """Σ_{m<N} c_m t^m as FLINT's."""
        if self._polynomial is None:
            self._polynomial = acb_poly(self.c)
        return self._polynomial

    @property
    def zero(self) -> bool:
        """Whether it is exactly zero."""
        return self.tail.is_zero() and all(x.is_zero() for x in self.c)

    def at(self, t: Any) -> Any:
        """A ball that holds f(t), |t| ≤ 1."""
        return widened(self.polynomial(acb(t)), self.tail)

    def beyond(self) -> list[Any]:
        """Σ_{j≥m} |f_j| for m = 0 … p, upper bounds; for m from p to N the last of them."""
        sums = [self.tail]
        for x in reversed(self.c):
            sums.append(sums[-1] + abs(x))
        return sums[::-1]

    def shortened(self, terms: int) -> TailedSeries:
        """The same functions by fewer terms: those dropped belong to the tail."""
        return TailedSeries(self.c[:terms], terms, self.tail + _norm(self.c[terms:]), self.real)

    def _like(self, c: Sequence[Any], tail: Any, real: bool) -> TailedSeries:
        return TailedSeries(c, self.terms, tail, real)

    def __neg__(self) -> TailedSeries:
        return self._like([-x for x in self.c], self.tail, self.real)

    def __add__(self, other: Any) -> TailedSeries:
        if isinstance(other, TailedSeries):
            c = [x + y for x, y in zip_longest(self.c, other.c, fillvalue=ZERO_BALL)]
            return self._like(c, self.tail + other.tail, self.real and other.real)
        return self._like([self.c[0] + other, *self.c[1:]], self.tail, self.real and _is_real(other))

    __radd__ = __add__

    def __sub__(self, other: Any) -> Any:
        return self + (-other)

    def __rsub__(self, other: Any) -> Any:
        return (-self) + other

    def __mul__(self, other: Any) -> TailedSeries:
        if not isinstance(other, TailedSeries):
            return self._like([x * other for x in self.c], self.tail * abs(acb(other)), self.real and _is_real(other))
        whole = (self.polynomial * other.polynomial).coeffs()
        tail = _norm(whole[self.terms :])
        if not (self.tail.is_zero() and other.tail.is_zero()):
            tail += self.tail * other.norm + other.tail * self.norm
        return self._like(whole[: self.terms], tail, self.real and other.real)

    __rmul__ = __mul__

    def __truediv__(self, other: Any) -> TailedSeries:
        if not isinstance(other, TailedSeries):
            return self * (1 / acb(other))
        first, u = other._relative()
        if not u.norm < 1:
            return self._unbounded()
        with capped(self.terms):
            c = (self._flint() / other._flint()).coeffs()
        return self._like(c, _carried(u, c, self.tail / abs(first), arb(1)), self.real and other.real)

    def __rtruediv__(self, other: Any) -> TailedSeries:
        return self._like([acb(other)], NO_TAIL, _is_real(other)) / self

    def __pow__(self, exponent: Any) -> TailedSeries:
        """A natural power by multiplication, any other one on the branch that numbers have: cut along the negative axis."""
        if isinstance(exponent, int) and exponent >= 0:
            power = self._like([acb(1)], NO_TAIL, True)
            for _ in range(exponent):
                power = power * self
            return power
        first, u = self._relative()
        r = acb(exponent)
        size = arb(1).max(abs(r))
        if not (size * u.norm < 1 and self._off_the_cut(u)):
            return self._unbounded()
        with capped(self.terms):
            c = ((acb_series([1, *u.c[1:]], self.terms).log() * r).exp() * first**r).coeffs()
        return self._like(c, _carried(u, c, NO_TAIL, size), self.real and _is_real(r) and first.real > 0)

    def exp(self) -> TailedSeries:
        """e^f."""
        u = self._like([ZERO_BALL, *self.c[1:]], self.tail, self.real)
        if not u.norm < 1:
            return self._unbounded()
        with capped(self.terms):
            c = self._flint().exp().coeffs()
        return self._like(c, _carried(u, c, NO_TAIL, arb(1)), self.real)

    def log(self) -> TailedSeries:
        """ln f, cut along the negative axis."""
        first, u = self._relative()
        if not (u.norm < 1 and self._off_the_cut(u)):
            return self._unbounded()
        with capped(self.terms):
            c = acb_series([1, *u.c[1:]], self.terms).log().coeffs()
        tail = _carried(u, c, u.tail, arb(1))
        return self._like([first.log(), *c[1:]], tail, self.real and first.real > 0)

    def sqrt(self) -> TailedSeries:
        """f^{1/2}."""
        return self ** (acb(1) / 2)

    def sin(self) -> Any:
        """(e^{if} − e^{−if})/2i."""
        turn = self * acb(0, 1)
        return ((turn.exp() - (-turn).exp()) * (1 / acb(0, 2)))._known_real(self.real)

    def cos(self) -> TailedSeries:
        """(e^{if} + e^{−if})/2."""
        turn = self * acb(0, 1)
        return ((turn.exp() + (-turn).exp()) * (acb(1) / 2))._known_real(self.real)

    def tan(self) -> TailedSeries:
        """sin f/cos f."""
        quotient: TailedSeries = self.sin() / self.cos()
        return quotient

    def sinh(self) -> Any:
        """(e^f − e^{−f})/2."""
        return (self.exp() - (-self).exp()) * (acb(1) / 2)

    def cosh(self) -> TailedSeries:
        """(e^f + e^{−f})/2."""
        return (self.exp() + (-self).exp()) * (acb(1) / 2)

    def tanh(self) -> Any:
        """1 − 2/(e^{2f} + 1)."""
        return 1 - 2 / ((self * 2).exp() + 1)

    def sech(self) -> TailedSeries:
        """2/(e^f + e^{−f})."""
        return 1 / self.cosh()

    def erf(self) -> TailedSeries:
        """The integral of 2 e^{−f²}/√π df from 0."""
        u = self._like([ZERO_BALL, *self.c[1:]], self.tail, self.real)
        bell = (-(self * self)).exp() * (2 / arb.pi().sqrt())
        with capped(self.terms):
            c = (acb_series(bell.c, self.terms) * self._flint().derivative()).integral().coeffs()
        return self._like([self.c[0].erf(), *c[1 : self.terms]], _met(u, bell.c) + bell.tail * u.norm, self.real)

    def _relative(self) -> tuple[Any, TailedSeries]:
        """b_0 and u with b = b_0 (1 + u)."""
        first = acb(self.c[0].real) if self.real else self.c[0]
        return first, self._like([ZERO_BALL, *(x / first for x in self.c[1:])], self.tail / abs(first), self.real)

    def _off_the_cut(self, u: TailedSeries) -> bool:
        """Whether 1 + u keeps b away from the negative axis, or b is real and keeps its sign."""
        first = self.c[0]
        if self.real or first.real > 0:
            return bool(u.norm < 1)
        return bool(abs(first.imag) > abs(first) * u.norm)

    def _known_real(self, real: bool) -> TailedSeries:
        """The series, real if the argument is: what was computed by way of complex numbers may have lost that."""
        return self._like([acb(x.real) for x in self.c], self.tail, True) if real else self

    def _unbounded(self) -> TailedSeries:
        return self._like([acb(0, 0)], UNBOUNDED, False)

    def _flint(self) -> Any:
        return acb_series(self.c, self.terms)


def widened(x: Any, radius: Any) -> Any:
    """x with its real and imaginary parts wider by a bound on the modulus of what is left out."""
    if radius.is_zero():
        return x
    spread = arb(0, radius.upper())
    return acb(x.real + spread, x.imag + spread)


def variable(centre: Any, step: Any, terms: int) -> TailedSeries:
    """z = centre + step·t."""
    return TailedSeries([acb(centre), acb(step)], terms, NO_TAIL, _is_real(centre) and _is_real(step))


def _carried(u: TailedSeries, c: list[Any], tail: Any, size: Any) -> Any:
    """Σ_{m≥N} |c_m| of c_m = g_m + Σ_{j=1}^m w_{jm} u_j c_{m−j}, |w_{jm}| ≤ size and Σ_{m≥N} |g_m| ≤ tail: see the head of this module."""
    room = 1 - size * u.norm
    return (tail + size * _met(u, c)) / room if room > 0 else UNBOUNDED


def _met(u: TailedSeries, c: Sequence[Any]) -> Any:
    """Σ_{k<N} |c_k| Σ_{j≥N−k} |u_j|: what u makes of these terms at N and behind it, whatever the weights of modulus 1 at most."""
    n, p = u.terms, len(u.c)
    beyond = u.beyond()
    return sum((abs(x) * beyond[min(n - k, p)] for k, x in enumerate(c) if n - k <= p or not beyond[p].is_zero()), NO_TAIL)


@contextmanager
def capped(terms: int) -> Iterator[None]:
    """FLINT's series keep so many terms, and no more; of their own accord they would keep ten."""
    before, ctx.cap = ctx.cap, terms
    try:
        yield
    finally:
        ctx.cap = before


def _is_real(x: Any) -> bool:
    return bool(acb(x).imag == 0)


def _norm(coefficients: Sequence[Any]) -> Any:
    return sum(map(abs, coefficients), NO_TAIL)
