"""Sentences in which verdicts, searches and frames give a reason: each is reached, by the case that it speaks of."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import pytest

import shootstab as st
from shootstab.analyses.root_near import find_near
from shootstab.analyses.verdicts import Circle, verdict_on
from shootstab.core.discriminant import Value
from shootstab.core.errors import ConvergenceError, Undecidable
from shootstab.core.records import CONFIRMED, CONVERGED, UNRESOLVED, Budget, Mode
from shootstab.core.scaled import Scaled
from shootstab.problems.kato_frame import KatoFrame
from shootstab.problems.protocol import Pencil
from shootstab.problems.splitting import AsymptoticPencil
from shootstab.roots.search import Search, Zero, find
from shootstab.roots.winding import wind


@dataclass
class Function:
    """D(σ) with its derivative, as a discriminant."""

    f: Any
    slope: Any
    evaluations: int = field(default=0)

    def __call__(self, sigma: complex) -> Scaled:
        return self.with_derivative(sigma).D

    def with_derivative(self, sigma: complex) -> Value:
        self.evaluations += 1
        return Value(sigma, Scaled(self.f(sigma), 0.0), self.slope(sigma))


def mode(sigma: complex, error: float = 1e-12) -> Mode:
    return Mode(sigma, error, Budget(error, 0.0, 0.0, 0.0, 0.0), CONVERGED, "frame", 1, 0.0)


def test_two_modes_in_one_circle_and_one_claim_are_no_confirmation() -> None:
    modes = [mode(0.1 + 0j), mode(0.1 + 3e-7j)]
    both = verdict_on(0.1 + 1e-7j, modes[0], Circle(1e-6, 0.0, 6, modes, claims=1))
    assert both.verdict == UNRESOLVED
    assert both.why.startswith("2 modes lie in the circle of 1.0e-06 that 6 digits mean, and 1 of the claims")
    assert verdict_on(0.1 + 1e-7j, modes[0], Circle(1e-6, 0.0, 6, modes, claims=2)).verdict == CONFIRMED


def test_a_mode_whose_bound_reaches_over_the_circle_may_lie_on_either_side() -> None:
    found = mode(0.1 + 0j, error=5e-7)
    said = verdict_on(0.1 + 8e-7j, found, Circle(1e-6, 0.0, 6, [found], claims=1))
    assert said.verdict == UNRESOLVED
    assert "may lie on either side of the circle of 1.0e-06" in said.why
    assert said.digits_agreed is None


def test_iterations_on_a_function_without_zeros_say_that_they_arrive_nowhere() -> None:
    with pytest.raises(ConvergenceError, match=r"neither Newton nor Muller arrives anywhere from 0\.3; the last step was"):
        find_near(Function(np.exp, np.exp), 0.3, 1e-10)


def test_a_search_that_counts_fewer_zeros_than_are_known_refuses() -> None:
    D = Function(lambda s: s - 0.5, lambda s: 1.0)
    search = Search(lambda region: wind(D, region), lambda disc: wind(D, disc), lambda start, length: None)
    known = [Zero(0.5 + 0j), Zero(0.25 + 0j)]
    with pytest.raises(ConvergenceError, match=r"1 zero was counted near .*, fewer than are known there"):
        find(search, st.Disc(0.4 + 0j, 0.3), known)


def test_a_contour_in_rounding_noise_is_named() -> None:
    """Phases at random where the derivative says that D hardly changes."""
    noise = Function(lambda s: np.exp(3j * math.sin(1e9 * (s.real + s.imag))), lambda s: 1e-6)
    with pytest.raises(ConvergenceError, match=r"near sigma = .* it jumps, by rounding or from one mesh to the next"):
        wind(noise, st.Disc(1 + 0j, 0.1))


def _kato(D0: Any, D1: Any, reference: complex) -> KatoFrame:
    """k = 1 of 2 solutions, for ψ′ = (D0 + σ D1) ψ far away."""
    one, nothing = np.eye(2, dtype=complex), np.zeros((2, 2), complex)
    pencil = Pencil(one, nothing, np.array(D0, complex), np.array(D1, complex))
    return KatoFrame(AsymptoticPencil(pencil, 1), 1, reference)


def test_the_decaying_space_has_no_frame_next_to_a_branch_point() -> None:
    """y″ = σ y: the rates ±√σ are one at 0, and no circle around a σ with a cell that rounding resolves is free of it."""
    frame = _kato([[0, 1], [0, 0]], [[0, 0], [1, 0]], 1.0 + 0j)
    found, *_ = frame.frame(-1 + 0.5j)
    assert np.isfinite(found).all()
    with pytest.raises(Undecidable, match="the decaying space at infinity is not analytic around sigma = 1e-20"):
        frame.frame(1e-20 + 0j)


def test_a_half_plane_behind_the_continuous_spectrum_has_no_path() -> None:
    """Rates ±√(σ² − 1): the imaginary axis is continuous spectrum from end to end, and nothing leads around it."""
    frame = _kato([[0, 1], [-1, 0]], [[0, 1], [1, 0]], 2.0 + 0j)
    found, *_ = frame.frame(1.5 + 1j)
    assert np.isfinite(found).all()
    with pytest.raises(Undecidable, match=r"no path from 2.* to sigma = -2.* was found around the continuous spectrum at infinity"):
        frame.frame(-2.0 + 0.3j)
