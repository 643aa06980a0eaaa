"""D(σ) is a function of σ: nothing that was asked before changes it."""

from __future__ import annotations

import gc
import itertools
import weakref
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
import pytest

import shootstab as st
from shootstab.core.errors import InputError, ShootstabError
from shootstab.discriminants import adaptive
from shootstab.discriminants.cells import CELL_PARTS, Cell
from shootstab.discriminants.continuation import Continuation
from shootstab.discriminants.method import AdaptiveDiscriminant
from shootstab.models.gallery.poiseuille import PlanePoiseuille
from shootstab.problems.protocol import Problem

METHODS = st.Frame(rtol=1e-9), st.Compound(rtol=1e-9), st.Riccati(rtol=1e-9)
ELSEWHERE = (0.02 + 0.3j, -3.0 + 0.5j, 70.0 - 20j, 1e-5j, 2000.0, -0.3 + 1e-3j)


def orr_sommerfeld() -> Problem:
    return PlanePoiseuille(reynolds=2000.0)


def well() -> Problem:
    return st.gallery.poeschl_teller(2.5)


@pytest.mark.parametrize("make", [orr_sommerfeld, well])
@pytest.mark.parametrize("method", METHODS, ids=lambda m: m.name)
def test_D_at_one_sigma_is_unaffected_by_evaluations_elsewhere(make, method) -> None:
    problem, sigma = make(), 0.05 - 0.3j
    alone, after = method.on(problem), method.on(problem)
    for other in ELSEWHERE:
        after.with_derivative(other)
    after.around(sigma, 0.02)
    for D in (alone, after):
        D(sigma)
    assert alone(sigma) == after(sigma)
    assert alone.with_derivative(sigma) == after.with_derivative(sigma)
    assert alone.at(sigma).refined()(sigma) == after.at(sigma).refined()(sigma)


def test_the_paths_around_a_continuous_spectrum_do_not_depend_on_the_order_of_questions(scenes) -> None:
    problem = scenes["fig2"]
    curve = [complex(problem.continuum(np.array([z + 0j]))[0]) for z in (5.0, 9.0, 15.0, 15.6, 30.0)]
    near = [s * (1 + 1e-3) for s in curve]
    forth, back = (Continuation(problem, st.Frame(rtol=1e-9)) for _ in range(2))
    values = {s: forth.at(s).discriminant.with_derivative(s) for s in near}
    assert {s: back.at(s).discriminant.with_derivative(s) for s in reversed(near)} == values
    assert len({forth.at(s).path for s in near}) > 2


def test_a_mesh_around_a_circle_makes_D_one_function_there() -> None:
    """Cauchy's formula to rounding, over cells whose meshes differ by the error of integration."""
    centre, radius = 1.0371 * 2.0 - 0.0j, 0.4  # on the border of two cells
    discriminant = st.Frame(rtol=1e-6).on(orr_sommerfeld()).around(centre, radius)
    middle = discriminant(centre)
    rim = [discriminant(centre + radius * np.exp(2j * np.pi * k / 64)).at_scale(middle.log_scale) for k in range(64)]
    assert np.mean(rim) == pytest.approx(middle.mantissa, rel=1e-11)


def test_claims_shuffled_split_or_alone_have_the_same_verdicts_bit_for_bit() -> None:
    problem = well()  # modes at 25/4, 9/4, 1/4 less than the continuum's edge
    found = [m.sigma for m in st.find(problem, st.Rectangle(0.05 - 0.5j, 7 + 0.5j)).modes]
    claims = [*found, found[0] * (1 + 1e-4), 3.3 + 0.2j, found[1] * (1 + 1e-3j)]

    def verdicts(some: list[complex]) -> dict[complex, tuple]:
        return {v.claimed: (v.verdict, v.sigma, v.error) for v in st.verify(problem, some).verdicts}

    together = verdicts(claims)
    assert {v for v, _, _ in together.values()} >= {"confirmed", "spurious"}
    shuffled = [claims[i] for i in np.random.default_rng(4).permutation(len(claims))]
    assert verdicts(shuffled) == together
    apart = verdicts(claims[:2]) | verdicts(claims[2:3]) | {c: v for claim in claims[4:5] for c, v in verdicts([claim]).items()}
    assert all(together[claim] == verdict for claim, verdict in apart.items())


def test_cells_are_nested_and_their_anchors_lie_in_their_closure() -> None:
    rng = np.random.default_rng(7)
    sigmas = [*(10.0 ** rng.uniform(-6, 6, 200) * np.exp(1j * rng.uniform(-np.pi, np.pi, 200))), -3.0, 2j, -2j, 5.0, 1e-300, 0.0]
    for sigma in map(complex, sigmas):
        cells = [Cell.of(sigma, level) for level in range(4)]
        for large, small in itertools.pairwise(cells):
            assert small.larger == large
        if abs(sigma) > 1e-20:
            for cell in cells:
                width = np.radians(40.0) / CELL_PARTS**cell.level
                turn = np.angle(sigma / cell.anchor)
                assert 1.0 <= abs(cell.anchor) / abs(sigma) * (1 + 1e-12) <= 2.0 ** (1 / CELL_PARTS**cell.level) * (1 + 1e-12)
                assert abs(turn) <= 0.5 * width * (1 + 1e-9)


@pytest.mark.parametrize("method", METHODS, ids=lambda m: m.name)
def test_the_mesh_of_a_cell_serves_both_of_its_ends(scenes, method) -> None:
    for problem, sigma in ((scenes["mid"], 0.00102), (scenes["high"], 0.004), (orr_sommerfeld(), 0.05 - 0.3j)):
        cell, D = Cell.of(sigma, 0), method.on(problem)
        assert D.at(cell.smallest * (1 + 1e-9)) is D.at(cell.anchor * (1 - 1e-9))


@pytest.mark.parametrize("scene", ["high", "mid"])
@pytest.mark.parametrize("rtol", [10**-9.75, 1e-11, 1e-12, 1e-13])
def test_the_iterates_of_a_search_share_their_meshes(scenes, scene: str, rtol: float) -> None:
    """By compound matrices one step errs now and then by more than the mesh was made for; its cell has a mesh then, not every iterate."""
    guess = {"high": 0.004, "mid": 0.001}[scene]
    mode, other = st.refine(scenes[scene], guess, rtol=1e-9, method=st.Compound(rtol=rtol)), st.refine(scenes[scene], guess)
    assert mode.evaluations < 40  # 18 where one mesh serves all
    assert abs(mode.sigma - other.sigma) <= mode.error + other.error


@pytest.mark.parametrize("scene", ["low", "high"])  # two subsystems, and one
def test_the_meshes_that_are_kept_take_no_more_memory_than_they_may_and_change_no_answer(scenes, scene: str, monkeypatch) -> None:
    problem, method = scenes[scene], st.Frame(rtol=1e-10)
    sigmas = [0.007 * 1.5**k * np.exp(0.2j * k) for k in range(14)]
    whole = method.on(problem)
    expected = [whole.with_derivative(s) for s in sigmas]
    bound = whole.bytes_kept // 2
    monkeypatch.setattr(adaptive, "MOST_BYTES_KEPT", bound)
    D = method.on(problem)
    alive: weakref.WeakSet[Any] = weakref.WeakSet()
    for sigma, value in zip(sigmas, expected, strict=True):
        assert D.with_derivative(sigma) == value
        alive |= {*getattr(D.at(sigma), "members", [D.at(sigma)])}
        assert D.bytes_kept <= bound
        assert sum(one.steps * one.sampled.bytes_of_a_step for one in alive) <= bound
    assert D.evaluations == whole.evaluations


@dataclass(frozen=True)
class Watched:
    """Frames, with notes on which D they made that cost no memory."""

    made: weakref.WeakSet[AdaptiveDiscriminant]
    rtol: float = 1e-9
    name: str = "frame"

    def on(self, *given: Any, **named: Any) -> AdaptiveDiscriminant:
        D = st.Frame(rtol=self.rtol).on(*given, **named)
        self.made.add(D)
        return D


@pytest.fixture
def no_collection() -> Iterator[None]:
    """What is not given back by counting references stays."""
    gc.collect()
    gc.disable()
    yield
    gc.enable()


def string(singular: float = 0.0) -> Problem:
    """y″ = σ y between walls at 0 and 1, σ = −(mπ)²; with a singular point at 1/2 where this is not 0. No function is kept from question to
    question."""

    def pencil(z: Any) -> tuple[Any, Any]:
        one, zero = np.ones_like(z), np.zeros_like(z)
        with np.errstate(all="ignore"):
            D0 = np.array([[zero, one], [singular / (z - 0.5001) ** 2, zero]])
        return D0.transpose(2, 0, 1), np.array([[zero, zero], [one, zero]]).transpose(2, 0, 1)

    return st.problem(2, pencil, st.Wall(0.0, [[1, 0]]), st.Wall(1.0, [[1, 0]]), vectorized=True)


QUESTIONS: dict[str, Callable[[Watched], Any]] = {
    "a mode": lambda m: st.refine(string(), -9.9, method=m),
    "a tighter tolerance": lambda m: st.refine(string(), -9.9, rtol=1e-13, method=Watched(m.made, 1e-6)),
    "no mode": lambda m: st.refine(string(), -20.0 + 300j, method=m),
    "no mesh": lambda m: st.refine(string(-0.3), -20.0, method=m),
    "no count": lambda m: st.count(string(), st.Disc(-(np.pi**2) - 0.3, 0.3), method=m),
    "no find": lambda m: st.find(string(-0.3), st.Rectangle(-50 - 1j, -1 + 1j), method=m),
    "verdicts": lambda m: st.verify(string(), [-9.87, -39.4, 3j], method=m),
}


@pytest.mark.parametrize("question", QUESTIONS)
@pytest.mark.usefixtures("no_collection")
def test_what_a_question_computed_is_given_back_with_the_answer(question: str) -> None:
    """An error that is kept where it was caught would hold every mesh that the search has seen: a gigabyte after a few that wander."""
    made: weakref.WeakSet[AdaptiveDiscriminant] = weakref.WeakSet()
    asked = []
    try:
        asked.append(QUESTIONS[question](Watched(made)))
    except ShootstabError as error:
        asked.append(str(error))
    assert asked
    assert not made


@pytest.mark.parametrize("method", [st.Frame, st.Compound, st.Riccati])
@pytest.mark.parametrize("rtol", [0.0, -1.0, float("inf"), float("nan"), 1e-17, 2.0, "1e-9"])
def test_a_tolerance_that_no_step_can_hold_is_refused(method, rtol) -> None:
    with pytest.raises(InputError, match="allowed is a number from"):
        method(rtol=rtol)
