"""Layers and interfaces in equations: waves between two fluids, exactly; one fluid cut in two; what is refused."""

from __future__ import annotations

import tomllib
from typing import Any

import mpmath
import numpy as np
import pytest

import shootstab as st
from shootstab.core.errors import InputError
from shootstab.formulation.equation_scene import from_table

FLUIDS = """
unknowns = ["u", "w", "p"]
parameters = { k = 1.3, g = 1, rho = [1, 0.8], U = [0, 0.7] }
equations = ["(sigma + i*k*U)*u*rho + i*k*p = 0", "rho*(sigma + i*k*U)*w + d(p) = 0", "i*k*u + d(w) = 0"]
left = { at = -1, conditions = ["w"] }
right = { at = 2, conditions = ["w"] }
interfaces = [{ at = 0, amplitudes = ["h"], conditions = [
  "before(sigma + i*k*U)*h = before(w)", "behind(sigma + i*k*U)*h = behind(w)", "jump(p) = g*jump(rho)*h"] }]
"""


def exact_waves(k: float, rho: tuple[float, float], U: tuple[float, float], depths: tuple[float, float]) -> np.ndarray:
    """ρ₁ (σ + ikU₁)² coth kh₁ + ρ₂ (σ + ikU₂)² coth kh₂ = −gk (ρ₁ − ρ₂)."""
    weights = [r / np.tanh(k * h) for r, h in zip(rho, depths, strict=True)]
    shifts = [1j * k * u for u in U]
    return np.roots(
        sum(w * np.array([1, 2 * s, s * s]) for w, s in zip(weights, shifts, strict=True)) + np.array([0, 0, k * (rho[0] - rho[1])])
    )


def test_waves_between_two_fluids() -> None:
    problem = from_table(tomllib.loads(FLUIDS))
    assert problem.first_order.order == 2
    for root in exact_waves(1.3, (1, 0.8), (0, 0.7), (1, 2)):
        mode = st.refine(problem, guess=root * (1 + 1e-3))
        assert mode.converged
        assert abs(mode.sigma - root) <= mode.error < 1e-11
    told = dict(problem.explanation)
    assert told["continuous spectrum inside of layer 1"].startswith("sigma = 0")
    assert "before(" in told["interface, z = 0"]
    assert "behind(" in told["interface, z = 0"]


def test_kelvin_and_helmholtz_between_half_planes() -> None:
    """Equal densities, no gravity: σ = k(±1/2 − i/2) for U = 0 and 1; the decaying spaces are those of the two layers."""
    problem = st.equations(
        ["u", "w", "p"],
        ["(sigma + i*k*U)*u + i*k*p", "(sigma + i*k*U)*w + d(p)", "i*k*u + d(w)"],
        st.Infinity(),
        st.Infinity(),
        parameters={"k": 2, "U": [0, 1]},
        interfaces=[st.InterfaceConditions(0, ["behind(sigma + i*k*U)*before(w) - before(sigma + i*k*U)*behind(w)", "jump(p)"])],
    )
    mode = st.refine(problem, guess=1.01 - 0.99j)
    assert abs(mode.sigma - (1 - 1j)) <= mode.error < 1e-10


POISEUILLE: dict[str, Any] = {
    "unknowns": ["u", "v", "p"],
    "equations": [
        "(sigma + i*a*U)*u + v*d(U) + i*a*p = mu*(d(u,2) - a**2*u)/R",
        "(sigma + i*a*U)*v + d(p) = mu*(d(v,2) - a**2*v)/R",
        "i*a*u + d(v)",
    ],
    "left": st.Conditions(-1, ["u", "v"]),
    "right": st.Conditions(1, ["u", "v"]),
    "where": {"U": "1 - z**2"},
}
CONTINUITY = ["jump(u) + jump(d(U))*h", "jump(v)", "jump(mu*(d(u) + d(U,2)*h + i*a*v))", "jump(2*mu*d(v)/R - p) = gamma*a**2*h"]
KINEMATIC = "before(sigma + i*a*U)*h = before(v)"


def two_layers(gamma: float, mu: tuple[float, float] = (1, 1)) -> Any:
    joint = st.InterfaceConditions(0.3, [*CONTINUITY, KINEMATIC], ["h"])
    return st.equations(**POISEUILLE, interfaces=[joint], parameters={"R": 10000, "a": 1, "gamma": gamma, "mu": list(mu)})


def test_one_fluid_in_two_layers_has_its_own_modes_and_the_interface() -> None:
    """Without surface tension the interface is carried along, σ = −iaU, and changes nothing."""
    problem = two_layers(0.0)
    mode = st.refine(problem, guess=0.0037 - 0.2375j)
    assert abs(mode.sigma - (0.003739670622979410 - 0.23752648882047011j)) <= mode.error < 1e-11
    carried = st.refine(problem, guess=0.001 - 0.909j)
    assert abs(carried.sigma + 0.91j) <= carried.error + 1e-12


MISTAKES: tuple[tuple[dict[str, Any], str], ...] = (
    (
        {"conditions": [*CONTINUITY, "u"], "amplitudes": ["h"]},
        r"u stands without a side: allowed are before\(u\), behind\(u\) and jump\(u\)",
    ),
    (
        {"conditions": [*CONTINUITY[:3], KINEMATIC], "amplitudes": ["h"]},
        "4 conditions and 1 amplitudes at the interface 0.3: allowed are 4 conditions, .* one for",
    ),
    ({"conditions": [*CONTINUITY[1:2], KINEMATIC, "jump(v)", "before(v)"], "amplitudes": ["h", "g"]}, "holds the amplitude g"),
    (
        {"conditions": [*CONTINUITY, "jump(w)"], "amplitudes": ["h"]},
        "condition 5, column 6, at 'w': unknown name 'w': allowed are h, before",
    ),
    ({"conditions": ["jump(i*a*u + d(v))", "jump(u)", "jump(v)", "jump(p)"]}, "condition 1 says nothing"),
    ({"conditions": [*CONTINUITY, "d(h)"], "amplitudes": ["h"]}, "a derivative of the amplitude h, which is a number"),
    ({"conditions": [*CONTINUITY, KINEMATIC], "amplitudes": ["u"]}, "the amplitude 'u' is an unknown of the equations too"),
)


@pytest.mark.parametrize(("given", "told"), MISTAKES)
def test_what_was_wrong_is_named(given: dict[str, Any], told: str) -> None:
    parameters = {"R": 10000, "a": 1, "gamma": 0, "mu": 1}
    with pytest.raises(InputError, match=told):
        st.equations(**POISEUILLE, interfaces=[{"at": 0.3, **given}], parameters=parameters)


def test_lists_are_as_long_as_there_are_layers() -> None:
    with pytest.raises(InputError, match="the parameter mu is a list of 3: allowed is one for each of the 2 layers"):
        two_layers(0.0, (1, 1, 2))  # type: ignore[arg-type]
    with pytest.raises(InputError, match=r"ends and interfaces lie at z = -1, 1\.5, 1"):
        st.equations(**POISEUILLE, interfaces=[{"at": 1.5, "conditions": []}], parameters={"R": 1, "a": 1, "mu": 1})


def test_twenty_digits_in_two_layers() -> None:
    """The mode of plane Poiseuille flow, and waves on water that is cut in three: σ² stands in the condition at its surface."""
    mode = st.refine(two_layers(0.0), 0.0037 - 0.2375j, digits=16)
    with mpmath.workdps(30):
        assert abs(mode.sigma - mpmath.mpc("0.0037396706229794099322", "-0.23752648882047010745")) < 1e-16
        cuts = [st.InterfaceConditions(z, ["jump(f)", "jump(d(f)) = 0"]) for z in (-0.7, -0.2)]
        water = st.equations(["f"], ["d(f,2) - f"], st.Conditions(-1, ["d(f)"]), st.Conditions(0, ["sigma**2*f + d(f)"]), interfaces=cuts)
        assert abs(st.refine(water, 0.87j, digits=25).sigma - 1j * mpmath.sqrt(mpmath.tanh(1))) < 1e-24


def test_the_eigenfunction_in_layers() -> None:
    """w = sinh k(z + 1)/sinh k · (σ + ikU₁)h below and sinh k(2 − z)/sinh 2k · (σ + ikU₂)h above the interface, with p from continuity."""
    problem, k = from_table(tomllib.loads(FLUIDS)), 1.3
    shape = st.eigenfunction(problem, exact_waves(k, (1, 0.8), (0, 0.7), (1, 2))[0])
    sigma, z = shape.mode.sigma, np.array([-0.9, -0.4, -0.05, 0.05, 0.6, 1.7])
    found, below = shape(z), z < 0
    drift = np.where(below, sigma, sigma + 1j * k * 0.7)
    height = np.where(below, np.sinh(k * (z + 1)) / np.sinh(k), np.sinh(k * (2 - z)) / np.sinh(2 * k))
    slope = np.where(below, np.cosh(k * (z + 1)) / np.sinh(k), -np.cosh(k * (2 - z)) / np.sinh(2 * k))
    exact = {"w": drift * height, "p": -np.where(below, 1.0, 0.8) * drift**2 * slope / k}
    assert set(problem.unknowns.names) == set(exact)
    scale = found["w"][0] / exact["w"][0]
    for name, values in exact.items():
        assert np.abs(found[name] - scale * values).max() < 1e-9 * np.abs(scale * values).max()


def test_an_amplitude_that_two_conditions_multiply_by_the_eigenvalue() -> None:
    """y = A sinh kz and B sinh k(1 − z), σ = k²: A = 2B, and aσ = B sinh k/2, so that 3k³ = (k² + 1) tanh k/2."""
    joint = st.InterfaceConditions(0.5, ["before(y) - 2*behind(y)", "jump(y) + sigma*a", "jump(d(y)) + (sigma + 1)*a"], ["a"])
    cut = st.equations(["y"], ["d(y,2) - sigma*y"], st.Conditions(0, ["y"]), st.Conditions(1, ["y"]), interfaces=[joint])
    k = mpmath.findroot(lambda k: 3 * k**3 - (k**2 + 1) * mpmath.tanh(k / 2), 0.44)
    mode = st.refine(cut, float(k**2))
    assert abs(mode.sigma - float(k**2)) <= mode.error < 1e-13
