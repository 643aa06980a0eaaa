"""Base flows that are pulled to their limit, in balls: Falkner and Skan's wedges against twenty-five digits, and what is said of them."""

from __future__ import annotations

from typing import Any

import mpmath
import numpy as np
import pytest

pytest.importorskip("flint")

import shootstab as st
from shootstab.analyses.prove import prove_disc
from shootstab.core.balls import acb, arb, ctx
from shootstab.formulation.base_integration import fields_of, state_on
from shootstab.formulation.base_shooting import settled_flow
from shootstab.formulation.base_solution import solved
from shootstab.formulation.boundary_layer_form import boundary_layer_form
from shootstab.formulation.enclosed_boundary_layer import BoundaryLayerFlow
from shootstab.formulation.flow_arrival import pulled_arrival
from shootstab.formulation.series_digits import on_numbers
from shootstab.multiprecision.flint_backend import FlintArithmetic
from shootstab.multiprecision.settings import Settings

PLAIN, DIGITS = FlintArithmetic(), Settings.of(25)


def wedge(beta: str) -> Any:
    """A velocity across the flow past a wedge."""
    base = {
        "unknowns": ["f"],
        "equations": [f"d(f,3) + f*d(f,2) + {beta}*(1 - d(f)**2) = 0"],
        "left": {"at": 0, "conditions": ["f", "d(f)"]},
        "right": {"infinity": True, "conditions": ["d(f) = 1"]},
    }
    ends = st.Conditions(0, ["w"]), st.Infinity()
    squire = ["sigma*w + i*a*d(f)*w = (d(w,2) - a**2*w)/R"]
    return st.equations(["w"], squire, *ends, parameters={"R": 50.0, "a": 0.3}, variable="y", base=base)


@pytest.mark.parametrize(("beta", "second"), [("1", 1.2325876568), ("1/2", 0.9276800398), ("1/10", 0.5870352192), ("2", 1.6872181692)])
def test_a_wedge_holds_the_truth(beta: str, second: float) -> None:
    """f″(0) as Hartree (1937) and others have it, and the flow at every place and beyond its pieces."""
    form, rng, seen = boundary_layer_form(wedge(beta).statement.base), np.random.default_rng(1), 0
    assert form is not None and form.pull is not None and not form.scaled
    flow = BoundaryLayerFlow(form)
    known, (way,) = settled_flow(PLAIN, DIGITS, form.flow, solved(form.flow)[0], lambda: None)
    with ctx.workprec(64):
        at = flow.located
        assert float(at.free[0]) == pytest.approx(second, abs=1e-10)
        reach, beyond = float(at.reach), at.beyond.on(None)
        given = {float(y): flow.on(acb(float(y))) for y in np.round(1024 * rng.uniform(0, reach, 40)) / 1024}
    with ctx.workprec(200):
        assert abs(at.free[0] - arb(mpmath.nstr(known.free[0], 27))) < at.radius + arb("1e-22")
        for y, found in [*given.items(), *((float(y), beyond) for y in np.linspace(reach, reach + 3, 20))]:
            state = state_on(PLAIN, way, arb(y))
            with PLAIN.working(DIGITS.digits):
                third = on_numbers(PLAIN, arb(y), fields_of(form.flow, dict(zip(form.flow.states, state, strict=True))))(
                    form.flow.higher("f", 3)
                )
            for order, exact in enumerate((*state, third)):
                if order or found is not beyond:
                    assert abs(found("f", order).real - exact).lower() < arb("1e-20"), (y, order)
                    assert found("f", order).real.rad() < arb("1e-15")
                    seen += 1
    assert seen == 4 * 40 + 3 * 20


def test_what_is_proved_on_a_wedge_says_of_which_flow() -> None:
    proof = prove_disc(wedge("1/2"), 0.05 - 0.2j, 2e-4)
    assert proof.count == 0 and "E23" in proof.lemmas and "E21" not in proof.lemmas
    assert proof.premise.startswith("a base flow with d(f,2) = 0.92768003983665114 to 16 digits at the wall exists that stays within 1e-")
    assert proof.premise.endswith("on, and for every such flow")


def test_flows_against_a_rising_pressure_are_not_enclosed() -> None:
    """The pull is away from the limit for β < 0, where a layer has more than one flow."""
    with pytest.raises(st.ConvergenceError, match="bracket"):
        prove_disc(wedge("-1/10"), 0.05 - 0.2j, 2e-4)


def test_a_pulled_flow_is_bounded_where_it_is_pulled_and_damped() -> None:
    form = boundary_layer_form(wedge("1").statement.base)
    assert form is not None
    with ctx.workprec(80):
        found = pulled_arrival(form, [arb(9), arb("1.001"), arb("-1e-3")])
        assert found is not None and found.moved > arb("0.00099") and found.rate > 8.9
        for state in ([arb(-1), arb(1), arb("1e-9")], [arb(9), arb(-2), arb("1e-9")], [arb(9), arb(0, 1), arb(0)]):
            assert pulled_arrival(form, state) is None
