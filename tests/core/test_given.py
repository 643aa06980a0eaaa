"""Numbers that users give: what is none is refused in a sentence, whatever its type, and what NumPy and mpmath hold is one."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import mpmath
import numpy as np
import pytest

import shootstab as st
from shootstab.core.given import complex_of, is_complex, is_real, require_real, require_whole

NONE = ("x", True, [1.0], {}, 10**400, math.nan, math.inf)
NUMBERS = (2, 0.5, np.float64(0.5), np.float32(0.5), np.int64(2), mpmath.mpf(2))


def well() -> Any:
    return st.gallery.davies(8.0)


DISC = st.Disc(0.7 + 0.7j, 0.1)
ASKED: dict[str, Callable[[Any], Any]] = {
    "rtol": lambda x: st.refine(well(), 0.7, rtol=x),
    "rtol of find": lambda x: st.find(well(), DISC, rtol=x),
    "atol": lambda x: st.refine(well(), 0.7, atol=x),
    "atol of verify": lambda x: st.verify(well(), [0.7], atol=x),
    "guess": lambda x: st.refine(well(), x),
    "digits": lambda x: st.refine(well(), 0.7, digits=x),
    "digits of verify": lambda x: st.verify(well(), [0.7], digits=x),
    "digits of prove": lambda x: st.prove(well(), 0.7, digits=x),
    "digits of an eigenfunction": lambda x: st.eigenfunction(well(), 0.7, digits=x),
    "local errors": lambda x: st.Frame(rtol=x),
    "radius": lambda x: st.Disc(0.7, x),
    "corner": lambda x: st.Rectangle(x, 1e3 + 1e3j),
    "corner of a polygon": lambda x: st.Polygon((0.0, 1.0, x)),
    "region": lambda x: st.count(well(), x),
    "region of find": lambda x: st.find(well(), x),
    "reference": lambda x: st.problem(1, lambda z: None, st.Wall(0, [[1]]), st.Wall(1, [[1]]), reference=x),
    "place of a wall": lambda x: st.problem(2, lambda z: (np.eye(2), np.eye(2)), st.Wall(x, [[1, 0]]), st.Wall(1, [[1, 0]])),
    "what a wall approximates": lambda x: st.Wall(1.0, [[1]], approximates=x).matrices(1, "left"),
    "steepness": lambda x: st.gallery.davies(x),
    "Reynolds number": lambda x: st.gallery.PlanePoiseuille(reynolds=x),
    "restitution": lambda x: st.chute.steady(far_temperature=7.0, e=x, e_w=0.8, r=0.6, tan_theta=0.3),
}


@pytest.mark.parametrize("asked", ASKED)
@pytest.mark.parametrize("given", NONE, ids=["text", "True", "list", "dict", "huge", "nan", "inf"])
def test_what_is_no_number_is_refused_in_a_line(asked: str, given: Any) -> None:
    """It ended in a TypeError or an OverflowError, or True was taken for 1."""
    with pytest.raises(st.InputError, match=r"allowed (is|are) ") as refused:
        ASKED[asked](given)
    assert "\n" not in str(refused.value)


@pytest.mark.parametrize("rtol", [0.0, -1.0, 1.0, math.inf])
def test_no_relative_accuracy_is_zero_negative_or_one(rtol: float) -> None:
    for ask in (ASKED["rtol"], ASKED["rtol of find"], ASKED["local errors"]):
        with pytest.raises(st.InputError, match=r"rtol = .*: allowed is a number from"):
            ask(rtol)


@pytest.mark.parametrize("number", NUMBERS, ids=repr)
def test_numbers_of_every_library_are_numbers(number: Any) -> None:
    assert is_real(number)
    assert is_complex(number)
    assert complex_of("guess", number) == complex(number)
    require_real("x", number, lambda x: x > 0.0, "a number above 0")


def test_bounds_of_whole_numbers_belong_to_them() -> None:
    for value in (1, np.int64(12)):
        require_whole("digits", value, 1, 12)
    require_whole("digits", 10**6, 1)
    for value in (0, 13, 6.0):
        with pytest.raises(st.InputError, match=rf"^digits = {value}: allowed is 1 to 12$"):
            require_whole("digits", value, 1, 12)
