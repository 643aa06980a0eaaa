"""The reduction of the pencil to A(σ) = X0 + σ X1 + V γ⁻¹ τ is C⁻¹D, whichever rows σ enters; what cannot be reduced is refused."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.special import lambertw

import shootstab as st
from shootstab.core.errors import InputError
from shootstab.discriminants import sampled_system
from shootstab.discriminants.mesh import halved, partly_halved
from shootstab.discriminants.perturbed_pencil import PerturbedPencil
from shootstab.discriminants.sampled_system import mixed, reduce_pencil, sample_system
from shootstab.discriminants.subsystems import decouple
from shootstab.formulation.problem import EquationProblem
from shootstab.kernels.reduced_system import ReducedSystem
from shootstab.problems.capabilities import RECORDED
from shootstab.problems.protocol import Pencil, Problem
from shootstab.problems.recorded_pencil import RecordedPencil

SIGMA = 0.7 - 0.4j


def matrix(pencil: Pencil, n: int) -> np.ndarray:
    """A(σ) at every point."""
    X, V, G, T = reduce_pencil(pencil, n)
    rest, gamma, tau = (sum(SIGMA**k * part[:, k] for k in range(part.shape[1])) for part in (X, G, T))
    return np.asarray(rest + V @ np.linalg.solve(gamma, tau))


def random_pencil(n: int, moving: list[int], columns: list[int], seed: int) -> Pencil:
    rng = np.random.default_rng(seed)
    C0, C1, D0, D1 = (rng.standard_normal((3, n, n)) + 1j * rng.standard_normal((3, n, n)) for _ in range(4))
    mask = np.zeros((n, n))
    mask[np.ix_(moving, columns)] = 1.0
    return Pencil(C0, C1 * mask, D0, D1)


@pytest.mark.parametrize(
    ("n", "moving", "columns"), [(3, [1], [2]), (4, [0, 2], [1, 3]), (4, [1], [0, 3]), (3, [0, 1, 2], [0, 1, 2]), (5, [2, 3], [4])]
)
def test_the_reduction_is_the_inverse_of_C_times_D(n: int, moving: list[int], columns: list[int]) -> None:
    p = random_pencil(n, moving, columns, seed=n)
    exact = np.linalg.solve(p.C0 + SIGMA * p.C1, p.D0 + SIGMA * p.D1)
    np.testing.assert_allclose(matrix(p, n), exact, rtol=1e-10, atol=1e-10)


@pytest.mark.parametrize("degree", [2, 3, 5])
@pytest.mark.parametrize("moving", [[], [1], [0, 2]])
def test_the_reduction_of_higher_powers(degree: int, moving: list[int]) -> None:
    n, rng = 4, np.random.default_rng(degree)
    C, D = ([rng.standard_normal((3, n, n)) + 1j * rng.standard_normal((3, n, n)) for _ in range(degree + 1)] for _ in range(2))
    still = np.setdiff1d(np.arange(n), moving)
    for M in C[1:]:
        M[:, still] = 0.0
    exact = np.linalg.solve(*(sum(SIGMA**k * M for k, M in enumerate(part)) for part in (C, D)))
    np.testing.assert_allclose(matrix(Pencil.of(C, D), n), exact, rtol=1e-9, atol=1e-9)


@pytest.mark.parametrize("coupling", [1.0, 0.0, 1e-12])
def test_rows_that_unit_vectors_do_not_complete(coupling: float) -> None:
    """C = [[1, ε], [−σ, 1]] has determinant 1 + εσ, and its first row is all but the unit vector on the column that σ enters."""
    C0 = np.array([[[1, coupling], [0, 1]]], complex)
    C1 = np.array([[[0, 0], [-1, 0]]], complex)
    D0, D1 = np.array([[[0, 1], [2, 0]]], complex), np.array([[[1, 0], [0, 3j]]], complex)
    exact = np.linalg.solve(C0 + SIGMA * C1, D0 + SIGMA * D1)
    np.testing.assert_allclose(matrix(Pencil(C0, C1, D0, D1), 2), exact, rtol=1e-12, atol=1e-12)


def test_modes_of_a_problem_whose_C_has_determinant_one() -> None:
    """y′ = x, x′ − σ y′ = c x: x′ = (σ + c) x with y(0) = 0 and x(1) + y(1) = 0, so that e^s (s + 1) = 1 for s = σ + c ≠ 0."""
    c = 0.3

    def pencil(z: float) -> tuple[np.ndarray, ...]:
        C1 = np.array([[0, 0], [-1.0, 0]])
        return np.eye(2), C1, np.array([[0, 1.0], [0, c]]), np.zeros((2, 2))

    p = st.problem(2, pencil, st.Wall(0, [[1, 0]]), st.Wall(1, [[1, 1]]))
    s = complex(lambertw(np.e, 1)) - 1  # Lambert's W, second branch
    mode = st.refine(p, guess=s - c + 0.01)
    assert mode.converged
    assert abs(mode.sigma - (s - c)) <= mode.error


def test_dependent_rows_are_refused() -> None:
    C0 = np.array([[[1, 1, 0], [1, 1, 0], [0, 0, 1]]], complex)
    C1 = np.zeros((1, 3, 3), complex)
    C1[0, 2, 2] = 1.0
    with pytest.raises(InputError, match="are dependent at some z"):
        reduce_pencil(Pencil(C0, C1, C0, C1), 3)


def assembled(system: ReducedSystem, n: int, sigma: complex) -> np.ndarray:
    """hA(σ) at every abscissa of every step, from the lists."""
    m, entries = system.G.shape[3], len(system.column)
    values = system.P[:, :, :entries].astype(complex)
    values[:, :, system.linear.astype(int)] += sigma * system.P[:, :, entries : entries + len(system.linear)]
    for k, (entry, power) in enumerate(zip(system.higher.astype(int), system.powers.astype(int), strict=True)):
        values[:, :, entry] += sigma**power * system.P[:, :, entries + len(system.linear) + k]
    stacked = np.zeros((*system.P.shape[:2], n + m, n), complex)
    stacked[:, :, np.searchsorted(system.start, np.arange(entries), side="right") - 1, system.column.astype(int)] = values
    V = np.zeros((*system.P.shape[:2], n, m), complex)
    V[:, :, system.carries.astype(int)] = system.V
    return np.asarray(
        stacked[:, :, :n] + V @ np.linalg.solve(sum(sigma**k * system.G[:, :, k] for k in range(system.G.shape[2])), stacked[:, :, n:])
    )


class WithoutFormula:
    """A problem that keeps to itself that its pencil is a formula."""

    recorded = None

    def __init__(self, problem: Problem) -> None:
        self.problem = problem

    def __getattr__(self, name: str) -> object:
        return getattr(self.problem, name)


@pytest.mark.parametrize(
    ("scene", "kx", "ky", "real"), [("high", 0.0, 0.01, True), ("low", 0.011, 0.0, False), ("low", 0.011, 0.02, False)]
)
def test_the_recorded_reduction_is_the_one_of_the_matrices(scene: str, kx: float, ky: float, real: bool) -> None:
    """Two eliminations, one recorded once and one at every point: the same A(σ), on the real axis and off it, of every subsystem."""
    flow = st.scene(scene).problem.flow
    problem = st.chute.problem(flow, kx=kx, ky=ky)
    decoupling = decouple(problem)
    straight = np.linspace(8.0, 0.0, 12) * flow.far_temperature
    for member in (problem,) if decoupling is None else decoupling.members:
        assert RECORDED.of(member).reduced is not None
        for nodes in (straight + 0j, straight + 0.05j * flow.far_temperature):
            systems = [sample_system(p, nodes) for p in (member, WithoutFormula(member))]
            assert (systems[0].real is not None) == (real and nodes is not None and not nodes.imag.any())
            one, other = (assembled(s.system, member.size, 0.02 - 0.03j) for s in systems)
            # entries that cancel are held against the largest of their row
            assert np.all(np.abs(one - other) <= 1e-13 * np.abs(other).max(axis=3, keepdims=True))


def spatial(nu: float) -> EquationProblem:
    """A compressible channel with α as the eigenvalue, to the power 2; its pressure obeys M² (a U - ω) p = … : σ stands in C, twice."""
    L, strain = "i*(a*U - omega)", "(i*a*u + d(v))"
    return st.equations(
        ["u", "v", "p"],
        [
            f"{L}*u + v*d(U) + i*a*p = nu*(d(u,2) - a**2*u + i*a*{strain}/3)",
            f"{L}*v + d(p) = nu*(d(v,2) - a**2*v + d({strain})/3)",
            f"{L}*p + {strain} = 0",
        ],
        st.Conditions(-1, ["u", "v"]),
        st.Conditions(1, ["u", "v"]),
        parameters={"omega": 0.4, "nu": nu},
        where={"U": "1 - z**2"},
        eigenvalue="a",
    )


@pytest.mark.parametrize("scene", ["pipe", "kink", "legendre", "maxwell-couette", "mri", "two walls", "compressible"])
def test_equations_record_the_reduction_of_their_matrices(scene: str) -> None:
    """On the real axis and off it, on one subdomain and on several; and so with entries that are changed by nothing."""
    walls = {"left": st.Conditions(0, ["sigma*d(y) + y"]), "right": st.Conditions(1, ["d(y) - sigma*y"])}
    made = {"two walls": lambda: st.equations(["y"], ["d((1 + z)*d(y)) - sigma*y"], **walls), "compressible": lambda: spatial(0.02)}
    problem = made[scene]() if scene in made else st.scene(scene).problem
    assert RECORDED.of(problem).reduced is not None
    straight = problem.mesh(problem.start(problem.generic_sigma, 1e-10))[::9]
    for nodes in (straight + 0j, straight * (1 + 0.01j)):
        systems = [sample_system(p, nodes) for p in (problem, PerturbedPencil(problem, 1, 0.0), WithoutFormula(problem))]
        one, unchanged, other = (assembled(s.system, problem.size, 0.3 - 0.2j) for s in systems)
        assert np.all(np.abs(one - other) <= 1e-12 * np.abs(other).max(axis=3, keepdims=True))
        assert np.all(np.abs(one - unchanged) <= 1e-12 * np.abs(one).max(axis=3, keepdims=True))


def test_an_elimination_without_pivots_gives_way_to_one_with() -> None:
    """C = [[a, a+1], [a+2, a+3]] with a = 0 in the middle of the path: what pivots on a is no number there, and is not used."""

    def formula(fields: list, parameters: list, shape: object) -> tuple[dict, ...]:
        (a,) = fields
        return {(0, 0): a, (0, 1): a + 1, (1, 0): a + 2, (1, 1): a + 3}, {}, {(0, 1): 1, (1, 0): a}, {(0, 0): 1}

    class Crossing(WithoutFormula):
        size = 2

        @property
        def recorded(self) -> RecordedPencil:
            return RecordedPencil(formula, "crossing", 2, lambda z: z.real[None].copy(), np.empty(0), 1)

        def pencil(self, z: np.ndarray) -> Pencil:
            matrices = np.zeros((4, len(z), 2, 2), complex)
            for M, entries in zip(matrices, formula([z], [], None), strict=True):
                for (i, j), entry in entries.items():
                    M[:, i, j] = entry
            return Pencil(*matrices)

    problem = Crossing(None)  # type: ignore[arg-type]
    assert problem.recorded.reduced is not None
    nodes = np.array([1.0, 0.0, -1.0], complex)  # an abscissa lies on every node
    with np.errstate(all="ignore"):
        got = assembled(sample_system(problem, nodes).system, 2, SIGMA)  # type: ignore[arg-type]
    p = problem.pencil(np.array([0j]))
    assert np.allclose(got[1, 0], -np.linalg.solve(p.C0[0], p.D0[0] + SIGMA * p.D1[0]), rtol=1e-13, atol=1e-15)


@pytest.mark.parametrize("moving", [False, True])
def test_a_system_sampled_in_chunks_is_the_same(moving: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    def pencil(z: float) -> tuple[np.ndarray, ...]:  # an entry, and sigma in C, are there on one half only
        late = float(z > 0.5)
        D0, D1 = np.array([[0, 1 + z], [late * z, 0]]), np.array([[0, 0], [1.0, 0]])
        return np.eye(2), np.array([[0, 0], [0, late if moving else 0.0]]), D0, D1

    problem = st.problem(2, pencil, st.Wall(0, [[1, 0]]), st.Wall(1, [[1, 0]]), continuum=False)
    nodes = np.linspace(0.0, 1.0, 12)
    whole = sample_system(problem, nodes)
    monkeypatch.setattr(sampled_system, "STEPS_AT_A_TIME", 5)
    chunked = sample_system(problem, nodes)
    for a, b in zip(chunked.system, whole.system, strict=True):
        assert np.array_equal(a, b)


@pytest.mark.parametrize("name", ["high", "low"])
def test_steps_of_two_meshes_are_copied_as_they_would_be_sampled(scenes: dict[str, Problem], name: str) -> None:
    nodes = scenes[name].mesh(scenes[name].start(0.01 + 0j, 1e-10)).astype(np.complex128)
    cut = np.arange(len(nodes) - 1) % 2 == 0
    some, all_cut = partly_halved(nodes, cut), halved(nodes)
    assert set(nodes) < set(some) < set(all_cut)
    assert set(partly_halved(nodes, ~cut)) != set(some)
    one, other, sampled = (sample_system(scenes[name], at) for at in (nodes, all_cut, some))
    copied = mixed(scenes[name], some, one, other)
    assert all(map(np.array_equal, copied.made.numbers, sampled.made.numbers))
    elsewhere = mixed(scenes[name], 0.5 * nodes[-2:], one, other)  # a step of neither
    assert all(map(np.array_equal, elsewhere.made.numbers, sample_system(scenes[name], 0.5 * nodes[-2:]).made.numbers))
