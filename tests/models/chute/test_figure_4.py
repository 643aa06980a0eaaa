"""The paper's figure 4, as far as its text states it (3.1, 3.2), and the eigenvectors of the conservative form on Chebyshev points.

The figure itself is at hand as a caption only: compared is what the text says of it, in numbers.
"""

from __future__ import annotations

import math

import numpy as np
import pytest
import scipy.linalg

from shootstab.analyses.eigenfunction import eigenfunction
from shootstab.analyses.eigenfunction_double import Eigenfunction
from shootstab.models.chute import ChuteProblem, chute_collocation
from shootstab.spectral import chebyshev

GUESSES = {"high": 0.00397, "mid": 0.0010229, "low": 0.00727558 - 0.01186505j}
TRUNCATIONS = {"high": 70, "mid": 80, "low": 90}


@pytest.fixture(scope="module")
def shapes(scenes: dict[str, ChuteProblem]) -> dict[str, Eigenfunction]:
    return {name: eigenfunction(scenes[name], guess) for name, guess in GUESSES.items()}


@pytest.mark.parametrize("name", GUESSES)
def test_the_vectors_of_the_pseudospectral_reference_are_the_eigenfunctions(shapes: dict[str, Eigenfunction], name: str) -> None:
    """Inverse iteration on the reference's matrices; the two share constitutive functions and flow, and no entry."""
    found = shapes[name]
    problem, flow = found.problem, found.problem.flow  # type: ignore[attr-defined]
    kx, ky, M = problem.kx, problem.ky, TRUNCATIONS[name]  # type: ignore[attr-defined]
    grid = chebyshev.malik(M, *chute_collocation.window(flow, kx, ky, None, None, None))
    A, B = chute_collocation.assemble(flow, kx, ky, M)
    factors = scipy.linalg.lu_factor(A - (complex(found.mode.sigma) + 1e-9) * B)
    vector = np.ones(len(A), dtype=complex)
    for _ in range(4):
        vector = scipy.linalg.lu_solve(factors, B @ vector)
        vector /= vector[np.abs(vector).argmax()]
    n, u, v, w, T = vector.reshape(5, M + 1)
    reference = {"nu": n * np.exp(flow.states_at(grid.z)[:, 0].real), "u": u, "v": chute_collocation.PHASE * v, "w": w, "T": T}
    own = found(grid.z)
    factor = np.vdot(T, own["T"]) / np.vdot(T, T)
    for field, values in own.items():
        assert np.abs(values - factor * reference[field]).max() <= 1e-9 * max(np.abs(values).max(), 1e-9), field


@pytest.mark.parametrize("name", GUESSES)
def test_the_volume_fraction_is_localized_and_the_other_fields_decay_with_the_wave(shapes: dict[str, Eigenfunction], name: str) -> None:
    """3.1: ν̂ lies at the base and decays as ν0 does, at a rate near 1/T_∞; T̂ decays at the rate of the wavenumber, which is lower."""
    found = shapes[name]
    problem = found.problem
    wavenumber = math.hypot(problem.kx, problem.ky)  # type: ignore[attr-defined]
    rate = 1.0 / problem.flow.far_temperature  # type: ignore[attr-defined]
    z = np.linspace(0.0, 60.0, 601)
    at = found(z)
    assert z[np.abs(at["nu"]).argmax()] < 5.0
    height = 10.0 + 8.0 / rate  # above the dense layer, where ν̂ falls as ν0 does but for a factor that is linear in z
    far = found(np.array([height, height + 1.0]))
    decay = {field: -math.log(abs(values[1] / values[0])) for field, values in far.items() if values.any()}
    assert decay["nu"] == pytest.approx(rate, rel=0.35)
    assert decay["T"] == pytest.approx(wavenumber, rel=0.05)
    assert decay["T"] < 0.2 * decay["nu"]


def test_the_low_flow_has_no_velocity_across_and_the_others_one_that_is_out_of_phase(shapes: dict[str, Eigenfunction]) -> None:
    """3.1 and 3.2: v̂ = 0 for the low flow; for the others û, ŵ, T̂ and ν̂ are in phase, v̂ by π/2 out of it, and Im σ = 0."""
    z = np.linspace(0.0, 60.0, 241)
    assert not shapes["low"](z)["v"].any()
    for name in ("high", "mid"):
        at = shapes[name](z)
        assert shapes[name].mode.sigma.imag == 0.0
        assert np.abs(at["v"].real).max() <= 1e-12 * np.abs(at["v"]).max()
        for field in ("nu", "u", "w", "T"):
            assert np.abs(at[field].imag).max() <= 1e-12 * np.abs(at[field]).max()


@pytest.mark.parametrize("name", ["high", "mid"])
def test_temperature_and_velocity_are_largest_where_it_is_dilute(shapes: dict[str, Eigenfunction], name: str) -> None:
    """3.2: where ν̂ < 0, T̂, û and ŵ are largest: at their peaks their signs are opposite to that of ν̂ at its own."""
    z = np.linspace(0.0, 60.0, 601)
    at = shapes[name](z)
    peaks = {field: at[field].real[np.abs(at[field]).argmax()] for field in ("nu", "u", "w", "T")}
    assert peaks["nu"] < 0.0 < min(peaks["u"], peaks["w"], peaks["T"])


def test_the_slip_across_that_makes_vortices_is_that_of_the_mid_flow(shapes: dict[str, Eigenfunction]) -> None:
    """3.2: "a small cross-slope slip velocity at the base boundary that is not present" for the high flow.

    v̂ at the base over its largest value is −0.138 for the mid flow, of the sign opposite to the flow above it, which a vortex needs. For
    the high flow it is +0.040, small and of one sign with the flow above: no return flow, though not no slip.
    """
    z = np.linspace(0.0, 60.0, 601)
    slip = {}
    for name in ("high", "mid"):
        v = shapes[name](z)["v"]
        slip[name] = (v[0] / v[np.abs(v).argmax()]).real
    assert slip["mid"] == pytest.approx(-0.1376, abs=2e-3)
    assert abs(slip["high"]) < 0.3 * abs(slip["mid"])
    assert slip["high"] > 0.0
