"""Scenes: a name, a TOML file or `module:object` goes in, a problem comes out.

The built-in scenes are the tables that a scene file would hold, and go the same way.
"""

from __future__ import annotations

import importlib
import sys
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from shootstab.core.errors import InputError
from shootstab.io.conventions import Convention
from shootstab.io.notation import shortened

if TYPE_CHECKING:
    from shootstab.models.chute import Flow
    from shootstab.problems.protocol import Problem

LARGEST = 1e300  # whatever is not below it, NaN too, is no number of physics
CHUTE_UNIT = "√(g cosθ/d)"


@dataclass(frozen=True)
class Scene:
    """A problem with a name. flow is the steady flow under it, if it has one; symbol is what the eigenvalue is called, unit its unit."""

    name: str
    description: str
    problem: Problem
    flow: Flow | None = None
    unit: str = ""
    symbol: str = "σ"

    def seen(self, convention: Convention) -> Scene:
        """The same with somebody else's eigenvalue."""
        if convention.plain:
            return self
        from shootstab.problems.rescaled import Rescaled

        description = f"{self.description}, {convention.formula}"
        return replace(self, description=description, problem=Rescaled(self.problem, convention.unit), unit="", symbol=convention.symbol)


def _paper(branch: str, kx: float, ky: float) -> dict[str, Any]:
    flow = {"e": 0.8, "e_w": 0.8, "r": 0.6, "tan_theta": 0.3, "mass_flux": 3.0, "branch": branch}
    return {"flow": flow, "wave": {"kx": kx, "ky": ky}}


_PLATE = {"name": "plate", "second": 2 / 15}
_MALIK_3 = {**_PLATE, "mach": 2.5, "far_temperature": 600 / 1.8 / 2.25, "reynolds": 3000.0, "alpha": 0.06, "beta": 0.1}
_MALIK_6 = {**_PLATE, "mach": 4.5, "far_temperature": 1100 / 1.8 / 5.05, "reynolds": 1500.0, "omega": 0.23}

# name: (description, what a scene file would say)
BUILT_IN: Mapping[str, tuple[str, dict[str, Any]]] = {
    "high": ("granular chute, high flow at Q0 = 3, kx = 0, ky = 0.0100, its most unstable wavenumber", _paper("high", 0.0, 0.01)),
    "mid": ("granular chute, mid flow at Q0 = 3, kx = 0, ky = 0.0125, its most unstable wavenumber", _paper("mid", 0.0, 0.0125)),
    "low": ("granular chute, low flow at Q0 = 3, kx = 0.011, ky = 0, its most unstable wavenumber", _paper("low", 0.011, 0.0)),
    "fig2": ("granular chute, high flow at Q0 = 3, kx = 5e-4, ky = 0: figure 2 of the paper", _paper("high", 5e-4, 0.0)),
    "poiseuille": ("plane Poiseuille flow, Re = 10000, alpha = 1", {"problem": {"name": "poiseuille", "reynolds": 10000.0, "alpha": 1.0}}),
    "blasius": ("Blasius boundary layer, R = 580, alpha = 0.179", {"problem": {"name": "blasius", "reynolds": 580.0, "alpha": 0.179}}),
    "suction": ("asymptotic suction layer, R = 54370, alpha = 0.1555", {"problem": {"name": "suction"}}),
    "benard": (
        "Rayleigh-Benard convection, rigid, Ra = 2000, a = 3.117",
        {"problem": {"name": "benard", "rayleigh": 2e3, "wavenumber": 3.117}},
    ),
    "poeschl-teller": ("Poeschl-Teller potential, nu = 0.2", {"problem": {"name": "poeschl-teller", "nu": 0.2}}),
    "davies": ("Davies' operator -u'' + i x^2 u", {"problem": {"name": "davies"}}),
    "shear-layer": ("shear layer U = tanh y, inviscid, alpha = 0.4446", {"problem": {"name": "shear-layer", "alpha": 0.4446}}),
    "malik-3": ("compressible flat plate, M = 2.5, temporal: Malik's case 3, Mack's bulk viscosity", {"problem": _MALIK_3}),
    "malik-6": ("compressible flat plate, M = 4.5, spatial: Malik's case 6, Mack's bulk viscosity", {"problem": _MALIK_6}),
}


def load(name: str) -> Scene:
    """The scene that a built-in name, a TOML file or `module:object` means.

    Raises InputError, whose one line names the scene, the key and what is allowed.
    """
    if name in BUILT_IN:
        description, tables = BUILT_IN[name]
        return _from_tables(name, description, tables)
    if name.endswith(".toml") or Path(name).is_file():
        return _from_tables(name, f"scene file {Path(name).name}", _toml(Path(name)))
    if ":" in name:
        return _from_module(name)
    raise InputError(f"{name}: no such scene: allowed is one of {', '.join(BUILT_IN)}, a TOML file or module:object")


# TOML


def _toml(path: Path) -> dict[str, Any]:
    try:
        return tomllib.loads(path.read_bytes().decode("utf-8-sig"))
    except OSError as error:
        raise InputError(f"{path}: cannot be read: {error.strerror or error}: allowed is a scene file") from error
    except (tomllib.TOMLDecodeError, UnicodeDecodeError, RecursionError, ValueError) as error:
        raise InputError(f"{path}: broken TOML: {error}") from error


@dataclass(frozen=True)
class Table:
    """Which keys a table of a scene file has, and of which type; needed are those in `required`, and one of `either`."""

    name: str
    keys: Mapping[str, type]
    required: tuple[str, ...]
    either: tuple[str, ...] = ()

    def checked(self, tables: Mapping[str, Any]) -> dict[str, Any]:
        """The values by key, numbers as floats. Raises InputError."""
        table = tables.get(self.name)
        if not isinstance(table, dict):
            raise InputError(f"{self.name} = {shortened(table)}: allowed is a table [{self.name}]")
        for key in table:
            if key not in self.keys:
                raise InputError(f"[{self.name}] has the unknown key {shortened(key)}: allowed are {', '.join(self.keys)}")
        for key in self.required:
            if key not in table:
                raise InputError(f"[{self.name}] lacks the key {key}: needed are {self._needed()}")
        given = [key for key in self.either if key in table]
        if self.either and len(given) != 1:
            raise InputError(f"[{self.name}] has {' and '.join(given) or 'no flow'}: allowed is exactly one of {', '.join(self.either)}")
        return {key: self._typed(key, value) for key, value in table.items()}

    def _needed(self) -> str:
        return ", ".join(self.required) + (f" and one of {', '.join(self.either)}" if self.either else "")

    def _typed(self, key: str, value: Any) -> Any:
        wanted = self.keys[key]
        if wanted is float and isinstance(value, int | float) and not isinstance(value, bool):
            if abs(value) < LARGEST:
                return float(value)
        elif wanted is not float and isinstance(value, wanted):
            return value
        words = {float: "a finite number", str: "a string", bool: "true or false"}
        raise InputError(f"[{self.name}] {key} = {shortened(value)}: allowed is {words[wanted]}")


_FLOW_NUMBERS = dict.fromkeys(("e", "e_w", "r", "tan_theta", "mass_flux", "far_temperature", "nu_max"), float)
_FLOW = Table(
    "flow",
    {**_FLOW_NUMBERS, **dict.fromkeys(("branch", "radial", "wall"), str)},
    required=("e", "e_w", "r", "tan_theta"),
    either=("mass_flux", "far_temperature"),
)
_WAVE = Table("wave", {"kx": float, "ky": float}, required=("kx", "ky"))


def _from_tables(name: str, description: str, tables: Mapping[str, Any]) -> Scene:
    try:
        return _gallery(name, description, tables) if "problem" in tables else _chute(name, description, tables)
    except InputError as error:
        raise type(error)(f"{name}: {error}") from error


def _require_tables(tables: Mapping[str, Any], allowed: tuple[str, ...]) -> None:
    for table in tables:
        if table not in allowed:
            names = " and ".join(f"[{t}]" for t in allowed)
            raise InputError(f"unknown key {shortened(table)}: allowed is {names} (or [problem] alone)")
    for table in allowed:
        if table not in tables:
            raise InputError(f"lacks [{table}]: needed is {' and '.join(f'[{t}]' for t in allowed)} (or [problem] alone)")


def _chute(name: str, description: str, tables: Mapping[str, Any]) -> Scene:
    _require_tables(tables, ("flow", "wave"))
    flow_values, wave = _FLOW.checked(tables), _WAVE.checked(tables)
    if wave["kx"] == 0.0 and wave["ky"] == 0.0:
        raise InputError("[wave] kx = 0 and ky = 0: allowed is any pair but this one")
    from shootstab.models import chute

    flow = chute.steady(**flow_values)
    return Scene(name, description, chute.problem(flow, kx=wave["kx"], ky=wave["ky"]), flow, CHUTE_UNIT)


# the gallery: name in [problem]: its table, and the function of shootstab.models.gallery that its values make the problem with


def _numbers(*keys: str, required: tuple[str, ...] = (), **others: type) -> Table:
    return Table("problem", {"name": str, **dict.fromkeys(keys, float), **others}, required=("name", *required))


_GALLERY: Mapping[str, tuple[Table, str]] = {
    "poiseuille": (_numbers("reynolds", "alpha", required=("reynolds", "alpha"), half=bool), "PlanePoiseuille"),
    "blasius": (_numbers("reynolds", "alpha"), "blasius"),
    "suction": (_numbers("reynolds", "alpha"), "suction"),
    "benard": (_numbers("rayleigh", "wavenumber", "prandtl", lower=str, upper=str), "benard"),
    "poeschl-teller": (_numbers("nu"), "poeschl_teller"),
    "davies": (_numbers("start"), "davies"),
    "shear-layer": (_numbers("alpha"), "shear_layer"),
    "plate": (
        _numbers(
            *("mach", "far_temperature", "reynolds", "alpha", "omega", "beta", "second", "sutherland", "prandtl", "gamma", "wall"),
            required=("mach", "far_temperature", "reynolds"),
        ),
        "plate",
    ),
}


def _gallery(name: str, description: str, tables: Mapping[str, Any]) -> Scene:
    _require_tables(tables, ("problem",))
    if isinstance(tables["problem"], dict) and "equations" in tables["problem"]:
        from shootstab.formulation.scene import from_table

        problem = from_table(tables["problem"])
        return Scene(name, description, problem, symbol=problem.statement.names.eigenvalue.replace("sigma", "σ"))
    wanted = tables["problem"].get("name") if isinstance(tables["problem"], dict) else None
    if not isinstance(wanted, str) or wanted not in _GALLERY:
        raise InputError(f"[problem] name = {shortened(wanted)}: allowed is one of {', '.join(_GALLERY)}")
    table, make = _GALLERY[wanted]
    values = table.checked(tables)
    del values["name"]
    from shootstab.models import gallery

    return Scene(name, description, getattr(gallery, make)(**values))


# module:object


def _from_module(name: str) -> Scene:
    module_name, _, path = name.partition(":")
    if "" not in sys.path:
        sys.path.insert(0, "")  # the current directory
    try:
        found: Any = importlib.import_module(module_name)
        for attribute in path.split("."):
            found = getattr(found, attribute)
        if callable(found) and not hasattr(found, "pencil"):
            found = found()  # a function that makes the problem
    except (Exception, SystemExit) as error:  # the module is the user's own: anything may come out of it
        raise InputError(f"{name}: cannot be loaded: {type(error).__name__}: {error}") from error
    _require_problem(name, found)
    return Scene(name, f"{path} of {module_name}", found, getattr(found, "flow", None))


def _require_problem(name: str, found: Any) -> None:
    """Raise InputError unless everything that the engine asks of a problem is there."""
    from shootstab.problems.protocol import Problem

    if isinstance(found, type):
        raise InputError(f"{name}: is a class: allowed is a problem, or a function without arguments that makes one")
    lacking = [member for member in vars(Problem) if not member.startswith("_") and not hasattr(found, member)]
    if lacking:
        raise InputError(f"{name}: is no problem, it lacks {', '.join(lacking)}: allowed is an object with these")
