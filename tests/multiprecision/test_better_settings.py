"""multiprecision/settings: what is computed better for the bound has an error that is small beside the first one's."""

from __future__ import annotations

import mpmath
import pytest

import shootstab as st

pytest.importorskip("flint")


@pytest.mark.parametrize("digits", [22, 25, 28])
def test_the_better_integration_shows_nearly_all_of_the_error(digits: int) -> None:
    """At 25 digits one with half as many more terms kept two thirds of the error, and the bound was broken by 3 %."""
    walls = st.Conditions(0, ["y"]), st.Conditions(1, ["y"])
    string = st.equations(["y"], ["d(y,2) + (-1.965*sin(-2.499*z) + 1.112)*y - sigma*y"], *walls)
    guess = complex(st.refine(string, -8.75, rtol=1e-9).sigma)
    truth, mode = st.refine(string, guess, digits=50), st.refine(string, guess, digits=digits)
    with mpmath.workdps(60):
        assert abs(mode.sigma - truth.sigma) < 0.6 * mpmath.mpf(mode.error)
