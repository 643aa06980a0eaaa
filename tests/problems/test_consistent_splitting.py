"""problems/consistent_splitting: advection, fronts and shocks without a reference, on the whole line and on half of it."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

import shootstab as st
from shootstab.problems.consistent_splitting import EndConditions, consistent_splitting
from shootstab.problems.protocol import Pencil
from shootstab.problems.splitting import AsymptoticPencil

MOVING = np.array([[0, 0], [1, 0]], dtype=np.complex128)


def well(x: float, a: float) -> tuple[Any, Any]:
    """v″ + a v′ + (1.5 sech² x − 0.5) v = σ v: with v = e^{−ax/2} w a Pöschl–Teller well, σ = ν² − 0.5 − a²/4 for ν(ν + 1) = 1.5."""
    return np.array([[0, 1], [0.5 - 1.5 / math.cosh(min(abs(x), 300.0)) ** 2, -a]]), MOVING


def exact_well(a: float) -> float:
    return ((math.sqrt(7) - 1) / 2) ** 2 - 0.5 - a * a / 4


@pytest.mark.parametrize("a", [0.3, -0.3, 1e-3, 1.0])
def test_advection_on_the_whole_line(a: float) -> None:
    """Inside the parabola σ = −0.5 − ℓ² + iaℓ the splitting 0 + 2 adds up too, and has no gap to compare."""
    problem = st.problem(2, lambda x: well(x, a), st.Infinity(), st.Infinity())
    assert [end.decaying for end in problem.ends(0.1)] == [1, 1]
    mode = st.refine(problem, exact_well(a) * 1.05)
    assert mode.converged
    assert abs(mode.sigma - exact_well(a)) <= mode.error < 1e-11
    assert st.verify(problem, [exact_well(a)]).verdicts[0].verdict == "confirmed"
    assert st.count(problem, st.Rectangle(-0.1 - 1j, 1 + 1j)) == 1


def test_advection_on_half_a_line() -> None:
    """The even state of the well that is 8 deep, with w′(0) = 0: v′ + (a/2) v = 0. The rows ask for one solution, and two decay inside."""
    a, nu = 0.6, (math.sqrt(33) - 1) / 2

    def pencil(x: float) -> tuple[Any, Any]:
        return np.array([[0, 1], [-8 / math.cosh(min(abs(x), 300.0)) ** 2, -a]]), MOVING

    exact = nu * nu - a * a / 4
    for ends in ((st.Wall(0, [[a / 2, 1]]), st.Infinity()), (st.Infinity(), st.Wall(0, [[a / 2, 1]]))):
        mode = st.refine(st.problem(2, pencil, *ends), exact * 1.02)
        assert abs(mode.sigma - exact) <= mode.error < 1e-9


def test_no_solution_or_all_of_them_decay() -> None:
    """The inside of the parabola, asked for by its own reference: nothing decays to the left, and the ends are told all the same."""
    problem = st.problem(2, lambda x: well(x, 0.3), st.Infinity(), st.Infinity(), reference=-1.0)
    left, right = problem.ends(-1.0)
    assert (left.decaying, right.decaying) == (0, 2)
    assert left.gap == right.gap == math.inf
    assert left.margin == pytest.approx(0.15)
    assert right.margin == pytest.approx(0.15)


def test_a_front_of_nagumo() -> None:
    """u_t = u_xx + c u_x + u(1 − u)(u − α), u = 1/(1 + e^{−x/√2}), c = (2α − 1)/√2: translation is the one mode right of the spectrum."""
    alpha = 0.3
    c = (2 * alpha - 1) / math.sqrt(2)

    def pencil(x: float) -> tuple[Any, Any]:
        u = 1 / (1 + math.exp(-max(min(x, 900.0), -900.0) / math.sqrt(2)))
        return np.array([[0, 1], [3 * u * u - 2 * (1 + alpha) * u + alpha, -c]]), MOVING

    problem = st.problem(2, pencil, st.Infinity(), st.Infinity())
    zero = st.find(problem, st.Disc(0.05, 0.2)).modes
    assert len(zero) == 1
    assert abs(zero[0].sigma) < 1e-10
    assert st.count(problem, st.Rectangle(0.05 - 1j, 2 + 1j)) == 0


def test_three_equations_as_in_fitzhugh_nagumo() -> None:
    """v_t = Lv − w, w_t = c w_x − γ w: triangular, so that L's eigenvalue is the whole's."""
    D1 = np.zeros((3, 3))
    D1[1, 0], D1[2, 2] = 1, 1 / 0.7

    def pencil(x: float) -> tuple[Any, Any]:
        D0 = np.zeros((3, 3))
        D0[:2, :2] = well(x, 0.3)[0]
        D0[1, 2], D0[2, 2] = 1, 0.4 / 0.7
        return D0, D1

    problem = st.problem(3, pencil, st.Infinity(), st.Infinity())
    assert [end.decaying for end in problem.ends(0.1)] == [2, 1]
    mode = st.refine(problem, 0.16)
    assert abs(mode.sigma - exact_well(0.3)) <= mode.error < 1e-9


def test_the_soliton_of_kdv_in_a_weighted_space() -> None:
    """R. L. Pego & M. I. Weinstein (1994): with e^{ax} v the essential spectrum moves left and σ = 0 is a mode of multiplicity 2."""
    a = 0.4
    shift = np.array([[1, 0, 0], [-a, 1, 0], [a * a, -2 * a, 1]])  # v, v′, v″ times e^{ax} from w, w′, w″
    D1 = np.zeros((3, 3))
    D1[2] = -shift[0]

    def pencil(x: float) -> tuple[Any, Any]:
        """σ v = −v‴ + v′ − 6 (u v)′, u = ½ sech²(x/2)."""
        x = max(min(x, 600.0), -600.0)
        u = 0.5 / math.cosh(x / 2) ** 2
        # v‴ = −σ v + v′ − 6 u v′ − 6 u′ v, and e^{ax} v‴ = w‴ − 3a w″ + 3a² w′ − a³ w
        third = (1 - 6 * u) * shift[1] + 6 * u * math.tanh(x / 2) * shift[0]
        D0 = np.array([[0, 1, 0], [0, 0, 1], third + np.array([a**3, -3 * a * a, 3 * a])])
        return D0, D1

    problem = st.problem(3, pencil, st.Infinity(), st.Infinity())
    assert [end.decaying for end in problem.ends(0.1)] == [2, 1]
    assert st.count(problem, st.Disc(0, 0.1)) == 2
    assert st.count(problem, st.Rectangle(0.1 - 2j, 3 + 2j)) == 0


def test_shocks() -> None:
    """Neither has a mode right of its spectrum: Burgers, integrated (w_xx + tanh(x/2) w_x = σ w), and isothermal Navier–Stokes.

    The latter is (2.20) of J. Humpherys, O. Lafitte & K. Zumbrun, Commun. Math. Phys. 293 (2010), for γ = 1, whose profile is a tanh.
    """
    strength = 0.2

    def burgers(x: float) -> tuple[Any, Any]:
        return np.array([[0, 1], [0, -math.tanh(x / 2)]]), MOVING

    def viscous(x: float) -> tuple[Any, Any]:
        V = strength + (1 - strength) / (1 + math.exp(min((1 - strength) * x, 700.0)))
        D0 = np.array([[0, 0, 1], [0, 0, 1], [0, 0, 2 * V - strength - 1]])
        return D0, np.array([[0, 1, 0], [0, 0, 0], [V, V, -1]])

    for size, pencil in ((2, burgers), (3, viscous)):
        problem = st.problem(size, pencil, st.Infinity(), st.Infinity())
        assert sum(end.decaying for end in problem.ends(1.0)) == size
        assert st.count(problem, st.Rectangle(0.05 - 1j, 2 + 1j)) == 0


# other conventions for the eigenvalue


def limits(D0: Any, D1: Any) -> dict[int, AsymptoticPencil]:
    n = len(D0)
    one, none = np.eye(n, dtype=np.complex128), np.zeros((n, n), dtype=np.complex128)
    return {side: AsymptoticPencil(Pencil(one, none, np.array(D0, complex), np.array(D1, complex)), side) for side in (-1, 1)}


@pytest.mark.parametrize(
    ("D0", "D1", "counts", "direction"),
    [
        ([[0, 1], [0, 0]], [[0, 0], [-1, 0]], {-1: 1, 1: 1}, -1),  # −y″ = λ y
        ([[0, 1], [0, -0.3]], [[0, 0], [-1, 0]], {-1: 1, 1: 1}, -1),  # −y″ − 0.3 y′ = λ y: to the right is the inside of its parabola
        ([[0, 1], [0, -1000.0]], [[0, 0], [-1, 0]], {-1: 1, 1: 1}, -1),  # and of a wide one
        ([[0, 1], [0, 0]], [[0, 0], [1j, 0]], {-1: 1, 1: 1}, 1),  # Schrödinger: either side of iR
        ([[0]], [[1j]], {-1: 0, 1: 1}, 1j),  # u_t + u_x = 0 in ω, e^{−iωt}
        (np.eye(4, k=1), np.eye(4, k=-3), {-1: 2, 1: 2}, -1),  # a beam, y⁗ = λ y
    ],
    ids=["lambda", "advection", "strong advection", "dispersive", "frequency", "beam"],
)
def test_the_direction_that_keeps_away_from_the_essential_spectrum(D0: Any, D1: Any, counts: dict[int, int], direction: complex) -> None:
    ends = limits(D0, D1)
    found = consistent_splitting(EndConditions(len(D0), {}, ends, {}), None)
    assert found.counts == counts
    assert found.reference / abs(found.reference) == direction


def test_units_do_not_matter() -> None:
    """The same splitting, and a reference that scales, for time in units of 1e-12 and 1e12."""
    for unit in (1e-12, 1.0, 1e12):
        found = consistent_splitting(EndConditions(2, {}, limits([[0, 1], [0.5, -0.3]], [[0, 0], [unit, 0]]), {}), None)
        assert found.counts == {-1: 1, 1: 1}
        assert 1e-3 < found.reference.real * unit < 1e3
