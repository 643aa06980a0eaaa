"""problems/linear_problem.py: any pencil between any ends; the decaying space is analytic; mistakes are named."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
import scipy.linalg

import shootstab as st
from shootstab.core.errors import InputError, Undecidable
from shootstab.discriminants.frame import Frame
from shootstab.problems.kato_frame import KatoFrame
from shootstab.problems.protocol import Pencil
from shootstab.problems.splitting import AsymptoticPencil
from shootstab.problems.unknowns import unknowns

ORSZAG = -1j * (0.23752648882047010745 + 0.0037396706229794099322j)
CLAMPED = np.eye(2, 4)


def poiseuille(y: Any, R: float = 10000.0, alpha: float = 1.0) -> tuple[Any, Any]:
    U, a2 = 1 - y * y, alpha * alpha
    D0 = np.eye(4, k=1, dtype=np.complex128)
    D0[3, 0], D0[3, 2] = -a2 * a2 - 1j * alpha * R * (U * a2 - 2), 2 * a2 + 1j * alpha * R * U
    D1 = np.zeros((4, 4), dtype=np.complex128)
    D1[3, 0], D1[3, 2] = -R * a2, R
    return D0, D1


def string(z: Any) -> tuple[Any, Any]:
    """y″ = σ y: between walls at 0 and 1, y = 0, σ = −(nπ)²."""
    return np.array([[0.0, 1.0], [0.0, 0.0]]), np.array([[0.0, 0.0], [1.0, 0.0]])


FIXED = [[1.0, 0.0]]


# modes


def test_poiseuille_from_a_plain_function() -> None:
    problem = st.problem(4, poiseuille, st.Wall(-1, CLAMPED), st.Wall(1, CLAMPED))
    mode = st.refine(problem, ORSZAG * 1.01)
    assert mode.converged
    assert abs(mode.sigma - ORSZAG) <= mode.error < 1e-10
    assert st.verify(problem, [-1j * (0.23752649 + 0.00373967j)]).summary["confirmed"] == 1


def test_compiled_vectorized_and_plain_are_the_same_problem() -> None:
    from numba import njit

    @njit
    def compiled(y):  # type: ignore[no-untyped-def]
        D0, D1 = np.zeros((4, 4), dtype=np.complex128), np.zeros((4, 4), dtype=np.complex128)
        U, R = 1 - y * y, 10000.0
        D0[0, 1] = D0[1, 2] = D0[2, 3] = 1
        D0[3, 0], D0[3, 2] = -1 - 1j * R * (U - 2), 2 + 1j * R * U
        D1[3, 0], D1[3, 2] = -R, R
        return D0, D1

    def many(y: Any) -> tuple[Any, Any]:
        return np.array([poiseuille(p)[0] for p in y]), poiseuille(0.0)[1]

    walls = st.Wall(-1, CLAMPED), st.Wall(1, CLAMPED)
    z = np.linspace(-1, 1, 5).astype(complex)
    plain = st.problem(4, poiseuille, *walls).pencil(z)
    for other in (st.problem(4, compiled, *walls), st.problem(4, many, *walls, vectorized=True)):
        for name in ("C0", "C1", "D0", "D1"):
            np.testing.assert_array_equal(getattr(other.pencil(z), name), getattr(plain, name))


def test_four_matrices_and_two_are_the_same_problem() -> None:
    def four(z: float) -> tuple[Any, ...]:
        S = np.array([[2.0, z], [0.0, 1j]])
        D0, D1 = string(z)
        return S, 0 * S, S @ D0, S @ D1

    mode = st.refine(st.problem(2, four, st.Wall(0, FIXED), st.Wall(1, FIXED)), -9.5)
    assert abs(mode.sigma + math.pi**2) <= mode.error < 1e-9


@pytest.mark.parametrize("method", [st.Frame(rtol=1e-11), st.Compound(rtol=1e-11), st.Riccati(rtol=1e-11)], ids=lambda m: m.name)
def test_poeschl_teller_next_to_its_continuum(method: Any) -> None:
    """λ = ν² on the whole line, both spaces found from the limiting matrix; ν = 0.02 decays over 50 lengths and starts at 25."""
    for nu in (0.2, 0.02):
        problem = st.gallery.poeschl_teller(nu)
        mode = st.refine(problem, 1.1 * nu**2, rtol=1e-9, method=method)
        assert mode.converged
        assert abs(mode.sigma - nu**2) <= mode.error
        assert mode.continuum_distance == pytest.approx(nu**2, rel=0.05)
        assert [(end.decaying, round(end.gap, 12)) for end in problem.ends(nu**2)] == [(1, 2 * nu)] * 2
        assert problem.start(nu**2, 1e-14) < 25.0


def test_all_bound_states_and_nothing_across_the_continuum() -> None:
    problem = st.gallery.poeschl_teller(1.5)
    with pytest.raises(Undecidable, match="enters the region"):
        st.count(problem, st.Rectangle(-1 - 1j, 3 + 1j))
    report = st.verify(problem, [-0.5, 1.0, 2.25001], digits=6, region=st.Rectangle(0.01 - 1j, 3 + 1j))
    assert [v.verdict for v in report.verdicts] == ["continuum", "spurious", "inaccurate"]
    assert [round(complex(m.sigma).real, 9) for m in report.missing] == [0.25]


def test_a_half_line_wants_as_many_rows_as_solutions_grow() -> None:
    """The odd states of Pöschl–Teller with y(0) = 0, the even ones with y′(0) = 0; from the right and from the left."""
    whole = st.gallery.poeschl_teller(2.5).function.function

    def pencil(x: float) -> tuple[Any, Any]:
        D0, D1 = whole(np.array([x]))
        return D0[0], D1

    for rows, exact in (([[1.0, 0.0]], 2.25), ([[0.0, 1.0]], 6.25)):
        for ends in ((st.Wall(0, rows), st.Infinity()), (st.Infinity(), st.Wall(0, rows))):
            mode = st.refine(st.problem(2, pencil, *ends), exact + 0.1)
            assert abs(mode.sigma - exact) <= mode.error < 1e-9


def test_a_potential_without_limit() -> None:
    """The harmonic oscillator, −y″ + x² y = λ y, λ = 2n + 1."""

    def pencil(x: float) -> tuple[Any, Any]:
        return np.array([[0, 1], [x * x, 0]]), np.array([[0, 0], [-1, 0]])

    problem = st.problem(2, pencil, st.Infinity(start=9), st.Infinity(start=9))
    found = st.find(problem, st.Rectangle(0 - 1j, 6 + 1j)).modes
    np.testing.assert_allclose(sorted(m.sigma.real for m in found), [1, 3, 5], rtol=1e-9)


def test_a_limit_that_the_function_cannot_give_is_given() -> None:
    """z e^{−z} is no number at ∞: y″ = (σ + (z − 2) e^{−z}) y, with its limit said, against a function that can be asked there."""

    def named(z: float) -> tuple[Any, Any]:
        return np.array([[0, 1], [z * math.exp(-z) - 2 * math.exp(-z), 0]]), np.array([[0, 0], [1, 0]])

    def finite(z: float) -> tuple[Any, Any]:
        return named(min(z, 800.0))

    given = [(named, st.Infinity(limit=string(0.0))), (finite, st.Infinity())]
    modes = [st.refine(st.problem(2, f, st.Wall(0, [[0.0, 1.0]]), end), 0.2) for f, end in given]
    assert modes[0].converged
    assert abs(modes[0].sigma - modes[1].sigma) <= modes[0].error + modes[1].error


# rows and interfaces


def test_rows_that_hold_sigma_at_either_wall_or_both() -> None:
    """y″ = σy with y′ = −σ y at z = 1, y(0) = 0: k cot k = k², σ = −k². Mirrored, and then at both ends."""
    from scipy.optimize import brentq

    k = brentq(lambda k: math.cos(k) - k * math.sin(k), 0.1, 1.5, xtol=1e-15)
    right = st.Wall(1, [[0.0, 1.0]], [[1.0, 0.0]])
    left = st.Wall(-1, [[0.0, 1.0]], [[-1.0, 0.0]])
    middle = st.Wall(0, FIXED)
    for problem in (st.problem(2, string, middle, right), st.problem(2, string, left, middle), st.problem(2, string, left, right)):
        mode = st.refine(problem, -(k**2) * 1.02)
        assert abs(mode.sigma + k**2) <= mode.error < 1e-9
    # both ends: the modes even about 0 are there too, and nothing else
    even = brentq(lambda k: math.sin(k) + k * math.cos(k), 1.6, 3.1, xtol=1e-15)
    found = st.find(st.problem(2, string, left, right), st.Rectangle(-6 - 1j, -0.1 + 1j))
    np.testing.assert_allclose(sorted(m.sigma.real for m in found.modes), sorted([-(k**2), -(even**2)]), rtol=1e-9)


def beads(z: float, masses: list[tuple[float, float]]) -> st.LinearProblem:
    """A string with point masses: y continuous, y′ jumps by σ m y."""
    joints = [st.Interface.jump(at, np.eye(2), [[0, 0], [m, 0]]) for at, m in masses]
    return st.problem(2, string, st.Wall(0, FIXED), st.Wall(z, FIXED), interfaces=joints)


@pytest.mark.parametrize("masses", [[(0.3, 0.5)], [(0.3, 0.5), (0.8, 2.0)], [(0.9, 0.1), (0.2, 1.0), (0.5, 0.3)]])
def test_interfaces_against_the_product_of_transfer_matrices(masses: list[tuple[float, float]]) -> None:
    problem = beads(1.0, masses)

    def exact(sigma: complex) -> complex:
        """y(1) of the solution with y(0) = 0, y′(0) = 1."""
        state, z = np.array([0.0, 1.0], dtype=complex), 0.0
        for at, m in [*sorted(masses), (1.0, 0.0)]:
            state = scipy.linalg.expm(np.array([[0, 1], [sigma, 0]]) * (at - z)) @ state
            state, z = state + np.array([0, sigma * m * state[0]]), at
        return complex(state[0])

    mode = st.refine(problem, -6.0)
    assert mode.converged
    h = 1e-4
    slope = (exact(mode.sigma + h) - exact(mode.sigma - h)) / (2 * h)
    assert abs(exact(mode.sigma) / slope) <= mode.error + 1e-12
    assert mode.error < 1e-9
    D = Frame(rtol=1e-10).on(problem)
    ratio = [D(s).over(D(-1.0)) / (exact(s) / exact(-1.0)) for s in (-3.0 + 1j, 5.0, -20.0)]
    np.testing.assert_allclose(ratio, 1.0, rtol=1e-9)  # D is the function itself, up to a constant


def test_coefficients_may_jump_at_an_interface() -> None:
    """A square well on the whole line, −y″ − 4·[|x| < 1] y = −λy: k tan k = √λ, k² = 4 − λ."""
    from scipy.optimize import brentq

    def pencil(x: float) -> tuple[Any, Any]:
        return np.array([[0, 1], [-4.0 * (abs(x) < 1), 0]]), np.array([[0, 0], [1, 0]])

    k = brentq(lambda k: k * math.tan(k) - math.sqrt(4 - k * k), 0.1, 1.5, xtol=1e-15)
    joints = [st.Interface.jump(z, np.eye(2)) for z in (-1, 1)]
    mode = st.refine(st.problem(2, pencil, st.Infinity(), st.Infinity(), interfaces=joints), 4 - k * k + 0.1)
    assert abs(mode.sigma - (4 - k * k)) <= mode.error < 1e-9


# the continuous spectrum inside


def channel(alpha: float, curve: bool) -> st.LinearProblem:
    """Rayleigh's equation for U = tanh y between walls at ±3: C is singular where σ = −iαU(y)."""
    a2 = alpha * alpha

    def pencil(y: complex) -> tuple[Any, ...]:
        U = np.tanh(y)
        D0 = np.array([[0, 1], [1j * alpha * U * (a2 - 2 * (1 - U * U)), 0]])
        return np.diag([1, 1j * alpha * U]), np.diag([0, 1]), D0, np.array([[0, 0], [a2, 0]])

    continuum = (lambda y: -1j * alpha * np.tanh(y)) if curve else False
    return st.problem(2, pencil, st.Wall(-3, FIXED), st.Wall(3, FIXED), continuum=continuum)


def test_around_the_singular_point_of_ones_own_continuum() -> None:
    """Both paths give the mode of α = 0.97; next to neutral, at a distance of 1e-4, only the one that leaves the real axis does.

    Neutral is α² = 0.97975, the largest eigenvalue of y″ + 2 sech² y with y(±3) = 0 (by Chebyshev collocation); beyond, σ = 0 has passed
    through the continuous spectrum, and what is left of the mode is a resonance.
    """
    bent, straight = (st.refine(channel(0.97, curve), 0.0117, rtol=1e-9) for curve in (True, False))
    assert bent.path != "real"
    assert straight.path == "real"
    assert abs(bent.sigma - straight.sigma) <= bent.error + straight.error
    near = st.refine(channel(0.9897, True), 0.004, rtol=1e-9)
    assert near.converged
    assert near.continuum_distance == pytest.approx(near.sigma.real, rel=1e-6)
    assert 0.0 < near.sigma.real < 2e-4
    beyond = st.refine(channel(0.99, True), 0.004, rtol=1e-9)
    assert not beyond.converged
    assert "a resonance, not a mode" in beyond.status


def test_with_a_fold_the_continuum_is_a_barrier() -> None:
    problem = st.gallery.shear_layer(0.4446)
    assert problem.continuum is None
    report = st.verify(problem, [0.18970, 0.2j], digits=4)
    assert [v.verdict for v in report.verdicts] == ["confirmed", "continuum"]
    with pytest.raises(Undecidable, match="enters the region"):
        st.count(problem, st.Rectangle(-0.1 - 0.1j, 0.3 + 0.1j))


# the decaying space


def random_limit(n: int, direction: int = 1, seed: int = 3) -> AsymptoticPencil:
    rng = np.random.default_rng(seed)
    C0, C1, D0, D1 = (rng.normal(size=(4, n, n)) + 1j * rng.normal(size=(4, n, n))) * np.array([1, 0.05, 1, 0.3])[:, None, None]
    return AsymptoticPencil(Pencil(C0 + 3 * np.eye(n), C1, D0, D1), direction)


@pytest.mark.parametrize(("n", "k"), [(2, 1), (4, 2), (5, 2), (8, 4)])
def test_projector_and_its_derivative(n: int, k: int) -> None:
    limit, sigma, h = random_limit(n), 0.3 + 0.2j, 1e-6
    split = limit.splitting(sigma, k)
    P = split.X @ split.left
    np.testing.assert_allclose(P @ P, P, atol=1e-11)
    np.testing.assert_allclose(split.A @ P, P @ split.A, atol=1e-10)
    np.testing.assert_allclose(sorted(np.linalg.eigvals(split.left @ split.A @ split.X).real), limit.rates(sigma)[:k].real, atol=1e-10)
    R = np.random.default_rng(1).normal(size=(n, k)).astype(complex)
    exact = split.projected(R)[1]
    difference = (limit.splitting(sigma + h, k).projected(R)[0] - limit.splitting(sigma - h, k).projected(R)[0]) / (2 * h)
    np.testing.assert_allclose(exact, difference, rtol=1e-4, atol=1e-5 * np.abs(exact).max())


@pytest.mark.parametrize(("n", "k"), [(2, 1), (4, 2), (8, 4)])
def test_section_is_analytic_and_never_degenerate(n: int, k: int) -> None:
    """Cauchy: minors of the frame have no negative powers; Kato: ℓX′ = 0 in the determinant, so that it does not vanish."""
    kato_frame = KatoFrame(random_limit(n), k, 0.1)
    centre, radius, N = 0.25 + 0.1j, 0.1, 64
    sigmas = centre + radius * np.exp(2j * np.pi * np.arange(N) / N)
    frames, slopes, logs = [], [], []
    for sigma in sigmas:
        frame, tangent, log_scale, split = kato_frame.frame(sigma)
        frames.append(frame), slopes.append(tangent), logs.append(log_scale)
        assert abs(np.trace(np.linalg.solve(split.left @ frame, split.left @ tangent))) < 1e-9
    rows = np.random.default_rng(5).normal(size=(k, n))
    minors = np.array([np.linalg.det(rows @ F) * math.exp(log) for F, log in zip(frames, logs, strict=True)])
    modes = np.fft.fft(minors) / N
    assert np.abs(modes[N // 2 :]).max() < 1e-7 * np.abs(minors).max()  # no negative powers of σ − centre
    # the derivative given is the derivative
    derivative = np.fft.fft(minors) / N * np.fft.fftfreq(N, 1 / N)
    exact = np.fft.ifft(derivative * N) / (sigmas - centre)
    given = [m * np.trace(np.linalg.solve(rows @ F, rows @ T)) for m, F, T in zip(minors, frames, slopes, strict=True)]
    np.testing.assert_allclose(given, exact, rtol=1e-5)


def test_the_section_does_not_depend_on_the_cells_it_came_through() -> None:
    limit = random_limit(4)
    direct, wandering = KatoFrame(limit, 2, 0.1), KatoFrame(limit, 2, 0.1)
    for sigma in np.linspace(0.5 + 0.5j, 0.1, 9):
        wandering.frame(complex(sigma))
    a, b = direct.frame(0.31 + 0.27j), wandering.frame(0.31 + 0.27j)
    rows = np.random.default_rng(5).normal(size=(2, 4))
    assert np.linalg.det(rows @ a[0]) * math.exp(a[2]) == pytest.approx(np.linalg.det(rows @ b[0]) * math.exp(b[2]), rel=1e-7)


def test_winding_of_D_is_the_number_of_modes_for_a_region_many_cells_wide() -> None:
    from shootstab.roots.winding import wind

    D = Frame(rtol=1e-9).on(st.gallery.poeschl_teller(2.5))
    assert wind(D, st.Rectangle(1e-4 - 4j, 20 + 4j)).count == 3
    assert wind(D, st.Rectangle(1e-4 - 1e-3j, 0.2 + 1e-3j)).count == 0


def test_on_the_cut_nothing_is_said() -> None:
    problem = st.gallery.poeschl_teller(0.2)
    with pytest.raises(Undecidable, match="continuous spectrum"):
        problem.far_frame(20.0, -1.0)
    mode = st.refine(problem, -1.0)
    assert not mode.converged


# mistakes

WALLS = st.Wall(0, FIXED), st.Wall(1, FIXED)


def nan_at_half(z: float) -> tuple[Any, Any]:
    D0, D1 = string(z)
    return (D0 * (math.nan if z > 0.5 else 1.0)), D1


MISTAKES: dict[str, tuple[Any, tuple[str, ...]]] = {
    "no size": (lambda: st.problem(0, string, *WALLS), ("size = 0", "1 to 64")),
    "no function": (lambda: st.problem(2, 3.0, *WALLS), ("pencil = 3.0", "a function")),  # type: ignore[arg-type]
    "no end": (lambda: st.problem(2, string, 0.0, WALLS[1]), ("left = 0.0", "st.Wall")),  # type: ignore[arg-type]
    "columns": (lambda: st.problem(2, string, st.Wall(0, [[1, 0, 0]]), WALLS[1]), ("left wall", "shape (1, 3)", "(m, 2)")),
    "no row": (lambda: st.problem(2, string, WALLS[0], st.Wall(1, np.zeros((0, 2)))), ("right wall", "one condition at least")),
    "one row flat": (lambda: st.problem(2, string, st.Wall(0, [1, 0]), WALLS[1]), ("left wall", "shape (2,)")),
    "NaN in rows": (lambda: st.problem(2, string, WALLS[0], st.Wall(1, [[math.nan, 0]])), ("right wall", "not finite")),
    "words in rows": (lambda: st.problem(2, string, WALLS[0], st.Wall(1, [["a", 0]])), ("right wall", "no matrix")),  # type: ignore[list-item]
    "dependent rows": (
        lambda: st.problem(4, poiseuille, st.Wall(-1, CLAMPED), st.Wall(1, [[1, 0, 0, 0], [2, 0, 0, 0]])),
        ("right wall", "rank 1", "independent"),
    ),
    "too many rows": (lambda: st.problem(4, poiseuille, st.Wall(-1, np.eye(3, 4)), st.Wall(1, CLAMPED)), ("3 rows", "2", "4 in all")),
    "ends the wrong way": (lambda: st.problem(2, string, WALLS[1], WALLS[0]), ("z = 1, 0", "left end first")),
    "interface outside": (
        lambda: st.problem(2, string, *WALLS, interfaces=[st.Interface.jump(2, np.eye(2))]),
        ("z = 0, 2, 1", "different points"),
    ),
    "interface of the wrong shape": (
        lambda: st.problem(2, string, *WALLS, interfaces=[st.Interface.jump(0.5, np.eye(3))]),
        ("interface z = 0.5", "(3, 3)", "(2, 2)"),
    ),
    "singular interface": (
        lambda: st.problem(2, string, *WALLS, interfaces=[st.Interface(0.5, [[1, 0], [1, 0]], [[1, 0], [1, 0]])]),
        ("interface z = 0.5", "rank 1"),
    ),
    "no limit": (
        lambda: st.problem(2, lambda z: (np.array([[0, 1], [z * z, 0]]), np.eye(2)), st.Wall(0, FIXED), st.Infinity()),
        ("+infinity", "start="),
    ),
    "slow limit": (
        lambda: st.problem(2, lambda z: (np.array([[0, 1], [1 + 1 / (1 + z), 0]]), np.eye(2)), st.Wall(0, FIXED), st.Infinity()),
        ("+infinity", "exponentially", "start="),
    ),
    "k of the user": (lambda: st.problem(2, string, st.Wall(0, FIXED), st.Infinity(decaying=3)), ("decaying = 3", "0 to 2")),
    "k that does not match": (
        lambda: st.problem(2, string, st.Wall(0, FIXED), st.Infinity(decaying=2)),
        ("1 of 2 solutions decay towards +infinity", "decaying = 2"),
    ),
    "rows that do not match": (
        lambda: st.problem(2, string, st.Wall(0, np.eye(2)), st.Infinity()),
        ("1 of 2 solutions decay", "2 rows at the wall ask for 2"),
    ),
    "whole line with too few": (
        lambda: st.problem(2, lambda z: (np.diag([-1.0, np.tanh(z)]), 0 * np.eye(2)), st.Infinity(), st.Infinity()),
        ("1 of 2 solutions decay towards +infinity", "0 of 2 solutions decay towards -infinity", "2 in all"),
    ),
    "start before the fold": (
        lambda: st.problem(2, string, st.Infinity(start=1), st.Infinity(start=1), fold=2.0),
        ("start = 1", "beyond 2"),
    ),
    "start that is none": (lambda: st.Infinity(start=math.inf), ("start = inf", "finite number above 0")),
}


@pytest.mark.parametrize("what", MISTAKES)
def test_mistakes_are_named_when_the_problem_is_made(what: str) -> None:
    make, words = MISTAKES[what]
    with pytest.raises(InputError) as refusal:
        make()
    message = str(refusal.value)
    assert "\n" not in message
    for word in words:
        assert word in message


WRONG_PENCILS: dict[str, tuple[Any, tuple[str, ...]]] = {
    "three matrices": (lambda z: (np.eye(2),) * 3, ("gives 3", "two matrices")),
    "one matrix": (lambda z: np.eye(2), ("gives ndarray", "two matrices")),
    "wrong shape": (lambda z: (np.eye(3), np.eye(2)), ("D0 has shape (3, 3)", "(2, 2)")),
    "NaN": (nan_at_half, ("D0", "not finite at z = 0.")),
    "division by zero": (lambda z: (np.eye(2) * (1 / (z - z)), np.eye(2)), ("cannot be computed at z",)),
    "shape that varies": (lambda z: (np.eye(2 + (z > 0.5)), np.eye(2)), ("one shape",)),
    "singular C": (lambda z: (np.zeros((2, 2)), np.zeros((2, 2)), np.eye(2), np.eye(2)), ("C", "dependent at some z")),
    "an algebraic row": (
        lambda z: (np.diag([1.0, 0.0]), np.zeros((2, 2)), np.array([[0.0, 1.0], [1.0, 1.0]]), np.eye(2)),
        ("dependent at some z", "to be put into the others"),
    ),
}


@pytest.mark.parametrize("what", WRONG_PENCILS)
def test_mistakes_in_the_function_are_named_when_it_is_used(what: str) -> None:
    pencil, words = WRONG_PENCILS[what]
    with pytest.raises(InputError) as refusal:
        st.refine(st.problem(2, pencil, *WALLS), -9.0)
    for word in words:
        assert word in str(refusal.value)


def test_a_compiled_function_that_is_wrong_is_told_in_the_same_words() -> None:
    from numba import njit

    @njit
    def pencil(z):  # type: ignore[no-untyped-def]
        return np.eye(3), np.eye(3)

    with pytest.raises(InputError, match=r"D0 has shape \(3, 3\)"):
        st.refine(st.problem(2, pencil, *WALLS), -9.0)


def test_a_vectorized_pencil_of_another_number_of_points_is_named() -> None:
    with pytest.raises(InputError, match=r"shape \(\d+, 2, 2\) at \d+ points: allowed is"):
        st.problem(2, lambda z: (np.zeros((len(z) + 1, 2, 2)), np.eye(2)), *WALLS, vectorized=True)


@pytest.mark.parametrize("compiled", [False, True])
@pytest.mark.parametrize("walls", [(0, 1), (-1, 0)])
def test_a_wall_at_a_singular_point_is_named(walls: tuple[float, float], compiled: bool) -> None:
    from numba import njit

    def pencil(z):  # type: ignore[no-untyped-def]
        D0, D1 = np.zeros((2, 2)), np.zeros((2, 2))
        D0[0, 1], D0[1, 0], D1[1, 0] = 1.0, 1 / z, 1.0
        return D0, D1

    function = njit(pencil) if compiled else pencil
    with pytest.raises(InputError, match="at z = 0: ZeroDivisionError") as refusal:
        st.refine(st.problem(2, function, st.Wall(walls[0], FIXED), st.Wall(walls[1], FIXED)), -9.0)
    assert "put the wall next to it" in str(refusal.value)


def test_a_continuum_that_is_no_number() -> None:
    problem = st.problem(2, string, *WALLS, continuum=lambda z: math.nan)
    with pytest.raises(InputError, match="continuum"):
        st.refine(problem, -9.0)


def test_the_coordinate_is_called_what_it_is_named() -> None:
    rows = np.eye(2)[:1]
    asked = (2, lambda z: (np.eye(2, k=1), np.eye(2, k=-1)), st.Wall(0, rows), st.Wall(1, rows))
    assert unknowns(st.problem(*asked, variable="r")).variable == "r"
    assert unknowns(st.problem(*asked, variable="r")).names == ("psi1", "psi2")
    assert unknowns(st.problem(*asked)).variable == "z"
    for name in ("blasius", "suction", "shear-layer", "malik-3"):
        assert unknowns(st.scene(name).problem).variable == "y"
    with pytest.raises(InputError, match="variable = 'a b': allowed is a name"):
        st.problem(*asked, variable="a b")
