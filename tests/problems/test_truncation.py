"""problems/truncation.py: infinity begins where the coefficients stay at their limit, wherever they come to it first."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import shootstab as st

SIGMA = np.array([[0.0, 0.0], [1.0, 0.0]])


def well(centre: float, width: float = 1.0) -> Callable[[float], tuple[Any, Any]]:
    """w² y″ = (σ − 6 sech²((x − c)/w)) y, with the modes 4 and 1 (Pöschl & Teller 1933)."""

    def pencil(x: float) -> tuple[Any, Any]:
        return np.array([[0, 1], [-6 / np.cosh((x - centre) / width) ** 2 / width**2, 0]]), SIGMA / width**2

    return pencil


@pytest.mark.parametrize(("centre", "width"), [(40.0, 1.0), (-200.0, 1.0), (1000.0, 2.0), (40.0, 0.05)])
def test_a_well_far_from_the_origin_is_seen_and_met_in_its_middle(centre: float, width: float) -> None:
    problem = st.problem(2, well(centre, width), st.Infinity(), st.Infinity())
    assert problem.reduction.subdomains[0].offset == pytest.approx(centre, rel=0.02)
    assert st.count(problem, st.Rectangle(0.5 - 1j, 5 + 1.1j)) == 2
    mode = st.refine(problem, 3.99)
    assert mode.converged
    assert abs(mode.sigma - 4.0) <= mode.error < 1e-10


def test_a_well_far_from_a_wall_is_seen() -> None:
    problem = st.problem(2, well(40.0), st.Wall(0, [[1, 0]]), st.Infinity())
    assert problem.reduction.start > 60.0
    assert [v.verdict for v in st.verify(problem, [4.0, 1.0], missing="none").verdicts] == ["confirmed", "confirmed"]


def test_where_the_coefficients_vary_about_the_origin_both_sides_meet_there() -> None:
    problem = st.problem(2, well(3.0), st.Infinity(), st.Infinity())
    assert problem.reduction.subdomains[0].offset == 0.0


def test_a_start_at_one_end_is_kept_whatever_the_other_needs() -> None:
    def morse(x: float) -> tuple[Any, Any]:  # (√30 − n − 1/2)², P. M. Morse 1929
        return np.array([[0, 1], [30 * (np.exp(-2 * x) - 2 * np.exp(-x)), 0]]), SIGMA

    problem = st.problem(2, morse, st.Infinity(start=4.0), st.Infinity())
    left, right = (space.z for space in problem.at_infinity)
    assert left == -4.0
    assert right > 40.0
    mode = st.refine(problem, 8.85)
    assert mode.converged
    assert abs(mode.sigma - (30**0.5 - 2.5) ** 2) <= mode.error


def test_coefficients_that_cannot_be_computed_far_out_are_taken_to_where_they_can() -> None:
    def pencil(x: float) -> tuple[Any, Any]:  # 4/(eˣ + e⁻ˣ)², written so that it is no number from x = 355 on
        e = np.exp(2 * np.float64(x))
        return np.array([[0, 1], [-24 * e / (1 + e) ** 2, 0]]), SIGMA

    limit = (np.array([[0, 1], [0, 0]]), SIGMA)
    problem = st.problem(2, pencil, st.Wall(0, [[0, 1]]), st.Infinity(limit=limit))
    assert 20.0 < problem.reduction.start < 60.0
    mode = st.refine(problem, 3.99)
    assert mode.converged
    assert abs(mode.sigma - 4.0) <= mode.error
