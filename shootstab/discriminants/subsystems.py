"""Only what a problem requires: the independent subsystems into which it falls, each of lower order, and real where phases make it so.

Equations, states, decaying solutions and wall rows that no entry connects are independent, and D is the product of the subsystems' D.
In one whose entries are all real or imaginary, states and the rest are multiplied by powers of i so that as much as possible becomes real:
for k_x = 0 that is v → iv. The signs and phases are kept account of: the product is the D of the whole.

For the chute k_y = 0 leaves a subsystem of order 6 with 3 decaying solutions, and v̂ alone with order 2 and 1.
"""

from __future__ import annotations

from collections.abc import Hashable, Iterable
from dataclasses import dataclass, field, replace
from functools import cached_property, lru_cache

import numpy as np
from numpy.typing import NDArray

from shootstab.core.errors import InputError, ShootstabError
from shootstab.problems.capabilities import GENERIC, INTERIOR, KNOTS, RECORDED, STRUCTURE, Continuum
from shootstab.problems.protocol import ComplexArray, FarFrame, Pencil, Problem
from shootstab.problems.recorded_pencil import I_POWERS, RecordedPencil, Selection

PATTERN_SAMPLES = 9  # chosen: points, beside those of the first mesh, at which the pencil is asked which entries it has
FAR_START = 1e-14  # chosen: the accuracy of the far field at the beginning of the interval that is sampled, so that it holds every mesh


FourLists = tuple[NDArray[np.int64], NDArray[np.int64], NDArray[np.int64], NDArray[np.int64]]


class Coupled(InputError):  # noqa: N818 - it is a finding, not a fault
    """What was taken for independent subsystems is not."""


@dataclass(frozen=True, eq=False)
class Subsystem:
    """Some states of a problem with the equations, decaying solutions and wall rows that belong to them, each with a phase 0 or 1.

    Again a problem: state j of the whole is i^phase times that of the subsystem, and so for the rest. states and equations (n,), solutions
    and rows (k,) are their places in the whole; phases are those of states, equations, solutions and rows, of the same lengths.
    """

    whole: Problem
    states: NDArray[np.int64]
    equations: NDArray[np.int64]
    solutions: NDArray[np.int64]
    rows: NDArray[np.int64]
    phases: FourLists

    @property
    def size(self) -> int:
        return len(self.states)

    @property
    def decaying(self) -> int:
        return len(self.solutions)

    def pencil(self, z: ComplexArray) -> Pencil:
        """The matrices (m, n, n) of the subsystem at points z (m,).

        Raises Coupled where a state of it meets an equation outside it: the samples have missed that.
        """
        of_states, of_equations = self.phases[:2]
        turn = I_POWERS[of_equations].conj()[:, None] * I_POWERS[of_states]
        pencil = self.whole.pencil(z)
        if self.size < self.whole.size:
            for M in pencil.named.values():
                _require_apart("pencil", M, self.equations, self.states)
            pencil = pencil.each(lambda M: M[:, self.equations[:, None], self.states])
        return pencil.each(lambda M: M * turn)

    @cached_property
    def recorded(self) -> RecordedPencil | None:
        whole: RecordedPencil | None = RECORDED.of(self.whole)
        lists = (self.equations, self.states, self.phases[1], self.phases[0])
        return None if whole is None else whole.selected(Selection(*(tuple(a.tolist()) for a in lists)))

    def start(self, sigma: complex, tolerance: float) -> float:
        return self.whole.start(sigma, tolerance)

    def far_frame(self, z: float, sigma: complex) -> FarFrame:
        """The subsystem's columns of the whole's frame. Its share of the scale goes with their number: only the sum counts."""
        far = _far_frame(self.whole, z, sigma)
        share = far.log_scale * len(self.solutions) / self.whole.decaying
        turn, frame, tangent = self._turn_of_frame, far.frame, far.tangent
        if frame.shape != turn.shape:
            _require_apart("far frame", frame[None], self.states, self.solutions)
            frame, tangent = (Y[self.states[:, None], self.solutions] for Y in (frame, tangent))
        return FarFrame(frame * turn, tangent * turn, share, far.error)

    @cached_property
    def _turn_of_frame(self) -> ComplexArray:
        """The phases (n, k) that make of the whole's frame that of the subsystem."""
        return np.asarray(I_POWERS[self.phases[0]].conj()[:, None] * I_POWERS[self.phases[2]])

    def mesh(self, start: float) -> NDArray[np.float64]:
        return self.whole.mesh(start)

    def wall_rows(self) -> tuple[ComplexArray, ...]:
        return self._wall_rows

    @cached_property
    def _wall_rows(self) -> tuple[ComplexArray, ...]:
        turn = I_POWERS[self.phases[3]].conj()[:, None] * I_POWERS[self.phases[0]]
        rows = self.whole.wall_rows()
        for W in rows:
            _require_apart("wall rows", W[None], self.rows, self.states)
        return tuple(W[self.rows[:, None], self.states] * turn for W in rows)

    @property
    def knots(self) -> NDArray[np.float64] | None:
        """The knots (k,) of the whole problem, which are its own."""
        known: NDArray[np.float64] | None = KNOTS.of(self.whole)
        return known

    def with_base_flow_error(self, factor: float) -> Problem:
        crude = self.whole.with_base_flow_error(factor)
        return self if crude is self.whole else replace(self, whole=crude)

    @property
    def continuum(self) -> Continuum | None:
        """The continuous spectrum of the whole: where C is singular in another subsystem, a path around it does no harm."""
        curve: Continuum | None = INTERIOR.of(self.whole)
        return curve

    def of_whole(self, states: ComplexArray) -> ComplexArray:
        """The states of the whole (m, n) of which these (m, size) are the subsystem's, and zero elsewhere."""
        return self._placed(states, self.states, I_POWERS[self.phases[0]])

    def left_of_whole(self, rows: ComplexArray) -> ComplexArray:
        """Rows (m, n) over the equations of the whole, of rows (m, size) over those of the subsystem."""
        return self._placed(rows, self.equations, I_POWERS[self.phases[1]].conj())

    def _placed(self, values: ComplexArray, places: NDArray[np.int64], turn: ComplexArray) -> ComplexArray:
        out = np.zeros((*values.shape[:-1], self.whole.size), dtype=np.complex128)
        out[..., places] = values * turn
        return out


def _require_apart(name: str, matrices: ComplexArray, rows: NDArray[np.int64], columns: NDArray[np.int64]) -> None:
    """Raise Coupled if one of the matrices (m, p, q) has entries in these columns that are not in these rows."""
    if np.count_nonzero(matrices[:, :, columns]) != np.count_nonzero(matrices[:, rows[:, None], columns]):
        raise Coupled(f"the {name} couples subsystems that are apart elsewhere: allowed is one structure for all z and sigma")


@lru_cache(maxsize=32)
def _far_frame(problem: Problem, z: float, sigma: complex) -> FarFrame:
    """The frame of the whole, kept for the other subsystems and for other draws of errors on a contour, which ask for the same."""
    return problem.far_frame(z, sigma)


@dataclass(frozen=True, eq=False)
class Decoupling:
    """The subsystems of a problem; D of the whole is factor times the product of theirs."""

    members: tuple[Subsystem, ...]
    factor: complex

    def applied_to(self, problem: Problem) -> tuple[Subsystem, ...]:
        """The same subsystems of another problem of the same structure, the same objects as long as they are kept."""
        return _applied(self, problem)


@lru_cache(maxsize=16)
def _applied(decoupling: Decoupling, problem: Problem) -> tuple[Subsystem, ...]:
    return tuple(replace(subsystem, whole=problem) for subsystem in decoupling.members)


@dataclass(frozen=True)
class _Structured:
    """A problem that stands for all of its structure."""

    structure: Hashable
    problem: Problem = field(compare=False)


@lru_cache(maxsize=64)
def decouple(problem: Problem) -> Decoupling | None:
    """The subsystems of a problem; None if it is one without phases, or if samples of it cannot be had.

    What is wrong with the latter is said when it is used. Problems of one structure are sampled once.
    """
    structure = STRUCTURE.of(problem)
    found = _sampled(problem) if structure is None else _of_structure(_Structured(structure, problem))
    return None if found is None else Decoupling(tuple(Subsystem(problem, *places) for places in found[0]), found[1])


@lru_cache(maxsize=64)
def _of_structure(like: _Structured) -> tuple[tuple[Places, ...], complex] | None:
    return _sampled(like.problem)


def _sampled(problem: Problem) -> tuple[tuple[Places, ...], complex] | None:
    """The places of the subsystems and the factor of their product, from samples; None as `decouple` has it."""
    try:
        blocks = _entries(problem)
    except ShootstabError:
        return None
    members, factor = _parts(problem.size, problem.decaying, *(_kinds(block).tobytes() for block in blocks))
    return None if members is None else (members, factor)


Places = tuple[NDArray[np.int64], NDArray[np.int64], NDArray[np.int64], NDArray[np.int64], FourLists]


def _kinds(block: ComplexArray) -> NDArray[np.uint8]:
    """What the entries (p, q) of a block (m, p, q) are: 0 zero, 1 real, 2 imaginary, 3 neither."""
    real, imaginary = ((part != 0.0).any(axis=0) for part in (block.real, block.imag))
    return np.asarray(real + 2 * imaginary, dtype=np.uint8)


@lru_cache(maxsize=64)
def _parts(n: int, k: int, pencil: bytes, frame: bytes, rows_at_wall: bytes) -> tuple[tuple[Places, ...] | None, complex]:
    """States, equations, solutions, rows and phases of every subsystem with decaying solutions, and the factor of their product.

    Given are the kinds of the entries: (n, n) of the pencil, (k, n) of the far frame and of the wall rows. None where nothing falls apart.
    """
    # nodes: states, equations, solutions, wall rows
    first = np.array([0, n, 2 * n, 2 * n + k])
    edges = []
    for kinds, at in zip((pencil, frame, rows_at_wall), (1, 2, 3), strict=True):
        block = np.frombuffer(kinds, dtype=np.uint8).reshape(-1, n)
        edges += [(int(a) + first[at], int(j), int(block[a, j])) for a, j in zip(*np.nonzero(block), strict=True)]
    component, phase, consistent = _two_colouring(2 * n + 2 * k, edges)
    members = []
    for name in dict.fromkeys(component[:n].tolist()):
        nodes = np.flatnonzero(component == name)
        turned = phase if consistent[name] else np.zeros_like(phase)
        kinds_of = [nodes[(nodes >= low) & (nodes < high)] for low, high in zip(first, (*first[1:], 2 * n + 2 * k), strict=True)]
        states, equations, solutions, rows = (kind - low for kind, low in zip(kinds_of, first, strict=True))
        if len(states) != len(equations) or len(solutions) != len(rows):
            return None, 1.0
        a, b, c, d = (turned[kind] for kind in kinds_of)
        members.append((states, equations, solutions, rows, (a, b, c, d)))
    if len(members) == 1 and not any(phase.any() for phase in members[0][4]):
        return None, 1.0
    factor = complex(_sign(np.concatenate([m[3] for m in members])) * _sign(np.concatenate([m[2] for m in members])))
    for m in members:
        factor *= _turned(m[4])
    return tuple(m for m in members if len(m[2]) > 0), factor


def _turned(phases: FourLists) -> complex:
    """i^(phases of the rows − phases of the solutions)."""
    return (1 + 0j, 1j, -1 + 0j, -1j)[int(phases[3].sum() - phases[2].sum()) % 4]


def _entries(problem: Problem) -> tuple[ComplexArray, ComplexArray, ComplexArray]:
    """Samples of the pencil (m, n, n), of the far frame as (m, k, n), and the wall rows (m, k, n).

    A problem whose decaying space does not exist at every σ names one at which it does.
    """
    sigma = GENERIC.of(problem)
    start = problem.start(sigma, FAR_START)
    mesh = problem.mesh(start)
    z = np.concatenate((mesh[0] + (mesh[-1] - mesh[0]) * np.linspace(0.0, 1.0, PATTERN_SAMPLES), mesh))
    pencil = problem.pencil(z.astype(np.complex128))
    far = problem.far_frame(start, sigma)
    frame = np.stack((far.frame, far.tangent)).transpose(0, 2, 1)
    return np.concatenate(list(pencil.named.values())), frame, np.stack(problem.wall_rows())


def _two_colouring(nodes: int, edges: Iterable[tuple[int, int, int]]) -> tuple[NDArray[np.int64], NDArray[np.int64], dict[int, bool]]:
    """component (nodes,), phase (nodes,) and, by component, whether phases make its entries real; edges come with the kind of an entry.

    A real entry asks for equal phases at its ends, an imaginary one for different ones; an entry that is neither allows none.
    """
    neighbours: list[list[tuple[int, int | None]]] = [[] for _ in range(nodes)]
    for a, b, kind in edges:
        turn = (0, 1, None)[kind - 1]
        neighbours[a].append((b, turn))
        neighbours[b].append((a, turn))
    component, phase = np.full(nodes, -1), np.zeros(nodes, dtype=np.int64)
    consistent: dict[int, bool] = {}
    for seed in range(nodes):
        if component[seed] >= 0:
            continue
        component[seed], todo, consistent[seed] = seed, [seed], True
        while todo:
            node = todo.pop()
            for other, turn in neighbours[node]:
                wanted = (phase[node] + (turn or 0)) % 2
                if component[other] < 0:
                    component[other], phase[other] = seed, wanted
                    todo.append(other)
                if turn is None or phase[other] != wanted:
                    consistent[seed] = False
    return component, phase, consistent


def _sign(order: NDArray[np.int64]) -> int:
    """The sign of a permutation."""
    order, sign = order.copy(), 1
    for i in range(len(order)):
        while order[i] != i:
            j = order[i]
            order[i], order[j] = order[j], order[i]
            sign = -sign
    return sign
