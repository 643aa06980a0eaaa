"""analyses/refine_double.py: a zero of D is a mode on its own side of the continuous spectrum only; 0 to rounding is 0."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import shootstab as st

RESONANCE = -0.0019283715831197616 + 8.83943293974821e-06j


def test_a_zero_beyond_the_continuous_spectrum_is_no_mode(slow_wave: st.chute.ChuteProblem) -> None:
    mode = st.refine(slow_wave, RESONANCE)
    assert not mode.converged
    assert "a resonance, not a mode" in mode.status


def test_the_growing_mode_of_the_same_scene_is_one(slow_wave: st.chute.ChuteProblem) -> None:
    mode = st.refine(slow_wave, 0.00022 + 3.4e-7j)
    assert mode.converged
    assert abs(mode.sigma - (0.00021990660491 + 3.4018e-7j)) < 1e-10


def test_a_mode_that_is_zero_to_rounding_is_zero_within_its_bound() -> None:
    D0, D1 = np.array([[0, 1.0], [0, 0]]), np.array([[0, 0], [1.0, 0]])
    string = st.problem(2, lambda z: (D0, D1), st.Wall(0, [[0, 1]]), st.Wall(1, [[0, 1]]))  # y″ = σ y, y′ = 0 at both ends
    for guess in (1e-3, 1e-9j, -0.1):
        mode = st.refine(string, guess)
        assert mode.converged
        assert abs(mode.sigma) <= mode.error


def string_and_growth(g: float) -> st.LinearProblem:
    """y″ = σy + w, w′ = gσw, y = 0 at both ends and w at the second: D = e^{gσ} sinh(√σ)/√σ."""

    def pencil(z: float) -> tuple[Any, Any]:
        return np.array([[0, 1.0, 0], [0, 0, 1.0], [0, 0, 0]]), np.array([[0, 0, 0], [1.0, 0, 0], [0, 0, g]])

    return st.problem(3, pencil, st.Wall(0, [[1, 0, 0]]), st.Wall(1, [[1, 0, 0], [0, 0, 1]]))


@pytest.mark.parametrize("guess", [-9.8 + 0.08j])
def test_a_mode_of_a_steep_discriminant(guess: complex) -> None:
    """From farther off than 1/|g| Newton and Muller leave; a count does not see the factor."""
    mode = st.refine(string_and_growth(-20.0), guess, rtol=1e-7)
    assert mode.converged
    assert abs(mode.sigma + np.pi**2) <= mode.error < 1e-8


def test_a_discriminant_that_underflows_gives_no_mode() -> None:
    """With w = e^{−987} on the wall D is 0 to the last bit, and no number says where its zero is."""
    mode = st.refine(string_and_growth(100.0), -9.97, rtol=1e-3)
    assert not mode.converged
    assert mode.error == np.inf
