"""The wall rows are the linearization of (A 12)–(A 18) with χ from (A 22): proved symbolically, against (A 20)–(A 26), and numerically."""

from __future__ import annotations

import math
from functools import cache

import mpmath
import numpy as np
import pytest
import sympy as sp
from linearization import A0, A0_NU, B0, DELTA, KAPPA, KX, KY, ROUGHNESS, TABLE_1, evaluator, jet, wall_matrices

from shootstab.models.chute import constitutive as law
from shootstab.models.chute.background import background
from shootstab.models.chute.parameters import Chute
from shootstab.models.chute.steady_flow import descend
from shootstab.models.chute.wall import base_matrices, wall_rows

CHUTES = [
    Chute(e=0.8, e_w=0.8, r=0.6, tan_theta=0.3),
    Chute(e=0.8, e_w=0.8, r=0.6, tan_theta=0.3, wall="isotropic"),
    Chute(e=0.92, e_w=0.65, r=0.35, tan_theta=0.44, nu_max=0.64, radial="carnahan-starling"),
    Chute(e=0.92, e_w=0.65, r=0.85, tan_theta=0.44, nu_max=0.64, radial="carnahan-starling", wall="isotropic"),
]
# ν, T, u, Q at a base that need not be in equilibrium: the rows hold for any
STATES = [(0.32, 0.61, 1.7, 0.8), (0.05, 8.9, 4.2, -1.3), (0.51, 0.08, 0.4, 0.2)]
VALUES = ("nu", "T", "u", "p", "eta", "xi", "K", "K_star", *TABLE_1)
SLOPES = ("nu", "T", "u")


def name_of(chute: Chute) -> str:
    return f"{chute.wall}-{chute.radial}-{chute.r}"


# ------------------------------------------------------------------------------------------------ against the paper
def paper_wall(isotropic: bool) -> tuple[sp.Matrix, sp.Matrix]:
    """(A 20)–(A 26) transcribed.

    ERRATA: ν and v print alike. R21, R41 take χ^ν, R21 also S_x^ν; R23, R43 take χ^v; R33 takes S_y^v. isotropic: S_z holds −½A r² ∂v/∂y,
    which puts p0 S_z^v into χ^v as p0 S_z^u stands in χ^u.
    """
    half, root = sp.Rational(1, 2), sp.sqrt(2 / sp.pi)
    nu, T, u, p, eta, xi, K, Ks = (jet(name, 0) for name in VALUES[:8])
    a, b, c, d, e, h, es, hs, _, _ = (jet(name, 0) for name in TABLE_1)
    u_z, T_z, nu_z = jet("u", 1), jet("T", 1), jet("nu", 1)
    s, r = sp.sqrt(T), ROUGHNESS

    S_x0 = root * (-KAPPA * u + (KAPPA - half * A0 * r**2) * u_z)
    S_x_nu, S_x_u = -half * root * A0_NU * r**2 * u_z, -root * KAPPA
    S_x_uz = root * (KAPPA - half * A0 * r**2)
    S_y_v, S_y_vz = -root * KAPPA, root * (KAPPA - half * A0 * r**2)
    S_z_u, S_z_wz = -half * root * A0 * r**2, root * B0
    S_z_v = S_z_u if isotropic else 0

    chi0 = p / (nu * T)
    chi_nu = (a * nu - p) / (nu**2 * T)
    chi_u = -((xi - 2 * eta / 3) * s + p * S_z_u) / (nu * T * s)
    chi_v = -(xi - 2 * eta / 3) / (nu * T) - p * S_z_v / (nu * T * s)
    chi_T = (b * T - p) / (nu * T**2)
    chi_wz = -((xi + 4 * eta / 3) * s + p * S_z_wz) / (nu * T * s)

    Q, R = sp.zeros(4, 5), sp.zeros(4, 5)

    def put(A: sp.Matrix, entries: dict[int, object]) -> None:
        for place, value in entries.items():
            A[place // 10 - 1, place % 10 - 1] = value

    put(Q, {22: eta + nu * chi0 * s * S_x_uz, 24: nu * s * S_x0 * chi_wz, 33: eta + nu * chi0 * s * S_y_vz})
    put(Q, {41: -Ks, 42: eta * u, 44: -DELTA * nu * T * s * chi_wz, 45: K})
    put(R, {14: 1, 21: c * u_z + chi0 * s * S_x0 + nu * s * S_x0 * chi_nu + nu * chi0 * s * S_x_nu})
    put(R, {22: sp.I * KX * nu * s * S_x0 * chi_u + nu * chi0 * s * S_x_u, 23: sp.I * KY * nu * s * S_x0 * chi_v})
    put(R, {25: d * u_z + nu * s * S_x0 * chi_T + half * nu * chi0 / s * S_x0, 33: nu * chi0 * s * S_y_v})
    put(R, {41: e * T_z - es * nu_z + c * u * u_z - DELTA * chi0 * T * s - DELTA * nu * T * s * chi_nu})
    put(R, {42: eta * u_z - sp.I * KX * DELTA * nu * T * s * chi_u, 43: -sp.I * KY * DELTA * nu * T * s * chi_v})
    put(R, {45: h * T_z - hs * nu_z + d * u * u_z - DELTA * nu * T * s * chi_T - sp.Rational(3, 2) * DELTA * nu * chi0 * s})
    return Q, R


@pytest.mark.parametrize("isotropic", [False, True], ids=["printed", "isotropic"])
def test_the_papers_matrices_are_the_linearization_of_the_wall_conditions(isotropic):
    for ours, theirs in zip(wall_matrices(isotropic), paper_wall(isotropic), strict=True):
        for i in range(4):
            for j in range(5):
                assert sp.expand(ours[i, j] - sp.expand(theirs[i, j])) == 0, (i + 1, j + 1)


def test_the_isotropic_wall_differs_from_the_printed_one_in_chi_v_alone():
    """In R23 and R43, both proportional to k_y; a wall isotropic in its plane treats (x, u, k_x) as (y, v, k_y)."""
    (Q, R), (Q_printed, R_printed) = wall_matrices(True), wall_matrices(False)
    assert sp.expand(Q - Q_printed) == sp.zeros(4, 5)
    difference = sp.expand(R - R_printed)
    assert {(i + 1, j + 1) for i in range(4) for j in range(5) if difference[i, j] != 0} == {(2, 3), (4, 3)}
    # at a base at rest the dissipation must not tell x from y: −Δνχ^u T^{3/2} i k_x û − Δνχ^v T^{3/2} i k_y v̂
    at_rest = {jet("u", 0): 0, jet("u", 1): 0}
    assert sp.expand(R[3, 1].subs(at_rest) * KY - R[3, 2].subs(at_rest) * KX) == 0
    assert sp.expand(R_printed[3, 1].subs(at_rest) * KY - R_printed[3, 2].subs(at_rest) * KX) != 0


# ------------------------------------------------------------------------------------------------ the code against them
@cache
def lambdified(isotropic: bool):
    Q, R = wall_matrices(isotropic)
    symbols = [jet(name, 0) for name in VALUES] + [jet(name, 1) for name in SLOPES] + [A0, A0_NU, B0, KAPPA, DELTA, ROUGHNESS, KX, KY]
    return sp.lambdify(symbols, (list(Q), list(R)), "mpmath", cse=True)


def expected_matrices(chute, bg, kx, ky):
    """Q, R (4, 5) from the symbolic linearization; A, B, κ, Δ by the formulas of (A 15), (A 16), (A 18)."""
    A, A_nu = (evaluator(chute.radial, ("A",), order, "mpmath")(bg.nu[0], chute.ep, chute.nu_max)[0] for order in (0, 1))
    root = mpmath.sqrt(1 - mpmath.mpf(chute.r) ** 2)
    kappa = (2 / (1 + root) - root) * 2 / 3
    B = A * (chute.r**2 - 2) + kappa + 2 * root
    delta = mpmath.sqrt(2 / mpmath.pi) * 2 * (1 - mpmath.mpf(chute.e_w)) / (1 + root)
    values = [getattr(bg, name)[0] for name in VALUES] + [getattr(bg, name + "_z")[0] for name in SLOPES]
    Q, R = lambdified(chute.wall == "isotropic")(*values, A, A_nu, B, kappa, delta, chute.r, kx, ky)
    return np.array(Q).reshape(4, 5), np.array(R).reshape(4, 5)


def full(entries):
    A = np.zeros((4, 5), complex)
    for place, value in entries.items():
        A[place] = value
    return A


@pytest.mark.parametrize("chute", CHUTES, ids=name_of)
@pytest.mark.parametrize("state", STATES)
def test_base_matrices_are_the_linearization(chute, state):
    bg = background(chute, *state, math.pi)
    kx, ky = 0.37, 0.21
    for got, expected in zip(base_matrices(chute, bg, kx, ky, math.pi), expected_matrices(chute, bg, kx, ky), strict=True):
        expected = expected.astype(complex)
        # a sum of terms as large as the row: relative to the row's largest entry
        assert np.all(np.abs(full(got) - expected) <= 3e-14 * np.abs(expected).max(axis=1, keepdims=True))
        assert np.array_equal(full(got) != 0, expected != 0)


@pytest.mark.parametrize("wall", ["printed", "isotropic"])
def test_wall_rows_hold_forty_digits(wall):
    with mpmath.workdps(45):
        mpf = mpmath.mpf
        chute = Chute(e=mpf("0.81"), e_w=mpf("0.77"), r=mpf("0.55"), tan_theta=mpf("0.3"), nu_max=mpf("0.63"), wall=wall)
        bg = background(chute, mpf("0.27"), mpf("0.9"), mpf("1.4"), mpf("0.3"), mpmath.pi)
        kx, ky = mpf("0.37"), mpf("0.21")
        for got, expected in zip(base_matrices(chute, bg, kx, ky, mpmath.pi), expected_matrices(chute, bg, kx, ky), strict=True):
            for (i, j), value in got.items():
                assert abs(value - expected[i, j]) <= mpf("1e-38") * (1 + max(abs(x) for x in expected[i]))
        W0, W1 = wall_rows(chute, bg, kx, ky, mpmath.pi)
        V0, V1 = rows_from(chute, bg, kx, ky)
        for got, expected in ((W0, V0), (W1, V1)):
            assert max(abs(x) for x in (got - expected).flat) <= mpf("1e-36")


def rows_from(chute, bg, kx, ky):
    """(V0, V1): Q X′ + R X in ψ, from the expected matrices; ŵ′ by mass conservation, −K0* ν̂′ + K0 T̂′ = −β̂."""
    Q, R = expected_matrices(chute, bg, kx, ky)
    nu, ell, advect = bg.nu[0], bg.decay[0], 1j * kx * bg.u[0]
    V0, V1 = Q[:, :1] * np.zeros((4, 8), dtype=int), Q[:, :1] * np.zeros((4, 8), dtype=int)
    for i in range(4):
        V0[i, :5] = [R[i, 0] * nu, *R[i, 1:]]
        V0[i, 5], V0[i, 6] = Q[i, 1], Q[i, 2]
        V0[i, :4] = V0[i, :4] - Q[i, 3] * np.array([advect, 1j * kx, 1j * ky, ell])
        V1[i, 0] = -Q[i, 3]
    V0[3, 7] = -1 + 0 * nu
    return V0, V1


@pytest.mark.parametrize("chute", CHUTES, ids=name_of)
@pytest.mark.parametrize("state", STATES)
def test_wall_rows_in_psi(chute, state):
    bg = background(chute, *state, math.pi)
    kx, ky = 0.37, 0.21
    W = wall_rows(chute, bg, kx, ky, math.pi)
    V = [A.astype(complex) for A in rows_from(chute, bg, kx, ky)]
    scale = np.abs(V[0]).max(axis=1, keepdims=True)
    for got, expected in zip(W, V, strict=True):
        assert got.shape == (4, 8) and got.dtype == complex
        assert np.all(np.abs(got - expected) <= 3e-14 * scale)
    # σ enters through ŵ′ alone, in the rows of the shear and of the energy
    assert [tuple(place) for place in np.argwhere(W[1])] == [(1, 0), (3, 0)]


def test_boundary_functions_are_A15_A16_A18():
    for radial in law.RADIAL_DISTRIBUTIONS:
        for nu in (0.05, 0.3, 0.55):
            g0, _ = law.radial(nu, (law.RADIAL_DISTRIBUTIONS[radial], 0.62))
            A = 1 + math.pi / (12 * math.sqrt(2)) * (1 + 5 / (8 * nu * g0))
            assert law.wall_shear(nu, g0, math.pi) == pytest.approx(A, rel=1e-15, abs=0.0)
    for r in (0.0, 0.2, 0.6, 0.95):
        s = math.sqrt(1 - r * r)
        kappa = 2 / 3 * (2 / (1 + s) - s)
        assert law.slip_coefficient(r) == pytest.approx(kappa, rel=1e-14, abs=1e-15)
        assert law.wall_normal(1.7, r) == pytest.approx(1.7 * (r * r - 2) + kappa + 2 * s, rel=1e-15, abs=0.0)
        assert law.wall_dissipation(r, 0.7, math.pi) == pytest.approx(math.sqrt(2 / math.pi) * 0.6 / (1 + s), rel=1e-15, abs=0.0)
    # a smooth base bears no shear: κ = ½ r² + O(r⁴), without cancellation
    assert law.slip_coefficient(0.0) == 0.0
    for r in (1e-9, 1e-5):
        assert law.slip_coefficient(r) == pytest.approx(r * r / 2, rel=1e-9, abs=0.0)


# ------------------------------------------------------------------------------------------------ complex step
def nonlinear_wall(value, gradient, chute):
    """w, M_x − P_xz, M_y − P_yz, −(q_z + P_iz u_i + 𝒟) for (ν, u, v, w, T), (5,), and their gradients in (x, y, z), (5, 3)."""
    nu, T, V = value[0], value[4], value[1:4]
    names = ("g1", "g2", "g6", "g3", "g4", "A")
    g1, g2, g6, g3, g4, A = evaluator(chute.radial, names, 0, "numpy")(nu, chute.ep, chute.nu_max)
    p, eta, xi, K, K_star = g1 * T, g2 * T**0.5, g6 * T**0.5, g3 * T**0.5, g4 * T**1.5
    r, s = chute.r, math.sqrt(1 - chute.r**2)
    kappa = 2 / 3 * (2 / (1 + s) - s)
    B = A * (r * r - 2) + kappa + 2 * s
    delta = math.sqrt(2 / math.pi) * 2 * (1 - chute.e_w) / (1 + s)

    G = gradient[1:4]
    div = np.trace(G)
    P_z = -eta * (G[:, 2] + G[2, :]) + np.array([0, 0, p - xi * div + 2 * eta * div / 3])
    q_z = -K * gradient[4, 2] + K_star * gradient[0, 2]
    root = math.sqrt(2 / math.pi)
    S_x, S_y = (root * (-kappa * V[i] + (kappa - A * r * r / 2) * G[i, 2]) for i in (0, 1))
    spread = G[0, 0] + (G[1, 1] if chute.wall == "isotropic" else 0)
    S_z = root * (B * G[2, 2] - A * r * r / 2 * spread)
    chi = P_z[2] / (nu * T + nu * T**0.5 * S_z)
    M_x, M_y = nu * chi * T**0.5 * S_x, nu * chi * T**0.5 * S_y
    return np.array([V[2], M_x - P_z[0], M_y - P_z[1], -(q_z + P_z @ V + delta * nu * chi * T**1.5)])


@pytest.mark.parametrize("chute", CHUTES[:2], ids=name_of)
@pytest.mark.parametrize("far_temperature", [0.2, 2.54, 7.34])
def test_wall_rows_against_complex_step_of_the_nonlinear_conditions(chute, far_temperature):
    y = descend(chute, far_temperature).states_at(0.0).real
    bg = background(chute, math.exp(y[0]), y[1], y[2], y[3], math.pi)
    nu, ell, h = bg.nu[0], bg.decay[0], 1e-40
    base = np.array([nu, bg.u[0], 0, 0, bg.T[0]])
    slopes = np.zeros((5, 3))
    slopes[:, 2] = [bg.nu_z[0], bg.u_z[0], 0, 0, bg.T_z[0]]
    # the steady flow itself satisfies the nonlinear conditions
    size = bg.p[0] * max(1.0, bg.T[0] ** 0.5)
    assert np.all(np.abs(nonlinear_wall(base, slopes, chute)) <= 1e-12 * size)
    rng = np.random.default_rng(11)
    for _ in range(6):
        kx, ky = rng.uniform(0.05, 0.6, 2)
        sigma = complex(*rng.normal(size=2))
        psi = rng.normal(size=8) + 1j * rng.normal(size=8)
        psi[3] = 0  # ŵ = 0, the first row: ∂w/∂x = ∂w/∂y = 0 of (A 11) is used in the others
        w_z = -(sigma + 1j * kx * bg.u[0]) * psi[0] - 1j * kx * psi[1] - 1j * ky * psi[2] - ell * psi[3]
        n_z = nu * complex(*rng.normal(size=2))
        T_z = (bg.K_star[0] * n_z - psi[7]) / bg.K[0]
        X = np.array([nu * psi[0], *psi[1:5]])
        grad = np.column_stack((1j * kx * X, 1j * ky * X, [n_z, psi[5], psi[6], w_z, T_z]))
        real, imag = (
            nonlinear_wall(base + 1j * h * getattr(X, part), slopes + 1j * h * getattr(grad, part), chute).imag / h
            for part in ("real", "imag")
        )
        W0, W1 = wall_rows(chute, bg, kx, ky, math.pi)
        W = W0 + sigma * W1
        assert np.all(np.abs(W @ psi - (real + 1j * imag)) <= 1e-13 * (np.abs(W) @ np.abs(psi)))


def test_the_first_row_is_impenetrability():
    bg = background(CHUTES[0], *STATES[0], math.pi)
    W0, W1 = wall_rows(CHUTES[0], bg, 0.1, 0.2, math.pi)
    assert np.array_equal(W0[0], np.eye(8)[3]) and not W1[0].any()
    # the cross-slope row involves v̂ and v̂′ only: with k_y = 0 it separates from the rest
    assert set(np.flatnonzero(W0[2])) == {2, 6} and not W1[2].any()
    flat0, _ = wall_rows(CHUTES[0], bg, 0.1, 0.0, math.pi)
    assert not flat0[[0, 1, 3]][:, [2, 6]].any()
