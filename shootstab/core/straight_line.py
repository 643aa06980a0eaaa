"""Formulas recorded as straight-line programs: the list of operations that a Python function carries out on numbers.

A formula is written once, for anything that can be added, multiplied and raised to a power. Carried out on `Recorded` in place of
numbers it leaves the operations that it consists of, each once. `kernels.recorded_programs` carries them out on arrays, and
`kernels.taylor_pieces` on truncated Taylor series (A. Griewank & A. Walther, Evaluating Derivatives, 2nd ed., SIAM 2008, 2.2 and 13.2).

A recorded number is coefficient · node. Coefficients are known when it is recorded: products by 0 and 1 vanish, and powers of i stay out of
the nodes, so that what is real but for such a power is computed in real numbers.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

HIGHEST_PRODUCT = 32  # chosen: natural powers up to this one are products
UNIT, INPUT, PARAMETER, SUM, PRODUCT, QUOTIENT, POWER, EXP = range(8)  # exact: what kernels know operations by


class Recorder:
    """What has been recorded so far: nodes (operation, x, y, a, b), the same operation on the same nodes once only."""

    def __init__(self) -> None:
        self.nodes: list[tuple[int, int, int, complex, complex]] = [(UNIT, 0, 0, 0j, 0j)]
        self._known: dict[tuple[int, int, int, complex, complex], int] = {}

    def inputs(self, count: int) -> list[Recorded]:
        """What differs from point to point."""
        return [self.node(INPUT, i) for i in range(count)]

    def parameters(self, count: int) -> list[Recorded]:
        """What is the same at all points."""
        return [self.node(PARAMETER, i) for i in range(count)]

    def node(self, operation: int, x: int, y: int = 0, a: complex = 0j, b: complex = 0j) -> Recorded:
        key = (operation, x, y, complex(a), complex(b))
        if key not in self._known:
            self._known[key] = len(self.nodes)
            self.nodes.append(key)
        return Recorded(self, self._known[key], 1.0)

    def constant(self, value: Any) -> Recorded:
        return Recorded(self, 0, value)


class Recorded:
    """coefficient · node, an operand of formulas; it has no value that a formula could branch on."""

    __slots__ = ("coefficient", "index", "recorder")
    __array_ufunc__ = None

    def __init__(self, recorder: Recorder, index: int, coefficient: Any) -> None:
        self.recorder, self.coefficient = recorder, coefficient
        self.index = index if coefficient != 0 else 0

    def __bool__(self) -> bool:
        raise TypeError("a recorded number has no value that a formula could branch on")

    @property
    def known(self) -> bool:
        """Whether it is a number that is known already."""
        return self.index == 0

    def __neg__(self) -> Recorded:
        return Recorded(self.recorder, self.index, -self.coefficient)

    def __add__(self, other: Any) -> Any:
        if not isinstance(other, OPERANDS):
            return NotImplemented
        other = self._recorded(other)
        if other.coefficient == 0:
            return self
        if self.coefficient == 0:
            return other
        if self.index == other.index:
            return Recorded(self.recorder, self.index, self.coefficient + other.coefficient)
        x, y = (self, other) if self.index > other.index else (other, self)
        a, b = complex(x.coefficient), complex(y.coefficient)
        if a.real == b.real == 0.0:
            return 1j * self.recorder.node(SUM, x.index, y.index, a.imag, b.imag)
        return self.recorder.node(SUM, x.index, y.index, a, b)

    __radd__ = __add__

    def __sub__(self, other: Any) -> Any:
        return self + (-other)

    def __rsub__(self, other: Any) -> Any:
        return (-self) + other

    def __mul__(self, other: Any) -> Any:
        if not isinstance(other, OPERANDS):
            return NotImplemented
        other = self._recorded(other)
        coefficient = self.coefficient * other.coefficient
        if self.known or other.known:
            return Recorded(self.recorder, max(self.index, other.index), coefficient)
        x, y = sorted((self.index, other.index))
        return Recorded(self.recorder, self.recorder.node(PRODUCT, x, y).index, coefficient)

    __rmul__ = __mul__

    def __truediv__(self, other: Any) -> Any:
        if not isinstance(other, OPERANDS):
            return NotImplemented
        other = self._recorded(other)
        coefficient = self.coefficient / other.coefficient
        if other.known or self.coefficient == 0:
            return Recorded(self.recorder, self.index, coefficient)
        if self.index == other.index:
            return self.recorder.constant(coefficient)
        return Recorded(self.recorder, self.recorder.node(QUOTIENT, self.index, other.index).index, coefficient)

    def __rtruediv__(self, other: Any) -> Any:
        return self._recorded(other) / self

    def __pow__(self, exponent: Any) -> Recorded:
        """The power with an exponent that is the same at all points; natural ones up to HIGHEST_PRODUCT by multiplication."""
        power = self._recorded(exponent)
        if power.known and power.coefficient in range(1, HIGHEST_PRODUCT + 1):
            half = int(power.coefficient.real) // 2
            root = self if half == 0 else self**half
            return root if half == 0 else root * root if power.coefficient == 2 * half else root * root * self
        if self.known and power.known:
            return self.recorder.constant(self.coefficient**power.coefficient)
        return self.recorder.node(POWER, self._plain().index, power._plain().index)

    def _plain(self) -> Recorded:
        """The number itself, as a node with coefficient 1."""
        if self.coefficient == 1:
            return self
        return self.recorder.node(SUM, self.index, 0, self.coefficient, 0j)

    def _recorded(self, other: Any) -> Recorded:
        return other if isinstance(other, Recorded) else self.recorder.constant(other)


OPERANDS = (Recorded, int, float, complex, np.number)  # the rest, series of recorded numbers among them, knows itself what to do


def exp(x: Recorded) -> Recorded:
    """e^x."""
    return x.recorder.node(EXP, x._plain().index)


@dataclass(frozen=True, eq=False)
class Program:
    """A recorded formula, as kernels take it.

    operation, x, y (r,) are the nodes in the order in which they can be carried out, the `shared` first ones the same at all points; a, b
    (r,) the coefficients of sums a·x + b·y; result (s,) are the nodes of the results. real: whether real inputs and parameters make all
    nodes real.
    """

    operation: NDArray[np.int64]
    x: NDArray[np.int64]
    y: NDArray[np.int64]
    a: NDArray[np.complex128]
    b: NDArray[np.complex128]
    shared: int
    result: NDArray[np.int64]
    real: bool

    def lists(self, real: bool) -> tuple[Any, ...]:
        """(operation, x, y, a, b, shared, result) for a kernel, a and b in real or in complex numbers."""
        a, b = self._in_real_numbers if real else (self.a, self.b)
        return self.operation, self.x, self.y, a, b, self.shared, self.result

    @cached_property
    def _in_real_numbers(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        return self.a.real.copy(), self.b.real.copy()


def program(recorder: Recorder, results: Sequence[Any]) -> Program:
    """What has to be carried out for these results, numbers among them."""
    wanted = [(r if isinstance(r, Recorded) else recorder.constant(r))._plain() for r in results]
    nodes = recorder.nodes
    needed, todo = {0}, [r.index for r in wanted]
    while todo:
        i = todo.pop()
        if i not in needed:
            needed.add(i)
            todo += [j for j in _operands(nodes[i]) if j not in needed]
    varying: set[int] = set()
    for i in sorted(needed):
        if nodes[i][0] == INPUT or any(j in varying for j in _operands(nodes[i])):
            varying.add(i)
    order = sorted(needed - varying) + sorted(varying)
    place = {i: k for k, i in enumerate(order)}
    rows = [nodes[i] for i in order]
    x, y = np.empty(len(rows), dtype=np.int64), np.zeros(len(rows), dtype=np.int64)
    for k, row in enumerate(rows):
        x[k] = place[row[1]] if _operands(row) else row[1]
        y[k] = place[row[2]] if len(_operands(row)) > 1 else 0
    a, b = (np.array([row[c] for row in rows], dtype=np.complex128) for c in (3, 4))
    return Program(
        np.array([row[0] for row in rows], dtype=np.int64),
        *(x, y, a, b, len(needed - varying)),
        np.array([place[r.index] for r in wanted], dtype=np.int64),
        not (a.imag.any() or b.imag.any()),
    )


def _operands(node: tuple[int, int, int, complex, complex]) -> tuple[int, ...]:
    operation, x, y = node[:3]
    if operation in (UNIT, INPUT, PARAMETER):
        return ()
    return (x,) if operation == EXP else (x, y)
