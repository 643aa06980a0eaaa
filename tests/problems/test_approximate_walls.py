"""A wall next to a singular point is an approximation, and its error is measured: bounds that hold, of the size of the error."""

from __future__ import annotations

import math
from typing import Any

import mpmath
import numpy as np
import pytest

import shootstab as st
from shootstab.core.errors import InputError


def bessel(m: int) -> Any:
    """r (r y′)′ = (m² + σ r²) y, the state (y, r y′): singular at r = 0."""

    def pencil(r: complex) -> tuple[Any, Any]:
        return np.array([[0, 1 / r], [m * m / r, 0]]), np.array([[0, 0], [r, 0]])

    return pencil


def drum(m: int, epsilon: float, mirrored: bool = False, sigma_in_rows: bool = False) -> tuple[st.LinearProblem, float]:
    """The drum of radius 1 with a wall at r = ε, and its eigenvalue −j².

    y ~ r^m there: r y′ = m y, which leaves an error of ε² (m = 0) or ε^{2m+2}. With y = 0 instead, m = 1, it is ε².
    """
    rows = [[-m, 1]]
    rim: dict[str, Any] = {"rows": [[1, 0]]}
    exact = -float(mpmath.besseljzero(m, 1) ** 2)
    inner = st.Wall(epsilon, rows, approximates=0.0)
    if not mirrored:
        return st.problem(2, bessel(m), inner, st.Wall(1, **rim)), exact

    def turned(x: complex) -> tuple[Any, Any]:
        D0, D1 = bessel(m)(-x)
        return -D0, -D1

    return st.problem(2, turned, st.Wall(-1, **rim), st.Wall(-epsilon, rows, approximates=0.0)), exact


@pytest.mark.parametrize("epsilon", [1e-1, 1e-2, 1e-4])
@pytest.mark.parametrize("mirrored", [False, True])
def test_the_error_of_a_wall_next_to_the_axis_is_in_the_bound(epsilon: float, mirrored: bool) -> None:
    problem, exact = drum(0, epsilon, mirrored)
    mode = st.refine(problem, 1.001 * exact)
    error = abs(mode.sigma - exact)
    assert error <= mode.error < 30 * error
    assert mode.budget.far_field == pytest.approx(3 * error, rel=0.2)  # ε² is moved by (2² − 1) times itself


def test_an_error_of_first_order_too() -> None:
    """y = 0 at r = ε for m = 1, an error of ε², and for y″ = σ y with y = 0 next to 0, one of ε."""
    exact = -float(mpmath.besseljzero(1, 1) ** 2)
    for epsilon in (1e-1, 1e-3):
        mode = st.refine(st.problem(2, bessel(1), st.Wall(epsilon, [[1, 0]], approximates=0.0), st.Wall(1, [[1, 0]])), 1.01 * exact)
        assert abs(mode.sigma - exact) <= mode.error < 30 * abs(mode.sigma - exact)

    def string(z: float) -> tuple[Any, Any]:
        return np.array([[0.0, 1.0], [0.0, 0.0]]), np.array([[0.0, 0.0], [1.0, 0.0]])

    for interfaces in ((), (st.Interface.jump(0.5, np.eye(2)),)):
        problem = st.problem(2, string, st.Wall(1e-3, [[1, 0]], approximates=0.0), st.Wall(1, [[1, 0]]), interfaces=interfaces)
        mode = st.refine(problem, -9.8)
        assert abs(mode.sigma + math.pi**2) <= mode.error < 2 * abs(mode.sigma + math.pi**2)


def test_without_the_word_the_wall_is_the_problem() -> None:
    """The same numbers, and a bound on the mode of the problem that was given."""
    told, _ = drum(0, 1e-2)
    plain = st.problem(2, bessel(0), st.Wall(1e-2, [[0, 1]]), st.Wall(1, [[1, 0]]))
    modes = [st.refine(p, -5.78) for p in (told, plain)]
    assert abs(modes[0].sigma - modes[1].sigma) < 1e-11
    assert modes[1].error < 1e-10 < modes[0].error


def test_a_verdict_knows_of_it() -> None:
    """At ε = 1e-2 six digits cannot be confirmed, at 1e-5 they are."""
    exact = -float(mpmath.besseljzero(0, 1) ** 2)
    verdicts = [st.verify(drum(0, epsilon)[0], [exact], digits=6).verdicts[0].verdict for epsilon in (1e-2, 1e-5)]
    assert verdicts[0] != "confirmed"
    assert verdicts[1] == "confirmed"


@pytest.mark.parametrize(("z", "point"), [(0.1, 0.1), (0.1, 0.2), (0.1, -math.inf)])
def test_a_point_that_is_not_beyond_the_wall(z: float, point: float) -> None:
    with pytest.raises(InputError, match="approximates") as refusal:
        st.problem(2, bessel(0), st.Wall(z, [[0, 1]], approximates=point), st.Wall(1, [[1, 0]]))
    assert "below 0.1" in str(refusal.value)


def test_a_wall_nearer_to_the_other_end_than_to_its_point() -> None:
    with pytest.raises(InputError, match="twice as far"):
        st.problem(2, bessel(0), st.Wall(0.6, [[0, 1]], approximates=0.0), st.Wall(1, [[1, 0]]))


def test_a_double_mode_knows_of_it() -> None:
    """Two drums: the bound of the double mode is no circle of rounding, and holds the exact value."""
    for epsilon in (1e-1, 1e-3):
        _, exact = drum(0, epsilon)
        single = bessel(0)
        zero = np.zeros((2, 2))

        def pencil(r: complex, single: Any = single, zero: Any = zero) -> tuple[Any, Any]:
            D0, D1 = single(r)
            return np.block([[D0, zero], [zero, D0]]), np.block([[D1, zero], [zero, D1]])

        inner = st.Wall(epsilon, [[0, 1, 0, 0], [0, 0, 0, 1]], approximates=0.0)
        mode = st.refine(st.problem(4, pencil, inner, st.Wall(1, [[1, 0, 0, 0], [0, 0, 1, 0]])), 1.001 * exact, rtol=1e-6)
        assert mode.multiplicity == 2
        assert abs(mode.sigma - exact) <= mode.error


def test_a_count_knows_of_it() -> None:
    """A circle whose count other walls would change is refused; one that is wide enough is counted."""
    problem, exact = drum(0, 1e-2)
    assert st.count(problem, st.Disc(exact, 0.5)) == 1
    assert st.count(problem, st.Disc(exact + 2.0, 0.5)) == 0
    with pytest.raises(st.ConvergenceError, match="singular points"):
        st.count(problem, st.Disc(exact, 1e-4))
