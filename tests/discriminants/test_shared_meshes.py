"""discriminants/shared_meshes: a mesh serves what it serves, whoever it was made for."""

from __future__ import annotations

import numpy as np
import pytest

import shootstab as st
from shootstab.discriminants import shared_meshes
from shootstab.discriminants.frame import Frame
from shootstab.discriminants.shared_meshes import SHORT_MESH, NeighbouringD, SharedMeshes
from shootstab.models.chute import ChuteProblem


def test_points_of_a_contour_share_few_meshes_and_D_is_the_same(scenes: dict[str, ChuteProblem]) -> None:
    D, shared = Frame(rtol=1e-6).on(scenes["high"]), SharedMeshes()
    sigmas = (0.05 * np.exp(1j * np.linspace(-1.4, 1.4, 30))).tolist()
    made = [shared.at(D, sigma) for sigma in sigmas]
    assert len({id(m) for m in made}) <= 3
    for sigma, m in zip(sigmas, made, strict=True):
        assert m.serves(sigma)
        own = D.at(sigma).with_derivative(sigma)
        assert m.with_derivative(sigma).D.over(own.D) == pytest.approx(1.0, abs=1e-4)


def test_a_long_mesh_serves_only_sigma_of_its_size(scenes: dict[str, ChuteProblem]) -> None:
    D, shared = Frame(rtol=1e-9).on(scenes["high"]), SharedMeshes()
    large = shared.at(D, 50.0)
    assert large.steps > SHORT_MESH
    assert shared.at(D, 40.0) is large
    assert shared.at(D, 0.5).steps < large.steps


def test_a_mesh_that_refused_what_is_next_to_sigma_is_not_asked(scenes: dict[str, ChuteProblem]) -> None:
    """The far frame of small σ begins farther out: a mesh of large σ refuses the first one of them, and is not asked about the others."""
    D, shared = Frame(rtol=1e-5).on(st.chute.problem(scenes["high"].flow, kx=5e-4, ky=0.012)), SharedMeshes()
    large, small = shared.at(D, 0.002 - 0.64j), shared.at(D, 0.002 - 0.0044j)
    assert large is not small and not large.serves(0.002 - 0.005j)
    spent = large.evaluations
    for y in np.linspace(0.0045, 0.007, 6).tolist():
        assert shared.at(D, complex(0.002, -y)) is small
    assert large.evaluations == spent
    assert shared.at(D, 0.002 - 0.6j) is large


def test_a_neighbour_lends_its_mesh_and_the_mode_is_its_own(scenes: dict[str, ChuteProblem]) -> None:
    flow = scenes["high"].flow
    one = NeighbouringD(st.chute.problem(flow, kx=5e-4, ky=0.0100), Frame(rtol=1e-9), None)
    mode = st.refine(st.chute.problem(flow, kx=5e-4, ky=0.0101), 0.00394 - 0.0029j, rtol=1e-10)
    sigma = complex(mode.sigma)
    lent = one.at(sigma)
    other = NeighbouringD(st.chute.problem(flow, kx=5e-4, ky=0.0101), Frame(rtol=1e-9), one)
    assert np.array_equal(other.at(sigma).sampled.nodes, lent.sampled.nodes)  # type: ignore[attr-defined]
    assert abs(other.with_derivative(sigma).newton_step) < 1e-7 * abs(sigma)
    assert other.begun == one.begun


def test_a_neighbour_of_another_structure_has_meshes_of_its_own(scenes: dict[str, ChuteProblem]) -> None:
    """At k_y = 0 v separates, and a mesh of the parts serves no whole; the other way round the whole is integrated."""
    flow = scenes["high"].flow
    apart = NeighbouringD(st.chute.problem(flow, kx=5e-4, ky=0.0), Frame(rtol=1e-9), None)
    sigma = 0.002 - 0.003j
    assert "6 + 2" in apart.at(sigma).system_at(sigma)
    joined = NeighbouringD(st.chute.problem(flow, kx=5e-4, ky=1e-3), Frame(rtol=1e-9), apart)
    assert joined.at(sigma).system_at(sigma) == "order 8 in complex numbers"
    again = NeighbouringD(st.chute.problem(flow, kx=5e-4, ky=0.0), Frame(rtol=1e-9), joined)
    own = Frame(rtol=1e-9).on(st.chute.problem(flow, kx=5e-4, ky=0.0)).with_derivative(sigma)
    assert again.with_derivative(sigma).newton_step == pytest.approx(own.newton_step, rel=1e-6)


def test_a_contour_begins_with_the_meshes_of_its_neighbours(scenes: dict[str, ChuteProblem], monkeypatch: pytest.MonkeyPatch) -> None:
    """Where they serve no mesh is made, and D is the neighbour's own; where v separates, or the far frame asks for more, one is."""
    flow, method = scenes["high"].flow, Frame(rtol=1e-5)
    one, two, apart = (method.on(st.chute.problem(flow, kx=5e-4, ky=ky)) for ky in (0.012, 0.014, 0.0))
    sigmas = [complex(0.3 * np.exp(1j * angle)) for angle in np.linspace(-1.5, 1.5, 12)]
    before = SharedMeshes()
    for sigma in sigmas:
        before.at(one, sigma)
    meshes = SharedMeshes(lent=before.of(one), to=two)
    for sigma in sigmas:
        made = meshes.at(two, sigma)
        assert made.serves(sigma)
        own = method.on(two.problem).with_derivative(sigma)
        assert made.with_derivative(sigma).D.over(own.D) == pytest.approx(1.0, abs=1e-3)
    assert two.evaluations == 0  # on meshes of its own
    assert len(meshes.of(two)) == len(before.of(one))
    monkeypatch.setattr(shared_meshes, "MOST_LENT", before.of(one)[0].made.steps)
    assert len(before.of(one)) == 1  # the latest
    other = SharedMeshes(lent=before.of(one), to=apart)
    assert "6 + 2" in other.at(apart, sigmas[0]).system_at(sigmas[0])
    assert apart.evaluations > 0
