"""Solitons as systems in equations: how often 0 is an eigenvalue is known, and so is the essential spectrum."""

from __future__ import annotations

import math

import pytest

import shootstab as st
from shootstab.by_name import problem_of

LINE = st.Infinity(), st.Infinity()


def test_a_soliton_of_the_cubic_schroedinger_equation() -> None:
    """i u_t + u_xx + 2|u|² u = 0 about e^{it} sech x, in real and imaginary part: 0 fourfold by its symmetries, for translation and phase
    with a generalized mode each; σ = ±i(1 + q²).
    """
    soliton = st.equations(
        ["u", "v"], ["sigma*u = -d(v,2) + v - 2*sech(x)**2*v", "sigma*v = d(u,2) - u + 6*sech(x)**2*u"], *LINE, variable="x"
    )
    assert st.count(soliton, st.Disc(0.0, 0.3)) == 4
    relation = dict(soliton.explanation)["essential spectrum, +infinity"]
    assert relation == "the zeros in sigma of q**4 + 2*q**2 + 1 + sigma**2, q real"


@pytest.mark.parametrize("a", [0.4, 0.7])
def test_the_soliton_of_korteweg_and_de_vries_in_a_weighted_space(a: float) -> None:
    """u_t + 6 u u_x + u_xxx = 0 about 2 sech²(x − 4t), perturbations e^{−ax} w with 0 < a < (4/3)^{1/2}: 0 twofold, away from the essential
    spectrum. R. L. Pego & M. I. Weinstein, Commun. Math. Phys. 164 (1994) 305.
    """
    soliton = st.equations(
        ["w"],
        ["sigma*w = 4*D1 - D3 - 12*(V*D1 + d(V)*w)"],
        *LINE,
        variable="x",
        parameters={"a": a},
        where={"V": "sech(x)**2", "D1": "d(w) - a*w", "D3": "d(w,3) - 3*a*d(w,2) + 3*a**2*d(w) - a**3*w"},
    )
    assert soliton.first_order.order == 3
    assert st.count(soliton, st.Disc(0.0, 0.3)) == 2


@pytest.mark.parametrize("k", [0.3, 0.5])
def test_the_soliton_of_korteweg_and_de_vries_is_unstable_along_its_crest(k: float) -> None:
    """σ = k (1 − k)^{1/2}: the τ-function e^{x + y} + e^{y − x} of Kadomtsev and Petviashvili, changed by e^{qx + q²y}, q² = 1 − k."""
    growth = k * math.sqrt(1.0 - k)
    mode = st.refine(problem_of("kdv-soliton").with_parameters({"k": k}), 1.02 * growth)
    assert abs(mode.sigma - growth) <= mode.error < 1e-9


def test_a_mode_behind_a_gap_of_the_essential_spectrum() -> None:
    """σ = −2γ lies left of the line Re σ = −γ, on which the essential spectrum leaves a gap around the real axis: a straight line leads
    there. With c and γ as in the scene, L u = −(σ + 2γ) v and (L + 4S² − 2c) v = σ u with L S′ = 0.
    """
    mode = st.refine(problem_of("nls-soliton"), -0.61)
    assert abs(mode.sigma + 0.6) <= mode.error < 1e-9
