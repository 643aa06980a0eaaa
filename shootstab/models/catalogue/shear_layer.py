"""The inviscid shear layer: see gallery/shear_layer.py."""

from __future__ import annotations

from shootstab.core.scene_keys import Description
from shootstab.models.catalogue.entry import WAVE_FORM, Entry, Maker, Published, keys

INVISCID = Description(2, "φ, φ′", "whole line, all modes", "lengths δ and velocities U∞ of U = tanh y", WAVE_FORM)
ENTRIES = (
    Entry(
        name="shear-layer",
        make=Maker("shear_layer", "shear_layer"),
        keys=keys("alpha"),
        describe=lambda values: INVISCID,
        scenes={"shear-layer": ("shear layer U = tanh y, inviscid, alpha = 0.4446", {"alpha": 0.4446})},
        published=(Published("shear layer", Maker("shear_layer", "shear_layer"), 0.1897, 4, "Michalke 1964"),),
    ),
)
