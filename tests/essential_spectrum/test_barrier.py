"""essential_spectrum: curves of the ends, known in closed form: distances to rounding, and regions that they enter anywhere."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

import shootstab as st
from shootstab.core.errors import Undecidable
from shootstab.core.regions import Disc, Rectangle
from shootstab.essential_spectrum.barrier import Barrier, barrier_of
from shootstab.essential_spectrum.curves import Curve, curve_through

MOVING = np.array([[0, 0], [1, 0]])


def sech2(x: float) -> float:
    return 1 / math.cosh(min(abs(x), 300.0)) ** 2


def kdv(x: float) -> tuple[Any, Any]:
    """σ v = −v‴ + v′ − 6 (u v)′, u = ½ sech²(x/2): σ = i(ℓ³ + ℓ), all of iR."""
    u = 0.5 * sech2(x / 2)
    D0, D1 = np.eye(3, k=1), np.zeros((3, 3))
    D0[2, :2], D1[2, 0] = [6 * u * math.tanh(x / 2), 1 - 6 * u], -1
    return D0, D1


def burgers(x: float) -> tuple[Any, Any]:
    """v″ + (tanh(x/2) v)′ = σ v: σ = −ℓ² ± iℓ, which touches 0."""
    return np.array([[0, 1], [-0.5 * sech2(x / 2), -math.tanh(x / 2)]]), MOVING


def nls(x: float) -> tuple[Any, Any]:
    """The soliton √2 sech x of the cubic equation, linearized: σ = ±i(1 + ℓ²)."""
    D0, D1 = np.zeros((4, 4)), np.zeros((4, 4))
    D0[0, 1] = D0[2, 3] = D1[1, 2] = 1
    D1[3, 0], D0[1, 0], D0[3, 2] = -1, 1 - 6 * sech2(x), 1 - 2 * sech2(x)
    return D0, D1


def whole_line(size: int, pencil: Any) -> st.LinearProblem:
    return st.problem(size, pencil, st.Infinity(), st.Infinity())


def barrier(size: int, pencil: Any) -> Barrier:
    found = barrier_of(whole_line(size, pencil))
    assert found is not None
    return found


POINTS: list[tuple[int, Any, list[complex]]] = [
    (3, kdv, [0, 1e-9j, 1e-7j, 5e-6j, 1e-5j, 1e-3j, 0.3j, -7j, 1e3j]),
    (2, burgers, [0, 1e-16, -1e-10 + 1e-5j, -1e-6 - 1e-3j, -1 + 1j, -400 + 20j]),
    (4, nls, [1j, -1j, 1.0000001j, 5j, -1e4j]),
]


@pytest.mark.parametrize(("size", "pencil", "points"), POINTS, ids=["kdv", "burgers", "nls"])
def test_a_point_of_the_curve_has_no_distance_from_it(size: int, pencil: Any, points: list[complex]) -> None:
    found = barrier(size, pencil)
    for sigma in points:
        assert found.distance(sigma) == 0.0
        assert found.enters(st.Disc(sigma, max(1e-9 * abs(sigma), 1e-12)))


def test_next_to_the_curve_the_distance_is_known_to_rounding() -> None:
    on_the_axis = barrier(3, kdv)
    for height in (0.0, 1e-7, 1e-5, 0.3, 7.0):
        for off in (1e-10, 1e-6, 1e-2, -1e-6):
            assert on_the_axis.distance(off + 1j * height) == pytest.approx(abs(off), rel=1e-2, abs=2e-14 * (1 + height))
    touching = barrier(2, burgers)
    assert touching.distance(1e-9) == pytest.approx(1e-9, rel=1e-3)
    # inside the parabola, on its axis: the point of −ℓ² ± iℓ nearest to −a lies at ℓ = 0 as long as a < ½
    assert touching.distance(-1e-4) == pytest.approx(1e-4, rel=1e-3)


@pytest.mark.parametrize("radius", [1e-12, 5e-6, 1e-3, 0.1, 10.0])
def test_regions_that_a_curve_enters_and_that_it_does_not(radius: float) -> None:
    """Small ones lie between two points of the curve, large ones hold an arc that meets no corner."""
    found = barrier(3, kdv)
    for height in (0.0, 0.123456, 2.0):
        middle = 1j * height
        assert found.enters(st.Disc(middle + 0.99 * radius, radius))
        assert found.enters(st.Rectangle(middle - radius - 1e-3j * radius, middle + radius + 1e-3j * radius))
        assert not found.enters(st.Rectangle(middle + 0.01 * radius - 1j * radius, middle + (1 + 1j) * radius)) or radius < 1e-11
        assert not found.enters(st.Disc(middle + 1.01 * radius, radius)) or radius < 1e-11


def test_a_small_region_on_a_dispersive_spectrum_is_refused_and_not_empty() -> None:
    for size, pencil, sigma in ((3, kdv, 0.0), (2, burgers, 0.0), (4, nls, 1j)):
        with pytest.raises(Undecidable, match="enters the region"):
            st.count(whole_line(size, pencil), st.Disc(sigma, 5e-6))


def test_claims_on_a_dispersive_spectrum_are_its_own() -> None:
    for size, pencil, claims in ((3, kdv, [1e-7j, 5e-6j, 1e-5j, 0.3j]), (4, nls, [1j, 1.5j])):
        report = st.verify(whole_line(size, pencil), claims, region=st.Rectangle(0.5 - 1j, 1 + 1j))
        assert [v.verdict for v in report.verdicts] == ["continuum"] * len(claims)


def test_a_boundary_beside_a_curve_is_told_apart_from_it() -> None:
    """Segments of iR from −1 to 1: a boundary parallel to them, a bow around their end, and ones that cross or touch them."""
    z = np.linspace(-1.0, 1.0, 900)
    curve = curve_through(1j * z, z)
    assert not any(curve.enters(Rectangle(gap - 0.9j, 0.5 + 0.9j)) for gap in (1e-2, 1e-8, 1e-12))
    assert not curve.enters(Disc(1.25 + 0.1j, 1.25 * (1 - 1e-6)))
    assert curve.enters(Disc(1.25 + 0.1j, 1.25 * (1 + 1e-6)))
    assert curve.enters(Rectangle(-1e-8 - 0.9j, 0.5 + 0.9j))
    assert curve.enters(Rectangle(0.0 - 0.9j, 0.5 + 0.9j))
    assert curve.enters(Rectangle(-0.5 - 0.5j, 0.5 - 0.4999j))  # between two of the points


@pytest.mark.parametrize("gap", [1e-4, 1e-6, 1e-8])
def test_a_curve_that_grazes_a_boundary_is_told_apart(gap: float) -> None:
    """σ = −ℓ² + 3iℓ, by 200 segments: its tip at 0 lies beside a straight boundary, or on its other side."""
    ell = np.linspace(-2.0, 2.0, 201) + 0.003
    points = -(ell**2) + 3j * ell
    curve = Curve(points[:-1], points[1:], ell[:-1], ell[1:], lambda t: [complex(-t * t, 3 * t)])
    assert not curve.enters(Rectangle(gap - 5j, 3 + 5j))
    assert curve.enters(Rectangle(-gap - 5j, 3 + 5j))


def test_an_advected_well_has_one_growing_mode() -> None:
    """y = e^{−3z/2} w: σ + 9/4 = 4 or 1 of the well, and growing is 7/4; its essential spectrum grazes the imaginary axis at 0.

    A reference inside the parabola has two decaying solutions at one end and none at the other, and no mode.
    """
    equation = "d(y,2) + 3*d(y) + 6*sech(z)**2*y - sigma*y"
    line = st.Infinity(), st.Infinity()
    found = st.count_unstable(st.equations(["y"], [equation], *line), 1e-4)
    assert (found.count, found.lemma) == (1, "P3")
    inside = st.equations(["y"], [equation], *line, reference=-3.0)
    assert st.count(inside, Disc(-3.0, 0.1)) == 0
    with pytest.raises(Undecidable, match="beyond the continuous spectrum of an end at infinity"):
        st.count_unstable(inside, 1e-4)


def test_a_curve_known_by_a_formula_along_a_boundary_is_refused_soon() -> None:
    z = np.linspace(-1.0, 1.0, 40)
    points = 1j * z
    curve = Curve(points[:-1], points[1:], z[:-1], z[1:], lambda t: [1j * t])
    with pytest.raises(Undecidable, match=r"runs along the boundary, within 1\.0e-08"):
        curve.enters(Rectangle(1e-8 - 0.9j, 0.5 + 0.9j))
