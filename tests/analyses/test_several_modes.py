"""Modes that lie close together, are double, defective or k-fold; claims and modes assigned to each other as a whole."""

from __future__ import annotations

import itertools
import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as some

import shootstab as st
from shootstab.analyses.assignment import Candidate, assign
from shootstab.problems import LinearProblem

PI2 = math.pi**2


def strings(*factors: float) -> LinearProblem:
    """Uncoupled strings, of modes −(jπ)² times a factor."""
    n = 2 * len(factors)
    D0, D1 = np.zeros((n, n)), np.zeros((n, n))
    for k, factor in enumerate(factors):
        D0[2 * k, 2 * k + 1], D1[2 * k + 1, 2 * k] = 1, 1 / factor
    rows = np.eye(n)[::2]
    return st.problem(n, lambda z: (D0, D1), st.Wall(0, rows), st.Wall(1, rows))


def chain(m: int) -> LinearProblem:
    """y_k″ = σ y_k + y_{k+1}, y = 0 at both walls: −π² is one Jordan block of m."""
    D0, D1 = np.zeros((2 * m, 2 * m)), np.zeros((2 * m, 2 * m))
    for k in range(m):
        D0[2 * k, 2 * k + 1] = D1[2 * k + 1, 2 * k] = 1
        if k < m - 1:
            D0[2 * k + 1, 2 * k + 2] = 1
    rows = np.eye(2 * m)[::2]
    return st.problem(2 * m, lambda z: (D0, D1), st.Wall(0, rows), st.Wall(1, rows))


def eady(mu: float) -> LinearProblem:
    """ψ″ = μ²ψ, (z − c) ψ′ = ψ at z = 0 and 1; c = 1/2 ± √(1/4 − coth μ/μ + 1/μ²)."""
    D0, D1 = np.array([[0, 1], [mu * mu, 0]]), np.zeros((2, 2))
    return st.problem(2, lambda z: (D0, D1), st.Wall(0, [[-1, 0]], [[0, -1]]), st.Wall(1, [[-1, 1]], [[0, -1]]))


@pytest.mark.parametrize("gap", [1e-4, 1e-6, 1e-7, 1e-9, 1e-12, 0.0])
def test_two_claims_on_two_modes_are_confirmed_together_and_none_is_missing(gap: float) -> None:
    report = st.verify(strings(1.0, 1.0 + gap), [-PI2, -PI2 * (1 + gap)])
    assert [v.verdict for v in report.verdicts] == ["confirmed", "confirmed"]
    assert not report.missing


@pytest.mark.parametrize("gap", [1e-4, 1e-7, 1e-9, 0.0])
def test_refine_tells_near_modes_apart_or_gives_them_as_one(gap: float) -> None:
    mode = st.refine(strings(1.0, 1.0 + gap), guess=-9.8)
    assert mode.converged
    truth = [-PI2, -PI2 * (1 + gap)]
    if mode.multiplicity == 1:
        assert min(abs(mode.sigma - t) for t in truth) <= mode.error
    else:
        assert mode.multiplicity == 2
        assert max(abs(mode.sigma - t) for t in truth) <= mode.error


@pytest.mark.parametrize("m", [2, 3, 4])
def test_a_jordan_block_is_one_mode_with_its_multiplicity(m: int) -> None:
    mode = st.refine(chain(m), guess=-9.5, rtol=1e-5)
    assert mode.converged
    assert mode.multiplicity == m
    assert abs(mode.sigma + PI2) <= mode.error < 1e-4


def test_claims_on_a_jordan_block_of_four() -> None:
    report = st.verify(chain(4), [-PI2] * 4)
    assert [v.verdict for v in report.verdicts] == ["confirmed"] * 4
    assert not report.missing


def test_find_gives_a_jordan_block_of_four_before_long() -> None:
    """Contours through the noise around it, which no halving follows, are given up; the four are counted in one circle."""
    found = st.find(chain(4), st.Rectangle(-14 - 2j, -6 + 2.1j), rtol=1e-5)
    assert found.counted.count == 4
    (mode,) = found.modes
    assert mode.multiplicity == 4
    assert abs(mode.sigma + PI2) <= mode.error < 1e-4


def test_one_claim_where_two_modes_share_its_digits_is_unresolved_and_one_is_missing() -> None:
    report = st.verify(strings(1.0, 1.0 + 1e-7), [-PI2], region=st.Rectangle(-9.92 - 0.05j, -9.81 + 0.04j))
    (verdict,) = report.verdicts
    assert verdict.verdict == "unresolved"
    assert "2 modes lie in the circle" in verdict.why
    assert len(report.missing) == 1


def test_a_mode_at_the_edge_of_its_circle_may_lie_on_either_side() -> None:
    """−π² is 5e−6/√2 off at six digits with an edge within the error bound of a double mode of 1e−9."""
    from shootstab.analyses.verdicts import radius_of

    claim = -PI2 + radius_of(complex(-PI2), 6)
    (verdict,) = st.verify(strings(1.0, 1.0), [claim], region=st.Rectangle(1 + 1j, 2 + 2j)).verdicts
    assert verdict.verdict == "unresolved"
    assert "may lie on either side" in verdict.why


def test_claims_are_assigned_as_a_whole() -> None:
    """The nearest claim first would leave a mode missing and a claim spurious: two have three digits each in order."""
    a, b = 71.910404, 72.046555
    report = st.verify(strings(a / PI2, b / PI2), [-71.982182, -72.120542])
    assert [v.verdict for v in report.verdicts] == ["inaccurate", "inaccurate"]
    assert [v.sigma.real for v in report.verdicts if v.sigma] == pytest.approx([-a, -b])
    assert not report.missing


@pytest.mark.parametrize("side", [1, -1])
def test_no_mode_is_confirmed_and_missing_at_once(side: int) -> None:
    """Eady, 1e−6 from the double c = 1/2 at μ = 2.3993572805…; from between the two an iteration comes to the one or the other."""
    mu = 2.39935728052
    root = side * (0.25 - 1 / (mu * math.tanh(mu)) + 1 / mu**2) ** 0.5
    report = st.verify(eady(mu), [0.5 + root], region=st.Rectangle(0.49 - 0.01j, 0.51 + 0.011j))
    assert report.verdicts[0].verdict == "confirmed"
    assert len(report.missing) == 1
    assert abs(report.missing[0].sigma - (0.5 - root)) < 1e-9


def test_a_spurious_claim_is_told_where_the_nearest_mode_is() -> None:
    report = st.verify(strings(1.0), [-PI2, -20.0])
    assert report.verdicts[1].verdict == "spurious"
    assert "nearest mode known here is -9.8696" in report.verdicts[1].why


@settings(max_examples=50, deadline=None)
@given(some.lists(some.floats(-1, 1), min_size=1, max_size=5), some.lists(some.floats(-1, 1), min_size=1, max_size=5))
def test_the_assignment_is_the_best_of_all(claims: list[float], modes: list[float]) -> None:
    """Against all ways to assign, one by one."""
    offers = [[Candidate(j, 1, abs(c - m), 1e-12, 1.0, 1e-3) for j, m in enumerate(modes)] for c in claims]
    worth = lambda given: sum(offers[i][j].worth for i, j in enumerate(given) if j is not None)  # noqa: E731
    spots = [*range(len(modes)), *[None] * len(claims)]
    best = max(worth(way) for way in set(itertools.permutations(spots, len(claims)))) if len(claims) <= 3 else None
    found = assign(offers)
    taken = [j for j in found if j is not None]
    assert len(taken) == len(set(taken)) == min(len(claims), len(modes))
    if best is not None:
        assert worth(found) == pytest.approx(best)


@pytest.mark.parametrize("gap", [1e-7, 1e-10, 1e-12, 0.0])
def test_the_multiplicities_that_find_gives_add_up_to_the_count(gap: float) -> None:
    found = st.find(strings(1.0, 1.0 + gap), st.Rectangle(-12 - 2j, -8 + 2.1j))
    assert found.counted.count == sum(mode.multiplicity for mode in found.modes) == 2
    for mode in found.modes:
        assert min(abs(mode.sigma - t) for t in (-PI2, -PI2 * (1 + gap))) <= mode.error
