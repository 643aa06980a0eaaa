"""Counts of regions that the continuous spectrum crosses, modes found without a guess, and the half-plane of growing modes."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
from augmented import Augmented

import shootstab as st
from shootstab.analyses.cut_region import count_in_region
from shootstab.analyses.resonances import find_resonances
from shootstab.analyses.unstable import LAW, HalfDisc, bound, departure_from_law
from shootstab.core.regions import Disc, Polygon, Rectangle
from shootstab.discriminants.continuation import Continuation, Undecidable
from shootstab.discriminants.frame import Frame
from shootstab.models.chute import ChuteProblem
from shootstab.models.gallery.poiseuille import PlanePoiseuille
from shootstab.roots.winding import wind

UNSTABLE = 0.0016924312039 - 0.0015662388101j
DAMPED = -0.0035032956689 - 0.0070878998209j
BESIDE = -0.0428226492523 - 0.0036611350691j  # a mode of v̂ alone, 7e−4 off the continuous spectrum


@pytest.fixture(scope="module")
def continuation(scenes: dict[str, ChuteProblem]) -> Continuation:
    return Continuation(scenes["fig2"], Frame(rtol=1e-8))


def test_a_clear_region_is_counted_as_before(continuation: Continuation) -> None:
    box = Rectangle(0.001 - 0.003j, 0.003 + 0.001j)
    found = count_in_region(continuation, box)
    assert found.count == wind(Frame(rtol=1e-8).on(continuation.problem), box).count == 1
    assert found.left_out == ()


def test_regions_cut_along_the_continuous_spectrum(continuation: Continuation) -> None:
    """A part of the curve, the end at infinity, and all of it; counts add up where regions do."""
    across = count_in_region(continuation, Rectangle(-0.3 - 0.01j, -0.01 + 0.01j))
    assert (across.count, across.left_out) == (1, ())
    end = count_in_region(continuation, Rectangle(-0.01 - 0.01j, 0.01 + 0.01j))
    assert (end.count, len(end.left_out)) == (2, 1)
    both = count_in_region(continuation, Rectangle(-0.3 - 0.01j, 0.01 + 0.01j))
    assert both.count == across.count + end.count
    whole = count_in_region(continuation, Rectangle(-2 - 0.9j, 0.01 + 0.9j))
    assert len(whole.left_out) == 2
    assert max(s.closure for s in (across, end, both, whole)) < 1e-5


def test_discs_and_polygons_are_cut_too(continuation: Continuation) -> None:
    assert count_in_region(continuation, Disc(BESIDE, 0.01)).count == 1
    assert count_in_region(continuation, Polygon((-0.06 - 0.006j, -0.03 - 0.006j, -0.03 + 0.0j, -0.06 + 0.0j))).count == 1
    assert count_in_region(continuation, Polygon((-0.06 - 0.006j, -0.05 - 0.006j, -0.05 + 0.0j))).count == 0


def test_an_end_on_the_boundary_is_refused(continuation: Continuation) -> None:
    assert continuation.continuum is not None
    end = complex(continuation.continuum.sigma[-1])
    with pytest.raises(Undecidable, match="on the boundary"):
        count_in_region(continuation, Rectangle(end - 0.01 - 0.01j, end + 1e-9 + 0.01j))


def test_find_needs_no_guess(scenes: dict[str, ChuteProblem]) -> None:
    found = st.find(scenes["fig2"], Rectangle(-0.1 - 0.01j, 0.01 + 0.005j))
    assert [
        abs(m.sigma - z) < 1e-10 for m, z in zip(sorted(found.modes, key=lambda m: m.sigma.real), (BESIDE, DAMPED, UNSTABLE), strict=True)
    ]
    assert all(m.converged for m in found.modes)
    assert found.resonances is None
    assert found.counted.count == 3


def test_resonances_are_zeros_of_a_continuation_and_not_modes(continuation: Continuation) -> None:
    (low, high) = (
        find_resonances(continuation, Rectangle(-0.11 - 0.01j, -0.08 + 0.01j)),
        find_resonances(continuation, Rectangle(-0.06 - 0.01j, -0.03 + 0.01j)),
    )
    assert low
    for sigma in low:
        report = st.verify(continuation.problem, [sigma], digits=5, region=Rectangle(0.01 + 0.01j, 0.02 + 0.02j))
        assert report.verdicts[0].verdict == "spurious"
    # the mode of v̂ is a zero of both continuations
    assert all(abs(s - BESIDE) > 1e-6 for s in high)
    assert find_resonances(Continuation(PlanePoiseuille(), Frame()), Rectangle(0j, 1 + 1j)) == []


def test_a_polygon() -> None:
    clockwise = Polygon((0j, 1j, 1 + 1j, 1 + 0j))
    assert clockwise.vertices[0] == 1
    assert clockwise.contains(0.5 + 0.5j)
    assert not clockwise.contains(1.5 + 0.5j)
    assert [clockwise.boundary(clockwise.parameter(p)) for p in (0.5 + 0j, 1 + 0.25j)] == [0.5, 1 + 0.25j]
    for bad in ((0j, 1j), (0j, 1j, 2j), (0j, 1j, complex("nan"))):
        with pytest.raises(st.InputError, match="polygon"):
            Polygon(bad)


def test_the_boundary_of_a_half_disc() -> None:
    half = HalfDisc(2.0, 1e-6)
    ts = np.linspace(0.0, 1.0, 101)
    points = [half.boundary(t) for t in ts]
    assert all(p.real > 0.99e-6 for p in points)
    assert points[0] == pytest.approx(points[-1], abs=1e-12)
    assert sum((p.conjugate() * q).imag for p, q in itertools.pairwise(points)) > 0  # counter-clockwise
    for t in ts[1:-1]:
        assert half.parameter(half.boundary(t)) == pytest.approx(t, abs=1e-6)


@pytest.mark.parametrize("name", ["high", "mid", "low", "fig2"])
def test_one_mode_grows_in_every_scene_of_the_paper(scenes: dict[str, ChuteProblem], name: str) -> None:
    found = st.count_unstable(scenes[name])
    assert found.count == 1
    assert found.departure < LAW
    assert found.counted.closure < 1e-6


def test_the_law_of_growth_gets_better_outwards(scenes: dict[str, ChuteProblem]) -> None:
    shooting = Frame(rtol=1e-8).on(scenes["high"])
    departures = [departure_from_law(shooting, r) for r in (1.0, 10.0, 100.0)]
    assert departures[0] > departures[1] > departures[2]
    assert departures[2] < 0.01


def test_a_zero_on_the_arc_breaks_the_law(scenes: dict[str, ChuteProblem]) -> None:
    """The bound may not stop short of the unstable mode."""
    shooting = Frame(rtol=1e-8).on(scenes["high"])
    assert departure_from_law(shooting, 0.0039705) > 0.2
    assert bound(shooting)[0] > 0.004


def test_verify_states_the_number_of_growing_modes(scenes: dict[str, ChuteProblem]) -> None:
    report = st.verify(scenes["high"], [-0.1558104046 + 0.3748369704j], unstable=True, region=Rectangle(0.01 + 0.01j, 0.02 + 0.02j))
    assert report.verdicts[0].verdict == "confirmed"
    assert [m.sigma for m in report.missing] == pytest.approx([0.0039705046389])
    assert "in all 1 mode has Re sigma >" in report.searched


SINGLE = PlanePoiseuille(reynolds=500.0)
SEMISIMPLE, DEFECTIVE = Augmented(SINGLE), Augmented(SINGLE, drive=1.0)
NOWHERE = Rectangle(1 + 1j, 2 + 2j)


@pytest.fixture(scope="module")
def single() -> complex:
    """Its own error is far below that of the double ones."""
    (mode,) = st.find(SINGLE, Rectangle(-0.1 - 0.45j, 0.05 - 0.2j), rtol=1e-13).modes
    assert mode.error < 1e-14
    assert mode.multiplicity == 1
    return complex(mode.sigma)


@pytest.mark.parametrize("problem", [SEMISIMPLE, DEFECTIVE], ids=["semisimple", "defective"])
def test_a_double_eigenvalue_is_reported_as_such(problem: Augmented, single: complex) -> None:
    near = Disc(single * (1 + 1e-4), 1e-3 * abs(single))
    assert st.count(problem, near) == 2
    for mode in (st.refine(problem, guess=single * 1.01, rtol=1e-4), *st.find(problem, near, rtol=1e-4).modes):
        assert mode.multiplicity == 2
        assert mode.converged
        assert abs(mode.sigma - single) <= mode.error < 1e-4 * abs(single)


def test_claims_of_a_double_eigenvalue(single: complex) -> None:
    """It answers two claims, not three; claimed once, one is missing."""
    problem = DEFECTIVE
    claims = [single, single * (1 + 1e-7), single * (1 + 2e-7)]
    report = st.verify(problem, claims, digits=4, region=NOWHERE)
    assert [v.verdict for v in report.verdicts] == ["confirmed", "confirmed", "spurious"]
    assert [v.multiplicity for v in report.verdicts] == [2, 2, 1]
    assert "of multiplicity 2" in report.verdicts[0].why
    assert "of multiplicity 2 only" in report.verdicts[2].why
    near = Rectangle(single - 0.01 - 0.01j, single + 0.012 + 0.013j)
    once = st.verify(problem, claims[:1], digits=4, region=near)
    assert len(once.missing) == 1
    assert abs(once.missing[0].sigma - single) < 1e-4
    off = st.verify(problem, [single * (1 + 1e-3)], digits=5, region=NOWHERE).verdicts[0]
    assert off.verdict == "inaccurate"
    assert off.digits_agreed == pytest.approx(3.0, abs=0.1)


@pytest.mark.parametrize(
    "region",
    [Disc(-0.001 - 0.004j, 0.006), Polygon((-0.006 - 0.009j, 0.003 - 0.009j, 0.004 + 0.0021j, 0.0007 - 0.0021j, -0.006 + 0.0017j))],
    ids=["disc", "polygon"],
)
def test_find_in_other_regions(scenes: dict[str, ChuteProblem], region: Disc | Polygon) -> None:
    """Around the end of the continuous spectrum at infinity."""
    found = st.find(scenes["fig2"], region)
    assert sorted((complex(m.sigma) for m in found.modes), key=lambda z: z.real) == pytest.approx([DAMPED, UNSTABLE], abs=1e-10)
    assert found.counted.closure < 1e-5


def test_points_where_an_iteration_stalls_are_no_modes() -> None:
    """Muller stalls at the first two with one tolerance and another: winding numbers are 0."""
    flow = st.chute.steady(e=0.85, e_w=0.75, r=0.5, tan_theta=0.25, far_temperature=5.0)
    problem = st.chute.problem(flow, 0.004, 0.006)
    stalls, mode = (-0.0001256 - 0.0405999j, 0.0039058 - 0.0351725j), 0.00182747 - 0.02681564j
    for sigma in stalls:
        assert st.count(problem, Disc(sigma, 0.05 * abs(sigma))) == 0
    report = st.verify(problem, [*stalls, mode], digits=6, region=NOWHERE)
    assert [v.verdict for v in report.verdicts] == ["spurious", "spurious", "confirmed"]


def test_a_claim_too_large_for_a_mesh_is_unresolved_at_once(scenes: dict[str, ChuteProblem]) -> None:
    report = st.verify(scenes["fig2"], [3e9 + 1e3j, 2000.0 + 3.0j], region=NOWHERE)
    assert [v.verdict for v in report.verdicts] == ["unresolved", "spurious"]
    assert "steps" in report.verdicts[0].why
