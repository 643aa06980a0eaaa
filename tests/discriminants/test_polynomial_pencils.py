"""Pencils and wall rows of any degree in σ: D and dD/dσ by other means, modes of the larger affine form, counts, many digits."""

from __future__ import annotations

import cmath
import math
from collections.abc import Callable

import mpmath
import numpy as np
import pytest
from linearized import linearized

import shootstab as st
from shootstab.core.errors import InputError
from shootstab.models.gallery.plate import malik_6
from shootstab.problems.rescaled import Rescaled

METHODS = [st.Frame(), st.Compound(), st.Riccati()]
NAMES = [method.name for method in METHODS]
SIGMA = 0.7 + 0.4j


def cubic(real: bool = False) -> tuple[st.LinearProblem, Callable[[mpmath.mpc], mpmath.mpc]]:
    """Constant coefficients, C of degree 2 in one row, D of degree 3, rows of degree 2 at z = 1; and D as a determinant of expm."""
    n, rng = 4, np.random.default_rng(5)
    draw = rng.normal if real else lambda size: rng.normal(size=size) + 1j * rng.normal(size=size)
    C, D = ([0.4 * draw(size=(n, n)) for _ in range(4)] for _ in range(2))
    C[0] += 3 * np.eye(n)
    for M in C[1:]:
        M[[0, 1, 3]] = 0.0
    C[3][:] = 0.0
    left, right = draw(size=(2, n)), [draw(size=(2, n)) for _ in range(3)]
    problem = st.problem(n, lambda z: (*C, *D), st.Wall(0, left), st.Wall(1, right[0], right[1:]), continuum=False)

    def exact(sigma: mpmath.mpc) -> mpmath.mpc:
        W, A, B = (
            sum((sigma**k * mpmath.matrix(M.tolist()) for k, M in enumerate(part[1:], 1)), mpmath.matrix(part[0].tolist()))
            for part in (right, C, D)
        )
        start = mpmath.matrix(problem.far_frame(0.0, 1.0).frame.tolist())
        return mpmath.det(W * mpmath.expm(mpmath.inverse(A) * B) * start)

    return problem, exact


@pytest.mark.parametrize("method", METHODS, ids=NAMES)
@pytest.mark.parametrize("real", [False, True], ids=["complex", "real"])
def test_D_and_its_derivative(method: st.Frame, real: bool) -> None:
    """Against the matrix exponential in 30 digits, and its derivative by a difference in them."""
    problem, exact = cubic(real)
    discriminant = method.on(problem)
    sigmas = [0.7, -0.3] if real else [SIGMA, -0.2 + 0.9j]
    with mpmath.workdps(30):
        values = [exact(mpmath.mpmathify(s)) for s in sigmas]
        slopes = [complex(mpmath.diff(exact, mpmath.mpmathify(s)) / v) for s, v in zip(sigmas, values, strict=True)]
    found = [discriminant.with_derivative(s) for s in sigmas]
    assert found[1].D.over(found[0].D) == pytest.approx(complex(values[1] / values[0]), rel=1e-9)
    for value, slope in zip(found, slopes, strict=True):
        assert value.logarithmic_derivative == pytest.approx(slope, rel=1e-9)


def string(power: int) -> st.LinearProblem:
    """y″ = σ^q y between y = 0 and y = 0: σ^q = −(πk)²."""
    D = [np.array([[0.0, 1.0], [0.0, 0.0]]), *(np.zeros((2, 2)) for _ in range(power))]
    D[power][1, 0] = 1.0
    C = [np.eye(2), *(np.zeros((2, 2)) for _ in range(power))]
    return st.problem(2, lambda z: (*C, *D), st.Wall(0, [[1, 0]]), st.Wall(1, [[1, 0]]))


@pytest.mark.parametrize("power", [2, 3, 4])
def test_all_roots_of_a_power_are_modes(power: int) -> None:
    problem = string(power)
    sizes = [(math.pi * k) ** (2 / power) for k in (1, 2)]
    assert st.count(problem, st.Disc(0.01 + 0.02j, math.sqrt(sizes[0] * sizes[1]))) == power
    exact = sizes[0] * cmath.exp(1j * math.pi / power)
    mode = st.refine(problem, guess=exact * 1.001)
    assert mode.converged
    assert abs(mode.sigma - exact) <= mode.error < 1e-12


@pytest.mark.parametrize("method", METHODS, ids=NAMES)
def test_a_half_line_agrees_with_the_larger_affine_form(method: st.Frame) -> None:
    """y″ + λ a(z) y′ = (1 + λ b + λ² c(z)) y towards infinity, with y′ + λ² y = 0 at 0 the affine form of which is y′ + λ ξ = 0."""

    def parts(z: np.ndarray) -> tuple[np.ndarray, np.ndarray, list[np.ndarray]]:
        decay = np.exp(-z)
        D = [np.zeros((len(z), 2, 2), complex) for _ in range(3)]
        D[0][:, 0, 1] = D[0][:, 1, 0] = 1.0
        D[1][:, 1, 0], D[1][:, 1, 1] = 0.4j, -decay
        D[2][:, 1, 0] = 1 + 0.5 * decay
        return np.broadcast_to(np.eye(2), D[0].shape).astype(complex), np.zeros_like(D[0]), D

    def quadratic(z: np.ndarray) -> tuple[np.ndarray, ...]:
        C0, C1, D = parts(z)
        return C0, C1, C1, *D

    rows = np.array([[0.0, 1.0]]), np.array([[[0.0, 0.0]], [[1.0, 0.0]]])
    small = st.problem(
        2, quadratic, st.Wall(0, *rows), st.Infinity(limit=tuple(M[0] for M in quadratic(np.array([800.0])))), vectorized=True
    )
    larger_limit = tuple(M[0] for M in linearized(*parts(np.array([800.0])), [0]))
    large = st.problem(
        3, lambda z: linearized(*parts(z), [0]), st.Wall(0, [[0, 1, 0]], [[0, 0, 1]]), st.Infinity(limit=larger_limit), vectorized=True
    )
    mode = st.refine(small, guess=1.2 + 0.2j, method=method)
    assert mode.converged
    other = st.refine(large, guess=mode.sigma * 1.0001)
    assert abs(mode.sigma - other.sigma) <= mode.error + other.error
    region = st.Disc(mode.sigma, 0.3)
    assert st.count(small, region) == st.count(large, region) == 1


def test_in_another_unit() -> None:
    problem, unit = string(3), 2.0 - 0.5j
    exact = math.pi ** (2 / 3) * cmath.exp(1j * math.pi / 3) / unit
    mode = st.refine(Rescaled(problem, unit), guess=exact * 1.001)
    assert mode.converged
    assert abs(mode.sigma - exact) <= mode.error


def test_spatial_modes_of_the_plate_have_its_order() -> None:
    assert malik_6().size == 8


def test_a_jump_with_powers_of_sigma() -> None:
    """y″ = −σ y on both sides of z = 1, y continuous, the slope jumping by σ³ y: tan √σ = −2/σ^{5/2}."""
    D0, D1 = np.array([[0.0, 1.0], [0.0, 0.0]]), np.array([[0.0, 0.0], [-1.0, 0.0]])
    moving = np.zeros((3, 2, 2))
    moving[2, 1, 0] = 1.0
    wall = [[1.0, 0.0]]
    joint = st.Interface.jump(1.0, np.eye(2), moving)
    problem = st.problem(2, lambda z: (D0, D1), st.Wall(0, wall), st.Wall(2, wall), interfaces=[joint])
    root = float(mpmath.findroot(lambda s: mpmath.tan(mpmath.sqrt(s)) + 2 / s ** mpmath.mpf(2.5), 9.0))
    mode = st.refine(problem, guess=root * 1.0001)
    assert mode.converged
    assert abs(mode.sigma - root) <= mode.error


def test_rows_that_are_dependent_at_every_sigma_are_refused() -> None:
    D = [np.zeros((2, 2))] * 6
    with pytest.raises(InputError, match="rank 1"):
        st.problem(2, lambda z: D, st.Wall(0, [[1, 0], [2, 0]], [[[0, 0], [0, 0]], [[1, 1], [2, 2]]]), st.Wall(1, [[1, 0]]))
