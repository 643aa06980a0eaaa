"""Lemma E14 of the guide: regular solutions in balls against Bessel's and Legendre's functions, and theorems on modes between such ends."""

from __future__ import annotations

import dataclasses
from fractions import Fraction

import numpy as np
import pytest

flint = pytest.importorskip("flint")

from flint import acb, arb, ctx  # noqa: E402

import shootstab as st  # noqa: E402
from shootstab.core.errors import InputError  # noqa: E402
from shootstab.formulation.enclosed_axis import EnclosedAxis, is_enclosed  # noqa: E402
from shootstab.formulation.exact_rank import shown_exactly  # noqa: E402
from shootstab.formulation.regular_singular import RegularSingularEnd, regular_singular_end  # noqa: E402
from shootstab.problems.capabilities import ENCLOSABLE  # noqa: E402


def bessel(n: int, extra: str = "") -> st.EquationProblem:
    """The modes are squares of the zeros of J_n."""
    return st.equations(
        ["y"], [f"d(y,2) + d(y)/z - n**2*y/z**2 + sigma*y {extra}"], st.Axis(0), st.Conditions(1, ["y"]), parameters={"n": n}
    )


def end_of(problem: st.EquationProblem) -> RegularSingularEnd:
    return regular_singular_end(problem.states, Fraction(0), 1, [0], "z = 0")


@pytest.mark.parametrize("n", [0, 1, 2, 5])
def test_regular_solutions_are_bessel_functions(n: int) -> None:
    rng, problem = np.random.default_rng(n), bessel(n)
    with ctx.workprec(150):
        axis = EnclosedAxis(end_of(problem), Fraction(0), 1, 0.25, problem.generic_sigma)
        assert axis.decaying == 1
        for _ in range(6):
            k = acb(rng.uniform(0.1, 6.0), rng.uniform(-2, 2))
            y, slope = axis.minors(k * k)
            J, dJ = (k * axis.place).bessel_j(n), k * ((k * axis.place).bessel_j(n - 1) - (k * axis.place).bessel_j(n + 1)) / 2
            assert (slope * J - y * dJ).contains(0)
            assert (slope / y).rel_accuracy_bits() > 90


def test_a_thick_sigma_holds_the_solutions_of_all_in_it() -> None:
    problem = bessel(1)
    with ctx.workprec(100):
        axis = EnclosedAxis(end_of(problem), Fraction(0), 1, 0.25, problem.generic_sigma)
        wide = axis.minors(acb(arb(3, 0.1), arb(1, 0.1)))
        for sigma in (acb(3, 1), acb(2.95, 1.05), acb(3.08, 0.93)):
            assert all(a.contains(b) for a, b in zip(wide, axis.minors(sigma), strict=True))


def test_a_rank_that_is_larger_for_some_eigenvalue_is_no_bound() -> None:
    end = end_of(bessel(2))
    (family,) = end.families
    assert shown_exactly(end, family)
    assert not shown_exactly(end, dataclasses.replace(family, free=(*family.free, 99)))


def test_coefficients_that_are_not_rational_have_no_enclosure() -> None:
    problem = bessel(1, "+ exp(z)*y")
    with pytest.raises(InputError, match="the series of a coefficient at a singular end are not rational"):
        is_enclosed(end_of(problem), [0])
    assert ENCLOSABLE.of(problem) is None


@pytest.mark.parametrize(("n", "mode"), [(0, "5.7831859629467845"), (2, "26.374616427163390")])
def test_squares_of_the_zeros_of_bessel_functions_are_proved(n: int, mode: str) -> None:
    """Abramowitz & Stegun, table 9.5: j_{0,1} = 2.40482 55576 95772 77, j_{2,1} = 5.13562 23018 40682 56."""
    proof = st.prove(bessel(n), guess=float(mode), digits=12)
    assert proof.count == 1
    assert proof.region["centre"]["re"].startswith(mode[:14])
    assert "E14" in proof.lemmas


def test_a_mode_between_two_singular_ends_is_proved() -> None:
    proof = st.prove(st.scene("legendre").problem, guess=20.0, digits=12)
    assert proof.count == 1 and abs(float(proof.region["centre"]["re"]) - 20.0) < 1e-11
