"""models/gallery: the problems that are laid out in arrays, in the digits of their equations."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import mpmath
import pytest

import shootstab as st
from shootstab.models.catalogue.published import PUBLISHED, Published

KNOWN: dict[str, list[str]] = json.loads((Path(__file__).parent / "many_digits.json").read_text())["modes"]
CASES = {case.name: case for case in PUBLISHED}
EXACT = {
    "Pöschl–Teller, ν = 0.2": lambda: mpmath.mpf("0.04"),
    "Pöschl–Teller, ν = 0.02": lambda: mpmath.mpf("0.0004"),
    "Davies, n = 0": lambda: mpmath.expjpi(mpmath.mpf(1) / 4),
    "Davies, n = 8": lambda: 17 * mpmath.expjpi(mpmath.mpf(1) / 4),
}


def must_hold(case: Published, digits: int) -> tuple[Any, Any]:
    """The mode in many digits and in doubles, whose error bounds both hold it."""
    problem = case.problem()
    double = st.refine(problem, case.sigma * (1 + 1e-4))
    mode = st.refine(problem, double.sigma, digits=digits)
    assert mode.converged
    assert abs(complex(mode.sigma) - double.sigma) <= double.error
    return mode, double


@pytest.mark.parametrize("name", EXACT)
def test_forty_digits_of_what_is_known_exactly(name: str) -> None:
    mode, _ = must_hold(CASES[name], 40)
    with mpmath.workdps(50):
        exact = EXACT[name]()
        assert abs(mode.sigma - exact) <= mode.error <= mpmath.mpf(10) ** -40 * abs(exact)


@pytest.mark.parametrize(
    ("name", "recorded"), [("shear layer", "shear layer"), ("suction layer", "suction layer"), ("Blasius", "boundary-layer")]
)
def test_twenty_digits_of_layers_are_those_of_other_equations(name: str, recorded: str) -> None:
    """In u, v and p; of Blasius' layer as the scene file poses it."""
    mode, _ = must_hold(CASES[name], 20)
    with mpmath.workdps(30):
        known = mpmath.mpc(*KNOWN[recorded])
        assert abs(mode.sigma - known) <= 1e-18 * abs(known)


@pytest.mark.slow
@pytest.mark.parametrize("name", ["plate, Malik 3", "plate, Malik 6"])
def test_plates_in_many_digits(name: str) -> None:
    """The equations of the scene file with the gas of the case, temporal and spatial."""
    must_hold(CASES[name], 16)


@pytest.mark.slow
@pytest.mark.parametrize("wall", [1.2, 1.5])
def test_plate_with_a_wall_of_given_temperature_has_its_equations(wall: float) -> None:
    """A cooled wall, in doubles by arrays and by equations; beyond the 24 intervals of the colder one its last polynomial went on."""
    cooled = st.gallery.plate(2.5, 148.0, 3000.0, alpha=0.06, beta=0.1, second=2 / 15, wall=wall)
    written = cooled.written()
    mode = st.refine(cooled, 0.0005 - 0.0367j)
    other = st.refine(written, mode.sigma)
    assert mode.converged
    assert abs(other.sigma - mode.sigma) <= mode.error + other.error


@pytest.mark.parametrize("name", ["benard", "poeschl-teller", "shear-layer", "suction"])
def test_equations_are_in_the_unknowns_that_eigenfunctions_are_shown_in(name: str) -> None:
    problem: Any = st.scene(name).problem
    assert set(problem.unknowns.names) == set(problem.written().unknowns.names)


def test_eigenfunction_of_a_layer_in_digits() -> None:
    """φ, u = φ′ by a difference, whose error is of the order 1e-9, and v = −iαφ."""
    shown = st.eigenfunction(st.scene("shear-layer").problem, 0.1897, digits=15)
    before, values, behind = (shown(z) for z in ("0.4999", "0.5", "0.5001"))
    assert abs(complex(values["v"]) + 0.4446j * complex(values["phi"])) < 1e-14
    assert abs(complex((behind["phi"] - before["phi"]) / mpmath.mpf("0.0002") - values["u"])) < 1e-7
