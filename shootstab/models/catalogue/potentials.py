"""Two operators of quantum mechanics: see gallery/potentials.py."""

from __future__ import annotations

import cmath
import math

from shootstab.core.scene_keys import Description
from shootstab.models.catalogue.entry import Entry, Maker, Published, keys

ENTRIES = (
    Entry(
        name="poeschl-teller",
        make=Maker("potentials", "poeschl_teller"),
        keys=keys("nu"),
        describe=lambda values: Description(2, "y, y′", "whole line, both parities", "no dimensions", "λ of y″ + ν(ν+1) sech²x y = λ y"),
        scenes={"poeschl-teller": ("Poeschl-Teller potential, nu = 0.2", {"nu": 0.2})},
        published=(
            Published("Pöschl–Teller, ν = 0.2", Maker("potentials", "poeschl_teller", {"nu": 0.2}), 0.04, 16, "exact"),
            Published("Pöschl–Teller, ν = 0.02", Maker("potentials", "poeschl_teller", {"nu": 0.02}), 0.0004, 16, "exact"),
        ),
    ),
    Entry(
        name="davies",
        make=Maker("potentials", "davies"),
        keys=keys("start"),
        describe=lambda values: Description(2, "u, u′", "whole line, both parities", "no dimensions", "λ of -u″ + i x² u = λ u"),
        scenes={"davies": ("Davies' operator -u'' + i x^2 u", {})},
        published=(
            Published("Davies, n = 0", Maker("potentials", "davies"), cmath.exp(0.25j * math.pi), 16, "exact"),
            Published("Davies, n = 8", Maker("potentials", "davies"), 17 * cmath.exp(0.25j * math.pi), 16, "exact"),
        ),
    ),
)
