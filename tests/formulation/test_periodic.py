"""Periodic ends: Mathieu's equation, and what is refused."""

from __future__ import annotations

import mpmath
import numpy as np
import pytest
from scipy.special import mathieu_a, mathieu_b

import shootstab as st
from shootstab.core.errors import InputError


def mathieu(q: float, right: float = np.pi) -> object:
    return st.equations(["y"], ["d(y,2) + (sigma - 2*q*cos(2*z))*y"], st.Periodic(0), st.Periodic(right), parameters={"q": q})


def test_characteristic_values_of_mathieus_equation() -> None:
    """Period π: a_0, b_2, a_2, …; a rectangle holds as many as there are."""
    problem = mathieu(3.0)
    values = [mathieu_a(0, 3.0), mathieu_b(2, 3.0), mathieu_a(2, 3.0)]
    for value in values:
        assert abs(st.refine(problem, guess=value + 0.01).sigma - value) < 1e-11
    assert st.count(problem, st.Rectangle(-3 - 1j, 8 + 1j)) == 3


def test_a_square_of_the_eigenvalue_gives_both_roots() -> None:
    equation = ["d(y,2) + (omega**2 - 6*cos(2*z))*y"]
    problem = st.equations(["y"], equation, st.Periodic(0), st.Periodic(np.pi), eigenvalue="omega")
    root = np.sqrt(mathieu_b(2, 3.0))
    for sign in (1, -1):
        mode = st.refine(problem, guess=sign * root + 0.01)
        assert abs(mode.sigma - sign * root) <= mode.error < 1e-10
    assert problem.size == 4  # (a, ψ), without states for powers


def test_double_eigenvalues_are_counted_twice() -> None:
    """Without the potential σ = (2n)²: 0 once, 4 and 16 twice."""
    assert st.count(mathieu(0.0), st.Rectangle(-1 - 1j, 5 + 1j)) == 3


def test_thirty_digits_of_a_characteristic_value() -> None:
    """a_0 for q = 1 in a period of 1, against the eigenvalue of its Fourier series' matrix; one known to doubles is not taken for exact."""
    equation = ["d(y,2) + (sigma - 2*pi**2*cos(2*pi*x))*y"]
    mode = st.refine(st.equations(["y"], equation, st.Periodic(0), st.Periodic(1), variable="x"), guess=-4.49, digits=30)
    with mpmath.workdps(45):
        fourier = mpmath.diag([(2 * k) ** 2 for k in range(30)])
        for k in range(29):
            fourier[k, k + 1] = fourier[k + 1, k] = mpmath.sqrt(2) if k == 0 else 1
        known = mpmath.eigsy(fourier, eigvals_only=True)[0] * mpmath.pi**2
        assert abs(mode.sigma - known) <= mode.error < 1e-29
    with pytest.raises(InputError, match=r"more than 12 digits: .*cos\(2\*z\) has the period 3.14159\d+ to the digits of a double only"):
        st.refine(mathieu(1.0), guess=-0.455, digits=20)


def test_what_users_are_told() -> None:
    with pytest.raises(InputError, match="allowed are periodic coefficients"):
        mathieu(1.0, 2.0)
    with pytest.raises(InputError, match="one end is periodic and the other is not"):
        st.equations(["y"], ["d(y,2) + sigma*y"], st.Periodic(0), st.Conditions(1, ["y"]))
