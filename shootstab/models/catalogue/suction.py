"""The asymptotic suction boundary layer: see gallery/suction.py."""

from __future__ import annotations

from shootstab.core.scene_keys import Description
from shootstab.models.catalogue.entry import WAVE_FORM, Entry, Maker, Published, keys

SUCTION = Description(4, "φ, φ′, φ″, φ‴", "half line y > 0, all modes", "lengths in displacement thicknesses, velocities U∞", WAVE_FORM)
ENTRIES = (
    Entry(
        name="suction",
        make=Maker("suction", "suction"),
        keys=keys("reynolds", "alpha"),
        describe=lambda values: SUCTION,
        scenes={"suction": ("asymptotic suction layer, R = 54370, alpha = 0.1555", {"reynolds": 54370.0, "alpha": 0.1555})},
        published=(
            Published("suction layer", Maker("suction", "suction"), 0.150, 3, "Hocking 1975, at the critical point", -0.1555j, slow=True),
        ),
    ),
)
