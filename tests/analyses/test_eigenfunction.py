"""Eigenfunctions: against exact ones, the equations they solve, the adjoint system, the reference's vectors, and differences of modes."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from numpy.polynomial import hermite, legendre
from scipy.special import jv

import shootstab as st
from shootstab.analyses.eigenfunction import eigenfunction
from shootstab.analyses.eigenfunction_double import Eigenfunction
from shootstab.core.errors import InputError
from shootstab.core.polynomial import value
from shootstab.discriminants.back_substitution import solution
from shootstab.discriminants.deformed_path import DeformedPath
from shootstab.discriminants.frame import Frame
from shootstab.models.chute import ChuteProblem
from shootstab.models.gallery import benard, davies, poeschl_teller
from shootstab.models.gallery.benard import free_growth_rate
from shootstab.models.gallery.poiseuille import PlanePoiseuille, plane_poiseuille

MODES = {"high": 0.0039705046389, "mid": 0.0010229, "low": 0.00727558 - 0.01186505j, "fig2": 0.00169243 - 0.00156624j}
BESSEL_ZEROS = {0.0: 2.404825557695773, 1.0 / 3.0: 2.9025862484169527, 1.0: 3.8317059702075125, 7.0: 11.086370019245083}  # DLMF 10.21
ORSZAG = 0.0037396706229794099 - 0.2375264888204701j


def against(
    found: Eigenfunction, name: str, exact: Callable[[Any], Any], points: int = 41, over: tuple[float, float] | None = None
) -> float:
    """The largest difference from an exact function, over that one's largest value, and in the scaling of the eigenfunction."""
    z = np.linspace(*(over or found.line.ends), points)
    at, place = found.peak
    return float(np.abs(found(z)[name] / found(place)[at] - exact(z) / exact(place)).max())


# exact eigenfunctions


@pytest.mark.parametrize("order", [0.0, 1.0 / 3.0, 1.0, 7.0])
def test_from_the_axis_to_a_wall(order: float) -> None:
    """J_ν(j r): a regular solution at r = 0, known between it and where the integration begins, at the axis itself too."""
    square = order**2
    axis, wall = st.Axis(0), st.Conditions(1, ["y"])
    bessel = st.equations(["y"], [f"d(y,2) + d(y)/r - {square!r}*y/r**2 + s*y = 0"], axis, wall, eigenvalue="s", variable="r")
    first = BESSEL_ZEROS[order]
    found = eigenfunction(bessel, first**2)
    assert found.extent == (0.0, 1.0)
    assert against(found, "y", lambda r: jv(order, first * np.asarray(r)), over=found.extent) <= max(found.error, 2e-15) < 1e-9
    with pytest.raises(InputError, match="allowed is z from 0 to 1"):
        found(-1e-3)


def test_between_two_singular_ends() -> None:
    """P_2² ~ 1 − x² and P_5² on the whole of −1 < x < 1, both ends included."""
    x = np.polynomial.Polynomial([0.0, 1.0])
    for degree, exact in ((2, 1.0 - x**2), (5, (1.0 - x**2) * (3.0 * x**3 - x))):
        found = eigenfunction(st.scene("legendre").problem, degree * (degree + 1.0))
        assert found.extent == (-1.0, 1.0)
        assert against(found, "y", exact, over=(-1.0, 1.0)) <= found.error < 1e-11


def test_what_swirls_through_the_axis_is_one_velocity_there() -> None:
    """Azimuthal order 1: on the axis v = i u, and w and p vanish."""
    found = eigenfunction(st.scene("pipe").problem, -0.0616190180049 - 0.3709350926968j)
    at = found(np.array([0.0]))
    assert abs(at["v"] - 1j * at["u"])[0] <= 2.0 * found.error
    assert max(abs(at["w"]), abs(at["p"]))[0] <= found.error
    near, far = (found(r)["w"] for r in (0.1224999, 0.1225001))  # on both sides of where the integration begins
    assert abs(far - near) < 1e-6


@pytest.mark.parametrize("n", [1, 2])
def test_free_walls_make_sines(n: int) -> None:
    """W = sin nπz between two free walls (Chandrasekhar 1961, II.15)."""
    sigma = free_growth_rate(1000.0, 2.5, 0.71, n)
    found = eigenfunction(benard(1000.0, 2.5, 0.71, "free", "free"), sigma)
    largest = "W" if abs(found(0.5 / n)["W"]) > abs(found(0.5 / n)["theta"]) else "theta"
    assert found.peak[0] == largest
    error = against(found, largest, lambda z: np.sin(n * math.pi * z))
    assert error <= found.error < 1e-11
    assert found.conditioning.nonnormality < 1.1


@pytest.mark.parametrize("nu", [0.4, 2.3])
def test_poeschl_teller(nu: float) -> None:
    """y = sech^ν x for λ = ν², on both sides of the fold."""
    found = eigenfunction(poeschl_teller(nu), nu * nu)
    assert against(found, "y", lambda x: np.cosh(x) ** -nu) <= max(found.error, 1e-15) < 1e-10
    assert found.conditioning.nonnormality == pytest.approx(1.0, abs=1e-6)


@pytest.mark.parametrize("n", [0, 3])
def test_davies(n: int) -> None:
    """u = H_n(e^{iπ/8} x) exp(−e^{iπ/4} x²/2); ∫|u|²/|∫u²| is the norm of the spectral projection, 2^{1/4} for n = 0."""
    found = eigenfunction(davies(), np.exp(0.25j * math.pi) * (2 * n + 1))
    turn, coefficients = np.exp(0.125j * math.pi), np.eye(n + 1)[n]

    def exact(x: Any) -> Any:
        return hermite.hermval(turn * x, coefficients) * np.exp(-((turn * x) ** 2) / 2)

    assert against(found, "u", exact) <= found.error < 1e-11
    x = np.linspace(-9, 9, 4001)
    norm = float((np.abs(exact(x)) ** 2).sum() / abs((exact(x) ** 2).sum()))
    assert found.conditioning.nonnormality == pytest.approx(norm, rel=1e-4)


# the equations themselves

PROBLEMS: dict[str, tuple[Callable[[], Any], complex]] = {
    "two walls": (lambda: PlanePoiseuille(half=False), ORSZAG),
    "interface": (
        lambda: st.problem(
            *(2, lambda z: ([[0, 1], [0, 0]], [[0, 0], [1 + 2 * (z > 0.4), 0]]), st.Wall(0.0, [[1, 0]]), st.Wall(1.0, [[1, 0]])),
            interfaces=[st.Interface.jump(0.4, [[1, 0], [0.3, 1]])],
        ),
        -4.0,
    ),
    "moving rows at both walls": (
        lambda: st.problem(
            *(2, lambda z: ([[0, 1], [z, 0]], [[0, 0], [1, 0]])),
            *(st.Wall(0.0, [[0, 1]], [[0.5, 0]]), st.Wall(1.0, [[1, 0.1]], [[0.3, 0]])),
        ),
        -3.0,
    ),
    "quadratic in the eigenvalue": (
        lambda: st.equations(
            ["u"], ["d(u,2) + (9 + z - k**2 + i*k*z)*u"], st.Conditions(0, ["u"]), st.Conditions(1, ["d(u) + k*u"]), eigenvalue="k"
        ),
        2.4,
    ),
    "periodic": (
        lambda: st.equations(["u"], ["sigma*u - d(u,2) + (2*cos(z) + i*sin(z))*u"], *map(st.Periodic, (0.0, 2 * math.pi))),
        0.4,
    ),
}


def residual(found: Eigenfunction, z: np.ndarray, h: float = 1e-3) -> float:
    """|C φ′ − D φ| with φ′ by differences of order 8, over the sum of the sizes of the terms, the largest at z."""
    weights = np.array([1 / 280, -4 / 105, 1 / 5, -4 / 5, 0, 4 / 5, -1 / 5, 4 / 105, -1 / 280])
    phi = found.state(z)
    slope = sum(w * found.state(z + j * h) for j, w in zip(range(-4, 5), weights, strict=True)) / h
    C, D = matrices(found, z)
    left, right = np.einsum("mij,mj->mi", C, slope), np.einsum("mij,mj->mi", D, phi)
    size = np.einsum("mij,mj->mi", np.abs(C), np.abs(slope)) + np.einsum("mij,mj->mi", np.abs(D), np.abs(phi))
    scale = size.max(axis=0)  # of an equation between components that vanish it is zero
    return float((np.abs(left - right).max(axis=0)[scale > 0] / scale[scale > 0]).max())


def matrices(found: Eigenfunction, z: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """C and D of the user's own system."""
    function = getattr(found.problem, "function", found.problem.pencil)
    p, sigma = function(z.astype(complex)), complex(found.line.solution.sigma)
    return value(p.C, sigma), value(p.D, sigma)


@pytest.mark.parametrize("name", PROBLEMS)
def test_the_solution_solves_its_equations_and_its_adjoint_the_adjoint_ones(name: str) -> None:
    """C φ′ = D φ, and −(Cᴴψ)′ = Dᴴψ, both by differences."""
    make, guess = PROBLEMS[name]
    found = eigenfunction(make(), guess)
    low, high = found.line.ends
    z = np.concatenate([np.linspace(low, 0.38, 7), np.linspace(0.42, high, 7)])
    z = z[(z > low + 0.01) & (z < high - 0.01)]
    assert residual(found, z) < 1e-9
    h = 1e-3
    chi = {}
    for j in (-2, -1, 1, 2):
        C, _ = matrices(found, z + j * h)
        chi[j] = np.einsum("mji,mj->mi", C.conj(), found.adjoint(z + j * h))
    slope = (8 * (chi[1] - chi[-1]) - (chi[2] - chi[-2])) / (12 * h)
    right = -np.einsum("mji,mj->mi", matrices(found, z)[1].conj(), found.adjoint(z))
    size = np.einsum("mji,mj->mi", np.abs(matrices(found, z)[1]), np.abs(found.adjoint(z)))
    assert (np.abs(slope - right).max(axis=0) <= 1e-6 * size.max()).all()


def test_walls_and_interfaces_hold() -> None:
    make, guess = PROBLEMS["moving rows at both walls"]
    found = eigenfunction(make(), guess)
    at, sigma = found.state([0.0, 1.0]), found.mode.sigma
    assert abs(at[0, 1] + 0.5 * sigma * at[0, 0]) < 1e-12
    assert abs((1 + 0.3 * sigma) * at[1, 0] + 0.1 * at[1, 1]) < 1e-12
    make, guess = PROBLEMS["interface"]
    found = eigenfunction(make(), guess)
    before, behind = found.state([0.4, np.nextafter(0.4, 1.0)])
    assert np.abs(behind - np.array([[1, 0], [0.3, 1]]) @ before).max() < 1e-12


@pytest.mark.parametrize("name", ["high", "low"])
def test_the_chute_far_above_and_below_the_start_of_the_integration(scenes: dict[str, ChuteProblem], name: str) -> None:
    """The solution goes on where the integration begins, and decays there as e^{−Kz}."""
    found = eigenfunction(scenes[name], MODES[name])
    start = found.line.ends[1]
    assert found.line.allowed == (0.0, math.inf)
    z = np.array([0.3 * start, start - 0.01, start + 0.01, 3 * start])
    assert residual(found, z, 2e-3 * start) < 1e-8
    K = math.hypot(scenes[name].kx, scenes[name].ky)
    far = np.abs(found(np.array([5 / K, 6 / K]))["T"])
    assert far[1] / far[0] == pytest.approx(math.exp(-1.0), rel=0.05)
    low, high = found.extent
    assert low == 0.0
    assert all(abs(found(high)[name]) <= 0.04 * np.abs(found(np.linspace(0, high, 50))[name]).max() for name in found.names)


# the adjoint


def test_adjoints_of_other_modes_are_orthogonal() -> None:
    """⟨ψ_m, (D1 − C1 d/dz) φ_n⟩ + λ W1 φ is 1 for m = n and 0 otherwise: two walls, C the identity, rows without σ."""
    problem = plane_poiseuille()
    modes = [eigenfunction(problem, guess) for guess in (ORSZAG, -0.0350 - 0.9645j, -0.0509 - 0.2772j)]
    assert len({round(complex(f.mode.sigma).imag, 6) for f in modes}) == 3
    x, w = legendre.leggauss(400)
    z, weights = 0.5 * (x + 1), 0.5 * w
    D1 = problem.function(z.astype(complex)).D1
    products = np.array([[np.einsum("m,mi,mij,mj->", weights, m.adjoint(z).conj(), D1, n.state(z)) for n in modes] for m in modes])
    sizes = np.abs([[np.einsum("m,mi,mij,mj->", weights, abs(m.adjoint(z)), abs(D1), abs(n.state(z))) for n in modes] for m in modes])
    errors = np.array([f.error for f in modes])
    assert errors.max() < 2e-8  # measured: from 5e-9 to 1.7e-8 while R changes by its last bits, for a bound is a sample of rounding
    assert (np.abs(products - np.eye(3)) < (errors[:, None] + errors) * sizes).all()


def test_sensitivities_are_the_differences_of_modes(scenes: dict[str, ChuteProblem]) -> None:
    """dσ/dp by the adjoint against central differences of modes: Reynolds number, and of the chute a wavenumber and T_∞."""
    cases: list[tuple[Callable[[float], Any], float, complex]] = [
        (lambda R: plane_poiseuille(R), 1e4, ORSZAG),
        (lambda k: ChuteProblem(scenes["low"].flow, k, 0.0), 0.011, MODES["low"]),
        (lambda R: benard(R, 3.117), 2000.0, 3.44),
    ]
    for make, p, guess in cases:
        h = 1e-5 * p
        found = eigenfunction(make(p), guess)
        adjoint = (found.shift(make(p + h)) - found.shift(make(p - h))) / (2 * h)
        ahead, behind = (st.refine(make(p + d), found.mode.sigma, rtol=1e-13).sigma for d in (h, -h))
        assert adjoint == pytest.approx((ahead - behind) / (2 * h), rel=1e-6)


def test_the_condition_number_bounds_what_small_changes_of_the_entries_do() -> None:
    """A relative change ε of every entry moves σ by at most condition·ε·|σ|, and the worst signs come near to it."""
    rng, eps = np.random.default_rng(3), 1e-7
    D0, D1 = np.array([[0, 1.0], [0.2, 0.1]]), np.array([[0, 0], [1.0, 0]])
    ends = st.Wall(0.0, [[1, 0]]), st.Wall(1.0, [[1, 0]])
    found = eigenfunction(st.problem(2, lambda z: (D0, D1), *ends), -9.0)
    moved = []
    for _ in range(8):
        A, B = (1 + eps * rng.choice([-1, 1], (2, 2)) for _ in range(2))
        moved.append(abs(st.refine(st.problem(2, lambda z, A=A, B=B: (A * D0, B * D1), *ends), -9.0, rtol=1e-13).sigma - found.mode.sigma))
    bound = found.conditioning.absolute * eps
    assert 0.1 * bound < max(moved) <= 1.001 * bound


# other ways to the same


def test_along_a_path_around_the_singular_point_it_is_the_same(scenes: dict[str, ChuteProblem]) -> None:
    """Along the real axis, and along a path through the complex plane where that runs on the real axis too."""
    problem, guess = scenes["fig2"], MODES["fig2"]
    found = eigenfunction(problem, guess)
    along = Frame(rtol=1e-11).on(problem, DeformedPath(20.0, 3.0, 0.5), guess).at(guess)
    member = min(along.members, key=lambda m: abs(m.with_derivative(guess).newton_step))
    path = solution(member, guess)
    assert path.sigma == pytest.approx(found.mode.sigma, rel=1e-9)
    assert path.nodes.imag.any()
    on_axis = np.flatnonzero((path.nodes.imag == 0.0) & (path.nodes.real <= found.line.ends[1]))
    states = member.problem.of_whole(path.phi[on_axis])
    same = found.state(path.nodes[on_axis].real)
    place = np.unravel_index(int(np.abs(same).argmax()), same.shape)
    u, v = same / same[place], states / states[place]
    assert (np.abs(u - v).max(axis=0) <= 1e-8 * np.maximum(np.abs(u).max(axis=0), 1e-9)).all()


def test_qz_of_the_reference_has_the_same_vectors() -> None:
    """Chebyshev collocation of the streamfunction: its right eigenvector at the collocation points."""
    flow = PlanePoiseuille(half=False)
    found = eigenfunction(flow, ORSZAG)
    y, D = collocation_points(80)
    D2 = D @ D
    lap = D2 - np.eye(len(y))
    U = np.diag(1 - y * y)
    A = lap @ lap / flow.reynolds - 1j * U @ lap - 2j * np.eye(len(y))
    B = lap.astype(complex)
    for row, values in ((0, np.eye(len(y))[0]), (-1, np.eye(len(y))[-1]), (1, D[0]), (-2, D[-1])):
        A[row], B[row] = values, 0.0
    inverse = np.linalg.solve(A - (ORSZAG + 1e-9) * B, B)
    vector = inverse @ np.ones(len(y), complex)
    for _ in range(6):
        vector = inverse @ vector
        vector /= vector[np.abs(vector).argmax()]
    mine = found(y)["phi"]
    assert np.abs(mine / mine[np.abs(vector).argmax()] - vector).max() < 1e-6


def collocation_points(n: int) -> tuple[np.ndarray, np.ndarray]:
    """Chebyshev points (n+1,) and their differentiation matrix, by barycentric weights."""
    x = np.cos(math.pi * np.arange(n + 1) / n)
    w = (-1.0) ** np.arange(n + 1)
    w[[0, -1]] *= 0.5
    D = (w / w[:, None]) / (x[:, None] - x + np.eye(n + 1))
    np.fill_diagonal(D, 0.0)
    np.fill_diagonal(D, -D.sum(axis=1))
    return x, D


@pytest.mark.parametrize("name", ["high", "low"])
def test_the_bound_holds_against_a_finer_solution(scenes: dict[str, ChuteProblem], name: str) -> None:
    rough, fine = (eigenfunction(scenes[name], MODES[name], rtol) for rtol in (1e-6, 1e-12))
    z = np.linspace(0.0, rough.line.ends[1], 60)
    unknown, place = rough.peak
    u, v = rough(z), fine(z)
    factor = rough(place)[unknown] / fine(place)[unknown]
    sizes = {key: np.abs(v[key]).max() for key in v}
    largest = max(sizes.values())
    error = max(np.abs(u[key] - factor * v[key]).max() / sizes[key] for key in v if sizes[key] > 1e-9 * largest)
    assert error <= rough.error < 1e-3
    assert fine.error < 1e-10


# what it says, and what it refuses


def test_unknowns_have_names_and_the_largest_is_one() -> None:
    found = st.eigenfunction("benard", 3.44)
    assert found.names == ("W", "theta")
    name, place = found.peak
    assert found(place)[name] == pytest.approx(1.0, abs=1e-12)
    assert max(np.abs(f).max() for f in found(np.linspace(0, 1, 101)).values()) <= 1.0 + 1e-12
    assert found.normalization.startswith(f"{name} = 1 at z = ")
    radial = st.equations(["y"], ["d(y,2) + d(y)/r - sigma*y"], st.Conditions(1, ["y"]), st.Conditions(2, ["y"]), variable="r")
    assert eigenfunction(radial, -9.75).normalization.startswith("y = 1 at r = 1.4")
    derived = eigenfunction(PROBLEMS["periodic"][0](), 0.4)
    assert derived.names == ("u",)
    assert derived(0.5)["u"] == pytest.approx(derived(0.5 + 2 * math.pi if derived.line.ends[1] > 6.5 else 0.5)["u"])


def test_other_units_of_the_eigenvalue_leave_the_eigenfunction_alone() -> None:
    from shootstab.problems.rescaled import Rescaled

    own = plane_poiseuille()
    a, b = eigenfunction(own, ORSZAG), eigenfunction(Rescaled(own, -1j), 1j * ORSZAG)
    z = np.linspace(0, 1, 9)
    assert a.names == b.names
    u, v = (f(z)["u"] / f(0.5)["u"] for f in (a, b))  # the largest value is flat, and its place known to half the digits
    assert np.abs(u - v).max() < 1e-10


def test_what_is_no_simple_mode_and_what_is_outside_is_refused() -> None:
    found = eigenfunction(benard(2000.0, 3.117), 3.44)
    with pytest.raises(InputError, match=r"z = 1.5: allowed is z from 0 to 1"):
        found(1.5)
    with pytest.raises(InputError, match="finite real"):
        found(float("nan"))
    with pytest.raises(InputError, match="unknowns"):
        st.problem(2, lambda z: np.eye(2), st.Wall(0, [[1, 0]]), st.Wall(1, [[1, 0]]), unknowns=["a", "a"])
    twice = st.problem(
        4,
        lambda z: (np.kron(np.eye(2), [[0, 1], [0, 0]]) + 1e-30, np.kron(np.eye(2), [[0, 0], [1, 0]])),
        st.Wall(0, [[1, 0, 0, 0], [0, 0, 1, 0]]),
        st.Wall(1, [[1, 0, 0, 0], [0, 0, 1, 0]]),
    )
    with pytest.raises(InputError, match="stands for 2"):
        eigenfunction(twice, -(math.pi**2))


def test_sensitivities_are_those_of_an_eigenfunction(scenes: dict[str, ChuteProblem]) -> None:
    with pytest.raises(st.InputError, match=r"ChuteProblem is no eigenfunction: allowed is what st\.eigenfunction"):
        st.sensitivities(scenes["high"], ["ky"])  # type: ignore[arg-type]
