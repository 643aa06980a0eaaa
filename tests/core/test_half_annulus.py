"""Half-annuli as regions: a closed boundary, counter-clockwise, and what lies inside."""

from __future__ import annotations

import numpy as np
import pytest

import shootstab as st

REGION = st.HalfAnnulus(0.3 - 0.2j, 0.5, 2.0)


def test_the_boundary_runs_once_around_what_is_inside() -> None:
    t = np.linspace(0.0, 1.0, 2001)
    z = np.array([REGION.boundary(float(x)) for x in t])
    assert abs(z[0] - z[-1]) < 1e-12
    for sigma in (0.3 + 0.9 - 0.2j, 0.4 + 1.2j, 0.0 - 0.2j, 0.4 - 0.2j, 3.0 + 0j):
        turns = np.angle((z[1:] - sigma) / (z[:-1] - sigma)).sum() / (2 * np.pi)
        assert round(turns) == int(REGION.contains(sigma))
    assert all(abs(REGION.parameter(REGION.boundary(x)) - x) < 1e-9 for x in (0.1, 0.3, 0.6, 0.9))


def test_the_hull_holds_the_boundary() -> None:
    corners = np.array(REGION.hull)
    sides = np.roll(corners, -1) - corners
    for x in np.linspace(0.0, 1.0, 101):
        away = REGION.boundary(float(x)) - corners
        assert (np.imag(np.conj(sides) * away) > -1e-12).all()


def test_modes_in_it_are_counted_in_doubles_too() -> None:
    string = st.equations(["y"], ["d(y,2) = -sigma*y"], st.Conditions(0, ["y"]), st.Conditions(1, ["y"]))
    assert st.count(string, st.HalfAnnulus(0.0, 20.0, 100.0)) == 2  # 4π² and 9π²


@pytest.mark.parametrize(("inner", "outer"), [(0.0, 1.0), (2.0, 1.0), (1.0, float("inf"))])
def test_radii_that_are_none_are_refused(inner: float, outer: float) -> None:
    with pytest.raises(st.InputError, match="allowed are finite numbers, the radii above 0 and the smaller one first"):
        st.HalfAnnulus(0.0, inner, outer)
