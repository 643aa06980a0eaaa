"""What a zero of D by frames depends on: its derivative with respect to every number that D is made of, on one mesh.

Let E = B Q_N be the boundary matrix at a σ next to the zero, u and v the singular vectors of its smallest singular value on both sides, and
E′ its σ-derivative as the transport gives it. What changes the solution φ_{s+1} by δ at the end of a step moves the zero by

    δσ = −χ_{s+1} δ / (uᴴE′v),   φ_N = Q_N v,   χ_N = uᴴB,

with φ and χ by back-substitution (see kernels/frame_gradient.py). So one pass gives the shift by another table, far frame or wall, to first
order in what differs, and what random changes of all of them come to in the mean.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from shootstab.core import polynomial
from shootstab.core.scaled import EPSILON
from shootstab.discriminants.mesh import across_knots
from shootstab.discriminants.sampled_system import SampledSystem
from shootstab.kernels.frame_gradient import back_substitute, ends_of_steps, entries_at_random
from shootstab.kernels.reduced_system import ReducedSystem
from shootstab.kernels.tableau import STAGES
from shootstab.problems.protocol import ComplexArray, FarFrame

NOT_AT_THE_WALL = 0.1  # chosen: the part of D′/D that may come from elsewhere than from the boundary matrix
MEAN_SQUARE = 1.0 / 3.0  # derived: the mean square of a number drawn uniformly from −1 to 1


@dataclass(frozen=True, eq=False)
class Ingredients:
    """What D at a σ is made of: the sampled system, the rows at the wall by powers of σ, and the far frame.

    places (N,) are |z| of the steps, the largest that the system was computed from; None where C has to be solved with, so that its
    entries are not those of the system.
    """

    sampled: SampledSystem
    rows: tuple[ComplexArray, ...]
    far: FarFrame
    places: NDArray[np.float64] | None


@dataclass(frozen=True, eq=False)
class CarriedFrames:
    """The frames Y (N + 1, n, k) before each orthonormalization, the last one Q (n, k) at the wall and its σ-derivative.

    trace is what of d ln D/dσ was carried away by the orthonormalizations.
    """

    frames: NDArray[Any]
    last: NDArray[Any]
    slope: NDArray[Any]
    trace: complex


@dataclass(frozen=True, eq=False)
class ZeroGradient:
    """dσ by every number of the ingredients: numbers as `ReducedSystem.numbers`, frame (n, k) and wall (k, n).

    system is the sampled one in the numbers, real or complex, in which the zero was looked at.
    phi and chi (N + 1, n) are the solution and the left one; χ_{s+1} δ is the shift of the zero by a change δ of φ_{s+1}. components and
    products are the root of the sum of squares of what a relative change of 1 does in every component of the frame at every node, and in
    every product of an entry and a component.
    """

    sigma: complex
    of: Ingredients
    numbers: tuple[NDArray[Any], ...]
    frame: ComplexArray
    wall: ComplexArray
    system: ReducedSystem
    phi: NDArray[Any]
    chi: NDArray[Any]
    components: float
    products: float

    def shift(self, other: Ingredients) -> complex | None:
        """The way from this zero to that of other ingredients on the same mesh, to first order; None if their tables differ in what is
        zero."""
        here, there = self.of.sampled.made, other.sampled.made
        if not all(map(np.array_equal, here.structure, there.structure)):
            return None
        by_table = sum(np.vdot(g.conj(), b - a) for g, a, b in zip(self.numbers, here.numbers, there.numbers, strict=True))
        by_frame = np.vdot(self.frame.conj(), other.far.frame - self.of.far.frame)
        rows = (polynomial.value(rows, self.sigma) for rows in (other.rows, self.of.rows))
        return complex(by_table + by_frame + np.vdot(self.wall.conj(), np.subtract(*rows)))

    def by_step(self, halved: SampledSystem) -> ComplexArray:
        """Shifts (N,) of the zero by each step being replaced by those of a finer mesh, which has these nodes and others between."""
        at_node = np.isin(halved.nodes[:-1], self.of.sampled.nodes[:-1])
        begin = np.where(at_node, np.cumsum(at_node) - 1, -1)
        system = halved.system if self.phi.dtype.kind == "c" or halved.real is None else halved.real
        kind = system.P.dtype
        sigma = self.sigma if kind.kind == "c" else self.sigma.real
        ends = np.empty((len(begin), self.phi.shape[1]), kind)
        work = _work(system, self.phi.shape[1])
        phi = self.phi.astype(kind, copy=False)
        ends_of_steps(*_of_step(system, sigma), sigma, begin, phi, ends, *work)  # type: ignore[call-arg]
        last = np.append(np.flatnonzero(at_node)[1:] - 1, len(begin) - 1)
        return np.asarray(((ends[last] - self.phi[1:]) * self.chi[1:]).sum(axis=1), dtype=np.complex128)

    @cached_property
    def by_far_frame(self) -> float:
        """The root mean square of the shift where every component of the far frame is changed by as much as itself, in random phase."""
        return float(np.linalg.norm(self.frame * self.of.far.frame))

    @cached_property
    def by_entries(self) -> float | None:
        """The root mean square of the shift by random relative changes up to 1 of every entry and of z: those of
        `SampledSystem.perturbed`; None where C has to be solved with."""
        places = self.of.places
        if places is None:
            return None
        nodes = self.of.sampled.nodes
        knots = across_knots(nodes)
        moved, together = np.where(knots, 0.0, places / np.abs(np.diff(nodes))), np.where(knots, 1.0 / EPSILON, 0.0)
        square = 0.0
        for g, a in zip(self.numbers, self.system.numbers, strict=True):
            flat = (*g.shape[:2], math.prod(g.shape[2:]))
            if flat[2]:
                square += entries_at_random(g.reshape(flat), a.reshape(flat), moved, together, np.empty((2, flat[2]), g.dtype))
        return math.sqrt(MEAN_SQUARE * square)


def zero_gradient(of: Ingredients, sigma: complex, way: CarriedFrames) -> ZeroGradient | None:
    """The gradient at σ next to the zero from the frames carried there.

    None where it is not finite, and where D′/D is not that of the smallest singular value: a zero is then not known so exactly that the
    solution meets the wall, as behind a barrier through which a rounding grows to more than itself.
    """
    frames, Q, slope = way.frames.copy(), way.last, way.slope
    B, dB = polynomial.value(of.rows, sigma), polynomial.slope(of.rows, sigma)
    if frames.dtype.kind == "f":  # then the rows are real too
        B, dB = B.real, dB.real
    system = of.sampled.system if frames.dtype.kind == "c" else of.sampled.real
    assert system is not None
    n, k = Q.shape
    kind = frames.dtype
    with np.errstate(all="ignore"):  # what is not finite is found below
        sizes = np.abs(B) @ np.abs(frames).max(axis=(0, 2))
        sizes[~(sizes > 0.0)] = 1.0
        E = B @ Q / sizes[:, None]
        if not np.isfinite(E).all():
            return None
        U, singular, Vh = np.linalg.svd(E)
        slopes = np.diagonal(U.conj().T @ ((dB @ Q + B @ slope) / sizes[:, None]) @ Vh.conj().T)
        elsewhere = singular[-1] * (way.trace + (slopes[:-1] / singular[:-1]).sum())
        if not abs(elsewhere) <= NOT_AT_THE_WALL * abs(slopes[-1]):
            return None
        u, v = U[:, -1].conj() / sizes * (-1.0 / slopes[-1]), Vh[-1].conj()
        row, c = np.asarray(u @ B, dtype=kind), np.asarray(v, dtype=kind).copy()
        numbers = tuple(np.zeros(a.shape, kind) for a in system.numbers)
        phi, chi = np.empty((2, len(frames), n), kind)
        work = *_work(system, n), np.empty((k, k), kind), np.empty((2, STAGES, n + system.G.shape[3]), kind)
        squares = np.zeros(2)
        at = sigma if kind.kind == "c" else sigma.real
        given = *_of_step(system, at), at, frames, c, row
        back_substitute(*given, *work, phi, chi, *numbers, squares)  # type: ignore[call-arg]
    if not np.isfinite(squares).all():
        return None
    components, products = np.sqrt(squares).tolist()
    return ZeroGradient(sigma, of, numbers, np.outer(chi[0], c), np.outer(u, phi[-1]), system, phi, chi, components, products)


def _of_step(system: ReducedSystem, sigma: complex) -> tuple[NDArray[Any], ...]:
    """What a step at σ is made of: the system with γ⁻¹ (N, S, m, m) in place of the coefficients of γ."""
    gamma = polynomial.value(tuple(np.moveaxis(system.G, 2, 0)), sigma)
    inverse = 1.0 / gamma if gamma.shape[-1] == 1 else np.linalg.inv(gamma)
    return *system[:8], np.ascontiguousarray(inverse, dtype=system.P.dtype)


def _work(system: ReducedSystem, n: int) -> tuple[NDArray[Any], ...]:
    """Memory for a step of one vector: stages, their images and the entries of the system."""
    shapes = (STAGES + 2, n), (STAGES, n + system.G.shape[3]), (STAGES, len(system.column))
    return tuple(np.empty(shape, system.P.dtype) for shape in shapes)
