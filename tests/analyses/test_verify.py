"""refine, count, verify: published values, error bounds, verdicts on planted faults, extremes."""

from __future__ import annotations

import math

import numpy as np
import pytest

import shootstab as st
from shootstab.analyses.error_budget import displacement
from shootstab.analyses.reference import claims, spectrum
from shootstab.analyses.verdicts import radius_of
from shootstab.essential_spectrum.interior import SampledContinuum, continuum_of
from shootstab.models.chute import ChuteProblem
from shootstab.models.chute import chute_collocation as pseudospectral
from shootstab.models.gallery.poiseuille import PlanePoiseuille

GRAINS = {"e": 0.8, "e_w": 0.8, "r": 0.6, "tan_theta": 0.3}
PAPER = {"high": (0.004, 0.00397, 3), "mid": (0.001, 0.00102, 3), "low": (0.0073 - 0.0119j, 0.00727 - 0.0119j, 3)}
# re-computed values of guide/theory.md 1.1, each digit
REFINED = {"high": 0.0039705, "mid": 0.0010229, "low": 0.0072756 - 0.0118650j}


@pytest.mark.parametrize("name", list(REFINED))
def test_the_papers_modes(scenes: dict[str, ChuteProblem], name: str) -> None:
    """Woodhouse & Hogg 2010, 3.2; the low flow is one unit off in the paper's third digit (guide/theory.md 1.1)."""
    guess, published, _ = PAPER[name]
    mode = st.refine(scenes[name], guess=guess, rtol=1e-10)
    assert mode.converged
    assert mode.error < 1e-10 * abs(mode.sigma)
    assert abs(mode.sigma - REFINED[name]) < 0.71e-7
    assert abs(mode.sigma.real - complex(published).real) < 1e-5
    assert abs(mode.sigma.imag - complex(published).imag) < 1e-4


def test_the_isotropic_wall_moves_the_mid_flow(flows) -> None:
    """guide/theory.md 1.3: 0.0010229 as printed, 0.0010251 with −½A r² ∂v/∂y in S_z."""
    flow = st.chute.steady(mass_flux=3.0, branch="mid", wall="isotropic", **GRAINS)
    mode = st.refine(st.chute.problem(flow, 0.0, 0.0125), guess=0.001)
    assert mode.sigma.real == pytest.approx(0.0010251, abs=5e-8)


def test_growth_of_the_high_flow_is_largest_at_ky_0_0100(flows) -> None:
    rates = {
        ky: st.refine(st.chute.problem(flows["high"], 0.0, ky), guess=0.00397, rtol=1e-8).sigma.real for ky in (0.0099, 0.0100, 0.0101)
    }
    assert max(rates, key=rates.__getitem__) == 0.0100


@pytest.mark.parametrize("rtol", [1e-4, 1e-6, 1e-8, 1e-10])
@pytest.mark.parametrize("name", ["high", "low", "fig2"])
def test_the_bound_holds_and_is_not_idle(scenes: dict[str, ChuteProblem], name: str, rtol: float) -> None:
    guess = {"high": 0.004, "low": 0.0073 - 0.0119j, "fig2": 0.0017 - 0.0016j}[name]
    truth = st.refine(scenes[name], guess=guess, rtol=1e-12)
    mode = st.refine(scenes[name], guess=guess, rtol=rtol)
    assert mode.converged
    assert abs(mode.sigma - truth.sigma) <= mode.error + truth.error
    assert mode.error <= rtol * abs(mode.sigma)
    assert mode.budget.total == mode.error


def test_budget_displacement_is_the_distance_of_zeros() -> None:
    from shootstab.discriminants.frame import Frame

    problem, other = PlanePoiseuille(), PlanePoiseuille(alpha=1 + 1e-6)
    discriminant = Frame(rtol=1e-11).on(problem)
    truth = st.refine(problem, guess=-1j * (0.2375 + 0.0037j), rtol=1e-11).sigma
    moved = st.refine(other, guess=truth, rtol=1e-11).sigma
    shooting = discriminant.at(truth)
    value = shooting.with_derivative(truth)
    assert displacement(shooting.on_same_mesh(other), value) == pytest.approx(abs(moved - truth), rel=1e-4)


def test_ten_digits_of_a_sigma_of_order_1e_9(flows) -> None:
    mode = st.refine(st.chute.problem(flows["high"], 0.0, 1e-6), guess=1.2e-9, rtol=1e-10)
    assert mode.converged
    turned = st.refine(st.chute.problem(flows["high"], 1e-9, math.sqrt(1e-12 - 1e-18)), guess=mode.sigma, rtol=1e-8)
    assert abs(mode.sigma) == pytest.approx(1.2092853580e-9, rel=1e-10)
    # a wave turned by 1e−3 radians drifts with the flow but grows alike
    assert turned.sigma.real == pytest.approx(mode.sigma.real, rel=1e-2)


@pytest.mark.parametrize(
    ("temperature", "kx", "ky", "guess"), [(0.03, 0.01, 0.0, 0.0075 + 0.0056j), (20.0, 0.0, 0.004, 0.003), (60.0, 0.0, 0.001, 0.0018)]
)
def test_dense_and_dilute_flows(temperature: float, kx: float, ky: float, guess: complex) -> None:
    problem = st.chute.problem(st.chute.steady(far_temperature=temperature, **GRAINS), kx, ky)
    mode = st.refine(problem, guess=guess, rtol=1e-10)
    assert mode.converged
    reference = pseudospectral.refine(problem.flow, kx, ky, guess, 200)
    assert abs(mode.sigma - reference.sigma) < 5e-8 * abs(mode.sigma)


@pytest.mark.parametrize(
    ("grains", "temperature", "kx", "ky"),
    [
        ({"e": 0.85, "e_w": 0.75, "r": 0.5, "tan_theta": 0.25}, 5.0, 0.004, 0.006),
        ({"e": 0.9, "e_w": 0.95, "r": 0.6, "tan_theta": 0.22, "nu_max": 0.64}, 3.0, 0.003, 0.004),
        ({"e": 0.8, "e_w": 0.8, "r": 0.6, "tan_theta": 0.3, "radial": "carnahan-starling"}, 4.0, 0.002, 0.007),
    ],
)
def test_odd_scenes_agree_with_the_pseudospectral_reference(grains: dict, temperature: float, kx: float, ky: float) -> None:
    problem = st.chute.problem(st.chute.steady(far_temperature=temperature, **grains), kx, ky)
    leading = claims(problem, 8)[0]
    mode = st.refine(problem, guess=leading, rtol=1e-10)
    assert mode.converged
    assert abs(mode.sigma - leading) < 1e-8 * abs(mode.sigma)


@pytest.mark.parametrize(("name", "wanted"), [("high", 1e-9), ("mid", 1e-9), ("fig2", 1e-9), ("low", 1e-7)])
def test_shooting_against_pseudospectral(scenes: dict[str, ChuteProblem], name: str, wanted: float) -> None:
    reference = spectrum(scenes[name], 80).eigenvalues[0]
    mode = st.refine(scenes[name], guess=reference, rtol=1e-11)
    assert abs(mode.sigma - reference) < wanted * abs(mode.sigma)


def test_refusals_give_reasons(scenes: dict[str, ChuteProblem]) -> None:
    for arguments in ({"guess": complex("nan")}, {"guess": 1.0, "rtol": 0.0}, {"guess": 1.0, "digits": 0}):
        with pytest.raises(st.InputError, match="allowed"):
            st.refine(scenes["high"], **arguments)
    lost = st.refine(scenes["high"], guess=3.0 + 5.0j, rtol=1e-6)
    assert lost.converged or lost.status.startswith("not converged: ")


def test_rtol_beyond_reach_is_said(flows) -> None:
    mode = st.refine(st.chute.problem(flows["high"], 0.0, 1e-6), guess=1.2e-9, rtol=1e-13)
    assert not mode.converged
    assert "exceeds" in mode.status
    assert 0 < mode.error < 1e-9 * abs(mode.sigma)


def test_the_circle_that_digits_mean() -> None:
    """Everything that rounds to the claim lies inside; half of the next unit outside does not."""
    for claim in (0.00397050, 9.999e-5 - 3e-6j, -1.0 + 1.0j, 123456.0):
        unit = 10.0 ** (math.floor(math.log10(max(abs(claim.real), abs(claim.imag)))) + 1 - 6)
        assert radius_of(claim, 6) == pytest.approx(abs(complex(unit / 2, unit / 2)))


def test_verdicts_on_planted_faults(scenes: dict[str, ChuteProblem]) -> None:
    problem = scenes["low"]
    truth = st.refine(problem, guess=0.0073 - 0.0119j, rtol=1e-11).sigma
    other = truth * (1 + 1e-3)
    report = st.verify(problem, [truth * (1 + 1e-9), truth * 1.3, truth])
    assert [v.verdict for v in report.verdicts] == ["spurious", "spurious", "confirmed"]
    assert "repeats claim 3" in report.verdicts[0].why
    report = st.verify(problem, [other])
    assert report.verdicts[0].verdict == "inaccurate"
    assert report.verdicts[0].digits_agreed == pytest.approx(3.0, abs=1e-6)
    assert abs(report.verdicts[0].sigma - truth) < 1e-11
    assert not report.missing
    for shift, digits, verdict in ((1e-6, 5, "confirmed"), (1e-6, 8, "inaccurate"), (1e-9, 8, "confirmed"), (1e-9, 10, "inaccurate")):
        assert st.verify(problem, [truth * (1 + shift)], digits=digits).verdicts[0].verdict == verdict


def test_a_removed_mode_is_missing(scenes: dict[str, ChuteProblem]) -> None:
    report = st.verify(scenes["high"], [0.002 + 0.003j], region=st.Rectangle(1e-4 - 0.1j, 0.05 + 0.1j))
    assert [v.verdict for v in report.verdicts] == ["spurious"]
    assert len(report.missing) == 1
    assert report.missing[0].sigma.real == pytest.approx(0.00397050464, rel=1e-9)
    assert report.bad_news
    assert report.summary["missing"] == 1


def test_claims_on_the_continuous_spectrum(scenes: dict[str, ChuteProblem]) -> None:
    """On the curve D is counted from both sides; only at its ends is there nothing to count."""
    problem = scenes["fig2"]
    inside, base, infinity = (complex(problem.continuum(np.array([z + 0j]))[0]) for z in (15.0, 0.0, problem.flow.height(1e-14)))
    report = st.verify(problem, [inside])
    assert report.verdicts[0].verdict == "spurious"
    assert report.verdicts[0].continuum_distance < 1e-6 * abs(inside)
    report = st.verify(problem, [base, infinity], region=st.Rectangle(0.01 + 0.01j, 0.02 + 0.02j))
    assert [v.verdict for v in report.verdicts] == ["continuum", "continuum"]
    assert "end at the wall" in report.verdicts[0].why
    assert "end at infinity" in report.verdicts[1].why
    assert not report.bad_news
    assert report.strictly_bad_news


def test_the_raw_balloon_is_never_confirmed_wrongly(scenes: dict[str, ChuteProblem]) -> None:
    """Of a raw QZ spectrum near the continuous spectrum, whatever is confirmed is a mode that a finer truncation has too."""
    raw = spectrum(scenes["fig2"], 40, filtered=False).raw
    near = [z for z in raw if abs(z) < 0.012]
    report = st.verify(scenes["fig2"], near, digits=4)
    fine = spectrum(scenes["fig2"], 120, filtered=False).raw
    confirmed = [v for v in report.verdicts if v.verdict == "confirmed"]
    assert 1 <= len(confirmed) < len(near)
    for v in confirmed:
        assert np.abs(fine - v.sigma).min() < 1e-5 * abs(v.sigma)
    assert report.summary["spurious"] + report.summary["continuum"] > 0


def test_count(scenes: dict[str, ChuteProblem]) -> None:
    assert st.count(scenes["high"], st.Rectangle(1e-4 - 0.1j, 0.05 + 0.1j)) == 1
    assert st.count(scenes["fig2"], st.Disc(0.00169243 - 0.00156624j, 1e-4)) == 1
    assert st.count(scenes["fig2"], st.Disc(0.002 + 0.002j, 5e-4)) == 0
    with pytest.raises(st.ConvergenceError, match="on the boundary"):
        st.count(scenes["fig2"], st.Disc(9.99999e-4 - 0.0044558630891j, 1e-3))


def test_poiseuille_through_the_same_doors() -> None:
    problem = PlanePoiseuille()
    c = 0.2375264888 + 0.0037396706j
    mode = st.refine(problem, guess=-1j * (0.2375 + 0.0037j))
    assert abs(1j * mode.sigma - c) < 1e-10
    assert mode.continuum_distance == math.inf
    report = st.verify(problem, [-1j * c], digits=8)
    assert report.verdicts[0].verdict == "confirmed"
    assert st.count(problem, st.Rectangle(1e-4 - 1j, 0.1 + 0.5j)) == 1


def test_distances_to_segments_of_the_continuous_spectrum(scenes: dict[str, ChuteProblem]) -> None:
    bent = SampledContinuum(scenes["fig2"].continuum, np.array([0.0, 1.0, 3.0]), np.array([0, 1, 1 + 1j]))
    assert bent.nearest(0.5 + 0.25j) == pytest.approx((0.25, 0.5))
    assert bent.nearest(-3 - 4j) == pytest.approx((5.0, 0.0))
    assert bent.nearest(1.5 + 0.5j) == pytest.approx((0.5, 2.0))
    assert continuum_of(PlanePoiseuille()) is None


def test_input_of_verify_is_checked(scenes: dict[str, ChuteProblem]) -> None:
    for bad, text in (([], "at least one"), ([math.nan], "eigenvalue 1"), ([0.1, math.inf], "eigenvalue 2")):
        with pytest.raises(st.InputError, match=text):
            st.verify(scenes["high"], bad)
    with pytest.raises(st.InputError, match="digits"):
        st.verify(scenes["high"], [0.1], digits=40)


def test_a_claim_of_nothing_shares_no_digit_with_a_mode(scenes: dict[str, ChuteProblem]) -> None:
    report = st.verify(scenes["fig2"], [0.0], digits=3)
    assert report.verdicts[0].verdict == "spurious"
    assert report.undecided
    assert "not looked for" in report.searched
    assert report.region is None


def test_where_nothing_is_searched_is_said(scenes: dict[str, ChuteProblem]) -> None:
    """Claims on a line span a box nevertheless; a claim beyond the reach of a mesh does not make the box larger, and is named."""
    line = st.verify(scenes["high"], [0.003, 0.0035, 0.0045])
    assert [m.sigma.real for m in line.missing] == pytest.approx([0.0039705046389])
    far = st.verify(scenes["high"], [0.0039705, 0.0045, 1e12], digits=5)
    assert [v.verdict for v in far.verdicts] == ["confirmed", "spurious", "unresolved"]
    assert far.undecided[0].startswith("the part of the plane that 1 more of the claims adds")
    assert "where 2 of the 3 claims lie" in far.searched


def test_a_claim_of_zero_where_no_zero_of_D_is_farther_than_another() -> None:
    """Waves on water have σ = ±0.87269362i and no other eigenvalue: D is quadratic, and 0 no double zero of it as seen from afar."""
    report = st.verify("water-waves", [0.0, 1e-9, 0.8726936208978296j], missing="none")
    assert [v.verdict for v in report.verdicts] == ["spurious", "spurious", "confirmed"]
