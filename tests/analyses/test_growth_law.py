"""analyses/growth_law: D is divided by what grows with it, and keeps its zeros."""

from __future__ import annotations

import cmath
import math

import pytest

from shootstab.analyses.cut_region import count_in_region
from shootstab.analyses.growth_law import ANGLES, GrowthLaw
from shootstab.analyses.unstable import HalfDisc, growth_beyond
from shootstab.core.discriminant import Value
from shootstab.core.scaled import Scaled
from shootstab.discriminants.continuation import Continuation
from shootstab.discriminants.frame import Frame
from shootstab.models.chute import ChuteProblem


def test_what_is_divided_by_is_a_function_and_its_derivative() -> None:
    """The quotient of a smooth D, its slope against a difference of its own values."""
    law = GrowthLaw(2.0, 3.0 - 0.5j, 0.7 + 0.2j, 0.0, 0)

    def quotient(sigma: complex) -> Value:
        return law.divided_out(Value(sigma, Scaled(sigma**2 + 1, 0.0), 2 * sigma))

    for sigma in (0.3 + 0.1j, 1e-6 + 0j, 1.0 - 1.5j):
        h = 1e-6
        ahead, behind, here = quotient(sigma + h), quotient(sigma - h), quotient(sigma)
        slope = (ahead.D.over(here.D) - behind.D.over(here.D)) / (2 * h)
        assert slope == pytest.approx(here.logarithmic_derivative, rel=1e-6)


def test_the_quotient_has_the_modes_of_D_and_takes_half_the_samples(scenes: dict[str, ChuteProblem]) -> None:
    for name in ("high", "low"):
        continuation = Continuation(scenes[name], Frame(rtol=1e-6))
        law = growth_beyond(continuation.on_the_axis)
        for floor in (1e-3, 1e-5):
            region = HalfDisc(law.radius, floor)
            plain, divided = (count_in_region(continuation, region, without=without) for without in (None, law.divided_out))
            assert divided.count == plain.count >= 1
            assert divided.evaluations < 0.7 * plain.evaluations


def test_a_law_is_found_where_it_is_one(scenes: dict[str, ChuteProblem]) -> None:
    """D of sinh √σ/√σ grows with A = 1/2, B = −1/2 to what e^{−2 √σ} leaves, and that is no more on the imaginary axis."""
    string = _SinhOfRoot()
    law = GrowthLaw.on(string, 400.0)  # type: ignore[arg-type]
    left = abs(1 / (cmath.exp(2 * cmath.sqrt(400j)) - 1))
    assert law.departure < 40 * left
    assert pytest.approx(0.5, abs=2 * left) == law.A
    assert pytest.approx(-0.5, abs=80 * left) == law.B  # the third function, 1/20 of the second there, takes its share of what is left
    assert law.work == len(ANGLES)
    assert not GrowthLaw.on(string, 1.0).departure < 1e-3  # type: ignore[arg-type]


def test_a_direction_of_an_arc_costs_one_value(scenes: dict[str, ChuteProblem]) -> None:
    """That by which a mesh is found to serve is the value; next to a radius whose mesh is known nothing else is computed."""
    D = Frame(rtol=1e-6).on(scenes["low"])
    law = GrowthLaw.on(D, 2.56)
    spent = D.evaluations
    next_to = GrowthLaw.on(D, 2.55)
    assert next_to.work == law.work
    assert D.evaluations - spent == len(ANGLES)


class _SinhOfRoot:
    """sinh √σ/√σ as a discriminant of one step."""

    steps = 1

    def at(self, sigma: complex) -> _SinhOfRoot:
        return self

    def serves(self, sigma: complex) -> bool:
        return True

    def with_derivative(self, sigma: complex) -> Value:
        root = cmath.sqrt(sigma)
        D = cmath.sinh(root) / root
        return Value(sigma, Scaled(D / abs(D), math.log(abs(D))), (cmath.cosh(root) - D) / (2 * sigma) / abs(D))
