"""Base flows that solve equations of their own: against formulas, published values, and the flow that the gallery integrates by itself."""

from __future__ import annotations

import math
from typing import Any

import mpmath
import numpy as np
import pytest
from scipy.integrate import solve_ivp

import shootstab as st
from shootstab.core.errors import InputError
from shootstab.formulation.base_flow import BaseFlow
from shootstab.formulation.base_solution import solved, table_of
from shootstab.formulation.base_table import base_flow
from shootstab.formulation.names import Names
from shootstab.models.catalogue.scene_files import scene_files
from shootstab.models.gallery.blasius import blasius
from shootstab.models.gallery.blasius import flow as toepfers_flow
from shootstab.models.gallery.plate import malik_3

INFINITE: dict[str, Any] = {"infinity": True, "conditions": []}
TANH: dict[str, Any] = {
    "unknowns": ["U"],
    "equations": ["d(U) = 1 - U**2"],
    "middle": {"at": 0, "conditions": ["U"]},
    "left": INFINITE,
    "right": INFINITE,
}
BLASIUS: dict[str, Any] = {
    "unknowns": ["f"],
    "equations": ["2*d(f,3) + f*d(f,2) = 0"],
    "left": {"at": 0, "conditions": ["f", "d(f)"]},
    "right": {"infinity": True, "conditions": ["d(f) = 1"]},
}


def made(table: dict[str, Any], domain: tuple[float, float] = (0.0, math.inf), **parameters: float) -> BaseFlow:
    return base_flow(table, Names(("u",), parameters, {}, given=tuple(table["unknowns"])), domain)


def test_the_curvature_at_the_wall_and_the_profile_are_those_of_blasius() -> None:
    """J. P. Boyd, Exp. Math. 8 (1999) 381; and the gallery's flow, by Töpfer's scaling."""
    flow = made(BLASIUS)
    found, _ = solved(flow)
    with mpmath.workdps(30):
        assert abs(found.free[0] - mpmath.mpf("0.33205733621519629893718006201")) < 1e-20
    y, table, other = np.linspace(0.0, 25.0, 101), table_of(flow), toepfers_flow()
    assert np.abs(table.derivative("f", y, 1) - other(y)).max() < 1e-15
    assert np.abs(table.derivative("f", y, 3) - other.derivative().derivative()(y)).max() < 1e-15


def test_a_flow_between_two_infinite_ends_is_its_formula_off_the_real_axis_too() -> None:
    table = table_of(made(TANH, (-math.inf, math.inf)))
    z = np.linspace(-30.0, 30.0, 301)
    assert np.abs(table.derivative("U", z, 0) - np.tanh(z)).max() < 3e-16
    assert np.abs(table.derivative("U", z, 2) + 2 * np.tanh(z) / np.cosh(z) ** 2).max() < 1e-15
    assert np.abs(table.derivative("U", z + 0.1j, 0) - np.tanh(z + 0.1j)).max() < 1e-15


def at_wall(equations: list[str], wall: list[str], far: list[str], **more: Any) -> dict[str, Any]:
    unknowns = sorted({name for name in ("U", "V") if name in "".join(equations)})
    ends = {"left": {"at": 0, "conditions": wall}, "right": {"infinity": True, "conditions": far}}
    return {"unknowns": unknowns, "equations": equations, **ends, **more}


@pytest.mark.parametrize(
    ("table", "formula"),
    [
        (at_wall(["d(U,2) = -2*V", "d(V,2) = 2*(U - 1)"], ["U", "V"], ["U - 1", "V"]), lambda z: 1 - np.exp(-z) * np.cos(z)),
        (at_wall(["d(U,2) = 10000*(U - 1)"], ["U"], ["U - 1"]), lambda z: -np.expm1(-100 * z)),
        (at_wall(["d(U,2) = 3*d(U) + 4*(U - 1)"], ["U"], ["U - 1"]), lambda z: -np.expm1(-z)),
        (at_wall(["d(U,2) = U - 2*U**3"], ["d(U)"], ["U"], guess={"U": "1.2*exp(-z**2/2)"}), lambda z: 1 / np.cosh(z)),
        (at_wall(["d(U,2) = -2*U*(1 - U**2)"], ["U"], ["U - 1"]), np.tanh),
        (at_wall(["d(U) = sech(z - 40)**2"], ["U - tanh(-40)"], []), lambda z: np.tanh(z - 40)),
    ],
)
def test_a_limit_that_other_solutions_leave_and_a_late_layer(table: dict[str, Any], formula: Any) -> None:
    """A shot at a saddle misses by what its error grows to, so more digits are needed at the origin, up to e^{4z} e^{z} times as many."""
    z = np.array([0.0, 0.01, 0.1, 0.5, 1.0, 3.0, 10.0, 30.0, 40.5, 80.0])
    assert np.abs(table_of(made(table)).derivative("U", z, 0) - formula(z)).max() < 3e-15


def test_the_rotating_disc_and_a_mixing_layer() -> None:
    """F′(0) and −G′(0) of T. von Kármán's flow, M. H. Rogers & G. N. Lance, J. Fluid Mech. 7 (1960) 617; R. C. Lock, Q. J. Mech. Appl.
    Math. 4 (1951) 42, whose equation has the same solution as Blasius' between two streams."""
    disc = {
        "unknowns": ["F", "G", "H"],
        "equations": ["d(F,2) = F**2 - G**2 + H*d(F)", "d(G,2) = 2*F*G + H*d(G)", "d(H) = -2*F"],
        "left": {"at": 0, "conditions": ["F", "G - 1", "H"]},
        "right": {"infinity": True, "conditions": ["F", "G"]},
    }
    slopes = solved(made(disc))[0].free
    assert np.abs(np.array(slopes, dtype=float) - [0.510233, -0.615922]).max() < 5e-7
    layer = {**BLASIUS, "middle": {"at": 0, "conditions": ["f"]}}
    layer |= {"left": {"infinity": True, "conditions": ["d(f) = 1/2"]}, "right": {"infinity": True, "conditions": ["d(f) = 1"]}}
    table = table_of(made(layer, (-math.inf, math.inf)))
    assert np.abs(table.derivative("f", np.array([-1e4, 0.0, 1e4]), 1) - [0.5, solved(table.flow)[0].free[0], 1.0]).max() < 1e-15


def test_every_function_has_its_series() -> None:
    """Against an explicit Runge–Kutta method of order 8."""
    terms = "0.1*exp(-tanh(z))*log(2+cos(z)) - sech(z)*sqrt(1+z**2)/10 + erf(z)*tan(y/4) + sinh(y/9)*cosh(z/3)*(1+y**2)**(1/3)"
    equation = {"unknowns": ["y"], "equations": [f"d(y,2) = -sin(y) + {terms}"]}
    flow = made({**equation, "left": {"at": 0, "conditions": ["y"]}, "right": {"at": 2, "conditions": ["y - 1"]}}, (0.0, 2.0))
    table = table_of(flow)

    def slopes(z: float, y: Any) -> list[float]:
        bell = 0.1 * math.exp(-math.tanh(z)) * math.log(2 + math.cos(z)) - math.sqrt(1 + z * z) / math.cosh(z) / 10
        rest = math.erf(z) * math.tan(y[0] / 4) + math.sinh(y[0] / 9) * math.cosh(z / 3) * (1 + y[0] ** 2) ** (1 / 3)
        return [y[1], -math.sin(y[0]) + bell + rest]

    begin, end = table.states(np.array([0.0, 2.0])).T
    assert np.abs(solve_ivp(slopes, (0, 2), begin, method="DOP853", rtol=1e-13, atol=1e-14).y[:, -1] - end).max() < 1e-12
    assert abs(begin[0]) < 1e-17 and abs(end[0] - 1) < 3e-16


def test_the_mode_on_a_flow_that_is_integrated_is_that_of_the_built_in_problem() -> None:
    scene, built_in = scene_files()["boundary-layer"].problem(), blasius()
    ours, theirs = (st.refine(p, 0.00142 - 0.0652j) for p in (scene, built_in))
    assert ours.converged and theirs.converged
    assert ours.budget.steady_flow > 0.0
    assert ours.error < 1e-14
    assert abs(ours.sigma - theirs.sigma) <= ours.error + theirs.error
    assert scene.with_base_flow_error(4.0) is not scene


@pytest.mark.slow
def test_macks_plate_from_the_compressible_equations_is_the_built_in_one() -> None:
    """The system derived by hand in gallery/plate_system.py, on a flow by Chebyshev polynomials, against equations as they are printed."""
    ours, theirs = (st.refine(p, 0.000584 - 0.036734j) for p in (scene_files()["mack"].problem(), malik_3()))
    assert ours.converged and theirs.converged
    assert abs(ours.sigma - theirs.sigma) <= ours.error + theirs.error < 1e-12


def test_many_digits_on_a_flow_are_those_on_its_formula() -> None:
    string = [["y"], ["d(y,2) + (1 + U)**2*y = sigma*y"], st.Conditions(0, ["y"]), st.Conditions(1, ["d(y) + U*y"])]
    turning = {"unknowns": ["U"], "equations": ["d(U,2) = -U"], "left": {"at": 0, "conditions": ["U", "d(U) - 1"]}}
    sine = {"base": {**turning, "right": {"at": 1, "conditions": []}}}, {"where": {"U": "sin(z)"}}
    rayleigh = ["(sigma + i*a*U)*u + v*d(U) + i*a*p = 0", "(sigma + i*a*U)*v + d(p) = 0", "i*a*u + d(v) = 0"]
    layer = [["u", "v", "p"], rayleigh, st.Infinity(), st.Infinity()]
    tanh = {"base": TANH}, {"where": {"U": "tanh(z)"}}
    falling = {"unknowns": ["U"], "equations": ["d(U,2) = 1600*U"], "left": {"at": 0, "conditions": ["U - 1"]}}
    steep = {"base": {**falling, "right": {"at": 1, "conditions": ["U"]}}}, {"where": {"U": "sinh(40*(1 - z))/sinh(40)"}}
    cases = (string, sine, {}, -1.271, 40), (layer, tanh, {"a": 0.4446}, 0.1897, 16), (string, steep, {}, -1.4, 30)
    for posed, ways, parameters, guess, digits in cases:
        ours, theirs = (st.refine(st.equations(*posed, parameters=parameters, **way), guess, digits=digits) for way in ways)
        assert ours.converged and theirs.converged
        assert abs(ours.sigma - theirs.sigma) <= ours.error + theirs.error


def test_a_parameter_of_the_flow_is_one_of_the_problem() -> None:
    """V. M. Falkner & S. W. Skan: U″ is −b at a wall where f‴ + f f″ + b (1 − f′²) = 0; and D. R. Hartree's f″(0) = 1.232588 at b = 1."""
    table = {**BLASIUS, "equations": ["d(f,3) + f*d(f,2) + b*(1 - d(f)**2) = 0"]}
    ends = st.Conditions(0, ["y"]), st.Conditions(1, ["y"])
    problem = st.equations(["y"], ["d(y,2) + d(f,2)*y = sigma*y"], *ends, parameters={"b": 1.0}, base=table)
    for b in (1.0, 0.5):
        other = problem.with_parameters({"b": b})
        flow = other.statement.base
        assert flow is not None and abs(table_of(flow).derivative("f", np.zeros(1), 3)[0] + b) < 1e-15
    assert abs(solved(made(table, b=1.0))[0].free[0] - 1.232588) < 5e-7
    assert dict(problem.explanation)["base flow"].startswith("settled at z = ")


@pytest.mark.parametrize(
    ("changed", "told"),
    [
        ({"equations": ["d(f,3)**2 + f = 0"]}, "base equation 1 is not linear in the highest derivatives d(f,3)"),
        ({"equations": ["d(f,3) + u = 0"]}, "base equation 1 holds u: allowed are f, the coordinate and real parameters"),
        ({"equations": ["d(f,3) + sigma = 0"]}, "base equation 1 holds sigma"),
        ({"equations": ["d(f,3) + i*f = 0"]}, "base equation 1 is not real"),
        ({"equations": ["f = 1"]}, "no equation holds a derivative of f"),
        ({"equations": ["d(f,3)", "f"]}, "2 equations for 1 unknown, f: allowed are as many"),
        ({"left": {"at": 0, "conditions": ["f"]}}, "base has 2 conditions: allowed are 3, the order of its equations"),
        (
            {"left": {"at": 0, "conditions": ["f", "d(f,3)"]}},
            "base, left condition 2 holds d(f,3): allowed are derivatives of f below order 3",
        ),
        ({"left": {"at": 1, "conditions": ["f", "d(f)"]}}, "allowed is a base flow that is known wherever they are"),
        ({"left": {"infinity": True, "conditions": ["f", "d(f)"]}}, "base has both ends at infinity: needed is middle"),
        ({"left": 0}, "base left = 0: allowed is { at = ..., conditions = [...] }"),
        ({"guess": {"g": "z"}}, "base guess of 'g': allowed are f"),
        ({"start": 1}, "base has the unknown key 'start': allowed are unknowns, equations, left, right, middle, guess"),
    ],
)
def test_a_base_flow_that_is_none_is_refused_in_words(changed: dict[str, Any], told: str) -> None:
    with pytest.raises(InputError) as error:
        made({**BLASIUS, **changed})
    assert told in str(error.value)


def test_a_flow_without_a_solution_or_with_a_slow_limit_is_refused() -> None:
    slow = made({"unknowns": ["f"], "equations": ["d(f) = -f**2"], "left": {"at": 0, "conditions": ["f - 1"]}, "right": INFINITE})
    with pytest.raises(InputError, match="slower than exponentially"):
        solved(slow)
    pole = {"unknowns": ["f"], "equations": ["d(f) = f**2"], "left": {"at": 0, "conditions": ["f - 1"]}}
    with pytest.raises(InputError, match=r"runs into a singularity|is singular"):
        solved(made({**pole, "right": {"at": 2, "conditions": []}}, (0.0, 2.0)))
    pipe = {"unknowns": ["W"], "equations": ["d(W,2) + d(W)/r + 4"], "left": {"at": 0, "conditions": ["d(W)"]}}
    with pytest.raises(InputError, match="equations are singular at the end at 0"):
        base = {**pipe, "right": {"at": 1, "conditions": ["W"]}}
        st.equations(["y"], ["d(y,2) - W*y - sigma*y"], *(st.Conditions(i, ["y"]) for i in (0, 1)), base=base, variable="r")
    none = {"unknowns": ["y"], "equations": ["d(y,2) = -y"], "left": {"at": 0, "conditions": ["y"]}}
    with pytest.raises(InputError, match=r"no solution for y is found from zero: allowed is another guess|does not settle"):
        solved(made({**none, "right": {"at": 3, "conditions": ["exp(y)"]}}, (0.0, 3.0)))
