"""What the rooms of equations refuse, and in which words: each sentence says what was wrong, where, and what is allowed."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from fractions import Fraction
from typing import Any

import pytest

import shootstab as st
from shootstab.core.errors import ConvergenceError, InputError
from shootstab.formulation import base_integration, base_shooting, base_solution, first_order, reduction
from shootstab.formulation.axis import RegularSpace
from shootstab.formulation.base_solution import solved
from shootstab.formulation.base_table import base_flow
from shootstab.formulation.continuous_spectrum import interior_spectrum
from shootstab.formulation.equation_collocation import collocation
from shootstab.formulation.equation_scene import from_table
from shootstab.formulation.expression import number
from shootstab.formulation.names import Names
from shootstab.formulation.problem import assembled
from shootstab.formulation.regular_digits import RegularStart
from shootstab.formulation.statement import stated
from shootstab.multiprecision.backends import choose
from shootstab.multiprecision.settings import Settings

STRING: dict[str, Any] = {
    "unknowns": ["y"],
    "equations": ["d(y,2) - sigma*y"],
    "left": {"at": 0, "conditions": ["y"]},
    "right": {"at": 1, "conditions": ["y"]},
}
WALLS: dict[str, Any] = {**STRING, "left": st.Conditions(0, ["y"]), "right": st.Conditions(1, ["y"])}
TANH: dict[str, Any] = {
    "unknowns": ["U"],
    "equations": ["d(U) = 1 - U**2"],
    "left": {"at": 0, "conditions": ["U"]},
    "right": {"infinity": True, "conditions": []},
}
JOINT = st.InterfaceConditions(0.5, ["jump(y)", "jump(d(y))"])


@pytest.mark.parametrize(
    ("changed", "told"),
    [
        ({"left": 3}, "[problem] left = 3: allowed is { at = ..., conditions = [...] }"),
        ({"right": {"infinity": True, "start": "far"}}, "[problem] right: start = 'far': allowed is a finite number"),
        ({"right": {"infinity": True, "decaying": 1.5}}, "[problem] right: decaying = 1.5: allowed is a count"),
        (
            {"interfaces": "none"},
            "[problem] interfaces = 'none': allowed is a list of { at = ..., conditions = [...], amplitudes = [...] }",
        ),
        ({"knots": [0.5, "b"]}, "[problem] knots = [0.5, 'b']: allowed is a list of numbers"),
        ({"variable": 1}, "[problem] variable = 1: allowed is a name"),
        ({"where": ["U"]}, "[problem] where = ['U']: allowed is a table of names"),
    ],
)
def test_a_table_of_equations(changed: dict[str, Any], told: str) -> None:
    with pytest.raises(InputError) as error:
        from_table({**STRING, **changed})
    assert told in str(error.value)


def rotated(**changed: Any) -> dict[str, Any]:
    return {"base": {**TANH, **changed}}


@pytest.mark.parametrize(
    ("changed", "told"),
    [
        ({"base": 3}, "base = 3: allowed is a table with the keys unknowns, equations, left, right"),
        ({"base": {"unknowns": ["U"]}}, "base lacks the key equations: needed are unknowns, equations, left, right"),
        (rotated(equations=[]), "base equations = []: allowed is a list with one entry or more"),
        (rotated(equations=["d(U,16) + d(d(U,16),9) = 0"]), "base: the order is 25: allowed are orders up to 24"),
        (rotated(left={"at": 0, "conditions": "U"}), "base left: conditions = 'U': allowed is a list of formulas"),
        (rotated(left={"at": math.inf, "conditions": ["U"]}), "base left: at = inf: allowed is a finite number"),
        (
            rotated(left={"infinity": False, "conditions": ["U"]}),
            "base left = {'infinity': False, 'conditions': ['U']}: allowed is { at = ",
        ),
        (rotated(left={"at": 0, "conditions": ["z"]}), "base, left condition 1 holds none of U: allowed are conditions for them"),
        (rotated(right={"at": -1, "conditions": []}), "base lies between z = 0 and -1: allowed is a left end below the right one"),
        (rotated(guess="z"), "base guess = 'z': allowed is a table of functions of z"),
        (
            rotated(unknowns=["U", "V"], equations=["d(U) + d(V) = 0", "d(U) + d(V) = U"]),
            "base: base equation 1, base equation 2 do not determine d(V): allowed is one equation for the highest derivative of each",
        ),
    ],
)
def test_a_base_flow(changed: dict[str, Any], told: str) -> None:
    with pytest.raises(InputError) as error:
        st.equations(**{**WALLS, **changed})
    assert told in str(error.value)


NESTED = "sigma"
for _ in range(17):
    NESTED = f"(sigma + 1/{NESTED})"
SIGMAS = st.InterfaceConditions(0.5, ["jump(y) + sigma*a", "jump(d(y)) + (sigma + 1)*a", "before(y) + (sigma + 2)*a"], ["a"])


@pytest.mark.parametrize(
    ("changed", "told"),
    [
        ({"equations": "d(y,2)"}, "equations = 'd(y,2)': allowed is a list"),
        ({"unknowns": [], "equations": []}, "unknowns is empty: allowed is a list of one name or more"),
        ({"equations": [None]}, "equation 1 = None: allowed is a formula, that is text, a number or an expression of SymPy"),
        ({"equations": ["y" + " " * 20_000]}, "equation 1 has 20001 characters: allowed are up to 20000"),
        ({"equations": ["y - y"]}, "equation 1 holds no unknown: allowed are linear equations for them"),
        ({"equations": ["y*(1 + z + sin(z) + cos(z))**64"]}, "at '**': a sum of 4 terms to the power 64 is too long to be multiplied"),
        ({"equations": [f"d(y,2) - y/{NESTED}"]}, "equation 1: the eigenvalue stands in more than 16 denominators within each other"),
        (
            {"unknowns": ["u", "y"], "equations": ["u + d(y)", "2*u + 2*d(y)"]},
            "equation 2 follows from the other equations: allowed are equations that determine the unknowns",
        ),
        ({"left": st.Conditions(0, []), "right": st.Infinity()}, "left has no conditions: allowed is at least one (the order of the"),
        (
            {"left": st.Conditions(0, ["y", "d(y)", "y + d(y)"]), "right": st.Infinity()},
            "left has 3 conditions: allowed are at most 2, the order of the equations",
        ),
        (
            {"unknowns": [f"y{k}" for k in range(65)], "equations": [f"d(y{k},2) - sigma*y{k}" for k in range(65)]}
            | {side: st.Conditions(at, [f"y{k}" for k in range(65)]) for side, at in (("left", 0), ("right", 1))},
            "the equations have 130 states: allowed are at most",
        ),
        ({"interfaces": [3]}, "the interface 3: allowed is { at = ..., conditions = [...], amplitudes = [...] }"),
        ({"interfaces": [st.InterfaceConditions(math.nan, [])]}, "the interface at = nan: allowed is a finite number"),
        ({"interfaces": [st.InterfaceConditions(0.5, "jump(y)")]}, "the interface 0.5: conditions = 'jump(y)': allowed is a list of texts"),
        (
            {"interfaces": [JOINT], "left": st.Axis(0)},
            "interfaces beside an axis or periodic ends: that is not offered; allowed are ends with conditions, or at infinity",
        ),
        (
            {"interfaces": [st.InterfaceConditions(0.5, ["jump(y) + jump(d(y))", "2*jump(d(y)) + 2*jump(y)"])]},
            "the interface 0.5, condition 2 follows from the interface 0.5, condition 1, at z = 0.5: allowed are independent conditions",
        ),
        (
            {"interfaces": [st.InterfaceConditions(0.5, ["jump(y)/(z - 1/2)", "jump(d(y))"])]},
            "the interface 0.5, condition 1: ",
        ),
        (
            {"left": st.Conditions(0, ["y", "z*d(y)"]), "right": st.Infinity()},
            "left condition 2 says nothing at z = 0: what it multiplies d(y) by vanishes there; allowed are conditions that leave some",
        ),
        (
            {"equations": ["d(y,4) - sigma*y"], "left": st.Conditions(0, ["y + sigma*d(y)", "d(y,2)", "y + d(y,2) + sigma*d(y)"])},
            "left condition 3 follows from left condition 1, left condition 2, at z = 0: allowed are independent conditions",
        ),
        (
            {"unknowns": ["u", "v"], "equations": ["d(u,2) + z*d(v,2) - sigma*u", "d(u,2) + d(v,2)/2 - v"]}
            | {"left": st.Conditions(0, ["u", "v"]), "right": st.Conditions(1, ["u", "v"])},
            "where 1 - 2*z vanishes, or has a pole, that multiplies d(u,2), d(v,2) in equation 1, equation 2: allowed is a domain",
        ),
        ({"equations": ["d(y,2) - s*y + x*y**2"], "variable": "x", "eigenvalue": "s"}, "equation 1 is not linear: it holds y**2: allowed"),
        ({"equations": ["d(y,2) - s*y + s*x"], "variable": "x", "eigenvalue": "s"}, "equation 1 holds the term s*x without an unknown"),
        (
            {"interfaces": [SIGMAS]},
            "at the interface 0.5 3 conditions multiply the amplitude a by the eigenvalue, not all in the same way: allowed are two such",
        ),
        (
            {"interfaces": [JOINT], "equations": ["k*d(y,2) + d(y) - sigma*y"], "parameters": {"k": [1, 0]}},
            "the states are y, d(y) and y in different layers (to 1): allowed are equations of one form in all",
        ),
        (
            {"equations": ["d(y,2) - exp(z)*y - sigma*y"], "right": st.Infinity()},
            "at +infinity the coefficients have no finite limit (",
        ),
    ],
)
def test_equations(changed: dict[str, Any], told: str) -> None:
    with pytest.raises(InputError) as error:
        st.equations(**{**WALLS, **changed})
    assert told in str(error.value)


BESSEL: dict[str, Any] = {**WALLS, "equations": ["d(y,2) + d(y)/z - m**2*y/z**2 - sigma*y"], "parameters": {"m": 0}, "left": st.Axis(0)}


@pytest.mark.parametrize(
    ("changed", "told"),
    [
        (
            {"right": st.Infinity(), "equations": ["d(y,2) + d(y)/z - sin(z)*y - sigma*y"]},
            "slower than exponentially, and no asymptotic series (at +infinity sin(z) has no limit",
        ),
        (
            {"equations": ["d(y,2) + d(y)/z - U*y - sigma*y"], "given": {"U": lambda z, order: 0 * z}},
            "a regular singular end at z = 0 asks for coefficients in formulas: U are given otherwise",
        ),
        (
            {"equations": ["d(y,2) - sigma*y"], "right": st.Axis(1)},
            "2 of 2 solutions are regular at z = 0 and 2 at z = 1: allowed are 2 in all",
        ),
        ({"parameters": {"m": 40}}, "at z = 0 exponents differ by 80: allowed are differences up to 59"),
        (
            {"equations": ["(sigma - z)*(d(y,2) + d(y)/z) - y"]},
            "C is singular for some sigma at every point up to a regular singular end: that is not offered",
        ),
        (
            {"unknowns": ["u", "v"], "equations": ["d(u) + d(v) - sigma*u", "d(u) + (1 + z)*d(v) - v"], "right": st.Conditions(1, ["u"])},
            "at z = 0 the highest derivatives are dependent: that is not offered",
        ),
        (
            {"unknowns": ["u", "v", "w"], "equations": ["d(u) - u", "d(v) + v", "z*d(w) - (sigma - 1)*u - (sigma + 1)*v"]}
            | {"right": st.Conditions(1, ["u", "v"])},
            "at z = 0 no basis of the regular solutions is found that is a polynomial in the eigenvalue: that is not offered",
        ),
        ({"equations": ["exp(-690)*d(y) - exp(690)*y/z - sigma*y"]}, "at z = 0 the series of the coefficients leave the range of doubles"),
    ],
)
def test_a_regular_singular_end(changed: dict[str, Any], told: str) -> None:
    with pytest.raises(InputError) as error:
        st.equations(**{**BESSEL, **changed})
    assert told in str(error.value)


def test_leading_coefficients_without_a_determinant() -> None:
    problem = st.equations(["u", "v"], ["d(u) - v", "d(v) - sigma*u"], st.Conditions(0, ["u"]), st.Conditions(1, ["u"]))
    row = {"u": number(1), "v": number(2)}
    with pytest.raises(InputError, match=r"the highest derivatives are dependent: allowed are equations that determine those of all"):
        interior_spectrum(replace(problem.first_order, leading=(row, row)), problem.statement.domain, problem.statement.names)


def test_families() -> None:
    problem = st.equations(**{**WALLS, "equations": ["d(y,2) - k*y - sigma*y"], "parameters": {"k": 1.0}})
    assert problem.family is not None
    with pytest.raises(InputError, match=r"k: given 2 times: allowed is once"):
        problem.family(("k", "k"))
    with pytest.raises(InputError, match=r"k = inf: allowed is a finite number"):
        problem.family(("k",)).checked({"k": math.inf})
    with pytest.raises(InputError, match=r"this problem comes from a statement: allowed is one made by st.equations"):
        assembled(problem.statement).with_parameters({"k": 2.0})
    assert problem.growing_region is not None
    with pytest.raises(InputError, match=r"for one value of each parameter: name a --region for an interval of them"):
        problem.growing_region(0.0, k=2.0)
    assert problem.pseudospectral is not None
    with pytest.raises(InputError, match=r"M = 5: allowed is an integer of at least 6"):
        problem.pseudospectral.spectrum(5)


def test_many_digits_between_periodic_ends_of_a_base_flow() -> None:
    base = {"unknowns": ["U"], "equations": ["d(U) = 0"], "left": {"at": 0, "conditions": ["U - 1"]}, "right": {"at": 1, "conditions": []}}
    posed = {**WALLS, "left": st.Periodic(0), "right": st.Periodic(1), "equations": ["d(y,2) - U*y = sigma*y"]}
    problem = st.equations(**posed, base=base)
    with pytest.raises(InputError, match=r"a base flow between periodic ends is known to doubles only: allowed are formulas"):
        problem.multiprecision()


def test_collocation_asks_for_finite_coefficients() -> None:
    ends = st.Conditions(0, ["y"]), st.Conditions(1, ["d(y) + y/(z - 1)"])
    found = collocation(stated(["y"], ["d(y,2) - sigma*y"], *ends, (), {}, {}, "sigma", "z", {}))
    assert found is not None
    with pytest.raises(InputError, match=r"a coefficient of the equations is not finite inside the domain, or one of the conditions at"):
        found.assembled(8)


def test_steps_of_a_reduction(monkeypatch: pytest.MonkeyPatch) -> None:
    written = ["d(u) + v", "d(v) - sigma*u", "w - d(u,2)"]
    ends = st.Conditions(0, ["u"]), st.Conditions(1, ["d(w)"])
    assert st.equations(["u", "v", "w"], written, *ends).size == 2
    with monkeypatch.context() as changed:
        changed.setattr(reduction, "MOST_REDUCTIONS", 1)
        with pytest.raises(InputError, match=r"equation 1, equation 2.* cannot be brought to first order in 1 steps"):
            st.equations(["u", "v", "w"], written, *ends)
    monkeypatch.setattr(first_order, "MOST_SUBSTITUTIONS", 1)
    with pytest.raises(InputError, match=r"a condition needs more than 1 substitutions: allowed are lower derivatives"):
        st.equations(["u", "v", "w"], written, *ends)


@pytest.mark.parametrize(
    ("room", "limit", "told"),
    [
        (base_integration, {"MOST_BASE_STEPS": 1}, r"the base flow takes more than 1 Taylor steps to 2"),
        (base_solution, {"MOST_BASE_DIGITS": 10.0}, r"base: the solution is so sensitive that 10 digits do not determine it"),
        (base_shooting, {"ROUNDS": 1}, r"the base flow does not settle up to 1.5: allowed is one that comes to its limit exponentially"),
    ],
)
def test_a_base_flow_is_given_up(monkeypatch: pytest.MonkeyPatch, room: Any, limit: dict[str, Any], told: str) -> None:
    solved.cache_clear()
    for name, value in limit.items():
        monkeypatch.setattr(room, name, value)
    right = TANH["right"] if room is base_shooting else {"at": 2, "conditions": []}
    with pytest.raises(InputError, match=told):
        solved(base_flow({**TANH, "right": right}, Names(("u",), {}, {}, given=("U",)), (0.0, 1.0)))


def test_conditions_that_do_not_determine_a_base_flow() -> None:
    table: dict[str, Any] = {"unknowns": ["U", "V"], "equations": ["d(U) = 0", "d(V) = 0"], "left": {"at": 0, "conditions": []}}
    table["right"] = {"at": 1, "conditions": ["U**4", "V"]}
    with pytest.raises(InputError, match=r"the conditions of the base flow do not determine it next to this solution"):
        solved(base_flow(table, Names(("u",), {}, {}, given=("U", "V")), (0.0, 1.0)))


def bessel(radius: float = 1.0) -> Any:
    return st.equations(**{**BESSEL, "equations": ["d(y,2) + d(y)/z - y/(1 + z**2) - sigma*y"], "right": st.Conditions(radius, ["y"])})


def test_the_series_at_a_regular_singular_end_holds_nearby() -> None:
    space = bessel().reduction.subdomains[0].far
    assert isinstance(space, RegularSpace)
    with pytest.raises(ConvergenceError, match=r"at z = 0 the regular solutions are known to .* only for sigma = 1e\+08"):
        space.frame(1e8)
    arithmetic, settings = choose("mpmath"), Settings.of(20)
    with arithmetic.working(settings.digits), pytest.raises(ConvergenceError, match=r"does not hold where the integration begins"):
        RegularStart(space.end, Fraction(3)).frame(arithmetic, settings, arithmetic.number(1))
    with pytest.raises(ConvergenceError, match=r"at z = 0 the series of the regular solutions holds nowhere"):
        bessel(1e8)


def in_digits(problem: Any, told: str, ask: Callable[[Any], Any]) -> None:
    arithmetic, settings = choose("mpmath"), Settings.of(20)
    with arithmetic.working(settings.digits), pytest.raises((InputError, ConvergenceError), match=told):
        ask(problem.multiprecision().integration(arithmetic, settings, ()))


def test_many_digits() -> None:
    half = st.equations(**{**WALLS, "equations": ["d(y,2) - y - sech(z)*y - sigma*y"], "right": st.Infinity()})
    in_digits(half, r"sigma lies on the essential spectrum: at \+infinity no gap", lambda found: found.begin(-2.0))


def test_many_digits_on_a_base_flow_beside_exponentials() -> None:
    table = {**TANH, "right": {"infinity": True, "conditions": []}}
    problem = st.equations(**{**WALLS, "equations": ["d(y,2) - y - (U + exp(-z))*y - sigma*y"], "right": st.Infinity(), "base": table})
    with pytest.raises(InputError, match=r"at \+infinity the coefficients hold the base flow and exp\(.*: allowed is one of them in the"):
        problem.multiprecision()
