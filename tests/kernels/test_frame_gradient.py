"""kernels/frame_gradient: a step of one vector is that of a frame, compiled and uncompiled."""

from __future__ import annotations

import numpy as np
import pytest
from test_frame_transport import RNG, random_complex, random_system, uncompiled

from shootstab.kernels import frame_gradient
from shootstab.kernels.frame_transport import transport
from shootstab.kernels.tableau import STAGES

N = 3


def arguments(m: int, real: bool) -> tuple[list[np.ndarray], complex]:
    """A system of order 5 with m rows of C that hold σ as `step` takes it, and σ."""
    sampled, _ = random_system(5, m, 3 if m < 2 else 2, N, real)
    sigma: complex = 0.3 if real else 0.3 - 0.2j
    system = sampled.in_real_numbers() if real else sampled
    assert system is not None
    gamma = sum(system.G[:, :, p] * sigma**p for p in range(system.G.shape[2]))
    return [*system[:8], np.ascontiguousarray(np.linalg.inv(gamma))], sigma


def work(given: list[np.ndarray]) -> list[np.ndarray]:
    kind, m = given[6].dtype, given[8].shape[2]
    return [np.empty(shape, kind) for shape in ((STAGES + 2, 5), (STAGES, 5 + m), (STAGES, len(given[1])))]


def ends(given: list[np.ndarray], sigma: complex, begin: np.ndarray, phi: np.ndarray) -> np.ndarray:
    out = np.empty((N, 5), given[6].dtype)
    frame_gradient.ends_of_steps(*given, sigma, begin, phi, out, *work(given))
    return out


@pytest.mark.parametrize("m", [0, 1, 2])
def test_a_step_of_a_vector_is_that_of_a_frame_of_one_column(m: int) -> None:
    sampled, _ = random_system(5, m, 2, N)
    sigma, phi = 0.3 - 0.2j, random_complex(N + 1, 5)
    gamma = sum(sampled.G[:, :, p] * sigma**p for p in range(sampled.G.shape[2]))
    given = [*sampled[:8], np.linalg.inv(gamma)]
    Y = phi[:1].T.copy()
    log_det, _ = transport(sampled, sigma, Y, Y.copy(), False, np.empty(N))
    there = ends(given, sigma, np.array([0, -1, -1]), phi)[-1]
    np.testing.assert_allclose(Y[:, 0] * np.exp(log_det), there, rtol=1e-12)
    single = ends(given, sigma, np.arange(N), phi)
    for s in range(N):
        part = sampled._replace(P=sampled.P[s : s + 1], V=sampled.V[s : s + 1], G=sampled.G[s : s + 1])
        Y = phi[s : s + 1].T.copy()
        log_det, _ = transport(part, sigma, Y, Y.copy(), False, np.empty(1))
        np.testing.assert_allclose(Y[:, 0] * np.exp(log_det), single[s], rtol=1e-12)


@pytest.mark.parametrize("real", [False, True])
@pytest.mark.parametrize("m", [0, 1, 2])
def test_compiled_equals_uncompiled(monkeypatch: pytest.MonkeyPatch, m: int, real: bool) -> None:
    given, sigma = arguments(m, real)
    draw = RNG.standard_normal if real else lambda shape: random_complex(*shape)
    frames, c, row, phi = draw((N + 1, 5, 2)), draw((2,)), draw((5,)), draw((N + 1, 5))

    def run() -> list[np.ndarray]:
        kind = given[6].dtype
        out = [np.zeros((N + 1, 5), kind), np.zeros((N + 1, 5), kind), *(np.zeros(a.shape, kind) for a in given[6:8])]
        out += [np.zeros((N, STAGES, 3, m, m), kind), np.zeros(2)]
        place, last = frames.copy(), c.copy()
        of_back = np.empty((2, 2), kind), np.empty((2, STAGES, 5 + m), kind)
        frame_gradient.back_substitute(*given, sigma, place, last, row.copy(), *work(given), *of_back, *out)
        g, moved = given[6][::-1].copy(), np.arange(3.0)
        square = frame_gradient.entries_at_random(g, given[6], moved, moved, np.empty((2, g.shape[2]), kind))
        return [*out, place, last, ends(given, sigma, np.array([1, -1, 0]), phi), np.array([square])]

    compiled = run()
    uncompiled(monkeypatch, frame_gradient)
    for a, b in zip(compiled, run(), strict=True):
        np.testing.assert_allclose(a, b, rtol=1e-9, atol=1e-12)
