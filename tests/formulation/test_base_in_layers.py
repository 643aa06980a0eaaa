"""A base flow that solves equations of its own beside interfaces: it is the flow that formulas say, in doubles and in many digits."""

from __future__ import annotations

from typing import Any

import mpmath
import numpy as np
import pytest

import shootstab as st
from shootstab.core.errors import InputError
from shootstab.formulation.problem import EquationProblem

EQUATIONS = [
    "rho*(sigma*u + i*k*U*u + v*d(U)) + i*k*p = mu*(d(u,2) - k**2*u)/R",
    "rho*(sigma*v + i*k*U*v) + d(p) = mu*(d(v,2) - k**2*v)/R",
    "i*k*u + d(v) = 0",
]
CONDITIONS = [
    "(sigma + i*k*before(U))*h = before(v)",
    "jump(v)",
    "jump(u) + jump(d(U))*h",
    "jump(mu*(d(u) + i*k*v + d(U,2)*h))",
    "jump(p - 2*mu*d(v)/R) = S*k**2*h",
]
WIND = {"unknowns": ["V"], "equations": ["d(V) = 1 - V**2"], "left": {"at": 0, "conditions": ["V"]}}
TANH: dict[str, Any] = {**WIND, "right": {"infinity": True, "conditions": []}}


def layers(U: list[str], right: Any, **more: Any) -> EquationProblem:
    joint = st.InterfaceConditions(0, CONDITIONS, ["h"])
    parameters = {"k": 0.6, "R": 50, "rho": [1, 0.5], "mu": [1, 0.6], "S": 0.05}
    walls = {"left": st.Conditions(-1, ["u", "v"]), "right": right}
    return st.equations(["u", "v", "p"], EQUATIONS, **walls, interfaces=[joint], parameters=parameters, where={"U": U}, **more)


def test_wind_over_a_layer_that_does_not_know_of_it() -> None:
    """The flow begins at the interface, where the jump of its slope is zero without being so in letters; tanh z by its formula."""
    written, solved = layers(["z", "tanh(z)"], st.Infinity()), layers(["z", "V"], st.Infinity(), base=TANH)
    one, other = (problem.pseudospectral.spectrum(40).eigenvalues for problem in (written, solved))  # type: ignore[union-attr]
    assert other == pytest.approx(one, abs=1e-10)
    modes = [st.refine(problem, one[0]) for problem in (written, solved)]
    assert abs(modes[0].sigma - modes[1].sigma) <= modes[0].error + modes[1].error < 1e-13
    assert modes[1].budget.steady_flow > 0.0
    with mpmath.workdps(40):
        many = [st.refine(problem, one[0], digits=30).sigma for problem in (written, solved)]
        assert abs(many[0] - many[1]) < 1e-30
    report = st.verify(solved, other.tolist(), missing="none")
    assert {v.verdict for v in report.verdicts} == {"confirmed"}
    told = [text for heading, text in solved.explanation if heading == "base flow"]
    assert told[0] == "d(V) = 1 - V**2"


def test_one_flow_through_both_layers() -> None:
    """1 − z² between walls, through an interface at which density and viscosity jump."""
    right = st.Conditions(1, ["u", "v"])
    walls = {side: {"at": at, "conditions": ["V"]} for side, at in (("left", -1), ("right", 1))}
    channel = {"unknowns": ["V"], "equations": ["d(V,2) = -2"], **walls}
    written, solved = layers(["1 - z**2", "1 - z**2"], right), layers(["V", "V"], right, base=channel)
    guess = written.pseudospectral.spectrum(40).eigenvalues[0]  # type: ignore[union-attr]
    assert st.refine(solved, guess).sigma == pytest.approx(st.refine(written, guess).sigma, abs=1e-13)
    assert np.isfinite(st.refine(solved, guess).error)


@pytest.mark.parametrize(
    ("changed", "told"),
    [
        ({"equations": ["d(V) = mu - V**2"]}, r"base equation 1, column 8, at 'mu': unknown name 'mu'"),
        ({"left": {"at": 0.5, "conditions": ["V"]}}, r"base lies between z = 0.5 and inf, and what holds it between 0 and inf"),
    ],
)
def test_what_a_flow_beside_interfaces_may_not_be(changed: dict[str, Any], told: str) -> None:
    """Parameters that differ from layer to layer stand in no flow through all of them; it is known wherever equations hold it."""
    with pytest.raises(InputError, match=told):
        layers(["z", "V"], st.Infinity(), base={**TANH, **changed})
