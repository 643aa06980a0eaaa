"""Every refusal of the chute in balls that no other test reaches: what is not enclosed, and where."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import pytest

flint = pytest.importorskip("flint")

from flint import acb  # noqa: E402

from shootstab.core.errors import ConvergenceError  # noqa: E402
from shootstab.models.chute import ChuteProblem, Flow, enclosed_flow, enclosed_problem  # noqa: E402
from shootstab.models.chute.enclosed_flow import EnclosedDescent  # noqa: E402
from shootstab.models.chute.enclosed_problem import LEAST_FAR_TERMS, ChuteEnclosable, ChutePath, Pencils  # noqa: E402
from shootstab.multiprecision.arithmetic import exact  # noqa: E402
from shootstab.multiprecision.settings import Settings  # noqa: E402
from shootstab.multiprecision.tailed_pencil import BALLS  # noqa: E402

COARSE = Settings.of(14)


def enclosed(flow: Flow, settings: Settings = COARSE, start: float = 2.0**-9) -> Any:
    """The way down of balls for the flow, its start and its far field."""
    chute = flow.chute.with_numbers(lambda x: BALLS.number(exact(x)))
    descent = EnclosedDescent(chute, BALLS.number(exact(flow.far_temperature)), settings)
    return descent, *descent.far(start)


def test_a_far_field_or_a_step_that_no_enclosure_holds_is_refused(flows: dict[str, Flow]) -> None:
    flow = flows["high"]
    with BALLS.working(COARSE.digits):
        descent, nu, far = enclosed(flow)
        with pytest.raises(ConvergenceError, match=r"no volume fraction above 3\.6e-15 is small enough for an enclosure of the far field"):
            descent.far(2.0**-47, lambda fields: math.inf)
        with pytest.raises(ConvergenceError, match="no step is short enough for an enclosure along the steady flow"):
            descent.descend(nu, far, flow.height(float(nu)), lambda piece: math.inf)


def test_a_base_that_is_not_enclosed_is_refused(flows: dict[str, Flow], monkeypatch: pytest.MonkeyPatch) -> None:
    """A box of no width about the base holds no interval that is proved to hold it."""
    flow = flows["high"]
    words = r"the base of the flow cannot be enclosed: take more bits, unless .* by grazing"
    with BALLS.working(COARSE.digits):
        descent, nu, far = enclosed(flow)
        for name, value in (("BASE_ROOM", 0.0), ("SHOWN_ROOM", 1e9)):
            with monkeypatch.context() as patched, pytest.raises(ConvergenceError, match=words):
                patched.setattr(enclosed_flow, name, value)
                descent.descend(nu, far, flow.height(float(nu)))


def test_a_base_at_the_very_end_of_a_step_is_refused(flows: dict[str, Flow], monkeypatch: pytest.MonkeyPatch) -> None:
    """Beyond the end the tails bound nothing, so that the interval about the base has to end before."""
    flow = flows["high"]
    monkeypatch.setattr(enclosed_flow, "LAST_STEP_OVER", 1.0)
    with BALLS.working(COARSE.digits):
        descent, nu, far = enclosed(flow)
        with pytest.raises(ConvergenceError, match="the base of the flow cannot be enclosed"):
            descent.descend(nu, far, flow.height(float(nu)))


def test_ends_of_a_bracket_with_another_base_are_refused(flows: dict[str, Flow], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(enclosed_flow.EnclosedFlow, "same_base", lambda flow, other: flow is other)
    with pytest.raises(ConvergenceError, match="no bracket of the far temperature is proved"):
        ChuteEnclosable(ChuteProblem(flows["high"], 0.0, 0.01)).enclosure(80, acb(0.004))


def test_a_bracket_of_the_far_temperature_that_is_not_proved_is_refused(flows: dict[str, Flow], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(enclosed_problem, "WIDENINGS", 0)
    with pytest.raises(ConvergenceError, match=r"no bracket of the far temperature .* a flow of this mass flux: take more bits"):
        ChuteEnclosable(ChuteProblem(flows["high"], 0.0, 0.01)).enclosure(80, acb(0.004))


def test_a_sigma_next_to_the_end_of_the_continuous_spectrum_needs_a_far_field_begun_higher(flows: dict[str, Flow]) -> None:
    """At k_x = 0 that end is σ = 0: what was begun at ν0 = 2⁻¹² holds at σ = 1 and not at 0.004, where one begun at 2⁻¹⁶ holds."""
    flow, series = flows["high"], replace(COARSE, far_terms=LEAST_FAR_TERMS)
    with BALLS.working(COARSE.digits):
        low, high = (path(flow, *enclosed(flow, series, start)) for start in (2.0**-12, 2.0**-16))
        assert len(low.far(acb(1))) == len(high.far(acb(0.004))) == high.size
        with pytest.raises(ConvergenceError, match=r"the far field starts too low for an enclosure at sigma = 0\.004"):
            low.far(acb(0.004))


def path(flow: Flow, descent: EnclosedDescent, nu: Any, far: Any) -> ChutePath:
    found = descent.descend(nu, far, flow.height(float(nu)))
    return ChutePath(found, Pencils(found.chute, acb(0), acb(0.01)))
