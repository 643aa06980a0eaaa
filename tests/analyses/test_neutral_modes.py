"""Modes at σ = 0 and next to it: they have no digits of their own, and an absolute accuracy in the scale of D."""

from __future__ import annotations

import math

import numpy as np
import pytest

import shootstab as st
from shootstab.models.gallery.benard import benard
from shootstab.problems import LinearProblem

D1 = np.array([[0, 0], [1, 0]])


def neumann() -> LinearProblem:
    """y″ = σy, y′ = 0 at 0 and 1: 0, −π², −4π², …; D = √σ sinh √σ = σ (1 + σ/6 + …) has the scale 6 at 0."""
    D0 = np.array([[0, 1], [0, 0]])
    return st.problem(2, lambda x: (D0, D1), st.Wall(0, [[0, 1]]), st.Wall(1, [[0, 1]]))


def kink() -> LinearProblem:
    """Allen & Cahn: u″ + (1 − 3 tanh²(x/√2)) u = σu has 0, of translation, and −3/2."""

    def pencil(x: float) -> tuple[np.ndarray, np.ndarray]:
        return np.array([[0, 1], [3 * np.tanh(x / 2**0.5) ** 2 - 1, 0]]), D1

    return st.problem(2, pencil, st.Infinity(), st.Infinity())


@pytest.mark.parametrize("guess", [0.01, 1e-13, 0.0])
@pytest.mark.parametrize(("problem", "tolerance"), [(neumann(), 1e-15), (kink(), 1e-11)], ids=["neumann", "kink"])
def test_a_mode_at_zero_is_refined_from_any_side(problem: LinearProblem, tolerance: float, guess: float) -> None:
    mode = st.refine(problem, guess=guess)
    assert mode.converged
    assert abs(mode.sigma) <= mode.error <= mode.atol
    assert mode.error <= tolerance


def test_the_scale_is_that_of_D_at_zero() -> None:
    assert st.refine(neumann(), guess=0.01).scale == pytest.approx(6.0, rel=1e-3)
    assert st.refine(neumann(), guess=0.01, rtol=1e-10).atol == pytest.approx(6e-12, rel=1e-3)


@pytest.mark.parametrize("printed", [1e-13, -3e-14, 1e-15j, 0.0])
def test_what_a_code_prints_for_zero_is_confirmed(printed: complex) -> None:
    report = st.verify(neumann(), [printed, -9.8696044])
    assert [v.verdict for v in report.verdicts] == ["confirmed", "confirmed"]
    assert report.verdicts[0].atol == pytest.approx(6e-12, rel=0.1)
    assert "absolute accuracy" in report.verdicts[0].why
    assert not report.missing


def far_pair(distance: float) -> LinearProblem:
    """y″ = 1e−9 σ y, y′ = 0 at 0, (σ² + d²) y = 0 at 1: ±i d, and all others lie beyond 2e9 in |σ|."""
    D0, moving = np.array([[0, 1], [0, 0]]), [[[0, 0]], [[1, 0]]]
    return st.problem(2, lambda x: (D0, 1e-9 * D1), st.Wall(0, [[0, 1]]), st.Wall(1, [[distance**2, 0]], moving))


@pytest.mark.parametrize("distance", [1.0, 1e-6])
def test_a_pair_that_D_resolves_is_not_neutral_however_far_the_others_lie(distance: float) -> None:
    """D = (σ² + d²) cosh √(1e−9 σ) is known at 0, so 0 is none of its zeros; it was taken for one of two within 2e3."""
    assert {v.verdict for v in st.verify(far_pair(distance), [0.0, 0.0], missing="none").verdicts} == {"spurious"}
    pair = st.verify(far_pair(distance), [1j * distance, -1j * distance], missing="none")
    assert [v.verdict for v in pair.verdicts] == ["confirmed", "confirmed"]


def test_a_double_zero_at_0_has_no_size_of_its_own() -> None:
    report = st.verify(far_pair(0.0), [0.0, 1e-9], missing="none")
    assert [v.verdict for v in report.verdicts] == ["confirmed", "confirmed"]
    assert all("multiplicity 2" in v.why for v in report.verdicts)


def test_a_claim_beyond_the_absolute_accuracy_is_inaccurate_and_not_lost() -> None:
    (verdict, _) = st.verify(neumann(), [3e-9, -9.8696044]).verdicts
    assert verdict.verdict == "inaccurate"
    assert verdict.sigma is not None
    assert abs(verdict.sigma) < 1e-15
    assert st.verify(neumann(), 3e-9, atol=1e-8).verdicts[0].verdict == "confirmed"


def test_an_absolute_accuracy_is_checked() -> None:
    for question in (lambda a: st.refine(neumann(), 0.1, atol=a), lambda a: st.verify(neumann(), 0.1, atol=a)):
        for bad in (-1.0, math.inf, math.nan):
            with pytest.raises(st.InputError, match="allowed"):
                question(bad)


def test_find_gives_the_mode_at_zero_once_and_verify_confirms_it() -> None:
    found = st.find(neumann(), st.Rectangle(-30 - 5j, 5 + 4j))
    assert sorted(m.sigma.real for m in found.modes) == pytest.approx([-(math.pi**2), 0.0], abs=1e-8)
    report = st.verify(neumann(), [m.sigma for m in found.modes])
    assert [v.verdict for v in report.verdicts] == ["confirmed", "confirmed"]


def test_a_near_neutral_mode_converges_in_its_scale() -> None:
    """Rigid walls at Ra_c = 1707.76177710 of eleven digits, Chandrasekhar (1961): σ is of the size of what they leave out."""
    mode = st.refine(benard(), guess=1e-3)
    assert mode.converged
    assert abs(mode.sigma) < 1e-7
    assert mode.error < mode.atol


def test_a_growth_rate_of_the_wrong_sign_is_said() -> None:
    """y″ = (σ − 1e−3 i − π²(1 + 1e−6)…) is shifted so that growth is small against the frequency."""
    shift = math.pi**2 + 1e-4 - 1j
    D0 = np.array([[0, 1], [-shift, 0]])
    problem = st.problem(2, lambda x: (D0, D1), st.Wall(0, [[1, 0]]), st.Wall(1, [[1, 0]]))
    (verdict,) = st.verify(problem, [-1e-4 - 1j], digits=3).verdicts  # truth 1e−4 − i
    assert verdict.growth_digits is not None
    assert verdict.growth_digits == 0.0
    assert "wrong sign" in verdict.why


def test_a_code_that_is_asked_for_one_number() -> None:
    (verdict,) = st.verify(neumann(), -9.8696044).verdicts
    assert verdict.verdict == "confirmed"
    with pytest.raises(st.InputError, match="eigenvalue 1"):
        st.verify(neumann(), [object()])


def test_a_mode_at_zero_in_many_digits() -> None:
    """The shift of a front is a mode at 0 exactly: its digits are those of the scale of D, from a guess at 0 and from one beside it."""
    for guess in (0, 1e-3):
        mode = st.refine("bistable-front", guess, digits=20)
        assert mode.converged
        assert abs(mode.sigma) <= mode.error <= mode.atol < 1e-18


def test_an_iteration_that_comes_to_a_double_zero_at_0_exactly_or_ever_nearer_has_a_circle() -> None:
    """Magnetorotational modes at this wavenumber: σ = ±0.75, and a double zero at 0, around which the radius was 0."""
    for guess in (0.225, 0.22, 0.23):  # by the build of the linear algebra, one or the other ends at 1e-167 and not at 0
        mode = st.refine(st.scene("mri").problem, guess, rtol=1e-9)
        assert (mode.multiplicity, mode.converged) == (2, True)
        assert abs(mode.sigma) <= mode.error < 1e-9


def test_a_claim_of_0_on_a_mode_that_another_mesh_has_on_the_other_side_of_0() -> None:
    """sine-Gordon's kink, φ″ = (σ + 1 − 2 sech² x) φ, and Coffey–Evans' three wells: iterates next to 0 are far from it, in |σ|."""
    string = np.array([[0, 0], [1, 0]], complex)

    def kink(x: float) -> tuple[np.ndarray, np.ndarray]:
        return np.array([[0, 1], [1 - 2 / np.cosh(x) ** 2, 0]], complex), string

    def wells(x: float, beta: float = 30.0) -> tuple[np.ndarray, np.ndarray]:
        return np.array([[0, 1], [beta**2 * np.sin(2 * x) ** 2 - 2 * beta * np.cos(2 * x), 0]], complex), string

    walls = st.Wall(-np.pi / 2, [[1, 0]]), st.Wall(np.pi / 2, [[1, 0]])
    for problem in (st.problem(2, kink, st.Infinity(), st.Infinity()), st.problem(2, wells, *walls)):
        report = st.verify(problem, [0.0])
        assert [v.verdict for v in report.verdicts] == ["confirmed"]
        assert all(abs(m.sigma) > 1e-3 for m in report.missing)
