"""The curve of continuous spectrum between its samples: how near a point lies to it, and whether a small disc meets it."""

from __future__ import annotations

import numpy as np
import pytest

import shootstab as st
from shootstab.core.regions import Disc
from shootstab.essential_spectrum.interior import SampledContinuum, continuum_of

X = 0.37317  # between two samples


class Parabola:
    """σ_c = −iz + z² over −1 … 1, sampled every thousandth: between samples it leaves their segments by up to 2.5e-7."""

    def heights(self, points: int) -> np.ndarray:
        return np.linspace(-1.0, 1.0, points)

    def __call__(self, z: np.ndarray) -> np.ndarray:
        return -1j * z + z * z


@pytest.fixture(scope="module")
def parabola() -> SampledContinuum:
    curve = Parabola()
    z = curve.heights(2001)
    return SampledContinuum(curve, z, curve(z.astype(complex)))


def beside(parabola: SampledContinuum, distance: float) -> complex:
    """The point at this distance from the curve on its normal at X, on the left of rising z for a positive one."""
    slope = -1j + 2 * X
    return parabola.at(X) + 1j * slope / abs(slope) * distance


@pytest.mark.parametrize("distance", [1e-2, 1e-5, 1e-7, 1e-10, 1e-13])
def test_the_distance_is_that_of_the_curve_and_not_of_the_segments_between_its_samples(parabola: SampledContinuum, distance: float) -> None:
    for side in (1, -1):
        assert parabola.distance(beside(parabola, side * distance)) == pytest.approx(distance, rel=2e-4, abs=1e-15)


def test_a_point_of_the_curve_between_samples_lies_on_it(parabola: SampledContinuum) -> None:
    assert parabola.nearest(parabola.at(X))[0] > 1e-8
    assert parabola.distance(parabola.at(X)) < 1e-14


@pytest.mark.parametrize("radius", [1e-3, 1e-6, 1e-8, 1e-11])
def test_a_disc_is_passed_where_the_curve_comes_nearer_than_its_radius(parabola: SampledContinuum, radius: float) -> None:
    for side in (1, -1):
        assert parabola.passes(beside(parabola, side * 0.99 * radius), radius) == [pytest.approx(X, abs=radius)]
        assert parabola.passes(beside(parabola, side * 1.01 * radius), radius) == []


def test_more_samples_lie_on_the_curve_and_keep_the_order_of_heights(parabola: SampledContinuum) -> None:
    disc = Disc(beside(parabola, 1e-9), 1e-8)
    fine = parabola.resolved(disc.centre, disc.radius)
    assert (np.diff(fine.z) > 0.0).all()
    assert fine.sigma == pytest.approx(Parabola()(fine.z + 0j), abs=0.0)
    assert len(fine.z) < len(parabola.z) + 1000
    inside = np.array([disc.contains(s) for s in fine.sigma])
    assert np.abs(np.diff(fine.sigma))[inside[1:] & inside[:-1]].max() <= 1e-8 / 16
    assert parabola.resolved(0.5 + 0.5j, 10.0) is parabola


def test_a_pole_at_the_wall_is_followed_from_next_to_it() -> None:
    """α = ω/U of a boundary layer at the wall is 1e17 of any sign to rounding, and one segment from there would pass anywhere."""

    class Pole(Parabola):
        def heights(self, points: int) -> np.ndarray:
            return np.linspace(0.0, 20.0, points)

        def __call__(self, z: np.ndarray) -> np.ndarray:
            return (0.23 - 1e-3j) / (np.tanh(z) - 1e-18)

    walls = st.Wall(0, [[1, 0]]), st.Wall(20, [[1, 0]])
    problem = st.problem(2, lambda z: (np.eye(2, k=1), np.eye(2, k=-1)), *walls, continuum=lambda z: Pole()(z))
    curve = continuum_of(problem)
    assert abs(curve.sigma[0]) == pytest.approx(0.23 / (0.01 * 1e-8), rel=1e-3)
    assert curve.distance(0.2 - 0.03j) == pytest.approx(abs(0.03 + 0.029j), rel=2e-2)


@pytest.mark.parametrize("p", [0.0, 1.0])
def test_claims_next_to_the_end_of_a_curve_at_zero_are_answered(p: float) -> None:
    """σ_c = iqz begins at 0; D does not depend on σ. Points of the curve were looked at down to 1e-308, and a slope of 0 divided by."""
    problem = st.equations(
        ["u"], ["(sigma - i*q*z)*(d(u,2) - p*u)"], st.Conditions(0, ["u"]), st.Conditions(1, ["u"]), parameters={"p": p, "q": 0.018}
    )
    found = st.verify(problem, [0.0, 1e-300, 0.3, 1e8, 1e200], missing="none")
    assert found.summary["confirmed"] == found.summary["inaccurate"] == 0
    assert [v.verdict for v in found.verdicts[2:]] == ["spurious"] * 3
