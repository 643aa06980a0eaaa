"""Regular singular ends: Bessel and Legendre for every order, pipe flow; what is regular is found from the series at the point itself."""

from __future__ import annotations

from typing import Any

import mpmath
import numpy as np
import pytest
from equations_written import WRITTEN
from scipy.special import jn_zeros, jv

import shootstab as st
from shootstab.analyses.refine_digits import refine_digits
from shootstab.core.errors import InputError


def bessel(order: float, **changed: Any) -> Any:
    settings: dict[str, Any] = {
        "left": st.Axis(0),
        "right": st.Conditions(1, ["y"]),
        "parameters": {"n": order},
        "variable": "r",
        **changed,
    }
    return st.equations(["y"], ["d(y,2) + d(y)/r - n**2*y/r**2 + sigma*y"], **settings)


def pipe(n: float, **parameters: float) -> Any:
    written = {k: v for k, v in WRITTEN["pipe flow"].items() if k not in ("order", "from", "to")}
    written["parameters"] = {**written["parameters"], "n": n, **parameters}
    return st.equations(**written, left=st.Axis(0), right=st.Conditions(1, ["u", "v", "w"]))


@pytest.mark.parametrize("order", [0, 1, 2, 7])
def test_zeros_of_bessel_functions(order: int) -> None:
    problem = bessel(order)
    for zero in jn_zeros(order, 3) ** 2:
        assert abs(st.refine(problem, guess=zero + 0.02).sigma - zero) < 1e-12 * zero
    below = float(jn_zeros(order, 3)[2]) ** 2 + 1
    assert st.count(problem, st.Rectangle(-1 - 5j, below + 5j)) == 3


def test_bessel_functions_of_an_order_that_is_no_integer() -> None:
    sigma = st.refine(bessel(0.3), guess=8.0).sigma
    assert abs(jv(0.3, np.sqrt(sigma))) < 1e-13


def test_the_frame_is_analytic_and_its_derivative_exact() -> None:
    """Cauchy–Riemann by differences along both axes, for pipe flow, where exponents differ by integers."""
    space = pipe(1).reduction.subdomains[0].far
    sigma, h = 0.3 - 0.8j, 1e-5
    at = space.frame(sigma)
    for step in (h, 1j * h):
        slope = (space.frame(sigma + step).frame - space.frame(sigma - step).frame) / (2 * step)
        assert np.abs(slope - at.tangent).max() < 1e-8 * np.abs(at.tangent).max()


@pytest.mark.parametrize("m", [0, 1, 2])
def test_legendre_between_two_singular_ends(m: int) -> None:
    """l(l + 1) with l = m, m + 1, …"""
    problem = st.equations(["y"], ["(1-z**2)*d(y,2) - 2*z*d(y) - m**2/(1-z**2)*y + sigma*y"], st.Axis(-1), st.Axis(1), parameters={"m": m})
    for degree in (m + 1, m + 4):
        expected = degree * (degree + 1)
        assert abs(st.refine(problem, guess=expected + 0.1).sigma - expected) < 1e-12 * expected


def test_pipe_flow() -> None:
    """Re = 3000, α = 1, n = 1: A. Meseguer & L. N. Trefethen, J. Comput. Phys. 186 (2003) 178, in the growth rate."""
    problem = pipe(1)
    mode = st.refine(problem, guess=-0.0413 - 0.9115j)
    assert abs(mode.sigma - (-0.0412756446937 - 0.9114655676227j)) < 2e-13
    twin = problem.pseudospectral
    assert abs(twin.spectrum(60).eigenvalues[0] - mode.sigma) < 1e-11
    assert problem.first_order.order == 6
    assert problem.reduction.subdomains[0].far.columns == 3


@pytest.mark.slow
def test_many_digits_from_the_axis() -> None:
    """Zeros of J_2 to 40 digits, from either side; pipe flow to 20, by two arithmetics."""
    with mpmath.workdps(50):
        expected = mpmath.besseljzero(2, 1) ** 2
        assert abs(st.refine(bessel(2), guess=26.37, digits=40).sigma - expected) < mpmath.mpf(10) ** -38
        mirrored = st.equations(["y"], ["d(y,2) - d(y)/(1-x) - 4*y/(1-x)**2 + sigma*y"], st.Conditions(0, ["y"]), st.Axis(1), variable="x")
        assert abs(st.refine(mirrored, guess=26.37, digits=40).sigma - expected) < mpmath.mpf(10) ** -38
        found = [refine_digits(pipe(1), -0.0412756446937 - 0.9114655676227j, 20, arithmetic=name) for name in ("flint", "mpmath")]
        assert all(mode.converged for mode in found)
        assert abs(found[0].sigma - found[1].sigma) < 2e-20


def test_many_digits_between_two_singular_ends() -> None:
    """Legendre functions of order 2: 4·5."""
    problem = st.equations(["y"], ["(1-z**2)*d(y,2) - 2*z*d(y) - 4/(1-z**2)*y + sigma*y"], st.Axis(-1), st.Axis(1))
    mode = st.refine(problem, 20.1, digits=25)
    assert abs(mode.sigma - 20) <= mode.error < 1e-25


@pytest.mark.parametrize("arithmetic", ["flint", "mpmath"])
@pytest.mark.parametrize(
    ("square", "order"), [("1/4", lambda: mpmath.mpf(1) / 2), ("2", lambda: mpmath.sqrt(2)), ("pi", lambda: mpmath.sqrt(mpmath.pi))]
)
def test_many_digits_where_exponents_are_no_integers(square: str, order: Any, arithmetic: str) -> None:
    """Zeros of J_ν: ν itself is known to as many digits."""
    equation = f"d(y,2) + d(y)/r - ({square})*y/r**2 + sigma*y"
    problem = st.equations(["y"], [equation], st.Axis(0), st.Conditions(1, ["y"]), variable="r")
    with mpmath.workdps(40):
        expected = mpmath.besseljzero(order(), 1) ** 2
        mode = refine_digits(problem, complex(expected) * 1.0001, 30, arithmetic=arithmetic)
        assert abs(mode.sigma - expected) <= mode.error < 1e-28


def test_many_digits_of_two_equal_exponents_and_of_complex_ones() -> None:
    """Two coupled functions of order 1/3, whose σ is shifted by ±√2; and order (1 + i)^(1/2)."""
    part = "d({0},2) + d({0})/r - {0}/(9*r**2) + sigma*{0} + {1}"
    ends = st.Axis(0), st.Conditions(1, ["u", "w"])
    pair = st.equations(["u", "w"], [part.format("u", "w"), part.format("w", "2*u")], *ends, variable="r")
    single = st.equations(["y"], ["d(y,2) + d(y)/r - (1 + i)*y/r**2 + sigma*y"], st.Axis(0), st.Conditions(1, ["y"]), variable="r")
    with mpmath.workdps(40):
        expected = mpmath.besseljzero(mpmath.mpf(1) / 3, 1) ** 2 + mpmath.sqrt(2)
        mode = st.refine(pair, complex(expected) * 1.0001, digits=25)
        assert abs(mode.sigma - expected) <= mode.error < 1e-23
        mode = st.refine(single, 15.4288 + 4.8282j, digits=25)
        assert abs(mpmath.besselj(mpmath.sqrt(mpmath.mpc(1, 1)), mpmath.sqrt(mode.sigma))) < 1e-24


@pytest.mark.parametrize("n", [0, 2, 3])
def test_pipe_flow_of_other_orders_by_two_derivations(n: int) -> None:
    problem = pipe(n)
    claimed = problem.pseudospectral.spectrum(60).eigenvalues[0]
    assert abs(st.refine(problem, guess=claimed).sigma - claimed) < 1e-9


def test_what_users_are_told() -> None:
    with pytest.raises(InputError, match=r"1 of 2 solutions are regular at r = 0, and the other end holds 2 conditions: allowed are 1"):
        bessel(1, right=st.Conditions(1, ["y", "d(y)"]))
    with pytest.raises(InputError, match="r = 0 is an irregular singular point of the equations"):
        st.equations(["y"], ["d(y,2) + d(y)/r**2 + sigma*y"], st.Axis(0), st.Conditions(1, ["y"]), variable="r")
    with pytest.raises(InputError, match="the exponents depend on the eigenvalue"):
        st.equations(["y"], ["d(y,2) + d(y)/r + sigma*y/r**2"], st.Axis(0), st.Conditions(1, ["y"]), variable="r")
    with pytest.raises(InputError, match=r"at the left end, r = 0, the equations are singular, or beyond 1e308: allowed is st.Axis\(0\)"):
        bessel(1, left=st.Conditions(0, ["y"]))
