"""Paths in the complex z-plane: D itself on the side of the real axis, its continuation on the other; no distance changes the cost."""

from __future__ import annotations

import numpy as np
import pytest

import shootstab as st
from shootstab.core.regions import Disc
from shootstab.discriminants.continuation import Continuation, Undecidable
from shootstab.discriminants.deformed_path import DeformedPath
from shootstab.discriminants.frame import Frame
from shootstab.essential_spectrum.interior import SampledContinuum, continuum_of
from shootstab.models.chute import ChuteProblem
from shootstab.models.gallery.poiseuille import PlanePoiseuille
from shootstab.roots.winding import wind

PLACE = 15.0
SCALE = 7.3  # T_∞ of the high flow
BELOW, ABOVE = DeformedPath(PLACE, 5.0, -4.0), DeformedPath(PLACE, 5.0, 4.0)


@pytest.fixture(scope="module")
def fig2(scenes: dict[str, ChuteProblem]) -> ChuteProblem:
    return scenes["fig2"]


def sigma_at(problem: ChuteProblem, z: complex) -> complex:
    return complex(problem.continuum(np.array([z]))[0])


def test_a_deformed_path_keeps_the_ends_of_the_path() -> None:
    for nodes in (np.array([30.0, 20.0, 12.0, 3.0, 0.0]), np.array([-1.0, 0.0, 14.0, 16.0])):
        bent = BELOW.deform(nodes)
        assert bent[0] == nodes[0]
        assert bent[-1] == nodes[-1]
        assert PLACE - 4j in bent
        assert (np.abs(np.diff(bent)) > 0).all()


@pytest.mark.parametrize("offset", [2e-1, 2e-2, 1e-4])
def test_the_side_of_the_real_axis_gives_D_itself(fig2: ChuteProblem, offset: float) -> None:
    """z_s above the real axis is passed below, and the other way round."""
    for sign, same, other in ((1, BELOW, ABOVE), (-1, ABOVE, BELOW)):
        sigma = sigma_at(fig2, PLACE + 1j * sign * offset * SCALE)
        straight = Frame(rtol=1e-11).on(fig2)(sigma)
        assert Frame(rtol=1e-11).on(fig2, same)(sigma).over(straight) == pytest.approx(1.0, abs=3e-9)
        assert abs(Frame(rtol=1e-11).on(fig2, other)(sigma).over(straight) - 1.0) > 0.1


@pytest.mark.parametrize("path", [BELOW, ABOVE])
def test_the_continuation_is_analytic_across_the_curve(fig2: ChuteProblem, path: DeformedPath) -> None:
    """Cauchy's formula on a circle that the continuous spectrum crosses: the mean is the value at the centre, on the curve itself."""
    centre = sigma_at(fig2, PLACE)
    radius, continued = 0.1 * abs(centre), Frame(rtol=1e-11).on(fig2, path)
    middle = continued(centre)
    ring = [continued(centre + radius * np.exp(2j * np.pi * k / 48)).at_scale(middle.log_scale) for k in range(48)]
    assert np.mean(ring) == pytest.approx(middle.mantissa, rel=1e-8)
    assert wind(continued, Disc(centre, radius)).closure < 0.5


def test_the_cost_does_not_depend_on_the_distance(fig2: ChuteProblem) -> None:
    steps = []
    for offset in (1e-2, 1e-4, 1e-8, 1e-10, 0.0):
        shooting = Frame(rtol=1e-10).on(fig2, BELOW)
        shooting(sigma_at(fig2, PLACE + 1j * offset * SCALE))
        steps.append(shooting.at(sigma_at(fig2, PLACE + 1j * offset * SCALE)).steps)
    assert max(steps) <= 1.2 * min(steps)


def test_singular_points_are_found(fig2: ChuteProblem) -> None:
    continuum = continuum_of(fig2)
    assert continuum is not None
    for z in (5.0 + 0.5j, 15.0 - 1e-6j, 40.0 + 1j):
        assert continuum.singular_point(sigma_at(fig2, z)) == pytest.approx(z, abs=1e-9)


class KnownNextToTheAxis:
    """σ_c = −1/(1 + z) on 0 ≤ z ≤ 9, of a base flow that is not continued further than 1/4 off the real axis."""

    def heights(self, count: int) -> np.ndarray:
        return np.linspace(0.0, 9.0, count)

    def __call__(self, z: np.ndarray) -> np.ndarray:
        if (np.abs(z.imag) > 0.25).any():
            raise st.ConvergenceError("the base flow cannot be continued")
        return -1 / (1 + z)


def test_a_singular_point_where_the_flow_is_not_known_is_none_of_concern() -> None:
    """Its path is the real axis, on which D is D itself: the search for it ends, and raises nothing."""
    curve = KnownNextToTheAxis()
    z = curve.heights(2001)
    continuum = SampledContinuum(curve, z, curve(z.astype(complex)))
    assert continuum.singular_point(-1 / (1 + 3 + 0.2j)) == pytest.approx(3 + 0.2j)
    assert continuum.singular_point(-1 / (1 + 3 + 0.5j)) is None


def test_branches(fig2: ChuteProblem) -> None:
    """Far off, D along the real axis; near, along one path on the own side; across, along two; at an end of the curve, along none."""
    continuation = Continuation(fig2, Frame(rtol=1e-9))
    assert continuation.branches(0.01 + 0.01j, 1e-4)[0].path == "real"
    near = sigma_at(fig2, PLACE + 0.5j)
    (branch,) = continuation.branches(near, 1e-6)
    assert "below" in branch.path
    on = sigma_at(fig2, PLACE)
    assert sorted(c.side for c in continuation.branches(on, 1e-6)) == [-1, 1]
    with pytest.raises(Undecidable, match="end at the wall"):
        continuation.branches(sigma_at(fig2, 0.0), 1e-6)
    with pytest.raises(Undecidable, match="end at infinity"):
        continuation.branches(sigma_at(fig2, fig2.flow.height(1e-14)), 1e-6)


def test_sides_tell_modes_from_resonances(fig2: ChuteProblem) -> None:
    continuation = Continuation(fig2, Frame(rtol=1e-9))
    below = next(c for c in continuation.branches(sigma_at(fig2, PLACE), 1e-6) if c.side == 1)
    assert continuation.own_side(below, sigma_at(fig2, PLACE + 0.2j), 0.0)
    assert not continuation.own_side(below, sigma_at(fig2, PLACE - 0.2j), 0.0)
    with pytest.raises(Undecidable, match="on the continuous spectrum"):
        continuation.own_side(below, sigma_at(fig2, PLACE), 0.0)


def test_a_problem_without_continuous_spectrum_has_one_branch_everywhere() -> None:
    continuation = Continuation(PlanePoiseuille(), Frame(rtol=1e-9))
    assert len(continuation.branches(0.1j, 0.05)) == 1
    assert continuation.distance(0.1j) == np.inf


def test_a_circle_through_which_a_curve_passes_twice_has_no_branches() -> None:
    """Rayleigh's equation with U = (z − ½)²: its continuous spectrum −iU is run through twice, from one wall and from the other."""

    def pencil(z: float) -> tuple[np.ndarray, ...]:
        u = 1j * (z - 0.5) ** 2
        singular, ideal = np.array([[1, 0], [0, u]]), np.array([[0, 1], [u + 2j, 0]])
        return singular, np.diag([0.0, 1.0]), ideal, np.array([[0.0, 0.0], [1.0, 0.0]])

    walls = st.Wall(0, [[1, 0]]), st.Wall(1, [[1, 0]])
    parabola = st.problem(2, pencil, *walls, continuum=lambda z: -1j * (z - 0.5) ** 2)
    with pytest.raises(Undecidable, match=r"the continuous spectrum passes 2 times through the circle of 1\.0e-03"):
        Continuation(parabola, Frame(rtol=1e-9)).branches(-0.1j, 1e-3)


def test_a_zero_on_the_continuous_spectrum_of_an_end_is_on_no_side() -> None:
    """y″ + 2 sech² z y = σ y: σ ≤ 0 is continuous spectrum, around which no path in z leads."""
    shift = np.array([[0.0, 0.0], [1.0, 0.0]])
    well = st.problem(2, lambda z: (np.array([[0, 1], [-2 / np.cosh(z) ** 2, 0]]), shift), st.Infinity(), st.Infinity())
    continuation = Continuation(well, Frame(rtol=1e-9))
    branch = continuation.at(0.5)
    assert continuation.own_side(branch, 1.0, 0.0)
    with pytest.raises(Undecidable, match="a zero of D lies on the continuous spectrum of an end at infinity"):
        continuation.own_side(branch, -1.0, 0.0)


def test_problems_of_one_flow_and_one_kx_share_the_samples_of_their_continuous_spectrum(scenes) -> None:
    flow, kx = scenes["fig2"].flow, scenes["fig2"].kx
    one, other, elsewhere = (continuum_of(st.chute.problem(flow, *wave)) for wave in ((kx, 0.0), (kx, 0.01), (2 * kx, 0.0)))
    assert one is other is not elsewhere
    assert one is not None and elsewhere is not None
    # the wave is carried with the flow: Im σ_c = −k_x u to rounding, and k_x shifts nothing else
    np.testing.assert_allclose(elsewhere.sigma, one.sigma + 1j * one.sigma.imag, rtol=1e-9)
