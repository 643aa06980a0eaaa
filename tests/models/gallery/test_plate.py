"""models/gallery/plate*.py: the similarity solution, Mack's 8×8 system against a symbolic derivation, and Malik's cases."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import sympy as sp

import shootstab as st
from shootstab.core.errors import InputError
from shootstab.models.gallery.plate import MACK, STOKES, malik_3, malik_6, plate_temporal, stagnation
from shootstab.models.gallery.plate_flow import Gas, PlateFlow, plate_flow
from shootstab.models.gallery.plate_system import background, system
from shootstab.models.gallery.profiles import Piecewise

GAS = Gas(2.5, 148.0)
NAMES = ("u", "v", "w", "p", "theta")


# the flow


def test_without_mach_number_it_is_blasius() -> None:
    flow = plate_flow(Gas(1e-6, 300.0))
    assert flow.wall[0] == pytest.approx(1.0, abs=1e-11)
    assert flow.wall[1] == pytest.approx(0.332057336215196, abs=1e-13)


@pytest.mark.parametrize("gas", [GAS, Gas(4.5, 121.0), Gas(2.5, 148.0, wall=1.2), Gas(6.0, 60.0)], ids=["2.5", "4.5", "cold", "6"])
def test_the_flow_solves_its_equations(gas: Gas) -> None:
    """μU′ and so on against differences of the state; and integrals of the equations over the whole layer."""
    flow = plate_flow(gas)
    y = np.linspace(0.3, 0.9 * flow.end, 40).astype(complex)
    h = 1e-3
    difference = (flow.at(y - 2 * h) - 8 * flow.at(y - h) + 8 * flow.at(y + h) - flow.at(y + 2 * h)) / (12 * h)
    bg = background(flow, y)
    np.testing.assert_allclose(difference[1], bg["U_y"], atol=1e-11)
    np.testing.assert_allclose(difference[3], bg["T_y"], atol=1e-10)
    second = (flow.at(y + h) - 2 * flow.at(y) + flow.at(y - h)) / h**2
    np.testing.assert_allclose(second[1], bg["U_yy"], atol=1e-6)
    np.testing.assert_allclose(second[3], bg["T_yy"], atol=1e-5)
    # momentum: the wall shear is half the flux that the layer lacks, S(0) = ½∫U(1−U)/T dy
    x, w = np.polynomial.legendre.leggauss(400)
    at = 0.5 * flow.end * (x + 1)
    _, U, _, T, _ = flow.at(at.astype(complex)).real
    assert flow.wall[1] == pytest.approx(0.25 * flow.end * np.sum(w * U * (1 - U) / T), rel=1e-12)
    if gas.wall is None:  # energy: no heat goes through the wall, ∫U(T0 − T0∞)/T dy = 0
        total = T + 0.5 * (gas.gamma - 1) * gas.mach**2 * U**2
        assert np.sum(w * U * (total - total[-1]) / T) == pytest.approx(0.0, abs=1e-11)
    else:
        assert flow.wall[0] == pytest.approx(gas.wall, abs=1e-13)


@pytest.mark.parametrize("pieces", range(1, 60))
def test_beyond_its_last_piece_a_flow_is_its_limit(pieces: int) -> None:
    """N h/h is below N for some N and h in doubles: the end was then taken for a point of the last piece."""
    h = 0.7151617008005242
    far = h * pieces * np.array([1.0, 1.0 + 1e-12, 1.5, 4.0, np.inf]) + 0j
    assert (Piecewise(h, np.ones((pieces, 3)), 7.0)(far) == 7.0).all()
    flow = PlateFlow(Gas(2.5, 148.0), h, np.ones((pieces, 4, 5)))
    assert (flow.at(far) == np.array([0.0, 1.0, 0.0, 1.0, 0.0])[:, None]).all()


def test_no_such_flow() -> None:
    with pytest.raises(InputError, match="mach = -1"):
        Gas(-1.0, 300.0)
    with pytest.raises(InputError, match="gamma"):
        Gas(1.0, 300.0, gamma=0.9)


# the system


def navier_stokes(m: sp.Expr) -> tuple[list[sp.Expr], sp.Expr, dict[str, list[sp.Symbol]], dict[str, sp.Symbol]]:
    """The linearized equations from the compressible Navier–Stokes equations in tensor form, at one point.

    Residuals of mass, three momenta and energy, the y-derivative of the first, the Taylor coefficients of the disturbances in y, and
    parameters.
    """
    x, y, z, t, eps = sp.symbols("x y z t eps")
    par = {n: sp.Symbol(n) for n in ("alpha", "beta", "sigma", "R", "M", "gamma", "Pr", "s")}
    taylor = {n: list(sp.symbols(f"{n}0:3")) for n in NAMES}
    flow = {n: list(sp.symbols(f"{n}0:3")) for n in ("U", "T")}
    wave = sp.exp(sp.I * par["alpha"] * x + sp.I * par["beta"] * z + par["sigma"] * t)

    def series(c: list[sp.Symbol]) -> sp.Expr:
        return c[0] + c[1] * y + c[2] * y**2 / 2

    d = {n: eps * series(taylor[n]) * wave for n in NAMES}
    g = par["gamma"] * par["M"] ** 2
    velocity = [series(flow["U"]) + d["u"], d["v"], d["w"]]
    T, p = series(flow["T"]) + d["theta"], 1 / g + d["p"]
    rho, mu = g * p / T, T ** sp.Rational(3, 2) * (1 + par["s"]) / (T + par["s"])
    X = (x, y, z)
    divergence = sum(sp.diff(velocity[k], X[k]) for k in range(3))
    tau = [
        [mu * (sp.diff(velocity[i], X[j]) + sp.diff(velocity[j], X[i])) + (m * mu * divergence if i == j else 0) for j in range(3)]
        for i in range(3)
    ]

    def material(q: sp.Expr) -> sp.Expr:
        return sp.diff(q, t) + sum(velocity[k] * sp.diff(q, X[k]) for k in range(3))

    mass = sp.diff(rho, t) + sum(sp.diff(rho * velocity[k], X[k]) for k in range(3))
    momenta = [
        rho * material(velocity[i]) + sp.diff(p, X[i]) - sum(sp.diff(tau[i][j], X[j]) for j in range(3)) / par["R"] for i in range(3)
    ]
    heat = sum(sp.diff(mu * sp.diff(T, X[j]), X[j]) for j in range(3)) / (par["R"] * par["Pr"])
    dissipation = sum(tau[i][j] * sp.diff(velocity[i], X[j]) for i in range(3) for j in range(3)) / par["R"]
    energy = rho * material(T) - (par["gamma"] - 1) * par["M"] ** 2 * (material(p) + dissipation) - heat
    linear = [sp.diff(e, eps).subs(eps, 0) / wave for e in (mass, *momenta, energy)]
    derivative = sp.diff(linear[0], y)
    here = [e.subs({x: 0, z: 0, t: 0, y: 0}) for e in linear]
    symbols = {**taylor, **flow}
    return here, derivative.subs({x: 0, z: 0, t: 0, y: 0}), symbols, par


@pytest.mark.parametrize("m", [STOKES, MACK, 1.7])
def test_the_system_is_the_linearized_navier_stokes_equations(m: float) -> None:
    """ψ′ = C⁻¹D ψ for random ψ, parameters and base flow makes every residual of the symbolic derivation vanish."""
    equations, mass_y, c, par = navier_stokes(sp.Symbol("m"))
    rng = np.random.default_rng(1)
    gas = Gas(1.7, 200.0, sutherland=120.0, prandtl=0.8, gamma=1.3)
    s = gas.sutherland / gas.far_temperature
    alpha, sigma, beta, R = 0.7 - 0.2j, 0.3 + 0.4j, 0.5, 37.0
    U, T = [0.6, 0.3, -0.2], [1.7, -0.4, 0.25]
    mu, mu_T, mu_TT = (float(v) for v in gas.viscosity(np.array(T[0])))
    bg: dict[str, Any] = {"U": U[0], "U_y": U[1], "U_yy": U[2], "T": T[0], "T_y": T[1], "T_yy": T[2], "mu": mu, "mu_T": mu_T}
    bg |= {"mu_y": mu_T * T[1], "mu_yy": mu_TT * T[1] ** 2 + mu_T * T[2], "turn": mu_TT * T[1] * U[1] + mu_T * U[2]}
    C, D = (dense(entries, alpha, sigma) for entries in system(bg, gas, R, beta, m))
    psi = rng.normal(size=8) + 1j * rng.normal(size=8)
    slope = np.linalg.solve(C, D @ psi)
    u, u_y, v, p, th, th_y, w, w_y = psi
    values = {
        par["alpha"]: alpha, par["beta"]: beta, par["sigma"]: sigma, par["R"]: R, par["M"]: gas.mach, par["gamma"]: gas.gamma,
        par["Pr"]: gas.prandtl, par["s"]: s, sp.Symbol("m"): m,
        **dict(zip(c["U"], U, strict=True)), **dict(zip(c["T"], T, strict=True)),
        **dict(zip(c["u"], (u, u_y, slope[1]), strict=True)), **dict(zip(c["w"], (w, w_y, slope[7]), strict=True)),
        **dict(zip(c["theta"], (th, th_y, slope[5]), strict=True)), c["p"][0]: p, c["p"][1]: slope[3], c["v"][0]: v, c["v"][1]: slope[2],
    }  # fmt: skip
    assert slope[[0, 4, 6]] == pytest.approx([u_y, th_y, w_y])
    order = list(values)
    numbers = [complex(values[q]) for q in order]
    v2 = c["v"][2]
    # v″ from the derivative of the conservation of mass, in which it is linear
    at = sp.lambdify([*order, v2], mass_y, "numpy")
    second = -at(*numbers, 0.0) / (at(*numbers, 1.0) - at(*numbers, 0.0))
    for name, equation in zip(("mass", "x", "y", "z", "energy"), equations, strict=True):
        residual = sp.lambdify([*order, v2], equation, "numpy")(*numbers, second)
        assert abs(residual) < 1e-11, name


def dense(entries: Any, alpha: complex, sigma: complex) -> Any:
    out = np.zeros((8, 8), dtype=complex)
    for at, polynomial in entries.items():
        out[at] = sum(x * alpha**i * sigma**j for (i, j), x in polynomial.items())
    return out


# Malik's cases


def test_malik_3_temporal() -> None:
    """ω = 0.0367340 + 0.0005840i (Malik 1990, 4 digits of ω_i less); re-computed 0.03673374 + 0.00058446i with Mack's bulk viscosity."""
    mode = st.refine(malik_3(), -1j * (0.0367340 + 0.0005840j), rtol=1e-9)
    assert mode.converged
    assert abs(1j * mode.sigma - (0.03673374 + 0.00058446j)) < 0.8e-8
    assert 0.0 < mode.budget.steady_flow < 1e-12


@pytest.mark.parametrize(("second", "alpha"), [(MACK, 0.2534012 - 0.0024936j), (STOKES, 0.2534368 - 0.0027759j)], ids=["Mack", "Stokes"])
def test_malik_6_spatial(second: float, alpha: complex) -> None:
    """Mack's ratio 1.2: 0.2534048 − 0.0024921i published; Stokes: 0.2534420 − 0.0027738i (Tumin 2007). Re-computed to seven digits."""
    mode = st.refine(malik_6(second), alpha * (1 + 3e-5), rtol=1e-8)
    assert mode.converged
    assert abs(mode.sigma - alpha) < 0.8e-7
    # the spatial α, put into the temporal problem as it is, gives −iω back
    temporal = plate_temporal(Gas(4.5, stagnation(4.5, 1100.0) / 1.8), 1500.0, mode.sigma, second=second)
    back = st.refine(temporal, -0.23j * 1.00001, rtol=1e-8)
    assert abs(back.sigma + 0.23j) < 1e-9
