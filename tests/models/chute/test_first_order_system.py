"""C ψ′ = D ψ is the linearization of (2.1)–(2.7): proved symbolically, against the paper's tables with their errata, and numerically."""

from __future__ import annotations

import math
from functools import cache

import mpmath
import numpy as np
import pytest
import sympy as sp
from linearization import (
    EP,
    KX,
    KY,
    NU,
    NU_MAX,
    SIGMA,
    TABLE_1,
    TAN,
    dz,
    evaluator,
    first_order,
    jet,
    matrices_of_2_12,
    table,
)
from paper_tables import ERRATA, paper_first_order, paper_matrices, to_psi

from shootstab.core.series import Series
from shootstab.models.chute.background import Background, background
from shootstab.models.chute.first_order_system import SIZE, continuum, pencil_entries
from shootstab.models.chute.parameters import Chute
from shootstab.models.chute.steady_flow import descend
from shootstab.models.chute.tabulated import as_background, tabulated

PAPER = Chute(e=0.8, e_w=0.8, r=0.6, tan_theta=0.3)
CHUTES = [PAPER, Chute(e=0.93, e_w=0.7, r=0.4, tan_theta=0.41), Chute(e=0.7, e_w=0.9, r=0.5, tan_theta=0.35, radial="carnahan-starling")]
STATES = [(0.31, 0.7, 1.9, -0.4), (0.04, 6.3, 4.1, 2.2), (3e-7, 7.4, 12.0, 1e-5), (0.52, 0.05, 0.6, 0.9)]  # ν, T, u, Q, any

n, n_z, n_zz = (jet("nu", order) for order in range(3))


# ------------------------------------------------------------------------------------------------ symbolic background
@cache
def symbolic_background() -> Background:
    """Every jet a symbol of its own: no chain rule and no steady equation is used."""

    def pair(name: str, order: int = 0) -> Series:
        return Series((jet(name, order), jet(name, order + 1)))

    plain = ("nu", "T", "u", "p", "eta", "xi", "K", "K_star", *TABLE_1)
    return Background(
        **{name: pair(name) for name in plain},
        decay=Series((n_z / n, n_zz / n - n_z**2 / n**2)),
        nu_z=pair("nu", 1),
        T_z=pair("T", 1),
        u_z=pair("u", 1),
    )


def exact(expression: object) -> sp.Expr:
    """1j brings the float 1.0 into SymPy; it is a whole number, so this is exact."""
    return sp.expand(sp.nsimplify(sp.sympify(expression), rational=True))


@cache
def symbolic_pencil() -> tuple[sp.Matrix, sp.Matrix, sp.Matrix, sp.Matrix]:
    matrices = []
    for entries in pencil_entries(symbolic_background(), TAN, KX, KY):
        A = sp.zeros(SIZE, SIZE)
        for place, value in entries.items():
            A[place] = exact(value)
        matrices.append(A)
    return tuple(matrices)


def unequal(A: sp.Matrix, B: sp.Matrix) -> set[tuple[int, int]]:
    """Places, counted from 1, where two matrices differ as expressions."""
    rows, columns = A.shape
    return {(i + 1, j + 1) for i in range(rows) for j in range(columns) if sp.expand(A[i, j] - B[i, j]) != 0}


def test_pencil_is_the_linearization_of_the_governing_equations():
    C, D = to_psi(*first_order())
    C0, C1, D0, D1 = symbolic_pencil()
    assert unequal(C0 + SIGMA * C1, C) == set()
    assert unequal(D0 + SIGMA * D1, D) == set()


def test_pencil_entries_do_not_contain_sigma_and_list_every_nonzero_entry_once():
    for A, entries in zip(symbolic_pencil(), pencil_entries(symbolic_background(), TAN, KX, KY), strict=True):
        assert not A.has(SIGMA)
        assert {place for place in entries if A[place] == 0} == set()


def test_steady_equations_are_the_zeroth_order_of_the_governing_equations():
    """(2.2), (2.3) at order ε⁰: tanθ ν + (η u′)′, −ν − p′ and η u′² − q′ − γ, which guide/theory.md 1.2 integrates."""
    from linearization import flatten, residuals

    mass, x, y, z, energy = (flatten(r.base.doit()) for r in residuals())
    eta, u_z, K, K_star = jet("eta", 0), jet("u", 1), jet("K", 0), jet("K_star", 0)
    heat = -K * jet("T", 1) + K_star * n_z
    assert mass == 0 and y == 0
    assert sp.expand(x - (TAN * n + dz(eta * u_z))) == 0
    assert sp.expand(z - (-n - dz(jet("p", 0)))) == 0
    assert sp.expand(energy - (eta * u_z**2 - dz(heat) - jet("gamma", 0))) == 0


# ------------------------------------------------------------------------------------------------ the paper's tables
def test_matrices_of_A2_with_their_errata():
    for ours, theirs in zip(matrices_of_2_12(), paper_matrices(), strict=True):
        assert unequal(ours, theirs) == set()


def test_A2_as_printed_is_wrong_at_N21_and_N35_and_nowhere_else():
    printed = paper_matrices(frozenset({"N21", "N35"}))
    wrong = [unequal(ours, theirs) for ours, theirs in zip(matrices_of_2_12(), printed, strict=True)]
    assert wrong == [set(), set(), {(2, 1), (3, 5)}, set()]


def test_first_order_system_of_A3_with_its_errata():
    C, D = paper_first_order()
    mine, yours = first_order()
    assert unequal(C, mine) == set()
    assert unequal(D, yours) == set()


def test_A3_as_printed_is_wrong_at_the_errata_and_nowhere_else():
    C, D = paper_first_order(ERRATA - {"N21", "N35", "(A 7)"})
    mine, yours = first_order()
    assert unequal(C, mine) == {(5, 1), (5, 5), (5, 8), (6, 2), (7, 3)}
    assert unequal(D, yours) == {(2, 6), (2, 7), (4, 4)}


def test_pencil_is_A3_of_the_paper():
    C, D = to_psi(*paper_first_order())
    C0, C1, D0, D1 = symbolic_pencil()
    assert unequal(C0 + SIGMA * C1, C) == set()
    assert unequal(D0 + SIGMA * D1, D) == set()


def test_determinant_is_A9_and_vanishes_on_the_continuous_spectrum():
    C0, C1, _, _ = symbolic_pencil()
    eta, xi, K, K_star, a, b, u = (jet(name, 0) for name in ("eta", "xi", "K", "K_star", "a", "b", "u"))
    viscous = xi + sp.Rational(4, 3) * eta
    # the first row is divided by ν0, the first column multiplied by it: the determinant of (A 9) itself
    det_A9 = -(eta**2) * (K * viscous * (SIGMA + sp.I * KX * u) + a * n * K + b * n * K_star)
    det = sp.expand((C0 + SIGMA * C1).det(method="berkowitz"))
    assert sp.expand(det - det_A9) == 0
    sigma_c = exact(continuum(symbolic_background(), KX)[0])
    assert sp.simplify(det.subs(SIGMA, sigma_c)) == 0
    assert sp.simplify(sigma_c + n * (a * K + b * K_star) / (K * viscous) + sp.I * KX * u) == 0


# ------------------------------------------------------------------------------------------------ the jets of background()
@cache
def steady_jets(radial: str):
    """Every field of Background and its z-derivative, from the table and the steady equations, by SymPy: a function of numbers.

    T′ and ν′ solve p_ν ν′ + p_T T′ = −ν, −K T′ + K* ν′ = νQ; d/dz of anything is ν′∂_ν + T′∂_T + u′∂_u + Q′∂_Q.
    """
    T, u, Q = sp.symbols("T u Q", positive=True)
    tan = sp.Symbol("tan_theta", positive=True)
    g = table(radial)
    p, eta, xi, K, K_star = g["g1"] * T, g["g2"] * sp.sqrt(T), g["g6"] * sp.sqrt(T), g["g3"] * sp.sqrt(T), g["g4"] * T ** sp.Rational(3, 2)
    gamma = g["g5"] * T ** sp.Rational(3, 2)
    p_nu, p_T = sp.diff(p, NU), sp.diff(p, T)
    det = p_nu * K + p_T * K_star
    nu_z, T_z = (p_T * NU * Q - K * NU) / det, -(p_nu * NU * Q + K_star * NU) / det
    u_z = tan * p / eta
    Q_z = (tan**2 * p**2 / eta - gamma) / NU - Q * nu_z / NU

    def d(f: sp.Expr) -> sp.Expr:
        return sp.diff(f, NU) * nu_z + sp.diff(f, T) * T_z + sp.diff(f, u) * u_z + sp.diff(f, Q) * Q_z

    fields = {
        "nu": NU, "T": T, "u": u, "decay": nu_z / NU, "nu_z": nu_z, "T_z": T_z, "u_z": u_z,
        "p": p, "eta": eta, "xi": xi, "K": K, "K_star": K_star,
        "a": sp.diff(p, NU), "b": sp.diff(p, T), "c": sp.diff(eta, NU), "d": sp.diff(eta, T),
        "e": sp.diff(K, NU), "h": sp.diff(K, T), "e_star": sp.diff(K_star, NU), "h_star": sp.diff(K_star, T),
        "l": sp.diff(gamma, NU), "m": sp.diff(gamma, T),
    }  # fmt: skip
    arguments = (NU, T, u, Q, EP, tan, NU_MAX)
    expressions = [(f, d(f)) for f in fields.values()]
    return tuple(fields), sp.lambdify(arguments, expressions, "mpmath", cse=True)


@pytest.mark.parametrize("chute", CHUTES, ids=lambda c: f"{c.radial}-{c.e}")
@pytest.mark.parametrize("state", STATES)
def test_background_jets_follow_from_the_steady_equations(chute, state):
    names, jets = steady_jets(chute.radial)
    with mpmath.workdps(30):
        expected = jets(*(mpmath.mpf(x) for x in (*state, chute.ep, chute.tan_theta, chute.nu_max)))
    bg = background(chute, *state, math.pi)
    scale_z = max(abs(bg.decay[0]), 1 / state[1])
    for name, (value, slope) in zip(names, expected, strict=True):
        got = getattr(bg, name)
        assert got[0] == pytest.approx(float(value), rel=1e-12, abs=1e-14 * abs(float(value))), name
        # a derivative may cancel: it is held against value/length
        assert abs(got[1] - float(slope)) <= 2e-12 * (abs(float(slope)) + abs(float(value)) * scale_z), name


@pytest.mark.parametrize("radial", ["lun-savage", "carnahan-starling"])
def test_background_holds_forty_digits(radial):
    """No double constant stands in the formulas: with mpmath parameters everything is right to 1e−35."""
    names, jets = steady_jets(radial)
    with mpmath.workdps(45):
        mpf = mpmath.mpf
        chute = Chute(e=mpf("0.83"), e_w=mpf("0.8"), r=mpf("0.6"), tan_theta=mpf("0.31"), nu_max=mpf("0.63"), radial=radial)
        state = tuple(mpf(x) for x in ("0.23", "1.7", "2.9", "-0.37"))
        expected = jets(*state, chute.ep, chute.tan_theta, chute.nu_max)
        bg = background(chute, *state, mpmath.pi)
        for name, (value, slope) in zip(names, expected, strict=True):
            got = getattr(bg, name)
            assert abs(got[0] - value) <= mpf("1e-38") * (1 + abs(value)), name
            assert abs(got[1] - slope) <= mpf("1e-35") * (1 + abs(slope)), name
        kx, ky = mpf("0.013"), mpf("0.017")
        for precise, double in zip(pencil_entries(bg, chute.tan_theta, kx, ky), _double_pencil(chute, state, kx, ky), strict=True):
            for place, value in precise.items():
                assert isinstance(value, mpf | mpmath.mpc)
                assert complex(value) == pytest.approx(complex(double[place]), rel=1e-11, abs=1e-13)


def _double_pencil(chute, state, kx, ky):
    parameters = {name: float(getattr(chute, name)) for name in ("e", "e_w", "r", "tan_theta", "nu_max")}
    bg = background(Chute(**parameters, radial=chute.radial), *map(float, state), math.pi)
    return pencil_entries(bg, float(chute.tan_theta), float(kx), float(ky))


def test_background_of_arrays_is_the_background_of_each_point():
    columns = [np.array(c) for c in zip(*STATES, strict=True)]
    whole = background(PAPER, *columns, math.pi)
    kx, ky = 0.02, 0.03
    stacked = pencil_entries(whole, PAPER.tan_theta, kx, ky)
    for i, state in enumerate(STATES):
        single = pencil_entries(background(PAPER, *state, math.pi), PAPER.tan_theta, kx, ky)
        for entries, point in zip(stacked, single, strict=True):
            assert entries.keys() == point.keys()
            for place, value in entries.items():
                assert np.shape(value) == (len(STATES),)
                assert complex(value[i]) == pytest.approx(complex(point[place]), rel=1e-13, abs=1e-300)


@pytest.mark.parametrize("chute", CHUTES, ids=lambda c: f"{c.radial}-{c.e}")
@pytest.mark.parametrize("turn", [0.0, 0.1])
def test_tabulated_background_is_the_background_of_each_point(chute, turn):
    """Recorded programs of the formulas give what the formulas do, with derivatives and without, in real numbers for real states."""
    states = np.array([[math.log(nu), T, u, Q, 0.0, 0.0] for nu, T, u, Q in STATES]) * (1 + turn * 1j)
    whole, plain = as_background(tabulated(chute, states)), as_background(tabulated(chute, states, derivatives=False), derivatives=False)
    for i, (log_nu, *state, _, _) in enumerate(states):
        exact = background(chute, np.exp(log_nu), *state, math.pi)
        for name in Background.__dataclass_fields__:
            got, want = getattr(whole, name), getattr(exact, name)
            assert np.iscomplexobj(got[0]) == (turn != 0.0)
            assert complex(got[0][i]) == pytest.approx(complex(want[0]), rel=2e-14, abs=0.0), name
            assert abs(got[1][i] - want[1]) <= 1e-13 * (abs(want[1]) + abs(want[0] * exact.decay[0])), name
            assert complex(getattr(plain, name)[0][i]) == pytest.approx(complex(want[0]), rel=2e-14, abs=0.0), name


def test_background_of_series_is_differentiated_by_them():
    """Coefficients that are series in z: their first-order part is the z-derivative of every entry, by a second route."""
    state = (0.21, 1.3, 2.0, 0.3)
    bg = background(PAPER, *state, math.pi)
    Q_z = _q_slope(state)
    along = [Series((s, d)) for s, d in zip(state, (bg.nu_z[0], bg.T_z[0], bg.u_z[0], Q_z), strict=True)]
    nested = background(PAPER, *along, math.pi)
    for name in Background.__dataclass_fields__:
        inner = getattr(nested, name)
        assert inner[0][0] == pytest.approx(getattr(bg, name)[0], rel=1e-13, abs=0.0)
        assert inner[0][1] == pytest.approx(getattr(bg, name)[1], rel=1e-10, abs=1e-13), name


def _q_slope(state):
    _, jets = steady_jets("lun-savage")
    nu, T, _, Q = state
    g5, g2, g1 = evaluator("lun-savage", ("g5", "g2", "g1"), 0, "numpy")(nu, PAPER.ep, PAPER.nu_max)
    decay = float(jets(*map(mpmath.mpf, (*state, PAPER.ep, PAPER.tan_theta, PAPER.nu_max)))[3][0])
    return (PAPER.tan_theta**2 * g1**2 / g2 - g5) * T**1.5 / nu - Q * decay


# ------------------------------------------------------------------------------------------------ complex-step linearization
NAMES = ("g1", "g2", "g6", "g3", "g4", "g5")
POWERS = (1.0, 0.5, 0.5, 0.5, 1.5, 1.5)  # of T in p, η, ξ, K, K*, γ


class JetOfSymbols:
    """ν, u, v, w, T at one point, (5,), with first, (5, 4), and second, (5, 4, 4), derivatives with respect to (t, x, y, z)."""

    def __init__(self, value, first, second):
        self.value, self.first, self.second = value, first, second

    def moved(self, other: JetOfSymbols, h: complex) -> JetOfSymbols:
        return JetOfSymbols(self.value + h * other.value, self.first + h * other.first, self.second + h * other.second)

    def part(self, which: str) -> JetOfSymbols:
        return JetOfSymbols(*(np.array(getattr(a, which)) for a in (self.value, self.first, self.second)))


def nonlinear_residual(jet_: JetOfSymbols, chute: Chute) -> np.ndarray:
    """(2.1), (2.2), (2.3) at a point, all derivatives of fluxes taken by the chain rule; signs as in (2.12)."""
    nu, T, V = jet_.value[0], jet_.value[4], jet_.value[1:4]
    grad_nu, grad_T = jet_.first[0, 1:], jet_.first[4, 1:]
    G = jet_.first[1:4, 1:]  # G[i, j] = ∂_j V_i
    H = jet_.second[1:4, 1:, 1:]
    values = evaluator(chute.radial, NAMES, 0, "numpy")(nu, chute.ep, chute.nu_max)
    slopes = evaluator(chute.radial, NAMES, 1, "numpy")(nu, chute.ep, chute.nu_max)
    F = [g * T**s for g, s in zip(values, POWERS, strict=True)]
    grads = [dg * T**s * grad_nu + g * s * T ** (s - 1) * grad_T for g, dg, s in zip(values, slopes, POWERS, strict=True)]
    p, eta, xi, K, K_star, gamma = F
    grad_p, grad_eta, grad_xi, grad_K, grad_Ks, _ = grads
    div, grad_div = np.trace(G), np.einsum("iij->j", H)
    S = (G + G.T) / 2 - div / 3 * np.eye(3)
    div_S = (np.einsum("ijj->i", H) + grad_div) / 2 - grad_div / 3
    div_P = grad_p - grad_xi * div - xi * grad_div - 2 * S @ grad_eta - 2 * eta * div_S
    P = (p - xi * div) * np.eye(3) - 2 * eta * S
    laplace_nu, laplace_T = np.trace(jet_.second[0, 1:, 1:]), np.trace(jet_.second[4, 1:, 1:])
    div_q = -grad_K @ grad_T - K * laplace_T + grad_Ks @ grad_nu + K_star * laplace_nu
    rate = jet_.first[:, 0] + jet_.first[:, 1:] @ V
    gravity = np.array([chute.tan_theta, 0.0, -1.0])
    energy = -np.sum(P * G) - div_q - gamma - 1.5 * nu * rate[4]
    return np.concatenate(([rate[0] + nu * div], nu * gravity - div_P - nu * rate[1:4], [energy]))


def linear_residual(base: JetOfSymbols, mode: JetOfSymbols, chute: Chute) -> np.ndarray:
    """d/dε of the residual at base + ε mode: two complex steps, for the real and for the imaginary part of the mode."""
    h = 1e-40
    real, imag = (nonlinear_residual(base.moved(mode.part(which), 1j * h), chute).imag / h for which in ("real", "imag"))
    return real + 1j * imag


def base_jet(bg: Background) -> JetOfSymbols:
    value, first, second = np.zeros(5), np.zeros((5, 4)), np.zeros((5, 4, 4))
    for i, (f, f_z) in zip((0, 1, 4), ((bg.nu, bg.nu_z), (bg.u, bg.u_z), (bg.T, bg.T_z)), strict=True):
        value[i], first[i, 3], second[i, 3, 3] = f[0], f_z[0], f_z[1]
    return JetOfSymbols(value, first, second)


def mode_jet(fields, slopes, curvatures, sigma, kx, ky) -> JetOfSymbols:
    """Of X(z) exp(σt + i k_x x + i k_y y) with X, X′, X″ given, at t = x = y = 0."""
    s = np.array([sigma, 1j * kx, 1j * ky])
    first, second = np.zeros((5, 4), complex), np.zeros((5, 4, 4), complex)
    first[:, :3], first[:, 3] = np.outer(fields, s), slopes
    second[:, :3, :3] = np.einsum("i,j,k->ijk", fields, s, s)
    second[:, :3, 3] = second[:, 3, :3] = np.outer(slopes, s)
    second[:, 3, 3] = curvatures
    return JetOfSymbols(fields, first, second)


def dense(entries, index=()):
    A = np.zeros((SIZE, SIZE), complex)
    for place, value in entries.items():
        A[place] = value[index] if index != () else value
    return A


@pytest.mark.parametrize("far_temperature", [0.2, 2.54, 7.34])
def test_pencil_against_complex_step_of_the_nonlinear_equations(far_temperature):
    flow = descend(PAPER, far_temperature)
    rng = np.random.default_rng(7)
    seen = set()
    for z in flow.nodes[0] * np.array([0.0, 0.01, 0.05, 0.2, 0.6]):
        y = flow.states_at(z).real
        bg = background(PAPER, math.exp(y[0]), y[1], y[2], y[3], math.pi)
        base = base_jet(bg)
        nu, u = bg.nu[0], bg.u[0]
        # the background itself obeys the nonlinear equations
        steady = nonlinear_residual(base, PAPER)
        assert np.all(np.abs(steady) <= 1e-12 * np.array([nu, nu, nu, nu, nu * bg.T[0] ** 0.5]))
        for _ in range(4):
            kx, ky = rng.uniform(0.01, 0.5, 2)
            sigma = complex(*rng.normal(size=2))
            psi, psi_z = (rng.normal(size=8) + 1j * rng.normal(size=8) for _ in range(2))
            # rows 1, 6, 7 and 8 are definitions of ŵ′, û′, v̂′ and β̂
            advect, ell = sigma + 1j * kx * u, bg.decay[0]
            psi_z[1], psi_z[2] = psi[5], psi[6]
            psi_z[3] = -advect * psi[0] - 1j * kx * psi[1] - 1j * ky * psi[2] - ell * psi[3]
            n_hat, n_hat_z = nu * psi[0], nu * psi_z[0] + bg.nu_z[0] * psi[0]
            psi[7] = -bg.K[0] * psi_z[4] + bg.K_star[0] * n_hat_z
            w_zz = (
                -advect * psi_z[0]
                - 1j * kx * bg.u_z[0] * psi[0]
                - 1j * kx * psi_z[1]
                - 1j * ky * psi_z[2]
                - ell * psi_z[3]
                - bg.decay[1] * psi[3]
            )
            # β̂′ fixes K0 T̂″ − K0* ν̂″; ν̂″ alone is free
            n_zz_hat = nu * complex(*rng.normal(size=2))
            T_zz = (-psi_z[7] - bg.K[1] * psi_z[4] + bg.K_star[1] * n_hat_z + bg.K_star[0] * n_zz_hat) / bg.K[0]
            mode = mode_jet(
                np.array([n_hat, *psi[1:5]]),
                np.array([n_hat_z, *psi_z[1:5]]),
                np.array([n_zz_hat, psi_z[5], psi_z[6], w_zz, T_zz]),
                sigma, kx, ky,
            )  # fmt: skip
            expected = linear_residual(base, mode, PAPER)
            C0, C1, D0, D1 = (dense(entries) for entries in pencil_entries(bg, PAPER.tan_theta, kx, ky))
            C, D = C0 + sigma * C1, D0 + sigma * D1
            got = C @ psi_z - D @ psi
            scale = np.abs(C) @ np.abs(psi_z) + np.abs(D) @ np.abs(psi)
            assert np.all(np.abs(got[[5, 6, 7]]) <= 1e-14 * scale[[5, 6, 7]])
            assert np.all(np.abs(got[:5] - expected / np.array([nu, 1, 1, 1, 1])) <= 2e-12 * scale[:5])
            seen |= {tuple(place) for place in np.argwhere(np.abs(D) > 0)}
    # every entry that the symbolic linearization has was in play
    assert seen == {(i, j) for i in range(8) for j in range(8) if symbolic_pencil()[2][i, j] != 0 or symbolic_pencil()[3][i, j] != 0}


def test_nothing_underflows_and_infinity_is_regular():
    """C⁻¹D has a limit for ν0 → 0, approached as O(ν0); at ν0 = 1e−200 it is that limit, with no digit lost."""
    sigma, kx, ky = 0.004 + 0.01j, 0.01, 0.02

    def propagator(nu: float) -> np.ndarray:
        bg = background(PAPER, nu, 7.3, 12.0, 1e-3 * nu, math.pi)
        C0, C1, D0, D1 = (dense(entries) for entries in pencil_entries(bg, PAPER.tan_theta, kx, ky))
        return np.linalg.solve(C0 + sigma * C1, D0 + sigma * D1)

    limit = propagator(1e-200)
    assert np.all(np.isfinite(limit))
    assert limit[0, 0] == pytest.approx(-1 / 7.3, rel=1e-13, abs=0.0)
    far = [np.abs(propagator(nu) - limit).max() for nu in (1e-7, 1e-8, 1e-9)]
    assert far[0] / far[1] == pytest.approx(10, rel=1e-2, abs=0.0)
    assert far[1] / far[2] == pytest.approx(10, rel=1e-2, abs=0.0)
