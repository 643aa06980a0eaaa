"""The Taylor recurrence of y′ = f(y) by compiled loops: a `RelaxedSystem` of python-flint's numbers for kernels.limb_program."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from flint import arb, ctx

from shootstab.kernels import limb_program as program
from shootstab.multiprecision.limb_numbers import (
    HEAD_BITS,
    MOST_LIMB_BITS,
    Binary,
    Limbs,
    binary,
    exponent_of,
    limbs_of,
    numbers_of,
    planes,
)
from shootstab.multiprecision.relaxed_series import RelaxedSeries, RelaxedSystem

INSTRUCTIONS = {
    "neg": program.NEG,
    "add": program.ADD,
    "shift": program.COPY,
    "scale": program.SCALE,
    "part": program.SCALE,
    "mul": program.MUL,
    "over": program.OVER,
    "into": program.INTO,
    "pow": program.POW,
}
RAISES = 12  # chosen: exponents raised, each by a limb, before the unit is held to be too long


class RelaxedProgram:
    """The recurrence of unknowns y with slopes f(y): nodes of a system, the unknowns first."""

    @classmethod
    def of(cls, system: RelaxedSystem, unknowns: Sequence[RelaxedSeries], slopes: Sequence[RelaxedSeries]) -> RelaxedProgram | None:
        """The program, None where an operation has no instruction."""
        return cls(system, unknowns, slopes) if all(node.operation in INSTRUCTIONS for node in system.nodes) else None

    def __init__(self, system: RelaxedSystem, unknowns: Sequence[RelaxedSeries], slopes: Sequence[RelaxedSeries]) -> None:
        self._system, self._nodes = system, [*unknowns, *system.nodes]
        self._count = len(unknowns)
        self._place = place = {id(node): i for i, node in enumerate(self._nodes)}
        later = self._nodes[self._count :]
        self._code = np.array([program.COPY] * self._count + [INSTRUCTIONS[node.operation] for node in later])
        operands = [[place[id(x)] if isinstance(x, RelaxedSeries) else 0 for x in (*node.kept, None)[:2]] for node in later]
        first = [(0, 0)] * self._count + [
            (pair[1], pair[0]) if code in (program.OVER, program.INTO) else (pair[0], pair[1])
            for pair, code in zip(operands, self._code[self._count :], strict=True)
        ]
        self._left, self._right = (np.array(side) for side in zip(*first, strict=True))
        self._slopes = np.array([place[id(slope)] for slope in slopes])

    def expand(self, state: Sequence[Any], log_unit: int, terms: int) -> list[list[Any]] | None:
        """The coefficients of y in z from y at z = 0: see arithmetic.CompiledRecurrence."""
        start = self._start(state)
        if start is None:
            return None
        constants, exponents_of, first, exponents = start
        (unit_exponent,), unit = _columns([arb(2) ** log_unit])
        step = unit[:, 0].copy()
        for _ in range(RAISES):
            data, ends = self._beginning(first, exponents, terms)
            parts = self._code, self._left, self._right, constants, exponents_of, self._slopes, step, unit_exponent
            missed = program.solve(*parts, data, ends, np.array(exponents))
            if missed < 0:
                return self._found(data, exponents, log_unit)
            exponents[missed] += 1
        return None

    def expand_singular(self, state: Sequence[Any], shifts: Sequence[int], log_unit: int, terms: int) -> list[list[Any]] | None:
        """The same about a regular singular point: see arithmetic.CompiledRecurrence."""
        start = self._start(state)
        if start is None:
            return None
        constants, exponents_of, first, exponents = start
        for _ in range(RAISES):
            data, ends = self._beginning(first, exponents, terms)
            data[0, :, 1:2] = limbs_of([binary(arb(2) ** log_unit)], exponents[:1])
            ends[0] = 2 * (data[0, :, 1] != 0)
            parts = self._code, self._left, self._right, constants, exponents_of, self._slopes, np.array(shifts)
            missed = program.solve_singular(*parts, data, ends, np.array(exponents))
            if missed < 0:
                return self._found(data, exponents, log_unit)
            exponents[missed] += 1
        return None

    def _start(self, state: Sequence[Any]) -> tuple[Limbs, Limbs, list[Binary], list[int]] | None:
        """The constants and their exponents, and the first coefficients of all nodes and theirs; None where one is not finite."""
        if ctx.prec > MOST_LIMB_BITS:
            return None
        system = self._system
        system.clear()
        for node, value in zip(self._nodes[: self._count], state, strict=True):
            node.coefficients.append(value)
        system.extend(0)
        values = [node.coefficients[0] for node in self._nodes]
        constants, places = self._constants()
        if not all(x.is_finite() for x in (*values, *constants)):
            return None
        L, count = planes(), len(values)
        factors, exponents_of = np.zeros((count, 2, L), dtype=np.int64), np.zeros((count, 2), dtype=np.int64)
        sizes, columns = _columns(constants)
        for (i, k), e, column in zip(places, sizes, columns.T, strict=True):
            factors[i, k], exponents_of[i, k] = column, e
        first = [binary(x) for x in values]
        return factors, exponents_of, first, self._exponents(first)

    def _beginning(self, first: Sequence[Binary], exponents: Sequence[int], terms: int) -> tuple[Limbs, Limbs]:
        data = np.zeros((len(first), planes(), terms), dtype=np.int64)
        data[:, :, 0] = limbs_of(first, exponents).T
        return data, (data[:, :, 0] != 0).astype(np.int64)

    def _found(self, data: Limbs, exponents: Sequence[int], log_unit: int) -> list[list[Any]]:
        shifts = [-log_unit * m for m in range(data.shape[2])]
        return [numbers_of(data[q], [exponents[q]] * len(shifts), shifts) for q in range(self._count)]

    def _constants(self) -> tuple[list[Any], list[tuple[int, int]]]:
        """What the instructions hold beside their operands, and the node and the place of each: see kernels.limb_program.term."""
        found, places = [], []
        for i, (node, code) in enumerate(zip(self._nodes, self._code, strict=True)):
            if code == program.SCALE:
                factor = arb(node.kept[1])
                found.append(1 / factor if node.operation == "part" else factor)
                places.append((i, 0))
            elif code in (program.OVER, program.INTO, program.POW):
                found.append(1 / node.kept[0].coefficients[0])
                places.append((i, 0))
                if code == program.POW:
                    found.append(arb(node.kept[1]) + 1)
                    places.append((i, 1))
        return found, places

    def _exponents(self, first: Sequence[Binary]) -> list[int]:
        """Each by the first coefficient; that of a zero by its operands, as if nothing cancelled."""
        found = [exponent_of([x], HEAD_BITS) for x in first]
        largest = max((e for e in found[: self._count] if e is not None), default=0)
        out: list[int] = []
        for i, (e, node) in enumerate(zip(found, self._nodes, strict=True)):
            if e is None:
                sides = [out[self._place[id(x)]] for x in node.kept if isinstance(x, RelaxedSeries)]
                e = largest if not sides else sum(sides) if self._code[i] == program.MUL else max(sides)
            out.append(e)
        return out


def _columns(numbers: Sequence[Any]) -> tuple[list[int], Limbs]:
    """Numbers, each with an exponent of its own."""
    given = [binary(x) for x in numbers]
    exponents = [exponent_of([x]) or 0 for x in given]
    return exponents, limbs_of(given, exponents)
