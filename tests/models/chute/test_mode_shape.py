"""The local mass flux of a mode, and the paper's three kinds of instability by the stated rule (section 3.2)."""

from __future__ import annotations

import numpy as np
import pytest

import shootstab as st
from shootstab.analyses.eigenfunction import eigenfunction
from shootstab.models.chute import ChuteProblem
from shootstab.models.chute.mode_shape import CLUSTERING, VORTEX_FORMING, ModeShape

KINDS = {"high": (0.00397, CLUSTERING), "mid": (0.0010229, VORTEX_FORMING), "low": (0.00727558 - 0.01186505j, CLUSTERING)}


@pytest.mark.parametrize("name", KINDS)
def test_the_kinds_of_the_papers_three_modes_and_conservation_of_mass(scenes: dict[str, ChuteProblem], name: str) -> None:
    """σ ν̂ + ∇·Q1 = 0 at every height, with dQ_z/dz by differences."""
    problem, (guess, kind) = scenes[name], KINDS[name]
    found = eigenfunction(problem, guess)
    assert found.kind == kind
    z, h = np.linspace(0.5, 30.0, 20), 1e-3
    flux = found.fields(z)
    slope = (found.fields(z + h)["Qz"] - found.fields(z - h)["Qz"]) / (2 * h)
    growth = found.mode.sigma * found(z)["nu"]
    terms = [growth, 1j * problem.kx * flux["Qx"], 1j * problem.ky * flux["Qy"], slope]
    assert np.abs(sum(terms)).max() < 1e-6 * sum(np.abs(t).max() for t in terms)


def test_the_slip_claim_of_the_paper(scenes: dict[str, ChuteProblem]) -> None:
    """3.2: vortices form because of a small cross-slope slip at the base that the most unstable mode of the high flow has not."""
    slip = {}
    for name in ("high", "mid"):
        found = eigenfunction(scenes[name], KINDS[name][0])
        v = found(np.linspace(0.0, 60.0, 241))["v"]
        slip[name] = (v[0] / v[np.abs(v).argmax()]).real
    assert slip["mid"] < 0 < slip["high"] or abs(slip["high"]) < 0.1 * abs(slip["mid"])


def test_a_vortex_is_found_where_one_is_and_none_where_none_is(scenes: dict[str, ChuteProblem]) -> None:
    """Rolls v = cos, w = sin of one cell turn around its middle; a flux that converges at every height does not."""
    shape = ModeShape(scenes["mid"].flow, 0.0, 0.5)
    z = np.linspace(0.0, 4.0, 401)
    nu0 = np.exp(shape.flow.states_at(z)[:, 0].real)
    nothing = np.zeros_like(z, dtype=complex)
    rolls = {"nu": nothing, "u": nothing, "v": 1j * np.cos(np.pi * z / 4) * np.pi / 2 / nu0, "w": np.sin(np.pi * z / 4) / nu0 + 0j}
    assert shape.vortices(z, rolls) == pytest.approx((2.0,), abs=1e-3)
    assert shape.kind(z, rolls) == VORTEX_FORMING
    inwards = {**rolls, "v": 1j * (1.5 + np.cos(np.pi * z / 4)) / nu0}
    assert shape.vortices(z, inwards) == ()
    assert shape.kind(z, inwards) == CLUSTERING


def test_the_eigenfunction_of_a_scene_by_name() -> None:
    found = st.eigenfunction("mid", 0.00102)
    assert found.names == ("nu", "u", "v", "w", "T")
    assert set(found.fields(1.0)) == {"Qx", "Qy", "Qz"}


def test_sensitivities_by_name_are_the_differences_of_modes(scenes: dict[str, ChuteProblem]) -> None:
    """∂σ/∂ν_m at fixed mass flux, and ∂σ/∂k_x, against central differences of refined modes of the family."""
    problem, guess = scenes["low"], KINDS["low"][0]
    found = eigenfunction(problem, guess)
    for slope in st.sensitivities(found, ["nu_max", "kx"]):
        family, h = problem.family((slope.parameter,)), 1e-4 * slope.value
        ahead, behind = (st.refine(family.problem({slope.parameter: slope.value + d}), guess, rtol=1e-12).sigma for d in (h, -h))
        assert slope.derivative == pytest.approx((ahead - behind) / (2 * h), rel=1e-5)
    with pytest.raises(st.InputError, match="cannot be swept"):
        st.sensitivities(found, ["colour"])
    with pytest.raises(st.InputError, match="belongs to no family"):
        st.sensitivities(st.eigenfunction("benard", 3.4), ["rayleigh"])


def test_a_mode_of_the_velocity_across_the_plane_of_the_wave_is_of_neither_kind() -> None:
    """At k_y = 0 v̂ alone carries no mass in the plane of k and z."""
    problem = st.scene("low").problem
    zero = np.zeros(2, dtype=complex)
    shape = ModeShape(problem.flow, problem.kx, problem.ky)
    assert shape.kind(np.array([0.0, 1.0]), {"nu": zero, "u": zero, "v": zero + 1.0, "w": zero, "T": zero}) == ""
