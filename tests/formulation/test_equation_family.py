"""Sweeps and critical points over the parameters of equations, against Rayleigh's exact solution between free walls."""

from __future__ import annotations

import json
import math
import pickle
from pathlib import Path

import pytest
from equations import FREE

import shootstab as st
from shootstab.cli.main import main
from shootstab.core.errors import InputError


def exact(Ra: float, a: float = 2.5, Pr: float = 0.71) -> float:
    """(σ/Pr + k²)(σ + k²) k² = Ra a², k² = π² + a²."""
    k2 = math.pi**2 + a * a
    half = 0.5 * k2 * (1 + Pr)
    return -half + math.sqrt(half**2 - Pr * (k2 * k2 - Ra * a * a / k2))


@pytest.fixture
def scene(tmp_path: Path) -> str:
    path = tmp_path / "free.toml"
    path.write_text(FREE)
    return str(path)


def test_a_sweep_over_a_parameter(scene: str) -> None:
    found = st.sweep(st.scene(scene).problem, {"Ra": [600.0, 700.0, 900.0]})
    outcomes = [outcome for _, outcome in found.rows()]
    assert [outcome.status for outcome in outcomes] == ["no growing mode", "proved", "proved"] or outcomes[0].sigma is None
    for Ra, outcome in zip((700.0, 900.0), outcomes[1:], strict=True):
        assert abs(outcome.sigma - exact(Ra)) <= outcome.error < 1e-8


def test_the_critical_point(scene: str, capsys: pytest.CaptureFixture[str]) -> None:
    """Rayleigh: Ra = 27π⁴/4 at a = π/√2."""
    assert main(["critical", scene, "--parameter", "Ra=640", "--over", "a=2.3", "--guess=0.0", "--json", "-"]) == 0
    found = json.loads(capsys.readouterr().out)["critical"]
    assert abs(float(found["Ra"]) - 27 * math.pi**4 / 4) <= found["errors"]["Ra"] + 1e-9
    assert abs(float(found["a"]) - math.pi / math.sqrt(2)) <= 1e-7


def test_a_family_goes_to_other_processes(scene: str) -> None:
    family = st.scene(scene).problem.family(("Ra",))
    again = pickle.loads(pickle.dumps(family))
    assert again.as_dict() == family.as_dict()
    assert json.dumps(family.as_dict())
    assert again.problem({"Ra": 700.0}).size == 6


def test_what_cannot_be_varied_is_named(scene: str, capsys: pytest.CaptureFixture[str]) -> None:
    problem = st.scene(scene).problem
    with pytest.raises(InputError, match="R: cannot be swept: allowed is one of the parameters a, Pr, Ra"):
        st.sweep(problem, {"R": [1.0]})
    with pytest.raises(InputError, match="R is no parameter of the equations: allowed is a, Pr, Ra"):
        problem.with_parameters({"R": 1.0})
    assert main(["critical", scene, "--parameter", "Ra=640", "--over", "Ra=2.3", "--guess", "0"]) == 2
    assert main(["critical", "high", "--parameter", "kx=1", "--over", "ky=2.3", "--guess", "0"]) == 2
    assert "this problem has no parameters by name" in capsys.readouterr().err


def test_the_derivatives_of_a_mode_by_parameters_of_the_equations() -> None:
    """y″ + kpy = σy between walls: σ = kp − π², so that ∂σ/∂k = p and ∂σ/∂p = k."""
    ends = st.Conditions(0, ["y"]), st.Conditions(1, ["y"])
    problem = st.equations(["y"], ["d(y,2) + k*p*y = sigma*y"], *ends, parameters={"k": 2.0, "p": 0.75})
    for slope, value, exact in zip(st.sensitivities(st.eigenfunction(problem, -8.4), ["k", "p"]), (2.0, 0.75), (0.75, 2.0), strict=True):
        assert slope.value == value
        assert abs(slope.derivative - exact) <= slope.error + 1e-9


def test_a_sweep_of_a_jet_on_the_whole_line() -> None:
    """The sech² jet: D follows no law of growth that is found, and a theorem says where growing modes lie."""
    stated = [
        "sigma*u + i*a*U*u + v*d(U) + i*a*p = (d(u,2) - a**2*u)/R",
        "sigma*v + i*a*U*v + d(p) = (d(v,2) - a**2*v)/R",
        "i*a*u + d(v) = 0",
    ]
    ends = st.Infinity(), st.Infinity()
    jet = st.equations(["u", "v", "p"], stated, *ends, parameters={"a": 0.8, "R": 50}, where={"U": "sech(z)**2"})
    outcomes = [outcome for _, outcome in st.sweep(jet, {"a": [0.6, 0.8, 1.0]}).rows()]
    assert [outcome.status for outcome in outcomes] == ["proved", "followed", "proved"]
    middle = st.refine(jet, outcomes[1].sigma + 1e-4)
    assert abs(middle.sigma - outcomes[1].sigma) <= middle.error + outcomes[1].error
    assert st.count_unstable(jet).count == 1
