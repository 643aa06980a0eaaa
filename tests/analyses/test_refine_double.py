"""analyses/refine_double.py: a zero of D is a mode on its own side of the continuous spectrum only; 0 to rounding is 0."""

from __future__ import annotations

import math
import re
from typing import Any

import numpy as np
import pytest

import shootstab as st
from shootstab.analyses.refine_double import examine
from shootstab.core.errors import ConvergenceError, InputError
from shootstab.discriminants.continuation import Continuation
from shootstab.roots.iterations import Root

NOTHING = np.zeros((2, 2))


def beside_a_constant(rate: float, power: int = 1, wall: float = 1.0, slope: float = 0.0) -> st.LinearProblem:
    """y′ = rate σ^power y on (0, 1) beside a component that vanishes: D = (wall + slope σ) exp(rate σ^power)."""
    C, D = [np.eye(2)] + [NOTHING] * power, [NOTHING] * power + [np.diag([rate, 0.0])]
    return st.problem(2, lambda z: (*C, *D), st.Wall(0, [[0, 1]]), st.Wall(1, [[wall, 0]], [[slope, 0]]))


def string(shift: float = 0.0) -> st.LinearProblem:
    """y″ = (σ + shift) y with both ends free: σ = −shift − n²π²."""
    D0, D1 = np.array([[0, 1.0], [shift, 0]]), np.array([[0, 0], [1.0, 0]])
    return st.problem(2, lambda z: (D0, D1), st.Wall(0, [[0, 1]]), st.Wall(1, [[0, 1]]))


def test_an_iteration_that_stops_where_no_zero_is_finds_none() -> None:
    """exp(σ²) has no zero, but Newton's steps −1/(2σ) are short for large σ."""
    mode = st.refine(beside_a_constant(1.0, power=2), 30.0, rtol=0.9)
    assert mode.status.startswith("not converged: the iteration stopped at 29.")
    assert "but no zero lies within" in mode.status


def test_a_root_next_to_which_the_iteration_goes_on_is_none() -> None:
    with pytest.raises(ConvergenceError, match=r"the iteration does not settle at 0\.3.* along the path real"):
        examine(Continuation(beside_a_constant(0.0), st.Frame()), Root(0.3 + 0j, 0.0, 1, True), 1e-8)


@pytest.mark.parametrize("guess", [0.0, 0.3, -1e100])
def test_a_constant_has_no_mode(guess: float) -> None:
    mode = st.refine(beside_a_constant(0.0), guess)
    assert mode.status.startswith("not converged: neither Newton nor Muller arrives anywhere")


def test_a_guess_whose_square_is_no_double_is_refused() -> None:
    with pytest.raises(InputError, match="allowed is a number up to 1e\\+100 in size"):
        st.refine(beside_a_constant(0.0), 1e200)


def test_a_mode_at_zero_of_a_linear_function_is_proven() -> None:
    mode = st.refine(beside_a_constant(0.0, wall=0.0, slope=1.0), 0.3)
    assert (mode.sigma, mode.error, mode.converged) == (0.0, 0.0, True)


def test_a_bound_as_large_as_the_mode_is_said() -> None:
    mode = st.refine(string(-(math.pi**2)), 1e-3, atol=0.0)
    assert mode.status.startswith("not converged: the error bound")
    assert mode.status.endswith("is as large as the mode itself")
    assert abs(mode.sigma) <= mode.error


def test_digits_that_double_precision_does_not_have_are_not_promised() -> None:
    mode = st.refine(string(-1e4), 515.0, rtol=1e-14)  # rates of size 100, and what is left of them
    assert "exceeds the" in mode.status
    assert abs(mode.sigma - (1e4 - (31 * math.pi) ** 2)) <= mode.error


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
    for guess in (1e-3, 1e-9j, -0.1):
        mode = st.refine(string(), guess)
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


def test_a_continuous_spectrum_inside_the_bound_is_said() -> None:
    """A string whose continuous spectrum is said to pass at 1e-9 from its mode −64π²: 1e-4 does not tell on which side the mode is."""
    shift, mode = np.array([[0.0, 0.0], [1.0, 0.0]]), -64 * math.pi**2
    walls = st.Wall(0, [[1, 0]]), st.Wall(1, [[1, 0]])
    string = st.problem(2, lambda z: (np.eye(2, k=1), shift), *walls, continuum=lambda z: mode + 1e-9 + 1j * (z - 0.5))
    found = st.refine(string, mode, rtol=1e-4)
    assert not found.converged
    assert re.search(r"the continuous spectrum passes at 1\.\de-09, inside the error bound 1\.\de-09", found.status)
    assert st.refine(string, mode, rtol=1e-12).converged


def test_an_iteration_that_leaves_the_numbers_on_the_halved_mesh_is_told() -> None:
    """A complex oscillator by Riccati's equation, whose solutions leave their charts: it ended in a disc of radius NaN."""
    walls = st.Conditions(-8, ["y"]), st.Conditions(8, ["y"])
    oscillator = st.equations(["y"], ["d(y, 2) - sigma*y - i*x**2*y"], *walls, variable="x")
    lost = st.refine(oscillator, -9.192388155738836 - 9.192388153518412j, rtol=1e-4, method=st.Riccati(rtol=1e-5))
    assert not lost.converged
    assert lost.error == math.inf
    assert st.refine(oscillator, -9.19 - 9.19j).converged
