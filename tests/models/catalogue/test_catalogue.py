"""models/catalogue: what is said of a problem is what it is."""

from __future__ import annotations

import json
from importlib import import_module
from inspect import signature
from typing import Any

import numpy as np
import pytest

from shootstab.core.errors import InputError
from shootstab.io.scenes import load
from shootstab.models.catalogue import entries
from shootstab.models.catalogue.benard import FREE, FREE_GROWTH_RATE
from shootstab.models.catalogue.plate import MACK_VISCOSITY
from shootstab.models.gallery.benard import free_growth_rate
from shootstab.models.gallery.poiseuille import PlanePoiseuille

plate: Any = import_module("shootstab.models.gallery.plate")


def test_numbers_that_stand_here_are_those_of_the_equations() -> None:
    rayleigh, wavenumber, prandtl = (FREE[name] for name in ("rayleigh", "wavenumber", "prandtl"))
    assert free_growth_rate(float(rayleigh), float(wavenumber), float(prandtl)) == pytest.approx(FREE_GROWTH_RATE, rel=1e-15, abs=0.0)
    assert pytest.approx(MACK_VISCOSITY, rel=1e-15, abs=0.0) == plate.MACK
    scenes = entries()["plate"].scenes
    for name, mach, stagnation in (("malik-3", 2.5, 600.0), ("malik-6", 4.5, 1100.0)):
        far = plate.stagnation(mach, stagnation) * plate.RANKINE
        assert scenes[name][1]["far_temperature"] == pytest.approx(far, rel=1e-14, abs=0.0)


@pytest.mark.parametrize("name", ["blasius", "shear-layer", "poeschl-teller", "poiseuille"])
def test_a_scene_of_published_parameters_has_those_of_its_equations(name: str) -> None:
    entry = entries()[name]
    make = getattr(import_module(f"shootstab.models.gallery.{entry.make.module}"), entry.make.function)
    defaults = {key: p.default for key, p in signature(make).parameters.items()}
    ((_, values),) = entry.scenes.values()
    assert values and {key: defaults[key] for key in values} == values


def test_every_entry_reads_its_own_scenes() -> None:
    for entry in entries().values():
        for _, values in entry.scenes.values():
            checked = entry.keys.checked({"problem": {"name": entry.name, **values}})
            assert {k: v for k, v in checked.items() if k != "name"} == values


def test_the_order_of_a_plate_is_told_before_it_is_made() -> None:
    describe = entries()["plate"].describe
    assert describe({"alpha": 0.1}).order == plate.PLATE_SIZE
    assert describe({"omega": 0.1}).order == plate.PLATE_SIZE


def test_poiseuille_is_the_whole_channel_and_half_of_it_where_that_is_asked_for(tmp_path: Any) -> None:
    whole = load("poiseuille")
    assert whole.problem == PlanePoiseuille(half=False)
    assert "both parities" in whole.heading and "order 4" in whole.heading and "exp(σt + iαx)" in whole.heading
    path = tmp_path / "half.toml"
    path.write_text('[problem]\nname = "poiseuille"\nreynolds = 1e4\nalpha = 1\nhalf = true\n')
    half = load(str(path))
    assert half.problem == PlanePoiseuille(half=True)
    assert "even φ only" in half.heading
    # the channel has the even modes of its half, and odd ones beside them
    channel, even = (scene.problem.pseudospectral.spectrum(80).eigenvalues for scene in (whole, half))
    assert 2 <= len(even) < len(channel)
    assert all(np.abs(channel - sigma).min() < 1e-7 for sigma in even)
    assert json.loads(json.dumps(whole.as_dict()))["symmetry"].startswith("whole channel")


def test_a_name_that_is_not_there_is_refused_with_those_that_are(tmp_path: Any) -> None:
    path = tmp_path / "a.toml"
    path.write_text('[problem]\nname = "couette"\n')
    with pytest.raises(InputError, match="poeschl-teller"):
        load(str(path))
