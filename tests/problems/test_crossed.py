"""problems/crossed.py: interfaces that a subdomain runs across, with a system no larger than between walls."""

from __future__ import annotations

from typing import Any

import mpmath
import numpy as np
import pytest

import shootstab as st
from shootstab.problems.crossed import can_be_crossed

D1 = np.array([[0.0, 0.0], [1.0, 0.0]])


def layered(densities: list[float], ends: list[float], **options: Any) -> st.LinearProblem:
    """(y′/ρ)′ = σ y in layers, the state (y, y′): y and y′/ρ are continuous."""

    def pencil(z: float) -> tuple[Any, Any]:
        rho = densities[min(int(np.searchsorted(ends, z)), len(densities) - 1)]
        return np.array([[0.0, 1.0], [0.0, 0.0]]), rho * D1

    jumps = [st.Interface.jump(z, np.diag([1.0, b / a])) for z, a, b in zip(ends, densities[:-1], densities[1:], strict=True)]
    return st.problem(2, pencil, st.Wall(0, [[1, 0]]), st.Wall(1, [[1, 0]]), interfaces=jumps, **options)


def truth(densities: list[float], ends: list[float], guess: float) -> complex:
    """The same from cosines and sines, layer by layer, in mpmath."""

    def miss(sigma: Any) -> Any:
        y, flux = mpmath.mpf(0), mpmath.mpf(1)
        for rho, a, b in zip(densities, [0.0, *ends], [*ends, 1.0], strict=True):
            k, h = mpmath.sqrt(-sigma * rho), mpmath.mpf(b) - mpmath.mpf(a)
            c, s = mpmath.cos(k * h), mpmath.sin(k * h)
            y, flux = y * c + flux * rho * s / k, flux * c - y * k * s / rho
        return y

    with mpmath.workdps(30):
        return complex(mpmath.findroot(miss, (guess, guess * (1 + 1e-6)), tol=1e-22))


def test_many_layers_cost_no_more_states_than_one() -> None:
    densities = [1.0, 3.0] * 20
    ends = list(np.linspace(0, 1, 41)[1:-1])
    problem = layered(densities, ends)
    assert problem.size == 2
    assert np.allclose(problem.knots, ends, rtol=1e-14)
    mode = st.refine(problem, guess=-5.0)
    assert mode.converged
    assert abs(mode.sigma - truth(densities, ends, float(mode.sigma.real))) <= mode.error < 1e-9


def test_interfaces_of_order_four_are_crossed() -> None:
    """A clamped beam in forty parts that are one: y⁗ = σ y, cosh cos = 1."""
    pencil = np.eye(4, k=1), np.eye(4, k=-3)
    jumps = [st.Interface.jump(float(z), np.eye(4)) for z in np.linspace(0, 1, 41)[1:-1]]
    problem = st.problem(4, lambda z: pencil, st.Wall(0, np.eye(2, 4)), st.Wall(1, np.eye(2, 4)), interfaces=jumps)
    with mpmath.workdps(25):
        exact = complex(mpmath.findroot(lambda k: mpmath.cosh(k) * mpmath.cos(k) - 1, 4.73) ** 4)
    mode = st.refine(problem, guess=500.0)
    assert abs(mode.sigma - exact) <= mode.error < 1e-7


@pytest.mark.parametrize("side", ["left", "right", "both"])
def test_layers_before_an_infinite_end_are_crossed(side: str) -> None:
    """A square well by interfaces with J = 1, where the state behind the second is turned, and turned back."""
    turn = np.array([[1.0, 2.0], [3.0, 7.0]])
    back = np.linalg.inv(turn)

    def pencil(x: float) -> tuple[Any, Any]:
        D0, move = np.array([[0.0, 1.0], [-5.0 * (abs(x) < 1), 0.0]]), D1
        return (turn @ D0 @ back, turn @ move @ back) if x > 1.5 else (D0, move)

    # y is even: y′ = 0 at 0 makes a half-line of it
    wall, jumps = st.Wall(0, [[0, 1]]), [st.Interface.jump(1.0, np.eye(2)), st.Interface.jump(1.5, turn)]
    if side == "right":
        problem = st.problem(2, pencil, wall, st.Infinity(), interfaces=jumps)
    elif side == "left":
        mirror = np.diag([1.0, -1.0])

        def mirrored(x: float) -> tuple[Any, Any]:
            D0, D1 = pencil(-x)
            return -mirror @ D0 @ mirror, -mirror @ D1 @ mirror

        other = [st.Interface.jump(-1.0, np.eye(2)), st.Interface.jump(-1.5, mirror @ back @ mirror)]
        problem = st.problem(2, mirrored, st.Infinity(), st.Wall(0, [[0, 1]]), interfaces=other)
    else:
        problem = st.problem(2, pencil, st.Infinity(), st.Infinity(), interfaces=[*jumps, st.Interface.jump(-1.0, np.eye(2))])
    with mpmath.workdps(30):
        k = mpmath.findroot(lambda k: k * mpmath.tan(k) - mpmath.sqrt(5 - k * k), 1.1)
        exact = complex(5 - k * k)
    assert problem.size == (4 if side == "both" else 2)
    mode = st.refine(problem, guess=exact * 1.001)
    assert mode.converged
    assert abs(mode.sigma - exact) <= mode.error < 1e-9


def test_an_interface_that_moves_with_sigma_is_a_joint() -> None:
    assert can_be_crossed(st.Interface.jump(0.5, [[1, 2], [3, 7]]), 2)
    assert can_be_crossed(st.Interface(0.5, 1e6 * np.eye(2), 1e-6 * np.eye(2)), 2)
    assert not can_be_crossed(st.Interface.jump(0.5, np.eye(2), [[0, 0], [1, 0]]), 2)
    assert not can_be_crossed(st.Interface(0.5, [[1, 0], [0, 0]], [[0, 0], [1, 0]]), 2)


def test_the_eigenfunction_jumps_where_interfaces_are_crossed() -> None:
    """y is continuous and y′ is ρ times a continuous flux; the state is turned back into that of the user."""
    densities, ends = [1.0, 4.0, 2.0], [0.3, 0.6]
    shape = st.eigenfunction(layered(densities, ends), -5.0)
    near = 1e-9
    for z, (before, behind) in zip(ends, [(1.0, 4.0), (4.0, 2.0)], strict=True):
        left, right = (shape.state(np.array([z + side * near]))[0] for side in (-1, 1))
        assert right[0] == pytest.approx(left[0], rel=1e-6)
        assert right[1] == pytest.approx(left[1] * behind / before, rel=1e-6)


def test_a_continuous_spectrum_of_one_point_is_crossed_and_not_led_around() -> None:
    """A curve without extent has no ends around which discs could be left out."""
    D0, D1 = np.array([[0.0, 1.0], [0.0, 0.0]]), np.array([[0.0, 0.0], [1.0, 0.0]])
    problem = st.problem(2, lambda z: (D0, D1), st.Wall(0, [[1, 0]]), st.Wall(1, [[1, 0]]), continuum=lambda z: 0.5)
    assert problem.continuum is None
    assert {complex(s) for _, sigma in problem.crossings for s in sigma} == {0.5}
    assert st.count(problem, st.Rectangle(-11 - 1j, -9 + 1j)) == 1
    with pytest.raises(st.ConvergenceError):
        st.count(problem, st.Rectangle(-1 - 1j, 1 + 1j))
