"""analyses/affordable.py: a search from a guess ends where D costs far more than at the guess."""

from __future__ import annotations

import re

import numpy as np
import pytest

import shootstab as st
from shootstab.analyses import affordable
from shootstab.problems import LinearProblem

D1 = np.array([[0, 0], [1, 0]], dtype=np.complex128)


def string() -> LinearProblem:
    """y″ = σ y between walls: −n²π²."""
    return st.problem(2, lambda x: (np.eye(2, k=1) + 0j, D1), st.Wall(0, [[1, 0]]), st.Wall(1, [[1, 0]]))


def test_a_search_that_wanders_off_is_ended_in_words(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(affordable, "ANYWAY", 1)
    monkeypatch.setattr(affordable, "COSTLIER", 1)
    told = r"the search from 0\.1\+0j, where 2 steps do, wandered off: the mesh for sigma = .* would need more than 2 steps"
    problem = string()
    lost = st.refine(problem, 0.1)
    assert not lost.converged
    assert np.isinf(lost.error)
    assert pytest.approx(0.1) == lost.sigma
    assert re.search(told, lost.status)
    assert st.refine(problem, -9.8).converged


def test_meshes_that_another_question_left_end_a_search_no_later(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(affordable, "ANYWAY", 1)
    monkeypatch.setattr(affordable, "COSTLIER", 1)
    problem = string()
    first = st.refine(string(), 0.1).status
    for known in (-9.8, -39.0, -9.9 + 4.5j):
        st.refine(problem, known)
    assert st.refine(problem, 0.1).status == first


def test_a_search_whose_steps_are_beyond_squares_of_doubles_ends_in_words() -> None:
    """No mode is there, but the continuous spectrum σ = iqz alone: (σ − iqz) divides both sides."""
    walls = st.Conditions(0.0, ["u"]), st.Conditions(1.0, ["u"])
    numbers = {"p": 12.009739079386952, "q": 1300355809.5543897}
    problem = st.equations(["u"], ["sigma*(d(u, 2) - p*u) - i*q*z*(d(u, 2) - p*u)"], *walls, parameters=numbers)
    mode = st.refine(problem, -0.005855197384325338 - 0.006333446905076336j)
    assert not mode.converged
    assert "neither Newton nor Muller arrives anywhere" in mode.status
