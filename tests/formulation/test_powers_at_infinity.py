"""Ends at infinity where coefficients go as powers: exact eigenvalues, from an axis too, in doubles and in many digits."""

from __future__ import annotations

import cmath
import math
from typing import Any

import mpmath
import numpy as np
import pytest
from scipy.special import ai_zeros

import shootstab as st
from shootstab.formulation.asymptotic_end import asymptotic_end
from shootstab.formulation.expression import number
from shootstab.formulation.names import Names
from shootstab.formulation.state_pencil import StatePencil

LINE = st.Infinity(), st.Infinity()


def schroedinger(V: str, *ends: Any) -> Any:
    """−u″ + V u = s u."""
    return st.equations(["u"], [f"-d(u,2) + ({V})*u = s*u"], *(ends or LINE), eigenvalue="s", variable="x")


def hydrogen(angular: int) -> Any:
    """u″ + 2u′/r + (2/r − l(l+1)/r²) u = s u, s = 1/n²: solutions have logarithms at no end, and powers r^(n−1) e^{−r/n} at infinity."""
    return st.equations(
        ["u"],
        ["d(u,2) + 2*d(u)/r + (2/r - l*(l+1)/r**2)*u = s*u"],
        st.Axis(0),
        st.Infinity(),
        parameters={"l": angular},
        eigenvalue="s",
        variable="r",
    )


@pytest.mark.parametrize(("angular", "n"), [(0, 1), (0, 3), (1, 2)])
def test_hydrogen_from_the_axis(angular: int, n: int) -> None:
    mode = st.refine(hydrogen(angular), 1.02 / n**2)
    assert mode.converged
    assert abs(mode.sigma - 1 / n**2) <= mode.error < 1e-12


def test_many_digits_from_an_axis_to_infinity() -> None:
    """At the mode itself the series ends: the place where it holds for others is farther out."""
    mode = st.refine(hydrogen(1), 0.11111, digits=25)
    with mpmath.workdps(40):
        assert abs(mode.sigma - mpmath.mpf(1) / 9) <= mode.error < 1e-25


@pytest.mark.parametrize(
    ("V", "guess", "exact"),
    [
        ("x**2", 7.1, 7.0),
        ("i*x**2", 5.02 * cmath.exp(0.25j * math.pi), 5 * cmath.exp(0.25j * math.pi)),
        ("x**4", 1.05, 1.0603620904841828996),  # C. M. Bender & T. T. Wu, Phys. Rev. 184 (1969) 1231
    ],
)
def test_potentials_that_grow(V: str, guess: complex, exact: complex) -> None:
    mode = st.refine(schroedinger(V), guess)
    assert abs(mode.sigma - exact) <= mode.error < 1e-12 * abs(exact)


def test_airys_equation_goes_as_a_broken_power() -> None:
    problem = schroedinger("x", st.Conditions(0, ["u"]), st.Infinity())
    assert abs(st.refine(problem, 2.3).sigma + ai_zeros(1)[0][0]) < 1e-12
    with mpmath.workdps(40):
        assert abs(st.refine(problem, 2.338, digits=25).sigma + mpmath.airyaizero(1)) < mpmath.mpf(10) ** -25


def test_many_digits_of_davies_operator_and_of_a_gaussian_well() -> None:
    """(2n + 1) exp(iπ/4); and what is exponentially small beside the powers, of any kind, is left out where it is below the digits."""
    mode = st.refine(schroedinger("i*x**2"), 3.5355 + 3.5355j, digits=30)
    with mpmath.workdps(40):
        assert abs(mode.sigma - 5 * mpmath.exp(1j * mpmath.pi / 4)) <= mode.error < mpmath.mpf(10) ** -29
    well = schroedinger("-2*exp(-x**2)")
    double = st.refine(well, -0.95)
    assert abs(complex(st.refine(well, double.sigma, digits=20).sigma) - double.sigma) <= double.error


def test_the_frame_is_analytic_and_its_derivative_exact() -> None:
    """Cauchy–Riemann by differences, where the decaying space of the limit moves with σ and so do the later terms."""
    space = st.equations(
        ["u", "v"],
        ["d(u,2) + d(u)/r + (1/r + s/r**2)*v = (s + 1)*u", "d(v,2) + 2*u/r = (2*s + 3)*v + d(u)/r**2"],
        st.Conditions(1, ["u", "v"]),
        st.Infinity(),
        eigenvalue="s",
        variable="r",
    ).at_infinity[0]
    sigma, h = 0.8 + 0.6j, 1e-5
    at = space.frame(sigma)

    def minors(sigma: complex) -> Any:
        found = space.frame(sigma)
        return np.array([np.linalg.det(found.frame[rows]) for rows in ([0, 1], [0, 2], [1, 3], [2, 3])]) * math.exp(found.log_scale)

    def moved(rows: list[int]) -> complex:
        det = np.linalg.det(at.frame[rows]) * math.exp(at.log_scale)
        return complex(det * np.trace(np.linalg.solve(at.frame[rows], at.tangent[rows])))

    slopes = np.array([moved(rows) for rows in ([0, 1], [0, 2], [1, 3], [2, 3])])
    for step in (h, 1j * h):
        difference = (minors(sigma + step) - minors(sigma - step)) / (2 * step)
        assert np.abs(difference - slopes).max() < 1e-7 * np.abs(slopes).max()


@pytest.mark.parametrize(
    "V",
    [
        "1/(1+x**2) + (1+x**2)**(-3/2)",  # of u = exp(-√(1+x²))
        "1 - x**2/sqrt(1+x**4) + (1+x**4)**(-5/4)",  # of u = exp(-∫x (1+x⁴)^(-1/4) dx)
    ],
)
def test_potentials_that_fall_off_as_powers(V: str) -> None:
    """σ = 1 exactly, where the first terms of the series vanish and where they do not; far out a double sees no power."""
    problem = st.equations(["u"], [f"d(u,2) + ({V})*u = sigma*u"], st.Infinity(), st.Infinity(), variable="x")
    double = st.refine(problem, 0.99)
    assert abs(double.sigma - 1) <= double.error < 1e-12
    mode = st.refine(problem, double.sigma, digits=25)
    with mpmath.workdps(35):
        assert abs(mode.sigma - 1) <= mode.error < 1e-25


def test_a_window_reaches_over_the_terms_that_vanish() -> None:
    """Coefficients with terms of the orders 0, 4 and 6, p = 1 and Q = 0; constant ones."""
    formula = Names(("y",), {}, {}).expression("1 + z**-4 + z**-6", "a test")
    end = asymptotic_end(StatePencil(1, ({(0, 0): number(1)}, {}), ({(0, 0): formula}, {}), ({},), ({},), 0, 0), 1)
    assert end.window([True, False, False, False, True, False, True, False]) == 1 + 0 + 4
    assert end.window([True, False, False]) == 1 + 0 + 1


@pytest.mark.parametrize("guess", [0.4j, 1e10j, 1e30 + 1e30j])
def test_a_series_whose_terms_overflow_is_told_in_words(guess: complex) -> None:
    """C = σ − iqz has no mode; its series goes in powers of σ/(qz), which a search that wanders off to |σ| = 1e18 overflows."""
    problem = st.equations(
        ["u"],
        ["sigma*(d(u,2) - p*u) = i*q*z*(d(u,2) - p*u)"],
        st.Conditions(0, ["u"]),
        st.Infinity(),
        parameters={"p": 0.0037, "q": 1458.0},
    )
    found = st.refine(problem, guess)
    assert not found.converged
    assert found.status.startswith("not converged: at +infinity"), found.status
