"""A problem falls into its subsystems, real where phases make it so, and D is what it was."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import pytest

from shootstab.core.errors import InputError
from shootstab.discriminants.compound import Compound
from shootstab.discriminants.frame import Frame
from shootstab.discriminants.meshing import made_for
from shootstab.discriminants.product import Product
from shootstab.discriminants.riccati import Riccati
from shootstab.discriminants.shooting import Shooting
from shootstab.discriminants.subsystems import decouple
from shootstab.models.chute import ChuteProblem, steady_flow
from shootstab.problems.protocol import FarFrame, Pencil

SIGMA = {"high": 0.0046, "mid": 0.0013 + 0.0002j, "low": 0.008 - 0.0112j, "fig2": 0.0015 - 0.0019j}


def test_the_chute_falls_apart_without_spanwise_wave_and_is_real_without_downslope_wave(scenes: dict[str, ChuteProblem]) -> None:
    for name in ("low", "fig2"):
        subsystems = decouple(scenes[name])
        assert subsystems is not None
        assert [(subsystem.size, subsystem.decaying) for subsystem in subsystems.members] == [(6, 3), (2, 1)]
    for name in ("high", "mid"):
        subsystems = decouple(scenes[name])
        assert subsystems is not None
        (subsystem,) = subsystems.members
        assert np.flatnonzero(subsystem.phases[0]).tolist() == [2, 6]
        pencil = subsystem.pencil(np.array([10.0, 3.0], complex))
        assert not any(M.imag.any() for M in (pencil.C0, pencil.C1, pencil.D0, pencil.D1))
    oblique = ChuteProblem(scenes["high"].flow, 0.003, 0.005)
    assert decouple(oblique) is None


def test_waves_on_one_flow_are_sampled_once_for_their_structure(scenes: dict[str, ChuteProblem], monkeypatch: pytest.MonkeyPatch) -> None:
    sampled = []
    pencil = ChuteProblem.pencil

    def counted(problem: ChuteProblem, z: Any) -> Pencil:
        sampled.append((problem.kx == 0.0, problem.ky == 0.0))
        return pencil(problem, z)

    monkeypatch.setattr(ChuteProblem, "pencil", counted)
    flow = steady_flow.descend(scenes["high"].flow.chute, 6.9)
    for k in (0.004, 0.007, 0.011):
        across, along, oblique = (ChuteProblem(flow, kx, ky) for kx, ky in ((0.0, k), (k, 0.0), (k / 10, k)))
        for problem, members in ((across, 1), (along, 2), (oblique, None)):
            found = decouple(problem)
            assert found is None if members is None else found is not None and len(found.members) == members
            assert found is None or all(subsystem.whole is problem for subsystem in found.members)
    assert sorted(sampled) == [(False, False), (False, True), (True, False)]
    other = ChuteProblem(steady_flow.descend(flow.chute, 6.8), 0.0, 0.01)
    assert decouple(other) is not None
    assert len(sampled) == 4


@pytest.mark.parametrize("name", list(SIGMA))
@pytest.mark.parametrize("method", [Frame(rtol=1e-11), Compound(rtol=1e-11), Riccati(rtol=1e-11)], ids=lambda m: m.name)
def test_D_of_the_parts_is_D_of_the_whole(scenes: dict[str, ChuteProblem], name: str, method) -> None:
    problem, sigma = scenes[name], SIGMA[name]
    whole, product = made_for(problem, method, None, sigma), method.on(problem)
    assert isinstance(product.at(sigma), Product)
    for s in (sigma, sigma * (1 + 0.3j)):
        a, b = product.with_derivative(s), whole.with_derivative(s)
        assert a.D.over(b.D) == pytest.approx(1.0, abs=1e-7)
        assert a.logarithmic_derivative == pytest.approx(b.logarithmic_derivative, rel=1e-7)
        assert product(s).over(a.D) == pytest.approx(1.0, abs=1e-9)


def test_real_sigma_is_carried_in_real_numbers(scenes: dict[str, ChuteProblem]) -> None:
    """k_x = 0: D is exactly real, and it is the limit of D from off the real axis."""
    shooting = Frame(rtol=1e-10).on(scenes["high"])
    real, beside = shooting.with_derivative(0.0046), shooting.with_derivative(0.0046 + 1e-12j)
    assert real.D.mantissa.imag == real.dD.imag == 0.0
    assert beside.D.over(real.D) == pytest.approx(1.0, abs=1e-8)
    assert beside.logarithmic_derivative == pytest.approx(real.logarithmic_derivative, rel=1e-8)


@dataclass(frozen=True, eq=False)
class Chains:
    """Two uncoupled systems of order 2 on [0, 1], y″ = −σ c y, shuffled; late couples them beyond z = 0.97."""

    late: bool = False
    size: int = 4
    decaying: int = 2
    order: tuple[int, ...] = (2, 0, 3, 1)

    def pencil(self, z: np.ndarray) -> Pencil:
        C0, C1, D0, D1 = (np.zeros((len(z), 4, 4), complex) for _ in range(4))
        C0[:] = np.eye(4)
        for first, c in ((0, 1.0), (2, 4.0)):
            D0[:, first, first + 1] = 1j
            D1[:, first + 1, first] = 1j * c
        if self.late:
            D0[:, 1, 2] = np.where(z.real > 0.97, 1.0, 0.0) * (z.real < 0.99)
        pick = np.array(self.order)
        return Pencil(*(M[:, pick[:, None], pick] for M in (C0, C1, D0, D1)))

    def start(self, sigma: complex, tolerance: float) -> float:
        return 0.0

    def far_frame(self, z: float, sigma: complex) -> FarFrame:
        frame = np.eye(4, dtype=complex)[:, [3, 1]][list(self.order)]  # the derivatives are free
        return FarFrame(frame, np.zeros_like(frame), 0.0, 0.0)

    def mesh(self, start: float) -> np.ndarray:
        return np.linspace(0.0, 1.0, 5)

    def wall_rows(self) -> tuple[np.ndarray, np.ndarray]:
        W0 = np.eye(4, dtype=complex)[[0, 2]][:, list(self.order)]
        return W0, np.zeros_like(W0)

    def with_base_flow_error(self, factor: float) -> Chains:
        return self


def test_parts_of_a_shuffled_problem_keep_the_sign_of_D() -> None:
    problem = Chains()
    product, whole = Frame(rtol=1e-11).on(problem), made_for(problem, Frame(rtol=1e-11), None, 3.0)
    subsystems = decouple(problem)
    assert subsystems is not None
    assert len(subsystems.members) == 2
    for sigma in (3.0, 2.0 + 1j):
        assert product(sigma).over(whole(sigma)) == pytest.approx(1.0, abs=1e-9)
    # y″ = −σ c y, y(0) = 0: zeros where √(σc) is a multiple of π
    for zero in (9 * np.pi**2 / 4, np.pi**2 / 4):
        assert abs(product.with_derivative(zero * (1 + 1e-6)).newton_step + 1e-6 * zero) < 1e-9 * zero


def test_a_coupling_that_the_samples_missed_is_refused() -> None:
    with pytest.raises(InputError, match="couples subsystems"):
        Frame().on(Chains(late=True))(3.0)


def test_a_discriminant_moves_to_a_neighbouring_problem_with_its_mesh(scenes: dict[str, ChuteProblem]) -> None:
    flow = scenes["high"].flow
    here = Frame(rtol=1e-10).on(scenes["high"])
    here(0.004)
    for kx, ky in ((0.0, 0.0103), (1e-4, 0.0103)):
        there = ChuteProblem(flow, kx, ky)
        moved, fresh = Frame(rtol=1e-10).on(there, begin=here.meshes), Frame(rtol=1e-10).on(there)
        for sigma in (0.004, 0.004 - 0.001j, 1e-6 - 1e-3j, 0.3 + 0.2j):
            assert moved(sigma).over(fresh(sigma)) == pytest.approx(1.0, abs=1e-8)
    # without spanwise wave it is in subsystems, with one it is not: these do not serve
    apart = Frame(rtol=1e-10).on(ChuteProblem(flow, 5e-4, 0.0))
    apart(0.002)
    oblique = ChuteProblem(flow, 5e-4, 0.002)
    moved = Frame(rtol=1e-10).on(oblique, begin=apart.meshes)
    assert isinstance(moved.at(0.002), Shooting)
    assert moved(0.002).over(Frame(rtol=1e-10).on(oblique)(0.002)) == pytest.approx(1.0, abs=1e-8)
