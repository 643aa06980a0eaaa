"""analyses/refine_double.py: a zero of D is a mode on its own side of the continuous spectrum only; 0 to rounding is 0."""

from __future__ import annotations

import numpy as np
import pytest

import shootstab as st

RESONANCE = -0.0019283715831197616 + 8.83943293974821e-06j


@pytest.fixture(scope="module")
def nearly_without_waves() -> st.chute.ChuteProblem:
    """k_x = 1e-7: the continuous spectrum hugs the real axis, and zeros of D continued through it lie next to it on both sides."""
    flow = st.chute.steady(
        far_temperature=8.259092290598987,
        e=0.7981727536605799,
        e_w=0.9794039787584508,
        r=0.7006985193967026,
        tan_theta=0.21277605159925433,
        nu_max=0.56407003093951,
        radial="carnahan-starling",
    )
    return st.chute.problem(flow, kx=1.0785622190010972e-07, ky=0.0006610754896898808)


def test_a_zero_beyond_the_continuous_spectrum_is_no_mode(nearly_without_waves: st.chute.ChuteProblem) -> None:
    mode = st.refine(nearly_without_waves, RESONANCE)
    assert not mode.converged
    assert "a resonance, not a mode" in mode.status


def test_the_growing_mode_of_the_same_scene_is_one(nearly_without_waves: st.chute.ChuteProblem) -> None:
    mode = st.refine(nearly_without_waves, 0.00022 + 3.4e-7j)
    assert mode.converged
    assert abs(mode.sigma - (0.00021990660491 + 3.4018e-7j)) < 1e-10


def test_a_mode_that_is_zero_to_rounding_is_zero_within_its_bound() -> None:
    D0, D1 = np.array([[0, 1.0], [0, 0]]), np.array([[0, 0], [1.0, 0]])
    string = st.problem(2, lambda z: (D0, D1), st.Wall(0, [[0, 1]]), st.Wall(1, [[0, 1]]))  # y″ = σ y, y′ = 0 at both ends
    for guess in (1e-3, 1e-9j, -0.1):
        mode = st.refine(string, guess)
        assert mode.converged
        assert abs(mode.sigma) <= mode.error
