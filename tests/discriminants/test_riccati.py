"""Charts of the Grassmannian: exchanges, poles, the transport by the Riccati equation, compiled against uncompiled."""

from __future__ import annotations

import numpy as np
import pytest
import scipy.linalg
from hypothesis import given, settings
from hypothesis import strategies as st
from sampled import constant, spoilt

from shootstab.core.discriminant import Value
from shootstab.discriminants.method import Propagator
from shootstab.discriminants.riccati import Charted, Riccati
from shootstab.discriminants.sampled_system import SampledSystem
from shootstab.discriminants.shooting import Shooting
from shootstab.kernels import riccati_transport as riccati
from shootstab.models.gallery.poiseuille import PlanePoiseuille
from shootstab.problems.protocol import FarFrame

RNG = np.random.default_rng(23)
SIZES = st.tuples(st.integers(1, 4), st.integers(1, 4), st.integers(0, 10**6))


def random_complex(*shape: int, rng: np.random.Generator = RNG) -> np.ndarray:
    return rng.standard_normal(shape) + 1j * rng.standard_normal(shape)


def constant_table(A: np.ndarray, dA: np.ndarray, length: complex, steps: int) -> SampledSystem:
    """The table of ψ′ = (A + σ dA) ψ."""
    return SampledSystem(length * np.arange(steps + 1) / steps, constant(A, dA, length, steps))


def propagate(
    table: SampledSystem, sigma: complex, Y: np.ndarray, W: np.ndarray, method: Propagator | None = None
) -> tuple[Value, np.ndarray]:
    propagation = (method or Riccati(1e-10)).propagate(table, (W.astype(complex), np.zeros(W.shape, complex)), at_infinity(Y), sigma, True)
    return propagation.value, propagation.errors


def at_infinity(Y: np.ndarray) -> FarFrame:
    return FarFrame(Y.astype(complex), np.zeros(Y.shape, complex), 0.0, 0.0)


def number(value: Value) -> complex:
    return complex(value.D.mantissa * np.exp(value.D.log_scale))


@settings(max_examples=40, deadline=None)
@given(SIZES)
def test_an_exchange_is_another_chart_of_the_same_space(sizes: tuple[int, int, int]) -> None:
    """[I; S] with row i and pivot j exchanged is [I; S̃] M, det M = S_ij; the same for its derivative; compiled and uncompiled."""
    rest, k, seed = sizes
    rng = np.random.default_rng(seed)
    i, j = int(rng.integers(rest)), int(rng.integers(k))
    S, dS = random_complex(rest, k, rng=rng), random_complex(rest, k, rng=rng)

    def exchanged(kernel, s: np.ndarray, ds: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        s, ds = s.copy(), ds.copy()
        kernel(s, ds, i, j, True)
        return s, ds

    order = np.arange(k + rest)
    order[[j, k + i]] = order[[k + i, j]]
    Y = np.vstack((np.eye(k), S))[order]
    direct = Y[k:] @ np.linalg.inv(Y[:k])
    assert np.linalg.det(Y[:k]) == pytest.approx(S[i, j])
    for kernel in (riccati.exchange, riccati.exchange.py_func):
        new, slope = exchanged(kernel, S, dS)
        np.testing.assert_allclose(new, direct, rtol=1e-9, atol=1e-9)
        eps = 1e-6 * abs(S[i, j]) ** 2
        ahead, behind = (exchanged(kernel, S + d * dS, dS)[0] for d in (eps, -eps))
        np.testing.assert_allclose(slope, (ahead - behind) / (2 * eps), rtol=1e-5, atol=1e-5 * np.abs(slope).max())
        there_and_back = exchanged(kernel, new, slope)
        np.testing.assert_allclose(there_and_back[0], S, rtol=1e-8, atol=1e-8)


@settings(max_examples=40, deadline=None)
@given(SIZES)
def test_a_frame_enters_a_chart_and_leaves_it(sizes: tuple[int, int, int]) -> None:
    """Y = [I; S] U in the order and the units of the chart, det U and the derivatives with it; compiled and uncompiled."""
    rest, k, seed = sizes
    rng = np.random.default_rng(seed)
    Y, dY, eps = random_complex(k + rest, k, rng=rng), random_complex(k + rest, k, rng=rng), 1e-6
    units, order = rng.uniform(0.5, 1.0, k + rest), rng.permutation(k + rest)
    U = (Y / units[:, None])[order[:k]]
    for enter, leave in ((riccati.enter_chart, riccati.leave_chart), (riccati.enter_chart.py_func, riccati.leave_chart.py_func)):
        S, dS, det, slope = enter(Y, dY, units, order)
        frame, tangent = leave(S, dS, units, order)
        np.testing.assert_allclose(frame @ U, Y, rtol=1e-8, atol=1e-8)
        assert det == pytest.approx(np.linalg.det(U), rel=1e-9)
        small = eps * min(1.0, abs(det)) / max(1.0, np.abs(S).max())
        ahead, behind = (enter(Y + d * dY, dY, units, order) for d in (small, -small))
        np.testing.assert_allclose(dS, (ahead[0] - behind[0]) / (2 * small), rtol=1e-3, atol=1e-3 * np.abs(dS).max())
        assert slope == pytest.approx((ahead[2] - behind[2]) / (2 * small), rel=1e-3, abs=1e-3 * abs(det))
        np.testing.assert_allclose(
            tangent, leave(dS, dS, units, order)[0] - leave(0 * dS, dS, units, order)[0], atol=1e-12 * np.abs(dS).max()
        )


@settings(max_examples=40, deadline=None)
@given(SIZES)
def test_the_riccati_equation_is_that_of_the_chart(sizes: tuple[int, int, int]) -> None:
    """S′ and (ln det U)′ by differences of exp(tA) [I; S], and their derivatives; compiled and uncompiled."""
    rest, k, seed = sizes
    rng = np.random.default_rng(seed)
    A, dA = random_complex(k + rest, k + rest, rng=rng), random_complex(k + rest, k + rest, rng=rng)
    S, dS, eps = random_complex(rest, k, rng=rng), random_complex(rest, k, rng=rng), 1e-4

    def moved(t: float) -> tuple[np.ndarray, complex]:
        Y = scipy.linalg.expm(t * A) @ np.vstack((np.eye(k), S))
        return Y[k:] @ np.linalg.inv(Y[:k]), complex(np.log(np.linalg.det(Y[:k])))

    for multiply, tangent in ((riccati.riccati, riccati.riccati_tangent), (riccati.riccati.py_func, riccati.riccati_tangent.py_func)):
        (out, slope, one, two), M = np.empty((4, 1, rest, k), complex), np.empty((2, k, k), complex)
        trace = multiply(A, S, M, out, 0)
        (ahead, log_ahead), (behind, log_behind) = moved(eps), moved(-eps)
        np.testing.assert_allclose(out[0], (ahead - behind) / (2 * eps), rtol=1e-4, atol=1e-4 * np.abs(out).max())
        assert trace == pytest.approx((log_ahead - log_behind) / (2 * eps), rel=1e-4, abs=1e-4)
        dtrace = tangent(A, dA, S, dS, M, slope, 0)
        difference = multiply(A + eps * dA, S + eps * dS, M, one, 0) - multiply(A - eps * dA, S - eps * dS, M, two, 0)
        np.testing.assert_allclose(slope, (one - two) / (2 * eps), rtol=1e-5, atol=1e-5 * np.abs(slope).max())
        assert dtrace == pytest.approx(difference / (2 * eps), rel=1e-5, abs=1e-5)


def test_transport_is_the_exponential_in_any_direction_and_its_slope_exact() -> None:
    A, dA, Y, W = random_complex(6, 6), random_complex(6, 6), random_complex(6, 3), random_complex(3, 6)
    sigma, length = 0.3 - 0.2j, 0.4 + 0.3j
    value, errors = propagate(constant_table(A, dA, length, 80), sigma, Y, W)

    def exact(s: complex) -> complex:
        return complex(np.linalg.det(W @ scipy.linalg.expm(length * (A + s * dA)) @ Y))

    assert number(value) == pytest.approx(exact(sigma), rel=1e-10)
    assert errors.max() < 1e-8
    difference = (np.log(exact(sigma + 1e-5)) - np.log(exact(sigma - 1e-5))) / 2e-5
    assert value.logarithmic_derivative == pytest.approx(difference, rel=1e-7)


def test_observed_order_is_8() -> None:
    A, Y, W = random_complex(4, 4) / 2, random_complex(4, 2), random_complex(2, 4)
    exact = np.linalg.det(W @ scipy.linalg.expm(A) @ Y)
    errors = [abs(number(propagate(constant_table(A, 0 * A, 1.0, steps), 0j, Y, W)[0]) / exact - 1) for steps in (8, 16)]
    assert np.log2(errors[0] / errors[1]) == pytest.approx(8.0, abs=1.2)


@pytest.mark.parametrize("turns", [0.3, 5.0, 40.25])
def test_poles_are_passed(turns: float) -> None:
    """ψ′ = [[0, −1], [1, 0]] ψ: S = tan z has a pole in every half turn, D = cos z or sin z has none; the phase of det U is kept."""
    A, z = np.array([[0, -1], [1, 0]], complex), 2 * np.pi * turns
    table = constant_table(A, A, z, round(60 * turns) + 10)
    Y = np.array([[1.0], [0.0]])
    cosine, errors = propagate(table, 0j, Y, np.array([[1.0, 0.0]]))
    sine = propagate(table, 0j, Y, np.array([[0.0, 1.0]]))[0]
    assert errors.max() < 1e-5
    assert number(cosine) == pytest.approx(np.cos(z), abs=1e-6)
    assert number(sine) == pytest.approx(np.sin(z), abs=1e-6)
    assert sine.dD * np.exp(sine.D.log_scale) == pytest.approx(z * np.cos(z), abs=1e-4)


def test_strong_growth_does_not_overflow() -> None:
    A = np.diag([300.0, 200.0, -100.0, -400.0]).astype(complex)
    value, errors = propagate(constant_table(A, 0 * A, 10.0, 4000), 0j, random_complex(4, 2), random_complex(2, 4))
    assert value.D.log_abs == pytest.approx(5000.0, rel=1e-2)
    assert np.isfinite(errors).all()


def test_growth_of_the_complement_is_no_harm() -> None:
    """S grows as e^(300 z) until the chart changes."""
    A = np.diag([-300.0, 200.0]).astype(complex)
    Y, W = np.array([[1.0], [1e-30]]), random_complex(1, 2)
    value, _ = propagate(constant_table(A, 0 * A, 1.0, 4000), 0j, Y, W)
    assert value.D.log_abs == pytest.approx(200 + np.log(1e-30 * abs(W[0, 1])), rel=1e-6)


def test_a_nan_is_an_error_not_a_zero() -> None:
    A = random_complex(3, 3)
    table = constant_table(A, 0 * A, 1.0, 3)
    table = SampledSystem(table.nodes, spoilt(table.system))
    errors = propagate(table, 0j, random_complex(3, 2), random_complex(2, 3))[1]
    assert np.isfinite(errors[0])
    assert np.isnan(errors[1])


def test_in_the_same_charts_D_is_analytic_however_coarse_the_mesh() -> None:
    """Cauchy–Riemann by differences along both axes, against the slope, at points where other charts would be chosen."""
    rng = np.random.default_rng(5)  # of its own: for some matrices S grows on the way to another sigma, and the charts change
    A, dA, Y, W = (random_complex(*shape, rng=rng) for shape in ((5, 5), (5, 5), (5, 2), (2, 5)))
    table, eps = constant_table(A, dA, 2.0, 8), 1e-4
    method = Riccati(1e-3).fixed_at(table, at_infinity(Y), 0.1j)
    for s in (0.1 + 0.2j, 0.3 - 0.1j, -0.2 + 0.1j):

        def log_D(sigma: complex) -> complex:
            value, _ = propagate(table, sigma, Y, W, method)
            return complex(np.log(value.D.mantissa) + value.D.log_scale)

        along = [(log_D(s + d) - log_D(s - d)) / (2 * d) for d in (eps, 1j * eps)]
        assert along[1] == pytest.approx(along[0], rel=1e-6)
        assert propagate(table, s, Y, W, method)[0].logarithmic_derivative == pytest.approx(along[0], rel=1e-6)


def test_charts_serve_a_halved_mesh_and_are_not_sound_where_S_grows() -> None:
    A = np.array([[0, -1], [1, 0]], complex)
    Y, W = np.array([[1.0], [0.2]]), np.array([[1.0, 0.0]])
    coarse, fine = (constant_table(A, A, 3.0, steps) for steps in (30, 60))
    method = Riccati(1e-8).fixed_at(coarse, at_infinity(Y), 0j)
    assert len(method.charts.z) > 0
    assert method.fixed_at(fine, at_infinity(Y), 0.5j) is method
    rows = W.astype(complex), np.zeros(W.shape, complex)
    for table in (coarse, fine):
        propagation = method.propagate(table, rows, at_infinity(Y), 0j, True)
        assert propagation.sound
        assert number(propagation.value) == pytest.approx(np.cos(3.0) - 0.2 * np.sin(3.0), abs=1e-6)
    # at another sigma the pole is elsewhere: near the old change of chart S is large
    assert not method.propagate(coarse, rows, at_infinity(Y), 0.55 + 0j, True).sound
    anew = Riccati(1e-8).fixed_at(coarse, at_infinity(Y), 0.55)
    assert number(propagate(coarse, 0.55 + 0j, Y, W, anew)[0]) == pytest.approx(np.cos(3 * 1.55) - 0.2 * np.sin(3 * 1.55), abs=1e-6)


def test_riccati_settles_its_charts_with_the_mesh_and_stays_the_same() -> None:
    method = Riccati(rtol=1e-8)
    shooting = method.on(PlanePoiseuille()).at(-0.2375j)
    assert isinstance(shooting, Shooting)
    assert isinstance(shooting.propagator, Charted)
    assert method == Riccati(rtol=1e-8)
    assert shooting.refined()(-0.2375j).over(shooting(-0.2375j)) == pytest.approx(1.0, abs=1e-6)


NESTED = (
    "gather",
    "riccati",
    "riccati_tangent",
    "set_block",
    "add_product",
    "subtract_product",
    "trace",
    "exchange",
    "farthest",
    "local_error",
    "error_of_step",
)


def test_compiled_equals_uncompiled(monkeypatch: pytest.MonkeyPatch) -> None:
    table, S, dS = constant_table(random_complex(4, 4), random_complex(4, 4), 1.0, 3), random_complex(2, 2), random_complex(2, 2)

    def run(kernel) -> list:
        order, s, ds, errors = np.arange(4), S.copy(), dS.copy(), np.empty(3)
        units, swaps = np.array([0.5, 0.6, 0.7, 1.0]), np.empty((0, 3), dtype=np.int64)
        answer = kernel(table.system, 0.3j, units, order, s, ds, True, errors, swaps, True)
        return [*answer, order, s, ds, errors]

    compiled = run(riccati.transport_chart)
    for name in NESTED:
        monkeypatch.setattr(riccati, name, getattr(riccati, name).py_func)
    for a, b in zip(compiled, run(riccati.transport_chart.py_func), strict=True):
        np.testing.assert_allclose(a, b, rtol=1e-6, atol=1e-12)
