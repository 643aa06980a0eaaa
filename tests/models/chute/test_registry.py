"""models/chute/registry.py: every parameter is written down once, and everybody reads it there."""

from __future__ import annotations

import subprocess
import sys
from dataclasses import fields
from fractions import Fraction

import numpy as np
import pytest

from shootstab.core.errors import InputError
from shootstab.models.chute import constitutive as law
from shootstab.models.chute.parameters import Chute
from shootstab.models.chute.registry import BY_NAME, CHUTE, PARAMETERS, RADIAL, REQUIRED, SWEPT, names

GOOD = {"e": 0.8, "e_w": 0.7, "r": 0.6, "tan_theta": 0.3}


def test_the_chute_has_the_parameters_of_the_registry_in_its_order() -> None:
    assert tuple(f.name for f in fields(Chute)) == names(CHUTE)
    chute = Chute(**GOOD)
    for parameter in PARAMETERS:
        if parameter.of == CHUTE and parameter.default is not REQUIRED:
            assert getattr(chute, parameter.name) == parameter.default
    assert {p.name for p in PARAMETERS if p.of == CHUTE and p.default is REQUIRED} == set(GOOD)


def test_names_and_options_are_different() -> None:
    assert len(BY_NAME) == len(PARAMETERS) == len({p.option for p in PARAMETERS})
    assert all(p.label.strip() and p.meaning and p.allowed for p in SWEPT)
    assert all(p.kind is float for p in SWEPT)


@pytest.mark.parametrize("parameter", [p for p in PARAMETERS if p.of == CHUTE], ids=lambda p: p.name)
def test_a_default_is_allowed_and_what_is_outside_is_refused_by_name(parameter) -> None:
    if parameter.default is not REQUIRED:
        parameter.check(parameter.default)
    wrong = "x" if parameter.choices else float("nan")
    with pytest.raises(InputError, match=f"^{parameter.name} = .*: allowed is "):
        Chute(**{**GOOD, parameter.name: wrong})


def test_numbers_of_a_chute_change_together_and_words_do_not() -> None:
    chute = Chute(**GOOD, radial="carnahan-starling", wall="isotropic")
    exact = chute.with_numbers(lambda x: Fraction(repr(x)))
    assert (exact.e, exact.e_w, exact.r, exact.tan_theta, exact.nu_max) == tuple(Fraction(n, 100) for n in (80, 70, 60, 30, 62))
    assert (exact.radial, exact.wall) == ("carnahan-starling", "isotropic")


@pytest.mark.parametrize("radial", RADIAL)
def test_a_law_means_the_same_as_a_tuple_and_as_an_array(radial: str) -> None:
    chute = Chute(**GOOD, radial=radial)
    packed = np.array(chute.radial_law)
    assert np.array_equal(chute.numbers[4:], packed)
    for nu in (1e-12, 0.1, 0.55 + 0.01j):
        assert law.radial(nu, chute.radial_law) == law.radial(nu, packed)


def test_the_registry_is_light() -> None:
    code = "import sys, shootstab.models.chute.registry; print([m for m in ('numpy', 'numba', 'mpmath', 'scipy') if m in sys.modules])"
    assert subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout.strip() == "[]"
