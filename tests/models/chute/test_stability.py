"""models/chute/stability.py: one growing mode refutes, counts support, and what could not be counted is said."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import pytest

from shootstab.core.errors import ConvergenceError
from shootstab.models import chute
from shootstab.models.chute import stability as module
from shootstab.models.chute.stability import STABLE, UNSTABLE, stability, waves

GRAINS = {"e": 0.8, "e_w": 0.8, "r": 0.6}


def said(found: module.Stability) -> tuple[Any, ...]:
    """All but how long it took."""
    return found.verdict, None if found.mode is None else found.mode.sigma, found.wave, found.place, found.counted


def test_flows_of_figure_8() -> None:
    """At tanθ = 0.3 the mid flow with T_∞ = 1.5 is stable (here: at six waves), the hot one with T_∞ = 7 is not."""
    hot = chute.steady(far_temperature=7.0, tan_theta=0.3, **GRAINS)
    found = stability(hot)
    assert found.verdict == UNSTABLE
    assert found.mode is not None and found.wave is not None
    assert found.mode.converged
    assert found.mode.sigma.real > 1e-3
    mid = chute.steady(far_temperature=1.5, tan_theta=0.3, **GRAINS)
    few = [line[3:7:2] for line in waves(mid)]
    assert stability(mid, few) == module.Stability(STABLE, counted=6)


def test_a_neighbour_tells_where_to_begin_and_not_what_is_said(monkeypatch: pytest.MonkeyPatch) -> None:
    """A mode is followed from flow to flow without another spectrum; beside a stable flow counts come first, and refute too."""
    hot, next_hot = (chute.steady(far_temperature=T, tan_theta=0.3, **GRAINS) for T in (7.0, 7.8))
    mid, low = (chute.steady(far_temperature=T, tan_theta=0.3, **GRAINS) for T in (1.5, 0.5))
    few = {flow: [line[3:7:2] for line in waves(flow)] for flow in (hot, next_hot, mid, low)}
    grows, alone = (stability(flow, few[flow]) for flow in (hot, next_hot))
    assert grows.place is not None and grows.wave == few[hot][grows.place[0]][grows.place[1]]

    with monkeypatch.context() as patched:

        def asked(problem: Any) -> Any:
            raise AssertionError("a spectrum was asked for")

        patched.setattr(module, "suggested", asked)
        found = stability(next_hot, few[next_hot], near=grows)
        assert found.verdict == UNSTABLE and found.counted == 0 and found.mode is not None and found.mode.converged
        assert found.wave == alone.wave and alone.mode is not None
        assert abs(found.mode.sigma - alone.mode.sigma) < 1e-6 * abs(alone.mode.sigma)
        stable = stability(mid, few[mid], near=module.Stability(STABLE, counted=6))
        assert stable == module.Stability(STABLE, counted=6)
        assert stability(low, few[low], near=stable).verdict == UNSTABLE  # refuted by a count
    # where the neighbour's mode leads nowhere, and where counts fail, the search is as it is without a neighbour
    lost = replace(grows, mode=replace(grows.mode, sigma=5.0 + 3.0j))  # type: ignore[type-var]
    assert said(stability(next_hot, few[next_hot], near=lost)) == said(alone)

    def fails(*_: Any) -> Any:
        raise ConvergenceError("a mode lies on the boundary")

    monkeypatch.setattr(module, "count_dominant", fails)
    assert said(stability(next_hot, few[next_hot], near=stable)) == said(alone)


def test_lines_of_waves_rise_over_three_decades() -> None:
    flow = chute.steady(far_temperature=1.5, tan_theta=0.3, **GRAINS)
    across, along, oblique = waves(flow)
    assert all(kx == 0.0 for kx, _ in across) and all(ky == 0.0 for _, ky in along)
    assert all(abs(kx / ky - 0.1) < 1e-12 for kx, ky in oblique)
    k = [ky * flow.centre_of_mass for _, ky in across]
    assert k == sorted(k)
    assert (k[0], k[-1]) == (pytest.approx(1e-3), pytest.approx(1.0))


def test_what_cannot_be_counted_is_not_stable(monkeypatch: pytest.MonkeyPatch) -> None:
    flow = chute.steady(far_temperature=1.5, tan_theta=0.3, **GRAINS)
    monkeypatch.setattr(module, "suggested", lambda problem: [])

    def fails(*_: Any) -> Any:
        raise ConvergenceError("a mode lies on the boundary")

    monkeypatch.setattr(module, "count_dominant", fails)
    assert stability(flow).verdict.startswith("unresolved: at kx = 0, ky = 0.0003149: a mode lies on the boundary")
    raised = SimpleNamespace(modes=(), floor=1e-5, continuation=None)
    monkeypatch.setattr(module, "count_dominant", lambda *_: raised)
    monkeypatch.setattr(module, "lowest_floor", lambda continuation, floor: floor)
    assert "modes could be counted above 1.0e-05 only" in stability(flow).verdict
    lost = SimpleNamespace(modes=(0.1 + 0j,), floor=1e-8, continuation=None)
    monkeypatch.setattr(module, "count_dominant", lambda *_: lost)
    monkeypatch.setattr(module, "refine", lambda *_: SimpleNamespace(converged=False))
    assert "a mode is counted at kx = 0" in stability(flow).verdict
