"""The source of truth of the chute tests, in SymPy and from the page: the table of guide/theory.md 1.1, the equations (2.1)–(2.7), the wall
conditions (A 12)–(A 18), and their linearization about a steady flow in normal modes.

Nothing here is imported from shootstab. A `Wave` f0(z) + ε f1(z) exp(σt + i k_x x + i k_y y) carries the base and the first order
in ε through products, quotients and derivatives, so that the equations are written once, as they stand in the paper, and linearize
themselves.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from typing import Any

import sympy as sp

# ------------------------------------------------------------------------------------------------ the table of guide/theory.md 1.1
NU, EP, NU_MAX = sp.symbols("nu eta_p nu_m", positive=True)
RADIAL = {
    "lun-savage": (1 - NU / NU_MAX) ** (-sp.Rational(5, 2) * NU_MAX),
    "carnahan-starling": (2 - NU) / (2 * (1 - NU) ** 3),
}


@cache
def table(radial: str) -> dict[str, sp.Expr]:
    """g0 … g6 as the table prints them, functions of NU, EP, NU_MAX."""
    nu, ep, pi, g0 = NU, EP, sp.pi, RADIAL[radial]
    R = sp.Rational
    front = 25 * sp.sqrt(pi) / (16 * ep * (41 - 33 * ep) * g0)
    first = 1 + R(12, 5) * ep * nu * g0
    return {
        "g0": g0,
        "g1": nu * (1 + 4 * ep * nu * g0),
        "g2": (5 * sp.sqrt(pi) / 96)
        * (
            (1 + R(8, 5) * ep * nu * g0) * (1 + R(8, 5) * ep * (3 * ep - 2) * nu * g0) / (ep * (2 - ep) * g0)
            + 768 / (25 * pi) * ep * nu**2 * g0
        ),
        "g3": front * (first * (1 + R(12, 5) * ep**2 * (4 * ep - 3) * nu * g0) + 64 / (25 * pi) * (41 - 33 * ep) * (ep * nu * g0) ** 2),
        "g4": front * first * R(12, 5) * ep * (2 * ep - 1) * (1 - ep) * (2 * g0 + nu * sp.diff(g0, nu)),
        "g5": 48 / sp.sqrt(pi) * ep * (1 - ep) * nu**2 * g0,
        "g6": 8 / (3 * sp.sqrt(pi)) * ep * nu**2 * g0,
        "A": 1 + pi / (12 * sp.sqrt(2)) * (1 + 5 / (8 * nu * g0)),
    }


@cache
def evaluator(radial: str, names: tuple[str, ...], order: int, module: str) -> Any:
    """A function (ν, η_p, ν_m) → [order-th ν-derivatives of the named entries], for numpy or mpmath."""
    return sp.lambdify((NU, EP, NU_MAX), [sp.diff(table(radial)[name], NU, order) for name in names], module, cse=True)


# ------------------------------------------------------------------------------------------------ normal modes
z = sp.Symbol("z")
KX, KY, SIGMA, TAN = sp.symbols("k_x k_y sigma tan_theta")
TABLE_1 = ("a", "b", "c", "d", "e", "h", "e_star", "h_star", "l", "m")
BASE_NAMES = ("nu", "T", "u", "p", "eta", "xi", "K", "K_star", "gamma", "xi_nu", "xi_T", *TABLE_1)
BASE = {name: sp.Function(f"{name}0")(z) for name in BASE_NAMES}
MODE = {name: sp.Function(f"{name}1")(z) for name in ("nu", "u", "v", "w", "T")}


@dataclass(frozen=True)
class PlaneWave:
    """base + ε first exp(σt + i k_x x + i k_y y) + O(ε²)."""

    base: sp.Expr
    first: sp.Expr

    def __add__(self, other: Any) -> PlaneWave:
        other = as_wave(other)
        return PlaneWave(self.base + other.base, self.first + other.first)

    __radd__ = __add__

    def __neg__(self) -> PlaneWave:
        return PlaneWave(-self.base, -self.first)

    def __sub__(self, other: Any) -> PlaneWave:
        return self + (-as_wave(other))

    def __rsub__(self, other: Any) -> PlaneWave:
        return as_wave(other) - self

    def __mul__(self, other: Any) -> PlaneWave:
        other = as_wave(other)
        return PlaneWave(self.base * other.base, self.base * other.first + self.first * other.base)

    __rmul__ = __mul__

    def __truediv__(self, other: Any) -> PlaneWave:
        other = as_wave(other)
        return PlaneWave(self.base / other.base, (self.first * other.base - self.base * other.first) / other.base**2)

    def sqrt(self) -> PlaneWave:
        return PlaneWave(sp.sqrt(self.base), self.first / (2 * sp.sqrt(self.base)))

    def d(self, direction: str) -> PlaneWave:
        """∂/∂t, ∂/∂x, ∂/∂y or ∂/∂z."""
        if direction == "z":
            return PlaneWave(sp.diff(self.base, z), sp.diff(self.first, z))
        return PlaneWave(sp.Integer(0), {"t": SIGMA, "x": sp.I * KX, "y": sp.I * KY}[direction] * self.first)


def as_wave(x: Any) -> PlaneWave:
    return x if isinstance(x, PlaneWave) else PlaneWave(sp.sympify(x), sp.Integer(0))


def _of_nu_and_T(value: str, by_nu: str, by_T: str) -> PlaneWave:
    """F(ν, T) of (2.10): F0 + (∂F/∂ν) ν1 + (∂F/∂T) T1."""
    return PlaneWave(BASE[value], BASE[by_nu] * MODE["nu"] + BASE[by_T] * MODE["T"])


nu = PlaneWave(BASE["nu"], MODE["nu"])
T = PlaneWave(BASE["T"], MODE["T"])
velocity = (PlaneWave(BASE["u"], MODE["u"]), PlaneWave(sp.Integer(0), MODE["v"]), PlaneWave(sp.Integer(0), MODE["w"]))
p, eta, xi = _of_nu_and_T("p", "a", "b"), _of_nu_and_T("eta", "c", "d"), _of_nu_and_T("xi", "xi_nu", "xi_T")
K, K_star, gamma = _of_nu_and_T("K", "e", "h"), _of_nu_and_T("K_star", "e_star", "h_star"), _of_nu_and_T("gamma", "l", "m")
AXES = ("x", "y", "z")


def divergence() -> PlaneWave:
    return sum((velocity[i].d(AXES[i]) for i in range(3)), as_wave(0))


@cache
def pressure_tensor() -> tuple[tuple[PlaneWave, ...], ...]:
    """P of (2.4) with S of (2.6)."""
    div = divergence()

    def entry(i: int, j: int) -> PlaneWave:
        strain = sp.Rational(1, 2) * (velocity[i].d(AXES[j]) + velocity[j].d(AXES[i]))
        if i == j:
            return p - xi * div - 2 * eta * (strain - sp.Rational(1, 3) * div)
        return -2 * eta * strain

    return tuple(tuple(entry(i, j) for j in range(3)) for i in range(3))


def heat_flux(axis: str) -> PlaneWave:
    """q of (2.5)."""
    return -K * T.d(axis) + K_star * nu.d(axis)


def material(f: PlaneWave) -> PlaneWave:
    """D/Dt."""
    return sum((velocity[i] * f.d(AXES[i]) for i in range(3)), f.d("t"))


@cache
def residuals() -> tuple[PlaneWave, ...]:
    """(2.1), the components of (2.2), and (2.3), signed as the rows of (2.12): mass left minus right, the others right minus left."""
    P = pressure_tensor()
    gravity = (TAN, sp.Integer(0), sp.Integer(-1))
    mass = material(nu) + nu * divergence()
    momentum = [nu * gravity[i] - sum((P[i][j].d(AXES[j]) for j in range(3)), as_wave(0)) - nu * material(velocity[i]) for i in range(3)]
    work = sum((P[i][j] * velocity[i].d(AXES[j]) for i in range(3) for j in range(3)), as_wave(0))
    energy = -work - sum((heat_flux(a).d(a) for a in AXES), as_wave(0)) - gamma - sp.Rational(3, 2) * nu * material(T)
    return (mass, *momentum, energy)


# ------------------------------------------------------------------------------------------------ names for jets
def jet(name: str, order: int) -> sp.Symbol:
    """The symbol of the order-th z-derivative of a base function."""
    return sp.Symbol(name + "_" + "z" * order if order else name)


def flatten(expression: sp.Expr) -> sp.Expr:
    """Base functions of z and their derivatives replaced by the symbols of `jet`."""
    swaps = {sp.diff(f, z, order): jet(name, order) for order in (2, 1, 0) for name, f in BASE.items()}
    # highest derivatives first: f0(z) also stands inside Derivative(f0(z), z)
    for order in (2, 1, 0):
        expression = expression.subs({key: value for key, value in swaps.items() if _order(key) == order})
    return sp.expand(expression)


def _order(f: sp.Expr) -> int:
    return sum(count for _, count in f.variable_count) if isinstance(f, sp.Derivative) else 0


@cache
def matrices_of_2_12() -> tuple[sp.Matrix, sp.Matrix, sp.Matrix, sp.Matrix]:
    """L, M, N, Σ of (2.12), read off from the linearized residuals."""
    fields = [MODE[name] for name in ("nu", "u", "v", "w", "T")]
    marks = [[sp.Symbol(f"X{j}_{order}") for j in range(5)] for order in range(3)]
    L, M, N, Sigma = (sp.zeros(5, 5) for _ in range(4))
    for i, residual in enumerate(residuals()):
        row = sp.expand(residual.first.doit())
        for order in (2, 1, 0):
            row = row.subs({sp.diff(f, z, order): marks[order][j] for j, f in enumerate(fields)})
        row = flatten(row)
        for j in range(5):
            L[i, j], M[i, j], whole = (row.coeff(marks[order][j]) for order in (2, 1, 0))
            Sigma[i, j] = -sp.expand(whole).coeff(SIGMA, 1)
            N[i, j] = sp.expand(whole).coeff(SIGMA, 0)
        rest = sp.expand(row - sum(A[i, j] * marks[o][j] for j in range(5) for o, A in ((2, L), (1, M), (0, N - SIGMA * Sigma))))
        assert rest == 0, "the linearized equations are linear in X″, X′, X and affine in σ"
    return L, M, N, Sigma


def dz(expression: sp.Expr) -> sp.Expr:
    """d/dz of an expression in the symbols of `jet`."""
    total = sp.Integer(0)
    for name in BASE_NAMES:
        for order in (0, 1):
            total += sp.diff(expression, jet(name, order)) * jet(name, order + 1)
    return total


@cache
def first_order() -> tuple[sp.Matrix, sp.Matrix]:
    """C, D of (A 8) by doing to (2.12) what A.3 says in words.

    φ = (ν̂, û, v̂, ŵ, T̂, û′, v̂′, β̂). ŵ′ and ŵ″ by mass conservation and its derivative; K0 T̂″ − K0* ν̂″ by β̂′.
    """
    L, M, N, Sigma = matrices_of_2_12()
    N = N - SIGMA * Sigma
    n, u, v, w, _, u_z, v_z, beta = phi = sp.symbols("phi1:9")
    dn, _, _, _, dt, du_z, dv_z, dbeta = dphi = sp.symbols("dphi1:9")
    w_z = -(N[0, 0] * n + N[0, 1] * u + N[0, 2] * v + N[0, 3] * w) / M[0, 3]
    # the derivative of ŵ′ = Σ s_j X_j, with ŵ′ replaced once more
    slopes = [-N[0, j] / M[0, 3] for j in range(4)]
    w_zz = sum(dz(s) * x + s * x_z for s, x, x_z in zip(slopes, (n, u, v, w), (dn, u_z, v_z, w_z), strict=True))
    K_, K_s = jet("K", 0), jet("K_star", 0)
    beta_z_part = -dbeta - dz(K_) * dt + dz(K_s) * dn  # K T″ − K* ν″ with β = −K T′ + K* ν′
    assert L[4, 0] == -K_s and L[4, 4] == K_
    X_z = (dn, u_z, v_z, w_z, dt)
    X_zz = (0, du_z, dv_z, w_zz, 0)
    rows = [M[0, 3] * dphi[3] + N[0, 0] * n + N[0, 1] * u + N[0, 2] * v + N[0, 3] * w]
    second = [sum(L[i, j] * X_zz[j] for j in range(5)) for i in (1, 2, 3)] + [beta_z_part]
    rows += [second[i - 1] + sum(M[i, j] * X_z[j] + N[i, j] * phi[j] for j in range(5)) for i in (1, 2, 3, 4)]
    rows += [dphi[1] - u_z, dphi[2] - v_z, -K_ * dt + K_s * dn - beta]
    C = sp.Matrix(8, 8, lambda i, j: sp.diff(rows[i], dphi[j]))
    D = sp.Matrix(8, 8, lambda i, j: -sp.diff(rows[i], phi[j]))
    return C.applyfunc(sp.expand), D.applyfunc(sp.expand)


# ------------------------------------------------------------------------------------------------ the wall
A0, A0_NU, B0, KAPPA, DELTA, ROUGHNESS = sp.symbols("A0 A0_nu B0 kappa Delta r", positive=True)


@cache
def wall_matrices(isotropic: bool) -> tuple[sp.Matrix, sp.Matrix]:
    """Q, R of (A 26) from (A 12)–(A 18) with χ from (A 22), in the symbols of `jet`; columns (ν̂, û, v̂, ŵ, T̂).

    Rows as the paper signs them: w, M_x − P_xz, M_y − P_yz, −(q_z + P_iz u_i + 𝒟). The column of R that multiplies ŵ = 0 holds nothing
    that counts below the first row and is left empty there.
    """
    root = sp.sqrt(2 / sp.pi)
    A = PlaneWave(A0, A0_NU * MODE["nu"])
    B = PlaneWave(B0, sp.Integer(0))  # B1 multiplies ∂w/∂z, itself of first order
    slip_shear = KAPPA - sp.Rational(1, 2) * ROUGHNESS**2 * A
    S_x = root * (-KAPPA * velocity[0] + slip_shear * velocity[0].d("z"))
    S_y = root * (-KAPPA * velocity[1] + slip_shear * velocity[1].d("z"))
    spread = velocity[0].d("x") + (velocity[1].d("y") if isotropic else as_wave(0))
    S_z = root * (B * velocity[2].d("z") - sp.Rational(1, 2) * ROUGHNESS**2 * A * spread)
    P, s = pressure_tensor(), T.sqrt()
    chi = P[2][2] / (nu * T + nu * s * S_z)
    loss = DELTA * nu * chi * T * s
    rows = (
        velocity[2],
        nu * chi * s * S_x - P[0][2],
        nu * chi * s * S_y - P[1][2],
        -(heat_flux("z") + sum((P[i][2] * velocity[i] for i in range(3)), as_wave(0)) + loss),
    )
    fields = [MODE[name] for name in ("nu", "u", "v", "w", "T")]
    Q, R = sp.zeros(4, 5), sp.zeros(4, 5)
    for i, row in enumerate(rows):
        first = sp.expand(row.first.doit())
        for j, f in enumerate(fields):
            Q[i, j] = flatten(first.coeff(sp.diff(f, z)))
            R[i, j] = flatten(first.subs(sp.diff(f, z), 0).coeff(f)) if i == 0 or j != 3 else 0
    return Q, R
