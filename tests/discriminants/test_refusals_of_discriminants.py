"""Refusals of the discriminants that no other test reaches: what was wrong, where, and what is allowed."""

from __future__ import annotations

import importlib.util
import math
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import shootstab as st
from shootstab.core.errors import ConvergenceError, InputError
from shootstab.discriminants import meshing
from shootstab.discriminants.back_substitution import solution
from shootstab.discriminants.frame import Frame
from shootstab.discriminants.named import method_named
from shootstab.discriminants.riccati import Riccati

FIXED = [[1.0, 0.0]]


def string() -> st.LinearProblem:
    """y″ = σy with y = 0 at 0 and 1: σ = −(kπ)²."""
    D0, D1 = np.array([[0.0, 1.0], [0.0, 0.0]]), np.array([[0.0, 0.0], [1.0, 0.0]])
    return st.problem(2, lambda z: (D0, D1), st.Wall(0, FIXED), st.Wall(1, FIXED))


@pytest.mark.parametrize(("method", "shown"), [("shooting", "'shooting'"), (3, "3"), (math.sin, "<built-in function sin>")])
def test_what_is_no_method_is_refused(method: Any, shown: str) -> None:
    with pytest.raises(InputError) as refusal:
        method_named(method, 1e-8)
    assert str(refusal.value) == f"method = {shown}: allowed is frame, compound, riccati, or a method such as st.Frame(rtol=1e-11)"


def test_a_mesh_that_cannot_be_made_fine_enough_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(meshing, "MESH_ATTEMPTS", 1)
    with pytest.raises(ConvergenceError, match=r"no mesh holds local errors of 1\.0e-13 at sigma = -4000\+0j: "):
        Frame(rtol=1e-13).on(string()).at(-4000 + 0j)


def test_a_riccati_transformation_that_does_not_serve_a_circle_is_refused() -> None:
    """σ = −5 and −4000: where the string swings many times, what is bounded at −5 has poles."""
    shooting = Riccati(rtol=1e-6).on(string()).at(-5 + 0j)
    with pytest.raises(ConvergenceError, match=r"middle of a circle do not serve sigma = -4000\+0j on it"):
        meshing.cut_for(shooting, [-5 + 0j, -4000 + 0j])


def test_a_discriminant_without_zero_has_no_solution() -> None:
    """u′ = 0 from u = 0 and v′ = 0 to v = 0: D is 1 for every σ, and Newton's step infinite."""
    zero = np.zeros((2, 2))
    problem = st.problem(2, lambda z: (zero, zero), st.Wall(0, FIXED), st.Wall(1, [[0.0, 1.0]]))
    with pytest.raises(ConvergenceError, match="the iteration from the mode to the zero of D on this mesh does not arrive"):
        solution(Frame(rtol=1e-8).on(problem).at(0.5 + 0j), 0.5 + 0j)


def test_balls_without_python_flint_are_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    from shootstab.core import errors

    monkeypatch.setitem(sys.modules, "flint", None)
    source = Path(errors.__file__).with_name("balls.py")
    spec = importlib.util.spec_from_file_location("balls_without_flint", source)
    assert spec is not None
    assert spec.loader is not None
    with pytest.raises(InputError, match=r"a proof needs python-flint: install it with `pip install 'shootstab\[precise\]'`"):
        spec.loader.exec_module(importlib.util.module_from_spec(spec))
