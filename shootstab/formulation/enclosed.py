"""Problems in equations in balls: the same expressions on numbers and series that carry their errors (theory, lemmas E1 to E3, E8).

Both ends give conditions a(σ) ψ = 0 (m, n) and b(σ) ψ = 0 (k, n), m + k = n, and D(σ) = ± det [a; b Φ] with Φ the matrix that carries ψ
from the left to the right end. By Laplace's expansion D = Σ_I b_I y_I, where b_I are the k-minors of b, y = Λ^k Φ y(left), and

    y_I(left) = (−1)^{Σ I} det a[columns not in I],

polynomials in σ: the eigenvalue may stand in the conditions at both ends. At an end at infinity the decaying solutions stand for those that
the conditions admit (lemma E12), at a regular singular point the regular ones (lemma E14).
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from fractions import Fraction
from itertools import combinations
from typing import Any, Protocol

from shootstab.core.balls import acb, acb_mat, arb
from shootstab.formulation.atoms import Atom
from shootstab.formulation.evaluation import Evaluator
from shootstab.formulation.gaussian import Gaussian
from shootstab.formulation.state_pencil import Powers, StatePencil
from shootstab.multiprecision.enclosable import ball, row_minors
from shootstab.multiprecision.minors import MinorEntries
from shootstab.multiprecision.tailed_series import TailedSeries

NOWHERE = acb(arb.nan())  # defined: what is computed with it is no number


class DecayingEnd(Protocol):
    """An end at infinity (enclosed_infinity), or a regular singular one (enclosed_axis): regular solutions stand for decaying ones."""

    decaying: int
    inwards: bool  # whether its solutions are best carried inwards

    @property
    def lemmas(self) -> tuple[str, ...]:
        """What it rests on."""
        ...

    @property
    def place(self) -> Any:
        """Where it is left, an arb."""
        ...

    @property
    def multiple(self) -> tuple[Any, ...]:
        """Where it is left and by which minor the others are divided."""
        ...

    def minors(self, sigma: Any) -> list[Any]:
        """The minors of the solutions that decay towards it."""
        ...


class FlowInBalls(Protocol):
    """A base flow (enclosed_boundary_layer.py)."""

    def on(self, z: Any) -> Callable[[str, int], Any]:
        """Its functions at z, an acb or a TailedSeries that is linear in t, by name and order of derivative."""
        ...


class EquationEnclosable:
    """See multiprecision.enclosable.EnclosableSystem: a system without given functions between ends with conditions or at infinity."""

    def __init__(
        self,
        system: StatePencil,
        left: Fraction | DecayingEnd,
        right: Fraction | DecayingEnd,
        parameters: Mapping[Atom, Any] | None = None,
        flow: FlowInBalls | None = None,
    ) -> None:
        """parameters: values, acb, of those that are left open in the system; flow: the base flow, if there is one."""
        self._system, self._left, self._right, self._parameters, self._flow = system, left, right, parameters or {}, flow

    @property
    def lemmas(self) -> tuple[str, ...]:
        """What the ends rest on."""
        at_ends = [name for end in (self._left, self._right) if not isinstance(end, Fraction) for name in end.lemmas]
        return (*dict.fromkeys(at_ends), "E8")

    @property
    def multiple(self) -> tuple[Any, ...]:
        """What the ends at infinity chose."""
        return tuple(end.multiple for end in (self._left, self._right) if not isinstance(end, Fraction))

    @property
    def matched(self) -> bool:
        """Whether solutions are carried inwards from both ends: from infinities from which errors would grow across the whole line."""
        return all(not isinstance(end, Fraction) and end.inwards for end in (self._left, self._right))

    @property
    def size(self) -> int:
        return self._system.size

    @property
    def decaying(self) -> int:
        """The number of conditions at the right end: of solutions there that do not decay, where it is at infinity."""
        return self._system.right_rows if isinstance(self._right, Fraction) else self.size - self._right.decaying

    def ends(self) -> tuple[Any, Any]:
        left, right = (ball(end) if isinstance(end, Fraction) else end.place for end in (self._left, self._right))
        return left, right

    def pencil(self, z: Any) -> tuple[list[MinorEntries], list[MinorEntries]]:
        at = on_balls(z, self._parameters, self._flow)
        C, D = ([{place: at(entry) for place, entry in part.items()} for part in powers] for powers in (self._system.C, self._system.D))
        return C, D

    def start(self, sigma: Any) -> list[Any]:
        n, k = self.size, self.decaying
        if not isinstance(self._left, Fraction):
            return self._left.minors(sigma)
        rows = self._rows(self._system.left, n - k, self._left, sigma)
        found = []
        for chosen in combinations(range(n), k):
            minor = acb_mat([[row[j] for j in range(n) if j not in chosen] for row in rows]).det() if n > k else acb(1)
            found.append(-minor if sum(chosen) % 2 else minor)
        return found

    def arriving(self, sigma: Any) -> list[Any]:
        """The minors of the solutions that the right end admits, which is no finite one."""
        assert not isinstance(self._right, Fraction)
        return self._right.minors(sigma)

    def wall(self, sigma: Any) -> list[Any]:
        if not isinstance(self._right, Fraction):
            return self.complementary(self._right.minors(sigma))
        return row_minors(self._rows(self._system.right, self.decaying, self._right, sigma)) if self.decaying else [acb(1)]

    def complementary(self, found: list[Any]) -> list[Any]:
        """w_I = (−1)^{Σ I} of the minor in the rows that are not in I: D = ± det of both bases, by Laplace's expansion."""
        every, n, k = range(self.size), self.size, self.decaying
        known = dict(zip(combinations(every, n - k), found, strict=True))
        rest = [(chosen, known[tuple(j for j in every if j not in chosen)]) for chosen in combinations(every, k)]
        return [-x if sum(chosen) % 2 else x for chosen, x in rest]

    def _rows(self, parts: Powers, count: int, z: Fraction, sigma: Any) -> list[list[Any]]:
        at = on_balls(acb(ball(z)), self._parameters, self._flow)
        rows = [[acb(0)] * self.size for _ in range(count)]
        for power, part in enumerate(parts):
            for (i, j), entry in part.items():
                rows[i][j] = rows[i][j] + at(entry) * sigma**power
        return rows


def on_balls(z: Any, parameters: Mapping[Atom, Any], flow: FlowInBalls | None = None) -> Evaluator:
    """Expressions at z, an acb or a TailedSeries: both have the functions as methods, and the branches of numbers."""
    known = {"z": z, "pi": acb(arb.pi())}
    return Evaluator(_number, _applied, _power, known, _not_given if flow is None else flow.on(z), parameters=parameters)


def _number(c: Gaussian) -> Any:
    return acb(ball(Fraction(c.re)), ball(Fraction(c.im)))


def _applied(name: str, x: Any) -> Any:
    return getattr(_off_the_cut(x) if name in ("log", "sqrt") else x, name)()


def _power(x: Any, exponent: Fraction) -> Any:
    if exponent.denominator == 1:
        return 1 / x ** -int(exponent)
    return _off_the_cut(x) ** acb(ball(exponent))


def _off_the_cut(x: Any) -> Any:
    """x, or what is no number where a ball holds both sides of the negative axis: no root or logarithm is analytic on it."""
    crosses = not isinstance(x, TailedSeries) and not x.real > 0 and x.imag.contains(0) and not x.imag.is_zero()
    return NOWHERE if crosses else x


def _not_given(name: str, order: int) -> Any:
    raise AssertionError(f"{name} is known to doubles only: refused where the problem offers its capabilities")
