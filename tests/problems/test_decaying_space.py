"""problems/splitting, truncation, decaying_space: how well the decaying space is known, and where an integration begins."""

from __future__ import annotations

import math
from typing import Any

import mpmath
import numpy as np
import pytest

import shootstab as st
from shootstab.core.errors import InputError, Undecidable
from shootstab.problems.protocol import ComplexArray, Pencil
from shootstab.problems.splitting import AsymptoticPencil

SIMILAR = np.array([[1.0, 0.5], [-0.3, 1.0]])
SHARP = np.array([[1.0, 2.0], [3.0, 7.0]])


def constant(A: Any) -> AsymptoticPencil:
    """C = I, D = A, whatever σ is."""
    none = np.zeros_like(np.asarray(A, dtype=np.complex128))
    return AsymptoticPencil(Pencil(np.eye(len(A), dtype=np.complex128), none, np.asarray(A, dtype=np.complex128), none), 1)


def exact_space(A: ComplexArray, k: int) -> ComplexArray:
    """An orthonormal basis (n, k) of the k solutions that decay fastest, from 50 digits."""
    with mpmath.workdps(50):
        rates, V = mpmath.eig(mpmath.matrix(A.tolist()))
        order = sorted(range(len(A)), key=lambda i: mpmath.re(rates[i]))[:k]
        columns = [[V[i, j] / mpmath.norm(V[:, j]) for i in range(len(A))] for j in order]
        # orthonormal in many digits: eigenvectors may be nearly parallel
        basis: list[Any] = []
        for column in columns:
            v = mpmath.matrix(column)
            for b in basis:
                v -= b * (b.H * v)[0]
            basis.append(v / mpmath.norm(v))
        return np.array([[complex(b[i]) for b in basis] for i in range(len(A))])


@pytest.mark.parametrize("gap", [1.0, 1e-2, 1e-4, 1e-6])
@pytest.mark.parametrize("n", [2, 4, 6])
def test_the_error_of_a_space_is_what_rounding_makes_and_no_more(n: int, gap: float) -> None:
    """Over ten matrices of normal-ish eigenvectors the largest error lies below the bound, and the bound within 1e3 of it."""
    rng, k = np.random.default_rng(n), n // 2
    errors, bounds = [], []
    for _ in range(10):
        V = np.linalg.qr(rng.normal(size=(n, n)) + 1j * rng.normal(size=(n, n)))[0] + 0.1 * rng.normal(size=(n, n))
        mu = np.concatenate((-gap / 2 - rng.random(k) * (np.arange(k) > 0), gap / 2 + rng.random(n - k) * (np.arange(n - k) > 0)))
        A = V @ np.diag(mu + 1j * rng.normal(size=n)) @ np.linalg.inv(V)
        split = constant(A).splitting(0.0, k)
        exact, X = exact_space(A, k), np.linalg.qr(split.X)[0]
        errors.append(float(np.linalg.norm(X - exact @ (exact.conj().T @ X), 2)))
        bounds.append(split.rounding)
    assert np.all(np.array(errors) <= 4 * np.array(bounds))
    assert max(bounds) < 1e3 * max(errors)


@pytest.mark.parametrize("size", [1e-8, 1.0, 1e8])
def test_a_defective_pair_is_not_split_by_rounding(size: float) -> None:
    """Rates 0 and 0 with one solution: under a similarity rounding makes ±√ε of them, and no space of it."""
    for T in (SIMILAR, SHARP):
        A = size * (T @ np.array([[0, 1], [0, 0]]) @ np.linalg.inv(T))
        with pytest.raises(Undecidable, match=r"one real part|one to rounding"):
            constant(A).splitting(0.0, 1)
    # and inside a larger system, next to rates that are told apart: those are
    A = np.diag([-2.0, 1e-9, 0.0, 3.0])
    A[1, 2] = 1.0
    A[2, 1] = 1e-17
    T4 = np.linalg.qr(np.random.default_rng(4).normal(size=(4, 4)))[0]
    limit = constant(size * T4 @ A @ T4.T)
    assert limit.splitting(0.0, 1).rounding < 1e-14
    assert limit.splitting(0.0, 3).rounding < 1e-14
    with pytest.raises(Undecidable):
        limit.splitting(0.0, 2)


def bessel(m: float, T: Any) -> Any:
    """r (r y′)′ = (m² + σ r²) y in s = ln r, the state (y, r y′) under a similarity."""
    inverse = np.linalg.inv(T)

    def pencil(s: float) -> tuple[Any, Any]:
        return T @ np.array([[0, 1], [m * m, 0]]) @ inverse, T @ np.array([[0, 0], [math.exp(2 * s), 0]]) @ inverse

    return pencil


@pytest.mark.parametrize("T", [np.eye(2), SIMILAR, SHARP], ids=["plain", "similar", "sharp"])
def test_a_regular_singular_point_with_equal_exponents_is_refused(T: Any) -> None:
    """m = 0: y ~ 1 and y ~ ln r. −5.7831864446 ± 1.2e-12 was found where j₀₁² is 5.7831859629."""
    with pytest.raises(InputError, match="one to rounding") as refusal:
        st.problem(2, bessel(0.0, T), st.Infinity(), st.Wall(0.0, [np.linalg.inv(T)[0]]))
    assert "st.Wall" in str(refusal.value)


@pytest.mark.parametrize("m", [0.5, 1.0, 2.0])
@pytest.mark.parametrize("T", [np.eye(2), SIMILAR], ids=["plain", "similar"])
def test_a_matrix_that_vanishes_at_infinity_is_small_against_the_others(m: float, T: Any) -> None:
    """D1 = e^{2s} is at its limit 0 where it does not matter any more, not where it underflows at s = −376."""
    problem = st.problem(2, bessel(m, T), st.Infinity(), st.Wall(0.0, [np.linalg.inv(T)[0]]))
    assert -30.0 < problem.start(-1.0, 1e-14) < -20.0
    exact = -float(mpmath.besseljzero(m, 1) ** 2)
    mode = st.refine(problem, 1.001 * exact)
    assert abs(mode.sigma - exact) <= mode.error < 1e-11


def test_close_exponents_are_in_the_bound() -> None:
    """m = 1e-3: exponents ±1e-3, told apart to 1e-11 or so."""
    problem = st.problem(2, bessel(1e-3, SIMILAR), st.Infinity(), st.Wall(0.0, [np.linalg.inv(SIMILAR)[0]]))
    exact = -float(mpmath.besseljzero(1e-3, 1) ** 2)
    mode = st.refine(problem, 1.001 * exact)
    assert abs(mode.sigma - exact) <= mode.error < 1e-8
    assert mode.budget.far_field > 1e-14


@pytest.mark.parametrize("start", [8.0, 10.0, 13.0])
def test_a_start_with_its_limit(start: float) -> None:
    """Pöschl–Teller, ν = 0.05, begun where the potential is still 0.2 e^{−2·start}: that is the error, and the bound."""
    pencil = st.gallery.poeschl_teller(0.05).function.function

    def plain(x: float) -> tuple[Any, Any]:
        D0, D1 = pencil(np.array([x]))
        return D0[0], D1

    limit = (np.array([[0, 1], [0, 0]]), np.array([[0, 0], [1, 0]]))
    end = st.Infinity(start=start, limit=limit)
    mode = st.refine(st.problem(2, plain, end, end), 0.0026, rtol=1e-11)  # far finer steps than the start is known
    error = abs(mode.sigma - 0.0025)
    assert 0.0 < error <= mode.error < 100 * error + 1e-14
    assert mode.budget.far_field > 0.9 * (mode.error - 1e-14)


def test_a_start_too_near_is_refused_with_what_is_known() -> None:
    def slow(z: float) -> tuple[Any, Any]:
        return np.array([[0, 1], [1 / (1 + z * z), 0]]), np.array([[0, 0], [1, 0]])

    limit = (np.array([[0, 1], [0, 0]]), np.array([[0, 0], [1, 0]]))
    problem = st.problem(2, slow, st.Wall(0, [[0, 1]]), st.Infinity(start=20.0, limit=limit))
    mode = st.refine(problem, -0.1 + 0.2j)
    assert not mode.converged
    assert "is known to" in mode.status


def test_a_tolerance_below_what_the_start_can_give_is_answered() -> None:
    """The far frame of Davies' problem, begun at 8, is known to some 1e-16, and no start is better: once this ran into itself for ever."""
    exact = (1 + 1j) / math.sqrt(2)
    mode = st.refine(st.gallery.davies(8.0), 0.7 + 0.7j, method=st.Frame(rtol=1e-14))
    assert abs(mode.sigma - exact) <= mode.error < 1e-13
