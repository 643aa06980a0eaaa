"""The chute as scene files see it: [flow] and [wave], with the keys of the registry, and the paper's scenes. Nothing heavy is imported
before a flow is asked for.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from shootstab.core.errors import InputError
from shootstab.core.scene_keys import BuiltIn, Description, Keys, Made, Tables
from shootstab.models.chute.registry import BY_NAME, CHUTE, FLOW, REQUIRED, WAVE, names

GROWTH_UNIT = "√(g cosθ/d)"


def _keys(table: str, parameters: tuple[str, ...], either: tuple[str, ...] = ()) -> Keys:
    required = tuple(name for name in parameters if BY_NAME[name].default is REQUIRED)
    return Keys(table, {name: BY_NAME[name].kind for name in parameters}, required, either)


FLOW_KEYS = _keys("flow", (*names(CHUTE), *names(FLOW)), either=("mass_flux", "far_temperature"))
WAVE_KEYS = _keys("wave", names(WAVE))
PAPER = {"e": 0.8, "e_w": 0.8, "r": 0.6, "tan_theta": 0.3, "mass_flux": 3.0}  # published: the flows of Woodhouse & Hogg (2010)


def _paper(what: str, branch: str, kx: float, ky: float) -> BuiltIn:
    said = f"granular chute, {branch} flow at Q0 = {PAPER['mass_flux']:g}, {what}"
    return BuiltIn(said, {"flow": {**PAPER, "branch": branch}, "wave": {"kx": kx, "ky": ky}})


SCENES = {
    "high": _paper("kx = 0, ky = 0.0100, its most unstable wavenumber", "high", 0.0, 0.01),
    "mid": _paper("kx = 0, ky = 0.0125, its most unstable wavenumber", "mid", 0.0, 0.0125),
    "low": _paper("kx = 0.011, ky = 0, its most unstable wavenumber", "low", 0.011, 0.0),
    "fig2": _paper("kx = 5e-4, ky = 0: figure 2 of the paper", "high", 5e-4, 0.0),
}


class ChuteScenes:
    """See core.scene_keys.SceneModel."""

    tables = ("flow", "wave")
    built_in: Mapping[str, BuiltIn] = SCENES

    def details(self, tables: Tables) -> Description:
        wave = self._wave(tables)
        apart = "; v apart from the rest, order 6 + 2" if wave["ky"] == 0.0 else ""
        return Description(
            order=8,
            unknowns="ν/ν0, u, v, w, T, u', v', β",
            symmetry=f"half line z > 0, all modes{apart}",
            scales="lengths d, times √(d/(g cosθ))",
            eigenvalue="σ of exp(σt + i kx x + i ky y)",
        )

    def made(self, tables: Tables) -> Made:
        values, wave = FLOW_KEYS.checked(tables), self._wave(tables)
        from shootstab.models import chute

        flow = chute.steady(**values)
        return Made(chute.problem(flow, **wave), self.details(tables), GROWTH_UNIT, flow)

    def _wave(self, tables: Tables) -> dict[str, Any]:
        wave = WAVE_KEYS.checked(tables)
        if wave["kx"] == 0.0 and wave["ky"] == 0.0:
            raise InputError("[wave] kx = 0 and ky = 0: allowed is any pair but this one")
        return wave


MODEL = ChuteScenes()
