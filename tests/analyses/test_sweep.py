"""analyses/sweep: a mode is followed as what it is, dominance is counted, and a sweep that was interrupted repeats nothing."""

from __future__ import annotations

import cmath
import sqlite3
import subprocess
import sys
import warnings
from collections.abc import Callable, Sequence
from multiprocessing import active_children
from pathlib import Path
from time import sleep
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from kills import environment, obey_modes

import shootstab as st
from shootstab.analyses.processes import in_processes
from shootstab.analyses.sweep import sweep as swept
from shootstab.analyses.sweep import swept as in_order
from shootstab.analyses.sweep import walk
from shootstab.analyses.sweep.dominance import count_dominant
from shootstab.analyses.sweep.following import ARRIVED, FADED, LOST, FollowedMode, follow, land
from shootstab.analyses.sweep.grid import LONGEST_LINE, GridLine, SweepGrid
from shootstab.analyses.sweep.outcomes import FOLLOWED, NO_FLOW, NO_WAVE, NONE_GROWS, PROVED
from shootstab.core.discriminant import Value
from shootstab.core.errors import ConvergenceError, InputError
from shootstab.core.scaled import Scaled
from shootstab.models.chute import ChuteProblem, perturbations
from shootstab.models.chute.parameter_family import ChuteFamily

# grids and lines


def test_lines_are_the_grid_cut_along_a_wavenumber(scenes: dict[str, ChuteProblem]) -> None:
    axes = {"ky": np.linspace(0.0, 0.03, 150), "tan_theta": [0.29, 0.3, 0.31]}
    grid = SweepGrid.of(axes, scenes["high"].family(tuple(axes)))
    lines = grid.lines()
    points = [p for line in lines for p in line.points]
    assert len(points) == len(grid) == 450
    assert set(points) == set(grid.points)
    assert all(len(line.points) <= LONGEST_LINE and len({p[1] for p in line.points}) == 1 for line in lines)
    done = lines[2].points + lines[5].points + lines[8].points[:-1]
    assert grid.lines(done) == [*lines[:2], *lines[3:5], *lines[6:]]  # the same cuts, whatever is done, and no line in part
    assert grid.lines(points) == []


def test_a_place_between_two_points() -> None:
    line = GridLine("ky", ("kx", "ky"), ((1e-3, 0.0), (1e-3, 0.02)))
    assert line.values(0.25) == {"kx": 1e-3, "ky": 0.005}
    assert line.values(1.0) == {"kx": 1e-3, "ky": 0.02}


@pytest.mark.parametrize(
    ("axes", "says"),
    [
        ({}, "nothing to sweep over"),
        ({"kz": [1.0]}, "kz: cannot be swept"),
        ({"kx": [0.0, 2.0, 1.0]}, "only rise or only fall"),
        ({"kx": [0.0, float("nan")]}, "finite"),
        ({"kx": "abc"}, "a sequence of numbers"),
        ({"e": [0.9, 1.1]}, "e = 1.1"),
        ({"far_temperature": [0.0, 1.0]}, "far_temperature = 0.0"),
        ({"far_temperature": [1.0], "mass_flux": [1.0]}, "one of them"),
    ],
)
def test_what_cannot_be_swept_is_refused(scenes: dict[str, ChuteProblem], axes: dict[str, Any], says: str) -> None:
    with pytest.raises(InputError, match=says):
        swept(scenes["high"], axes)


def test_other_problems_and_settings_are_refused(scenes: dict[str, ChuteProblem]) -> None:
    with pytest.raises(InputError, match="belongs to no family"):
        swept(st.gallery.poiseuille.PlanePoiseuille(), {"kx": [0.1]})
    for settings in ({"digits": 0}, {"every": 0}, {"floor": 0.0}, {"workers": 0}):
        with pytest.raises(InputError, match=f"{next(iter(settings))} = 0"):
            swept(scenes["high"], {"ky": [0.01]}, **settings)


def test_a_flow_chosen_by_its_flux_keeps_flux_and_branch(scenes: dict[str, ChuteProblem]) -> None:
    family = scenes["mid"].family(("tan_theta",))
    assert (family.mass_flux, family.origin) == (3.0, scenes["mid"].flow)
    flow = family.flow({"tan_theta": 0.3})
    assert abs(flow.far_temperature - scenes["mid"].flow.far_temperature) < 1e-12
    assert abs(family.flow({"tan_theta": 0.301}).mass_flux - 3.0) < 1e-10
    # over wavenumbers and far temperatures nothing is kept but the grains
    assert scenes["mid"].family(("ky",)).far_temperature == scenes["mid"].flow.far_temperature


# following


class KnownPolynomial:
    """D(σ) = Π (σ − zero)."""

    def __init__(self, zeros: Sequence[complex]) -> None:
        self.zeros, self.evaluations = zeros, 0

    def with_derivative(self, sigma: complex) -> Value:
        self.evaluations += 1
        D = complex(np.prod([sigma - z for z in self.zeros]))
        dD = sum(complex(np.prod([sigma - z for j, z in enumerate(self.zeros) if j != i])) for i in range(len(self.zeros)))
        return Value(sigma, Scaled(D, 0.0), complex(dD))

    def __call__(self, sigma: complex) -> Scaled:
        return self.with_derivative(sigma).D

    def vanishing_at(self, sigma: complex) -> KnownPolynomial:
        return self

    def refined(self) -> KnownPolynomial:
        return KnownPolynomial(self.zeros)

    def partly_refined(self, digit: int, sigma: complex) -> KnownPolynomial:
        return self

    def gradient(self, sigma: complex) -> None:
        """None: nothing is known but its values."""

    def local_errors(self, sigma: complex) -> np.ndarray:
        return np.zeros(0)

    def at(self, sigma: complex) -> KnownPolynomial:
        return self

    def serves(self, sigma: complex) -> bool:
        return True

    def on_same_mesh(self, problem: Any) -> KnownPolynomial:
        return KnownPolynomial(problem.zeros)

    meshes = None


def test_the_prediction_is_exact_for_cubics() -> None:
    cubic = np.polynomial.Polynomial([1 + 1j, 2.0, -0.3j, 0.1])
    branch = FollowedMode()
    for place in (5.0, 0.0, 0.5, 1.25, 2.0):  # the first is too long ago to count
        branch.add(place, complex(cubic(place)) if place < 5 else 99j)
    assert abs(branch.predicted(3.0) - cubic(3.0)) < 1e-13


def test_newton_lands_on_a_zero_only_if_no_other_is_near() -> None:
    a, b = 1.0 + 0.5j, 1.1 + 0.5j
    assert land(KnownPolynomial([a, b]), a - 0.01) == pytest.approx(a, abs=1e-11)
    assert land(KnownPolynomial([a, b]), a + 0.045) is None  # about as near to the one as to the other
    assert land(KnownPolynomial([a]), a + 0.4) == pytest.approx(a, abs=1e-11)
    assert land(KnownPolynomial([-0.5]), 0.2 + 0j) is None  # decaying modes are not looked for


@pytest.mark.parametrize("detour", [0.3, 0.03])
def test_a_mode_is_followed_past_another(detour: float) -> None:
    """The two exchange their growth rates at t = 1/2, at a distance of the detour."""

    def zeros(t: float) -> list[complex]:
        return [0.5 + t + 0j, 1.5 - t + 1j * detour]

    places = np.linspace(0.0, 1.0, 6)
    branch = FollowedMode([0.0], [zeros(0.0)[0]])
    for t in places[1:]:
        assert follow(branch, t, lambda t: KnownPolynomial(zeros(t))) == ARRIVED  # type: ignore[arg-type,return-value]
    assert abs(branch.last - zeros(1.0)[0]) < 1e-10


def test_two_real_modes_that_become_a_pair_are_lost_and_not_guessed() -> None:
    def at(t: float) -> Any:
        return KnownPolynomial([2 + cmath.sqrt(0.55 - t), 2 - cmath.sqrt(0.55 - t)])

    branch = FollowedMode([0.0], [2 + cmath.sqrt(0.55)])
    assert [follow(branch, t, at) for t in (0.2, 0.4)] == [ARRIVED, ARRIVED]
    assert follow(branch, 1.0, at) == LOST


def test_a_mode_that_stops_growing_has_faded() -> None:
    branch = FollowedMode([0.0], [1 + 0.2j])
    reached = [follow(branch, t, lambda t: KnownPolynomial([1 - t + 0.2j])) for t in (0.3, 0.6, 0.9, 1.2)]  # type: ignore[arg-type,return-value]
    assert reached == [ARRIVED, ARRIVED, ARRIVED, FADED]


# the walk: where which mode dominates is known beforehand


def walked(monkeypatch: pytest.MonkeyPatch, zeros: Callable[[float], list[complex]], count: int, every: int) -> list[Any]:
    """Walk over polynomials; the count_dominant is what their zeros say, errors are nothing."""

    def counted(problem: Any, known: Any, floor: float, before: Any) -> Any:
        growing = sorted((z for z in problem.zeros if z.real > floor), key=lambda z: -z.real)
        level = max(floor, 0.5 * max((z.real for z in growing), default=0.0))
        return SimpleNamespace(modes=[z for z in growing if z.real > level], floor=level, evaluations=1)

    class CountedMethod:
        def __init__(self, rtol: float) -> None: ...

        def on(self, problem: Any, begin: Any) -> KnownPolynomial:
            return KnownPolynomial(problem.zeros)

    family: Any = SimpleNamespace(
        absent=lambda values: None, beside=lambda values: {}, problem=lambda values: SimpleNamespace(zeros=zeros(values["kx"]))
    )
    monkeypatch.setattr(walk, "count_dominant", counted)
    monkeypatch.setattr(walk, "Frame", CountedMethod)
    monkeypatch.setattr(
        walk, "refine", lambda problem, sigma, rtol: SimpleNamespace(converged=True, sigma=sigma, error=1e-12, evaluations=1)
    )
    points = tuple((x,) for x in np.linspace(0.0, 1.0, count))
    return walk.walk(family, walk.WalkSettings(every=every), GridLine("kx", ("kx",), points))


def test_a_crossing_between_two_counts_is_found_on_its_own_side(monkeypatch: pytest.MonkeyPatch) -> None:
    """A mode that is not known at the first anchor, being slower than half, dominates at the second: both change over where they cross."""

    def zeros(x: float) -> list[complex]:
        return [1.0 - 0.9 * x + 0j, 0.3 + 0.6 * x + 1j]

    outcomes = walked(monkeypatch, zeros, 21, 20)
    for x, outcome in zip(np.linspace(0.0, 1.0, 21), outcomes, strict=True):
        assert outcome.sigma == pytest.approx(max(zeros(x), key=lambda z: z.real), abs=1e-9)
    assert [i for i, o in enumerate(outcomes) if o.proved] == [0, 20]
    assert {o.status for o in outcomes[1:-1]} == {FOLLOWED}


def test_a_lost_mode_makes_a_count(monkeypatch: pytest.MonkeyPatch) -> None:
    """Two real modes meet and go on as a pair: where the one cannot be followed any more, the pair is counted and followed."""

    def zeros(x: float) -> list[complex]:
        return [2 + cmath.sqrt(0.512 - x), 2 - cmath.sqrt(0.512 - x)]

    outcomes = walked(monkeypatch, zeros, 21, 50)
    for x, outcome in zip(np.linspace(0.0, 1.0, 21), outcomes, strict=True):
        assert outcome.sigma.real == pytest.approx(max(z.real for z in zeros(x)), abs=1e-9)
        assert abs(outcome.sigma.imag) == pytest.approx(abs(zeros(x)[0].imag), abs=1e-9)
    assert [i for i, o in enumerate(outcomes) if o.proved] == [0, 11, 20]


def test_an_island_between_two_stable_counts_is_what_followed_leaves_open(monkeypatch: pytest.MonkeyPatch) -> None:
    outcomes = walked(monkeypatch, lambda x: [0.5 - abs(x - 0.5) * 1.2 + 0.1j, -1 + 0j], 9, 8)
    assert {o.status for o in outcomes} == {NONE_GROWS}
    assert [o.proved for o in outcomes] == [True, *[False] * 7, True]
    outcomes = walked(monkeypatch, lambda x: [0.5 - abs(x - 0.5) * 1.2 + 0.1j, -1 + 0j], 9, 2)
    assert [o.status for o in outcomes] == [NONE_GROWS, FOLLOWED, PROVED, FOLLOWED, PROVED, FOLLOWED, PROVED, FOLLOWED, NONE_GROWS]


def test_a_count_that_fails_leaves_its_neighbours_unresolved(monkeypatch: pytest.MonkeyPatch) -> None:
    outcomes = walked(monkeypatch, lambda x: [1 - 0.1 * x + 0j], 9, 4)
    assert [o.status for o in outcomes] == [PROVED, *[FOLLOWED] * 3, PROVED, *[FOLLOWED] * 3, PROVED]

    def fails(*_: Any) -> Any:
        raise ConvergenceError("a mode lies on the boundary")

    original = walk.count_dominant
    calls = iter([original, fails, original])

    def zeros(x: float) -> list[complex]:
        return [1 - 0.1 * x + 0j]

    family: Any = SimpleNamespace(
        absent=lambda values: None, beside=lambda values: {}, problem=lambda values: SimpleNamespace(zeros=zeros(values["kx"]))
    )
    monkeypatch.setattr(walk, "count_dominant", lambda *given: next(calls)(*given))
    line = GridLine("kx", ("kx",), tuple((x,) for x in np.linspace(0.0, 1.0, 9)))
    outcomes = walk.walk(family, walk.WalkSettings(every=4), line)
    assert [o.status.partition(":")[0] for o in outcomes] == [PROVED, *["unresolved"] * 7, PROVED]
    assert all("a mode lies on the boundary" in o.status for o in outcomes[1:-1])


# the real thing

KY = [-0.012, -0.006, 0.0, 0.006, 0.012, 0.018, 0.0215, 0.024]


@pytest.fixture(scope="module")
def row(scenes: dict[str, ChuteProblem]) -> Any:
    """The high flow at k_x = 0, from one side of k_y = 0 to beyond the last growing mode."""
    return swept(scenes["high"], {"kx": 0.0, "ky": KY}, every=2)


def test_every_point_against_a_search_of_its_own(row: Any, scenes: dict[str, ChuteProblem]) -> None:
    said = [o.status for _, o in row.rows()]
    assert said[2] == NO_WAVE
    assert said[-1] == NONE_GROWS
    assert set(said[:2] + said[3:-1]) <= {PROVED, FOLLOWED}
    for (_, ky), outcome in row.rows():
        if outcome.sigma is None:
            continue
        truth = st.refine(st.chute.problem(scenes["high"].flow, 0.0, ky), outcome.sigma, rtol=1e-10)
        assert truth.converged
        assert abs(outcome.sigma - truth.sigma) <= outcome.error + truth.error
        assert outcome.error <= 1e-8 * abs(outcome.sigma)


def test_symmetry_in_ky(row: Any) -> None:
    found = {ky: o for (_, ky), o in row.rows()}
    for ky in (0.006, 0.012):
        assert abs(found[ky].sigma - found[-ky].sigma) <= found[ky].error + found[-ky].error


def test_what_was_proved_is_what_another_count_says(row: Any, scenes: dict[str, ChuteProblem]) -> None:
    for (_, ky), outcome in row.rows():
        if outcome.proved and ky in (0.012, 0.024):
            assert st.count_unstable(st.chute.problem(scenes["high"].flow, 0.0, ky)).count == int(outcome.sigma is not None)
    assert row.summary["counted"] >= 4


def test_a_count_finds_what_nobody_knew(scenes: dict[str, ChuteProblem]) -> None:
    found = count_dominant(scenes["low"], [], 1e-8)
    assert len(found.modes) == 1
    assert abs(found.modes[0] - (0.0072756 - 0.0118650j)) < 1e-6
    neighbour = st.chute.problem(scenes["low"].flow, 0.0112, 0.0)
    again = count_dominant(neighbour, [], 1e-8, found)  # on the meshes of the first
    assert len(again.modes) == 1
    with pytest.raises(ConvergenceError, match=r"1 mode is counted with Re sigma > 0\.0037, but 2 found"):
        count_dominant(scenes["low"], [0.0075 + 0j, *found.modes], 1e-8)


def test_a_sweep_over_waves_makes_the_tables_of_its_flow_once(scenes: dict[str, ChuteProblem], monkeypatch: pytest.MonkeyPatch) -> None:
    """The fields of the flow on a mesh are what does not depend on k_x and k_y: four times the points between two counts make none more."""
    made = []
    tabulated = perturbations.tabulated

    def counted(chute: Any, states: Any, derivatives: bool = True) -> Any:
        made.append(len(states))
        return tabulated(chute, states, derivatives)

    monkeypatch.setattr(perturbations, "tabulated", counted)
    tables = {}
    for points in (11, 41):
        made.clear()
        found = st.sweep(scenes["high"], {"kx": 5e-4, "ky": np.linspace(0.006, 0.014, points)}, every=64)
        assert (found.summary[PROVED], found.summary[FOLLOWED]) == (2, points - 2)
        tables[points] = sum(made)
    assert 0 < tables[41] <= tables[11], tables


def test_flows_without_a_member(scenes: dict[str, ChuteProblem]) -> None:
    """Along the slope at Q0 = 3 the three flows become fewer: a point whose branch is gone says so."""
    problem = st.chute.problem(scenes["mid"].flow, 0.0, 0.0125)
    said = [o.status for _, o in swept(problem, {"tan_theta": [0.26, 0.3]}).rows()]
    assert said[0].startswith(NO_FLOW)
    assert said[1] == PROVED


# the store


class StopHereError(Exception):
    """In place of Ctrl-C."""


def test_an_interrupted_sweep_goes_on_and_repeats_nothing(
    scenes: dict[str, ChuteProblem], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    axes = {"kx": [0.0, 5e-4, 1e-3], "ky": [0.009, 0.0095, 0.01, 0.0105]}
    worked: list[GridLine] = []
    original = in_order.walk

    def counted(family: ChuteFamily, settings: Any, line: GridLine) -> Any:
        worked.append(line)
        return original(family, settings, line)

    def interrupt(done: int, total: int) -> None:
        if done == 8:
            raise StopHereError

    monkeypatch.setattr(in_order, "walk", counted)
    file = tmp_path / "map.sqlite"
    with pytest.raises(StopHereError):
        swept(scenes["high"], axes, out=file, progress=interrupt)
    assert len(worked) == 2
    again = swept(scenes["high"], axes, out=file)
    assert len(worked) == 3
    assert len({p for line in worked for p in line.points}) == sum(len(line.points) for line in worked) == 12
    assert again.outcomes == swept(scenes["high"], axes).outcomes
    assert swept(scenes["high"], axes, out=file).outcomes == again.outcomes
    with sqlite3.connect(file) as base:
        assert base.execute("SELECT count(*) FROM points WHERE re > 0.003").fetchone() == (12,)
    base.close()
    with pytest.raises(InputError, match="another sweep, of other digits"):
        swept(scenes["high"], axes, digits=7, out=file)
    with pytest.raises(InputError, match="another sweep, of other axes"):
        swept(scenes["high"], {**axes, "ky": [0.01, 0.02]}, out=file)
    with pytest.raises(InputError, match="another sweep, of other problem"):
        swept(scenes["mid"], axes, out=file)


def test_files_of_other_kinds_are_refused(scenes: dict[str, ChuteProblem], tmp_path: Path) -> None:
    text, other = tmp_path / "a.txt", tmp_path / "b.sqlite"
    text.write_text("no database, but long enough to be looked at. " * 40)
    with sqlite3.connect(other) as base:
        base.execute("CREATE TABLE mine (x)")
    base.close()
    for file, says in ((text, "cannot be used for results"), (other, "holds other tables")):
        with pytest.raises(InputError, match=says):
            swept(scenes["high"], {"ky": [0.01]}, out=file)
    assert text.read_text().startswith("no database")


# workers


def test_processes_give_the_same(scenes: dict[str, ChuteProblem]) -> None:
    axes = {"kx": [0.0, 5e-4], "ky": [0.009, 0.01]}
    assert swept(scenes["high"], axes, workers=2).outcomes == swept(scenes["high"], axes).outcomes


def test_a_dask_cluster_gives_the_same(scenes: dict[str, ChuteProblem]) -> None:
    distributed = pytest.importorskip("distributed")
    axes = {"kx": [0.0, 5e-4], "ky": [0.009, 0.01]}
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # distributed's own
        settings = {"n_workers": 1, "threads_per_worker": 1, "dashboard_address": None}
        with distributed.LocalCluster(**settings) as cluster:
            found = swept(scenes["high"], axes, cluster=cluster.scheduler_address)
    assert found.outcomes == swept(scenes["high"], axes).outcomes


def test_a_cluster_that_is_not_there(scenes: dict[str, ChuteProblem], monkeypatch: pytest.MonkeyPatch) -> None:
    from shootstab.analyses import workers

    def absent(name: str) -> Any:
        raise ImportError(name)

    monkeypatch.setattr(workers, "import_module", absent)
    with pytest.raises(InputError, match=r"a cluster needs dask: install it with .*shootstab\[cluster\]"):
        swept(scenes["high"], {"ky": [0.01]}, cluster="tcp://127.0.0.1:1")


def test_processes_end_with_the_one_that_asked_for_them() -> None:
    """An interrupted sweep does not wait for what is under way: closing the results ends the workers."""
    before = set(active_children())
    results = in_processes(sleep, [0.0, 600.0], 2)
    assert next(results) == (0.0, None)
    results.close()
    assert set(active_children()) <= before


LOCKED_STORE = """
import os, sqlite3, sys, layer
import shootstab as st

file, axes, told = sys.argv[1], {"kx": [0.0], "far_temperature": [50.0, 55.0]}, []
whole = st.sweep(layer.layer(), axes, out=file)
os.chmod(file, 0o444)
assert st.sweep(layer.layer(), axes, out=file).outcomes == whole.outcomes
os.chmod(file, 0o644)
with sqlite3.connect(file) as base:
    base.execute("DELETE FROM points WHERE far_temperature > 52")
os.chmod(file, 0o444)
try:
    st.sweep(layer.layer(), axes, out=file, progress=lambda done, total: told.append(done))
except st.InputError as error:
    print(told, error)
"""


def test_a_file_that_may_not_be_written_to_is_read_where_it_is_whole_and_refused_before_any_work_where_not(tmp_path: Path) -> None:
    file = tmp_path / "a.sqlite"
    command = [sys.executable, "-c", LOCKED_STORE, file]
    done = subprocess.run(command, env=environment(), preexec_fn=obey_modes, capture_output=True, text=True, check=True)
    assert done.stdout.startswith(f"[] {file}: cannot be used for results: ")
    assert len(done.stdout.splitlines()) == 1
    assert not done.stderr
