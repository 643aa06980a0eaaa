"""Three methods for one D(σ): frames, compound matrices, branches. They must agree on D, on its derivative and on its zeros."""

from __future__ import annotations

import itertools
import json
from dataclasses import dataclass, replace

import numpy as np
import pytest

import shootstab as st
from shootstab.analyses.refine_double import TIGHTEST, tightened
from shootstab.cli import main as cli
from shootstab.core.discriminant import Discriminant, Value
from shootstab.core.scaled import Scaled
from shootstab.discriminants.continuation import Continuation
from shootstab.discriminants.method import MeshedDiscriminant
from shootstab.models.chute import ChuteProblem
from shootstab.models.gallery.poiseuille import PlanePoiseuille
from shootstab.problems.protocol import Problem
from shootstab.roots.winding import wind

GRAINS = {"e": 0.8, "e_w": 0.8, "r": 0.6, "tan_theta": 0.3}
METHODS = (st.Frame(), st.Compound(), st.Riccati())
GUESS = {
    "high": 0.00397,
    "mid": 0.00102,
    "low": 0.00727 - 0.0119j,
    "fig2": 0.0017 - 0.0016j,
    "K=1e-6": 1.2e-9,
    "K=1": -0.1 - 0.6j,
    "T=0.03": 0.0075 + 0.0056j,
    "T=60": 0.0018,
    "poiseuille": -1j * (0.2375 + 0.0037j),
    "whole channel": -1j * (0.2375 + 0.0037j),
}
# Orszag's mode, re-computed to 20 digits (published.md)
POISEUILLE = -1j * (0.23752648882047010745 + 0.0037396706229794099322j)


@pytest.fixture(scope="module")
def problems(scenes: dict[str, ChuteProblem], flows) -> dict[str, Problem]:
    """The four scenes, the extremes of wavenumber and of flow, and plane Poiseuille flow."""
    extremes = {
        "K=1e-6": st.chute.problem(flows["high"], 0.0, 1e-6),
        "K=1": st.chute.problem(flows["high"], 0.6, 0.8),
        "T=0.03": st.chute.problem(st.chute.steady(far_temperature=0.03, **GRAINS), 0.01, 0.0),
        "T=60": st.chute.problem(st.chute.steady(far_temperature=60.0, **GRAINS), 0.0, 0.001),
    }
    return {**scenes, **extremes, "poiseuille": PlanePoiseuille(), "whole channel": PlanePoiseuille(half=False)}


@pytest.mark.parametrize("name", list(GUESS))
def test_the_methods_have_one_D(problems: dict[str, Problem], name: str) -> None:
    """D and dD/dσ, not up to a factor, at random σ around the mode."""
    discriminants = [replace(m, rtol=1e-10).on(problems[name]) for m in METHODS]
    rng = np.random.default_rng(29)
    # next to a zero only differences against D's values around it mean something: stay away from it
    for sigma in GUESS[name] * (1 + (0.2 + 0.3 * rng.random(4)) * np.exp(2j * np.pi * rng.random(4))):
        reference, *others = (d.with_derivative(sigma) for d in discriminants)
        for other in others:
            assert other.D.over(reference.D) == pytest.approx(1.0, abs=3e-8)
            assert other.logarithmic_derivative == pytest.approx(reference.logarithmic_derivative, rel=1e-7)


@pytest.mark.parametrize("distance", [1e-2, 1e-8, 0.0])
def test_the_methods_have_one_D_along_a_bent_path_too(scenes: dict[str, ChuteProblem], distance: float) -> None:
    """Next to the continuous spectrum, and on it, where the real axis leads nowhere."""
    problem = scenes["fig2"]
    sigma = complex(problem.continuum(np.array([15.0 + 0j]))[0]) * (1 + distance)
    branches = [Continuation(problem, method).at(sigma) for method in METHODS]
    reference, *others = (branch.discriminant.with_derivative(sigma) for branch in branches)
    for branch, other in zip(branches[1:], others, strict=True):
        assert branch.path != "real"
        assert other.D.over(reference.D) == pytest.approx(1.0, abs=1e-9)
        assert other.logarithmic_derivative == pytest.approx(reference.logarithmic_derivative, rel=1e-9)


@pytest.mark.parametrize("name", list(GUESS))
def test_the_methods_agree_on_zeros_within_their_error_bars(problems: dict[str, Problem], name: str) -> None:
    modes = [st.refine(problems[name], guess=GUESS[name], rtol=1e-10, method=m) for m in METHODS]
    for mode, method in zip(modes, METHODS, strict=True):
        assert mode.converged
        assert mode.method == method.name
        assert mode.budget.integration > 0.0
        assert mode.budget.rounding > 0.0
        assert mode.error < 1e-10 * abs(mode.sigma)
    for a, b in itertools.combinations(modes, 2):
        assert abs(a.sigma - b.sigma) <= a.error + b.error
    if isinstance(problems[name], PlanePoiseuille):
        for mode in modes:
            assert abs(mode.sigma - POISEUILLE) <= mode.error


@dataclass
class Ratio:
    """One D over another, as a discriminant."""

    upper: Discriminant
    lower: Discriminant
    evaluations: int = 0

    def __call__(self, sigma: complex) -> Scaled:
        return self.with_derivative(sigma).D

    def with_derivative(self, sigma: complex) -> Value:
        self.evaluations += 1
        a, b = self.upper.with_derivative(sigma), self.lower.with_derivative(sigma)
        ratio = a.D.mantissa / b.D.mantissa
        return Value(sigma, Scaled(ratio, a.D.log_scale - b.D.log_scale), (a.logarithmic_derivative - b.logarithmic_derivative) * ratio)


@pytest.mark.parametrize(("one", "other"), [(0, 1), (0, 2), (1, 2)])
@pytest.mark.parametrize("name", ["high", "low", "fig2", "poiseuille"])
def test_the_ratio_of_two_has_neither_zeros_nor_poles(problems: dict[str, Problem], name: str, one: int, other: int) -> None:
    """Over a region that holds a mode each D winds once, and their ratio not at all."""
    guess = GUESS[name]
    region = st.Rectangle(guess - (0.41 + 0.23j) * abs(guess), guess + (0.37 + 0.29j) * abs(guess))
    a, b = (replace(METHODS[i], rtol=1e-7).on(problems[name]) for i in (one, other))
    assert wind(a, region).count == wind(b, region).count == 1
    ratio = wind(Ratio(a, b), region)
    assert ratio.count == 0
    assert ratio.closure < 1e-3


@pytest.mark.parametrize("method", METHODS[1:], ids=lambda m: m.name)
@pytest.mark.parametrize("name", ["high", "low", "K=1e-6", "T=0.03", "poiseuille"])
def test_D_is_analytic_and_its_derivative_exact(problems: dict[str, Problem], name: str, method: st.Compound | st.Riccati) -> None:
    """Cauchy–Riemann by differences along both axes, against dD/dσ."""
    sigma = GUESS[name] * (1.2 + 0.1j)
    shooting = method.on(problems[name]).at(sigma)
    value, eps = shooting.with_derivative(sigma), 1e-4 * abs(sigma)
    for direction in (eps, 1j * eps):
        ahead, behind = shooting(sigma + direction), shooting(sigma - direction)
        derivative = (ahead.at_scale(value.D.log_scale) - behind.at_scale(value.D.log_scale)) / (2 * direction)
        assert derivative == pytest.approx(value.dD, rel=2e-6)


@pytest.mark.parametrize("method", METHODS, ids=lambda m: m.name)
def test_another_basis_rounds_otherwise_and_is_the_same(problems: dict[str, Problem], method: st.Compound | st.Riccati) -> None:
    """The samples of rounding: small, and no two alike where the first frame does not consist of zeros and ones."""
    for name in ("high", "poiseuille"):
        sigma = GUESS[name] * 1.1
        shooting: MeshedDiscriminant = method.on(problems[name]).at(sigma)
        value = shooting(sigma)
        ratios = [shooting.with_rotated_basis(seed)(sigma).over(value) - 1 for seed in (1, 2, 3)]
        assert all(abs(r) < 1e-10 for r in ratios)
        assert name == "poiseuille" or len({*ratios, 0.0}) == 4
        assert method.name == "riccati" or (name == "high") == all(complex(r).imag == 0.0 for r in ratios)  # real rounding of a real system


@pytest.mark.parametrize("method", METHODS, ids=lambda m: m.name)
def test_ten_digits_of_a_sigma_of_order_1e_9(problems: dict[str, Problem], method: st.Compound | st.Riccati) -> None:
    """K = 1e−6 grades the rows of the state over eight orders, and products of them over more."""
    assert st.refine(problems["K=1e-6"], 1.2e-9, method=method).sigma.real == pytest.approx(1.20928535802e-9, rel=1e-11)


@pytest.mark.parametrize("method", METHODS, ids=lambda m: m.name)
def test_a_method_too_loose_is_tightened(problems: dict[str, Problem], method: st.Compound | st.Riccati) -> None:
    mode = st.refine(problems["fig2"], GUESS["fig2"], rtol=1e-10, method=replace(method, rtol=1e-6))
    assert mode.converged
    assert mode.method == method.name


def test_tightening() -> None:
    assert tightened(st.Compound(rtol=1e-8)) == st.Compound(rtol=1e-10)
    assert tightened(st.Riccati(rtol=2e-13)) == st.Riccati(rtol=TIGHTEST)
    assert tightened(st.Frame(rtol=TIGHTEST)) is None


@pytest.mark.parametrize("method", ["frame", "compound", "riccati"])
def test_the_command_line_knows_them(method: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.main(["refine", "poiseuille", "--guess=0.0037,-0.2375", "--digits=9", "--method", method, "--json", "-"]) == 0
    answer = json.loads(capsys.readouterr().out)
    assert answer["method"] == method
    assert answer["digits"] > 9
    assert abs(complex(float(answer["sigma"]["re"]), float(answer["sigma"]["im"])) - POISEUILLE) <= answer["error"]
