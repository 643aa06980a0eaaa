"""How sensitive a mode is to the problem: its condition number, and how much φ and ψ cancel in their product.

With the left solution y scaled so that ∫ y M φ + λᴴ ∂_σB φ = 1, M = ∂_σD − ∂_σC d/dz, a change of the problem moves a simple mode by
−∫ y (δD − δC d/dz) φ − λᴴ δB φ to first order. So a relative change ε of every entry of C, D and B, its sign and phase as bad as
can be, moves it by ε κ with

    κ = ∫ |y| (|C| |φ′| + |D| |φ|) |dz| + |λᴴ| |B| |φ|.

Source: D. J. Higham & N. J. Higham, SIAM J. Matrix Anal. Appl. 20 (1998) 493, for matrices. The other number is

    ∫ Σ_i |y_i (Mφ)_i| |dz| + … over |∫ y M φ dz + …| = 1,

which for −u″ + V u = λu is ∫|u|²/|∫u²|, the norm of the spectral projection (Davies, Proc. R. Soc. Lond. A 455 (1999) 585).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from shootstab.core.polynomial import slope, value
from shootstab.discriminants.back_substitution import Solution
from shootstab.problems.protocol import ComplexArray


@dataclass(frozen=True)
class Conditioning:
    """absolute: κ, |δσ| per relative change of every entry; relative: κ/|σ|, infinite at σ = 0. nonnormality ≥ 1: 1 without
    cancellation."""

    absolute: float
    relative: float
    nonnormality: float

    def as_dict(self) -> dict[str, float]:
        """The absolute and the relative condition and the nonnormality by name, for JSON."""
        return {"absolute": self.absolute, "relative": self.relative, "nonnormality": self.nonnormality}


def conditioning(solved: Solution) -> Conditioning:
    """The condition of a solution, scaled as above."""
    absolute, nonnormality = _integrals(solved, solved)
    return Conditioning(absolute, absolute / abs(solved.sigma) if solved.sigma != 0 else float("inf"), max(1.0, nonnormality))


def joint_conditioning(basis: Sequence[Solution]) -> tuple[Conditioning, ...]:
    """The conditions of a basis of all solutions at a semisimple mode and of the left ones, with ∫ y_i M φ_j + … = δ_ij.

    The zeros move by the eigenvalues of the matrix with entries −∫ y_i (δD − δC d/dz) φ_j − …, and so by at most ε times the spectral
    radius of that of the κ_ij. Every function has that condition, and a nonnormality of its own.
    """
    pairs = [[_integrals(left, right) for right in basis] for left in basis]
    together = float(np.abs(np.linalg.eigvals([[absolute for absolute, _ in row] for row in pairs])).max())
    size = abs(basis[0].sigma)
    relative = together / size if size > 0.0 else float("inf")
    return tuple(Conditioning(together, relative, max(1.0, row[i][1])) for i, row in enumerate(pairs))


def _integrals(left: Solution, right: Solution) -> tuple[float, float]:
    """κ and the other number of a left solution and a right one on one mesh; by Simpson's rule on the steps of it, to some percent."""
    p, sigma = right.problem, right.sigma
    middles = 0.5 * (right.nodes[:-1] + right.nodes[1:])
    points = np.empty(2 * len(middles) + 1, dtype=np.complex128)
    points[::2], points[1::2] = right.nodes, middles
    phi = np.empty((len(points), p.size), dtype=np.complex128)
    phi[::2], phi[1::2] = right.phi, right.at(middles)
    chi = np.empty_like(phi)
    pencil = p.pencil(points)
    C, D, dC, dD = value(pencil.C, sigma), value(pencil.D, sigma), slope(pencil.C, sigma), slope(pencil.D, sigma)
    chi[::2] = left.chi
    chi[1::2] = _times(left.left_at(middles), C[1::2])
    y = np.linalg.solve(C.transpose(0, 2, 1), chi[:, :, None])[:, :, 0]
    phi_z = np.linalg.solve(C, np.einsum("mij,mj->mi", D, phi)[:, :, None])[:, :, 0]
    moved = np.einsum("mij,mj->mi", dD, phi) - np.einsum("mij,mj->mi", dC, phi_z)
    weights = np.zeros(len(points))
    lengths = np.abs(np.diff(right.nodes)) / 6.0
    weights[1::2] = 4.0 * lengths
    weights[:-1:2] += lengths
    weights[2::2] += lengths
    entries = np.einsum("mij,mj->mi", np.abs(C), np.abs(phi_z)) + np.einsum("mij,mj->mi", np.abs(D), np.abs(phi))
    rows = p.wall_rows()
    wall, last = np.abs(left.wall), np.abs(right.phi[-1])
    absolute = float(weights @ (np.abs(y) * entries).sum(axis=1) + wall @ np.abs(value(rows, sigma)) @ last)
    at_wall = np.abs(left.wall * (slope(rows, sigma) @ right.phi[-1])).sum()
    return absolute, float(weights @ np.abs(y * moved).sum(axis=1) + at_wall)


def _times(rows: ComplexArray, matrices: ComplexArray) -> ComplexArray:
    return np.asarray(np.einsum("mi,mij->mj", rows, matrices))
