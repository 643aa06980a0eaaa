"""analyses/sweep/neutral.py: modes are followed one step below zero growth, so that neutral curves are interpolated."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from equations import FREE

import shootstab as st
from shootstab.analyses.sweep.grid import ParameterAxis, SweepGrid
from shootstab.analyses.sweep.neutral import neutral_steps, with_below
from shootstab.analyses.sweep.outcomes import FOLLOWED, NO_FLOW, NONE_GROWS, PROVED, Outcome
from shootstab.analyses.sweep.walk import WalkSettings
from shootstab.cli import maps
from shootstab.core.records import UNRESOLVED

# u″ = (σ − a + b²) u between walls at 0 and π: σ = a − b² − 1, so that the neutral curve is a = b² + 1
EQUATIONS: dict[str, Any] = {
    "unknowns": ["u"],
    "equations": ["sigma*u = d(u,2) + (a - b**2)*u"],
    "left": st.Conditions(0.0, ["u"]),
    "right": st.Conditions(np.pi, ["u"]),
    "parameters": {"a": 2.0, "b": 0.5},
}


@pytest.fixture(scope="module")
def problem() -> Any:
    return st.equations(**EQUATIONS)


def test_every_point_beside_a_growing_one_has_the_mode_below_zero(problem: Any, tmp_path: Path) -> None:
    axes = {"a": [0.3, 1.2, 2.1, 3.0], "b": [0.2, 0.7, 1.2, 1.7]}
    file = tmp_path / "a.sqlite"
    found = st.sweep(problem, axes, out=file)
    for i, a in enumerate(axes["a"]):
        for j, b in enumerate(axes["b"]):
            outcome = found.outcomes[a, b]
            sides = [(i - 1, j), (i + 1, j), (i, j - 1), (i, j + 1)]
            grows_beside = any(
                axes["a"][k] > axes["b"][m] ** 2 + 1.0 for k, m in sides if 0 <= k < len(axes["a"]) and 0 <= m < len(axes["b"])
            )
            if a > b**2 + 1.0:
                assert outcome.sigma == pytest.approx(a - b**2 - 1.0, rel=1e-8)
                assert outcome.below is None
            elif grows_beside:
                assert outcome.status == NONE_GROWS
                assert outcome.below == pytest.approx(a - b**2 - 1.0, rel=1e-6)
            else:
                assert outcome.below is None
    assert st.sweep(problem, axes, out=file).outcomes == found.outcomes
    assert np.isfinite(found.below).sum() == sum(o.below is not None for o in found.outcomes.values()) >= 4


def test_a_sweep_that_was_ended_between_the_lines_and_the_steps_ends_with_the_same(problem: Any, tmp_path: Path) -> None:
    axes, file = {"a": [0.5, 1.5, 2.5], "b": [0.5, 1.0]}, tmp_path / "a.sqlite"
    whole = st.sweep(problem, axes)
    told: list[tuple[int, int]] = []

    class EndedError(Exception):
        """In place of Ctrl-C."""

    def end(done: int, total: int) -> None:
        told.append((done, total))
        if done == 6:
            raise EndedError

    with pytest.raises(EndedError):
        st.sweep(problem, axes, out=file, progress=end)
    assert st.sweep(problem, axes, out=file, progress=lambda done, total: told.append((done, total))).outcomes == whole.outcomes
    assert told[-1] == (7, 7)  # the steps are a part of the work that is shown


def test_steps_are_from_growing_points_to_neighbours_at_which_nothing_grows() -> None:
    grid = SweepGrid((ParameterAxis("a", (0.0, 1.0, 2.0)), ParameterAxis("b", (5.0, 6.0))))
    outcomes = {p: Outcome(NONE_GROWS) for p in grid.points}
    outcomes[1.0, 5.0] = Outcome(PROVED, True, 0.1 + 0.2j, 1e-9)
    outcomes[2.0, 6.0] = Outcome(f"{NO_FLOW}: none")
    outcomes[1.0, 6.0] = Outcome(FOLLOWED, False, 0.3 + 0.2j, 1e-9)
    steps = {s.point: s.begins for s in neutral_steps(grid, outcomes)}
    assert set(steps) == {(0.0, 5.0), (2.0, 5.0), (0.0, 6.0)}
    ((line, sigma),) = steps[0.0, 6.0]
    assert (line.along, line.points, sigma) == ("a", ((1.0, 6.0), (0.0, 6.0)), 0.3 + 0.2j)


def test_a_mode_that_grows_where_counts_told_of_none_leaves_the_point_unresolved() -> None:
    outcomes = {(0.0,): Outcome(NONE_GROWS), (1.0,): Outcome(NONE_GROWS, True, floor=1e-4), (2.0,): Outcome(NONE_GROWS)}
    told = with_below(outcomes, {(0.0,): 0.1 + 1j, (1.0,): 5e-5 + 1j, (2.0,): -0.1 + 1j}, WalkSettings())
    assert told[0.0,].status.startswith(f"{UNRESOLVED}: the mode 0.1+1j of a neighbouring point grows here")
    assert (told[1.0,].status, told[1.0,].proved) == (NONE_GROWS, True)  # below the floor of its own count
    assert (told[2.0,].status, told[2.0,].below) == (NONE_GROWS, -0.1 + 1j)


def test_the_neutral_curve_of_a_map_is_interpolated(problem: Any) -> None:
    """a = b² + 1: σ is linear in a, so that the curve is met to rounding where it crosses lines of constant b, however coarse the grid."""
    axes = {"a": [0.3, 1.4, 2.5, 3.6], "b": [0.1, 0.5, 0.9, 1.3]}
    found = st.sweep(problem, axes)
    seen = maps.continued(found.growth, found.below.real, np.zeros((4, 4), dtype=bool))
    for j, b in enumerate(axes["b"]):
        i = int(np.flatnonzero(seen[:, j] > 0.0)[0])
        low, high = seen[i - 1, j], seen[i, j]
        edge = axes["a"][i] - (axes["a"][i] - axes["a"][i - 1]) * high / (high - low)
        assert edge == pytest.approx(b**2 + 1.0, abs=1e-7)


def test_the_neutral_curve_of_convection_on_a_coarse_grid(tmp_path: Path) -> None:
    """Rayleigh: Ra = (π² + a²)³/a² between free walls; where growth rates lead, the curve was off by up to 29."""
    (tmp_path / "free.toml").write_text(FREE)
    axes = {"Ra": np.linspace(500.0, 1300.0, 6).tolist(), "a": np.linspace(1.5, 4.0, 6).tolist()}
    found = st.sweep(st.scene(str(tmp_path / "free.toml")).problem, axes)
    seen = maps.continued(found.growth, found.below.real, np.zeros((6, 6), dtype=bool))
    for j, a in enumerate(axes["a"]):
        i = int(np.flatnonzero(found.growth[:, j] > 0.0)[0])
        low, high = seen[i - 1, j], seen[i, j]
        edge = axes["Ra"][i] - (axes["Ra"][i] - axes["Ra"][i - 1]) * high / (high - low)
        assert abs(edge - (np.pi**2 + a**2) ** 3 / a**2) < 2.5
