"""Mirrors of equations: which unknowns are even and which odd, against the modes themselves."""

from __future__ import annotations

import numpy as np
import pytest

import shootstab as st
from shootstab.formulation.mirror import mirror_signs

ORR_SOMMERFELD = (
    "sigma*u + i*a*U*u + v*d(U) + i*a*p - (d(u,2) - a**2*u)/R",
    "sigma*v + i*a*U*v + d(p) - (d(v,2) - a**2*v)/R",
    "i*a*u + d(v)",
)


def channel(U: str, low: float = -1.0, high: float = 1.0, right: tuple[str, ...] = ("u", "v")) -> st.EquationProblem:
    ends = st.Conditions(low, ["u", "v"]), st.Conditions(high, list(right))
    return st.equations(["u", "v", "p"], list(ORR_SOMMERFELD), *ends, parameters={"R": 1e4, "a": 1}, where={"U": U})


def test_modes_of_a_channel_have_the_parity_that_is_told() -> None:
    problem = channel("1 - z**2")
    middle, signs = mirror_signs(problem.statement) or (None, {})
    assert middle == 0
    assert signs == {"u": 1, "v": -1, "p": 1}
    assert ("symmetry", "about z = 0: a basis of modes has u, p even and v odd, or the reverse") in problem.explanation
    mode = st.eigenfunction(problem, 0.0037 - 0.2375j)
    z = np.array([0.2, 0.5, 0.9])
    here, there = mode(z), mode(-z)
    kind = round(float((there["v"] / here["v"]).real.mean()))  # even or odd in v
    for name, sign in signs.items():
        assert np.allclose(there[name], -kind * sign * here[name], atol=1e-7)


@pytest.mark.parametrize(
    ("problem", "middle"),
    [
        (channel("(z - 2)*(4 - z)", 2.0, 4.0), 3),
        (channel("z"), None),  # plane Couette flow is its own image with the stream turned round only
        (channel("1 - z**2", right=("d(u)", "v")), None),
        (channel("1 - z**2", right=("3*u", "i*v")), 0),
        (channel("1 - z**2", right=("u + v", "v")), None),  # the same conditions, of which each is no other's image
        (st.equations(["u", "v"], ["(2 + z)*(d(u) - v)", "d(v) - sigma*u"], st.Conditions(-1, ["u"]), st.Conditions(1, ["u"])), 0),
        (st.equations(["y"], ["d(y,2) - y"], st.Conditions(-1, ["(sigma - 1)*y"]), st.Conditions(1, ["(sigma + 1)*y"])), None),
        (st.equations(["y"], ["d(y,2) - y"], st.Conditions(-1, ["d(y) - sigma*y"]), st.Conditions(1, ["2*d(y) + 2*sigma*y"])), 0),
        (st.equations(["y"], ["d(y,2) + (6*sech(z)**2 - sigma)*y"], st.Infinity(), st.Infinity()), 0),
        (st.equations(["y"], ["d(y,2) + (6*sech(z - 1)**2 - sigma)*y"], st.Infinity(), st.Infinity()), None),
        (st.equations(["y"], ["d(y,2) + d(y) - sigma*y"], st.Conditions(0, ["y"]), st.Conditions(1, ["y"])), None),
    ],
)
def test_where_the_mirror_stands(problem: st.EquationProblem, middle: int | None) -> None:
    found = mirror_signs(problem.statement)
    assert found is None if middle is None else found is not None and found[0] == middle
