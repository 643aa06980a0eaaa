"""The tableau, and the transport of frames: identities, observed order, compiled against uncompiled."""

from __future__ import annotations

from collections.abc import Callable
from types import ModuleType

import numpy as np
import pytest
import scipy.linalg
from sampled import constant, spoilt
from scipy.integrate import DOP853

from shootstab.discriminants.sampled_system import sample
from shootstab.kernels import frame_transport as transport
from shootstab.kernels import frobenius as regular_singular
from shootstab.kernels import reduced_system as system
from shootstab.kernels import tableau
from shootstab.kernels.reduced_system import ReducedSystem

RNG = np.random.default_rng(5)


def random_complex(*shape: int) -> np.ndarray:
    return RNG.standard_normal(shape) + 1j * RNG.standard_normal(shape)


def test_the_tableau_is_that_of_scipy() -> None:
    for name in ("A", "B", "C"):
        assert np.array_equal(getattr(tableau, name), getattr(DOP853, name))
    assert np.array_equal(tableau.E5, DOP853.E5[: tableau.STAGES])
    assert np.array_equal(tableau.E3, DOP853.E3[: tableau.STAGES])


def test_quadrature_conditions_to_order_8() -> None:
    for q in range(8):
        assert tableau.B @ tableau.C**q == pytest.approx(1 / (q + 1), abs=2e-15)


def test_stages_are_consistent() -> None:
    np.testing.assert_allclose(tableau.A.sum(axis=1), tableau.C, atol=2e-15)
    assert np.triu(tableau.A).max() == 0.0


def test_linear_order_conditions() -> None:
    """The tall trees, bᵀ A^{q−1} 1 = 1/q!, which are what a linear system with constant coefficients sees."""
    vector, factorial = np.ones(tableau.STAGES), 1.0
    for q in range(1, tableau.ORDER + 1):
        factorial *= q
        assert tableau.B @ vector == pytest.approx(1 / factorial, rel=1e-13)
        vector = tableau.A @ vector


def test_error_weights_vanish_on_constants_and_see_more() -> None:
    for weights, order in ((tableau.E5, 5), (tableau.E3, 3)):
        for q in range(order):
            assert abs(weights @ tableau.C**q) < 1e-13
        assert abs(weights @ tableau.C**8) > 1e-6


def run(sampled: ReducedSystem, sigma: complex, Y: np.ndarray, dY: np.ndarray | None = None, kernel=transport.transport):
    Y, slope = Y.copy(), np.zeros_like(Y) if dY is None else dY.copy()
    errors = np.empty(len(sampled.P))
    log_det, trace = kernel(sampled, sigma, Y, slope, True, errors)
    return Y, slope, log_det, trace, errors


def det_and_slope(W: np.ndarray, result: tuple) -> tuple[complex, complex]:
    Y, dY, log_det, trace, _ = result
    M = W @ Y
    return np.linalg.det(M) * np.exp(log_det), trace + np.trace(np.linalg.solve(M, W @ dY))


def test_transport_is_the_matrix_exponential_in_any_direction() -> None:
    A, dA, Y, W = random_complex(5, 5), random_complex(5, 5), random_complex(5, 2), random_complex(2, 5)
    sigma, length = 0.3 - 0.2j, 0.8 + 0.6j
    D, slope = det_and_slope(W, run(constant(A, dA, length, 60), sigma, Y))

    def exact(s: complex) -> complex:
        return np.linalg.det(W @ scipy.linalg.expm(length * (A + s * dA)) @ Y)

    assert pytest.approx(exact(sigma), rel=1e-11) == D
    eps = 1e-5
    difference = (np.log(exact(sigma + eps)) - np.log(exact(sigma - eps))) / (2 * eps)
    assert slope == pytest.approx(difference, rel=1e-8)


def test_observed_order_is_8() -> None:
    A, Y, W = random_complex(4, 4), random_complex(4, 2), random_complex(2, 4)
    exact = np.linalg.det(W @ scipy.linalg.expm(2.0 * A) @ Y)
    errors = [abs(det_and_slope(W, run(constant(A, 0 * A, 2.0, steps), 0j, Y))[0] / exact - 1) for steps in (4, 8)]
    assert np.log2(errors[0] / errors[1]) == pytest.approx(8.0, abs=0.9)


def test_frame_leaves_orthonormal_and_strong_growth_does_not_overflow() -> None:
    A = np.diag([300.0, 200.0, -100.0, -400.0]).astype(complex)
    Y, _, log_det, _, _ = run(constant(A, 0 * A, 10.0, 4000), 0j, random_complex(4, 2))
    np.testing.assert_allclose(Y.conj().T @ Y, np.eye(2), atol=1e-14)
    assert log_det == pytest.approx(5000.0, rel=1e-2)


def test_a_scheme_on_a_fixed_mesh_is_analytic_however_coarse() -> None:
    """Cauchy–Riemann: the derivative along the imaginary axis is i times that along the real one, and both are the exact slope."""
    A, dA, Y, W = random_complex(5, 5), random_complex(5, 5), random_complex(5, 3), random_complex(3, 5)
    table, eps = constant(A, dA, 1.0, 2), 1e-4

    def log_D(s: complex) -> complex:
        return np.log(det_and_slope(W, run(table, s, Y))[0])

    s = 0.1 + 0.2j
    along_real = (log_D(s + eps) - log_D(s - eps)) / (2 * eps)
    along_imag = (log_D(s + 1j * eps) - log_D(s - 1j * eps)) / (2j * eps)
    assert along_imag == pytest.approx(along_real, rel=1e-6)
    assert det_and_slope(W, run(table, s, Y))[1] == pytest.approx(along_real, rel=1e-6)


def random_system(n: int, m: int, degree: int, steps: int, real: bool = False) -> tuple[ReducedSystem, Callable[[complex], np.ndarray]]:
    """A system constant along the path, with zeros in it, and its A as a dense function of σ."""
    make = RNG.standard_normal if real else lambda shape: random_complex(*shape)
    q = max(2, degree)
    X, V, G, T = make((q, n, n)), make((n, m)), make((q, m, m)), make((degree + 1, m, n))
    X[:, 0, 1], V[n - 1], T[:, :, 0] = 0, 0, 0
    G[0] += 3 * np.eye(m)
    everywhere = (np.broadcast_to(a, (steps, 12, *a.shape)).astype(complex) for a in (X, V, G, T))

    def dense(s: complex) -> np.ndarray:
        rest, gamma, tau = (sum(s**j * M for j, M in enumerate(part)) for part in (X, G, T))
        return np.asarray(rest + V @ np.linalg.solve(gamma, tau))

    return sample(np.full(steps, 1 / steps, complex), *everywhere), dense


@pytest.mark.parametrize(("m", "degree"), [(0, 1), (0, 4), (1, 1), (1, 2), (3, 2), (2, 5)])
def test_sampled_system_equals_its_dense_form(m: int, degree: int) -> None:
    n, sigma = 5, 0.2 + 0.1j
    sampled, dense = random_system(n, m, degree, 1)
    A, dA = np.empty((n, n), complex), np.empty((n, n), complex)
    for kernel in (system.system_matrix, system.system_matrix.py_func):
        kernel(sampled, 0, 7, sigma, A, dA, system.workspace(sampled, n))
        np.testing.assert_allclose(A, dense(sigma), rtol=1e-11)
        np.testing.assert_allclose(dA, (dense(sigma + 1e-5) - dense(sigma - 1e-5)) / 2e-5, rtol=1e-6, atol=1e-8)


@pytest.mark.parametrize(("m", "degree", "k"), [(1, 1, 4), (1, 2, 3), (2, 2, 5), (2, 1, 1), (2, 4, 2), (0, 3, 3)])
def test_transport_through_a_resolvent(m: int, degree: int, k: int) -> None:
    n, sigma = 6, 0.2 - 0.1j
    sampled, dense = random_system(n, m, degree, 40)
    Y, W = random_complex(n, k), random_complex(k, n)
    D, slope = det_and_slope(W, run(sampled, sigma, Y))

    def exact(s: complex) -> complex:
        return np.linalg.det(W @ scipy.linalg.expm(dense(s)) @ Y)

    assert pytest.approx(exact(sigma), rel=1e-9) == D
    assert slope == pytest.approx((np.log(exact(sigma + 1e-5)) - np.log(exact(sigma - 1e-5))) / 2e-5, rel=1e-6)


def test_real_arithmetic_gives_the_same() -> None:
    sampled, _ = random_system(6, 1, 1, 20, real=True)
    real = sampled.in_real_numbers()
    Y, dY = RNG.standard_normal((6, 3)), RNG.standard_normal((6, 3))
    complex_result = run(sampled, 0.3 + 0j, Y.astype(complex), dY.astype(complex))
    for a, b in zip(run(real, 0.3, Y, dY), complex_result, strict=True):
        np.testing.assert_allclose(a, b, rtol=1e-11, atol=1e-13)


def test_a_nan_is_an_error_not_a_zero() -> None:
    A = random_complex(3, 3)
    errors = run(spoilt(constant(A, 0 * A, 1.0, 3)), 0j, random_complex(3, 2))[4]
    assert np.isfinite(errors[0])
    assert np.isnan(errors[1])


def uncompiled(monkeypatch: pytest.MonkeyPatch, module: ModuleType) -> None:
    """Every compiled function that a module has or imports, as plain Python."""
    for name, kernel in list(vars(module).items()):
        if hasattr(kernel, "py_func"):
            monkeypatch.setattr(module, name, kernel.py_func)


@pytest.mark.parametrize("real", [False, True])
def test_compiled_equals_uncompiled(monkeypatch: pytest.MonkeyPatch, real: bool) -> None:
    sampled, _ = random_system(4, 2, 2, 2, real)
    Y, sigma = random_complex(4, 2), 0.3j
    if real:
        sampled, Y, sigma = sampled.in_real_numbers(), Y.real.copy(), 0.3
    compiled = run(sampled, sigma, Y)
    uncompiled(monkeypatch, transport)
    for a, b in zip(compiled, run(sampled, sigma, Y, kernel=transport.transport), strict=True):
        np.testing.assert_allclose(a, b, rtol=1e-9, atol=1e-12)


def test_series_at_a_regular_singular_point(monkeypatch: pytest.MonkeyPatch) -> None:
    """C(x) x P′ + C(x) P Λ = D(x) P, term by term, and the σ-derivative by differences; compiled and uncompiled."""
    n, k, terms, rate = 4, 2, 6, 0.3
    C, D = random_complex(2, terms, n, n), random_complex(2, terms, n, n)
    C[:, :, 0, 1] = D[:, :, 2, 3] = 0
    left, right = np.array([1, 0.5j]), np.array([0.5j, -1]) * (-0.7)
    Lam = rate * np.eye(k) + np.outer(left, right)
    assert abs(left @ right) < 1e-15
    P0, dP0 = random_complex(n, k), random_complex(n, k)
    system = regular_singular.recurrence(C, D)

    def solve(sigma: complex, kernel=regular_singular.series_terms) -> tuple[np.ndarray, np.ndarray]:
        P, dP = np.zeros((terms, n, k), complex), np.zeros((terms, n, k), complex)
        P[0], dP[0] = P0 + sigma * dP0, dP0
        kernel(system, sigma, rate, left, right, P, dP, True)
        return P, dP

    sigma = 0.2 - 0.4j
    P, dP = solve(sigma)
    c, d = C[0] + sigma * C[1], D[0] + sigma * D[1]
    for m in range(1, terms):
        residual = sum(c[j] @ ((m - j) * P[m - j] + P[m - j] @ Lam) - d[j] @ P[m - j] for j in range(m + 1))
        assert np.abs(residual).max() < 1e-10 * max(np.abs(P[: m + 1]).max(), 1.0)
    difference = (solve(sigma + 1e-5)[0] - solve(sigma - 1e-5)[0]) / 2e-5
    np.testing.assert_allclose(dP, difference, rtol=1e-5, atol=1e-6 * np.abs(dP).max())
    np.testing.assert_allclose(regular_singular.series_value(P, 0.3), sum(p * 0.3**m for m, p in enumerate(P)), rtol=1e-13)
    sizes = np.empty(terms)
    regular_singular.row_sizes(P, sizes)
    np.testing.assert_allclose(sizes, (np.abs(P).max(axis=2) / np.abs(P[0]).max(axis=1)).max(axis=1), rtol=1e-13)
    uncompiled(monkeypatch, regular_singular)
    for a, b in zip((P, dP), solve(sigma, regular_singular.series_terms), strict=True):
        np.testing.assert_allclose(a, b, rtol=1e-9, atol=1e-10 * np.abs(a).max())
