"""Every refusal of the room of many digits that no other test reaches: what was wrong, and where."""

from __future__ import annotations

from typing import Any

import mpmath
import pytest

from shootstab.core.errors import ConvergenceError
from shootstab.models.gallery.poiseuille import PlanePoiseuille
from shootstab.multiprecision import taylor_shooting
from shootstab.multiprecision.backends import choose
from shootstab.multiprecision.closed_form_integration import ClosedFormIntegration
from shootstab.multiprecision.linear_step import subsystems
from shootstab.multiprecision.settings import Settings
from shootstab.multiprecision.taylor import Taylor
from shootstab.multiprecision.taylor_shooting import TaylorShooting


def test_equations_without_a_derivative_are_refused() -> None:
    """ψ_0′ = ψ_0 and 0 = ψ_0: two equations for one unknown, and none for the other."""
    arithmetic = choose("mpmath")
    one = Taylor(arithmetic, 4, arithmetic.series([arithmetic.number(x) for x in (1, 0, 0, 0)]), None)
    with pytest.raises(ConvergenceError, match="the pencil's C is singular for every z"):
        subsystems(2, {(0, 0): one}, {(0, 0): one, (1, 0): one})


@pytest.mark.parametrize(
    ("budget", "said"),
    [
        ("TRIALS", "no Taylor step is short enough: sigma lies on the continuous spectrum, or next to it"),
        ("MOST_TAYLOR_STEPS", "more than 0 Taylor steps: sigma lies next to the continuous spectrum"),
    ],
)
def test_a_march_that_does_not_arrive_says_where_sigma_lies(budget: str, said: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(taylor_shooting, budget, 0)
    with pytest.raises(ConvergenceError, match=said):
        marched()


def test_the_same_march_arrives_with_its_budgets() -> None:
    assert abs(marched()) > 0


def marched() -> Any:
    """D of plane Poiseuille flow to a few digits."""
    arithmetic, settings = choose("mpmath"), Settings.of(8)
    problem = PlanePoiseuille(100.0, 1.0)
    with arithmetic.working(settings.digits), mpmath.workdps(settings.digits):
        D = TaylorShooting(arithmetic, 4, settings, ClosedFormIntegration(arithmetic, problem, settings), lambda: None)
        return arithmetic.to_mpmath(D(arithmetic.number(0)))


class Path:
    """One step with ψ(1) = ψ(0) of two equations, or one too long; a decaying solution begins with these values. See EnclosedPath."""

    size, decaying = 2, 1

    def __init__(self, bounded: bool, first: Any, second: Any) -> None:
        self._bounded, self._begins = bounded, [[first], [second]]
        self.steps = [self]

    def carried(self, sigma: Any, *starts: Any) -> Any:
        return starts if self._bounded else None

    def far(self, sigma: Any) -> Any:
        return self._begins

    def wall(self, sigma: Any) -> Any:
        return [[1, 0]]


def test_enclosures_too_wide_or_unbounded_are_refused() -> None:
    flint = pytest.importorskip("flint")
    from shootstab.multiprecision.frame_enclosure import FrameEnclosure

    acb, arb = flint.acb, flint.arb
    sigma = acb(0.25, -1)
    assert FrameEnclosure(Path(True, 2, 1), False)(sigma).contains(2)
    with pytest.raises(ConvergenceError, match=r"a step is too long for an enclosure at sigma = 0\.25-1j"):
        FrameEnclosure(Path(False, 2, 1), False)(sigma)
    with pytest.raises(ConvergenceError, match="too wide to tell the decaying solutions apart: take more bits"):
        FrameEnclosure(Path(True, acb(arb(1, 2)), acb(arb(0, 2))), False)(sigma)


def test_a_matrix_that_may_be_singular_is_not_divided_by() -> None:
    flint = pytest.importorskip("flint")
    from shootstab.multiprecision.minors import solved

    one, wide = flint.acb(1), flint.acb(flint.arb(1, 2))
    assert solved(1, {(0, 0): one}, {(0, 0): wide})[0, 0].contains(1)
    with pytest.raises(
        ConvergenceError, match=r"C may be singular, as far as its enclosure tells: .* on the continuous spectrum, or next to it"
    ):
        solved(1, {(0, 0): wide}, {(0, 0): one})
