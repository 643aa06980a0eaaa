"""Every refusal of the chute that no other test reaches: what was wrong, where, and what is allowed."""

from __future__ import annotations

import math
from collections.abc import Callable
from fractions import Fraction
from typing import Any

import mpmath
import pytest

import shootstab as st
from shootstab.core.errors import ConvergenceError, InputError, NoFlowError
from shootstab.models import chute
from shootstab.models.chute import ChuteProblem, Flow, branch, chute_collocation, multiprecision_flow, multiprecision_problem, steady_flow
from shootstab.models.chute.branch import continued
from shootstab.models.chute.multiprecision_problem import ChuteDigits
from shootstab.models.chute.steady_flow import descend
from shootstab.multiprecision.backends import choose
from shootstab.multiprecision.settings import Settings

REFUSALS: dict[str, tuple[Callable[[Flow], Any], tuple[str, ...]]] = {
    "temperature and flux": (
        lambda flow: chute.steady(far_temperature=7.0, mass_flux=3.0, e=0.8, e_w=0.8, r=0.6, tan_theta=0.3),
        ("far_temperature and mass_flux", "allowed is exactly one of them"),
    ),
    "neither": (lambda flow: chute.steady(e=0.8, e_w=0.8, r=0.6, tan_theta=0.3), ("allowed is exactly one of them",)),
    "swept twice": (lambda flow: ChuteProblem(flow, 0.0, 0.01).family(("ky", "ky")), ("ky: given 2 times", "allowed is once")),
    "no wave": (lambda flow: chute.problem(flow, 0.0, 0.0), ("kx = 0 and ky = 0", "any pair but this one")),
    "a grid folded beyond its top": (
        lambda flow: chute_collocation.window(flow, 0.0, 0.01, z_max=10.0, z_half=20.0),
        ("z_half = 20.0, z_max = 10.0", "0 < z_half < z_max"),
    ),
    "kx that is no number": (lambda flow: chute.problem(flow, math.nan, 0.01), ("kx = nan", "a finite number")),
    "ky that is infinite": (lambda flow: chute.problem(flow, 0.0, math.inf), ("ky = inf", "a finite number")),
    "denser than the flow": (
        lambda flow: flow.height(0.99),
        ("nu = 0.99", "allowed is a volume fraction that the flow reaches, at most 0."),
    ),
}


@pytest.mark.parametrize("what", REFUSALS)
def test_what_was_wrong_is_named(what: str, flows: dict[str, Flow]) -> None:
    ask, words = REFUSALS[what]
    with pytest.raises(InputError) as refusal:
        ask(flows["high"])
    for word in (*words, "allowed"):
        assert word in str(refusal.value)


def test_a_flow_on_a_fold_has_no_branch(flows: dict[str, Flow], monkeypatch: pytest.MonkeyPatch) -> None:
    """Where the mass flux does not change with T_∞, d ln Q0/dx = 0, no step leads on, also from a flow that has the flux wanted."""
    flow = flows["high"]
    monkeypatch.setattr(branch, "descend", lambda chute, far_temperature, tolerance: flow)
    with pytest.raises(NoFlowError, match=r"ends on the way there, after 0 % of it, at mass_flux = 3: in a fold of the family"):
        continued(flow, flow.chute, 2.5)


def test_a_height_that_is_not_found_is_refused(flows: dict[str, Flow], monkeypatch: pytest.MonkeyPatch) -> None:
    flow = flows["high"]
    nu = 0.6 * float(flow.at(0.0).nu)
    assert flow.at(flow.height(nu)).nu == pytest.approx(nu, rel=1e-12, abs=0.0)
    monkeypatch.setattr(steady_flow, "HEIGHT_NEWTONS", 1)
    with pytest.raises(ConvergenceError, match=f"no height found at which nu = {nu:g}"):
        flow.height(nu)


@pytest.mark.parametrize("steps", [60, 1])
def test_many_digits_do_not_take_what_newton_has_not_settled(steps: int, flows: dict[str, Flow], monkeypatch: pytest.MonkeyPatch) -> None:
    """The base, by the energy condition, and ν0 at a distance above the start of the far field."""
    arithmetic, settings = choose("mpmath"), Settings.of(8)
    flow = descend(flows["high"].chute, 7.3125)
    digits = ChuteDigits(ChuteProblem(flow, 0.0, 0.01))
    with arithmetic.working(settings.digits), mpmath.workdps(settings.digits):
        base = digits.base(arithmetic, settings, lambda: None)
        integration = digits.integration(arithmetic, settings, base)
        sigma, one = arithmetic.number(Fraction(1, 256)), arithmetic.number(1)
        integration.begin(sigma)
        combination = [[one]] * 4
        for module in (multiprecision_flow, multiprecision_problem):
            monkeypatch.setattr(module, "FLOW_NEWTONS", steps)
        if steps > 1:
            assert set(integration.farther(sigma, combination, arithmetic.number(0), arithmetic.number(50)))
            return
        with pytest.raises(ConvergenceError, match="no volume fraction is found at a distance of 50 above the start"):
            integration.farther(sigma, combination, arithmetic.number(0), arithmetic.number(50))
        with pytest.raises(ConvergenceError, match="the base of the flow cannot be located: its energy condition is met by grazing"):
            digits.base(arithmetic, settings, lambda: None)


@pytest.mark.parametrize("kx", [0.0, 0.02])
def test_a_guess_at_the_end_of_the_continuous_spectrum_is_no_mode(kx: float, flows: dict[str, Flow]) -> None:
    """σ = −i k_x u_∞, where the series of the far field has a pole: what is said is a reason, and no warning of an arithmetic."""
    flow = flows["high"]
    mode = st.refine(chute.problem(flow, kx, 0.01), guess=-1j * kx * flow.far_velocity)
    assert not mode.converged and mode.error == math.inf and "no step is short enough at sigma = 0" in repr(mode)
