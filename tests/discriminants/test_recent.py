"""What is kept of a problem changes no answer, and is kept only where the problem cannot have changed."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import shootstab as st
from shootstab.discriminants import recent
from shootstab.discriminants.continuation import Continuation
from shootstab.discriminants.recent import RECENT, continuation_of

METHOD = st.Frame(rtol=1e-9)
MODES = {"high": 0.00397, "low": 0.00727 - 0.0119j}  # published: the growth rates of the paper


def anew(problem):
    return st.chute.problem(problem.flow, kx=problem.kx, ky=problem.ky)


@pytest.mark.parametrize("name", ["high", "low"])
def test_a_mode_is_the_same_whatever_was_asked_before(scenes, name) -> None:
    problem = anew(scenes[name])
    first = st.refine(problem, MODES[name], rtol=1e-8)
    for elsewhere in (1.3, 0.6 + 0.2j):
        st.refine(problem, elsewhere * MODES[name], rtol=1e-7)
    again, alone = st.refine(problem, MODES[name], rtol=1e-8), st.refine(anew(problem), MODES[name], rtol=1e-8)
    assert (again.sigma, again.budget, again.status) == (first.sigma, first.budget, first.status)
    assert (alone.sigma, alone.budget, alone.status) == (first.sigma, first.budget, first.status)
    assert again.evaluations < first.evaluations == alone.evaluations


def test_few_continuations_are_kept_and_none_that_has_grown(scenes, monkeypatch: pytest.MonkeyPatch) -> None:
    problem = anew(scenes["high"])
    kept = continuation_of(problem, METHOD)
    assert continuation_of(problem, st.Frame(rtol=1e-9)) is kept
    assert continuation_of(anew(problem), METHOD) is not kept
    assert continuation_of(problem, METHOD) is kept
    for k in range(RECENT):
        continuation_of(problem, st.Frame(rtol=1e-7 / (k + 1)))
    grown = continuation_of(problem, METHOD)
    assert grown is not kept
    grown.at(0.004).discriminant(0.004)
    monkeypatch.setattr(recent, "MOST_KEPT_BYTES", grown.bytes_kept)
    assert continuation_of(problem, METHOD) is grown
    grown.at(0.0004).discriminant(0.0004)
    assert continuation_of(anew(problem), METHOD) is not grown
    assert continuation_of(problem, METHOD) is not grown


def test_a_function_that_reads_what_may_change_is_computed_anew() -> None:
    """y″ = (U − σ) y between walls at 0 and π: σ = U + 1."""
    depth = [0.0]

    def pencil(z: float) -> tuple[Any, Any]:
        return np.array([[0, 1], [depth[0], 0]]), np.array([[0, 0], [-1, 0]])

    problem = st.problem(2, pencil, st.Wall(0, [[1.0, 0.0]]), st.Wall(np.pi, [[1.0, 0.0]]))
    for depth[0] in (0.0, 2.5):
        assert complex(st.refine(problem, depth[0] + 0.9, rtol=1e-9).sigma) == pytest.approx(depth[0] + 1, rel=1e-9)


def test_a_zero_is_moved_by_what_moves_that_of_its_subsystem(scenes) -> None:
    D = Continuation(scenes["low"], METHOD).at(MODES["low"]).discriminant
    sigma = complex(st.refine(scenes["low"], MODES["low"], rtol=1e-10).sigma)
    own, value = D.vanishing_at(sigma), D.with_derivative(sigma)
    assert [m.problem.size for m in D.members] == [6, 2]
    assert [m.problem.size for m in own.members] == [6]
    for whole, part in ((D.refined(), own.refined()), (D.with_perturbed_start(1, 1e-4), own.with_perturbed_start(1, 1e-4))):
        moved, own_moved = (v.with_derivative(sigma).newton_step for v in (whole, part))
        assert own_moved == pytest.approx(moved, rel=1e-3, abs=1e-3 * abs(value.newton_step))


@pytest.mark.parametrize("given", [False, True])
def test_equations_are_kept_unless_they_call_a_function(given) -> None:
    """y″ = (σ − U) y, U = 0 or what a function says: σ = U − 1."""
    depth = [0.0]
    walls = st.Conditions(0.0, ["y"]), st.Conditions(float(np.pi), ["y"])
    known = {"given": {"U": lambda z, order: (depth[0] if order == 0 else 0.0) + 0 * z}} if given else {}
    problem = st.equations(["y"], [f"d(y, 2) - (sigma - {'U' if given else '0'})*y"], *walls, **known)
    assert (continuation_of(problem, METHOD) is continuation_of(problem, METHOD)) != given
    for depth[0] in (0.0, 2.5) if given else (0.0,):
        assert complex(st.refine(problem, depth[0] - 0.9, rtol=1e-9).sigma) == pytest.approx(depth[0] - 1, rel=1e-9)
