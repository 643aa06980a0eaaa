"""Many σ through one sampled system: each as by itself, whatever its neighbours, compiled and uncompiled."""

from __future__ import annotations

import batched_transport
import numpy as np
import pytest
from sampled import constant

from shootstab.kernels.frame_transport import transport

LANES = 8
SIGMAS = 0.3 - 0.2j + 0.1 * np.exp(2j * np.pi * np.arange(LANES) / LANES)


def given() -> tuple:
    random = np.random.default_rng(7)
    A, dA, Y, dY = (random.standard_normal((5, columns)) + 1j * random.standard_normal((5, columns)) for columns in (5, 5, 2, 2))
    return constant(A, dA, 0.8 + 0.6j, 3), np.repeat(Y[None], LANES, 0), np.repeat(dY[None], LANES, 0)


@pytest.mark.parametrize("tangent", [False, True])
def test_a_lane_is_what_the_kernel_makes_of_its_sigma(tangent: bool) -> None:
    system, Y, dY = given()
    frames, tangents, log_det, trace = batched_transport.transport(system, SIGMAS, Y, dY, tangent)
    for i, sigma in enumerate(SIGMAS.tolist()):
        y, dy = Y[i].copy(), dY[i].copy()
        log, along = transport(system, sigma, y, dy, tangent, np.empty(len(system.P)))
        assert log_det[i] == pytest.approx(log, rel=1e-13)
        np.testing.assert_allclose(frames[i], y, atol=1e-13)
        if tangent:
            assert trace[i] == pytest.approx(along, rel=1e-11)
            np.testing.assert_allclose(tangents[i], dy, atol=1e-11)


def test_no_bit_depends_on_the_neighbours() -> None:
    system, Y, dY = given()
    order = np.random.default_rng(3).permutation(LANES)
    one = batched_transport.transport(system, SIGMAS, Y, dY, True)
    other = batched_transport.transport(system, SIGMAS[order], Y, dY, True)
    for a, b in zip(one, other, strict=True):
        assert np.array_equal(a[order], b)


def test_compiled_is_uncompiled(monkeypatch: pytest.MonkeyPatch) -> None:
    system, Y, dY = given()
    compiled = batched_transport.transport(system, SIGMAS[:2], Y[:2], dY[:2], True)
    for name in ("carry", "add_product", "orthonormalize"):
        monkeypatch.setattr(batched_transport, name, getattr(batched_transport, name).py_func)
    for a, b in zip(compiled, batched_transport.transport(system, SIGMAS[:2], Y[:2], dY[:2], True), strict=True):
        np.testing.assert_allclose(a, b, atol=1e-12)
