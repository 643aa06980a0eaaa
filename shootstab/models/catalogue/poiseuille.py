"""Plane Poiseuille flow: as a scene the whole channel, for whoever brings a spectrum has that of the channel: see gallery/poiseuille.py."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from shootstab.core.scene_keys import Description
from shootstab.models.catalogue.entry import WAVE_FORM, Entry, Maker, Published, keys


def _describe(values: Mapping[str, Any]) -> Description:
    half = "half channel 0 < y < 1, even φ only" if values.get("half", False) else "whole channel -1 < y < 1, both parities"
    return Description(4, "φ, φ′, φ″, φ‴", half, "lengths in half-widths, velocities U(0)", WAVE_FORM)


ENTRIES = (
    Entry(
        name="poiseuille",
        make=Maker("poiseuille", "PlanePoiseuille", {"half": False}),
        keys=keys("reynolds", "alpha", required=("reynolds", "alpha"), half=bool),
        describe=_describe,
        scenes={"poiseuille": ("plane Poiseuille flow, Re = 10000, alpha = 1", {"reynolds": 10000.0, "alpha": 1.0})},
        published=(
            Published(
                "plane Poiseuille",
                Maker("poiseuille", "PlanePoiseuille"),
                0.23752648882047010745 + 0.0037396706229794099322j,
                15,
                "Orszag 1971, re-computed",
                -1j,
            ),
        ),
    ),
)
