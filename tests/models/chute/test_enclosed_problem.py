"""The chute in balls: its flow, its far field and D hold what many digits and doubles find by other ways."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

flint = pytest.importorskip("flint")

from flint import acb, acb_mat, arb, arb_mat, arb_poly, ctx  # noqa: E402

import shootstab as st  # noqa: E402
from shootstab.analyses.prove import prove_region  # noqa: E402
from shootstab.core.errors import ConvergenceError  # noqa: E402
from shootstab.models.chute import ChuteProblem, Flow  # noqa: E402
from shootstab.models.chute import first_order_system as system  # noqa: E402
from shootstab.models.chute.background import background  # noqa: E402
from shootstab.models.chute.enclosed_flow import EnclosedDescent, EnclosedFlow  # noqa: E402
from shootstab.models.chute.enclosed_problem import ChuteEnclosable  # noqa: E402
from shootstab.models.chute.flow_set import FlowSet  # noqa: E402
from shootstab.models.chute.multiprecision_far import leading, wavenumber  # noqa: E402
from shootstab.models.chute.multiprecision_flow import descend  # noqa: E402
from shootstab.multiprecision.arithmetic import exact  # noqa: E402
from shootstab.multiprecision.flint_backend import FlintArithmetic  # noqa: E402
from shootstab.multiprecision.mapped_tails import tailed  # noqa: E402
from shootstab.multiprecision.settings import Settings  # noqa: E402
from shootstab.multiprecision.tailed_pencil import BALLS  # noqa: E402

COARSE, FINE = Settings.of(14), Settings.of(30)
HIGH = "7.33856837590247147037991397485"  # T_∞ of the high flow; from the project's notes on proofs, a prototype of its own


def enclosed(flow: Flow, far_temperature: Any, settings: Settings = COARSE) -> EnclosedFlow:
    """The flow of a T_∞ in balls, from ν0 = 2⁻⁹ down."""
    with BALLS.working(settings.digits):
        chute = flow.chute.with_numbers(lambda x: BALLS.number(exact(x)))
        descent = EnclosedDescent(chute, far_temperature, settings)
        nu, far = descent.far(2.0**-9)
        return descent.descend(nu, far, flow.height(float(nu)))


def test_an_enclosed_flow_holds_the_one_of_many_digits(flows: dict[str, Flow]) -> None:
    flow, T = flows["high"], arb(7.3125)
    found = enclosed(flow, T)
    arithmetic = FlintArithmetic()
    with arithmetic.working(FINE.digits):
        chute = flow.chute.with_numbers(lambda x: arithmetic.number(exact(x)))
        truth = descend(arithmetic, chute, T, FINE, flow, lambda: None)
    with ctx.workprec(200):
        nu, temperature, _, Q, _ = found.base.state
        for ball, x in zip((nu, temperature, Q), (truth.state[0], truth.state[1], truth.state[3]), strict=True):
            assert ball.contains(x) and ball.rad() < 1e-10
        assert found.base.far_velocity.contains(truth.far_velocity)
        assert found.base.mass_flux.contains(truth.mass_flux)
    assert found.first


def test_a_thick_far_temperature_holds_the_flows_of_all_in_it(flows: dict[str, Flow]) -> None:
    thick = enclosed(flows["mid"], arb(flows["mid"].far_temperature, 1e-9))
    for offset in (-0.9e-9, 0.0, 0.7e-9):
        thin = enclosed(flows["mid"], arb(flows["mid"].far_temperature + offset))
        for wide, ball in zip((*thick.base.state, thick.base.mass_flux), (*thin.base.state, thin.base.mass_flux), strict=True):
            assert wide.contains(ball.mid())
        # the flow itself, on the first piece: it is the same ν0 at which both begin
        assert all(a.at(1).real.contains(b.at(1).real.mid()) for a, b in zip(thick.far[:4], thin.far[:4], strict=True))


def test_a_set_of_flows_does_not_grow_from_step_to_step(flows: dict[str, Flow]) -> None:
    """Boxes carried by themselves were wider by factors of 1e25 where the flow is dense."""
    T = flows["low"].far_temperature
    with ctx.workprec(200):
        balls = arb(T, 1e-9), arb(T) - arb(1e-9), arb(T) + arb(1e-9)
    thick, *ends = (enclosed(flows["low"], ball) for ball in balls)
    with ctx.workprec(200):
        apart = abs(ends[1].base.mass_flux.mid() - ends[0].base.mass_flux.mid()) / 2
        assert apart > 1e-10 and apart < thick.base.mass_flux.rad() < 300 * apart
        assert all(thick.base.mass_flux.contains(end.base.mass_flux.mid()) for end in ends)
    assert all(map(thick.same_base, ends))


def test_flows_from_a_box_differ_by_no_more_than_the_derivative_of_the_flow_map_says(flows: dict[str, Flow]) -> None:
    """Lemma C6, for states without any property: every flow from a corner of the set lies in its fields and in the set at their end."""
    rng = np.random.default_rng(5)
    with BALLS.working(FINE.digits):
        chute = flows["mid"].chute.with_numbers(lambda x: BALLS.number(exact(x)))
        descent = EnclosedDescent(chute, arb(1), FINE)
        for _ in range(2):
            middle = [arb(x) for x in (rng.uniform(0.01, 0.4), rng.uniform(0.3, 4.0), rng.uniform(1.0, 5.0), rng.uniform(-0.1, 0.1), 0.5)]
            frame = arb_mat([[arb(x) for x in row] for row in (np.eye(5) + 0.5 * rng.standard_normal((5, 5))).tolist()])
            here, h = FlowSet(middle, frame, [arb(0, 1e-8)] * 5), arb(-rng.uniform(0.01, 0.1))
            for _ in range(2):  # sets of sets: what one step leaves is carried by the next
                found = descent.step(here, h)
                assert found is not None
                piece, there = found
                for _ in range(2):
                    corner = [arb(m) + x.mid() for m, x in zip(here.middle, inside(here, rng), strict=True)]
                    thin = descent.step(FlowSet.about(corner), h)
                    assert thin is not None
                    for wide, narrow in zip(piece.fields, thin[0].fields, strict=True):
                        assert all(a.overlaps(b) for a, b in zip(wide.c, narrow.c, strict=True))
                        assert wide.at(arb(0.7)).real.contains(narrow.at(arb(0.7)).real.mid())
                    back = there.frame.inv() * arb_mat([[x - m] for x, m in zip(thin[1].middle, there.middle, strict=True)])
                    assert all(r.contains(x[0].mid()) for r, x in zip(there.box, back.tolist(), strict=True))
                here = there


def inside(flow_set: FlowSet, rng: np.random.Generator) -> list[Any]:
    """The difference from the middle of a state of the set, near a corner of its box."""
    signs = [0.99 * x.rad() * int(s) + x.mid() for x, s in zip(flow_set.box, rng.choice([-1, 1], 5), strict=True)]
    return [row[0] for row in (flow_set.frame * arb_mat([[x] for x in signs])).tolist()]


def test_the_base_of_a_flow_is_that_of_its_neighbours_and_of_no_others(flows: dict[str, Flow]) -> None:
    T = flows["high"].far_temperature
    thick = enclosed(flows["high"], arb(T, 1e-9))
    for offset in (-1e-9, 1e-9):
        assert thick.same_base(enclosed(flows["high"], arb(T + offset)))
    for offset in (-1e-3, 1e-3):
        assert not thick.same_base(enclosed(flows["high"], arb(T + offset)))


def test_a_typed_far_temperature_is_told_as_typed(flows: dict[str, Flow]) -> None:
    """A ball that is exact has no digits to be counted."""
    flow = st.chute.steady(far_temperature=7.3125, e=0.8, e_w=0.8, r=0.6, tan_theta=0.3)
    form = ChuteEnclosable(ChuteProblem(flow, 0.0, 0.01))
    with ctx.workprec(64):
        form.enclosure(64, acb(arb(0.004, 1e-6), arb(0, 1e-6)))
    assert form.premise.startswith("for the steady flow with far_temperature = 7.3125 and a base at nu = 0.03")


def test_tails_that_do_not_map_into_themselves_are_no_tails() -> None:
    """y′ = 4 y² from 1: the solution 1/(1 − 4t) does not reach t = 1."""
    with ctx.workprec(100):
        terms = [[arb(4) ** m for m in range(20)]]
        assert tailed(terms, arb(1), lambda y: [4 * (y[0] * y[0]).tail / 20]) is None
        near = tailed(terms, arb("0.05"), lambda y: [arb("0.2") * (y[0] * y[0]).beyond()[19] / 20])
        assert near is not None
        assert near[0].at(1).contains(1 / arb("0.8")) and near[0].tail < 1e-12


def test_the_exponents_at_infinity_are_those_of_plane_waves(flows: dict[str, Flow]) -> None:
    """Lemma C3: det(λ − A_0) = (λ² − K² T²)⁴ and A_0 P_0 = P_0 Λ, for parameters without any property."""
    with BALLS.working(60):
        for waves, T, sigma in (((0.3, 0.4), "1.7", "0.9"), ((0.0, 0.7), "3.1", "0.2"), ((0.6, 0.0), "0.4", "1.3")):
            chute = flows["high"].chute.with_numbers(lambda x: BALLS.number(exact(x)))
            kx, ky = (acb(BALLS.number(exact(k))) for k in waves)
            far, s = (arb(T), arb("2.3")), acb(arb(sigma), arb("0.45"))
            bg = background(chute, arb(0), far[0], far[1], arb(0), arb.pi())
            C0, C1, D0, D1 = ({at: acb(e) for at, e in part.items()} for part in system.pencil_entries(bg, chute.tan_theta, kx, ky))

            def dense(plain: Any, factor: Any, s: Any = s) -> Any:
                every = range(system.SIZE)
                return acb_mat([[plain.get((i, j), acb(0)) + s * factor.get((i, j), acb(0)) for j in every] for i in every])

            A0 = (dense(C0, C1) * bg.decay[0]).inv() * dense(D0, D1)
            KT = wavenumber(BALLS, kx, ky) * far[0]
            assert all(
                (a - b).contains(0) and a.rad() < 1e-30
                for a, b in zip(A0.charpoly(), (arb_poly([-(acb(KT).real ** 2), 0, 1]) ** 4).coeffs(), strict=True)
            )
            P, nilpotent = leading(BALLS, chute, (kx, ky), far, s)
            if waves[0] == 0.0:  # back from v → iv
                P = [[acb(x) * (1j if i in (2, 6) else 1) for x in row] for i, row in enumerate(P)]
            P0, N = acb_mat([[acb(x) for x in row] for row in P]), acb_mat([[acb(x) for x in row] for row in nilpotent])
            off = A0 * P0 - P0 * N - P0 * acb(KT)
            assert all(x.contains(0) and x.rad() < 1e-30 for x in off.entries())


@pytest.mark.slow
def test_d_in_balls_is_a_multiple_of_d_in_doubles(scenes: dict[str, ChuteProblem]) -> None:
    """k_x ≠ 0 and k_y = 0: nothing of the system is real, and v is apart."""
    problem, places = scenes["fig2"], (0.0015 - 0.0045j, 0.0016 - 0.0044j)
    with ctx.workprec(96):
        middle = acb(sum(places) / 2)
        region = acb(middle.real + arb(0, 2e-4), middle.imag + arb(0, 2e-4))
        form = ChuteEnclosable(problem)
        D = form.enclosure(96, region)
        assert form.enclosure(80, acb(places[0])) is D
        found = [D(acb(s)) for s in places]
        assert all(x.rel_accuracy_bits() > 30 for x in found)
        assert abs(found[0]).log() < D.growth(acb(arb(0.0015, 1e-8), arb(-0.0045, 1e-8)))
    doubles = st.discriminant(problem)
    assert complex(found[0] / found[1]) == pytest.approx(doubles(places[0]).over(doubles(places[1])), rel=1e-7)


def test_no_enclosure_holds_the_end_of_the_continuous_spectrum(scenes: dict[str, ChuteProblem]) -> None:
    problem = scenes["high"]
    with ctx.workprec(64), pytest.raises(ConvergenceError):
        ChuteEnclosable(problem).enclosure(64, acb(arb(0, 1e-3), arb(0, 1e-3)))


@pytest.mark.slow
def test_the_growing_mode_of_the_high_flow_is_proved(scenes: dict[str, ChuteProblem]) -> None:
    """A disc of 1e-11 takes fewest values of D; smaller ones, and the other flows, are in validation/proofs.py."""
    proof = st.prove(scenes["high"], guess=0.00397, digits=8)
    assert proof.count == 1 and proof.region["radius"] == "1e-11"
    assert proof.region["centre"]["re"].startswith("0.0039705046388892")
    assert proof.premise.startswith("a steady flow with mass_flux = 3.0 exists")
    assert HIGH[:17] in proof.premise
    assert "C6" in proof.lemmas
    assert not {"E2", "E3"} & set(proof.lemmas)  # frames on given steps, in place of compound matrices


@pytest.mark.slow
def test_balls_of_the_continuous_spectrum_hold_it_and_regions_about_it_are_refused(scenes: dict[str, ChuteProblem]) -> None:
    """det C of the enclosed system vanishes in them: σ_c of doubles at every height lies in one, and D is analytic on what none meets."""
    for name, place in (("high", 0.004), ("low", 0.02 - 0.04j)):
        problem = scenes[name]
        form = ChuteEnclosable(problem)
        with ctx.workprec(64):
            D = form.enclosure(64, acb(arb(place.real, 1e-6), arb(place.imag, 1e-6)))
            balls = D.path.singular
            top = problem.flow.height(float(D.path.flow.start.mid()))
            for sigma in problem.continuum(np.linspace(0.0, top, 200)).tolist():
                assert any(ball.overlaps(acb(arb(sigma.real, 1e-9), arb(sigma.imag, 1e-9))) for ball in balls)
            assert all(ball.real.lower() < 1e-12 and ball.is_finite() for ball in balls)
            assert D.analytic(acb(place)) and not D.analytic(acb(-1j * problem.kx * problem.flow.far_velocity))
    with pytest.raises(ConvergenceError, match="not seen to be analytic inside the region at -"):
        prove_region(scenes["high"], st.Rectangle(-2.0 - 1.0j, 0.5 + 1.0j), workers=1)
