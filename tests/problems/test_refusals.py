"""Every refusal of the problems' room that no other test reaches: what was wrong, where, and what is allowed."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

import shootstab as st
from shootstab.core.errors import InputError, Undecidable
from shootstab.problems.protocol import Pencil
from shootstab.problems.splitting import AsymptoticPencil
from shootstab.problems.unknowns import Unknowns

FIXED = [[1.0, 0.0]]


def string(z: Any) -> tuple[Any, Any]:
    return np.array([[0.0, 1.0], [0.0, 0.0]]), np.array([[0.0, 0.0], [1.0, 0.0]])


def moving_c(z: Any) -> tuple[Any, ...]:
    """y″ = σ y with its first row times 1 − σ: C is singular at σ = 1, at infinity too."""
    return np.eye(2), np.diag([-1.0, 0.0]), string(z)[0], np.array([[0.0, -1.0], [1.0, 0.0]]) * np.array([[0.0, 1.0], [1.0, 0.0]])


def without_derivative(z: Any) -> tuple[Any, ...]:
    return np.diag([1.0, 0.0]), np.zeros((2, 2)), np.array([[0.0, 1.0], [1.0, 1.0]]), np.eye(2)


REFUSALS: dict[str, tuple[Any, tuple[str, ...]]] = {
    "wall at infinity": (
        lambda: st.problem(2, string, st.Wall(-math.inf, FIXED), st.Wall(1, FIXED)),
        ("left wall", "z = -inf", "st.Infinity()"),
    ),
    "reference 0": (lambda: st.problem(2, string, st.Wall(0, FIXED), st.Infinity(), reference=0), ("reference = 0", "other than 0")),
    "reference on the spectrum": (
        lambda: st.problem(2, moving_c, st.Wall(0, FIXED), st.Infinity(), reference=1.0),
        ("C is singular", "reference = 1", "off the continuous spectrum"),
    ),
    "reference where too few decay": (
        lambda: st.problem(2, lambda z: (np.diag([1.0, 1.0]), np.diag([-1.0, -1.0])), st.Wall(0, FIXED), st.Infinity(), reference=0.5),
        ("0 of 2 solutions decay towards +infinity at reference = 0.5", "1 rows at the wall ask for 1"),
    ),
    "a start on the other side": (
        lambda: st.problem(2, string, st.Infinity(start=2.0), st.Infinity(start=4.0), fold=5.0),
        ("at +infinity start = 4", "a |z| beyond 5"),
    ),
    "no derivative at infinity": (
        lambda: st.problem(2, without_derivative, st.Wall(0, FIXED), st.Infinity()),
        ("C is singular at an end at infinity, whatever sigma is", "solved for the derivative"),
    ),
    "limit of the wrong shape": (
        lambda: st.problem(2, string, st.Wall(0, FIXED), st.Infinity(limit=(np.eye(3), np.eye(3)))),
        ("the limit given at +infinity", "(3, 3)", "(2, 2)"),
    ),
    "five matrices": (
        lambda: st.problem(2, lambda z: (*string(z), *string(z), np.eye(2)), st.Wall(0, FIXED), st.Infinity()),
        ("the pencil gives 5", "as many of C as of D"),
    ),
    "rows times sigma squared of another shape": (
        lambda: st.problem(2, string, st.Wall(0, FIXED, [[[1.0, 0.0]], [[1.0]]]), st.Wall(1, FIXED)),
        ("left wall", "times sigma**2", "(1, 2)"),
    ),
    "start before an interface": (
        lambda: st.problem(2, string, st.Wall(0, FIXED), st.Infinity(start=2.0), interfaces=[st.Interface.jump(3.0, np.eye(2))]),
        ("at +infinity start = 2", "an interface lies 3 from z = 0", "a start beyond all interfaces"),
    ),
    "no unknowns": (lambda: Unknowns.combinations({}, 2), ("unknowns is empty", "a row over the components")),
    "a row of unknowns too short": (
        lambda: st.problem(2, string, st.Wall(0, FIXED), st.Wall(1, FIXED), unknowns={"W": [1.0]}),
        ("unknowns['W']", "a row of 2 finite numbers"),
    ),
    "an infinite row of unknowns": (
        lambda: Unknowns.combinations({"W": [1.0, math.inf]}, 2),
        ("unknowns['W']", "2 finite numbers"),
    ),
}


@pytest.mark.parametrize("what", REFUSALS)
def test_what_was_wrong_is_named(what: str) -> None:
    make, words = REFUSALS[what]
    with pytest.raises(InputError) as refusal:
        make()
    for word in words:
        assert word in str(refusal.value)
    assert "allowed" in str(refusal.value)


def test_an_end_whose_c_is_singular_lies_on_the_spectrum() -> None:
    limit = AsymptoticPencil(Pencil(*(np.asarray(M, dtype=np.complex128) for M in moving_c(0.0))), 1)
    with pytest.raises(Undecidable, match=r"C is singular at the end at infinity for sigma = 1\b"):
        limit.rates(1.0)


def test_a_pencil_whose_c_is_singular_at_a_point_for_every_sigma_is_told_the_point() -> None:
    """The string, multiplied by a matrix whose determinant is 3/4 − z: its samples next to z = 3/4 are rounding."""

    def multiplied(z: Any) -> tuple[Any, ...]:
        L, (D0, D1) = np.array([[0.75 - z, 0.3], [0.0, 1.0]]), string(z)
        return L, np.zeros((2, 2)), L @ D0, L @ D1

    with pytest.raises(InputError, match=r"C is singular at z = 0\.75, whatever sigma is"):
        st.problem(2, multiplied, st.Wall(0, FIXED), st.Wall(1, FIXED))
    assert st.refine(st.problem(2, multiplied, st.Wall(0, FIXED), st.Wall(0.5, FIXED)), guess=-39.0).converged
