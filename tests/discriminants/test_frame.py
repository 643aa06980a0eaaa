"""D(σ) by orthonormalized shooting: reduction of the pencil, far field, analyticity, exact derivative."""

from __future__ import annotations

import numpy as np
import pytest

from shootstab.core.errors import InputError
from shootstab.core.regions import Disc, Rectangle
from shootstab.discriminants.frame import Frame
from shootstab.discriminants.mesh import halved, redistribute, subdivide
from shootstab.discriminants.meshing import cut_for, made_for
from shootstab.discriminants.sampled_system import reduce_pencil, sample_system
from shootstab.discriminants.shooting import Shooting
from shootstab.kernels import elimination
from shootstab.models import chute
from shootstab.models.chute import ChuteProblem
from shootstab.models.chute.far_field import FarField, decay_matrix
from shootstab.models.gallery.poiseuille import PlanePoiseuille
from shootstab.problems.protocol import Pencil
from shootstab.roots.iterations import newton
from shootstab.roots.winding import wind

RNG = np.random.default_rng(11)
GUESS = {"high": 0.00397, "mid": 0.00102, "low": 0.00727 - 0.0119j, "fig2": 0.0017 - 0.0016j}


def random_complex(*shape: int) -> np.ndarray:
    return RNG.standard_normal(shape) + 1j * RNG.standard_normal(shape)


def reduced_matrix(reduced: tuple[np.ndarray, ...], sigma: complex) -> np.ndarray:
    X, V, G, T = (a[0] for a in reduced)
    t = T[0] + sigma * T[1] + sigma**2 * T[2]
    return X[0] + sigma * X[1] + V @ np.linalg.solve(G[0] + sigma * G[1], t) if V.shape[1] else X[0] + sigma * X[1]


@pytest.mark.parametrize("moving", [(), (2,), (0, 3), (0, 1, 2, 3)])
@pytest.mark.parametrize("sparse", [True, False])
def test_reduction_is_the_solved_pencil(moving: tuple[int, ...], sparse: bool) -> None:
    C0, C1, D0, D1 = (random_complex(1, 4, 4) for _ in range(4))
    keep = np.isin(np.arange(4), moving)
    C1[:, ~keep] = 0
    if sparse:
        C1[:, :, ~keep] = 0
    reduced = reduce_pencil(Pencil(C0, C1, D0, D1), 4)
    for sigma in (0.3 - 0.2j, 5j):
        np.testing.assert_allclose(reduced_matrix(reduced, sigma), np.linalg.solve(C0[0] + sigma * C1[0], D0[0] + sigma * D1[0]), rtol=1e-9)


def test_reduction_of_the_chute_is_singular_on_the_continuous_spectrum_only(scenes: dict[str, ChuteProblem]) -> None:
    problem, z = scenes["fig2"], np.array([15.0 + 0j])
    _X, V, G, T = reduce_pencil(problem.pencil(z), 8)
    assert V.shape[2] == 1
    assert np.all(T[0, 2] == 0)
    sigma_c = -G[0, 0, 0, 0] / G[0, 1, 0, 0]
    assert sigma_c == pytest.approx(problem.continuum(z)[0], rel=1e-12)


def test_bad_pencils_are_named() -> None:
    good = [np.eye(3, dtype=complex)[None] for _ in range(4)]
    with pytest.raises(InputError, match="shape"):
        reduce_pencil(Pencil(*good), 4)
    with pytest.raises(InputError, match="D1 is not finite"):
        reduce_pencil(Pencil(*good[:3], np.full((1, 3, 3), np.nan, complex)), 3)
    with pytest.raises(InputError, match="dependent at some z"):
        reduce_pencil(Pencil(np.zeros((1, 3, 3), complex), 0 * good[1], *good[2:]), 3)


def test_determinant_and_derivative_also_where_it_vanishes() -> None:
    for det_with_slope in (elimination.det_with_slope, elimination.det_with_slope.py_func):
        M, dM = random_complex(4, 4), random_complex(4, 4)
        det, slope = det_with_slope(M, dM)
        assert det == pytest.approx(np.linalg.det(M), rel=1e-12)
        assert slope == pytest.approx(det * np.trace(np.linalg.solve(M, dM)), rel=1e-11)
        M[3] = M[2]
        det, slope = det_with_slope(M, dM)
        assert abs(det) < 1e-14
        assert slope == pytest.approx((np.linalg.det(M + 1e-6 * dM) - np.linalg.det(M - 1e-6 * dM)) / 2e-6, rel=1e-6)
        assert det_with_slope(np.zeros((1, 1), complex), np.ones((1, 1), complex)) == (0, 1)


def test_meshes_keep_their_ends_and_corners() -> None:
    nodes = np.array([3.0, 2.0, 1.0 + 1j, 0.5j, 0.0])
    for new in (
        redistribute(nodes, np.array([1e-3, 1e-20, 1e-5, 1e-9]), 1e-10),
        subdivide(nodes, np.array([1e-3, 0, np.nan, 0]), 1e-10),
        halved(nodes),
    ):
        assert new[0] == 3.0
        assert new[-1] == 0.0
        assert {2.0, 1.0 + 1j, 0.5j} <= set(new.tolist())


@pytest.mark.parametrize(("kx", "ky"), [(0.0, 0.01), (0.011, 0.0), (0.004, 0.006)])
def test_decay_matrix_solves_the_stokes_equations_at_infinity(kx: float, ky: float) -> None:
    """e^{−Bz}α satisfies (A 32)–(A 34), and B is the matrix of (2.20)–(2.21)."""
    B, K = decay_matrix(kx, ky)[:3, :3], np.hypot(kx, ky)
    second, mixed = np.diag([1, 1, 1.0]), np.zeros((3, 3), complex)
    mixed[0, 2], mixed[1, 2] = 1j * kx / 3, 1j * ky / 3
    mixed[2, 0], mixed[2, 1] = 1j * kx / 4, 1j * ky / 4
    zeroth = -np.array([[4 / 3 * kx**2 + ky**2, kx * ky / 3, 0], [kx * ky / 3, kx**2 + 4 / 3 * ky**2, 0], [0, 0, 3 / 4 * K**2]])
    assert np.abs(second @ B @ B - mixed @ B + zeroth).max() < 1e-14 * K**2 * 100
    printed = np.array(
        [
            [(8 * kx**2 + 7 * ky**2) / (7 * K), kx * ky / (7 * K), 1j * kx / 7],
            [kx * ky / (7 * K), (7 * kx**2 + 8 * ky**2) / (7 * K), 1j * ky / 7],
            [1j * kx / 7, 1j * ky / 7, 6 * K / 7],
        ]
    )
    np.testing.assert_allclose(B, printed, atol=1e-16)


def test_far_frame_is_carried_by_the_system(scenes: dict[str, ChuteProblem]) -> None:
    """The space spanned at one height, carried down, is the space spanned at the other, as is its σ-derivative."""
    problem, sigma = scenes["fig2"], 0.0017 - 0.0016j
    values = []
    for nu in (1e-5, 1e-7, 1e-9):
        first = sample_system(problem, problem.mesh(problem.flow.height(nu)).astype(complex))
        values.append(cut_for(Shooting(problem, Frame(rtol=1e-12), first), [sigma]).with_derivative(sigma))
    for v in values[1:]:
        assert v.D.over(values[0].D) == pytest.approx(1.0, abs=2e-10)
        assert v.logarithmic_derivative == pytest.approx(values[0].logarithmic_derivative, rel=2e-10)


@pytest.mark.parametrize("real", [False, True])
def test_the_determinant_of_wall_rows_and_frame(real: bool) -> None:
    """det[(W0 + σ W1) Y] and its slope by NumPy and by differences; where W0 + σ W1 has a zero that its slope has not; both ways."""
    rng = np.random.default_rng(8)
    W0, W1, Y, dY = (rng.standard_normal(shape) for shape in ((3, 6), (3, 6), (6, 3), (6, 3)))
    sigma = 0.4 if real else 0.4 - 0.3j
    if not real:
        W0, Y = W0 + 1j * rng.standard_normal((3, 6)), Y + 1j * rng.standard_normal((6, 3))
        W1, dY = W1.astype(complex), dY.astype(complex)
    W0[1, 2], W0[2, 4], W1[2, 4] = -sigma * W1[1, 2], 0.0, 0.0

    def exact(s: complex) -> complex:
        return complex(np.linalg.det((W0 + s * W1) @ (Y + (s - sigma) * dY)))

    for kernel in (elimination.wall_determinant, elimination.wall_determinant.py_func):
        det, slope = kernel(W0 + sigma * W1, W1, Y, dY)
        assert det == pytest.approx(exact(sigma), rel=1e-12)
        assert slope == pytest.approx((exact(sigma + 1e-5) - exact(sigma - 1e-5)) / 2e-5, rel=1e-7)


def _far_field(problem: ChuteProblem) -> FarField:
    return FarField(problem.flow.chute, problem.flow.far_temperature, problem.flow.far_velocity, problem.kx, problem.ky)


def test_the_far_field_in_real_numbers_is_that_in_complex_ones(scenes: dict[str, ChuteProblem]) -> None:
    """For kx = 0 and real sigma the series runs in float64; with the least imaginary part of sigma in complex128, to the same frame."""
    problem, sigma = scenes["high"], 0.004
    z = problem.start(sigma, 1e-12)
    real, other = problem.far_frame(z, sigma), problem.far_frame(z, sigma + 1e-30j)
    assert _far_field(problem).terms(sigma)[0].dtype == np.float64
    for a, b in ((real.frame, other.frame), (real.tangent, other.tangent)):
        np.testing.assert_allclose(a, b, rtol=1e-12, atol=1e-14 * np.abs(b).max())
    assert real.error == pytest.approx(other.error, rel=1e-3)
    assert _far_field(scenes["low"]).terms(sigma)[0].dtype == np.complex128


@pytest.mark.parametrize("name", list(GUESS))
def test_sigma_does_not_move_with_the_far_field_start(scenes: dict[str, ChuteProblem], name: str) -> None:
    """A factor of 100 in ν moves σ by less than 1e−11."""
    problem = scenes[name]
    shooting = made_for(problem, Frame(rtol=1e-13), None, GUESS[name])
    sigma = newton(shooting, GUESS[name], 1e-14).sigma
    nu = float(np.exp(problem.flow.states_at(shooting.sampled.nodes[0].real)[0].real)) / 100
    first = sample_system(problem, problem.mesh(problem.flow.height(nu)).astype(complex))
    higher = cut_for(Shooting(problem, Frame(rtol=1e-13), first), [sigma])
    assert newton(higher, sigma, 1e-14).sigma == pytest.approx(sigma, rel=1e-11)


@pytest.mark.parametrize("name", ["high", "low", "fig2"])
def test_D_is_analytic_and_its_derivative_exact(scenes: dict[str, ChuteProblem], name: str) -> None:
    """Cauchy–Riemann by differences along both axes, against dD/dσ."""
    sigma = GUESS[name] * (1.2 + 0.1j)
    shooting = Frame(rtol=1e-10).on(scenes[name]).at(sigma)
    value, eps = shooting.with_derivative(sigma), 1e-4 * abs(sigma)
    for direction in (eps, 1j * eps):
        ahead, behind = shooting(sigma + direction), shooting(sigma - direction)
        derivative = (ahead.at_scale(value.D.log_scale) - behind.at_scale(value.D.log_scale)) / (2 * direction)
        assert derivative == pytest.approx(value.dD, rel=1e-6)


def test_D_is_real_for_real_sigma_without_downslope_wave(scenes: dict[str, ChuteProblem]) -> None:
    """k_x = 0: with v → iv the system is real, so D(σ*) = D(σ)*; one factor i belongs to the column and one to the row."""
    shooting = Frame(rtol=1e-10).on(scenes["high"])
    sigma = 0.004 + 0.002j
    a, b = shooting(sigma), shooting(sigma.conjugate())
    assert b.mantissa == pytest.approx(a.mantissa.conjugate(), rel=1e-9)


def test_reflection_ky(flows) -> None:
    """y → −y: D is even in k_y."""
    a = Frame().on(chute.problem(flows["mid"], 0.003, 0.006))
    b = Frame().on(chute.problem(flows["mid"], 0.003, -0.006))
    sigma = 0.001 - 0.004j
    assert b(sigma).over(a(sigma)) == pytest.approx(1.0, abs=1e-8)


def test_complex_conjugation_kx(flows) -> None:
    """x → −x conjugates the spectrum: D(σ; −k_x) = D(σ*; k_x)*."""
    a = Frame().on(chute.problem(flows["low"], 0.011, 0.0))
    b = Frame().on(chute.problem(flows["low"], -0.011, 0.0))
    sigma = 0.005 - 0.01j
    x, y = a(sigma), b(sigma.conjugate())
    assert y.mantissa * np.exp(y.log_scale - x.log_scale) == pytest.approx(x.mantissa.conjugate(), rel=1e-8)


def test_argument_principle_gives_integers(scenes: dict[str, ChuteProblem]) -> None:
    winding = wind(Frame(rtol=1e-9).on(scenes["high"]), Rectangle(1e-4 - 0.1j, 0.05 + 0.1j))
    assert winding.count == 1
    assert winding.closure < 0.2


def test_stalled_iterations_are_refuted(flows) -> None:
    """Where Muller has been seen to stall, the winding number is 0; around the true mode it is 1."""
    flow = chute.steady(e=0.85, e_w=0.75, r=0.5, tan_theta=0.25, far_temperature=5.0)
    shooting = Frame(rtol=1e-10).on(chute.problem(flow, 0.004, 0.006))
    for stall in (-0.0001256 - 0.0405999j, 0.0039058 - 0.0351725j):
        assert wind(shooting, Disc(stall, 1e-4)).count == 0
    assert wind(shooting, Disc(0.00182747 - 0.02681564j, 1e-6)).count == 1


@pytest.mark.parametrize("half", [True, False])
def test_poiseuille(half: bool) -> None:
    """Orszag's mode, re-computed to 20 digits (published.md)."""
    root = newton(Frame(rtol=1e-12).on(PlanePoiseuille(half=half)), -1j * (0.2375 + 0.0037j), 1e-14)
    assert abs(1j * root.sigma - (0.23752648882047010745 + 0.0037396706229794099322j)) < 2e-13
