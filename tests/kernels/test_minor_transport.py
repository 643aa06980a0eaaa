"""Exterior algebra for any n and k, and the transport of Plücker coordinates: identities, observed order, compiled against uncompiled."""

from __future__ import annotations

import math

import numpy as np
import pytest
import scipy.linalg
from hypothesis import given, settings
from hypothesis import strategies as st
from sampled import between, constant, spoilt

from shootstab.kernels import exterior
from shootstab.kernels import minor_transport as compound
from shootstab.kernels.exterior import induced, minors_with_slope
from shootstab.kernels.reduced_system import ReducedSystem

RNG = np.random.default_rng(17)
SIZES = st.integers(2, 6).flatmap(lambda n: st.tuples(st.just(n), st.integers(1, n - 1), st.integers(0, 10**6)))
proved = settings(max_examples=40, deadline=None)


def random_complex(*shape: int, rng: np.random.Generator = RNG) -> np.ndarray:
    return rng.standard_normal(shape) + 1j * rng.standard_normal(shape)


def minors(Y: np.ndarray, subsets: np.ndarray) -> np.ndarray:
    return np.linalg.det(Y[subsets])


def dense(A: np.ndarray, k: int) -> np.ndarray:
    """A^(k), column by column."""
    lists = induced(len(A), k)
    out = np.zeros((len(lists.subsets),) * 2, complex)
    for c in range(len(out)):
        exterior.apply(A, *lists[1:], np.eye(len(out), dtype=complex)[c], out, c)
    return out.T


def power(M: np.ndarray, k: int) -> np.ndarray:
    """∧^k M: the minors M[I, J]."""
    subsets = induced(len(M), k).subsets
    return np.column_stack([minors(M[:, J], subsets) for J in subsets])


def random_table(n: int, steps: int, length: complex) -> ReducedSystem:
    P, Q, R = (random_complex(n, n) for _ in range(3))
    return between((P, Q, R), 0.0, length, steps)


def propagate(table: ReducedSystem, sigma: complex, Y: np.ndarray, kernel=compound.transport_minors):
    """y, dy, log_scale, errors from the frame Y, whose σ-derivative is 0."""
    lists = induced(*Y.shape)
    y, errors = minors(Y, lists.subsets), np.empty(len(table.P))
    dy = np.zeros_like(y)
    log_scale = kernel(table, sigma, *lists, y, dy, True, errors)
    return y, dy, log_scale, errors


def test_the_lists_of_the_chute_and_of_orr_sommerfeld_are_as_long_as_they_must_be() -> None:
    for n, k, coordinates in ((8, 4, 70), (4, 2, 6), (6, 3, 20)):
        lists = induced(n, k)
        assert len(lists.subsets) == coordinates
        assert len(lists.row) == n * math.comb(n - 1, k - 1) + n * (n - 1) * math.comb(n - 2, k - 1)
        with pytest.raises(ValueError, match="read-only"):
            lists.row[0] = 1


def test_the_printed_matrix_for_n_4_k_2() -> None:
    """Allen & Bridges, Numer. Math. 92 (2002) 197: coordinates 12, 13, 14, 23, 24, 34."""
    A = random_complex(4, 4)
    a = {(i + 1, j + 1): A[i, j] for i in range(4) for j in range(4)}
    printed = [
        [a[1, 1] + a[2, 2], a[2, 3], a[2, 4], -a[1, 3], -a[1, 4], 0],
        [a[3, 2], a[1, 1] + a[3, 3], a[3, 4], a[1, 2], 0, -a[1, 4]],
        [a[4, 2], a[4, 3], a[1, 1] + a[4, 4], 0, a[1, 2], a[1, 3]],
        [-a[3, 1], a[2, 1], 0, a[2, 2] + a[3, 3], a[3, 4], -a[2, 4]],
        [-a[4, 1], 0, a[2, 1], a[4, 3], a[2, 2] + a[4, 4], a[2, 3]],
        [0, -a[4, 1], a[3, 1], -a[4, 2], a[3, 2], a[3, 3] + a[4, 4]],
    ]
    np.testing.assert_allclose(dense(A, 2), printed, rtol=1e-15)


@proved
@given(SIZES)
def test_the_induced_matrix_generates_the_exterior_power(sizes: tuple[int, int, int]) -> None:
    """∧^k exp(A) = exp(A^(k))."""
    n, k, seed = sizes
    A = random_complex(n, n, rng=np.random.default_rng(seed)) / n
    np.testing.assert_allclose(scipy.linalg.expm(dense(A, k)), power(scipy.linalg.expm(A), k), atol=1e-11)


@proved
@given(SIZES)
def test_exterior_powers_multiply_and_induced_matrices_commute_alike(sizes: tuple[int, int, int]) -> None:
    """Cauchy–Binet: ∧^k(AB) = ∧^k A ∧^k B and minors(Wᵀ)·minors(Y) = det(WY); [A, B]^(k) = [A^(k), B^(k)]; tr A^(k) = C(n−1, k−1) tr A."""
    n, k, seed = sizes
    rng = np.random.default_rng(seed)
    A, B, W, Y = random_complex(n, n, rng=rng), random_complex(n, n, rng=rng), random_complex(k, n, rng=rng), random_complex(n, k, rng=rng)
    subsets = induced(n, k).subsets
    np.testing.assert_allclose(power(A @ B, k), power(A, k) @ power(B, k), atol=1e-9)
    assert minors(W.T, subsets) @ minors(Y, subsets) == pytest.approx(np.linalg.det(W @ Y), abs=1e-9)
    Ak, Bk = dense(A, k), dense(B, k)
    np.testing.assert_allclose(dense(A @ B - B @ A, k), Ak @ Bk - Bk @ Ak, atol=1e-10)
    assert np.trace(Ak) == pytest.approx(math.comb(n - 1, k - 1) * np.trace(A), abs=1e-11)


@proved
@given(SIZES)
def test_minors_move_as_their_frame_does(sizes: tuple[int, int, int]) -> None:
    """The derivative of the minors of exp(tA) Y at t = 0 is A^(k) y, by columns as well; compiled and uncompiled."""
    n, k, seed = sizes
    rng = np.random.default_rng(seed)
    A, Y = random_complex(n, n, rng=rng), random_complex(n, k, rng=rng)
    lists = induced(n, k)
    y, slope = minors_with_slope(Y, A @ Y, lists.subsets)
    np.testing.assert_allclose(y, minors(Y, lists.subsets), atol=1e-12)
    np.testing.assert_allclose((y, slope), minors_with_slope.py_func(Y, A @ Y, lists.subsets), atol=1e-12)
    for kernel in (exterior.apply, exterior.apply.py_func):
        out = np.zeros((1, len(y)), complex)
        kernel(A, *lists[1:], y, out, 0)
        np.testing.assert_allclose(out[0], slope, atol=1e-10)


@proved
@given(SIZES)
def test_row_sizes_are_those_of_an_orthonormal_frame(sizes: tuple[int, int, int]) -> None:
    """And no minor of it is larger than the product of its rows (Hadamard)."""
    n, k, seed = sizes
    rng = np.random.default_rng(seed)
    Y = random_complex(n, k, rng=rng) * 10.0 ** rng.integers(-5, 5, (n, 1))
    Q = np.linalg.qr(Y)[0]
    subsets = induced(n, k).subsets
    y = minors(Q, subsets)
    for kernel in (exterior.row_sizes, exterior.row_sizes.py_func):
        r = np.empty(n)
        assert kernel(3 * y, subsets, r) == pytest.approx(9.0)
        np.testing.assert_allclose(r, np.linalg.norm(Q, axis=1), rtol=1e-7, atol=1e-9)
        assert (np.abs(y) <= r[subsets].prod(axis=1) * (1 + 1e-6) + 1e-12).all()


def test_transport_is_the_exponential_in_any_direction_and_its_slope_exact() -> None:
    A, dA, Y, W = random_complex(6, 6), random_complex(6, 6), random_complex(6, 3), random_complex(3, 6)
    sigma, length = 0.3 - 0.2j, 0.4 + 0.3j
    y, dy, log_scale, errors = propagate(constant(A, dA, length, 60), sigma, Y)
    w = minors(W.T, induced(6, 3).subsets)

    def exact(s: complex) -> complex:
        return complex(np.linalg.det(W @ scipy.linalg.expm(length * (A + s * dA)) @ Y))

    assert w @ y * np.exp(log_scale) == pytest.approx(exact(sigma), rel=1e-11)
    assert errors.max() < 1e-9
    difference = (np.log(exact(sigma + 1e-5)) - np.log(exact(sigma - 1e-5))) / 2e-5
    assert (w @ dy) / (w @ y) == pytest.approx(difference, rel=1e-7)


def test_observed_order_is_8() -> None:
    A, Y, W = random_complex(4, 4), random_complex(4, 2), random_complex(2, 4)
    exact, w = np.linalg.det(W @ scipy.linalg.expm(A) @ Y), minors(W.T, induced(4, 2).subsets)
    errors = []
    for steps in (4, 8):
        y, _, log_scale, _ = propagate(constant(A, 0 * A, 1.0, steps), 0j, Y)
        errors.append(abs(w @ y * np.exp(log_scale) / exact - 1))
    assert np.log2(errors[0] / errors[1]) == pytest.approx(8.0, abs=1.2)


def test_plucker_relations_are_kept() -> None:
    """y12 y34 − y13 y24 + y14 y23 = 0 for n = 4, k = 2, along a system that varies."""
    y, _, _, errors = propagate(random_table(4, 80, 2.0), 0.3j, random_complex(4, 2))
    assert errors.max() < 1e-8
    assert abs(y[0] * y[5] - y[1] * y[4] + y[2] * y[3]) < 1e-10


@pytest.mark.parametrize(("n", "k"), [(4, 2), (5, 2), (8, 4)])
def test_D_does_not_depend_on_the_place_of_matching(n: int, k: int) -> None:
    """y from the far end and u ∈ ∧^(n−k) from the wall meet anywhere: (y ∧ u)(z) exp(∫ tr A from z to the wall) is the same."""
    system, sigma, wall = tuple(random_complex(n, n) for _ in range(3)), 0.2 - 0.1j, 1.5
    Y, U = random_complex(n, k), random_complex(n, n - k)
    # y ∧ u = Σ ± y_I u_J over complementary I and J
    other = {frozenset(J): place for place, J in enumerate(map(tuple, induced(n, n - k).subsets.tolist()))}
    places, signs = [], []
    for rows in map(tuple, induced(n, k).subsets.tolist()):
        rest = sorted(set(range(n)) - set(rows))
        places.append(other[frozenset(rest)])
        signs.append(np.linalg.det(np.eye(n)[[*rows, *rest]]))
    traces = [np.trace(M) for M in system]
    values = []
    for z in (0.0, 0.4, 1.1, wall):
        y, _, down, _ = propagate(between(system, 0.0, z, round(80 * z)), sigma, Y)
        u, _, up, _ = propagate(between(system, wall, z, round(80 * (wall - z))), sigma, U)
        growth = (
            traces[0] * (np.sin(wall) - np.sin(z)) - traces[1] * (np.cos(2 * wall) - np.cos(2 * z)) / 2 + sigma * traces[2] * (wall - z)
        )
        values.append(np.array(signs) * y @ u[places] * np.exp(down + up + growth))
    np.testing.assert_allclose(values, values[0], rtol=1e-8)


def test_strong_growth_does_not_overflow() -> None:
    A = np.diag([300.0, 200.0, -100.0, -400.0]).astype(complex)
    y, _, log_scale, _ = propagate(constant(A, 0 * A, 10.0, 4000), 0j, random_complex(4, 2))
    assert 1.0 <= np.abs(y).max() < 2.0
    assert log_scale == pytest.approx(5000.0, rel=1e-2)


def test_on_a_fixed_mesh_D_is_analytic_however_coarse() -> None:
    """Cauchy–Riemann by differences along both axes, against the slope."""
    table, Y, W = random_table(5, 3, 1.0), random_complex(5, 3), random_complex(3, 5)
    w, s, eps = minors(W.T, induced(5, 3).subsets), 0.1 + 0.2j, 1e-4

    def log_D(sigma: complex) -> complex:
        y, _, log_scale, _ = propagate(table, sigma, Y)
        return complex(np.log(w @ y) + log_scale)

    along = [(log_D(s + d) - log_D(s - d)) / (2 * d) for d in (eps, 1j * eps)]
    y, dy, _, _ = propagate(table, s, Y)
    assert along[1] == pytest.approx(along[0], rel=1e-6)
    assert (w @ dy) / (w @ y) == pytest.approx(along[0], rel=1e-6)


def test_errors_of_graded_rows_are_relative_to_their_grade() -> None:
    """A change of units of the state changes no error estimate by more than a small factor."""
    table, Y, units = random_table(4, 6, 0.6), random_complex(4, 2), np.array([1.0, 1e-4, 1e3, 1e-2])
    row = np.searchsorted(table.start, np.arange(16), side="right") - 1
    scaled = table._replace(
        P=table.P * np.concatenate([(units[row] / units[table.column])[at] for at in (np.arange(16), table.linear, table.higher)])
    )
    plain, graded = propagate(table, 0j, Y)[3], propagate(scaled, 0j, units[:, None] * Y)[3]
    assert (np.abs(np.log10(graded / plain)) < 1.5).all()


def test_a_nan_is_an_error_not_a_zero() -> None:
    A = random_complex(3, 3)
    table = spoilt(constant(A, 0 * A, 1.0, 3))
    errors = propagate(table, 0j, random_complex(3, 2))[3]
    assert np.isfinite(errors[0])
    assert np.isnan(errors[1])


def test_compiled_equals_uncompiled(monkeypatch: pytest.MonkeyPatch) -> None:
    table, Y = random_table(4, 2, 0.5), random_complex(4, 2)
    compiled = propagate(table, 0.3j, Y)
    for name in ("halve", "error_of_step", "local_error", "apply", "row_sizes"):
        monkeypatch.setattr(compound, name, getattr(compound, name).py_func)
    for a, b in zip(compiled, propagate(table, 0.3j, Y, compound.transport_minors.py_func), strict=True):
        np.testing.assert_allclose(a, b, rtol=1e-6, atol=1e-13)
