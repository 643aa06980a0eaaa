"""Power series that are known only as far as they have been computed: the Taylor recurrence of a formula, built once.

The operators of a `RelaxedSeries` write down an expression graph; `RelaxedSystem.extend(m)` then computes the m-th coefficient of every
series from the coefficients of its operands up to m, in O(m) for a product, a quotient or a power.
Solving y′ = f(y) to order N costs O(N²) a
product, against O(N³) for series recomputed as a whole.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

from shootstab.multiprecision.arithmetic import Arithmetic

Term = Callable[[int, list[Any]], Any]  # the m-th coefficient, from m and the coefficients before it


class RelaxedSystem:
    """The nodes in the order in which they can be computed. Equal expressions are one node."""

    def __init__(self, arithmetic: Arithmetic) -> None:
        self.arithmetic = arithmetic
        self._inputs: list[RelaxedSeries] = []
        self._nodes: list[RelaxedSeries] = []
        self._turn: list[tuple[list[Any], Term]] = []  # coefficients and term of each node
        self._known: dict[tuple[Any, ...], RelaxedSeries] = {}

    def __len__(self) -> int:
        """The number of expressions in it."""
        return len(self._nodes)

    @property
    def nodes(self) -> Sequence[RelaxedSeries]:
        """The expressions, in the order in which they can be computed."""
        return self._nodes

    def unknown(self) -> RelaxedSeries:
        """A series whose coefficients are set from outside, before each turn."""
        node = RelaxedSeries(self)
        self._inputs.append(node)
        return node

    def extend(self, m: int) -> None:
        """Compute (or compute anew) the m-th coefficient of every node; those below m are known."""
        for c, term in self._turn:
            if len(c) > m:
                del c[m:]
            c.append(term(m, c))

    def clear(self) -> None:
        """Forget all coefficients."""
        for node in (*self._inputs, *self._nodes):
            node.coefficients.clear()

    def node(self, key: tuple[Any, ...], term: Term, *kept: Any) -> RelaxedSeries:
        """The node of this expression. Operands in the key stand by their identity, and kept keeps them alive."""
        if key not in self._known:
            self._known[key] = node = RelaxedSeries(self, kept, key[0])
            self._nodes.append(node)
            self._turn.append((node.coefficients, term))
        return self._known[key]


class RelaxedSeries:
    """One series of the system, real."""

    __slots__ = ("coefficients", "kept", "operation", "system")

    def __init__(self, system: RelaxedSystem, kept: Any = (), operation: str = "") -> None:
        self.system, self.kept, self.operation = system, kept, operation
        self.coefficients: list[Any] = []

    def __neg__(self) -> RelaxedSeries:
        a = self.coefficients
        return self.system.node(("neg", id(self)), lambda m, _: -a[m], self)

    def __add__(self, other: Any) -> RelaxedSeries:
        a = self.coefficients
        if isinstance(other, RelaxedSeries):
            b = other.coefficients
            return self.system.node(("add", id(self), id(other)), lambda m, _: a[m] + b[m], self, other)
        return self.system.node(("shift", id(self), _key(other)), lambda m, _: a[0] + other if m == 0 else a[m], self, other)

    __radd__ = __add__

    def __sub__(self, other: Any) -> Any:
        return self + (-other)

    def __rsub__(self, other: Any) -> Any:
        return (-self) + other

    def __mul__(self, other: Any) -> RelaxedSeries:
        a, dot = self.coefficients, self.system.arithmetic.dot
        if isinstance(other, RelaxedSeries):
            b = other.coefficients
            first, second = sorted((id(self), id(other)))
            return self.system.node(("mul", first, second), lambda m, _: dot(a, b[m::-1]), self, other)
        return self.system.node(("scale", id(self), _key(other)), lambda m, _: a[m] * other, self, other)

    __rmul__ = __mul__

    def __truediv__(self, other: Any) -> RelaxedSeries:
        a = self.coefficients
        if isinstance(other, RelaxedSeries):
            return _quotient(self.system, ("over", id(self), id(other)), lambda m: a[m], other, self)
        return self.system.node(("part", id(self), _key(other)), lambda m, _: a[m] / other, self, other)

    def __rtruediv__(self, other: Any) -> RelaxedSeries:
        return _quotient(self.system, ("into", _key(other), id(self)), lambda m: other if m == 0 else 0, self, other)

    def __pow__(self, exponent: Any) -> RelaxedSeries:
        """a^r from a c′ = r a′ c; natural powers by multiplication; r = 1/2 from c c = a."""
        if isinstance(exponent, int) and exponent > 0:
            return self if exponent == 1 else self * self ** (exponent - 1)
        a, dot = self.coefficients, self.system.arithmetic.dot

        def root(m: int, c: list[Any]) -> Any:
            if m == 0:
                return a[0] ** exponent
            return (a[m] - dot(c[1:], c[:0:-1])) / (2 * c[0])

        def power(m: int, c: list[Any]) -> Any:
            if m == 0:
                return a[0] ** exponent
            back = c[::-1]
            weighted = [j * x for j, x in enumerate(a[1 : m + 1], 1)]
            return ((exponent + 1) * dot(weighted, back) - m * dot(a[1 : m + 1], back)) / (m * a[0])

        return self.system.node(("pow", id(self), _key(exponent)), root if exponent == 0.5 else power, self, exponent)


def _quotient(
    system: RelaxedSystem, key: tuple[Any, ...], numerator: Callable[[int], Any], divisor: RelaxedSeries, other: Any
) -> RelaxedSeries:
    b, dot = divisor.coefficients, system.arithmetic.dot

    def term(m: int, c: list[Any]) -> Any:
        if m == 0:
            return numerator(0) / b[0]
        return (numerator(m) - dot(b[1 : m + 1], c[::-1])) / b[0]

    return system.node(key, term, divisor, other)


def _key(constant: Any) -> Any:
    """What a constant is known by: small numbers by value, others by identity."""
    return constant if isinstance(constant, int | float) else ("at", id(constant))
