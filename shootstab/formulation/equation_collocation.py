"""The candidate spectrum of a problem in equations: Chebyshev collocation of the equations as they stand, and QZ.

It shares the formulas with the way by the reduction and nothing else: no equation is differentiated, combined or brought to first order.
Unknown u_j is a polynomial with N + d_j coefficients, and equation i holds at N + c_i points, the zeros of a Chebyshev polynomial inside
the interval; the conditions make up the difference. With S_ij the highest derivative of u_j in equation i, the integers are the smallest
with

    d_j − c_i ≥ S_ij, and equality on n entries, one in each row and column, whose sum is largest,

so that Σ d_j − Σ c_i is the number of conditions: in the Navier–Stokes equations the pressure has one coefficient fewer than the
velocities, and continuity holds at one point more than momentum.

Source: T. A. Driscoll & N. Hale, IMA J. Numer. Anal. 36 (2016) 108 (rectangular collocation); J. D. Pryce, BIT 41 (2001) 364 (c and d).
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.polynomial import chebyshev as polynomials
from numpy.typing import NDArray
from scipy.optimize import linear_sum_assignment

from shootstab.core.errors import InputError
from shootstab.formulation.conditions import Conditions, Periodic
from shootstab.formulation.evaluation import on_arrays
from shootstab.formulation.statement import Statement
from shootstab.formulation.system import EquationRow, coefficients, degree
from shootstab.spectral import chebyshev, qz
from shootstab.spectral.qz import DenseMatrix, Spectrum

SMALLEST_TRUNCATION = 6  # chosen: the least order; below it the tail of a series is the whole series
MINUS_INFINITY = -1000.0  # chosen: stands for −∞ in S
BALANCES = 2  # chosen: rounds in which rows and columns are scaled to size one


@dataclass(frozen=True, eq=False)
class EquationCollocation:
    """See problems.capabilities.Pseudospectral: a statement between two finite ends. d and c belong to unknowns and equations."""

    statement: Statement
    d: tuple[int, ...]
    c: tuple[int, ...]

    def spectrum(self, M: int, filtered: bool = True) -> Spectrum:
        """The spectrum at N = M. Raises InputError below the smallest truncation."""
        if M < SMALLEST_TRUNCATION:
            raise InputError(f"M = {M!r}: allowed is an integer of at least {SMALLEST_TRUNCATION}")

        def unfold(vectors: DenseMatrix) -> DenseMatrix:
            """Values of the unknowns at the extrema, of the degree of the longest; N is what is left of a companion matrix's vectors."""
            lengths = self._lengths(M)
            total, most = sum(lengths), max(lengths)
            fields = np.zeros((vectors.shape[1], len(lengths), most), dtype=np.complex128)
            scaled = self.assembled(M)[2][:, None] * vectors[:total]
            for j, (first, length) in enumerate(zip(np.cumsum([0, *lengths[:-1]]), lengths, strict=True)):
                fields[:, j, :length] = scaled[first : first + length].T
            return chebyshev.values(fields)

        return qz.spectrum(lambda N: self.assembled(N)[:2], M, unfold, filtered)

    @property
    def ways(self) -> Mapping[str, Callable[[int, complex], tuple[complex, int]]]:
        """QZ alone."""
        return {"qz": lambda M, guess: (qz.nearest(self.spectrum(M, filtered=False), guess), 1)}

    def assembled(self, N: int) -> tuple[DenseMatrix, DenseMatrix, NDArray[np.float64]]:
        """A, B (N′, N′) with A x = σ B x, and scales (N′,): Chebyshev coefficients = scale · x.

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

    def _lengths(self, N: int) -> list[int]:
        return [N + d for d in self.d]

    def _powers(self, N: int) -> NDArray[np.complex128]:
        """The matrices before σ⁰, σ¹, …"""
        statement, lengths = self.statement, self._lengths(N)
        rows = [(row, self._points(N + c)) for row, c in zip(statement.system.rows, self.c, strict=True)]
        for end, conditions in ((statement.left, statement.left_rows), (statement.right, statement.right_rows)):
            if isinstance(end, Conditions):
                rows += [(row, np.array([float(end.at)])) for _, row in conditions]
        highest = max(degree(coefficient) for row, _ in rows for coefficient in row.values())
        parts = [self._sampled(row, z, lengths, highest) for row, z in rows]
        return np.concatenate(parts, axis=1)

    def _points(self, count: int) -> NDArray[np.float64]:
        low, high = self.statement.domain.left, self.statement.domain.right
        return np.asarray(0.5 * (low + high) + 0.5 * (high - low) * chebyshev.roots(count - 1))

    def _sampled(self, row: EquationRow, z: NDArray[np.float64], lengths: list[int], highest: int) -> NDArray[np.complex128]:
        """An equation at the points z, over the Chebyshev coefficients of the unknowns, (highest + 1, points, Σ lengths)."""
        low, high = self.statement.domain.left, self.statement.domain.right
        y, stretch = (2 * z - low - high) / (high - low), 2 / (high - low)
        at = on_arrays(z, self.statement.domain.given)
        starts = dict(zip(self.statement.names.unknowns, np.cumsum([0, *lengths[:-1]]).tolist(), strict=True))
        widths = dict(zip(self.statement.names.unknowns, lengths, strict=True))
        out = np.zeros((highest + 1, len(z), sum(lengths)), dtype=np.complex128)
        for (name, order), coefficient in row.items():
            width, first = widths[name], starts[name]
            derivative = polynomials.chebder(np.eye(width), order) * stretch**order if order else np.eye(width)
            basis = polynomials.chebvander(y, len(derivative) - 1) @ derivative
            with np.errstate(all="ignore"):  # what is not finite is refused
                for power, value in coefficients(coefficient).items():
                    out[power, :, first : first + width] += np.reshape(at(value) * np.ones(len(z)), (-1, 1)) * basis
        if not np.isfinite(out).all():
            raise InputError("a coefficient of the equations is not finite inside the domain, or one of the conditions at an end")
        return out


def collocation(statement: Statement) -> EquationCollocation | None:
    """The discretization of a statement; None in layers, with ends at infinity or periodic, and where conditions do not fit."""
    if not all(statement.finite) or isinstance(statement.left, Periodic) or statement.joints:
        return None
    unknowns = statement.names.unknowns
    S = np.full((len(unknowns), len(unknowns)), MINUS_INFINITY)
    for i, row in enumerate(statement.system.rows):
        for name, order in row:
            S[i, unknowns.index(name)] = max(S[i, unknowns.index(name)], order)
    _, chosen = linear_sum_assignment(-S)
    if S[np.arange(len(S)), chosen].min() < 0:
        return None
    c = np.zeros(len(S))
    for _ in range(int(S.max() + 2) * len(S) + 1):
        d = (S + c[:, None]).max(axis=0)
        following = d[chosen] - S[np.arange(len(S)), chosen]
        if (following == c).all():
            break
        c = following
    lacking = int(d.sum() - c.sum()) - len(statement.left_rows) - len(statement.right_rows)
    if lacking and not all(statement.holding):
        # a polynomial is regular at a singular end by itself: as many coefficients fewer as conditions, one for each of the highest orders
        for j in np.argsort(-d, kind="stable")[:lacking]:
            d[j] -= 1
        lacking -= min(max(lacking, 0), len(d)) if lacking <= len(d) else 0
    if lacking:
        return None
    return EquationCollocation(statement, tuple(int(x) for x in d), tuple(int(x) for x in c))
