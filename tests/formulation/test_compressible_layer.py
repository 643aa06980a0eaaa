"""Base flows with several free values in balls: a compressible plate against thirty digits, and every bound against what it bounds."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from functools import cache
from typing import Any

import mpmath
import numpy as np
import pytest

pytest.importorskip("flint")

import shootstab as st
from shootstab.core.balls import acb, arb, ctx
from shootstab.formulation.atoms import Atom
from shootstab.formulation.base_integration import FlowBranch, FlowRecurrence, fields_of, state_on, value
from shootstab.formulation.base_shooting import OriginValues, settled_flow
from shootstab.formulation.base_solution import solved
from shootstab.formulation.boundary_layer_form import BoundaryLayerForm, boundary_layer_form, partial
from shootstab.formulation.enclosed_boundary_layer import BoundaryLayerFlow
from shootstab.formulation.enclosed_flow_steps import FlowSteps, around
from shootstab.formulation.evaluation import on_mpmath
from shootstab.formulation.flow_arrival import arrival
from shootstab.formulation.flow_origin import FlowOrigin
from shootstab.formulation.series_digits import on_numbers
from shootstab.models.catalogue.scene_files import scene_files
from shootstab.multiprecision.flint_backend import FlintArithmetic
from shootstab.multiprecision.settings import Settings
from shootstab.multiprecision.tailed_series import variable

PLAIN = FlintArithmetic()
DIGITS = Settings.of(34)
WALL = ["f", "U", "d(T)"]


def layer(equations: Sequence[str], wall: Sequence[str], far: Sequence[str], unknowns: Sequence[str] = ("f", "U", "T")) -> Any:
    """A base flow, with a perturbation that is of no matter."""
    base = {
        "unknowns": list(unknowns),
        "equations": list(equations),
        "left": {"at": 0, "conditions": list(wall)},
        "right": {"infinity": True, "conditions": list(far)},
        "guess": {"U": "tanh(z/4)", "T": "1 + sech(z/4)**2"} if "U" in unknowns else {},
    }
    return st.equations(["w"], ["d(w,2) - w + sigma*w"], st.Conditions(0, ["w"]), st.Infinity(), base=base).statement.base


@cache
def plate() -> BoundaryLayerForm:
    """Mack's plate at M = 2.5, Sutherland's viscosity."""
    form = boundary_layer_form(scene_files()["mack"].problem().statement.base)
    assert form is not None
    return form


@cache
def truth() -> tuple[OriginValues, FlowBranch]:
    """The flow in thirty digits, by shooting."""
    flow = plate().flow
    known, ways = settled_flow(PLAIN, DIGITS, flow, solved(flow)[0], lambda: None)
    return known, ways[0]


def exact_end(form: BoundaryLayerForm, state: list[Any], h: Any, pieces: int = 2) -> list[Any]:
    """The state at a distance h, in thirty digits."""
    with PLAIN.working(DIGITS.digits):
        recurrence, step = FlowRecurrence(PLAIN, form.flow), h / pieces
        for _ in range(pieces):
            state = [value(PLAIN, series, step) for series in recurrence.expand(arb(0), arb(1), state, 50)]
        return state


def random_state(rng: np.random.Generator) -> list[Any]:
    """f, U, U′, T, T′ of some flow."""
    low, high = [0.0, 0.0, -0.3, 0.6, -0.4], [8.0, 1.2, 0.3, 2.5, 0.4]
    return [arb(float(x)) for x in rng.uniform(low, high)]


def test_the_plate_is_a_layer_with_two_free_values() -> None:
    form = plate()
    assert [form.flow.states[i] for i in form.free] == [("U", 1), ("T", 0)]
    assert form.limits == (1, 1) and not form.scaled
    assert set(form.derivatives()) == {(0, 1), (0, 3), (1, 2), (2, 0), (2, 2), (2, 3), (2, 4), (3, 4), (4, 0), (4, 2), (4, 3), (4, 4)}


@pytest.mark.parametrize(
    "equations",
    [
        ["d(f) = U", "d(U,2) + f*d(T) = 0", "d(T,2) + f*d(T) = 0"],  # the slope of T carries U away
        ["d(f) = U", "d(U,2) + f*d(U) + (1 - U**2)/2 = 0", "d(T,2) + f*d(T) = 0"],  # a wedge: U is pulled to its limit
        ["d(f) = U", "d(U,2) + f**2*d(U) = 0", "d(T,2) + f*d(T) = 0"],
        ["d(f) = U", "d(U,2) + f*d(U)**2 + f*d(U) = 0", "d(T,2) + f*d(T) = 0"],
        ["d(f) = U", "d(U,2) + (1 + exp(-z))*f*d(U) = 0", "d(T,2) + f*d(T) = 0"],
    ],
)
def test_what_is_no_layer_has_no_form(equations: list[str]) -> None:
    assert boundary_layer_form(layer(equations, WALL, ["U = 1", "T = 1"])) is None


def test_a_layer_with_two_functions_of_their_own_is_one() -> None:
    """Pohlhausen's heat transfer on Blasius' flow: T′(0) in closed form of f″."""
    flow = layer(["2*d(f,3) + f*d(f,2) = 0", "d(T,2) + 0.35*f*d(T) = 0"], ["f", "d(f)", "T = 2"], ["d(f) = 1", "T = 1"], ("f", "T"))
    form = boundary_layer_form(flow)
    assert form is not None and not form.scaled
    with ctx.workprec(80):
        (second, slope), radius, *_ = FlowOrigin(form).located()
    with ctx.workprec(200), mpmath.workdps(40):
        assert abs(second - arb("0.332057336215196298937180062010582966547")) < radius + arb("1e-38")
        known, _ = settled_flow(PLAIN, Settings.of(30), flow, solved(flow)[0], lambda: None)
        assert abs(slope - arb(mpmath.nstr(known.free[1], 32))) < radius + arb("1e-28")


def test_the_free_values_hold_the_truth_in_thirty_digits() -> None:
    origin, (known, _) = FlowOrigin(plate()), truth()
    for bits in (60, 100):
        with ctx.workprec(bits):
            found, radius, _, beyond = origin.located()
            assert radius < arb(2) ** -bits
            assert all(abs(defect) < arb(2) ** (4 - bits) for defect in beyond.defects)
        with ctx.workprec(200):
            for x, exact in zip(found, known.free, strict=True):
                assert abs(x - arb(mpmath.nstr(exact, 36))) < radius + arb("1e-33")
    assert origin.alone > arb("1e-11")


def test_the_flow_holds_the_truth_at_every_place() -> None:
    form, (_, way), rng, inside = plate(), truth(), np.random.default_rng(3), 0
    flow, jets = BoundaryLayerFlow(form), [*form.flow.states, ("f", 1), ("U", 2), ("T", 2), ("T", 3)]
    with ctx.workprec(90), mpmath.workdps(60):
        reach = float(flow.reach)
        for _ in range(110):
            y = round(1024 * rng.uniform(0, reach - 0.2)) / 1024
            given, along = flow.on(acb(y)), flow.on(variable(acb(y + 0.125), arb("-0.125"), 40))
            with PLAIN.working(DIGITS.digits):
                known = dict(zip(form.flow.states, state_on(PLAIN, way, arb(y)), strict=True))
                fields = fields_of(form.flow, known)
                at = on_numbers(PLAIN, arb(y), fields)
                exact = [fields(at, name, order) for name, order in jets]
            for (name, order), x in zip(jets, exact, strict=True):
                for ball in (given(name, order).real, along(name, order).at(1).real):
                    assert abs(ball - x).lower() < arb("1e-29"), (y, name, order)
                    assert ball.rad() < arb("1e-23")
                    inside += 1
    assert inside == 110 * 9 * 2


def test_beyond_its_pieces_the_flow_lies_in_a_box() -> None:
    form, (_, way), flow = plate(), truth(), BoundaryLayerFlow(plate())
    with ctx.workprec(64):
        beyond, reach = flow.located.beyond.on(None), float(flow.reach)
        for y in np.linspace(reach, reach + 4, 40):
            with PLAIN.working(DIGITS.digits):
                state = state_on(PLAIN, way, arb(float(y)))
                fields = fields_of(form.flow, dict(zip(form.flow.states, state, strict=True)))
                at = on_numbers(PLAIN, arb(float(y)), fields)
                exact = {jet: fields(at, *jet) for jet in [*form.flow.states[1:], ("f", 1), ("U", 2), ("T", 2), ("U", 3), ("T", 3)]}
            for jet, x in exact.items():
                assert abs(beyond(*jet).real - x).lower() < arb("1e-29"), (y, jet)
        assert not beyond("f", 0).is_finite()


def test_partial_derivatives_are_those_of_the_slopes() -> None:
    form, rng = plate(), np.random.default_rng(5)
    states, seen = form.flow.states, 0
    with mpmath.workdps(40):
        for _ in range(12):
            here = dict(zip(states, (mpmath.mpf(float(x)) for x in random_state(rng)), strict=True))
            for slope in form.flow.slopes:
                for y in states:
                    h = mpmath.mpf(10) ** -12

                    def at(step: Any, moved: Any = y, here: Any = here, slope: Any = slope) -> Any:
                        known = {**here, moved: here[moved] + step}
                        given = {name: (lambda z, order, name=name: known[name, order]) for name in form.flow.unknowns}
                        return on_mpmath(mpmath.mpf(0), given)(slope)

                    given = {name: (lambda z, order, name=name, here=here: here[name, order]) for name in form.flow.unknowns}
                    found = on_mpmath(mpmath.mpf(0), given)(partial(slope, Atom("given", *y)))
                    assert abs(found - (at(h) - at(-h)) / (2 * h)) < mpmath.mpf(10) ** -20
                    seen += 1
    assert seen == 300


def test_a_set_of_flows_holds_each_of_them_after_a_step() -> None:
    """Radii of differences against the true ones, of flows that begin anywhere in the set; the bound is no wild one."""
    form, rng, ratios = plate(), np.random.default_rng(7), []
    steps = FlowSteps(form)
    for _ in range(60):
        state, radii = random_state(rng), [float(10.0**e) for e in rng.uniform(-20, -5, 5)]
        with ctx.workprec(120):
            piece = steps.step(arb(0), state, [[arb(0)] * 5, [arb(r) for r in radii]])
        for _ in range(4):
            with ctx.workprec(200):
                corner = [x + arb(float(s)) * arb(r) for x, s, r in zip(state, rng.uniform(-1, 1, 5), radii, strict=True)]
                end, part = exact_end(form, corner, piece.h), float(rng.uniform(0.1, 0.9))
                inside = exact_end(form, corner, piece.h * arb(part))
                for i in range(5):
                    off = abs(end[i] - piece.middle[i])
                    assert off.lower() <= piece.sets[1][i]
                    assert abs(inside[i] - piece.fields[i].at(arb(part)).real).lower() <= piece.spread[i]
                    ratios.append(float(piece.sets[1][i] / off))
        with ctx.workprec(200):
            thin = exact_end(form, state, piece.h)
            assert all(abs(a - b).lower() <= r for a, b, r in zip(thin, piece.middle, piece.sets[0], strict=True))
    assert len(ratios) == 1200 and min(ratios) >= 1.0 and np.median(ratios) < 30


def test_complex_flows_are_carried_too() -> None:
    form, rng = plate(), np.random.default_rng(11)
    steps = FlowSteps(form)
    for _ in range(10):
        state = [acb(x) for x in random_state(rng)]
        radius = arb("1e-6")
        with ctx.workprec(100):
            piece = steps.step(arb(0), state, [[radius] * 5])
            for _ in range(4):
                turned = [x + radius * acb(*map(float, rng.uniform(-0.7, 0.7, 2))) for x in state]
                found = steps.series([x.mid() for x in turned], piece.h, 60)
                assert found is not None
                for i, series in enumerate(found):
                    assert abs(series.at(1) - piece.middle[i]).lower() <= piece.sets[0][i]


def test_an_arrival_bounds_what_is_left() -> None:
    """States far out, of which the flow is followed on: the limit and every place on the way lie in the box."""
    form, rng, seen = plate(), np.random.default_rng(13), 0
    for _ in range(40):
        f, small = float(rng.uniform(8, 16)), 10.0 ** float(rng.uniform(-8, -3))
        state = [arb(f), arb(float(rng.uniform(0.9, 1.1))), arb(small * rng.uniform(-1, 1)), arb(float(rng.uniform(0.9, 1.2))), arb(small)]
        with ctx.workprec(100):
            found = arrival(form, [around(x, arb("1e-20")) for x in state])
        assert found is not None
        here = state
        for k in range(1, 4):
            with ctx.workprec(160):
                here = exact_end(form, here, arb(1), 4)
                for place, i in enumerate(form.settling):
                    assert abs(here[i] - found.state[i].real).lower() <= 0
                    if k == 3:  # what is left falls by e^{−8} or more on the way
                        assert abs(here[i] - found.flown[place].real).lower() <= found.moved * arb("1e-3")
                for j in form.falling:
                    assert abs(here[j]) <= arb(small) * (-found.rate * k).exp() + arb("1e-19")
                for jet in (("U", 2), ("T", 2)):
                    given = dict(zip(form.flow.states, here, strict=True))
                    with PLAIN.working(40):
                        exact = on_numbers(PLAIN, arb(0), fields_of(form.flow, given))(form.flow.higher(*jet))
                    assert abs(exact) <= abs(found.on(None)(*jet)).upper() + arb("1e-18")
                    seen += 1
    assert seen == 240


def test_nothing_arrives_where_it_grows_or_runs_back() -> None:
    form = plate()
    with ctx.workprec(80):
        assert arrival(form, [arb(x) for x in ("0.1", "1", "0.1", "1", "0.1")]) is None
        assert arrival(form, [arb(x) for x in ("9", "-1", "1e-9", "1", "1e-9")]) is None
        assert arrival(form, [arb("9"), arb("1"), arb("1e-9"), arb(0, 1), arb("1e-9")]) is None


def test_a_wall_that_is_warmed_has_another_free_value() -> None:
    base = scene_files()["mack"].tables["problem"]["base"]
    changed = {**base, "left": {"at": 0, "conditions": ["f", "U", "T = 3/2"]}}
    problem = st.equations(
        ["w"],
        ["d(w,2) - w + sigma*w"],
        st.Conditions(0, ["w"]),
        st.Infinity(),
        base=changed,
        variable="y",
        parameters={"M": 2.5, "g": 1.4, "Pr": 0.7, "s": 0.74475},
        where={"h": "(g - 1)*M**2", "mu": "T**(3/2)*(1 + s)/(T + s)"},
    )
    form = boundary_layer_form(problem.statement.base)
    assert form is not None and [form.flow.states[i] for i in form.free] == [("U", 1), ("T", 1)] and form.wall == Fraction(0)
    with ctx.workprec(64):
        found, radius, *_ = FlowOrigin(form).located()
    with ctx.workprec(200), mpmath.workdps(40):
        known, _ = settled_flow(PLAIN, Settings.of(30), form.flow, solved(form.flow)[0], lambda: None)
        assert all(abs(x - arb(mpmath.nstr(y, 30))) < radius + arb("1e-28") for x, y in zip(found, known.free, strict=True))
