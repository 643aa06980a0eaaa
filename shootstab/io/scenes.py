"""Scenes: a name, a TOML file or `module:object` goes in, a problem comes out.

What the tables of a scene file hold is the models' own affair (see core.scene_keys). The built-in scenes are the tables that a scene file
would hold, and go the same way.
"""

from __future__ import annotations

import importlib
import sys
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from shootstab.core.errors import InputError, shortened
from shootstab.core.reading import toml_of
from shootstab.core.scene_keys import Description, NamedScene, SceneModel
from shootstab.core.scene_notes import NOTES, about, described, known
from shootstab.io.conventions import Convention, wavenumber
from shootstab.io.notation import nearest

if TYPE_CHECKING:
    from shootstab.models.chute import Flow
    from shootstab.problems.protocol import Problem

LARGEST_SCENE = 2**17  # chosen: bytes of a scene file, six of the longest formulas; TOML of more may take minutes to be read
MODELS = ("shootstab.models.chute.chute_scene", "shootstab.models.catalogue.gallery_scene")  # each has a SceneModel called MODEL


@dataclass(frozen=True, repr=False)
class Scene:
    """A problem with a name. flow is the steady flow under it, if it has one; symbol is what the eigenvalue is called, unit its unit;
    details say what the problem is, parameters are the tables that a scene file would hold.
    """

    name: str
    description: str
    problem: Problem
    details: Description
    flow: Flow | None = None
    unit: str = ""
    symbol: str = "σ"
    parameters: Mapping[str, Any] = field(default_factory=dict)

    def __repr__(self) -> str:
        return f"Scene({self.name}: {self.description})"

    def __str__(self) -> str:
        return self.heading

    @property
    def heading(self) -> str:
        """The first line of every table."""
        return f"{self.name}: {self.description} ({self.details})"

    def as_dict(self) -> dict[str, Any]:
        """The name, the description, the details and the parameters, for JSON."""
        return {"name": self.name, "description": self.description, **vars(self.details), "parameters": self.parameters}

    @property
    def wavenumber(self) -> tuple[str, float] | None:
        """What the streamwise wavenumber is called, and its value; None where it is not told apart."""
        return wavenumber(self.problem, self.parameters, self.details.eigenvalue)

    def seen(self, convention: Convention) -> Scene:
        """The scene with somebody else's eigenvalue."""
        if convention.plain:
            return self
        from shootstab.problems.rescaled import Rescaled

        description = f"{self.description}, {convention.formula}"
        return replace(self, description=description, problem=Rescaled(self.problem, convention.unit), unit="", symbol=convention.symbol)


@dataclass(frozen=True)
class Listed:
    """A built-in scene and the model that makes it."""

    model: SceneModel
    scene: NamedScene

    @property
    def details(self) -> Description:
        """What the problem is; nothing is computed."""
        return self.model.details(self.scene.tables)


def _models() -> Iterator[SceneModel]:
    """One after the other, so that those after the one that was meant are not imported."""
    for name in MODELS:
        yield importlib.import_module(name).MODEL


def built_in() -> dict[str, Listed]:
    """All scenes that have a name of their own."""
    return {name: Listed(model, scene) for model in _models() for name, scene in model.built_in.items()}


def load(name: str) -> Scene:
    """The scene that a built-in name, a TOML file or `module:object` means.

    Raises InputError, whose one line names the scene, the key and what is allowed.
    """
    for model in _models():
        if name in model.built_in:
            scene = model.built_in[name]
            return from_tables(name, scene.description, scene.tables)
    if name.endswith(".toml") or Path(name).is_file():
        return from_tables(name, f"scene file {Path(name).name}", toml_of(Path(name), LARGEST_SCENE, "a scene file"))
    if ":" in name:
        return _from_module(name)
    raise InputError(
        f"{name}: no such scene{nearest(name, built_in())}: allowed is one of {', '.join(built_in())}, a TOML file or module:object"
    )


def from_tables(name: str, description: str, tables: Mapping[str, Any]) -> Scene:
    """The scene of the tables that a scene file would hold. Raises InputError, whose one line begins with the name."""
    try:
        if isinstance(tables.get("dedalus"), dict) and "problem" not in tables:
            from shootstab.formulation.dedalus_table import problem_table

            read, taus = problem_table(tables["dedalus"])
            tables = {**{key: table for key, table in tables.items() if key != "dedalus"}, "problem": read}
            told = f", without its tau terms in {', '.join(taus)}" if taus else ""
            return _from_equations(name, f"{description}, in Dedalus' spelling{told}", tables)
        if isinstance(tables.get("problem"), dict) and "equations" in tables["problem"]:
            return _from_equations(name, description, tables)
        made = _model_of(tables).made(tables)
    except InputError as error:
        raise type(error)(f"{name}: {error}") from error
    return Scene(name, description, made.problem, made.details, made.flow, made.unit, parameters=tables)


def _from_equations(name: str, description: str, tables: Mapping[str, Any]) -> Scene:
    """A problem that the scene file itself writes down, by its equations."""
    for table in tables:
        if table not in ("problem", *NOTES):
            raise InputError(f"unknown key {shortened(table)}: allowed is [problem], and beside it {' and '.join(f'[{t}]' for t in NOTES)}")
    notes = about(tables)
    known(tables)
    from shootstab.formulation.equation_scene import from_table

    problem = from_table(tables["problem"])
    order = problem.first_order.order
    if notes.get("order", order) != order:
        raise InputError(f"[about] order = {notes['order']}: the equations are found to be of order {order}")
    symbol = problem.statement.names.eigenvalue.replace("sigma", "σ")
    details = described(tables["problem"], notes, order)
    return Scene(name, notes.get("description", description), problem, details, symbol=symbol, parameters=tables)


def _model_of(tables: Mapping[str, Any]) -> SceneModel:
    """The model whose first table is there, or the first of all. Raises InputError unless its tables, and no others, are there."""
    models = list(_models())
    model = next((m for m in reversed(models) if m.tables[0] in tables), models[0])
    own = " and ".join(f"[{t}]" for t in model.tables)
    others = " or ".join(f"{' and '.join(f'[{t}]' for t in m.tables)} alone" for m in models if m is not model)
    for table in tables:
        if table not in model.tables:
            raise InputError(f"unknown key {shortened(table)}: allowed is {own} (or {others})")
    for table in model.tables:
        if table not in tables:
            raise InputError(f"lacks [{table}]: needed is {own} (or {others})")
    return model


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
    return Scene(name, f"{path} of {module_name}", found, Description(found.size), getattr(found, "flow", None))


def _require_problem(name: str, found: Any) -> None:
    """Raise InputError unless everything that the engine asks of a problem is there."""
    from shootstab.problems.protocol import Problem

    if isinstance(found, type):
        raise InputError(f"{name}: is a class: allowed is a problem, or a function without arguments that makes one")
    lacking = [member for member in vars(Problem) if not member.startswith("_") and not hasattr(found, member)]
    if lacking:
        raise InputError(f"{name}: is no problem, it lacks {', '.join(lacking)}: allowed is an object with these")
