"""analyses/error_budget.py: every part of the bound against discriminants that are linear, whose zeros are known."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

import shootstab as st
from shootstab.analyses.error_budget import (
    FAR_PROBE,
    FLOW_NOISE,
    NOISE,
    SAFETY,
    SYSTEM_NOISE,
    SYSTEM_PROBE,
    budget,
    gradient_by_steps,
    integration_error,
)
from shootstab.core.discriminant import Value
from shootstab.core.scaled import Scaled

SIGMA, ZERO = 0.3 + 0.2j, 0.3 + 0.2j - 1e-6
HALVED = 2.0 ** (8 / 2) - 1.0  # an error that is halved to the fourth power, half the order of the pair: what is left is 1/15 of what went
EPSILON = 2.0**-52
CLOSE = 3e-7  # 7e-10, the least that a zero is moved by and not lost in others, has a rounding error of 1e-7 of itself


@dataclass
class RoughFlow:
    """A problem whose base flows, less accurate by 4 and by 2, move the zero so far; and whose farther walls do."""

    moves: dict[float, float]
    farther_walls: Any = None
    move: float = 0.0

    def with_base_flow_error(self, factor: float) -> Any:
        return RoughFlow({}, move=self.moves[factor]) if self.moves else self


@dataclass
class Linear:
    """D(σ) = slope · (σ − zero) at a scale of its own; every variant moves its zero by what is said here."""

    zero: complex
    slope: complex = 2.0 - 1.0j
    log_scale: float = 3.0
    start: float = 0.0
    signed: float = 0.0  # by what the zero moves where the start is changed by real amounts; 0 for a D that is not real
    rotated: dict[int, float] = field(default_factory=dict)
    elsewhere: dict[int, float] = field(default_factory=dict)
    entries: dict[int, float] = field(default_factory=dict)
    far: float = 1e-5
    drawn: dict[int, float] | None = None  # by what the zero moves where the steps of a digit are halved; by default half the way to ZERO
    local: tuple[float, ...] = (1e-9,)  # local errors of steps; of halved ones those of both halves

    def __call__(self, sigma: complex) -> Scaled:
        return Scaled(self.slope * (sigma - self.zero), self.log_scale)

    def with_derivative(self, sigma: complex) -> Value:
        return Value(sigma, self(sigma), self.slope)

    def moved(self, distance: float) -> Linear:
        return Linear(self.zero + distance * (0.6 + 0.8j), self.slope * math.exp(-1.5), self.log_scale + 1.5)

    def with_perturbed_start(self, seed: int, size: float, real: bool = False) -> Linear:
        return self.moved(self.signed if real else self.start)

    def real_at(self, sigma: complex) -> bool:
        return self.signed > 0.0

    def far_error(self, sigma: complex) -> float:
        return self.far

    def with_rotated_basis(self, seed: int) -> Linear:
        return self.moved(self.rotated[seed])

    def with_perturbed_system(self, seed: int, size: float) -> Linear:
        assert size == SYSTEM_PROBE
        return self.moved(self.entries.get(seed, 0.0))

    def gradient(self, sigma: complex) -> None:
        """None: nothing is known but its values."""

    def local_errors(self, sigma: complex) -> np.ndarray:
        return np.array(self.local)

    def partly_refined(self, digit: int, sigma: complex) -> Linear:
        towards = 0.5 * (ZERO - self.zero) if self.drawn is None else self.drawn[digit] * (0.6 + 0.8j)
        return Linear(self.zero + towards, self.slope, self.log_scale)

    def at_other_points(self, seed: int) -> Linear:
        return self.moved(self.elsewhere.get(seed, 0.0))

    def on_same_mesh(self, problem: Any) -> Linear:
        return self.moved(problem.move)


def of(problem: RoughFlow, coarse: Linear, fine: Linear, scale: float) -> Any:
    halves = replace(fine, local=tuple(np.repeat(0.5 * np.array(fine.local), 2)))
    meshed: Any = (coarse, coarse.with_derivative(SIGMA), halves, halves.with_derivative(SIGMA))
    return budget(problem, *meshed, scale)  # type: ignore[arg-type]


def test_every_part_is_what_the_variants_move_the_zero_by() -> None:
    coarse = Linear(ZERO + 3e-9, start=4e-9, rotated={1: 3e-13, 2: 4e-13})
    fine = Linear(ZERO)
    found = of(RoughFlow({4.0: 7e-10, 2.0: 5e-10}), coarse, fine, 0.25)
    assert found.integration == pytest.approx(3e-9 / HALVED, rel=CLOSE, abs=0.0)
    assert found.far_field == pytest.approx(SAFETY * 4e-9 / FAR_PROBE * 1e-5, rel=CLOSE, abs=0.0)
    assert found.steady_flow == pytest.approx(FLOW_NOISE * 7e-10, rel=CLOSE, abs=0.0)
    assert found.root == pytest.approx(SAFETY * 1e-12 / 0.25, rel=CLOSE, abs=0.0)


@pytest.mark.parametrize(
    ("left", "halving"),
    [(1e-9 / 1000, 255.0), (1e-9 / 60, 60.0), (1e-9 / 3, 15.0), (0.0, 15.0), (math.inf, 15.0)],
    ids=["whole order", "sixtieth", "third", "nothing", "no number"],
)
@pytest.mark.parametrize("drawn", [{0: 5e-9, 1: 0.0}, {0: 0.0, 1: 5e-9}], ids=["the first", "the second"])
def test_errors_of_steps_that_cancel_by_chance_are_seen_by_halving_half_of_them(
    left: float, halving: float, drawn: dict[int, float]
) -> None:
    """The coarse zero is off by 3e-12 only, but by ±5e-9 from steps of one half and the others; local errors say what is left of each."""
    coarse = Linear(ZERO + 3e-12, start=0.0, rotated={1: 3e-13, 2: 4e-13}, drawn=drawn)
    found = of(RoughFlow({4.0: 0.0, 2.0: 0.0}), coarse, Linear(ZERO, local=(left,)), 0.25)
    assert found.integration == pytest.approx(SAFETY * (2 * 5e-9) / halving, rel=1e-3, abs=0.0)


def test_what_is_left_of_most_steps_is_not_told_by_the_largest() -> None:
    """The errors of four steps fall by 200, 80, 60 and 40, and their sum by 191; one that counts for nothing does not fall."""
    errors, fallen = np.array([1e-9, 1.1e-11, 2e-11, 3e-11, 1e-12]), np.array([200.0, 80.0, 60.0, 40.0, 1.0])
    coarse = Linear(ZERO + 3e-12, rotated={1: 3e-13, 2: 4e-13}, drawn={0: 5e-9, 1: 0.0}, local=tuple(errors))
    found = of(RoughFlow({4.0: 0.0, 2.0: 0.0}), coarse, Linear(ZERO, local=tuple(errors / fallen)), 0.25)
    assert found.integration == pytest.approx(SAFETY * (2 * 5e-9) / 55.0, rel=1e-3, abs=0.0)


@pytest.mark.parametrize("digit", [0, 1])
def test_a_mesh_of_which_half_the_steps_serve_is_no_bound(digit: int) -> None:
    lost = Linear(ZERO + 3e-12, rotated={1: 3e-13, 2: 4e-13}, drawn={digit: math.nan, 1 - digit: 0.0})
    assert of(RoughFlow({4.0: 0.0, 2.0: 0.0}), lost, Linear(ZERO), 0.25).integration == math.inf


def test_the_bound_holds_where_the_errors_of_nine_steps_cancel(scenes: dict[str, Any]) -> None:
    """Steps of the mid flow err by up to 2e-9, and by 1e-11 together; the halved ones by 1e-12, beyond a fifteenth of that."""
    mid = scenes["mid"]
    truth = st.refine(mid, 0.00102, digits=16)
    mode = st.refine(mid, complex(truth.sigma), rtol=1e-4, method=st.Frame(rtol=1e-5))
    assert mode.converged
    assert abs(mode.sigma - complex(truth.sigma)) <= mode.error


def test_the_bound_holds_where_the_errors_of_seven_steps_cancel() -> None:
    """A scene drawn at random (validation/random_chutes.py, 194): its zero errs by 6e-9 on seven steps, and by 1.3e-9 on their halves."""
    grains = {
        "e": 0.78626,
        "e_w": 0.99557,
        "r": 0.89565,
        "tan_theta": 0.12273,
        "nu_max": 0.59972,
        "radial": "lun-savage",
        "wall": "isotropic",
    }
    problem = st.chute.problem(st.chute.steady(far_temperature=0.025221, **grains), kx=1.0916e-06, ky=0.0)
    truth = complex(st.refine(problem, -1.419, digits=18).sigma)
    for method in (st.Frame, st.Compound, st.Riccati):
        mode = st.refine(problem, truth, rtol=1e-4, method=method(rtol=1e-5))
        assert mode.converged
        assert abs(mode.sigma - truth) <= mode.error


def test_rounding_is_sampled_on_the_fine_mesh_where_it_matters() -> None:
    coarse = Linear(ZERO + 3e-9, rotated={1: 3e-9, 2: 4e-9}, elsewhere={1: 1e-9, 2: 2e-9})
    fine = Linear(ZERO, rotated={1: 1e-9, 2: 2e-9})
    found = of(RoughFlow({}), coarse, fine, 0.25)
    samples = (3e-9, 4e-9, 1e-9, 2e-9)
    rms = math.sqrt(sum(x * x for x in samples) / len(samples))
    assert found.rounding == pytest.approx(NOISE * rms + 8 * EPSILON * abs(SIGMA), rel=CLOSE, abs=0.0)
    assert found.steady_flow == 0.0
    assert found.far_field == 0.0
    rough = of(RoughFlow({}), Linear(ZERO, rotated={1: 0.0, 2: 0.0}, elsewhere={1: 3e-9, 2: 4e-9}), fine, 0.25)
    assert rough.rounding == pytest.approx(NOISE * math.sqrt(12.5) * 1e-9 + 8 * EPSILON * abs(SIGMA), rel=CLOSE, abs=0.0)
    quiet = of(RoughFlow({4.0: 0.0, 2.0: 0.0}), Linear(ZERO + 3e-9, rotated={1: 3e-13, 2: 4e-13}), fine, 0.25)
    rms = math.sqrt((3e-13**2 + 4e-13**2) / 2)
    assert quiet.rounding == pytest.approx(NOISE * rms + 8 * EPSILON * abs(SIGMA), rel=1e-3, abs=0.0)


def test_the_rounding_of_the_system_is_what_its_entries_move_the_zero_by() -> None:
    """Two draws of entries that are changed by the probe; of D alone, whose other variants do not move, nothing else is seen."""
    coarse = Linear(ZERO + 3e-9, rotated={1: 0.0, 2: 0.0}, entries={1: 3e-9, 2: 4e-9})
    found = of(RoughFlow({4.0: 0.0, 2.0: 0.0}), coarse, Linear(ZERO), 0.25)
    rms = math.sqrt((3e-9**2 + 4e-9**2) / 2)
    expected = SYSTEM_NOISE * EPSILON * rms / SYSTEM_PROBE + 8 * EPSILON * abs(SIGMA)
    assert found.rounding == pytest.approx(expected, rel=1e-3, abs=0.0)


def test_signs_of_a_real_start_are_believed_where_the_far_field_counts_for_nothing() -> None:
    """A sum of signs may be small by chance: what could matter is looked at with phases."""
    noise = {1: 3e-13, 2: 4e-13}
    for signed, taken in ((1e-9, 1e-9), (4e-7, 9e-7)):
        coarse = Linear(ZERO + 3e-8, start=9e-7, signed=signed, rotated=noise, far=1e-11)
        found = of(RoughFlow({4.0: 0.0, 2.0: 0.0}), coarse, Linear(ZERO), 0.25)
        assert found.far_field == pytest.approx(SAFETY * taken / FAR_PROBE * 1e-11, rel=1e-5, abs=0.0)


def test_farther_walls_and_the_total() -> None:
    coarse = Linear(ZERO + 3e-9, start=4e-9, rotated={1: 3e-13, 2: 4e-13})
    problem = RoughFlow({4.0: 0.0, 2.0: 1e-8}, farther_walls=RoughFlow({}, move=6e-9))
    found = of(problem, coarse, Linear(ZERO), 0.25)
    assert found.far_field == pytest.approx(SAFETY * 4e-9 / FAR_PROBE * 1e-5 + 6e-9, rel=CLOSE, abs=0.0)
    assert found.steady_flow == 0.0  # the first flow moves nothing against the integration: the second is not asked
    parts = (found.integration, found.far_field, found.steady_flow, found.root, found.rounding)
    assert all(part >= 0.0 for part in parts)
    assert found.total == pytest.approx(sum(parts), rel=1e-15, abs=0.0)


class Told(Linear):
    """With a gradient of its zero, of which steps come to what is given."""

    told: tuple[float, ...] = ()

    def gradient(self, sigma: complex) -> Any:
        shares = np.asarray(self.told, dtype=np.complex128)
        return SimpleNamespace(by_step=lambda _: shares, components=0.0, products=0.0)

    def ingredients(self, sigma: complex) -> Any:
        return SimpleNamespace(sampled=None)


@pytest.mark.parametrize(("told", "taken"), [((-3e-9, 0.0), True), ((-5e-9, 2.2e-9), True), ((-5e-9, 1e-9), False), ((math.nan,), False)])
def test_a_gradient_is_taken_where_its_steps_come_to_what_both_meshes_say(told: tuple[float, ...], taken: bool) -> None:
    coarse, fine = Told(ZERO + 3e-9), Told(ZERO, local=(5e-10, 5e-10))
    coarse.told = told
    values: Any = coarse, coarse.with_derivative(SIGMA), fine, fine.with_derivative(SIGMA)
    found = gradient_by_steps(*values)
    assert (found is not None) == taken
    if found is not None:
        assert integration_error(*values, found[1]) == pytest.approx(SAFETY / HALVED * max(abs(sum(told)), np.linalg.norm(told)), rel=1e-6)
