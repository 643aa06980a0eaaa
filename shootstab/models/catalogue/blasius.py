"""The Blasius boundary layer: see gallery/blasius.py."""

from __future__ import annotations

from shootstab.core.scene_keys import Description
from shootstab.models.catalogue.entry import WAVE_FORM, Entry, Maker, Published, keys

LAYER_UNITS = Description(4, "φ, φ′, φ″, φ‴", "half line y > 0, all modes", "lengths √(νx/U∞), velocities U∞", WAVE_FORM)
ENTRIES = (
    Entry(
        name="blasius",
        make=Maker("blasius", "blasius"),
        keys=keys("reynolds", "alpha"),
        describe=lambda values: LAYER_UNITS,
        scenes={"blasius": ("Blasius boundary layer, R = 580, alpha = 0.179", {"reynolds": 580.0, "alpha": 0.179})},
        published=(
            Published("Blasius", Maker("blasius", "blasius"), 0.3641228676 + 0.0079597204j, 9, "Jordinson 1970, re-computed", -0.179j),
        ),
    ),
)
