"""The candidate spectrum of a problem in equations: collocation of the equations as they stand, and QZ.

It shares the formulas with the way by the reduction and nothing else: no equation is differentiated, combined or brought to first order.
Unknowns are Chebyshev polynomials between finite ends, rational Chebyshev functions that vanish at infinity (spectral/bases.py), and
Fourier's series over a period; equations hold at the zeros of the first function that is left out. Every layer has a basis of its own, and
conditions at ends and at interfaces are rows, with a column for each amplitude. How many coefficients and points there are is told in
collocation_counts.py. On an unbounded domain the basis has a length, which is that with which most eigenvalues stay where they are.

Source: T. A. Driscoll & N. Hale, IMA J. Numer. Anal. 36 (2016) 108 (rectangular collocation).
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from shootstab.core.errors import InputError
from shootstab.formulation.collocation_blocks import LayerBlock, UnknownColumns, highest_power, sampled
from shootstab.formulation.collocation_counts import ADVICE, Counts, conditions_needed, counts, without
from shootstab.formulation.collocation_length import DRIFT_COUNTED, PROBE, TAIL_COUNTED, best_length, centre, digits_held, largest_step
from shootstab.formulation.conditions import Conditions, CoupledEnd, Periodic
from shootstab.formulation.coupled_conditions import END_SIDES
from shootstab.formulation.joints import INTERFACE_SIDES
from shootstab.formulation.statement import Statement
from shootstab.formulation.system import EquationRow
from shootstab.spectral import qz
from shootstab.spectral.bases import Basis, BasisExtent, HalfLine, Interval, Line, Period
from shootstab.spectral.qz import DenseMatrix, Spectrum

SMALLEST_TRUNCATION = 6  # chosen: the least order; below it the tail of a series is the whole series
BALANCES = 2  # chosen: rounds in which rows and columns are scaled to size one


@dataclass(frozen=True, eq=False)
class EquationCollocation:
    """See problems.capabilities.Pseudospectral. counts are those of each layer, from left to right."""

    statement: Statement
    counts: tuple[Counts, ...]
    length: float | None = None

    def spectrum(self, M: int, filtered: bool = True) -> Spectrum:
        """The spectrum at N = M. Raises InputError below the smallest truncation."""
        if M < SMALLEST_TRUNCATION:
            raise InputError(f"M = {M!r}: allowed is an integer of at least {SMALLEST_TRUNCATION}")
        return self._spectrum(M, filtered)

    def _spectrum(self, M: int, filtered: bool, drift: float = qz.DRIFT_TOLERANCE, tail: float = qz.TAIL_TOLERANCE) -> Spectrum:

        def unfold(vectors: DenseMatrix) -> DenseMatrix:
            """Coefficients of the unknowns of all layers, each as many as of the longest."""
            expanded = [(block.basis, shape) for block in self._blocks(M) for shape in block.shapes]
            scale = self.assembled(M)[2]
            scaled = scale[:, None] * vectors[: len(scale)]  # what is left is of a companion matrix's vectors
            fields = np.zeros((vectors.shape[1], len(expanded), max(shape.width for _, shape in expanded)), dtype=np.complex128)
            first = 0
            for j, (basis, shape) in enumerate(expanded):
                fields[:, j, : shape.width] = (basis.series(shape) @ scaled[first : first + shape.width]).T
                first += shape.width
            return fields

        return qz.spectrum(lambda N: self.assembled(N)[:2], M, unfold, filtered, drift, tail)

    @property
    def ways(self) -> Mapping[str, Callable[[int, complex], tuple[complex, int]]]:
        """QZ alone."""
        return {"qz": lambda M, guess: (qz.nearest(self.spectrum(M, filtered=False), guess), 1)}

    def assembled(self, N: int) -> tuple[DenseMatrix, DenseMatrix, NDArray[np.float64]]:
        """A, B (N′, N′) with A x = σ B x, and scales (N′,): coefficients, and amplitudes behind them, = scale · x.

        Where σ occurs to higher powers, x goes on with σ x, …
        """
        powers = self._powers(N)
        size = np.abs(powers).max(axis=0)
        scale = np.ones(size.shape[1])
        for _ in range(BALANCES):
            rows = 1.0 / size.max(axis=1)
            powers, size = powers * rows[:, None], size * rows[:, None]
            columns = 1.0 / size.max(axis=0)
            powers, size, scale = powers * columns, size * columns, scale * columns
        q, n = len(powers) - 1, len(size)
        A, B = (np.zeros((q, n, q, n), dtype=np.complex128) for _ in range(2))
        for m in range(q - 1):
            A[m, :, m + 1] = B[m, :, m] = np.eye(n)
        for m in range(q):
            A[-1, :, m] = -powers[m]
        B[-1, :, -1] = powers[q]
        left, right = A.reshape(q * n, q * n), B.reshape(q * n, q * n)
        if not (left.imag.any() or right.imag.any()):
            return left.real, right.real, scale
        return left, right, scale

    @cached_property
    def _length(self) -> float:
        """The length of the basis on an unbounded domain."""
        if self.length is not None or all(self.statement.finite):
            return self.length or 1.0

        def held(length: float) -> float:
            return digits_held(replace(self, length=length)._spectrum(PROBE, True, DRIFT_COUNTED, TAIL_COUNTED))

        def step(length: float) -> float:
            blocks = replace(self, length=length)._blocks(PROBE)
            return max(largest_step(block.layer, block.basis.points(PROBE).z) for block in blocks if not isinstance(block.basis, Interval))

        return best_length(held, step)

    @cached_property
    def _centre(self) -> float:
        return centre(self.statement.layers[0])

    def _blocks(self, N: int) -> list[LayerBlock]:
        if isinstance(self.statement.left, Periodic):
            N += 1 - N % 2  # a cosine of the highest frequency without its sine would be one of two modes that nearly are one
        out, first = [], 0
        for layer, found in zip(self.statement.layers, self.counts, strict=True):
            block = LayerBlock(layer, found, self._basis(layer.domain.left, layer.domain.right), N, first)
            out.append(block)
            first += sum(block.lengths)
        return out

    def _basis(self, low: float, high: float) -> Basis:
        if isinstance(self.statement.left, Periodic):
            return Period(low, high)
        if np.isfinite(low) and np.isfinite(high):
            return Interval(low, high)
        if np.isfinite(low):
            return HalfLine(low, 1, self._length)
        return HalfLine(high, -1, self._length) if np.isfinite(high) else Line(self._centre, self._length)

    def _powers(self, N: int) -> NDArray[np.complex128]:
        """The matrices before σ⁰, σ¹, …"""
        statement, blocks = self.statement, self._blocks(N)
        given = statement.domain.given
        width = blocks[-1].first + sum(blocks[-1].lengths)
        amplitudes = sum(len(joint.amplitudes) for joint in statement.joints)
        shape = highest_power(self._all_rows) + 1, width + amplitudes
        parts = [rows for block in blocks for rows in block.equations(shape)]
        ends = (statement.left, statement.left_rows, blocks[0], -1), (statement.right, statement.right_rows, blocks[-1], 1)
        for end, conditions, block, side in ends:
            if isinstance(end, Conditions | CoupledEnd):
                at = block.basis.end(side)
                parts += [sampled(row, at.z, block.columns(at), shape, given) for _, row in conditions]
        if statement.coupled:
            (block,) = blocks
            sides = zip(END_SIDES, (-1, 1), strict=True)
            both = {f"{word}({name})": at for word, side in sides for name, at in block.columns(block.basis.end(side)).items()}
            parts += [sampled(row, np.zeros(1), both, shape, given) for _, row in statement.coupled]
        for joint, before, behind in zip(statement.joints, blocks[:-1], blocks[1:], strict=True):
            columns: dict[str, UnknownColumns] = {}
            for word, block, side in zip(INTERFACE_SIDES, (before, behind), (1, -1), strict=True):
                columns |= {f"{word}({name})": found for name, found in block.columns(block.basis.end(side)).items()}
            for name in joint.amplitudes:
                columns[name] = UnknownColumns(width, BasisExtent(1))
                width += 1
            parts += [sampled(row, np.array([joint.at]), columns, shape, given) for _, row in joint.rows]
        return np.concatenate(parts, axis=1)

    @cached_property
    def _all_rows(self) -> list[EquationRow]:
        statement = self.statement
        of_places = [row for _, row in (*statement.left_rows, *statement.right_rows)]
        of_joints = [row for joint in statement.joints for _, row in joint.rows]
        of_both = [row for _, row in statement.coupled]
        return [*(row for layer in statement.layers for row in layer.system.rows), *of_places, *of_both, *of_joints]


def offered(statement: Statement) -> tuple[EquationCollocation | None, Mapping[str, str]]:
    """The discretization, or None and why not, as problems.capabilities asks for it."""
    try:
        return collocation(statement), {}
    except InputError as error:
        return None, {"pseudospectral": str(error)}


def collocation(statement: Statement) -> EquationCollocation:
    """The discretization of a statement. Raises InputError where conditions do not fit the derivatives in its equations."""
    found = [counts(layer.system) for layer in statement.layers]
    needed = [conditions_needed(one) for one in found]
    if isinstance(statement.left, Periodic):
        return EquationCollocation(statement, tuple(without(one, n) for one, n in zip(found, needed, strict=True)))
    joints = sum(len(joint.rows) - len(joint.amplitudes) for joint in statement.joints)
    held = len(statement.left_rows) + len(statement.right_rows) + len(statement.coupled) + joints
    # the basis does what conditions would at ends that have none; two such ends, in two layers, take as many each
    open_layers = sorted({j for j, closed in zip((0, len(found) - 1), statement.closed, strict=True) if not closed})
    fewer = sum(needed) - held
    share = fewer // max(len(open_layers), 1)
    if fewer < 0 or share * len(open_layers) != fewer:
        most = " at most" if open_layers else ""
        told = f"by the derivatives that they hold they ask for {sum(needed)} conditions{most}, and have {held}"
        raise InputError(f"no collocation of the equations as they stand: {told}: {ADVICE}")
    return EquationCollocation(statement, tuple(without(one, share if j in open_layers else 0) for j, one in enumerate(found)))
