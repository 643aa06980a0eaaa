"""What others have published of the gallery's problems: the numbers, how many of their digits hold, and where they stand."""

from __future__ import annotations

import cmath
import math
from collections.abc import Callable
from dataclasses import dataclass

from shootstab.models.gallery.benard import benard, free_growth_rate
from shootstab.models.gallery.blasius import blasius
from shootstab.models.gallery.plate import STOKES, malik_3, malik_6
from shootstab.models.gallery.poiseuille import PlanePoiseuille
from shootstab.models.gallery.potentials import davies, poeschl_teller
from shootstab.models.gallery.shear_layer import shear_layer
from shootstab.models.gallery.suction import suction
from shootstab.problems.protocol import Problem


@dataclass(frozen=True)
class Published:
    """value is an eigenvalue as its source has it, unit what makes it the problem's own: σ = unit·value. digits of it hold."""

    name: str
    problem: Callable[[], Problem]
    value: complex
    digits: int
    source: str
    unit: complex = 1.0
    slow: bool = False

    @property
    def sigma(self) -> complex:
        """The problem's own eigenvalue."""
        return self.unit * self.value

    @property
    def tolerance(self) -> float:
        """How far from it the true one may lie."""
        size = max(abs(self.value.real), abs(self.value.imag))
        return float(abs(self.unit) * 10.0 ** (math.floor(math.log10(size)) + 1 - self.digits))


PUBLISHED: tuple[Published, ...] = (
    Published("plane Poiseuille", PlanePoiseuille, 0.23752648882047010745 + 0.0037396706229794099322j, 15, "Orszag 1971, re-computed", -1j),
    Published("Blasius", blasius, 0.3641228676 + 0.0079597204j, 9, "Jordinson 1970, re-computed", -0.179j),
    Published("Bénard, free", lambda: benard(1000.0, 2.5, 0.71, "free", "free"), free_growth_rate(1000.0, 2.5, 0.71), 15, "exact"),
    Published("Pöschl–Teller, ν = 0.2", lambda: poeschl_teller(0.2), 0.04, 16, "exact"),
    Published("Pöschl–Teller, ν = 0.02", lambda: poeschl_teller(0.02), 0.0004, 16, "exact"),
    Published("Davies, n = 0", davies, cmath.exp(0.25j * math.pi), 16, "exact"),
    Published("Davies, n = 8", davies, 17 * cmath.exp(0.25j * math.pi), 16, "exact"),
    Published("shear layer", shear_layer, 0.1897, 4, "Michalke 1964"),
    Published("plate, Malik 3", malik_3, 0.03673374 + 0.00058446j, 7, "Malik 1990, re-computed; Mack's bulk viscosity", -1j, True),
    Published("plate, Malik 6", malik_6, 0.2534012 - 0.0024936j, 7, "the same, spatial", slow=True),
    Published("plate, Malik 6, Stokes", lambda: malik_6(STOKES), 0.2534368 - 0.0027759j, 7, "Tumin 2007, re-computed; spatial", slow=True),
    Published("suction layer", suction, 0.150, 3, "Hocking 1975, at the critical point", -0.1555j, slow=True),
)
