"""Where a coefficient vanishes: exponentials do so nowhere, however small they are in doubles."""

from __future__ import annotations

import numpy as np
import pytest

import shootstab as st
from shootstab.core.errors import InputError
from shootstab.formulation.domain import Domain
from shootstab.formulation.names import Names
from shootstab.formulation.scaled_values import scaled_values


@pytest.mark.parametrize(
    ("formula", "place"),
    [
        ("exp(-500)**2", None),
        ("exp(-30*z)", None),
        ("exp(-800*z) + exp(-900*z)", None),
        ("exp(i*z)*(2 + z)", None),
        ("1/(1 + exp(900*z))", None),
        ("sech(900*z)*cosh(z)", None),
        ("sinh(900*(z - 1/2))*exp(-900*z)", 0.5),
        ("exp(-900*z) - exp(-450)", 0.5),
        ("1 - 2*z", 0.5),
        ("1/(1 - 2*z)", 0.5),
    ],
)
def test_where_a_coefficient_vanishes(formula: str, place: float | None) -> None:
    found = Domain(0.0, 1.0, {}).zero(Names(("u",), {}, {}).expression(formula, "here"))
    assert found is None if place is None else found == pytest.approx(place, abs=0.003)


def test_values_times_the_exponential_of_logs_are_the_expression() -> None:
    z = np.array([-0.7, 0.3, 1.1])
    expression = Names(("u",), {}, {}).expression("exp(2*z)*sinh(z)/sech(z)**2 + i*z**3*exp(i*z) + (1 + cosh(z))**(-1/2)*tanh(z)", "here")
    values, logs = scaled_values(expression, z, {})
    exact = np.exp(2 * z) * np.sinh(z) * np.cosh(z) ** 2 + 1j * z**3 * np.exp(1j * z) + (1 + np.cosh(z)) ** -0.5 * np.tanh(z)
    assert np.abs(values * np.exp(logs) - exact).max() < 1e-13


def test_a_medium_that_thins_out_keeps_its_order() -> None:
    """Internal waves of density e^{−z}: (e^{−z} y′)′ = σ e^{−z} y between walls 30 apart, σ = −1/4 − π²/900."""
    written = "d(exp(-z)*d(y)) - sigma*exp(-z)*y"
    mode = st.refine(st.equations(["y"], [written], st.Conditions(0, ["y"]), st.Conditions(30, ["y"])), -0.261)
    assert abs(mode.sigma + 0.25 + np.pi**2 / 900) <= mode.error < 1e-12
    ends = st.Conditions(0, ["u"]), st.Conditions(1, ["u"])
    assert st.equations(["u", "v"], ["exp(-500)*d(u) + v", "exp(-500)*d(v) - sigma*u"], *ends).size == 2
    with pytest.raises(InputError, match=r"at z = 0.3, where z - 3/10 vanishes, or has a pole, that multiplies d\(y,2\) in equation 1:"):
        st.equations(["y"], ["(z - 3/10)*d(y,2) + sigma*y"], st.Conditions(0, ["y"]), st.Conditions(1, ["y"]))
    with pytest.raises(InputError, match=r"changes at z = 0.5, where \(1 - 2\*z\)\*\*\(-1\) vanishes, or has a pole, that multiplies"):
        st.equations(["u", "v"], ["d(u)/(1 - 2*z) + v", "d(v) - sigma*u"], *ends)
