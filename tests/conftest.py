"""The scenes of the paper, solved once for all tests."""

from __future__ import annotations

import os

os.environ.setdefault("OMP_NUM_THREADS", "1")  # the matrices are small: threads only cost

import pytest

from shootstab.models import chute
from shootstab.models.chute import ChuteProblem, Flow

GRAINS = {"e": 0.8, "e_w": 0.8, "r": 0.6, "tan_theta": 0.3}
WAVES = {"high": ("high", 0.0, 0.01), "mid": ("mid", 0.0, 0.0125), "low": ("low", 0.011, 0.0), "fig2": ("high", 5e-4, 0.0)}


@pytest.fixture(scope="session")
def flows() -> dict[str, Flow]:
    """The three flows at Q0 = 3."""
    return {branch: chute.steady(mass_flux=3.0, branch=branch, **GRAINS) for branch in ("high", "mid", "low")}


@pytest.fixture(scope="session")
def scenes(flows: dict[str, Flow]) -> dict[str, ChuteProblem]:
    """high, mid, low and fig2."""
    return {name: chute.problem(flows[branch], kx, ky) for name, (branch, kx, ky) in WAVES.items()}


@pytest.fixture(scope="session")
def slow_wave() -> ChuteProblem:
    """k_x = 1e−7: the continuous spectrum hugs the real axis, and D has nearly the same value on both sides of it."""
    flow = chute.steady(
        far_temperature=8.259092290598987,
        e=0.7981727536605799,
        e_w=0.9794039787584508,
        r=0.7006985193967026,
        tan_theta=0.21277605159925433,
        nu_max=0.56407003093951,
        radial="carnahan-starling",
    )
    return chute.problem(flow, kx=1.0785622190010972e-07, ky=0.0006610754896898808)
