"""Modes and resonances at any distance from a curved continuous spectrum, where D is known in closed form.

(σ − σ_c(z)) y₁′ = y₂, y₂′ = 0 with y₁(−1) = a y₂ and y₁(1) = 0 has D = a + ∫ dz/(σ − σ_c(z)), over a path that leaves the singular point on
its side. With a = −∫ at a chosen σ that is a zero of D continued from one side: a mode if σ lies on it, and otherwise a resonance.
"""

from __future__ import annotations

import math
import re

import numpy as np
import pytest
from scipy.integrate import quad

import shootstab as st
from shootstab.analyses.affordable import Affordable
from shootstab.analyses.zeros import zeros_in
from shootstab.core.errors import OnSpectrum
from shootstab.core.regions import Disc
from shootstab.discriminants.continuation import Continuation
from shootstab.problems import LinearProblem
from shootstab.roots.iterations import newton

X = 0.37317  # between two samples of the curve, whose segments leave it by 1e-7 there


def curve(z):
    return -1j * z + z * z


def integral(sigma: complex) -> complex:
    """∫ dz/(σ − σ_c(z)) from −1 to 1 through −i, below all singular points in question."""

    def along(t: float) -> complex:
        z = -np.exp(1j * t)
        return 1j * z / (sigma - curve(z))

    parts = [quad(lambda t, k=k: (along(t).real, along(t).imag)[k], 0.0, np.pi, epsabs=1e-14, epsrel=1e-13)[0] for k in (0, 1)]
    return complex(*parts)


def with_zero_at(sigma: complex) -> LinearProblem:
    c1, d1 = np.diag([1.0, 0.0]), np.zeros((2, 2))

    def pencil(z: float) -> tuple[np.ndarray, ...]:
        return np.diag([-curve(z), 1.0]), c1, np.eye(2, k=1) + 0j, d1

    return st.problem(2, pencil, st.Wall(-1, [[1, integral(sigma)]]), st.Wall(1, [[1, 0]]), continuum=curve)


@pytest.mark.parametrize("offset", [1e-5, 1e-8, 1e-10])
def test_a_mode_is_found_and_a_resonance_is_none_however_near_they_lie(offset: float) -> None:
    """Discs that the curve crosses between two of its samples were taken for discs that it does not."""
    for side in (1, -1):
        sigma = curve(X + 1j * side * offset)
        problem = with_zero_at(sigma)
        disc = Disc(sigma + 0.2 * offset, 3.0 * offset)
        if offset > 1e-10:  # beyond, D is noise on so small a circle
            assert st.count(problem, disc) == (side > 0)
            assert len(st.find(problem, disc).modes) == (side > 0)
        claim = curve(X + 1j * (side + min(0.3, 1e-7 / offset)) * offset)
        (verdict,) = st.verify(problem, [claim], digits=6, missing="none").verdicts
        assert verdict.verdict == ("confirmed" if side > 0 else "spurious")


def test_a_disc_on_both_sides_tells_modes_from_resonances() -> None:
    offset = 1e-8
    problem = with_zero_at(curve(X - 1j * offset))
    found = zeros_in(Continuation(problem, st.Frame(rtol=1e-10)), Disc(curve(X + 0.3j * offset), 3 * offset))
    assert found.modes == ()
    assert [zero.sigma for zero in found.resonances] == [pytest.approx(curve(X - 1j * offset), abs=1e-9)]


def test_a_zero_nearer_than_its_error_lies_on_the_spectrum_and_one_farther_does_not() -> None:
    offset = 1e-10
    sigma = curve(X - 1j * offset)
    problem, disc = with_zero_at(sigma), Disc(sigma, 1e-8)
    with pytest.raises(OnSpectrum, match=r"a zero of D lies on the continuous spectrum to its error of 3.*e-10, at 0.13925"):
        zeros_in(Continuation(problem, st.Frame(rtol=1e-10)), disc)
    assert len(zeros_in(Continuation(problem, st.Frame(rtol=1e-12)), disc).resonances) == 1


def test_a_mode_next_to_the_spectrum_is_refined_up_to_its_error() -> None:
    sigma = curve(X + 1e-11j)
    mode = st.refine(with_zero_at(sigma), guess=sigma + 1e-6, rtol=1e-12)
    assert mode.converged
    assert abs(mode.sigma - sigma) < mode.error < 0.1 * mode.continuum_distance
    assert mode.continuum_distance == pytest.approx(1.2478e-11, rel=1e-2)
    sigma = curve(X + 1e-14j)
    lost = st.refine(with_zero_at(sigma), guess=curve(X + 1e-7j), rtol=1e-12)
    assert re.search(r"(passes at 1\.\de-14, inside the error bound \d\.\de-13|lies on the continuous spectrum to the error)", lost.status)


def test_a_resonance_to_which_a_search_comes_is_told_as_one() -> None:
    """The guess lies on the side from which D has a zero; D itself has none, and leads elsewhere, to infinity."""
    sigma = curve(X - 1e-8j)
    lost = st.refine(with_zero_at(sigma), guess=curve(X + 1e-7j))
    told = "the zero at 0.139256-0.37317j is one of D continued from the other side of the continuous spectrum, and none of D itself"
    assert told in lost.status


def test_a_search_that_runs_away_is_ended() -> None:
    """From the side where D has no zero Newton's steps grow without end; that D is constant out there was once taken for an arrival."""
    guess = curve(X - 1e-2j)
    D = Continuation(with_zero_at(curve(X - 1e-8j)), st.Frame(rtol=1e-10)).along(guess)[0]
    root = newton(Affordable(D, guess), guess, 1e-10)
    assert not root.converged
    assert abs(root.sigma) > 1e15
    lost = st.refine(with_zero_at(curve(X - 1e-8j)), guess)
    assert not lost.converged
    assert lost.error == math.inf


def test_a_guess_on_the_wrong_side_of_the_spectrum_means_the_mode_across() -> None:
    """D itself has no zero at such a guess, and its continuation from where the mode lies has."""
    sigma = curve(X + 1e-8j)
    mode = st.refine(with_zero_at(sigma), guess=curve(X - 1e-6j), rtol=1e-9)
    assert mode.converged
    assert abs(mode.sigma - sigma) < mode.error < 1e-10


def test_a_boundary_that_rounds_to_more_than_where_the_curve_crosses_it_is_followed() -> None:
    """A disc of 1e-8 of σ has a boundary of eight digits: nearer than that the sides of a crossing are not told apart."""
    rng = np.random.default_rng(3)
    sigma = curve(X - 5e-9j)
    problem = with_zero_at(sigma)
    for angle in rng.uniform(0.0, 2 * np.pi, 6):
        disc = Disc(sigma + 5e-9 * np.exp(1j * angle), 1.1e-8)
        assert st.count(problem, disc) == 0
