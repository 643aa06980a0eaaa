"""The reduction proved: its solutions satisfy the equations that it came from, and its order is that of the determinant."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import mpmath
import numpy as np
import pytest
from equations_written import WRITTEN
from put_back import residual

import shootstab as st
from shootstab.core.errors import InputError
from shootstab.formulation.domain import Domain
from shootstab.formulation.first_order import FirstOrder, first_order
from shootstab.formulation.names import Names
from shootstab.formulation.system import System


def made(written: Mapping[str, Any], left: float = -1.0, right: float = 1.0) -> tuple[System, FirstOrder]:
    names = Names(
        tuple(written["unknowns"]),
        written.get("parameters", {}),
        written.get("where", {}),
        written.get("eigenvalue", "sigma"),
        written.get("variable", "z"),
    )
    system = System.of(
        names.unknowns, {f"equation {i}": names.expression(e, f"equation {i}") for i, e in enumerate(written["equations"], 1)}, names.text
    )
    domain = Domain(written.get("from", left), written.get("to", right), {})
    return system, first_order(system, domain.vanishing, domain.regular)


@pytest.mark.parametrize("name", WRITTEN)
def test_solutions_of_the_first_order_system_satisfy_the_equations(name: str) -> None:
    written = WRITTEN[name]
    system, first = made(written)
    assert first.order == written["order"]
    generator = np.random.default_rng(7)
    low, high = written.get("from", -1.0), written.get("to", 1.0)
    with mpmath.workdps(40):
        for _ in range(2):
            z0 = low + (high - low) * generator.uniform(0.2, 0.8)
            sigma = complex(*generator.normal(size=2))
            start = [mpmath.mpc(*pair) for pair in generator.normal(size=(first.order, 2))]
            assert residual(system, first, z0, sigma, start) < 1e-30


def test_the_order_of_random_systems_is_the_degree_of_their_determinant() -> None:
    """With constant coefficients the operators commute: n is the degree of det P(d) in d."""
    generator = np.random.default_rng(11)
    orders = []
    for _ in range(16):
        m = int(generator.integers(2, 5))
        coefficients = generator.integers(-3, 4, size=(m, m, 3, 2)) * (generator.random((m, m, 3, 2)) < 0.4)
        coefficients[np.arange(m), generator.permutation(m), 0, 0] += 5
        terms = [
            " + ".join(f"({c[0]}+({c[1]})*sigma)*d(u{j},{k})" for j in range(m) for k, c in enumerate(row[j]))
            for row in coefficients.tolist()
        ]
        written = {"unknowns": [f"u{j}" for j in range(m)], "equations": terms}
        expected = degree_of_determinant(coefficients)
        if expected <= 0:
            with pytest.raises(InputError):
                made(written)
            continue
        system, first = made(written)
        assert first.order == expected
        orders.append(expected)
        with mpmath.workdps(60):
            start = [mpmath.mpc(*pair) for pair in generator.normal(size=(expected, 2))]
            assert residual(system, first, 0.1, 0.3 - 0.4j, start) < 1e-25
    assert len(set(orders)) >= 3


def degree_of_determinant(coefficients: Any) -> int:
    """In d, at one σ without any property; −1 for zero. By interpolation in exact arithmetic."""
    import sympy as sp

    d, sigma = sp.symbols("d"), sp.Rational(17, 23)
    m = len(coefficients)
    P = sp.Matrix(m, m, lambda i, j: sum((int(c[0]) + int(c[1]) * sigma) * d**k for k, c in enumerate(coefficients[i][j].tolist())))
    det = sp.expand(P.det(method="berkowitz"))
    return -1 if det == 0 else int(sp.degree(det, d)) if det.has(d) else 0


def test_states_and_pivots_of_the_navier_stokes_equations() -> None:
    """In primitive variables plane Poiseuille flow has the order 4 and C is the identity: nothing is divided by, sigma stays linear."""
    _, first = made(WRITTEN["plane Poiseuille flow"])
    assert first.states == (("u", 0), ("u", 1), ("v", 0), ("p", 0))
    assert first.degree == 1
    assert {at: c.constant for at, c in first.C.items()} == {(i, i): first.C[0, 0].constant for i in range(4)}


def check_refusal(equations: Sequence[str], unknowns: Sequence[str], told: str) -> None:
    with pytest.raises(InputError, match=told):
        made({"unknowns": unknowns, "equations": equations})


def test_dependent_equations_are_named() -> None:
    check_refusal(["d(u) + v", "d(u,2) + d(v)"], ["u", "v"], "equation 1, equation 2 are dependent")


def test_equations_without_a_derivative_that_remains_are_refused() -> None:
    check_refusal(["u + d(v)", "v"], ["u", "v"], "no derivative that remains")


def test_what_no_equation_connects_is_told_apart() -> None:
    """A wave along the stream: the spanwise velocity is driven by nothing else."""
    along = ["sigma*u + d(u)*0 + p = d(u,2)", "sigma*v + d(p) = d(v,2)", "u + d(v) = 0", "sigma*w = d(w,2)"]
    ends = st.Conditions(0, ["u", "v", "w"]), st.Conditions(1, ["u", "v", "w"])
    told = dict(st.equations(["u", "v", "p", "w"], along, *ends).explanation)
    assert told["subsystems"] == "2, which no equation or condition connects: u, d(u), v, p; w, d(w)"
    driven = [*along[:3], "sigma*w + v = d(w,2)"]
    assert "subsystems" not in dict(st.equations(["u", "v", "p", "w"], driven, *ends).explanation)


def test_the_eigenvalue_divides_nothing_but_its_multiples() -> None:
    """u = σw and v = (σ + 1)w with (2σ + 1)w″ + w′ = w, w(0) = 0, w′(1) = 3w(1): z e^{2z} at σ = −5/8, and σ_c = −1/2."""
    written = ["u - sigma*w", "v - (sigma + 1)*w", "d(u,2) + d(v,2) + d(w) - w"]
    problem = st.equations(["u", "v", "w"], written, st.Conditions(0, ["u"]), st.Conditions(1, ["d(u) - 3*u"]))
    assert np.abs(problem.spectrum_inside.curve(np.array([0.0, 1.0])) + 0.5).max() < 1e-15
    mode = st.refine(problem, -0.53)
    assert abs(mode.sigma + 0.625) <= mode.error < 1e-13
    from_afar = st.refine(problem, -0.7)  # Newton's iterates go beyond 1e200, Muller's do not
    assert abs(from_afar.sigma + 0.625) <= from_afar.error < 1e-13
