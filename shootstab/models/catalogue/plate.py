"""The compressible flat plate: see gallery/plate.py."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from shootstab.core.scene_keys import Description
from shootstab.models.catalogue.entry import Entry, Maker, Published, keys

MACK_VISCOSITY = 2 / 15  # derived: second coefficient of viscosity, in μ, for Mack's ratio 1.2
RANKINES = 1.8  # exact: degrees Rankine in a kelvin
# published: Malik (1990): Mach number, stagnation temperature in degrees Rankine, Reynolds number and wave of his cases
MALIK_CASES = {3: (2.5, 600.0, 3000.0, {"alpha": 0.06, "beta": 0.1}), 6: (4.5, 1100.0, 1500.0, {"omega": 0.23})}


def _describe(values: Mapping[str, Any]) -> Description:
    scales = "lengths √(ν∞x/U∞), velocities U∞, temperatures T∞, pressures ρ∞U∞²"
    spatial = "omega" in values
    wave = "exp(i(αx + βz - ωt))"
    eigenvalue = f"α of {wave}" if spatial else f"σ = -iω of {wave}"
    return Description(8, "u, u′, v, p, θ, θ′, w, w′", "half line y > 0, all modes", scales, eigenvalue)


def _malik(case: int) -> dict[str, float]:
    mach, stagnant, reynolds, wave = MALIK_CASES[case]
    far_temperature = stagnant / RANKINES / (1 + mach**2 / 5)  # γ = 7/5
    return {"second": MACK_VISCOSITY, "mach": mach, "far_temperature": far_temperature, "reynolds": reynolds, **wave}


ENTRIES = (
    Entry(
        name="plate",
        make=Maker("plate", "plate"),
        keys=keys(
            *("mach", "far_temperature", "reynolds", "alpha", "omega", "beta", "second", "sutherland", "prandtl", "gamma", "wall"),
            required=("mach", "far_temperature", "reynolds"),
        ),
        describe=_describe,
        scenes={
            "malik-3": ("compressible flat plate, M = 2.5, temporal: Malik's case 3, Mack's bulk viscosity", _malik(3)),
            "malik-6": ("compressible flat plate, M = 4.5, spatial: Malik's case 6, Mack's bulk viscosity", _malik(6)),
        },
        published=(
            Published(
                "plate, Malik 3",
                Maker("plate", "malik_3"),
                0.03673374 + 0.00058446j,
                7,
                "Malik 1990, re-computed; Mack's bulk viscosity",
                -1j,
                True,
            ),
            Published("plate, Malik 6", Maker("plate", "malik_6"), 0.2534012 - 0.0024936j, 7, "the same, spatial", slow=True),
            Published(
                *(
                    "plate, Malik 6, Stokes",
                    Maker("plate", "malik_6", {"second": -2 / 3}),
                    0.2534368 - 0.0027759j,
                    7,
                    "Tumin 2007, re-computed; spatial",
                ),
                slow=True,
            ),
        ),
    ),
)
