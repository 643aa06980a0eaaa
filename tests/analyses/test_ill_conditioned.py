"""Bounds on modes that rounding moves much further than by itself: each holds, and is no more than a few tens of times the error."""

from __future__ import annotations

import cmath
import math
from typing import Any

import mpmath
import numpy as np
import pytest

import shootstab as st

D1 = np.array([[0.0, 0.0], [1.0, 0.0]])


def davies(n: int) -> Any:
    """−u″ + i x² u = λu between walls at ±8: λ to 40 digits by power series; it is e^{iπ/4}(2n + 1) on the line."""
    with mpmath.workdps(60):

        def miss(value: Any) -> Any:
            y = [mpmath.mpf(n % 2 == 0), mpmath.mpf(n % 2)]
            for k in range(700):
                y.append((1j * (y[k - 2] if k >= 2 else 0) - value * y[k]) / ((k + 1) * (k + 2)))
            return mpmath.polyval(y[::-1], 8)

        near = cmath.exp(0.25j * math.pi) * (2 * n + 1)
        return mpmath.findroot(miss, (near, near * (1 + 1e-9)), tol=1e-30, verify=False)


@pytest.mark.parametrize("n", [0, 5, 9, 12])
@pytest.mark.parametrize("method", ["frame", "riccati"])
def test_davies_oscillator_breaks_no_bound(n: int, method: str) -> None:
    """The condition of the n-th mode grows as e^{1.3 n}."""
    truth = davies(n)
    P = st.problem(2, lambda x: (np.array([[0, 1], [1j * x * x, 0]]), -D1), st.Wall(-8, [[1, 0]]), st.Wall(8, [[1, 0]]))
    mode = st.refine(P, guess=complex(truth), rtol=1e-8, method=method)
    assert mode.converged
    error = float(abs(mpmath.mpmathify(mode.sigma) - truth))
    assert error <= mode.error
    assert mode.error < 200 * max(error, 1e-14)


@pytest.mark.parametrize("P", [1.0, 40.0, 200.0])
@pytest.mark.parametrize("n", [1, 4])
def test_advection_and_diffusion_break_no_bound(P: float, n: int) -> None:
    """y″ − P y′ = σ y, y(0) = y(1) = 0: σ = −P²/4 − n²π², of a condition of about e^{P/2}."""
    truth = -(P**2) / 4 - (n * math.pi) ** 2
    problem = st.problem(2, lambda x: (np.array([[0.0, 1.0], [0.0, P]]), D1), st.Wall(0, [[1, 0]]), st.Wall(1, [[1, 0]]))
    mode = st.refine(problem, guess=truth * (1 + 1e-6))
    assert mode.converged
    assert abs(mode.sigma - truth) <= mode.error < 1e-11 * abs(truth)


def test_complex_airy_breaks_no_bound() -> None:
    """y″ = (σ + 1000 i x) y, y(±1) = 0: rounding moves the mode by 1e-13 of itself times a million; by Airy's functions in mpmath."""
    near = -397.2 - 312j
    with mpmath.workdps(50):
        turn = mpmath.mpc(0, 1000) ** (mpmath.mpf(1) / 3)

        def miss(value: Any) -> Any:
            a, b = (turn * x + value / turn**2 for x in (-1, 1))
            return mpmath.airyai(a) * mpmath.airybi(b) - mpmath.airyai(b) * mpmath.airybi(a)

        truth = mpmath.findroot(miss, (near, near * (1 + 1e-6)), tol=1e-30, verify=False)
    problem = st.problem(2, lambda x: (np.array([[0, 1], [1000j * x, 0]]), D1), st.Wall(-1, [[1, 0]]), st.Wall(1, [[1, 0]]))
    mode = st.refine(problem, guess=near, rtol=1e-9)
    error = float(abs(mpmath.mpmathify(mode.sigma) - truth))
    assert mode.converged
    assert error <= mode.error < 200 * error


@pytest.mark.parametrize("method", ["frame", "riccati"])
def test_a_pencil_whose_c_is_nearly_singular_breaks_no_bound(method: str) -> None:
    """y″ = σ y times a matrix of condition 1e6 that varies: what elimination makes of a rounding of its entries is in the bound."""

    def multiplied(z: Any) -> tuple[Any, ...]:
        L = np.array([[1.0, 1.0 + 0.1 * np.sin(9 * z)], [1.0, 1.0 + 0.1 * np.sin(9 * z) + 1e-6]])
        return L, np.zeros((2, 2)), L @ np.array([[0.0, 1.0], [0.0, 0.0]]), L @ D1

    P = st.problem(2, multiplied, st.Wall(0, [[1, 0]]), st.Wall(1, [[1, 0]]))
    for n in (1, 2, 3):
        mode = st.refine(P, guess=-((n * math.pi) ** 2) * 1.001, rtol=1e-7, method=method)
        assert abs(mode.sigma + (n * math.pi) ** 2) <= mode.error < 1e-7 * n * n
