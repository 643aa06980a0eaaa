"""Branches on which the promise of a count or a verdict rests: resonances, cuts, circles, repetitions that are refused, each reached."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import shootstab as st
from shootstab.analyses.accuracy import Tightening
from shootstab.analyses.count import counted_twice
from shootstab.analyses.cut_region import RegionCount, count_in_region
from shootstab.analyses.multiple import cluster, multiple
from shootstab.analyses.verdicts import Circle, verdict_on
from shootstab.core.errors import ConvergenceError, Inaccurate, Undecidable
from shootstab.core.records import CONFIRMED, CONVERGED, Budget, Mode
from shootstab.discriminants.continuation import Continuation

FIXED = [[1.0, 0.0]]
FIRST = -(math.pi**2)


def string() -> st.LinearProblem:
    """y″ = σy with y = 0 at 0 and 1: σ = −(kπ)²."""
    D0, D1 = np.array([[0.0, 1.0], [0.0, 0.0]]), np.array([[0.0, 0.0], [1.0, 0.0]])
    return st.problem(2, lambda z: (D0, D1), st.Wall(0, FIXED), st.Wall(1, FIXED))


def advected_well(a: float) -> st.LinearProblem:
    """y″ + 2ay′ + 2 sech² x y = σy: y = e^{−ax} sech x has σ = 1 − a², and decays at both ends for a < 1 only."""

    def pencil(x: float) -> tuple[Any, Any]:
        return np.array([[0, 1], [-2 / np.cosh(x) ** 2, -2 * a]], complex), np.array([[0, 0], [1, 0]], complex)

    return st.problem(2, pencil, st.Infinity(), st.Infinity())


def rayleigh(alpha: float, U: Callable[[Any], Any], U_zz: Callable[[Any], Any], wall: float) -> st.LinearProblem:
    """Rayleigh's equation between walls at ±wall: C is singular where σ = −iαU(y)."""
    a2 = alpha * alpha

    def pencil(y: complex) -> tuple[Any, ...]:
        D0 = np.array([[0, 1], [1j * alpha * (U(y) * a2 + U_zz(y)), 0]])
        return np.diag([1, 1j * alpha * U(y)]), np.diag([0, 1]), D0, np.array([[0, 0], [a2, 0]])

    return st.problem(2, pencil, st.Wall(-wall, FIXED), st.Wall(wall, FIXED), continuum=lambda y: -1j * alpha * U(y))


def test_a_zero_beyond_the_spectrum_of_an_end_is_a_resonance_for_all_that_ask() -> None:
    beyond = advected_well(1.2)
    mode = st.refine(beyond, -0.43)
    assert "lies beyond the continuous spectrum of an end at infinity: a resonance, not a mode" in mode.status
    assert "reference = a sigma in it names them" in mode.status
    report = st.verify(beyond, [-0.44])
    assert report.verdicts[0].verdict == "spurious"
    assert "lies beyond the continuous spectrum: a resonance, not a mode" in report.verdicts[0].why
    with pytest.raises(Undecidable, match="the region lies beyond the continuous spectrum of an end at infinity"):
        st.count(beyond, st.Rectangle(-0.5 - 0.05j, -0.4 + 0.05j))


def test_the_same_zero_is_a_mode_where_it_decays() -> None:
    mode = st.refine(advected_well(0.5), 0.74)
    assert mode.converged
    assert abs(mode.sigma - 0.75) <= mode.error


def test_a_spectrum_that_runs_over_itself_is_not_cut() -> None:
    parabola = rayleigh(1.0, lambda y: y * y, lambda y: -2.0 + 0.0 * y, 1.0)
    with pytest.raises(Undecidable, match="the continuous spectrum runs over itself inside the region"):
        st.count(parabola, st.Rectangle(-0.1 - 0.6j, 0.1 - 0.3j))


def test_an_end_of_the_spectrum_on_the_boundary_is_named() -> None:
    layer = rayleigh(0.97, np.tanh, lambda y: 2.0 * np.tanh(y) * (1 - np.tanh(y) ** 2), 3.0)
    with pytest.raises(Undecidable, match=r"an end of the continuous spectrum, .*0\.965203j, lies on the boundary of the region"):
        st.count(layer, st.Rectangle(complex(-0.1, -0.97 * math.tanh(3.0)), 0.1 + 0.3j))


def test_a_contour_that_takes_too_many_samples_is_given_up() -> None:
    with pytest.raises(Inaccurate, match="or has too many zeros next to it: 6 samples do not follow it"):
        count_in_region(Continuation(string(), st.Frame(rtol=1e-6)), st.Rectangle(-20 - 1j, -1 + 1j), most=5)


class Twice(Tightening):
    """A first count of a region that is cut, and none of any part of it."""

    def __init__(self) -> None:
        super().__init__(Continuation(string(), st.Frame(rtol=1e-6)))
        self.asked = 0

    def first(self, ask: Any) -> Any:
        self.asked += 1
        if self.asked > 1:
            raise ConvergenceError("a mode lies on the cut")
        return next(iter(self)), RegionCount(1, 0.0, (), 0, (), True)


def test_a_cut_region_whose_count_cannot_be_repeated_is_refused() -> None:
    with pytest.raises(Undecidable, match="the continuous spectrum enters could not be repeated: a mode lies on the cut"):
        counted_twice(Twice(), st.Rectangle(-1 - 1j, 1 + 1j))


def test_a_cluster_is_counted_or_refused_and_told_in_the_accuracy_asked_for() -> None:
    continuation = Continuation(string(), st.Frame(rtol=1e-8))
    for wrong in (2, 3):  # the circles end before the next mode is in them
        told = rf"no circle around -9\.869\d+\+0j, up to one of 8\.0e-01, is found in which D counts {wrong} modes for certain"
        with pytest.raises(ConvergenceError, match=told):
            cluster(continuation, FIRST + 0j, 0.1, wrong)
    held = multiple(continuation, cluster(continuation, FIRST + 0j, 0.1), 1e-30)
    assert held.status.startswith("not converged: 1 mode lies within")
    assert abs(held.sigma - FIRST) <= held.error


def test_two_claims_of_one_simple_mode_are_one_too_many() -> None:
    report = st.verify(string(), [FIRST, FIRST * (1 + 1e-4)], missing="none")
    assert [v.verdict for v in report.verdicts] == ["confirmed", "spurious"]
    assert report.verdicts[1].why.startswith("is farther from the mode than claim 1, and the mode is simple")


def test_what_is_confirmed_together_says_so() -> None:
    modes = [Mode(sigma, 1e-12, Budget(1e-12, 0.0, 0.0, 0.0, 0.0), CONVERGED, "frame", 1, 0.0) for sigma in (0.1 + 0j, 0.1 + 3e-7j)]
    together = verdict_on(0.1 + 1e-7j, modes[0], Circle(1e-6, 0.0, 6, modes, claims=2))
    assert (together.verdict, together.why) == (CONFIRMED, "2 zeros of D and 2 claims within 1.0e-06, confirmed together")
    double = Mode(0.1 + 0j, 1e-9, Budget(1e-9, 0.0, 0.0, 0.0, 0.0), CONVERGED, "frame", 1, 0.0, multiplicity=2)
    one = verdict_on(0.1 + 0j, double, Circle(1e-6, 1e-6, 6, [double], claims=2, counted=True))
    assert one.verdict == CONFIRMED
    assert one.why == (
        "a zero of multiplicity 2, or as many not told apart, within 1.0e-06, the absolute accuracy next to 0, and 2 of the claims"
    )
