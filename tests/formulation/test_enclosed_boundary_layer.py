"""The Blasius flow in balls: against a computation in sixty digits, and the modes of its boundary layer."""

from __future__ import annotations

from typing import Any

import mpmath
import numpy as np
import pytest

pytest.importorskip("flint")

import shootstab as st
from shootstab.analyses.prove import prove, prove_disc
from shootstab.core.balls import acb, arb, ctx
from shootstab.formulation.boundary_layer_form import boundary_layer_form
from shootstab.formulation.enclosed_boundary_layer import BoundaryLayerFlow
from shootstab.formulation.enclosed_flow_steps import FlowSteps
from shootstab.multiprecision.tailed_series import variable

BLASIUS = {
    "unknowns": ["f"],
    "equations": ["2*d(f,3) + f*d(f,2) = 0"],
    "left": {"at": 0, "conditions": ["f", "d(f)"]},
    "right": {"infinity": True, "conditions": ["d(f) = 1"]},
}
SQUIRE = ["sigma*w + i*a*d(f)*w = (d(w,2) - a**2*w)/R"]  # velocity across a boundary layer: no mode of it grows


def squire(R: float = 50.0) -> st.EquationProblem:
    ends = st.Conditions(0, ["w"]), st.Infinity()
    return st.equations(["w"], SQUIRE, *ends, parameters={"R": R, "a": 0.3}, variable="y", base=BLASIUS)


def expanded(state: list[Any], h: Any, terms: int, c: Any) -> list[list[Any]]:
    """The same recurrence on mpmath's numbers."""
    a = [[x] for x in state]
    for m in range(terms):
        product = mpmath.fsum(a[0][j] * a[2][m - j] for j in range(m + 1))
        for series, slope in zip(a, (a[1][m], a[2][m], -c * product), strict=True):
            series.append(h * slope / (m + 1))
    return a


def test_the_flow_holds_the_truth_at_every_place() -> None:
    form, rng, inside = boundary_layer_form(squire().statement.base), np.random.default_rng(1), 0
    assert form is not None and form.scaled and form.limits == (1,)
    flow = BoundaryLayerFlow(form)
    with ctx.workprec(110), mpmath.workdps(75):
        states, h, half = [[mpmath.mpf(0), mpmath.mpf(0), mpmath.mpf(1)]], mpmath.mpf(1) / 4, mpmath.mpf(1) / 2
        for _ in range(90):
            states.append([mpmath.fsum(series) for series in expanded(states[-1], h, 70, half)])
        A = 1 / mpmath.sqrt(states[-1][1])
        for _ in range(250):
            y = float(rng.uniform(0, 15))
            step = min(y, 0.125)
            eta = A * mpmath.mpf(y)
            j = int(eta / h)
            g = [mpmath.fsum(series) for series in expanded(states[j], eta - j * h, 70, half)]
            truth = [A * g[0], A**2 * g[1], A**3 * g[2], -half * A**4 * g[0] * g[2]]
            given = flow.on(acb(y))
            along = flow.on(variable(acb(y) - arb(step), arb(step), 40))
            for order, exact in enumerate(truth):
                for ball in (given("f", order).real, along("f", order).at(1).real):
                    assert abs(ball - arb(mpmath.nstr(exact, 70))).lower() < arb("1e-60")
                    assert abs(ball.rad()) < arb("1e-25")
                    inside += 1
        far = flow.located.beyond.on(None)
        eta = A * mpmath.mpf(flow.reach.mid().str(60, radius=False))
        last = [mpmath.fsum(series) for series in expanded(states[int(eta / h)], eta - int(eta / h) * h, 70, half)]
        assert far("f", 1).real.contains(1) and not far("f", 0).is_finite()
        assert far("f", 2).real.contains(arb(mpmath.nstr(A**3 * last[2], 60)))
    assert inside == 2000


def test_a_step_that_is_too_long_has_no_tail() -> None:
    form = boundary_layer_form(squire().statement.base)
    assert form is not None
    with ctx.workprec(80):
        assert FlowSteps(form).series([arb(0), arb(0), arb(1)], arb(8), 30) is None
        assert FlowSteps(form).series([arb(0), arb(0), arb(1)], arb("0.25"), 30) is not None


def test_no_velocity_across_a_boundary_layer_grows_and_other_flows_have_no_enclosure() -> None:
    proof = prove_disc(squire(), 0.05 - 0.2j, 2e-4)
    assert proof.count == 0
    assert proof.premise.startswith("for the only base flow, with d(f,2) = 0.33205733621519630 to 16 digits at the wall,")
    assert {"E17", "E18"} <= set(proof.lemmas)
    other = {**BLASIUS, "equations": ["d(f,3) + f**2*d(f,2) = 0"]}
    problem = st.equations(
        ["w"], SQUIRE, st.Conditions(0, ["w"]), st.Infinity(), parameters={"R": 50.0, "a": 0.3}, variable="y", base=other
    )
    assert problem.enclosable is None
    with pytest.raises(st.InputError, match="base flow"):
        prove_disc(problem, 0.1, 0.01)


@pytest.mark.slow
def test_jordinsons_mode_is_proved() -> None:
    proof = prove(st.gallery.blasius(), 0.00142478994549 - 0.065177993292667j, 12)
    assert proof.count == 1
