"""verify and find by several processes and by a cluster: who does the work moves no bit of an answer."""

from __future__ import annotations

import os
import pickle
import warnings
from time import sleep
from typing import Any

import layer
import numpy as np
import pytest

import shootstab as st
from shootstab.analyses import workers
from shootstab.core.records import Mode, Report

CLAIMS = [layer.exact(60.0, 0.0, n) * (1 + (n % 3) * 1e-8) for n in range(1, 10)] + [30.0 + 2.0j, 1e9]
BOX = st.Rectangle(-40 - 1j, 60 + 1j)


def told(report: Report) -> list[Any]:
    """All that verdicts say."""
    return [(v.claimed, v.verdict, v.sigma, v.error, v.digits_agreed, v.why, v.atol, v.continuum_distance) for v in report.verdicts]


def seen(modes: tuple[Mode, ...]) -> list[Any]:
    """What modes are; not how long they took."""
    return [(m.sigma, m.error, m.multiplicity, m.evaluations) for m in modes]


def test_claims_by_any_number_of_workers() -> None:
    """No bit of a verdict depends on how many processes judge, and so not on what was asked of them before."""
    problem = layer.layer()
    alone, shared = (st.verify(problem, CLAIMS, missing="within", workers=n) for n in (1, 2))
    assert told(shared) == told(alone)
    assert shared.missing == alone.missing and shared.searched == alone.searched and shared.rests_on == alone.rests_on
    assert {v.verdict for v in alone.verdicts} == {"confirmed", "spurious", "unresolved"}


def test_modes_found_by_any_number_of_workers() -> None:
    problem = layer.layer()
    alone, shared = (st.find(problem, BOX, workers=n) for n in (1, 2))
    assert seen(shared.modes) == seen(alone.modes)
    assert len(alone.modes) == alone.counted.count > 1


def test_a_cluster_gives_the_same() -> None:
    distributed = pytest.importorskip("distributed")
    problem = layer.layer()
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # distributed's own
        with distributed.LocalCluster(n_workers=1, threads_per_worker=1, dashboard_address=None) as cluster:
            at = cluster.scheduler_address
            verdicts, modes = st.verify(problem, CLAIMS, missing="none", cluster=at), st.find(problem, BOX, cluster=at)
    assert told(verdicts) == told(st.verify(problem, CLAIMS, missing="none"))
    assert seen(modes.modes) == seen(st.find(problem, BOX).modes)


def test_others_are_started_where_much_is_left(monkeypatch: pytest.MonkeyPatch) -> None:
    """What one process alone has done by then it need not do again; a first job that takes long, as one that compiles, tells nothing."""
    done: list[int] = []

    def here(job: int) -> int:
        done.append(job)
        if job == 0:
            sleep(0.2)
        return job

    def shared() -> dict[int, int]:
        done.clear()
        return dict(workers.spread(here, lambda: abs, list(range(9)), None, None))

    whole = {job: job for job in range(9)}
    monkeypatch.setattr(os, "cpu_count", lambda: 2)
    monkeypatch.setattr(workers, "WORTH_OTHERS", 0.1)
    assert shared() == whole and done == list(range(9))
    monkeypatch.setattr(workers, "WORTH_OTHERS", 0.0)
    assert shared() == whole and done == list(range(workers.DONE_FIRST))


@pytest.mark.parametrize("name", ["low", "benard", "shear-layer", "kink", "two-layers"])
def test_problems_that_can_be_sent(name: str) -> None:
    """A built-in scene is made again elsewhere, by its formulas or by what made it, and has the same D to the last bit."""
    problem = st.scene(name).problem
    sent = pickle.loads(pickle.dumps(problem))
    ours, theirs = (st.discriminant(p, "frame")(0.13 - 0.21j) for p in (problem, sent))
    assert ours == theirs


def test_a_problem_that_cannot_be_sent() -> None:
    """A function inside a function stays in its process: several are refused in words, and as many as are worth it are one."""
    D1 = np.array([[0, 0], [1, 0]], dtype=complex)
    problem = st.problem(2, lambda z: (np.eye(2, k=1) + 0j, D1), st.Wall(0, [[1, 0]]), st.Wall(1, [[1, 0]]))
    claims = [-((n * np.pi) ** 2) for n in (1, 2)]
    with pytest.raises(st.InputError, match="this problem cannot be sent to other processes"):
        st.verify(problem, claims, workers=2)
    assert all(v.verdict == "confirmed" for v in st.verify(problem, claims, workers=None).verdicts)


@pytest.mark.parametrize("number", [0, 2.5, 10**6])
def test_numbers_that_are_none(number: Any) -> None:
    with pytest.raises(st.InputError, match="workers"):
        st.verify(layer.layer(), CLAIMS, workers=number)
    with pytest.raises(st.InputError, match="workers"):
        st.find(layer.layer(), BOX, workers=number)


def test_processes_beside_a_cluster() -> None:
    with pytest.raises(st.InputError, match="beside a cluster"):
        st.verify(layer.layer(), CLAIMS, workers=2, cluster="tcp://127.0.0.1:1")
