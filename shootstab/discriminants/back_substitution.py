"""The solution that belongs to a zero of D, and the one of the adjoint problem, by back-substitution through the factors of the frame.

On a mesh every step is a matrix, φ_{s+1} = M_s φ_s, and orthonormalized shooting factors M_s Q_s = Q_{s+1} R_{s+1}, F = Q_0 R_0 for the
far frame F. At a zero of D there is c with B Q_N c = 0, B = W0 + σ W1 + … the rows at the wall, and

    c_N = c,   c_s = R_{s+1}⁻¹ c_{s+1},   φ_s = Q_s c_s :

what is solved from the wall outwards are triangular systems, so that no growing solution enters (S. K. Godunov, Uspekhi Mat. Nauk 16
(1961) 171; Ascher, Mattheij & Russell, Numerical Solution of Boundary Value Problems (1988), 4.3).

The left solution is the row y(z) with (y C)′ = −y D, and ψ = yᴴ solves the adjoint system −(Cᴴψ)′ = Dᴴψ. With χ = y C its conditions are
χ = λᴴB at the wall and χ F = 0 at the far end; for then ∫ y (C v′ − D v) dz = 0 for every v with Bv = 0 at the wall and v in the span of F
at the far end. On the mesh χ_s = χ_{s+1} M_s, with λᴴ B Q_N = 0; it is kept orthogonal to Q_s, which is what χ F = 0 says further in.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
import scipy.linalg
from numpy.typing import NDArray

from shootstab.core.errors import ConvergenceError, InputError
from shootstab.core.polynomial import slope, value
from shootstab.discriminants.frame import Frame
from shootstab.discriminants.meshing import cut_for
from shootstab.discriminants.sampled_system import sample_system
from shootstab.discriminants.shooting import Shooting
from shootstab.kernels.tableau import STAGES
from shootstab.kernels.tableau import A as RK_A
from shootstab.kernels.tableau import B as RK_B
from shootstab.kernels.tableau import C as ABSCISSAE
from shootstab.problems.protocol import ComplexArray, Problem

# the part of a solution that may lie outside the decaying space begun farther out: half the digits of a double less two
ALIGNED = 1e-6  # chosen
FEWEST = 8  # chosen: steps on the way out that are tried first
NEWTON_STEPS = 3  # derived: Newton's steps from a mode that is right to half its digits to one that is right to rounding, with one to spare


@dataclass(frozen=True, eq=False)
class Solution:
    """The solution of a problem at a zero σ of D on nodes (N+1,) from the far end to the wall.

    phi (N+1, n) is the solution; chi (N+1, n) are the rows y C of the left one, and wall the λᴴ (k,) with χ = λᴴB at the wall. Both have an
    arbitrary factor. coefficients (k,) are those of φ in the far frame, and rtol is what local errors are held to.
    """

    problem: Problem
    sigma: complex
    nodes: ComplexArray
    phi: ComplexArray
    chi: ComplexArray
    wall: ComplexArray
    coefficients: ComplexArray
    rtol: float

    def at(self, z: ComplexArray) -> ComplexArray:
        """φ (m, n) at real points z (m,) inside the mesh: a step of the method from the node farther out."""
        order, node = self._places(z)
        start = self.nodes[node]
        M = step_matrices(self.problem, self.sigma, start, z[order] - start)
        return _back_in_order(M @ self.phi[node][:, :, None], order)

    def left_at(self, z: ComplexArray) -> ComplexArray:
        """y (m, n) at points z (m,): a step back from the node nearer to the wall, from which y C decays."""
        order, node = self._places(z)
        points, end = z[order], self.nodes[node + 1]
        M = step_matrices(self.problem, self.sigma, points, end - points)
        p = self.problem.pencil(points)
        chi = self.chi[node + 1][:, None, :] @ M
        return _back_in_order(np.linalg.solve(value(p.C, self.sigma).transpose(0, 2, 1), chi.transpose(0, 2, 1)), order)

    def reaching(self, z: float) -> Solution:
        """The solution on a mesh that begins at z, farther out, with local errors as they are on this one.

        Raises InputError where the problem gives no decaying space there whose solutions are those that decay at the first node.
        """
        first = self.nodes[0]
        count = math.ceil(abs(z - first) / np.abs(np.diff(self.nodes)).max())
        begin = sample_system(self.problem, np.linspace(z, first, max(count, FEWEST) + 1))
        nodes = cut_for(Shooting(self.problem, Frame(rtol=self.rtol), begin), [self.sigma]).sampled.nodes
        M = step_matrices(self.problem, self.sigma, nodes[:-1], np.diff(nodes))
        Q, R = _factored(self.problem.far_frame(z, self.sigma).frame, M)
        c = Q[-1].conj().T @ self.phi[0]
        if not np.abs(Q[-1] @ c - self.phi[0]).max() <= ALIGNED * np.abs(self.phi[0]).max():
            raise InputError(f"z = {z:.6g}: no decaying space is known there: allowed is z up to {first.real:.6g}")
        phi, chi, coefficients = _substituted(M, Q, R, c, self.chi[0])
        nodes, phi, chi = (np.concatenate((a[:-1], b)) for a, b in ((nodes, self.nodes), (phi, self.phi), (chi, self.chi)))
        return replace(self, nodes=nodes, phi=phi, chi=chi, coefficients=coefficients)

    def change(self, other: Problem, sigma: complex | None = None) -> complex:
        """λᴴ δB φ_N + χ_0 δF c + Σ χ_{s+1} δM_s φ_s, what another problem, or another σ, changes in the form of which D is the determinant.

        It vanishes to first order at a mode of the other problem, so that a mode moves by −(change of the problem)/(change per σ).
        """
        sigma = self.sigma if sigma is None else sigma
        start = float(self.nodes[0].real)
        frames = [problem.far_frame(start, at) for problem, at in ((other, sigma), (self.problem, self.sigma))]
        F, G = (far.frame for far in frames)
        steps = np.diff(self.nodes)
        moved = [step_matrices(problem, at, self.nodes[:-1], steps) for problem, at in ((other, sigma), (self.problem, self.sigma))]
        W, V = (value(problem.wall_rows(), at) for problem, at in ((other, sigma), (self.problem, self.sigma)))
        inside = np.einsum("si,sij,sj->", self.chi[1:], moved[0] - moved[1], self.phi[:-1])
        return complex(inside + self.wall @ (W - V) @ self.phi[-1] + self.chi[0] @ (F - G) @ self.coefficients)

    @cached_property
    def change_per_sigma(self) -> complex:
        """The derivative of `change` by σ at the same problem, by the σ-derivative of every step: dD/dσ but for a factor."""
        return self.change_per_sigma_of(self)

    def change_per_sigma_of(self, other: Solution) -> complex:
        """The same form of this left solution and of the φ of another solution on the mesh."""
        start = float(self.nodes[0].real)
        dW = slope(self.problem.wall_rows(), self.sigma)
        dF = self.problem.far_frame(start, self.sigma).tangent
        slopes = step_slopes(self.problem, self.sigma, self.nodes[:-1], np.diff(self.nodes), other.phi[:-1])
        inside = np.einsum("si,si->", self.chi[1:], slopes)
        return complex(inside + self.wall @ dW @ other.phi[-1] + self.chi[0] @ dF @ other.coefficients)

    def scaled(self, right: complex, left: complex) -> Solution:
        """φ and the left solution times these factors."""
        c, wall = self.coefficients * right, self.wall * left
        return replace(self, phi=self.phi * right, chi=self.chi * left, wall=wall, coefficients=c)

    @property
    def falling(self) -> bool:
        """Whether z falls from the far end to the wall."""
        return bool(self.nodes[-1].real < self.nodes[0].real)

    def _places(self, z: ComplexArray) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
        """The order in which the points follow each other on the way to the wall, and for each of them the last node before it."""
        turn = -1.0 if self.falling else 1.0
        order = np.argsort(turn * z.real)
        node = np.searchsorted(turn * self.nodes.real, turn * z[order].real, side="right") - 1
        return order, np.clip(node, 0, len(self.nodes) - 2)


def solution(shooting: Shooting, sigma: complex) -> Solution:
    """The solution on the mesh of a discriminant, at its own zero next to σ. Raises ConvergenceError where none is next to it."""
    sigma = complex(sigma)
    for _ in range(NEWTON_STEPS):
        sigma += shooting.with_derivative(sigma).newton_step
        if not np.isfinite(sigma):
            raise ConvergenceError("the iteration from the mode to the zero of D on this mesh does not arrive")
    return BoundaryMatrix.of(shooting, sigma).solutions(1)[0]


@dataclass(frozen=True, eq=False)
class BoundaryMatrix:
    """E(σ) = B Q_N (k, k) on the mesh of a discriminant, whose determinant is D but for a factor, with all that a solution is made of.

    singular_values (k,) rise; they are those of E with every row in the size that its terms have anywhere, as those of B Q_N may vanish at
    a mode, and so may components at the wall.
    """

    shooting: Shooting
    sigma: complex
    M: ComplexArray
    Q: list[ComplexArray]
    R: list[ComplexArray]
    B: ComplexArray
    rows: NDArray[np.float64]
    U: ComplexArray
    singular_values: NDArray[np.float64]
    Vh: ComplexArray

    @classmethod
    def of(cls, shooting: Shooting, sigma: complex) -> BoundaryMatrix:
        """The boundary matrix of a discriminant at σ."""
        problem, nodes = shooting.problem, shooting.sampled.nodes
        M = step_matrices(problem, sigma, nodes[:-1], np.diff(nodes))
        Q, R = _factored(shooting.far(sigma).frame, M)
        B = value(problem.wall_rows(), sigma)
        rows = np.abs(B) @ np.max(np.abs(Q), axis=(0, 2))
        rows[rows == 0.0] = 1.0  # a row with σ in it may vanish at the mode
        U, s, Vh = np.linalg.svd(B @ Q[-1] / rows[:, None])
        return cls(shooting, sigma, M, Q, R, B, rows, U[:, ::-1], s[::-1], Vh[::-1])

    def solutions(self, count: int) -> tuple[Solution, ...]:
        """The solutions of the smallest singular values, each with a left one; for a count of the kernel's dimension, bases of both."""
        return tuple(self._solution(self.Vh[i].conj(), self.U[:, i].conj() / self.rows) for i in range(count))

    def near_kernel(self, at_mode: BoundaryMatrix) -> Solution:
        """φ with B φ_N + b g = 0 and wᴴφ_N = 1, b and w the left and the right singular vector of the smallest singular value at a mode.

        It is analytic in σ, like the number g, which has a zero of the multiplicity of the mode where the kernel has dimension 1: φ is a
        root function, and the coefficients of its Taylor series are the chain of the mode.
        """
        k = len(self.rows)
        bordered = np.zeros((k + 1, k + 1), dtype=np.complex128)
        bordered[:k, :k] = self.B @ self.Q[-1] / at_mode.rows[:, None]
        bordered[:k, k] = at_mode.U[:, 0]
        bordered[k, :k] = (at_mode.Q[-1] @ at_mode.Vh[0].conj()).conj() @ self.Q[-1]
        c = np.asarray(np.linalg.solve(bordered, np.eye(k + 1)[k])[:k], dtype=np.complex128)
        return self._solution(c, at_mode.U[:, 0].conj() / at_mode.rows)

    def _solution(self, c: ComplexArray, wall: ComplexArray) -> Solution:
        phi, chi, coefficients = _substituted(self.M, self.Q, self.R, c, wall @ self.B)
        shooting = self.shooting
        nodes, rtol = shooting.sampled.nodes, shooting.propagator.rtol
        return Solution(shooting.problem, self.sigma, nodes, phi, chi, wall, coefficients, rtol)


def _back_in_order(columns: NDArray[np.complexfloating], order: NDArray[np.intp]) -> ComplexArray:
    """Rows (m, n) from columns (m, n, 1) that came in this order."""
    out = np.empty(columns.shape[:2], dtype=np.complex128)
    out[order] = columns[:, :, 0]
    return out


def _factored(frame: ComplexArray, M: ComplexArray) -> tuple[list[ComplexArray], list[ComplexArray]]:
    """Q_0 … Q_N and R_0 … R_N."""
    Q, R = ([x] for x in np.linalg.qr(frame))
    for step in M:
        q, r = np.linalg.qr(step @ Q[-1])
        Q.append(q)
        R.append(r)
    return Q, R


def _substituted(
    M: ComplexArray, Q: list[ComplexArray], R: list[ComplexArray], c: ComplexArray, row: ComplexArray
) -> tuple[ComplexArray, ComplexArray, ComplexArray]:
    """φ and χ (N+1, n) from c at the last node and the row χ there, outwards; and c in the far frame."""
    phi, chi = (np.empty((len(Q), len(row)), dtype=np.complex128) for _ in range(2))
    for s in range(len(Q) - 1, -1, -1):
        row = row - (row @ Q[s]) @ Q[s].conj().T
        phi[s], chi[s] = Q[s] @ c, row
        c = scipy.linalg.solve_triangular(R[s], c)
        if s > 0:
            row = row @ M[s - 1]
    return phi, chi, c


# one step of the method as a matrix


def _stage_matrices(problem: Problem, sigma: complex, starts: ComplexArray, h: ComplexArray, tangent: bool) -> tuple[ComplexArray, ...]:
    """hA, A = C(σ)⁻¹D(σ), at the 12 abscissae of steps of lengths h (N,) from starts, (N, 12, n, n); and its σ-derivative."""
    order = np.argsort(ABSCISSAE)
    back = np.argsort(order)
    points = (starts[:, None] + h[:, None] * ABSCISSAE[order]).ravel()
    p = problem.pencil(points)
    C = value(p.C, sigma)
    A = np.linalg.solve(C, value(p.D, sigma))
    parts = (A, np.linalg.solve(C, slope(p.D, sigma) - slope(p.C, sigma) @ A)) if tangent else (A,)
    shape = (len(h), STAGES, problem.size, problem.size)
    return tuple(part.reshape(shape)[:, back] * h[:, None, None, None] for part in parts)


def step_matrices(problem: Problem, sigma: complex, starts: ComplexArray, h: ComplexArray) -> ComplexArray:
    """M (N, n, n): one step of the pair of `tableau`, of length h (N,), from each of the starts, which come in the order of the path."""
    (A,) = _stage_matrices(problem, sigma, starts, h, False)
    one = np.broadcast_to(np.eye(problem.size, dtype=np.complex128), A[:, 0].shape)
    K = np.empty_like(A)
    for i in range(STAGES):
        K[:, i] = A[:, i] @ (one + np.tensordot(RK_A[i, :i], K[:, :i], (0, 1)))
    return np.asarray(one + np.tensordot(RK_B, K, (0, 1)))


def step_slopes(problem: Problem, sigma: complex, starts: ComplexArray, h: ComplexArray, phi: ComplexArray) -> ComplexArray:
    """(dM/dσ) φ (N, n) of such steps of length h (N,) from starts (N,), from phi (N, n)."""
    A, dA = _stage_matrices(problem, sigma, starts, h, True)
    K, L = (np.empty((*A.shape[:3], 1), dtype=np.complex128) for _ in range(2))
    for i in range(STAGES):
        y = phi[:, :, None] + np.tensordot(RK_A[i, :i], K[:, :i], (0, 1))
        K[:, i] = A[:, i] @ y
        L[:, i] = A[:, i] @ np.tensordot(RK_A[i, :i], L[:, :i], (0, 1)) + dA[:, i] @ y
    return np.asarray(np.tensordot(RK_B, L, (0, 1))[:, :, 0])
