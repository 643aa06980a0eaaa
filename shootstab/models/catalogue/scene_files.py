"""Problems of the gallery that are nothing but equations: one scene file each, in the folder scenes, its name that of the scene."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache, cached_property
from importlib.resources import files
from typing import TYPE_CHECKING

from shootstab.core.scene_keys import Tables
from shootstab.core.scene_notes import about, known
from shootstab.models.catalogue.entry import Published

if TYPE_CHECKING:
    from shootstab.problems.protocol import Problem

FOLDER = files("shootstab.models.catalogue").joinpath("scenes")


@dataclass(frozen=True)
class SceneFile:
    """See core.scene_keys.NamedScene: one file, read when it is asked for."""

    name: str

    @cached_property
    def tables(self) -> Tables:
        """All tables of the file."""
        import tomllib

        return tomllib.loads(FOLDER.joinpath(f"{self.name}.toml").read_text(encoding="utf-8"))

    @property
    def description(self) -> str:
        """The description, one line."""
        return str(about(self.tables)["description"])

    def problem(self) -> Problem:
        """The problem, read and reduced."""
        from shootstab.formulation.equation_scene import from_table

        return from_table(self.tables["problem"])

    @property
    def published(self) -> Published:
        """The eigenvalue that others have published. Raises ValueError where the file says of none."""
        found = known(self.tables)
        if found is None:
            raise ValueError(f"{self.name}.toml lacks [published]")
        return Published(self.name, self.problem, found.double, found.digits, found.source)


@cache
def scene_files() -> dict[str, SceneFile]:
    """The scene files by name, in alphabetical order."""
    names = sorted(file.name.removesuffix(".toml") for file in FOLDER.iterdir() if file.name.endswith(".toml"))
    return {name: SceneFile(name) for name in names}
