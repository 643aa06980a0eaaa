"""Rayleigh–Bénard convection: see gallery/benard.py."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from shootstab.core.scene_keys import Description
from shootstab.models.catalogue.entry import Entry, Maker, Published, keys

FREE = {"rayleigh": 1000.0, "wavenumber": 2.5, "prandtl": 0.71, "lower": "free", "upper": "free"}
FREE_GROWTH_RATE = 2.973306944007456  # derived: gallery.benard.free_growth_rate of these


def _describe(values: Mapping[str, Any]) -> Description:
    walls = f"{values.get('lower', 'rigid')} wall below, {values.get('upper', 'rigid')} wall above"
    return Description(6, "W, W′, W″, W‴, θ, θ′", f"layer 0 < z < 1, {walls}", "lengths h, times h²/κ", "σ of exp(σt + ia·x)")


ENTRIES = (
    Entry(
        name="benard",
        make=Maker("benard", "benard"),
        keys=keys("rayleigh", "wavenumber", "prandtl", lower=str, upper=str),
        describe=_describe,
        scenes={"benard": ("Rayleigh-Benard convection, rigid, Ra = 2000, a = 3.117", {"rayleigh": 2e3, "wavenumber": 3.117})},
        published=(Published("Bénard, free", Maker("benard", "benard", FREE), FREE_GROWTH_RATE, 15, "exact"),),
    ),
)
