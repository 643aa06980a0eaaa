"""A zero between two points: to the last places, of steep, flat and high-order functions, in a bounded number of evaluations."""

from __future__ import annotations

import math

import pytest
from scipy.optimize import brentq

from shootstab.roots.bracket import zero_between

CASES = [
    (lambda x: x**3 - 2.0, 0.0, 3.0),
    (lambda x: math.exp(20 * x) - 5.0, -3.0, 3.0),
    (lambda x: math.atan(1e3 * (x - 0.3)), -1.0, 1.0),
    (lambda x: x**3 - x**2 / 7, 0.1, 3.0),
    (lambda x: math.cos(x) - x, 0.0, 1.0),
    (lambda x: x - 1e-9, -1.0, 1.0),
]


@pytest.mark.parametrize(("f", "low", "high"), CASES)
def test_the_zero_is_the_one_of_brent(f, low, high):
    counted = []

    def watched(x):
        counted.append(x)
        return f(x)

    for ends in ((low, high), (high, low)):
        x = zero_between(watched, *ends)
        assert x == pytest.approx(brentq(f, low, high, xtol=1e-15, rtol=1e-15), rel=4e-15, abs=1e-14)
    assert len(counted) <= 320
    assert all(low <= x <= high for x in counted)


def test_ends_that_are_zeros_and_ends_of_one_sign():
    assert zero_between(lambda x: x, 0.0, 1.0) == 0.0
    assert zero_between(lambda x: x - 1, 0.0, 1.0) == 1.0
    with pytest.raises(ValueError, match=r"no change of sign between 1\.0 and 2\.0"):
        zero_between(lambda x: x, 1.0, 2.0)
