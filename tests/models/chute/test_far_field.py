"""The series of the far field: it solves the system at every order, exactly in σ, and begins with the exponents of (2.20)–(2.22)."""

from __future__ import annotations

import math
from functools import cache

import numpy as np
import pytest

from shootstab.models.chute.background import background
from shootstab.models.chute.balance import slopes
from shootstab.models.chute.far_field import (
    FAR_TERMS,
    TURNED_SOLUTIONS,
    TURNED_STATES,
    FarField,
    decay_matrix,
    flow_series,
)
from shootstab.models.chute.first_order_system import DECAYING, SIZE, pencil_entries
from shootstab.models.chute.parameters import Chute

CHUTE, TEMPERATURE, VELOCITY = Chute(e=0.8, e_w=0.7, r=0.6, tan_theta=0.3), 1.3, 2.1
WAVES = [(0.3, 0.2), (0.0, 0.25), (0.2, 0.0)]
SIGMAS = [0.4 - 0.7j, 0.3 + 0j]


def phases(count: int, turned: list[int]) -> np.ndarray:
    return np.where(np.isin(np.arange(count), turned), 1j, 1.0)


@cache
def matrices(kx: float, ky: float, sigma: complex) -> tuple[np.ndarray, ...]:
    """(ν0′/ν0)C, D and their σ-derivatives, each (FAR_TERMS, 8, 8), as series in ν0."""
    bg = background(CHUTE, *flow_series(CHUTE, TEMPERATURE, VELOCITY, FAR_TERMS, math.pi), math.pi)
    parts = []
    for entries, factor in zip(pencil_entries(bg, CHUTE.tan_theta, kx, ky), (bg.decay[0], bg.decay[0], 1, 1), strict=True):
        out = np.zeros((FAR_TERMS, SIZE, SIZE), complex)
        for place, entry in entries.items():
            out[:, *place] = [complex(c) for c in (entry * factor).coefficients]
        parts.append(out)
    C0, C1, D0, D1 = parts
    return C0 + sigma * C1, D0 + sigma * D1, C1, D1


def residual(C: np.ndarray, D: np.ndarray, P: np.ndarray, powers: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Σ_j C_j ((m−j) P_{m−j} + P_{m−j} Λ) − D_j P_{m−j} for every m, and the sizes of what is summed."""
    rest, size = np.zeros(P.shape, complex), np.zeros(P.shape)
    for m in range(len(P)):
        for j in range(m + 1):
            turned = (m - j) * P[m - j] + P[m - j] @ powers
            rest[m] += C[j] @ turned - D[j] @ P[m - j]
            size[m] += np.abs(C[j]) @ (np.abs((m - j) * P[m - j]) + np.abs(P[m - j]) @ np.abs(powers)) + np.abs(D[j]) @ np.abs(P[m - j])
    return rest, size


@pytest.mark.parametrize("sigma", SIGMAS)
@pytest.mark.parametrize(("kx", "ky"), WAVES)
def test_the_series_solves_the_system_and_its_tangent_the_derivative_of_it(kx: float, ky: float, sigma: complex) -> None:
    """Λ by what P_0 makes of the system at infinity: D_0 P_0 = C_0 P_0 Λ."""
    far = FarField(CHUTE, TEMPERATURE, VELOCITY, kx, ky)
    back = phases(SIZE, TURNED_STATES)[:, None] / phases(DECAYING, TURNED_SOLUTIONS)
    P, dP = (back * terms for terms in far.terms(sigma))
    C, D, dC, dD = matrices(kx, ky, sigma)
    powers = np.linalg.lstsq(C[0] @ P[0], D[0] @ P[0], rcond=None)[0]
    exponent = TEMPERATURE * math.hypot(kx, ky)
    np.testing.assert_allclose(np.linalg.matrix_power(powers - exponent * np.eye(DECAYING), 2), 0, atol=1e-13)  # defective
    assert far.trace == pytest.approx(DECAYING * exponent, rel=1e-14)
    rest, size = residual(C, D, P, powers)
    assert np.all(np.abs(rest) <= 2e-15 * size.max(axis=2, keepdims=True) + 1e-300), np.abs(rest / size.max(axis=2, keepdims=True)).max()
    rest, size = residual(C, D, dP, powers)
    given, given_size = residual(dC, dD, P, powers)
    assert np.all(np.abs(rest + given) <= 2e-15 * (size + given_size).max(axis=2, keepdims=True) + 1e-300)


@pytest.mark.parametrize(("kx", "ky"), WAVES)
def test_the_exponents_are_those_of_2_20_to_2_22(kx: float, ky: float) -> None:
    """e^{−Bz}α is divergence-free of stress: B = K I − s sᵀ/(7K), s·s = 0, so that B s = K s and (B − K)² = 0; T̂ decays as e^{−Kz}."""
    K, s = math.hypot(kx, ky), np.array([1j * kx, 1j * ky, -math.hypot(kx, ky)])
    B = decay_matrix(kx, ky)
    np.testing.assert_allclose(B[:3, :3], K * np.eye(3) - np.outer(s, s) / (7 * K), atol=1e-16)
    np.testing.assert_allclose(B[:3, :3] @ s, K * s, atol=1e-16)
    assert np.array_equal(B[3], [0, 0, 0, K]) and np.array_equal(B[:, 3], [0, 0, 0, K])


def test_the_series_of_the_flow_obeys_the_steady_equations_at_every_order() -> None:
    """x dT/dx = T′/(ν0′/ν0), x du/dx likewise, and x dQ/dx = Q′/(ν0′/ν0)."""
    nu, T, u, Q = flow_series(CHUTE, TEMPERATURE, VELOCITY, FAR_TERMS, math.pi)
    decay, T_z, u_z, Q_z = slopes(nu, T, Q, CHUTE.ep, CHUTE.tan_theta, CHUTE.radial_law, math.pi)
    assert (T[0], u[0], Q[0], nu[1]) == (TEMPERATURE, VELOCITY, 0.0, 1.0)
    for field, slope in ((T, T_z), (u, u_z), (Q, Q_z)):
        turned = type(field)(m * field[m] for m in range(FAR_TERMS))
        left, right = turned * decay, slope
        for m in range(FAR_TERMS):
            assert left[m] == pytest.approx(right[m], rel=1e-12, abs=1e-13 * abs(turned[m] * decay[0])), m
