"""discriminants/meshing.py: local errors that are rounding are no reason to refuse, and a singular point is none for meshes without end."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from scipy.optimize import brentq

import shootstab as st
from shootstab.discriminants import meshing
from shootstab.discriminants.cells import Cell
from shootstab.discriminants.frame import Frame
from shootstab.discriminants.mesh import fits

SIGMA = np.array([[0.0, 0.0], [1.0, 0.0]])


def strings_in_other_equations(z: float) -> tuple[Any, Any, Any, Any]:
    """y″ = σ y and a component that vanishes, the equations combined so that sigma stands in several rows of C and D."""
    S = np.array([[2.0, 0.3 * z, 0.1], [0, 1, 0.4], [0.2, 0, 1]])
    N = np.array([[0, 0, 1.0], [0, 0, -0.5], [0, 0, 0]])
    D0, D1 = np.array([[0, 1.0, 0], [0, 0, 0], [0, 0, 1]]), np.array([[0, 0, 0], [1.0, 0, 0], [0, 0, 0]])
    return S, S @ N, S @ D0, S @ (D1 + N)


def test_a_row_that_is_rounding_does_not_ask_for_shorter_steps() -> None:
    problem = st.problem(3, strings_in_other_equations, st.Wall(0, [[1, 0, 0], [0, 0, 1]]), st.Wall(1, [[1, 0, 0]]))
    mode = st.refine(problem, -9.85)
    assert mode.converged
    assert abs(mode.sigma + np.pi**2) <= mode.error < 1e-10
    assert Frame(rtol=1e-11).on(problem).at(mode.sigma).steps < 2000


@pytest.mark.parametrize(("middle", "width"), [(0.4321, 4e-4), (0.111, 8e-4)])
def test_a_narrow_hat_that_the_first_look_missed_is_found_where_errors_do_not_fall(middle: float, width: float) -> None:
    """y″ = (σ + V) y with V = 200 on an interval that the samples of knots step over; D by three products in closed form."""

    def pencil(z: float) -> tuple[Any, Any]:
        return np.array([[0, 1], [200.0 if abs(z - middle) < width / 2 else 0.0, 0]]), SIGMA

    def over(q: float, h: float) -> Any:  # (y, y′) over a length h where y″ = q y
        r = np.sqrt(complex(q))
        return np.array([[np.cosh(r * h), np.sinh(r * h) / r], [r * np.sinh(r * h), np.cosh(r * h)]]).real

    def D(sigma: float) -> float:
        low, high = middle - width / 2, middle + width / 2
        return float((over(sigma, 1 - high) @ over(sigma + 200.0, width) @ over(sigma, low))[0, 1])

    problem = st.problem(2, pencil, st.Wall(0, [[1, 0]]), st.Wall(1, [[1, 0]]))
    assert len(problem.knots) == 0
    mode = st.refine(problem, -9.9, rtol=1e-8)
    assert mode.converged
    assert abs(mode.sigma - brentq(D, -12.0, -9.0, xtol=1e-15, rtol=1e-15)) <= mode.error + 1e-12
    assert Frame(rtol=1e-9).on(problem).at(mode.sigma).steps < 100


def test_rounding_of_a_coefficient_is_in_the_bound() -> None:
    def pencil(z: float) -> tuple[Any, Any]:  # (1 + z) − z is 1 to rounding: the modes are −1 − n²π²
        return np.array([[0, 1], [(1e3 + z) - z - 1e3 + 1, 0]]), SIGMA

    problem = st.problem(2, pencil, st.Wall(0, [[1, 0]]), st.Wall(1, [[1, 0]]))
    mode = st.refine(problem, -10.85)
    assert mode.converged
    assert abs(mode.sigma + 1 + np.pi**2) <= mode.error < 1e-9


def test_rounding_where_a_coefficient_vanishes_is_no_row_of_knots() -> None:
    """w″ = (1 + σ)w, b′ = (s w)′ with s = 1 − tanh²(30(x − ½)), which rounds as 1 does where it is 1e−13: the modes are −1 − n²π²."""

    def pencil(x: float) -> tuple[Any, Any]:
        s = 1 - np.tanh(30 * (x - 0.5)) ** 2
        slope = -60 * np.tanh(30 * (x - 0.5)) * s
        return np.array([[0, 1, 0], [1, 0, 0], [slope, s, 0.0]]), np.array([[0, 0, 0], [1.0, 0, 0], [0, 0, 0]])

    problem = st.problem(3, pencil, st.Wall(0, [[1, 0, 0], [0, 0, 1]]), st.Wall(1, [[1, 0, 0]]))
    report = st.verify(problem, [-1 - np.pi**2, -1 - 4 * np.pi**2], missing="none")
    assert [v.verdict for v in report.verdicts] == ["confirmed"] * 2


def test_a_step_over_a_large_jump_is_as_long_as_rounding_allows() -> None:
    """y″ = σy + 3000 y′ beyond z = 0.3: the error of the step over it, 1e−15 times the jump, is no reason to refuse at 1e−13."""

    def pencil(x: float) -> tuple[Any, Any]:
        return np.array([[0, 1], [0, 3000.0 * (x > 0.3)]]), SIGMA

    interfaces = [st.Interface.jump(z, np.eye(2)) for z in (0.3, 0.7)]
    problem = st.problem(2, pencil, st.Wall(0, [[1, 0]]), st.Wall(1, [[1, 0]]), interfaces=interfaces)
    assert Frame(rtol=1e-13).on(problem).at(-134.7).serves(-134.7)


def alfven(x: Any) -> tuple[Any, Any, Any, Any]:
    """((σ − a)ξ′)′ = 4(σ − a)ξ with a = 1 + x + x²/2, singular at σ = a(x), in (ξ, (σ − a)ξ′); no mode, by energy."""
    a = 1 + x + x * x / 2
    return np.array([[-a, 0], [0, 1]]), np.array([[1.0, 0], [0, 0]]), np.array([[0, 1], [-4 * a, 0]]), np.array([[0, 0], [4.0, 0]])


def test_next_to_a_singular_wall_the_mesh_does_not_grow_in_vain() -> None:
    """Behind a step that is no number no step is, and cutting them all leads to meshes of a hundred thousand steps."""
    asked: list[float] = []

    def counted(x: Any) -> tuple[Any, Any, Any, Any]:
        asked.append(x)
        return alfven(x)

    problem = st.problem(2, counted, st.Wall(0, [[1, 0]]), st.Wall(1, [[1, 0]]), continuum=False)
    before = len(asked)
    with pytest.raises(st.ConvergenceError, match="C is singular next to z = "):
        Frame(rtol=1e-5).on(problem).at(1.0)
    assert len(asked) - before < 100_000  # of five meshes; one that grows takes a million


def test_claims_on_the_continuum_next_to_its_end_at_the_wall() -> None:
    """The mesh of a path is made for a σ whose singular point the path leads around: not for that of the wall."""
    asked: list[Any] = []

    def counted(x: Any) -> tuple[Any, Any, Any, Any]:
        asked.append(x)
        return alfven(x)

    problem = st.problem(2, counted, st.Wall(0, [[1, 0]]), st.Wall(1, [[1, 0]]), continuum=lambda x: 1 + x + x * x / 2)
    verdicts = st.verify(problem, [1 + x + x * x / 2 for x in (0.02, 0.98)], missing="none").verdicts
    assert [v.verdict for v in verdicts] == ["spurious"] * 2
    assert len(asked) < 100_000


def test_a_singular_point_between_the_walls_is_named() -> None:
    """y″ = (σ + 3/(z − 0.5123)²) y: no solution goes through it, and no mesh comes near."""

    def pencil(z: float) -> tuple[Any, Any]:
        return np.array([[0, 1], [3.0 / ((z - 0.5123) ** 2 or 1e-300), 0]]), SIGMA

    mode = st.refine(st.problem(2, pencil, st.Wall(0, [[1, 0]]), st.Wall(1, [[1, 0]])), -9, rtol=1e-8)
    assert not mode.converged
    assert "no step is short enough at sigma = -9" in mode.status
    assert "too fast next to z = 0.5123" in mode.status


WAVES = st.problem(2, lambda z: (np.array([[0, 1], [1000 * np.cos(30 * z), 0]]), SIGMA), st.Wall(0, [[1, 0]]), st.Wall(1, [[1, 0]]))


def test_a_mesh_that_memory_does_not_hold_is_refused_before_it_is_made(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(meshing, "MOST_BYTES", 20_000)
    mode = st.refine(WAVES, -90, rtol=1e-8)
    assert not mode.converged
    assert "would need more than the 23 steps that memory allows" in mode.status


def test_a_circle_on_whose_rim_no_mesh_holds_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    D = Frame(rtol=1e-9).on(WAVES)
    assert D.around(-90 + 0j, 5.0).propagated(-85 + 0j, True).errors.max() < 1e-8
    monkeypatch.setattr(meshing, "MESH_ATTEMPTS", 0)
    with pytest.raises(st.ConvergenceError, match=r"local errors of 1\.0e-09 cannot be held around sigma = -85"):
        D.around(-90 + 0j, 5.0)


def test_noise_next_to_the_continuous_spectrum_is_told_as_that() -> None:
    """A growth rate of 1e-11 on the continuous spectrum of a cold flow, which a pseudospectral code gives: C is singular next to it."""
    grains = {"e": 0.80772, "e_w": 0.78825, "r": 0.68957, "nu_max": 0.59107}
    flow = st.chute.steady(far_temperature=0.048123, tan_theta=0.23979, radial="carnahan-starling", wall="isotropic", **grains)
    found = st.refine(st.chute.problem(flow, kx=0.62815, ky=1.5877e-7), guess=9.766983e-12 - 0.13353738206633j)
    assert not found.converged
    assert "C is nearly singular there" in found.status


def test_a_mesh_fits_where_its_errors_hold_and_fewer_steps_would_not_do() -> None:
    even = np.full(20, 0.6e-8)
    assert fits(even, 1e-8)
    assert not fits(1e-6 * even, 1e-8)  # a fifth of the steps would do
    assert not fits(np.zeros(20), 1e-8)
    for bad in (1.1e-8, np.nan, np.inf):
        assert not fits(np.append(even, bad), 1e-8)
    assert fits(np.append(even, 0.0), 1e-8)  # a step over a knot


def test_mesh_is_cut_for_the_other_end_of_its_cell_unless_it_grows_too_much(monkeypatch: pytest.MonkeyPatch) -> None:
    """A cell of plane Poiseuille flow: its smallest σ asks for a third more steps, which all others of the cell then take too."""
    problem, propagator, cell = st.gallery.PlanePoiseuille(), Frame(rtol=1e-11), Cell.of(0.0037 - 0.2375j, 0)
    alone = meshing.made_for(problem, propagator, None, cell.anchor)
    cut = meshing.made_for(problem, propagator, None, cell.anchor, smallest=cell.smallest)
    assert 1.2 * alone.steps < cut.steps <= meshing.MOST_GROWTH * alone.steps
    monkeypatch.setattr(meshing, "MOST_GROWTH", 1.1)
    assert meshing.made_for(problem, propagator, None, cell.anchor, smallest=cell.smallest).steps == alone.steps
