"""A problem on a fixed mesh: what does not depend on σ, computed once.

At every Runge–Kutta abscissa the pencil is reduced to

    A(σ) = C⁻¹D = X(σ) + V γ(σ)⁻¹ τ(σ),   X, γ and τ polynomials: where C and D are affine, γ is affine and τ of degree 2.

The rows of C that σ does not enter fix ψ′ up to the null space V of those rows; the m rows that it does enter fix the rest. m is 0 for most
problems and 1 for the chute, and det C vanishes where det γ does: nothing is divided by that is not singular in truth.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise, product
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from shootstab.core.errors import InputError
from shootstab.core.scaled import EPSILON
from shootstab.discriminants.mesh import across_knots
from shootstab.kernels.elimination import solve_each
from shootstab.kernels.recorded_programs import evaluate
from shootstab.kernels.reduced_system import ReducedSystem
from shootstab.kernels.tableau import STAGES
from shootstab.kernels.tableau import C as ABSCISSAE
from shootstab.problems.capabilities import RECORDED
from shootstab.problems.protocol import ComplexArray, Pencil, PencilSource
from shootstab.problems.recorded_pencil import RecordedPencil, ReducedPencil

STEPS_AT_A_TIME = 1024  # chosen: steps sampled together: what is needed on the way takes ten times the memory of what is kept
OF_A_BYTE = np.linspace(-1.0, 1.0, 256)  # chosen: what a random byte means, where the size of an effect is measured by its mean square
LARGE_COMPLETION = 1e8  # chosen: entries of V beyond which unit vectors complete C badly; half the digits of a double are lost there
BYTES_OF_ENTRY = 24  # derived: 8 of a real number and 16 of a complex one


@dataclass(frozen=True, eq=False)
class SampledSystem:
    """nodes (N+1,) from the far end to the wall; the reduced system on the N steps, in real or in complex numbers as it was made."""

    nodes: ComplexArray
    made: ReducedSystem

    @cached_property
    def system(self) -> ReducedSystem:
        """The system in complex numbers."""
        return self.made.in_complex_numbers()

    @cached_property
    def real(self) -> ReducedSystem | None:
        """The system in real numbers, None if it is not real."""
        return self.made.in_real_numbers()

    @property
    def bytes_of_a_step(self) -> int:
        """How much memory one step takes in real and in complex numbers."""
        return sum(BYTES_OF_ENTRY * a.size for a in self.made.numbers) // (len(self.nodes) - 1)

    def numbers(self, sigma: complex, *arrays: ComplexArray) -> tuple[Any, ...]:
        """The system, σ and copies of arrays for a kernel: as real numbers where all of them are, and complex ones otherwise."""
        if sigma.imag == 0.0 and not any(a.imag.any() for a in arrays) and self.real is not None:
            return self.real, sigma.real, *(a.real.copy() for a in arrays)
        return self.system, sigma, *(a.astype(np.complex128, order="C") for a in arrays)

    def perturbed(self, seed: int, size: float, places: NDArray[np.float64]) -> SampledSystem:
        """Every entry changed by random relative amounts of this size, real and imaginary parts apart, so that what is real stays so.

        One along all of the path, as a constant that it is made of rounds, and one at every abscissa, as the entry itself and the step do.
        places (N,) are |z| of the steps: z rounds too, by the same relative amount, and moves an entry by its slope. A step over a knot is
        longer or shorter by as many of its lengths as size holds roundings: no place is known better than to one.
        """
        random = np.random.default_rng(seed)
        knots = across_knots(self.nodes)
        moved = np.where(knots, 0.0, places / np.abs(np.diff(self.nodes)))  # steps, for a relative amount of 1

        def part(a: NDArray[np.float64]) -> NDArray[np.float64]:
            along = random.uniform(-1.0, 1.0, a.shape[2:])
            draws = OF_A_BYTE[np.frombuffer(random.bytes(2 * a.size), np.uint8)].reshape(2, *a.shape)
            by_place = np.ptp(a, axis=1, keepdims=True) * moved.reshape(-1, *(1,) * (a.ndim - 1))
            changed = a + size * (a * (along + draws[0]) + by_place * draws[1])
            changed[knots] += a[knots] * random.uniform(-1.0, 1.0, (knots.sum(), *(1,) * (a.ndim - 1))) * size / EPSILON
            return np.asarray(changed)

        numbers = (part(np.ascontiguousarray(a).view(np.float64)).view(a.dtype) for a in self.made.numbers)
        P, V, G = numbers
        return SampledSystem(self.nodes, self.made._replace(P=P, V=V, G=G))


def sample_system(problem: PencilSource, nodes: NDArray[np.complexfloating]) -> SampledSystem:
    """A problem sampled on a mesh with nodes (N+1,).

    Raises InputError where the pencil is of the wrong shape, not finite, or of deficient rank.
    """
    at: ComplexArray = np.asarray(nodes, dtype=np.complex128)
    return SampledSystem(at, _sampled(problem, at[:-1], np.diff(at)))


def resample(problem: PencilSource, nodes: NDArray[np.complexfloating], known: SampledSystem) -> SampledSystem:
    """The same as `sample_system` on nodes (N + 1,), with the steps copied that another mesh of the same path has too."""
    at: ComplexArray = np.asarray(nodes, dtype=np.complex128)
    places = {step: i for i, step in enumerate(pairwise(known.nodes.tolist()))}
    old = np.array([places.get(step, -1) for step in pairwise(at.tolist())])
    fresh = np.flatnonzero(old < 0)
    if 2 * len(fresh) > len(old):
        return sample_system(problem, at)
    P, V, G = (a[old] for a in known.made.numbers)
    if len(fresh):
        new = _sampled(problem, at[:-1][fresh], np.diff(at)[fresh])
        same = all(map(np.array_equal, new.structure, known.made.structure))
        if not same or new.P.dtype != P.dtype:
            return sample_system(problem, at)  # an entry, or all imaginary parts, vanish on one of the two
        P[fresh], V[fresh], G[fresh] = new.numbers
    return SampledSystem(at, known.made._replace(P=P, V=V, G=G))


def mixed(problem: PencilSource, nodes: ComplexArray, one: SampledSystem, other: SampledSystem) -> SampledSystem:
    """The same as `sample_system` on nodes (N + 1,) whose steps are those of two meshes, from which they are copied."""
    alike = all(map(np.array_equal, one.made.structure, other.made.structure)) and one.made.P.dtype == other.made.P.dtype
    places = {step: i for i, step in enumerate(step for mesh in (one, other) for step in pairwise(mesh.nodes.tolist()))}
    old = [places.get(step, -1) for step in pairwise(nodes.tolist())]
    if not alike or -1 in old:
        return sample_system(problem, nodes)
    P, V, G = (np.concatenate(both)[old] for both in zip(one.made.numbers, other.made.numbers, strict=True))
    return SampledSystem(nodes, one.made._replace(P=P, V=V, G=G))


def _sampled(problem: PencilSource, starts: ComplexArray, h: ComplexArray) -> ReducedSystem:
    """The system on steps of these lengths from these points, in the order of the path, STEPS_AT_A_TIME of them together."""
    recorded = RECORDED.of(problem)
    formula = None if recorded is None else recorded.reduced
    if formula is not None:
        points, back = _abscissae(starts, h)
        system = _computed(recorded, formula, points.ravel(), np.repeat(h, STAGES), back)
        if system is not None:
            return system
    chunks = [slice(first, first + STEPS_AT_A_TIME) for first in range(0, len(h), STEPS_AT_A_TIME)]
    made, present = [], []
    for chunk in chunks:
        reduced = _reduced(problem, starts[chunk], h[chunk])
        present.append(_present(*reduced))
        made.append(sample(h[chunk], *reduced, present[-1]))
    if len(made) == 1:
        return made[0]
    if len({(p.entries.shape, p.rows.shape) for p in present}) > 1:  # σ enters other rows of C in one chunk than in another
        reduced = _reduced(problem, starts, h)
        return sample(h, *reduced, _present(*reduced))
    whole = Present(np.asarray(sum(p.entries for p in present), dtype=np.bool_), np.asarray(sum(p.rows for p in present), dtype=np.bool_))
    for i, chunk in enumerate(chunks):
        if not all(map(np.array_equal, present[i], whole)):  # an entry vanishes all over it
            made[i] = sample(h[chunk], *_reduced(problem, starts[chunk], h[chunk]), whole)
    P, V, G = (np.concatenate(arrays) for arrays in zip(*(system.numbers for system in made), strict=True))
    return made[0]._replace(P=P, V=V, G=G)


def _abscissae(starts: ComplexArray, h: ComplexArray) -> tuple[ComplexArray, NDArray[np.int64]]:
    """The points (N, 12) of the steps in the order of the path, and where among them each abscissa of the pair stands."""
    order = np.argsort(ABSCISSAE)
    return starts[:, None] + h[:, None] * ABSCISSAE[order], np.argsort(order)


def _reduced(problem: PencilSource, starts: ComplexArray, h: ComplexArray) -> tuple[ComplexArray, ComplexArray, ComplexArray, ComplexArray]:
    """X, V, G, T of `reduce_pencil` at the abscissae of the steps, each (N, 12, …)."""
    points, back = _abscissae(starts, h)
    X, V, G, T = (a.reshape(len(h), STAGES, *a.shape[1:])[:, back] for a in reduce_pencil(problem.pencil(points.ravel()), problem.size))
    return X, V, G, T


def _computed(
    recorded: RecordedPencil, formula: ReducedPencil, points: ComplexArray, h: ComplexArray, back: NDArray[np.int64]
) -> ReducedSystem | None:
    """The system by a program, at points in the order of the path with the lengths of their steps; back is the order of the abscissae.

    None where V is large or numbers are not finite: elimination then takes pivots by size, or says what is wrong.
    """
    fields = recorded.fields(points)
    kind = np.float64 if formula.program.real and fields.dtype.kind == "f" and not h.imag.any() else np.complex128
    inputs = np.concatenate((fields, (h if kind is np.complex128 else h.real)[None])).astype(kind, copy=False)
    parameters, lengths = recorded.parameters.astype(kind), np.abs(h).reshape(-1, STAGES, 1)
    entries, carried, _ = formula.counts
    numbers = [np.empty((len(lengths), STAGES, count), dtype=kind) for count in formula.counts]
    for first in range(0, len(lengths), STEPS_AT_A_TIME):
        chunk = slice(first, first + STEPS_AT_A_TIME)
        values = evaluate(formula.program, np.ascontiguousarray(inputs[:, STAGES * first : STAGES * chunk.stop]), parameters)
        at_stages = values.T.reshape(-1, STAGES, len(values))[:, back]
        parts = np.split(at_stages, (entries, entries + carried), axis=2)
        if not (np.isfinite(values).all() and (np.abs(parts[1]) < LARGE_COMPLETION * lengths[chunk]).all()):
            return None
        for whole, part in zip(numbers, parts, strict=True):
            whole[chunk] = part
    lists = formula.start, formula.column, formula.linear, formula.higher, formula.powers, formula.carries
    m = formula.moving
    shapes = (entries,), (len(formula.carries), m), (formula.of_gamma, m, m)
    shaped = (a.reshape(len(lengths), STAGES, *shape) for a, shape in zip(numbers, shapes, strict=True))
    return ReducedSystem(*(np.array(a, dtype=np.uint64) for a in lists), *shaped)  # type: ignore[arg-type]


class Present(NamedTuple):
    """The entries (·, n + m, n) of [X; τ], by the power of σ, and the rows (n,) of V that are not zero everywhere."""

    entries: NDArray[np.bool_]
    rows: NDArray[np.bool_]


def _present(X: ComplexArray, V: ComplexArray, G: ComplexArray, T: ComplexArray) -> Present:
    """What is present in the arrays of `sample`."""
    n, m = V.shape[2:]
    entries = np.zeros((max(2, X.shape[2], T.shape[2]), n + m, n), dtype=np.bool_)
    entries[: X.shape[2], :n] = X.any(axis=(0, 1))
    entries[: T.shape[2], n:] = T.any(axis=(0, 1))
    # the rows of τ have the same columns: γ⁻¹ mixes them
    entries[0, n:] |= T.any(axis=(0, 1, 2, 3))
    return Present(entries, np.asarray(V.any(axis=(0, 1, 3))))


def sample(
    h: ComplexArray, X: ComplexArray, V: ComplexArray, G: ComplexArray, T: ComplexArray, present: Present | None = None
) -> ReducedSystem:
    """The reduced system at the abscissae of N steps of lengths h, in the form that the kernels take; with what is present in it, or more.

    X (N, 12, ·, n, n), V (N, 12, n, m), G (N, 12, ·, m, m), T (N, 12, ·, m, n): of X, G and T as many powers of σ as they have.
    """
    n, m = V.shape[2:]
    held = _present(X, V, G, T) if present is None else present
    lengths = h[:, None, None, None]
    stacked = np.zeros((len(h), STAGES, len(held.entries), n + m, n), dtype=np.complex128)
    stacked[:, :, : X.shape[2], :n] = X * lengths[..., None]
    stacked[:, :, : T.shape[2], n:] = T
    row, column = np.nonzero(held.entries.any(axis=0))
    start = np.searchsorted(row, np.arange(n + m + 1))
    linear = np.flatnonzero(held.entries[1, row, column])
    powers, higher = np.nonzero(held.entries[2:, row, column])
    carries = np.flatnonzero(held.rows)
    entries = stacked[:, :, :, row, column]
    P = np.concatenate((entries[:, :, 0], entries[:, :, 1, linear], entries[:, :, 2 + powers, higher]), axis=2)
    numbers = map(np.ascontiguousarray, (P, V[:, :, carries] * lengths, G))
    lists = (start, column, linear, higher, 2 + powers, carries)
    return ReducedSystem(*(a.astype(np.uint64) for a in lists), *numbers)  # type: ignore[arg-type]


def reduce_pencil(pencil: Pencil, n: int) -> tuple[ComplexArray, ComplexArray, ComplexArray, ComplexArray]:
    """X (p, q, n, n), V (p, n, m), G (p, q, m, m), T (p, 2q − 1, m, n) at p points, q ≥ 2 the powers of σ that the pencil has.

    With X and V such that the rows of C that σ does not enter hold for ψ′ = X ψ + V y, whatever y is, the others are γ y = τ ψ with

        γ = C V,   τ = D − C X.
    """
    for name, M in pencil.named.items():
        if M.shape[1:] != (n, n):
            raise InputError(f"the pencil's {name} has shape {M.shape[1:]}: allowed is ({n}, {n})")
        if not np.isfinite(M).all():
            raise InputError(f"the pencil's {name} is not finite at every point")
    C0, D = pencil.C0, pencil.D
    entered = np.any([M != 0 for M in pencil.C[1:]], axis=(0, 1))
    moving = np.flatnonzero(entered.any(axis=1))
    fixed = np.setdiff1d(np.arange(n), moving)
    m, p = len(moving), len(C0)
    if m == 0 and (np.eye(n) == C0).all():  # nothing to solve
        none = np.zeros((p, n, 0), dtype=np.complex128)
        return np.stack(D, 1), none, np.zeros((p, len(D), 0, 0), dtype=np.complex128), np.zeros((p, 1, 0, n), dtype=np.complex128)
    columns = np.flatnonzero(entered.any(axis=0))
    D_fixed = [M[:, fixed] for M in D]
    right = _completed(C0[:, fixed], D_fixed, columns) if len(columns) == m else None
    if right is None:
        right = _completed(C0[:, fixed], D_fixed, None)
    if right is None:
        told = "the rows of the pencil's C that sigma does not enter are dependent at some z: C is singular there for every sigma"
        advice = "one equation with a derivative for every component; one without gives a component, to be put into the others"
        raise InputError(f"{told}: allowed is {advice} (st.equations does that)")
    *X, V = np.split(right, n * np.arange(1, len(D) + 1), axis=2)
    C_moving = [M[:, moving] for M in pencil.C]
    T = [M[:, moving] for M in D] + [np.zeros((p, m, n), dtype=np.complex128) for _ in D[1:]]
    for (i, M), (j, x) in product(enumerate(C_moving), enumerate(X)):
        T[i + j] = T[i + j] - M @ x
    return np.stack(X, 1), V, np.stack([M @ V for M in C_moving], 1), np.stack(T, 1)


def _completed(C: ComplexArray, D: list[ComplexArray], columns: NDArray[np.int64] | None) -> ComplexArray | None:
    """X0, X1, …, V side by side (p, n, qn + m) with C [X0, X1, …, V] = [D0, D1, …, 0] for rows C, D0, D1, … (p, n−m, n) and E V = 1.

    The rows E (m, n) complete C to a regular matrix: unit vectors on these columns, so that C1 X vanishes where they are those of C1, or
    with None an orthonormal basis of what C leaves. None where the complete matrix is singular, or so nearly that V is large.
    """
    p, rows, n = C.shape
    m = n - rows
    E = np.zeros((p, m, n), dtype=np.complex128)
    if columns is not None:
        E[:, np.arange(m), columns] = 1.0
    elif rows > 0:
        E[:] = np.linalg.qr(C.conj().transpose(0, 2, 1), mode="complete")[0][:, :, rows:].conj().transpose(0, 2, 1)
    else:
        E[:] = np.eye(n)
    width = len(D) * n
    right = np.zeros((p, n, width + m), dtype=np.complex128)
    right[:, :rows, :width] = np.concatenate(D, axis=2)
    right[:, rows:, width:] = np.eye(m)
    solve_each(np.concatenate((C, E), axis=1), right)
    sound = np.isfinite(right).all() and (columns is None or (np.abs(right[:, :, width:]) < LARGE_COMPLETION).all())
    return right if sound else None
