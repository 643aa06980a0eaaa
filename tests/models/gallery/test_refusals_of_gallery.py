"""Every refusal of the gallery that no other test reaches: what was wrong, where, and what is allowed."""

from __future__ import annotations

import math
from typing import Any

import pytest

import shootstab as st
from shootstab.core.errors import InputError, NoFlowError
from shootstab.models.gallery import plate_flow as flows
from shootstab.models.gallery.benard import benard
from shootstab.models.gallery.plate import plate, plate_temporal
from shootstab.models.gallery.plate_flow import Gas, plate_flow

GAS = Gas(2.5, 148.0)
NO_MODE = "allowed is a number below ", "above which no mode grows"


REFUSALS: dict[str, tuple[Any, tuple[str, ...]]] = {
    "floor of convection": (lambda: benard().growing_region(1e3), ("floor = 1000.0", *NO_MODE)),
    "floor that is no number": (lambda: benard().growing_region(math.nan), ("floor = nan", *NO_MODE)),
    "floor of the channel": (lambda: st.gallery.PlanePoiseuille().growing_region(2.0), ("floor = 2.0", *NO_MODE)),
    "both wavenumber and frequency": (lambda: plate(2.5, 148.0, 3e3, alpha=0.1, omega=0.1), ("alpha", "omega", "exactly one of them")),
    "neither": (lambda: plate(2.5, 148.0, 3e3), ("alpha", "omega", "exactly one of them")),
    "second below Stokes": (lambda: plate_temporal(GAS, 3e3, 0.1, second=-0.7), ("second = -0.7", "-2/3 (Stokes) or more", "below 100,")),
    "second too large": (lambda: plate_temporal(GAS, 3e3, 0.1, second=100.0), ("second = 100.0", "below 100,")),
    "wall without heat": (lambda: Gas(2.5, 148.0, wall=0.0), ("wall = 0.0", "a finite number above 0, or none for an adiabatic wall")),
    "wall that is no number": (lambda: Gas(2.5, 148.0, wall=math.nan), ("wall = nan", "a finite number above 0")),
}


@pytest.mark.parametrize("what", REFUSALS)
def test_what_was_wrong_is_named(what: str) -> None:
    make, words = REFUSALS[what]
    with pytest.raises(InputError) as refusal:
        make()
    for word in (*words, "allowed"):
        assert word in str(refusal.value)


def test_a_boundary_layer_that_is_not_found_says_by_how_much(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(flows, "NEWTON", 1)
    monkeypatch.setattr(flows, "PICARD", 4)  # enough for a miss
    with pytest.raises(NoFlowError, match=r"no boundary layer found for Gas\(mach=0\.31.*: U and T miss 1 by \d\.\de-\d\d$"):
        plate_flow(Gas(0.31, 300.0))


def test_a_temperature_below_zero_is_the_end_of_a_boundary_layer() -> None:
    with pytest.raises(NoFlowError, match=r"no boundary layer found for Gas\(.*: the temperature leaves the range of physics$"):
        plate_flow(Gas(2.5, 148.0, wall=1e-3))
