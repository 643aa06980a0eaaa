"""The candidate spectrum of the equations as they stand: published eigenvalues, and its independence of the reduction."""

from __future__ import annotations

import math

import numpy as np
import pytest
from equations_written import WRITTEN
from test_floors import reachable

import shootstab as st
from shootstab.analyses import reference
from shootstab.core.errors import InputError
from shootstab.formulation.problem import EquationProblem


def posed(name: str, left: list[str], right: list[str], low: float = -1.0, high: float = 1.0) -> EquationProblem:
    written = {k: v for k, v in WRITTEN[name].items() if k not in ("order", "from", "to")}
    return st.equations(**written, left=st.Conditions(low, left), right=st.Conditions(high, right))


def test_it_shares_nothing_with_the_reduction() -> None:
    """Formulas, names and conditions as the user stated them are common, and the solution of a base flow; what is derived is not."""
    twin = reachable("shootstab.formulation.equation_collocation", beside="shootstab.formulation.base_")
    derived = ("reduction", "first_order", "linear_algebra", "state_pencil", "continuous_spectrum", "digits", "problem")
    assert not any(name == f"shootstab.formulation.{module}" for name in twin for module in derived)
    assert not any(name.startswith(("shootstab.discriminants", "shootstab.kernels", "shootstab.multiprecision")) for name in twin)


def test_plane_poiseuille_flow_as_it_stands() -> None:
    """Orszag 1971, in u, v and p: one coefficient fewer for the pressure, one point more for continuity."""
    twin = posed("plane Poiseuille flow", ["u", "v"], ["u", "v"]).pseudospectral
    assert twin is not None
    assert twin.counts == (((2, 2, 1), (0, 0, 1)),)
    assert abs(twin.spectrum(80).eigenvalues[0] - (0.0037396706229794 - 0.2375264888204701j)) < 1e-11


def test_convergence_is_spectral() -> None:
    """Eigenvalues −(nπ/2)²: the error falls faster than any power of N."""
    twin = st.equations(["y"], ["d(y,2) - sigma*y"], st.Conditions(-1, ["y"]), st.Conditions(1, ["y"])).pseudospectral
    assert twin is not None
    errors = [np.abs(twin.spectrum(N, filtered=False).raw + (5 * np.pi / 2) ** 2).min() for N in (12, 16, 20)]
    assert errors[1] < 1e-3 * errors[0]
    assert errors[2] < 1e-3 * errors[1]


def test_powers_of_the_eigenvalue() -> None:
    """y″ + σ² y = 0 has ±nπ/2, and σ = 0 is none; spatial modes of plane Poiseuille flow are those of the reduced problem."""
    twin = st.equations(["y"], ["d(y,2) + sigma**2*y"], st.Conditions(-1, ["y"]), st.Conditions(1, ["y"])).pseudospectral
    assert twin is not None
    found = twin.spectrum(30).eigenvalues
    near = np.sort(found[np.abs(found) < 5].real)
    assert near == pytest.approx(np.pi / 2 * np.array([-3, -2, -1, 1, 2, 3]), abs=1e-10)
    spatial = posed("plane Poiseuille flow, spatial", ["u", "v"], ["u", "v"])
    assert spatial.pseudospectral is not None
    mode = st.refine(spatial, guess=1.0006 - 0.0109j)
    assert np.abs(spatial.pseudospectral.spectrum(60, filtered=False).raw - mode.sigma).min() < 1e-9


def test_two_derivations_agree_on_taylor_couette_flow() -> None:
    """Order 6 in u, v, w, p, with the axis outside: every claim of the collocation is a mode of the reduction."""
    problem = posed("Taylor-Couette flow", ["u", "v", "w"], ["u", "v", "w"], 1.0, 2.0)
    report = st.verify(problem, problem.pseudospectral.spectrum(40).eigenvalues[:3].tolist())  # type: ignore[union-attr]
    assert [v.verdict for v in report.verdicts] == ["confirmed"] * 3


def kept(problem: EquationProblem, M: int) -> np.ndarray:
    return np.asarray(problem.pseudospectral.spectrum(M).eigenvalues)  # type: ignore[union-attr]


def confirmed(problem: EquationProblem, M: int) -> bool:
    """Whether every value that the collocation keeps is a mode of the reduction."""
    report = st.verify(problem, kept(problem, M).tolist(), missing="none")
    return {v.verdict for v in report.verdicts} == {"confirmed"}


def test_the_line_by_rational_functions() -> None:
    """Bound states of ν (ν + 1) sech²(x − c), (ν − n)²: the place of the well, and its width, are found."""
    for place, width in ((0, 1), (12, 1), (-3, 0.05)):
        shape = {"parameters": {"nu": 2.3, "c": place, "w": width}, "variable": "x"}
        well = ["d(y,2) + nu*(nu + 1)/w**2*sech((x - c)/w)**2*y = sigma*y"]
        problem = st.equations(["y"], well, st.Infinity(), st.Infinity(), **shape)
        assert kept(problem, 80) * width**2 == pytest.approx([2.3**2, 1.3**2, 0.3**2], rel=1e-6)
    assert confirmed(st.equations(["y"], well, st.Infinity(), st.Infinity(), **{**shape, "parameters": {"nu": 2.3, "c": 1, "w": 1}}), 60)


def test_convergence_on_the_half_line() -> None:
    """Morse's well on x > 0 with a wall in it, against a collocation on a long interval; and a potential that grows, 4n + 3."""
    well = ["d(y,2) - 9*(exp(-2*(x - 2)) - 2*exp(-(x - 2)))*y = sigma*y"]
    ends = st.Conditions(0, ["y"]), st.Infinity()
    half = st.equations(["y"], well, *ends, variable="x")
    long = st.equations(["y"], well, ends[0], st.Conditions(30, ["y"]), variable="x")
    assert half.pseudospectral is not None
    errors = [np.abs(half.pseudospectral.spectrum(M, filtered=False).raw - kept(long, 120)[0]).min() for M in (24, 48, 96)]
    assert errors[2] < 1e-9 < 1e-3 * errors[0]
    assert confirmed(half, 60)
    oscillator = st.equations(["y"], ["x**2*y - d(y,2) = sigma*y"], *ends, variable="x")
    assert kept(oscillator, 60)[-3:] == pytest.approx([11, 7, 3], rel=1e-6)
    mirrored = st.equations(["y"], ["x**2*y - d(y,2) = sigma*y"], st.Infinity(), st.Conditions(0, ["y"]), variable="x")
    assert kept(mirrored, 60)[-3:] == pytest.approx([11, 7, 3], rel=1e-6)


def test_an_axis_and_infinity() -> None:
    """Hydrogen, 1/n²."""
    orbital = ["d(f,2) + 2*d(f)/r + (2/r - l*(l + 1)/r**2)*f = sigma*f"]
    problem = st.equations(["f"], orbital, st.Axis(0), st.Infinity(), parameters={"l": 1}, variable="r")
    assert kept(problem, 60)[:4] == pytest.approx([1 / n**2 for n in (2, 3, 4, 5)], rel=1e-9)


def test_periodic_ends_by_fourier_series() -> None:
    """Mathieu's a_0, a_2 and b_2 for q = 1 (Abramowitz & Stegun 20), and a system of two equations."""
    ends = st.Periodic(0), st.Periodic(math.pi)
    mathieu = st.equations(["y"], ["d(y,2) + (sigma - 2*q*cos(2*z))*y = 0"], *ends, parameters={"q": 1})
    assert kept(mathieu, 20)[-3:] == pytest.approx([4.3713009827, 3.9170247729, -0.4551386041], abs=1e-9)
    split = st.equations(["y", "w"], ["d(y) = w", "d(w) + (sigma - 2*cos(2*z))*y = 0"], *ends)
    assert kept(split, 40)[-3:] == pytest.approx([4.3713009827, 3.9170247729, -0.4551386041], abs=1e-9)
    assert confirmed(mathieu, 16)


def test_layers_and_amplitudes() -> None:
    """Kelvin and Helmholtz with surface tension: ρ1 (σ + ikU1)² + ρ2 (σ + ikU2)² + gk (ρ1 − ρ2) + S k³ = 0 (Chandrasekhar, ch. XI)."""
    k, g, S, rho, U = 2.0, 1.0, 0.1, (1.0, 0.5), (0.0, 2.0)
    stated = ["rho*(sigma + i*k*U)*u + i*k*p", "rho*(sigma + i*k*U)*w + d(p)", "i*k*u + d(w)"]
    rows = ["before(sigma + i*k*U)*h = before(w)", "behind(sigma + i*k*U)*h = behind(w)", "jump(p) = (g*jump(rho) - S*k**2)*h"]
    parameters = {"k": k, "g": g, "S": S, "rho": list(rho), "U": list(U)}
    joint = st.InterfaceConditions(0, rows, ["h"])
    problem = st.equations(["u", "w", "p"], stated, st.Infinity(), st.Infinity(), interfaces=[joint], parameters=parameters)
    of_powers = [
        sum(rho),
        2j * k * np.dot(rho, U),
        -(k**2) * np.dot(rho, np.square(U)) + g * k * (rho[0] - rho[1]) + S * k**3,
    ]
    assert np.sort_complex(kept(problem, 60)) == pytest.approx(np.sort_complex(np.roots(of_powers)), abs=1e-8)
    assert confirmed(problem, 32)


def test_low_modes_of_high_derivatives_keep_their_digits() -> None:
    """A clamped and free beam, w⁗ = β⁴ w with cos β cosh β = −1: no digit is lost to N⁸."""
    ends = st.Conditions(0, ["w", "d(w)"]), st.Conditions(1, ["d(w,2)", "d(w,3)"])
    problem = st.equations(["w"], ["d(w,4) - sigma*w"], *ends)
    assert kept(problem, 90)[-1] == pytest.approx(1.8751040687119611664**4, rel=1e-12)


def test_an_eigenvalue_that_is_zero() -> None:
    """The front tanh of u_t = u″ + u − u³, scaled: 0 by translation, and −3/2."""
    front = ["sigma*w = d(w,2) + (1 - 3*tanh(x/sqrt(2))**2)*w"]
    problem = st.equations(["w"], front, st.Infinity(), st.Infinity(), variable="x")
    assert kept(problem, 60) == pytest.approx([0, -1.5], abs=1e-9)
    assert [round(x.real, 6) for x in reference.claims(problem, 6)] == [0, -1.5]


def test_what_cannot_be_collocated_says_why() -> None:
    """Derivatives that cancel: by the derivatives in them these equations would be of order 4, and they are of order 2."""
    ends = st.Conditions(0, ["u"]), st.Conditions(1, ["u"])
    problem = st.equations(["u", "v"], ["d(u,2) + d(v,2) - sigma*u", "d(u,2) + d(v,2) - v"], *ends)
    with pytest.raises(InputError, match=r"no collocation .* they ask for 4 conditions, and have 2: allowed is a file of eigenvalues"):
        reference.spectrum(problem)


def test_zero_in_a_jordan_block_is_claimed_as_often_as_it_counts() -> None:
    """The solitons of sine-Gordon's equation, 0 twice, and of Schrödinger's, 0 four times, at truncations where more than rounding parts
    them; a pair ±1e-3 that is one stays."""
    line = st.Infinity(), st.Infinity()
    kink = st.equations(["w"], ["sigma**2*w = d(w,2) - (1 - 2*sech(x)**2)*w"], *line, variable="x")
    pair = ["sigma*v = d(u,2) + 6*sech(x)**2*u - u", "sigma*u = -d(v,2) - 2*sech(x)**2*v + v"]
    soliton = st.equations(["u", "v"], pair, *line, variable="x")
    for M in (40, 60, 80):
        assert list(reference.claims(kink, 6, M)) == [0, 0]
        assert list(reference.claims(soliton, 6, M)) == [0, 0, 0, 0]
    walls = st.Conditions(0, ["u"]), st.Conditions(1, ["u"])
    slow = st.equations(["u"], ["sigma**2*u = d(u,2) + (pi**2 + 1/1000000)*u"], *walls)
    claims = reference.claims(slow, 6, 40)
    assert np.sort(np.abs(claims))[:2] == pytest.approx([1e-3, 1e-3], rel=1e-5)


def test_waves_over_a_period_come_in_pairs() -> None:
    """As many sines as cosines at every truncation: at none is one of two modes that nearly are one lacking."""
    ends = st.Periodic(0), st.Periodic(1)
    ring = st.equations(["y"], ["d(y,2) + (sigma - 2*cos(2*pi*z))*y = 0"], *ends)
    for M in (24, 25):
        assert len(ring.pseudospectral.spectrum(M, filtered=False).raw) == 25
