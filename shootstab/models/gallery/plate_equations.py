"""The compressible flat plate in equations, for many digits: those of the scene file `mack`, with other parameters."""

from __future__ import annotations

import re
from collections.abc import Mapping

from shootstab.formulation.equation_scene import from_table
from shootstab.formulation.problem import EquationProblem
from shootstab.models.catalogue.scene_files import scene_files
from shootstab.models.gallery.plate_flow import Gas

SCENE = "mack"  # chosen: the scene file whose equations these are
SPATIAL = {"L": "-i*omega + a*U"}  # exact: −iω + iαU, the rate along the flow, where α is the eigenvalue


def plate_equations(gas: Gas, wave: Mapping[str, float], reference: float | None = None) -> EquationProblem:
    """Temporal modes, or spatial ones where omega stands in the wave; every parameter is the decimal that was typed.

    wave holds R, m, the second coefficient of viscosity in μ, beta, and alpha or omega.
    """
    table = scene_files()[SCENE].tables["problem"]
    where = {name: _renamed(formula) for name, formula in table["where"].items() if name != "m"}
    parameters = {**wave, "M": gas.mach, "g": gas.gamma, "Pr": gas.prandtl, "S": gas.sutherland, "far": gas.far_temperature}
    where["s"] = "S/far"
    base = dict(table["base"])
    if gas.wall is not None:
        base["left"] = {"at": 0, "conditions": ["f", "U", "T = wall"]}
        parameters["wall"] = gas.wall
    unknowns, formulas = ([_renamed(text) for text in table[key]] for key in ("unknowns", "equations"))
    left = {**table["left"], "conditions": [_renamed(text) for text in table["left"]["conditions"]]}
    changed = {**table, "unknowns": unknowns, "equations": formulas, "left": left, "parameters": parameters, "where": where, "base": base}
    if "omega" in wave:
        changed |= {"where": {**where, **SPATIAL}, "eigenvalue": "alpha", "reference": reference}
    return from_table(changed)


def _renamed(formula: str) -> str:
    """The formula with the temperature called as the gallery calls it."""
    return re.sub(r"\bt\b", "theta", formula)
